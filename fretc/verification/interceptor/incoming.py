"""The messages that came in to an interceptor, and what they demand.

Nothing here knows how a core keeps them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from monitors.interceptor import Options

STOP, RELEASE, COMMAND, SCAN, RING = (
    "a stop is requested",
    "no stop is requested",
    "a command comes",
    "a scan comes",
    "the timer rings",
)
"""What can come in, as the actions of a trace begin."""


CHANNELS = (
    ("stop", "the safety function"),
    ("scan", "the sensor"),
    ("command", "the planner"),
)


class Seen(NamedTuple):
    """What has come in up to now; durations in ticks."""

    requested: bool
    """By the last message of the safety function."""
    ever: bool
    owed: int
    """Ticks for which zero must still be said after the last request."""
    stop: int
    """Ticks since the safety function was heard, no more than the timeout; the others likewise."""
    scan: int
    command: int
    last: Any
    """The last command; None: there was none."""


class Moment(NamedTuple):
    """One step, as contracts look at it."""

    before: Seen
    heard: str
    after: Seen
    said: str
    """`nothing`, `zero`, `last` (the last command, which may just have come) or `other`."""
    state: Any
    """The core's, after the step."""


def first(options: Options) -> Seen:
    """Nothing was heard: what is watched is silent."""
    return Seen(
        requested=False,
        ever=False,
        owed=0,
        stop=options.stop_timeout,
        scan=options.scan_timeout,
        command=options.command_timeout,
        last=None,
    )


def after(seen: Seen, heard: str, command: object, options: Options) -> Seen:
    """The same once one more is heard; `command` is what comes with `COMMAND`."""
    match heard:
        case "a stop is requested":
            return seen._replace(requested=True, ever=True, owed=options.hold, stop=0)
        case "no stop is requested":
            return seen._replace(requested=False, stop=0)
        case "a command comes":
            return seen._replace(command=0, last=command)
        case "a scan comes":
            return seen._replace(scan=0)
    if options.event_driven:
        return seen
    return seen._replace(
        owed=max(seen.owed - 1, 0),
        stop=min(seen.stop + 1, options.stop_timeout),
        scan=min(seen.scan + 1, options.scan_timeout),
        command=min(seen.command + 1, options.command_timeout),
    )


def stands(seen: Seen, options: Options) -> bool:
    """Whether there is a reason for zero: of a stop, of one before, of silence."""
    return (
        seen.requested
        or seen.owed > 0
        or (options.latching and seen.ever)
        or seen.stop >= options.stop_timeout > 0
        or seen.scan >= options.scan_timeout > 0
        or seen.command >= options.command_timeout > 0
    )
