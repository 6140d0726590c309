"""A draft of `bindings.toml`: what a log offers to bind, and what the requirements still need.

It is text for a person to edit. What is known of a message's type is written out; every other
number stands there as a comment. Times are nanoseconds.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from compiler.files.edition import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import Formalized
from compiler.project.folder import Project
from fretc.audit.bindings.quantities import QUANTITIES, Quantity
from fretc.logs.reader import Overview
from fretc.logs.signals.samples import Topic
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.declarations import Role, path, short_type
from fretish.clock import in_words

_TICK = 100 * 10**6
"""Where no topic has a rate."""
_FAST = 220 * 10**6
"""A topic that comes no less often than this can set the tick; slower ones are held."""
_AGES = 3
"""Periods of its topic up to which a sample counts."""
_FEW = 10
"""Messages; fewer are events, and have no rate."""


@dataclass(frozen=True, slots=True)
class Drafted:
    """A signal of the draft."""

    name: str
    topic: str
    type: str
    quantity: Quantity
    max_age: str
    """Empty: the topic has no rate."""

    @property
    def path(self) -> str:
        """As the bindings write it."""
        return f"{self.topic}.{self.quantity.field}"


@dataclass(frozen=True, slots=True)
class TopicDraft:
    """A topic with its signals, and the paths of its other numbers."""

    title: str
    signals: tuple[Drafted, ...]
    others: tuple[str, ...]
    remark: str
    """Why nothing of it can be bound; empty where something can."""


@dataclass(frozen=True, slots=True)
class MissingProposition:
    """A proposition that the requirements name and no bindings define."""

    name: str
    requirements: tuple[str, ...]
    role: str
    aggregate: str


def draft(overview: Overview, missing: Sequence[MissingProposition]) -> str:
    """The text of a `bindings.toml`.

    Without missing propositions it can be read as it is; each of these is an error until edited.
    """
    topics = _topics(overview)
    signals = [signal for topic in topics for signal in topic.signals]
    tick, why = _tick(overview, signals)
    return render(
        "bindings/bindings.toml.j2",
        version=__version__,
        log=overview.recording.name,
        tick=in_words(tick),
        why=why,
        topics=topics,
        missing=missing,
        example=f"{signals[0].name} < 0.5 {signals[0].quantity.unit}".strip()
        if signals
        else "x < 5 cm",
    )


def drafted_signals(overview: Overview) -> tuple[Drafted, ...]:
    """The signals that a draft writes out."""
    return tuple(signal for topic in _topics(overview) for signal in topic.signals)


def plain_signals(overview: Overview) -> tuple[Drafted, ...]:
    """A signal for each number of a message whose type says nothing: without a unit."""
    taken: set[str] = set()
    return tuple(
        _named(_plain(topic, field), taken)
        for name, topic in overview.recording.topics.items()
        for field in overview.numbers.get(name) or ()
        if topic.count and "[" not in field and _is_worth(field) and path(f"{name}.{field}")
    )


def _plain(topic: Topic, field: str) -> Drafted:
    name = _word(f"{topic.name}_{field}")
    return Drafted(name, topic.name, short_type(topic.type), Quantity(field, ""), _max_age(topic))


# Propositions


def missing_propositions(project: Project) -> tuple[MissingProposition, ...]:
    """The propositions of the requirements that the project's bindings do not define.

    Bindings with a mistake are those that the draft is to replace: they define none.
    """
    declared = project.declarations
    defined = declared.propositions if declared and not declared.mistakes else {}
    users: dict[str, list[Formalized]] = {}
    for rule in project.rules:
        if rule.requirement.status == "retired":
            continue
        for name in rule.watched:
            if name not in defined:
                users.setdefault(name, []).append(rule)
    return tuple(_missing_proposition(name, rules) for name, rules in users.items())


def _missing_proposition(name: str, rules: Sequence[Formalized]) -> MissingProposition:
    roles = {_role(name, rule.sentence) for rule in rules}
    role = roles.pop() if len(roles) == 1 else Role.INTERNAL
    aggregate = "any" if role is Role.INPUT else "last"
    return MissingProposition(name, tuple(rule.id for rule in rules), str(role), aggregate)


def _role(name: str, sentence: s.Sentence) -> Role:
    """What the place of a name in the sentence says of it."""

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
        numbers = overview.numbers.get(name)
        drafted = _drafted(topic, numbers or ())
        signals = tuple(_named(signal, names) for signal in drafted)
        paths_of_signals = {signal.path for signal in signals}
        paths = [f"{name}.{field}" for field in numbers or () if _is_worth(field)]
        others = tuple(
            each for each in paths if each not in paths_of_signals and path(each) is not None
        )
        drafts.append(TopicDraft(_title(topic), signals, others, _remark(topic, numbers, paths)))
    return drafts


def _drafted(topic: Topic, numbers: Sequence[str]) -> list[Drafted]:
    """The signals of a topic, where its type is well known; with names that are not yet unique."""
    if not topic.count:
        return []
    base = _word(topic.name)
    type_ = short_type(topic.type)
    return [
        Drafted(
            "_".join(filter(None, (base, quantity.name))),
            topic.name,
            type_,
            quantity,
            _max_age(topic),
        )
        for quantity in QUANTITIES.get(type_, ())
        if quantity.field in numbers and path(f"{topic.name}.{quantity.field}") is not None
    ]


def _word(text: str) -> str:
    """The text as a name."""
    word = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_").lower()
    return word if word[:1].isalpha() else f"topic_{word}"


_RESERVED = {"and", "or", "not", "for", "true", "false", "abs", "min", "max"}


def _named(signal: Drafted, names: set[str]) -> Drafted:
    """The same with a name of its own, which an expression can use."""
    name, number = signal.name, 2
    while name in names or name in _RESERVED:
        name, number = f"{signal.name}_{number}", number + 1
    names.add(name)
    return replace(signal, name=name)


def _is_worth(field: str) -> bool:
    """Stamps and covariances are numbers too; nobody asks for them."""
    return not re.match(r"(?:header|stamp)\.", field) and "covariance" not in field


def _remark(topic: Topic, numbers: Sequence[str] | None, paths: Sequence[str]) -> str:
    if numbers is None:
        return f"its messages cannot be read (encoded as `{topic.encoding}`)"
    if not paths:
        return "no number has a place of its own in its messages"
    if path(paths[0]) is None:
        return "no path can name a topic that is called so"
    return ""


def _title(topic: Topic) -> str:
    count, period = f"{topic.count} message{'' if topic.count == 1 else 's'}", _period(topic)
    if period is None:
        return f"{topic.name}: {topic.type or 'no type'}, {count}"
    every, gap = (_rounded(length) for length in (period, topic.longest_gap_ns or 0))
    return f"{topic.name}: {topic.type or 'no type'}, {count}, every {every}, longest gap {gap}"


def _rounded(length: int) -> str:
    return f"{length / 10**9:.3g} s"


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
    return "" if period is None else in_words(_nice(_AGES * period, (10, 20, 30, 50)))


def _tick(overview: Overview, signals: Sequence[Drafted]) -> tuple[int, str]:
    """A tick in which each fast topic comes once, and what it was taken from."""
    topics = overview.recording.topics
    drafted = dict.fromkeys(signal.topic for signal in signals)
    periods = {name: period for name in drafted if (period := _period(topics[name])) is not None}
    if not periods:
        return _TICK, "no topic has a rate: a guess"
    fast = {name: period for name, period in periods.items() if period <= _FAST}
    slowest = max(fast, key=fast.__getitem__) if fast else min(periods, key=periods.__getitem__)
    tick = _nice(int(periods[slowest] / 1.1), (10, 20, 25, 40, 50))
    return tick, f"{slowest} comes every {_rounded(periods[slowest])}"


def _nice(least: int, steps: Sequence[int]) -> int:
    """The least round number from `least` on: a step times a power of ten, at least 1 ms."""
    unit = 10**5
    while True:
        for step in steps:
            if step * unit >= least:
                return step * unit
        unit *= 10
