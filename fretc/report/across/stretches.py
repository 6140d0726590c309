"""The intervals of a run at which a requirement was violated, unknown or open."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable

from fretc.audit.evidence.result_summaries import audited_s, undecided_ticks
from fretc.audit.evidence.schema import Result
from fretish.classes.frozen import dataclass

Span = tuple[float, float]
"""Start and end, in seconds from the first tick of a run."""


@dataclass(frozen=True, slots=True)
class Stretches:
    """The intervals of one run at which a requirement was violated, unknown or open.

    A tick lasts until the next one. Where the clock ticks by message, ends of ticks of which the
    evidence has no time lie evenly between those of which it has one.
    """

    length: float
    """Seconds from the first tick to the end of the last one."""
    violations: tuple[Span, ...]
    unknown: tuple[Span, ...]
    open: tuple[float, ...]
    """The triggers whose demand is open at the end."""


def stretches(result: Result) -> Stretches:
    """The intervals at which a result is violated, unknown or open."""
    undecided = undecided_ticks(result)
    if not (result.violations or undecided or result.open):
        return Stretches(_length(result), (), (), ())
    at = _seconds(result)
    return Stretches(
        length=at(result.ticks),
        violations=tuple(
            (v.start_s, max(v.start_s, at(v.last_tick + 1))) for v in result.violations
        ),
        unknown=tuple((at(first), at(last + 1)) for first, last in undecided),
        open=tuple(moment.seconds for moment in result.open),
    )


def _seconds(result: Result) -> Callable[[int], float]:
    """The time at which a tick begins; for an index after the last tick, the end of that tick."""
    moments = [*result.triggers, *result.open, *(v.first for v in result.violations)]
    moments += [v.last for v in result.violations]
    times = {0: 0.0} | {moment.tick: moment.seconds for moment in moments}
    times |= {state.tick: state.seconds for state in result.states}
    times |= {one.first_tick: one.start_s for one in result.unknown_inputs or ()}
    times |= {one.last_tick: one.end_s for one in result.unknown_inputs or ()}
    times |= {answer.tick: answer.seconds for answer in result.answers}
    known_ticks = sorted(times)
    rate = times[known_ticks[-1]] / known_ticks[-1] if known_ticks[-1] else _mean_tick(result)

    def at(tick: int) -> float:
        index = bisect_right(known_ticks, tick) - 1
        before = known_ticks[index]
        if before == tick:
            return times[tick]
        if index + 1 == len(known_ticks):
            return round(times[before] + (tick - before) * rate, 9)
        after = known_ticks[index + 1]
        share = (tick - before) / (after - before)
        return round(times[before] + (times[after] - times[before]) * share, 9)

    return at


def _length(result: Result) -> float:
    """The end of the last tick, for a result without intervals."""
    last = [events[-1] for events in (result.triggers, result.states, result.answers) if events]
    last_event = max(last, key=lambda event: event.tick, default=None)
    if last_event is None or not last_event.tick:
        return round(result.ticks * _mean_tick(result), 9)
    return round(
        last_event.seconds
        + (result.ticks - last_event.tick) * (last_event.seconds / last_event.tick),
        9,
    )


def _mean_tick(result: Result) -> float:
    """The mean length of a tick in seconds, if only the length of the run is known."""
    return (audited_s(result) or 0.0) / result.ticks if result.ticks else 0.0
