"""The time of an interval of ticks, and its words; all outputs use them.

A tick lasts until the next one: an interval begins with its first tick and ends with the tick after
its last one. Where the clock ticks by message, evidence does not have the time of that tick.
"""

from __future__ import annotations

from compiler.files.records import Count, Record, Seconds, Whole
from fretish.bindings.amounts import duration, seconds
from fretish.clock import period_of


class Moment(Record, frozen=True):
    """A tick with its time: `ns` on the clock of the log, `seconds` from the first tick."""

    tick: Count
    ns: Whole
    seconds: Seconds


class TickInterval(Record, frozen=True):
    """An interval of ticks with their times, as in `Moment`."""

    first_tick: Count
    last_tick: Count
    start_ns: Whole
    end_ns: Whole
    start_s: Seconds
    end_s: Seconds

    @property
    def first(self) -> Moment:
        """The first tick."""
        return Moment(self.first_tick, self.start_ns, self.start_s)

    @property
    def last(self) -> Moment:
        """The last tick."""
        return Moment(self.last_tick, self.end_ns, self.end_s)


def end_ns(last: Moment, clock: str) -> int | None:
    """The end of an interval in nanoseconds of the log; None: the clock ticks by message.

    Args:
        last: its last tick.
        clock: the clock, in the words of evidence.
    """
    period = period_of(clock)
    return None if period is None else last.ns + period


def end_s(last: Moment, clock: str) -> float | None:
    """The end of an interval, in seconds from the first tick; None as for `end_ns`."""
    period = period_of(clock)
    return None if period is None else round(last.seconds + period / 1e9, 9)


def interval_words(first: Moment, last: Moment, clock: str) -> str:
    """`from 13.2 s to 13.5 s (300 ms)`.

    Where the clock ticks by message, `from the message at 3 s to the one at 5 s`.

    Args:
        first: its first tick.
        last: its last tick.
        clock: the clock, in the words of evidence.
    """
    end = end_s(last, clock)
    if end is not None:
        return f"from {seconds(first.seconds)} to {seconds(end)} ({interval_length(first, end)})"
    if first.tick == last.tick:
        return f"at the message at {seconds(first.seconds)}"
    return f"from the message at {seconds(first.seconds)} to the one at {seconds(last.seconds)}"


def interval_length(first: Moment, end: float) -> str:
    """The duration of an interval: `300 ms`.

    Args:
        first: its first tick.
        end: its end, in seconds from the first tick of the run.
    """
    return duration(round(end - first.seconds, 9))
