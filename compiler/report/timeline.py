"""What happened when, as a picture with few elements, whatever the length of the run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from compiler.evidence import Moment, Result, Violation
from compiler.report.phrases import joined, seconds, times
from compiler.report.views import Lane, SpanMark, Timeline

DETAIL = 400
"""Two marks nearer than this part of the picture are drawn as one: that bounds their number."""
_DRAWN = 12
"""Violations that get a picture of their own."""
_AROUND = 10
"""Ticks to show before and after a violation, at least."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """From `start` to `end`, in seconds."""

    start: float
    end: float


def timelines(result: Result, tick: float) -> tuple[Timeline, ...]:
    """One for each of the first violations; where there is none, one for the whole run.

    Args:
        result: one run, one requirement.
        tick: seconds of a tick; an average where the clock ticks by message.
    """
    if not result.ticks:
        return ()
    events = _Events(result, tick)
    if not result.violations:
        return (events.timeline("The whole run", Stretch(0.0, result.ticks * tick)),)
    return tuple(
        events.timeline(f"Violation {number}", _around(violation, tick))
        for number, violation in enumerate(result.violations[:_DRAWN], 1)
    )


def _around(violation: Violation, tick: float) -> Stretch:
    first = violation.trigger or violation.first
    start, end = min(first.seconds, violation.first.seconds), violation.last.seconds + tick
    margin = max(_AROUND * tick, (end - start) / 8, 1e-3)
    return Stretch(max(0.0, start - margin), max(end, start) + margin)


class _Events:
    """The events of a result as stretches of time, by their lanes."""

    def __init__(self, result: Result, tick: float) -> None:
        self.lanes: list[tuple[str, str, list[Stretch]]] = [
            ("triggered", "trigger", _ticks(result.triggers, tick)),
            ("waiting", "waiting", _waiting(result)),
            ("violated", "violated", [_violated(v, tick) for v in result.violations]),
            (
                "unknown",
                "unknown",
                [Stretch(first * tick, (last + 1) * tick) for first, last in result.unknown],
            ),
            ("open at end", "open", _open(result, tick)),
        ]

    def timeline(self, title: str, window: Stretch) -> Timeline:
        lanes = [_lane(name, kind, events, window) for name, kind, events in self.lanes]
        shown = tuple(lane for lane in lanes if lane.marks or lane.kind == "trigger")
        return Timeline(title, window.start, window.end, shown, _in_words(shown, window))


def _ticks(moments: Iterable[Moment], tick: float) -> list[Stretch]:
    return [Stretch(moment.seconds, moment.seconds + tick) for moment in moments]


def _waiting(result: Result) -> list[Stretch]:
    return [
        Stretch(trigger.seconds, trigger.seconds + latency)
        for trigger, latency in answered(result)
        if latency > 0
    ]


def answered(result: Result) -> list[tuple[Moment, float]]:
    """Each trigger that was answered with its latency; empty where that cannot be told."""
    still_open = {moment.tick for moment in result.open}
    closed = [trigger for trigger in result.triggers if trigger.tick not in still_open]
    if len(closed) != len(result.latencies):
        return []
    return list(zip(closed, result.latencies, strict=True))


def _violated(violation: Violation, tick: float) -> Stretch:
    start = violation.first.seconds
    return Stretch(start, max(start, violation.last.seconds) + tick)


def _open(result: Result, tick: float) -> list[Stretch]:
    end = result.ticks * tick
    return [Stretch(m.seconds, max(m.seconds + tick, end)) for m in result.open]


def _lane(name: str, kind: str, events: Sequence[Stretch], window: Stretch) -> Lane:
    inside = sorted(
        (max(event.start, window.start), min(event.end, window.end))
        for event in events
        if event.end > window.start and event.start < window.end
    )
    nearest = (window.end - window.start) / DETAIL
    marks: list[SpanMark] = []
    for start, end in inside:
        if marks and start - marks[-1].end < nearest:
            last = marks[-1]
            marks[-1] = SpanMark(last.start, max(last.end, end), last.count + 1)
        else:
            marks.append(SpanMark(start, end, 1))
    return Lane(name, kind, tuple(_rounded(mark) for mark in marks))


def _rounded(mark: SpanMark) -> SpanMark:
    return SpanMark(round(mark.start, 6), round(mark.end, 6), mark.count)


_WORDS = {
    "trigger": ("tick with a trigger", "ticks with a trigger"),
    "waiting": ("trigger waiting for its response", "triggers waiting for their response"),
    "violated": ("violation", "violations"),
    "unknown": ("stretch of unknown ticks", "stretches of unknown ticks"),
    "open": ("demand open at the end", "demands open at the end"),
}
_NAMED = 3
"""Stretches of a lane that are named one by one."""


def _in_words(lanes: Sequence[Lane], window: Stretch) -> str:
    what = [_lane_in_words(lane) for lane in lanes]
    return f"From {seconds(window.start)} to {seconds(window.end)}: {joined(what)}."


def _lane_in_words(lane: Lane) -> str:
    one, many = _WORDS[lane.kind]
    count = sum(mark.count for mark in lane.marks)
    if not count:
        return f"no {one}"
    named = [f"{seconds(m.start)} to {seconds(m.end)}" for m in lane.marks[:_NAMED]]
    more = len(lane.marks) - len(named)
    rest = [times(more, "later stretch", "later stretches")] if more else []
    return f"{times(count, one, many)} ({joined([*named, *rest])})"
