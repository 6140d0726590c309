"""The timeline of a result, with a bounded number of elements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import floor, log10
from types import MappingProxyType

from compiler.formalization.formalized import FormalizedRequirement
from fretc.audit.evidence.schema import Moment, Result, Violation
from fretc.audit.measurements.intervals import interval_words
from fretc.report.model.causes import causes, falsity, in_words
from fretc.report.model.phrases import duration, joined, seconds, times, value
from fretc.report.model.pictures import Lane, NamedInstant, Panel, SpanMark, Timeline, WordLane
from fretc.report.pictures.first_tick import reading
from fretc.report.pictures.signals import left_out, panels, persistences, word_lanes
from fretish.classes.frozen import dataclass

DETAIL = 400
"""Marks nearer than 1/400 of the picture are merged, which bounds their number."""
DRAWN = 6
"""Maximum number of violations of one result with a picture; the report lists the others."""
_AROUND = 10
"""Minimum number of ticks before and after a violation."""
_INPUTS = 4
"""Maximum number of lanes of unknown inputs."""
_UNKNOWN = "unknown"
"""The kind of lanes of unknown stretches, and the name of that of the requirement itself."""
_MARGIN = 2.0
"""Minimum seconds before and after a violation."""
_LONGEST = 20.0
"""Maximum seconds of a violation in its picture."""


@dataclass(frozen=True, slots=True)
class TimeInterval:
    """From `start` to `end`, in seconds."""

    start: float
    end: float


def timelines(
    result: Result,
    tick: float,
    ages: Mapping[str, float] = MappingProxyType({}),
    requirement: FormalizedRequirement | None = None,
) -> tuple[Timeline, ...]:
    """A timeline for each of the first violations; without violations, one for the whole run.

    Args:
        result: one run, one requirement.
        tick: seconds of a tick; an average if ticks are messages.
        ages: age limit of each signal in seconds; a signal without one has no limit.
        requirement: the requirement that was judged; None if unknown.
    """
    if not result.ticks:
        return ()
    events = _Events(result, tick)
    if not result.violations:
        return (events.timeline("The whole run", TimeInterval(0.0, result.ticks * tick)),)
    return tuple(
        _explained(
            events.timeline(f"Violation {number}", stretch),
            violation,
            result,
            tick,
            ages,
            requirement,
        )
        for number, violation in enumerate(result.violations[:DRAWN], 1)
        for stretch in [_around(violation, tick)]
    )


def _explained(
    plain: Timeline,
    violation: Violation,
    result: Result,
    tick: float,
    ages: Mapping[str, float],
    requirement: FormalizedRequirement | None,
) -> Timeline:
    """The timeline with signals, trigger, deadline, the violating stretch, and the cause."""
    drawings = panels(violation, result, ages, plain.start, plain.end, persistences(requirement))
    lanes = word_lanes(violation, ages, plain.start, plain.end)
    broken = _violated(violation, tick)
    why = cause(violation, result, ages, requirement)
    hidden = left_out(violation, drawings, lanes)
    is_cut = broken.end > plain.end + tick / 2
    sentences = [
        why,
        plain.text,
        f"The violation goes on to {seconds(broken.end)}." if is_cut else "",
        *(_panel_in_words(panel) for panel in drawings if not panel.is_enlarged),
        *(_signal_in_words(lane) for lane in lanes),
        f"Not drawn: {joined(hidden)}." if hidden else "",
    ]
    return replace(
        plain,
        text=" ".join(filter(None, sentences)),
        panels=drawings,
        words=lanes,
        flags=tuple(flag for flag in _flags(violation) if plain.start <= flag.at <= plain.end),
        broken=_rounded(SpanMark(broken.start, broken.end, 1)),
        cause=why,
        continues=round(broken.end, 6) if is_cut else None,
        epoch_ns=violation.start_ns - round(violation.start_s * 1e9),
    )


def _flags(violation: Violation) -> Iterable[NamedInstant]:
    for kind, moment in (("trigger", violation.trigger), ("deadline", violation.deadline)):
        if moment is not None:
            yield NamedInstant(kind, round(moment.seconds, 6))


def cause(
    violation: Violation,
    result: Result,
    ages: Mapping[str, float],
    requirement: FormalizedRequirement | None = None,
) -> str:
    """The cause of a violation: the missing response, why it was missing, what agents believed.

    If the evidence leaves the reason open, the values of the signals at that tick.
    """
    believed = (f"{belief.in_words()}." for belief in violation.beliefs or ())
    return " ".join([_cause(violation, result, ages, requirement), *believed])


def _cause(
    violation: Violation,
    result: Result,
    ages: Mapping[str, float],
    requirement: FormalizedRequirement | None,
) -> str:
    what = falsity(violation, result, requirement) or _missing(violation, result)
    at = seconds(violation.first.seconds)
    reasons = causes(violation, result, requirement)
    if reasons:
        return f"{what}: at {at} {in_words(reasons)}."
    values = [
        f"{name} was {reading(name, violation, result, ages)}" for name in sorted(violation.values)
    ]
    return f"{what}; at {at} {joined(values)}." if values else f"{what}."


def _missing(violation: Violation, result: Result) -> str:
    missing = violation.missing or "the response"
    if violation.deadline is not None:
        what = f"`{missing}` was not true by {seconds(violation.deadline.seconds)}"
    else:
        what = (
            f"`{missing}` was false {interval_words(violation.first, violation.last, result.clock)}"
        )
    if violation.trigger is not None:
        what += f", triggered at {seconds(violation.trigger.seconds)}"
    return what


def _panel_in_words(panel: Panel) -> str:
    points = [point for piece in panel.pieces for point in piece.points]
    levels = [level.label for level in panel.levels if level.label]
    parts = [
        f"{panel.signal} {_extent(points, panel)}",
        f"threshold {joined(levels)}" if levels else "",
        f"unknown for {_total([(m.start, m.end) for m in panel.unknown])}" if panel.unknown else "",
        f"infinite for {_total([(a, b) for a, b, _ in panel.infinite])}" if panel.infinite else "",
    ]
    return f"{', '.join(filter(None, parts))}."


def _signal_in_words(lane: WordLane) -> str:
    """`mode is "drive", "docking" and unknown.`: each word once, in the order in which it came."""
    words = dict.fromkeys("unknown" if word is None else f'"{word}"' for _, _, word in lane.words)
    return f"{lane.signal} is {joined(list(words))}." if words else ""


def _extent(points: Sequence[tuple[float, float, float]], panel: Panel) -> str:
    if not points:
        return "has no finite value"
    digits = 3 - floor(log10(panel.high - panel.low))  # This is finer than can be drawn.
    least, greatest = (
        round(number, digits)
        for number in (min(point[1] for point in points), max(point[2] for point in points))
    )
    if least == greatest:
        return f"is {value(least, panel.unit)}"
    return f"is {value(least, panel.unit)} to {value(greatest, panel.unit)}"


def _total(stretches: Sequence[tuple[float, float]]) -> str:
    return duration(sum(end - start for start, end in stretches))


def _around(violation: Violation, tick: float) -> TimeInterval:
    """The time from the trigger, if it is the start of a deadline or near, to the end.

    A picture of a long violation ends a margin after its first tick.
    """
    broken, trigger = violation.first.seconds, violation.trigger
    margin = max(_AROUND * tick, _MARGIN)
    start = broken
    if trigger and (violation.deadline or broken - trigger.seconds <= margin):
        start = min(trigger.seconds, broken)
    margin = max(margin, (broken - start) / 8)
    end = min(max(broken, violation.last.seconds) + tick, broken + _LONGEST)
    stretch = TimeInterval(max(0.0, start - margin), end + margin)
    window = violation.window
    if window is None or not (window.samples or window.words):
        return stretch
    # The evidence has no samples outside the window, and without samples it would look unknown.
    inside = TimeInterval(max(stretch.start, window.start), min(stretch.end, window.end))
    return inside if inside.end - inside.start > tick / 2 else stretch


class _Events:
    """The events of a result as time intervals, by lane."""

    def __init__(self, result: Result, tick: float) -> None:
        self.lanes: list[tuple[str, str, list[TimeInterval]]] = [
            (
                "triggered",
                "trigger",
                [TimeInterval(m.seconds, m.seconds + tick) for m in result.triggers],
            ),
            ("waiting", "waiting", _waiting(result)),
            ("violated", "violated", [_violated(v, tick) for v in result.violations]),
            (
                _UNKNOWN,
                _UNKNOWN,
                [TimeInterval(first * tick, (last + 1) * tick) for first, last in result.unknown],
            ),
            *_unknown_inputs(result, tick),
            ("open at end", "open", _open(result, tick)),
        ]

    def timeline(self, title: str, window: TimeInterval) -> Timeline:
        lanes = [_lane(name, kind, events, window) for name, kind, events in self.lanes]
        visible = tuple(lane for lane in lanes if lane.marks or lane.kind == "trigger")
        return Timeline(title, window.start, window.end, visible, _in_words(visible, window))


def _unknown_inputs(result: Result, tick: float) -> Iterator[tuple[str, str, list[TimeInterval]]]:
    """A lane for each of the first propositions that were unknown, and one for all others."""
    names = dict.fromkeys(one.proposition for one in result.unknown_inputs or ())
    own = list(names) if len(names) <= _INPUTS else list(names)[: _INPUTS - 1]
    for name in dict.fromkeys([*own, *(["other inputs"] if len(own) < len(names) else [])]):
        yield (
            name,
            _UNKNOWN,
            [
                TimeInterval(one.start_s, one.end_s + tick)
                for one in result.unknown_inputs or ()
                if (one.proposition if one.proposition in own else "other inputs") == name
            ],
        )


def _waiting(result: Result) -> list[TimeInterval]:
    return [
        TimeInterval(trigger.seconds, trigger.seconds + latency)
        for trigger, latency in answered(result)
        if latency > 0
    ]


def answered(result: Result) -> list[tuple[Moment, float]]:
    """Each answered trigger with its latency; empty if they cannot be matched."""
    still_open = {moment.tick for moment in result.open}
    closed = [trigger for trigger in result.triggers if trigger.tick not in still_open]
    if len(closed) != len(result.latencies):
        return []
    return list(zip(closed, result.latencies, strict=True))


def _violated(violation: Violation, tick: float) -> TimeInterval:
    start = violation.first.seconds
    return TimeInterval(start, max(start, violation.last.seconds) + tick)


def _open(result: Result, tick: float) -> list[TimeInterval]:
    end = result.ticks * tick
    return [TimeInterval(m.seconds, max(m.seconds + tick, end)) for m in result.open]


def _lane(name: str, kind: str, events: Sequence[TimeInterval], window: TimeInterval) -> Lane:
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
    "unknown": ("interval of unknown ticks", "intervals of unknown ticks"),
    "open": ("obligation open at the end", "obligations open at the end"),
}
_NAMED = 3
"""Maximum number of intervals of a lane that the text names."""


def _in_words(lanes: Sequence[Lane], window: TimeInterval) -> str:
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
    what = times(count, one, many)
    if lane.kind == _UNKNOWN and lane.name != _UNKNOWN:
        what = f"`{lane.name}` unknown"
    return f"{what} ({joined([*named, *rest])})"
