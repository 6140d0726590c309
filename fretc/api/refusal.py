"""The one exception of the API: why something could not be done."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from typing import ParamSpec, TypeVar

from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.rendering import render_all
from fretish.reading.limits import ExceededError, exceeded
from fretish.reading.natural_order import by_place

P = ParamSpec("P")
R = TypeVar("R")


class Refusal(Exception):  # noqa: N818 - as its users speak of it
    """The input is not what it must be.

    Its text has for each diagnostic the code, the place with a caret, and what to do.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        super().__init__(self.diagnostics)

    def __str__(self) -> str:
        """What the command would print."""
        return render_all(by_place(self.diagnostics))


def accepted(value: R | Diagnostic) -> R:
    """The value, where there is one.

    Raises:
        Refusal: there is none.
    """
    if isinstance(value, Diagnostic):
        raise Refusal((value,))
    return value


def bounded(function: Callable[P, R]) -> Callable[P, R]:
    """Let the function raise `Refusal` where its input costs too much to read, or is too deep."""

    @functools.wraps(function)
    def refusing(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return function(*args, **kwargs)
        except ExceededError as error:
            raise Refusal((exceeded(error),)) from None
        except RecursionError:
            raise Refusal((too_deep(),)) from None

    return refusing


def too_deep() -> Diagnostic:
    """An expression of more levels than Python can follow."""
    return Diagnostic(
        Code.TOO_DEEP,
        "an expression has too many nested operators",
        help="give parts of it names of their own",
    )
