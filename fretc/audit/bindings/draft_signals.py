"""The signals of a draft: what is known of the messages of a log, without the requirements.

Times are nanoseconds.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from fretc.audit.bindings.quantities import QUANTITIES, NumberField
from fretc.logs.messages.leaves import FieldKind, Leaves
from fretc.logs.reader import Overview
from fretc.logs.signals.samples import Topic
from fretc.logs.tables.contents import TOPIC as TABLE
from fretc.logs.vocabulary import Words
from fretish.bindings.amounts import duration
from fretish.bindings.declarations import path, short_type
from fretish.classes.frozen import dataclass
from fretish.clock import in_words

_AGES = 3
"""Age limit of a sample, in periods of its topic."""
_ROUND = (10, 12, 15, 20, 25, 30, 35, 40, 50, 60, 75, 90)
"""Factors to which an age limit is rounded up, times a power of ten."""
_FEW = 10
"""A topic with fewer messages has no rate: its messages are events."""


@dataclass(frozen=True, slots=True)
class DraftedSignal:
    """A signal of the draft."""

    name: str
    topic: str
    type: str
    quantity: NumberField
    max_age: str
    """The age limit; empty: the topic has no rate."""
    values: tuple[str, ...] = ()
    """The texts of the field in the log."""
    gap: str = ""
    """The longest gap between messages of the log, if it exceeds the age limit; else empty."""

    @property
    def path(self) -> str:
        """The path of the field, as written in bindings."""
        return f"{self.topic}.{self.quantity.field}"


@dataclass(frozen=True, slots=True)
class UndraftedField:
    """A field without a drafted signal, and the values that it can have."""

    path: str
    values: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class TopicDraft:
    """A topic with its signals and its other fields."""

    title: str
    signals: tuple[DraftedSignal, ...]
    others: tuple[UndraftedField, ...]
    remark: str
    """The reason why no field of the topic can be bound; empty: some can."""


def drafted_signals(overview: Overview) -> tuple[DraftedSignal, ...]:
    """The signals that a draft declares."""
    return tuple(signal for topic in topic_drafts(overview) for signal in topic.signals)


def plain_signals(overview: Overview) -> tuple[DraftedSignal, ...]:
    """A signal for each enumeration or unitless field, for types that are not well known."""
    taken: set[str] = set()
    return tuple(
        _named(_plain(topic, field, values), taken)
        for name, topic in overview.recording.topics.items()
        for field, values in bindable_fields(overview, name).items()
        if topic.count and "[" not in field and path(f"{name}.{field}")
    )


def _plain(topic: Topic, field: str, values: tuple[str, ...]) -> DraftedSignal:
    name, type_ = _word(_name(topic.name, field)), short_type(topic.type)
    quantity, age, gap = NumberField(field, ""), age_limit(topic), long_gap(topic)
    return DraftedSignal(name, topic.name, type_, quantity, age, values, gap)


def _name(topic: str, field: str) -> str:
    """The words of a signal of a type that is not well known; a table is not named."""
    if topic == TABLE:
        return field
    if topic.startswith(f"{TABLE}/"):
        return topic.removeprefix(f"{TABLE}/")
    return f"{topic}_{field}"


def bindable_fields(overview: Overview, topic: str) -> dict[str, tuple[str, ...]]:
    """The fields of a topic that a signal can read, each with its possible values."""
    leaves, words = overview.leaves.get(topic) or {}, overview.words.get(topic, {})
    return {
        field: (*leaf.names, *(words.get(field) or ()))
        for field, leaf in leaves.items()
        if _is_worth(field) and (leaf.kind is not FieldKind.TEXT or words.get(field))
    }


def topic_drafts(overview: Overview) -> list[TopicDraft]:
    """Each topic with its signals and its other fields."""
    names: set[str] = set()
    drafts = []
    for name, topic in overview.recording.topics.items():
        leaves, words = overview.leaves.get(name), overview.words.get(name, {})
        drafted = _drafted(topic, leaves or {}, words)
        signals = tuple(_named(signal, names) for signal in drafted)
        paths_of_signals = {signal.path for signal in signals}
        fields = {
            f"{name}.{field}": each for field, each in bindable_fields(overview, name).items()
        }
        others = tuple(
            UndraftedField(each, values)
            for each, values in fields.items()
            if each not in paths_of_signals and path(each) is not None
        )
        remark = _remark(topic, leaves, [*fields])
        drafts.append(TopicDraft(_title(topic), signals, others, remark))
    return drafts


def _drafted(topic: Topic, leaves: Leaves, words: Words) -> list[DraftedSignal]:
    """The drafted signals of a topic of a well-known type; their names are not yet unique."""
    if not topic.count:
        return []
    base = _word(topic.name)
    type_ = short_type(topic.type)
    return [
        DraftedSignal(
            "_".join(filter(None, (base, quantity.name))),
            topic.name,
            type_,
            quantity,
            age_limit(topic),
            words.get(quantity.field) or (),
            long_gap(topic),
        )
        for quantity in QUANTITIES.get(type_, ())
        if quantity.field in leaves and path(f"{topic.name}.{quantity.field}") is not None
        if leaves[quantity.field].kind is not FieldKind.TEXT or words.get(quantity.field)
    ]


def _word(text: str) -> str:
    """The text as a name."""
    word = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_").lower()
    return word if word[:1].isalpha() else f"topic_{word}"


_RESERVED = {"and", "or", "not", "for", "true", "false", "abs", "min", "max"}
"""Keywords of bindings and sentences, which cannot be names of signals."""


def _named(signal: DraftedSignal, names: set[str]) -> DraftedSignal:
    """The signal with a unique name that expressions can use."""
    name, number = signal.name, 2
    while name in names or name in _RESERVED:
        name, number = f"{signal.name}_{number}", number + 1
    names.add(name)
    return replace(signal, name=name)


def _is_worth(field: str) -> bool:
    """Whether the field is of interest: neither a stamp nor a covariance."""
    return not re.match(r"(?:header|stamp)\.", field) and "covariance" not in field


def _remark(topic: Topic, leaves: Leaves | None, paths: Sequence[str]) -> str:
    if leaves is None:
        return f"its messages cannot be read (encoded as `{topic.encoding}`)"
    if not paths:
        return "its messages have no number and no enumeration text at a fixed path"
    if path(paths[0]) is None:
        return "a path cannot contain the name of this topic"
    return ""


def _title(topic: Topic) -> str:
    count, period = f"{topic.count} message{'' if topic.count == 1 else 's'}", period_of(topic)
    if period is None:
        return f"{topic.name}: {topic.type or 'no type'}, {count}"
    every, gap = (rounded(length) for length in (period, topic.longest_gap_ns or 0))
    return f"{topic.name}: {topic.type or 'no type'}, {count}, every {every}, longest gap {gap}"


def rounded(length: int) -> str:
    """Nanoseconds for people."""
    return duration(length / 10**9)


# Time


def period_of(topic: Topic) -> int | None:
    """Nanoseconds from a message to the next: the median, or the mean where they come in bursts.

    None where there are too few of them for a rate.
    """
    if topic.count < _FEW or topic.first_ns is None or topic.last_ns is None:
        return None
    mean = (topic.last_ns - topic.first_ns) // (topic.count - 1)
    return max(mean, topic.median_period_ns or 0) or None


def age_limit(topic: Topic) -> str:
    """How long a sample of the topic counts, as text; empty: the topic has no rate."""
    limit = _age_limit(topic)
    return "" if limit is None else in_words(limit)


def _age_limit(topic: Topic) -> int | None:
    period = period_of(topic)
    return None if period is None else round_number(_AGES * period, _ROUND)


def long_gap(topic: Topic) -> str:
    """The longest gap between messages as text, if it exceeds the age limit; else empty."""
    limit, gap = _age_limit(topic), topic.longest_gap_ns or 0
    return rounded(gap) if limit is not None and gap > limit else ""


def round_number(least: int, steps: Sequence[int]) -> int:
    """The least round number from `least` on: a step times a power of ten, at least 1 ms."""
    unit = 10**5
    while True:
        for step in steps:
            if step * unit >= least:
                return step * unit
        unit *= 10
