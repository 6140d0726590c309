"""A draft of `bindings.toml`: the signals of a log, and what the requirements still need.

It is text for a person to edit. What is known of a message's type is written out; every other
number or text stands there as a comment. Times are nanoseconds.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from math import gcd

from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization import binding_agreement
from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.project import Project
from fretc.audit.bindings.quantities import QUANTITIES, NumberField
from fretc.logs.messages.leaves import FieldKind, Leaves
from fretc.logs.reader import Overview
from fretc.logs.signals.samples import Topic
from fretc.logs.vocabulary import Words
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.amounts import duration
from fretish.bindings.declarations import Declarations, Role, path, short_type
from fretish.classes.frozen import dataclass
from fretish.clock import NANOSECONDS, in_words

_TICK = 100 * 10**6
"""Nanoseconds of a tick if no topic has a rate."""
_FAST = 220 * 10**6
"""The longest period, in nanoseconds, of a topic that determines the tick; samples of slower topics
are held."""
_AGES = 3
"""Age limit of a sample, in periods of its topic."""
_SHORTEST = 10**6
"""The shortest tick, in nanoseconds."""
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


@dataclass(frozen=True, slots=True)
class MissingProposition:
    """A proposition that requirements use and no bindings define."""

    name: str
    requirements: tuple[str, ...]
    role: str
    aggregate: str


@dataclass(frozen=True, slots=True)
class MissingSignal:
    """A signal that comparisons of the requirements use and no bindings declare."""

    name: str
    requirements: tuple[str, ...]


def draft(
    overview: Overview,
    missing: Sequence[MissingProposition],
    durations: Sequence[int] = (),
    unread: Sequence[MissingSignal] = (),
) -> str:
    """The text of a `bindings.toml`.

    With nothing missing it can be read as it is; what is missing is an error until edited, but for
    a proposition that is called as a signal that is true or false, and a signal of the draft.

    Args:
        overview: the summary of a log, with the texts of its fields.
        missing: propositions that sentences use and no bindings define.
        durations: durations of the sentences in nanoseconds; each is a whole number of ticks.
        unread: signals that sentences compare and no bindings declare.
    """
    topics = _topics(overview)
    signals = [signal for topic in topics for signal in topic.signals]
    tick, why = _dividing(*_tick(overview, signals), durations)
    return render(
        "bindings/bindings.toml.j2",
        version=__version__,
        log=overview.recording.name,
        tick=in_words(tick),
        why=why,
        topics=topics,
        missing=missing,
        unread=[each for each in unread if each.name not in {signal.name for signal in signals}],
        flags={signal.name for signal in signals if _is_flag(overview, signal)},
        example=_example(overview, signals),
    )


def drafted_signals(overview: Overview) -> tuple[DraftedSignal, ...]:
    """The signals that a draft declares."""
    return tuple(signal for topic in _topics(overview) for signal in topic.signals)


def plain_signals(overview: Overview) -> tuple[DraftedSignal, ...]:
    """A signal for each enumeration or unitless field, for types that are not well known."""
    taken: set[str] = set()
    return tuple(
        _named(_plain(topic, field, values), taken)
        for name, topic in overview.recording.topics.items()
        for field, values in _fields(overview, name).items()
        if topic.count and "[" not in field and path(f"{name}.{field}")
    )


def _plain(topic: Topic, field: str, values: tuple[str, ...]) -> DraftedSignal:
    name, type_ = _word(f"{topic.name}_{field}"), short_type(topic.type)
    return DraftedSignal(name, topic.name, type_, NumberField(field, ""), _max_age(topic), values)


def _fields(overview: Overview, topic: str) -> dict[str, tuple[str, ...]]:
    """The fields of a topic that a signal can read, each with its possible values."""
    leaves, words = overview.leaves.get(topic) or {}, overview.words.get(topic, {})
    return {
        field: (*leaf.names, *(words.get(field) or ()))
        for field, leaf in leaves.items()
        if _is_worth(field) and (leaf.kind is not FieldKind.TEXT or words.get(field))
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


# Propositions


def missing_propositions(project: Project) -> tuple[MissingProposition, ...]:
    """The propositions of the requirements that the project's bindings do not define.

    Bindings with a mistake are those that the draft is to replace: they define none.
    """
    declared = project.declarations
    defined = declared.propositions if declared and not declared.mistakes else {}
    users: dict[str, list[FormalizedRequirement]] = {}
    for requirement in project.in_force:
        for name in requirement.watched:
            if name not in defined and not _unread(requirement, name, declared):
                users.setdefault(name, []).append(requirement)
    return tuple(_missing_proposition(name, requirements) for name, requirements in users.items())


def missing_signals(project: Project) -> tuple[MissingSignal, ...]:
    """The undeclared signals in comparisons of the requirements."""
    users: dict[str, dict[str, None]] = {}
    for requirement in project.in_force:
        for name in requirement.watched:
            for signal in _unread(requirement, name, project.declarations):
                users.setdefault(signal, {})[requirement.id] = None
    return tuple(MissingSignal(name, tuple(ids)) for name, ids in users.items())


def _unread(
    requirement: FormalizedRequirement, name: str, declared: Declarations | None
) -> tuple[str, ...]:
    """The undeclared signals in the comparison of a proposition; none if bindings define it."""
    if declared is not None and name in declared.propositions:
        return ()
    return binding_agreement.missing_signals(
        requirement, name, declared.signals if declared else {}
    )


def durations(project: Project) -> tuple[int, ...]:
    """The durations of the requirements in nanoseconds, without those stated in ticks."""
    seconds_or_ticks = [
        s.duration(requirement.sentence.timing) for requirement in project.formalized
    ]
    return tuple(
        d.amount * NANOSECONDS[d.unit] for d in seconds_or_ticks if d and d.unit in NANOSECONDS
    )


def _missing_proposition(
    name: str, requirements: Sequence[FormalizedRequirement]
) -> MissingProposition:
    roles = {_role(name, requirement.sentence) for requirement in requirements}
    role = roles.pop() if len(roles) == 1 else Role.INTERNAL
    aggregate = "any" if role is Role.INPUT else "last"
    return MissingProposition(
        name, tuple(requirement.id for requirement in requirements), str(role), aggregate
    )


def _role(name: str, sentence: s.Sentence) -> Role:
    """The role of a name, from its place in the sentence."""

    def within(expression: e.Expression | None) -> bool:
        return expression is not None and any(part.id == name for part in e.names(expression))

    if within(sentence.response):
        return Role.OUTPUT
    if within(sentence.condition.expression if sentence.condition else None):
        return Role.INPUT
    if within(sentence.scope.mode if sentence.scope else None):
        return Role.MODE
    return Role.INTERNAL


# Signals


def _topics(overview: Overview) -> list[TopicDraft]:
    names: set[str] = set()
    drafts = []
    for name, topic in overview.recording.topics.items():
        leaves, words = overview.leaves.get(name), overview.words.get(name, {})
        drafted = _drafted(topic, leaves or {}, words)
        signals = tuple(_named(signal, names) for signal in drafted)
        paths_of_signals = {signal.path for signal in signals}
        fields = {f"{name}.{field}": each for field, each in _fields(overview, name).items()}
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
            _max_age(topic),
            words.get(quantity.field) or (),
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
    count, period = f"{topic.count} message{'' if topic.count == 1 else 's'}", _period(topic)
    if period is None:
        return f"{topic.name}: {topic.type or 'no type'}, {count}"
    every, gap = (_rounded(length) for length in (period, topic.longest_gap_ns or 0))
    return f"{topic.name}: {topic.type or 'no type'}, {count}, every {every}, longest gap {gap}"


def _rounded(length: int) -> str:
    return duration(length / 10**9)


# Time


def _period(topic: Topic) -> int | None:
    """Nanoseconds from a message to the next: the median, or the mean where they come in bursts.

    None where there are too few of them for a rate.
    """
    if topic.count < _FEW or topic.first_ns is None or topic.last_ns is None:
        return None
    mean = (topic.last_ns - topic.first_ns) // (topic.count - 1)
    return max(mean, topic.median_period_ns or 0) or None


def _max_age(topic: Topic) -> str:
    period = _period(topic)
    return "" if period is None else in_words(_nice(_AGES * period, _ROUND))


def _tick(overview: Overview, signals: Sequence[DraftedSignal]) -> tuple[int, str]:
    """A tick in which each fast topic sends one message, and the reason for its length."""
    topics = overview.recording.topics
    drafted = dict.fromkeys(signal.topic for signal in signals) or dict.fromkeys(
        name for name in topics if _fields(overview, name)
    )
    periods = {name: period for name in drafted if (period := _period(topics[name])) is not None}
    if not periods:
        return _TICK, "no topic has a rate: a guess"
    fast = {name: period for name, period in periods.items() if period <= _FAST}
    slowest = max(fast, key=fast.__getitem__) if fast else min(periods, key=periods.__getitem__)
    tick = _nice(int(periods[slowest] / 1.1), (10, 20, 25, 40, 50))
    return tick, f"{slowest} comes every {_rounded(periods[slowest])}"


def _dividing(tick: int, why: str, durations: Sequence[int]) -> tuple[int, str]:
    """The longest tick up to `tick` that divides every duration."""
    whole = gcd(*durations)
    steps = (count * _SHORTEST for count in range(tick // _SHORTEST, 0, -1))
    longest = next((step for step in steps if whole % step == 0), tick)
    if whole % tick == 0 or longest == tick:
        return tick, why
    return longest, f"{why}; the durations of the requirements are whole numbers of ticks"


def _nice(least: int, steps: Sequence[int]) -> int:
    """The least round number from `least` on: a step times a power of ten, at least 1 ms."""
    unit = 10**5
    while True:
        for step in steps:
            if step * unit >= least:
                return step * unit
        unit *= 10
