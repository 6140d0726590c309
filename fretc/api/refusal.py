"""`Refusal`, the exception of the API."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from typing import ParamSpec, TypeVar

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import render_all
from fretish.reading.limits import ExceededError, exceeded
from fretish.reading.natural_order import by_place

P = ParamSpec("P")
R = TypeVar("R")


class Refusal(Exception):  # noqa: N818 - the public name has no suffix
    """The input cannot be processed.

    The text of the exception has the code, the position and the help of each diagnostic.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        super().__init__(self.diagnostics)

    def __str__(self) -> str:
        """The diagnostics, as the command line prints them."""
        return render_all(by_place(self.diagnostics))


def accepted(value: R | Diagnostic) -> R:
    """The value, unless it is a diagnostic.

    Raises:
        Refusal: the value is a diagnostic.
    """
    if isinstance(value, Diagnostic):
        raise Refusal((value,))
    return value


def bounded(function: Callable[P, R]) -> Callable[P, R]:
    """Make the function raise `Refusal` if its input is too large or nested too deeply."""

    @functools.wraps(function)
    def refusing(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return function(*args, **kwargs)
        except ExceededError as error:
            raise Refusal((exceeded(error),)) from None
        except RecursionError:
            raise Refusal((diagnostic("api_expression_too_deep"),)) from None

    return refusing
