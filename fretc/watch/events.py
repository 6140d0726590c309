"""The events that a watch reports."""

from __future__ import annotations

from collections.abc import Mapping

from fretc.watch.sources.source import ConnectionLost, Missed, Opened, Reconnected
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from monitors.stop_supervisor import State


@dataclass(frozen=True, slots=True)
class StateChange:
    """The state of a requirement has changed."""

    state: State
    before: State | None
    time: int
    """The latest time of all messages, on the declared clock."""


@dataclass(frozen=True, slots=True)
class LateMessages:
    """Judged ticks have become unknown, because messages were late for them."""

    ticks: int
    """The number of ticks in the run so far."""
    messages: Mapping[str, int]
    """For each topic, the late messages of the run so far."""


@dataclass(frozen=True, slots=True)
class DiagnosticEvent:
    """A diagnostic for the user; the watch continues."""

    diagnostic: Diagnostic


@dataclass(frozen=True, slots=True)
class RunEnded:
    """A run has ended, and possibly another one begins."""

    number: int
    """Counted from 1."""
    verdicts: Mapping[str, str]
    recording: str | None
    """The file with the recording."""
    ticks: int


WatchEvent = (
    StateChange
    | LateMessages
    | DiagnosticEvent
    | RunEnded
    | Opened
    | ConnectionLost
    | Reconnected
    | Missed
)
