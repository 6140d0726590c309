"""Messages for a test: field contents with which the audit reads the values of each tick."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.measures import NameValues
from fretc.logs.signals.propositions import FALSE, TRUE, UNKNOWN, truth
from fretc.testing.log_synthesis.contents import FieldContent, choices
from fretc.testing.log_synthesis.messages import (
    Content,
    NotRecordableError,
    SignalField,
    field,
    message,
)
from fretc.testing.log_synthesis.ticks import TickPart, TickPlan, part, tick_plan
from fretc.testing.suite import Test
from fretish.bindings.declarations import Declarations, Path, Signal
from fretish.classes.frozen import dataclass
from monitors.kernel import Monitor

EPOCH = 1_700_000_000 * 10**9
"""Start of each log in nanoseconds."""
_MOST_COMBINED = 500_000
"""Maximum number of combinations of contents that are tried for a tick."""
_STATES = {False: FALSE, None: UNKNOWN, True: TRUE}


@dataclass(frozen=True, slots=True)
class SyntheticMessage:
    """One message."""

    topic: str
    type: str
    time: int
    message: Any


@dataclass(frozen=True, slots=True)
class SyntheticLog:
    """All messages of a log in the order of time."""

    lead: int
    """Number of ticks before those of the test."""
    messages: tuple[SyntheticMessage, ...]


def synthesize(test: Test, declarations: Declarations, monitor: Monitor) -> SyntheticLog:
    """The messages of a test.

    Args:
        test: a test of the suite.
        declarations: bindings of its propositions.
        monitor: monitor of its requirement.

    Raises:
        NotRecordableError: no messages have the required values, or bindings are missing.
    """
    clock = declarations.clock
    if clock.period is None:
        raise NotRecordableError("its clock ticks with messages")
    if clock.phase:
        raise NotRecordableError("its clock has a phase")
    absent = next((n for n in monitor.PROPOSITIONS if n not in declarations.propositions), None)
    if absent is not None:
        raise NotRecordableError(f"`{absent}` has no binding")
    parts = [part(declarations.propositions[n], clock.period) for n in monitor.PROPOSITIONS]
    names = dict.fromkeys(name for one in parts for name in one.proposition.signals)
    signals = [declarations.signals[name] for name in names]
    remembering = next((signal for signal in signals if signal.memory is not None), None)
    if remembering is not None:
        raise NotRecordableError(
            f"`{remembering.name}` has memory: several messages make its value"
        )
    stage = _SignalSearch(parts, signals, {signal.name: field(signal) for signal in signals})
    plan = tick_plan(test, parts, monitor)
    contents = stage.contents(test, plan)
    return SyntheticLog(plan.lead, tuple(_messages(stage, contents, clock.period, declarations)))


class _SignalSearch:
    """The signals of a requirement, and their possible contents."""

    def __init__(
        self,
        parts: Sequence[TickPart],
        signals: Sequence[Signal],
        fields: Mapping[str, SignalField],
    ) -> None:
        self.signals, self.fields = signals, fields
        self._parts = parts
        self._known: dict[tuple[object, ...], tuple[FieldContent, ...] | None] = {}

    def contents(self, test: Test, plan: TickPlan) -> list[tuple[FieldContent, ...]]:
        """Contents of each tick, in the order of the signals."""
        rows = [row for row in test.rows for _ in range(row.count)]
        rows = [rows[0]] * plan.lead + rows
        made: list[tuple[FieldContent, ...]] = []
        for tick, row in enumerate(rows):
            wanted = tuple(plan.wanted[one.proposition.name][tick] for one in self._parts)
            wished = tuple(row.values.get(signal.name, math.nan) for signal in self.signals)
            key = wanted, tuple(map(repr, wished))
            if key not in self._known:
                self._known[key] = self._chosen(wanted, wished)
            chosen = self._known[key]
            if chosen is None:
                raise NotRecordableError(self._impossible(wanted, tick - plan.lead))
            made.append(chosen)
        return made

    def _chosen(
        self, wanted: Sequence[bool | None], wished: Sequence[object]
    ) -> tuple[FieldContent, ...] | None:
        """Contents that give all parts their required value, most of them preferred ones."""
        every = [
            self._choices(signal, wish) for signal, wish in zip(self.signals, wished, strict=True)
        ]
        sizes = [len(each) for each in every]
        if math.prod(sizes) > _MOST_COMBINED:
            raise NotRecordableError(f"{len(sizes)} signals have too many values together")
        places = [each.reshape(-1) for each in np.indices(sizes)]
        good = self._good(wanted, every, places)
        if not good.any():
            return None
        strange = sum(
            (place >= self._as_wished(each, wish)).astype(np.int64) * 1000 + place
            for each, place, wish in zip(every, places, wished, strict=True)
        )
        best = int(np.argmin(np.where(good, strange, np.iinfo(np.int64).max)))
        return tuple(each[place[best]] for each, place in zip(every, places, strict=True))

    def _choices(self, signal: Signal, wish: object) -> tuple[FieldContent, ...]:
        read_by = [one.expression for one in self._parts if signal.name in one.proposition.signals]
        wishes = [] if isinstance(wish, float) and math.isnan(wish) else [wish]
        found = choices(signal, self.fields[signal.name], read_by, wishes)
        return tuple(reversed(found)) if wishes == [None] else found  # Unknown values come first.

    def _as_wished(self, choices: Sequence[FieldContent], wish: object) -> int:
        """Number of leading choices that are the preferred ones."""
        first = choices[0].nominal
        if isinstance(wish, float) and math.isnan(wish):
            return len(choices)  # No message.
        return next((i for i, each in enumerate(choices) if each.nominal != first), len(choices))

    def _good(
        self,
        wanted: Sequence[bool | None],
        every: Sequence[Sequence[FieldContent]],
        places: Sequence[NDArray[np.intp]],
    ) -> NDArray[np.bool_]:
        """For each combination, whether the audit reads the required value of all parts."""
        numbers = {
            signal.name: np.array([each.value for each in some], self._kind(signal))[place]
            for signal, some, place in zip(self.signals, every, places, strict=True)
        }
        scope = NameValues(
            len(places[0]),
            numbers,
            scales={signal.name: signal.scale for signal in self.signals},
            words={signal.name: signal.values for signal in self.signals if signal.values},
        )
        good = np.ones(len(places[0]), bool)
        for one, truth_wanted in zip(self._parts, wanted, strict=True):
            states = truth(one.expression, scope)
            replaced = one.proposition.on_unknown
            if replaced is not None and not one.back:
                states = np.where(states == UNKNOWN, _STATES[replaced], states)
            good &= states == _STATES[truth_wanted]
        return good

    def _kind(self, signal: Signal) -> np.dtype[Any]:
        is_chosen = not signal.values and not signal.path.each
        single = is_chosen and self.fields[signal.name].base == "float32"
        return np.dtype(np.float32 if single else np.float64)

    def _impossible(self, wanted: Sequence[bool | None], tick: int) -> str:
        words = {True: "true", False: "false", None: "unknown"}
        asked = [
            f"`{one.proposition.name}` {words[truth]}"
            for one, truth in zip(self._parts, wanted, strict=True)
        ]
        names = ", ".join(f"`{each.name}`" for each in self.signals)
        return f"no values of {names} make {', '.join(asked)}, as tick {tick} asks for"


# Messages ---------------------------------------------------------------------------------------


def _messages(
    stage: _SignalSearch,
    contents: Sequence[Sequence[FieldContent]],
    period: int,
    declarations: Declarations,
) -> Iterator[SyntheticMessage]:
    """Messages of all topics, tick by tick; a topic without messages stays silent long enough."""
    topics = dict.fromkeys(signal.path.topic for signal in stage.signals)
    ticks = {topic: _message_ticks(stage, topic, contents, period) for topic in topics}
    speaking = set().union(*ticks.values())
    for tick, chosen in enumerate(contents):
        for topic in topics:
            if tick in ticks[topic]:
                yield from _of_tick(stage, topic, chosen, tick, period)
        if tick in (0, len(contents) - 1) and tick not in speaking:
            yield _pulse(declarations, topics, EPOCH + tick * period)


def _message_ticks(
    stage: _SignalSearch, topic: str, contents: Sequence[Sequence[FieldContent]], period: int
) -> set[int]:
    """Ticks at which a topic has a message.

    Raises:
        NotRecordableError: an older message would count where the value must be unknown, or the
            reverse.
    """
    own = [i for i, signal in enumerate(stage.signals) if signal.path.topic == topic]
    silent = {t for t, chosen in enumerate(contents) if any(chosen[i].content is None for i in own)}
    ages = [stage.signals[i].max_age for i in own]
    lasts = [len(contents) if age is None else age // period for age in ages]
    quiet = {t - back for t in silent for back in range(min(max(lasts), t) + 1)}
    spoken: int | None = None
    for tick in range(len(contents)):
        if tick not in quiet:
            spoken = tick
        elif tick not in silent and not (
            spoken is not None
            and tick - spoken <= min(lasts)
            and all(contents[spoken][i] == contents[tick][i] for i in own)
        ):
            names = ", ".join(f"`{stage.signals[i].name}`" for i in own)
            raise NotRecordableError(
                f"{names} cannot become unknown so soon: a message counts longer"
            )
    return {*range(len(contents))} - quiet


def _of_tick(
    stage: _SignalSearch, topic: str, chosen: Sequence[FieldContent], tick: int, period: int
) -> Iterator[SyntheticMessage]:
    """Messages of a tick, repeated before it as often as their maximum age requires."""
    own = {
        signal: choice
        for signal, choice in zip(stage.signals, chosen, strict=True)
        if signal.path.topic == topic
    }
    youngest = min((s.max_age for s in own if s.max_age is not None), default=period)
    times = -(-period // max(youngest, 1)) if tick else 1
    name = stage.fields[next(iter(own)).name].message
    contents: dict[Path, Content] = {}
    for signal, choice in own.items():
        assert choice.content is not None
        contents[signal.path] = choice.content
    for number in reversed(range(times)):
        time = EPOCH + tick * period - number * period // times
        yield SyntheticMessage(topic, name, time, message(name, time, contents))


def _pulse(declarations: Declarations, topics: Mapping[str, None], time: int) -> SyntheticMessage:
    """Message of another topic, which makes the log cover ticks without messages."""
    for signal in declarations.signals.values():
        if signal.path.topic not in topics and signal.type is not None:
            name = field(signal).message
            return SyntheticMessage(signal.path.topic, name, time, message(name, time, {}))
    raise NotRecordableError(
        "it has no message at its first or last tick, so a log would not contain that tick"
    )
