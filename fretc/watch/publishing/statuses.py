"""The statuses of a session, with the levels of emitted nodes (`monitors/stop_supervisor.py`)."""

from __future__ import annotations

from collections.abc import Collection

from fretc.watch.session import Session
from monitors.stop_supervisor import OK, STALE, State, Status, status, status_of

SOURCES = "sources"
"""The name of the status of the source."""


def statuses(
    session: Session,
    states: Collection[State],
    violated: Collection[str],
) -> list[Status]:
    """A status of the source, and one for each requirement.

    Args:
        session: the present run.
        states: the states of its requirements.
        violated: the requirements that were violated in earlier runs.
    """
    silent = {name for name, topic in session.topics.items() if not topic.count}

    def fault(topics: Collection[str]) -> str:
        """The reason why the source is not reliable; empty: it is."""
        if session.interrupted:
            return "the source is not connected"
        return "; ".join(f"no message of {topic} yet" for topic in topics if topic in silent)

    wrong = fault(session.topics)
    values: dict[str, object] = {
        f"messages of {name}": topic.count for name, topic in session.topics.items()
    }
    values |= {"ticks": session.ticks, "ticks that became unknown": session.late_ticks}
    sources = status(STALE if wrong else OK, SOURCES, wrong or "all come", values)
    own = (
        status_of(
            state, fault(session.reads[state.requirement]), violated=state.requirement in violated
        )
        for state in states
    )
    return [sources, *own]
