"""Many small cases in one test: a test of its own for each would take longer than the case.

pytest's own `subtests` would report each case by itself, too, and cost as much as a test.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable
from typing import Any


def each(name: str, cases: Iterable[Any]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Call the test with each case, as `pytest.mark.parametrize` does.

    Every case is tried, and each one that fails is reported with its name.
    """
    cases = tuple(cases)
    assert cases, "no case"

    def over(test: Callable[..., None]) -> Callable[..., None]:
        @functools.wraps(test)
        def every(**fixtures: Any) -> None:
            failures = []
            for case in cases:
                try:
                    test(**fixtures, **{name: case})
                except Exception as error:
                    error.add_note(f"where {name} is {case!r}")
                    failures.append(error)
                except BaseException as error:  # a skip, or Ctrl-C
                    error.add_note(f"where {name} is {case!r}")
                    raise
            if len(failures) > 1:
                raise ExceptionGroup(f"{len(failures)} of {len(cases)} cases", failures)
            if failures:
                raise failures[0]

        signature = inspect.signature(test)
        others = [p for p in signature.parameters.values() if p.name != name]
        assert len(others) < len(signature.parameters), name
        every.__signature__ = signature.replace(parameters=others)  # type: ignore[attr-defined]
        return every

    return over
