"""The history of an interceptor's messages, and what it demands.

It is independent of the way in which a core stores its history.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from monitors.interceptor import Options

STOP, RELEASE, COMMAND, SCAN, RING = (
    "a stop is requested",
    "no stop is requested",
    "a command comes",
    "a scan comes",
    "the timer expires",
)
"""The events, as the beginnings of a trace's actions."""


CHANNELS = (
    ("stop", "the safety function"),
    ("scan", "the sensor"),
    ("command", "the planner"),
)


class EventHistory(NamedTuple):
    """Facts about all events up to now; durations in ticks."""

    requested: bool
    """Whether the last message of the safety function requests a stop."""
    ever: bool
    hold_pending: int
    """Ticks for which zero must still be published after the last request."""
    stop: int
    """Ticks since the last message of the safety function, at most the timeout; likewise below."""
    scan: int
    command: int
    last: Any
    """The last command; None: there was none."""


class ContractStep(NamedTuple):
    """One step, as contracts evaluate it."""

    before: EventHistory
    event: str
    """The event; empty before the first step."""
    after: EventHistory
    output: str
    """`nothing`, `zero`, `last` (the last command, which may be the present one) or `other`."""
    state: Any
    """State of the core after the step."""


def first(options: Options) -> EventHistory:
    """The history before the first event: each channel with a timeout is silent."""
    return EventHistory(
        requested=False,
        ever=False,
        hold_pending=0,
        stop=options.stop_timeout,
        scan=options.scan_timeout,
        command=options.command_timeout,
        last=None,
    )


def after(history: EventHistory, event: str, command: object, options: Options) -> EventHistory:
    """The history after one more event; `command` belongs to `COMMAND`."""
    match event:
        case "a stop is requested":
            return history._replace(requested=True, ever=True, hold_pending=options.hold, stop=0)
        case "no stop is requested":
            return history._replace(requested=False, stop=0)
        case "a command comes":
            return history._replace(command=0, last=command)
        case "a scan comes":
            return history._replace(scan=0)
    if options.event_driven:
        return history
    return history._replace(
        hold_pending=max(history.hold_pending - 1, 0),
        stop=min(history.stop + 1, options.stop_timeout),
        scan=min(history.scan + 1, options.scan_timeout),
        command=min(history.command + 1, options.command_timeout),
    )


def stands(history: EventHistory, options: Options) -> bool:
    """Whether there is a reason for zero: a stop, an earlier stop, or silence."""
    return (
        history.requested
        or history.hold_pending > 0
        or (options.latching and history.ever)
        or history.stop >= options.stop_timeout > 0
        or history.scan >= options.scan_timeout > 0
        or history.command >= options.command_timeout > 0
    )
