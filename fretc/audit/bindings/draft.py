"""A draft of `bindings.toml`: the signals of a log, and what the requirements still need.

It is text for a person to edit. What is known of a message's type is written out; every other
number or text stands there as a comment. Times are nanoseconds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import gcd

from compiler.files.build_id import __version__
from compiler.files.templating import render
from fretc.audit.bindings.candidates import (
    Candidate,
    Candidates,
    Need,
    Similarity,
    candidates,
    ranges,
)
from fretc.audit.bindings.draft_signals import (
    DraftedSignal,
    TopicDraft,
    bindable_fields,
    drafted_signals,
    period_of,
    round_number,
    rounded,
    topic_drafts,
)
from fretc.audit.bindings.needs import MissingProposition, MissingSignal
from fretc.logs.messages.leaves import FieldKind
from fretc.logs.reader import Overview
from fretish.clock import in_words

_ONE = 1.5
"""A fraction above it, also with an error of measurement, is a percentage."""
_TICK = 100 * 10**6
"""Nanoseconds of a tick if no topic has a rate."""
_FAST = 220 * 10**6
"""The longest period, in nanoseconds, of a topic that determines the tick; samples of slower topics
are held."""
_SHORTEST = 10**6
"""The shortest tick, in nanoseconds."""


def draft(
    overview: Overview,
    missing: Sequence[MissingProposition],
    durations: Sequence[int] = (),
    unread: Sequence[MissingSignal] = (),
    clocked_by: str = "",
    topics: Sequence[TopicDraft] | None = None,
) -> str:
    """The text of a `bindings.toml`.

    With nothing missing it can be read as it is. A name that a field of the log bears is bound to
    it; every other name is an error until a person has edited it.

    Args:
        overview: the summary of a log, with the texts of its fields.
        missing: propositions that sentences use and no bindings define.
        durations: durations of the sentences in nanoseconds; each is a whole number of ticks.
        unread: signals that sentences compare and no bindings declare.
        clocked_by: the topic that sets the tick; empty: those of the names that sentences use, or
            else those of all signals.
        topics: what `draft_of_topics` gives, if a caller drafts twice; None: it is called here.
    """
    topics = draft_of_topics(overview) if topics is None else topics
    signals = [signal for topic in topics for signal in topic.signals]
    known = {signal.name for signal in signals}
    needs: list[Need] = [*unread, *missing]
    wanted = candidates(overview, (each for each in needs if each.name not in known))
    fields = {each.need.name: each for each in wanted}
    chosen = [each.chosen.signal for each in fields.values() if each.chosen]
    timed = [clocked_by] if clocked_by else [each.topic for each in chosen or signals]
    tick, why = _dividing(*_tick(overview, timed), durations)
    return render(
        "bindings/bindings.toml.j2",
        version=__version__,
        log=overview.recording.name,
        tick=in_words(tick),
        why=why,
        topics=topics,
        missing=missing,
        unread=[each for each in unread if each.name not in known],
        bound={signal.path for signal in chosen},
        example=_example(overview, [*chosen, *signals]),
        **_of_fields(overview, fields, [*chosen, *signals]),
    )


def addition(
    overview: Overview, missing: Sequence[MissingProposition], unread: Sequence[MissingSignal]
) -> str:
    """The tables that existing bindings lack, as text to append to them.

    Args:
        overview: the summary of a log, with the texts of its fields.
        missing: propositions that sentences use and no bindings define.
        unread: signals that sentences compare and no bindings declare.
    """
    known = {signal.name: signal for signal in drafted_signals(overview)}
    needs: list[Need] = [*unread, *missing]
    fields = {each.need.name: each for each in candidates(overview, needs)}
    for need in needs:
        if need.name in known:
            candidate = Candidate(known[need.name], Similarity.SAME_NAME, is_unit_assumed=False)
            fields[need.name] = Candidates(need, candidate, ())
    chosen = [each.chosen.signal for each in fields.values() if each.chosen]
    return render(
        "bindings/needs.toml.j2",
        missing=missing,
        unread=unread,
        example=_example(overview, chosen),
        **_of_fields(overview, fields, chosen),
    )


def _of_fields(
    overview: Overview, fields: Mapping[str, Candidates], signals: Sequence[DraftedSignal]
) -> dict[str, object]:
    """What the templates of needs show of the candidates."""
    return {
        "fields": fields,
        "choices": {name: each.others for name, each in fields.items() if not each.chosen},
        "flags": {signal.name for signal in signals if _is_flag(overview, signal)},
    }


def _is_flag(overview: Overview, signal: DraftedSignal) -> bool:
    leaves = overview.leaves.get(signal.topic) or {}
    return leaves[signal.quantity.field].kind is FieldKind.FLAG


def _example(overview: Overview, signals: Sequence[DraftedSignal]) -> str:
    """An expression over the first signal."""
    if not signals:
        return "x < 5 cm"
    first = signals[0]
    if first.values:
        return f"{first.name} == '{first.values[0]}'"
    if _is_flag(overview, first):
        return first.name
    return f"{first.name} < 0.5 {first.quantity.unit}".strip()


# Percentages


def draft_of_topics(overview: Overview) -> list[TopicDraft]:
    """The topics, with the unit `%` for each fraction that exceeds 1 in the log.

    sensor_msgs/BatteryState defines the percentage as a number from 0 to 1, and many robots send
    0 to 100. A log with such a message is read once more.
    """
    topics = topic_drafts(overview)
    fractions = [each for topic in topics for each in topic.signals if _is_fraction(each)]
    exceeding = {path for path, (_, most) in ranges(overview, fractions).items() if most > _ONE}
    note = "from 0 to 100 in this log, although its type defines it as 0 to 1; NaN: unmeasured"
    return [
        replace(
            topic,
            signals=tuple(
                replace(each, quantity=replace(each.quantity, unit="%", note=note))
                if each.path in exceeding
                else each
                for each in topic.signals
            ),
        )
        for topic in topics
    ]


def _is_fraction(signal: DraftedSignal) -> bool:
    return signal.quantity.name == "percentage" and not signal.quantity.unit


# Time


def _tick(overview: Overview, timed: Sequence[str]) -> tuple[int, str]:
    """A tick in which each fast topic sends one message, and the reason for its length."""
    topics = overview.recording.topics
    drafted = dict.fromkeys(timed) or dict.fromkeys(
        name for name in topics if bindable_fields(overview, name)
    )
    periods = {name: period for name in drafted if (period := period_of(topics[name])) is not None}
    if not periods:
        return _TICK, "no topic has a rate: a guess"
    fast = {name: period for name, period in periods.items() if period <= _FAST}
    slowest = max(fast, key=fast.__getitem__) if fast else min(periods, key=periods.__getitem__)
    tick = round_number(int(periods[slowest] / 1.1), (10, 20, 25, 40, 50))
    return tick, f"{slowest} comes every {rounded(periods[slowest])}"


def _dividing(tick: int, why: str, durations: Sequence[int]) -> tuple[int, str]:
    """The longest tick up to `tick` that divides every duration."""
    whole = gcd(*durations)
    steps = (count * _SHORTEST for count in range(tick // _SHORTEST, 0, -1))
    longest = next((step for step in steps if whole % step == 0), tick)
    if whole % tick == 0 or longest == tick:
        return tick, why
    return longest, f"{why}; the durations of the requirements are whole numbers of ticks"
