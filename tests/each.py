"""Many small cases in one test: a test of its own for each would take longer than the case."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable
from typing import Any


def each(name: str, cases: Iterable[Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Call the test with each case, as `pytest.mark.parametrize` does; a failure names its case."""
    cases = tuple(cases)
    assert cases, "no case"

    def over(test: Callable[..., None]) -> Callable[..., None]:
        @functools.wraps(test)
        def every(**fixtures: Any) -> None:
            for case in cases:
                try:
                    test(**fixtures, **{name: case})
                except BaseException as error:
                    error.add_note(f"where {name} is {case!r}")
                    raise

        signature = inspect.signature(test)
        others = [p for p in signature.parameters.values() if p.name != name]
        assert len(others) < len(signature.parameters), name
        every.__signature__ = signature.replace(parameters=others)  # type: ignore[attr-defined]
        return every

    return over
