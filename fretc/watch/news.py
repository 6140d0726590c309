"""What a watch has to tell, each as it happens."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fretc.watch.sources.source import Interrupted, Missed, Opened, Reconnected
from fretish.diagnostics.diagnostic import Diagnostic
from monitors.guard import State


@dataclass(frozen=True, slots=True)
class Changed:
    """Something of a requirement is otherwise than it was."""

    state: State
    before: State | None
    time: int
    """The latest time of all messages, on the declared clock."""


@dataclass(frozen=True, slots=True)
class Late:
    """Ticks that were judged have become unknown: messages were late for them."""

    ticks: int
    """All of the run so far."""
    messages: Mapping[str, int]
    """Of each topic the messages of the run that were late."""


@dataclass(frozen=True, slots=True)
class Found:
    """What a user should know; the watch goes on."""

    diagnostic: Diagnostic


@dataclass(frozen=True, slots=True)
class RunEnded:
    """A run has ended, and perhaps another one begins."""

    number: int
    """From 1 on."""
    verdicts: Mapping[str, str]
    recording: str | None
    """The file that holds it."""
    ticks: int


News = Changed | Late | Found | RunEnded | Opened | Interrupted | Reconnected | Missed
