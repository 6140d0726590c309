"""Commands work in this process alone, but in tests that are `confined`."""

from collections.abc import Callable, Generator, Sequence
from typing import Any

import pytest

from fretc.audit import pool
from fretc.verification.engines import sandbox


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    """A new process takes a quarter of a second; to fork this large one, more than a small audit.

    Limits of time need a process, and have one. That calls can be sent, some tests show.
    """

    def direct(session: object, function: Callable[..., Any], *args: Any) -> Any:
        return function(*args)

    shared = pool._shared

    def here(
        function: Callable[[Any], Any],
        things: Sequence[Any],
        places: Sequence[int],
        jobs: int,
        clock: pool._Clock,
    ) -> Generator[tuple[int, Any], None, None]:
        if clock.patience([0.0]) is not None:
            yield from shared(function, things, places, jobs, clock)
            return
        for place in places:
            yield place, function(things[place])

    if "confined" not in request.keywords:
        monkeypatch.setattr(sandbox.Session, "call", direct)
        monkeypatch.setattr(pool, "_shared", here)
