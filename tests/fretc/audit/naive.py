"""An auditor that is written from the documentation, and shares no code with fretc.

It looks at each nanosecond and at each sample by itself, counts in fractions, and tries all truth
values of what is unknown. It is slow, and reads no files: a `Run` has all that there is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, cached_property
from itertools import product
from math import pi
from typing import Any

Truth = bool | None
"""None is unknown."""
Number = Fraction | None
Expression = tuple[Any, ...]
"""`("<", a, b)`, `("and", p, q)`, `("or", p, q)`, `("not", p)`, `("for", p, quanta)`; of numbers
`("signal", name)`, `("constant", text, unit)`, and `-`, `abs`, `min`, `max`, `+`, `*`, `/`."""

FACTORS: dict[str, Fraction] = {
    "1": Fraction(1),
    "%": Fraction(1, 100),
    "km": Fraction(1000),
    "m": Fraction(1),
    "cm": Fraction(1, 100),
    "mm": Fraction(1, 1000),
    "m/s": Fraction(1),
    "km/h": Fraction(10, 36),
    "cm/s": Fraction(1, 100),
    "rad": Fraction(1),
    "mrad": Fraction(1, 1000),
    "deg": Fraction(pi) / 180,
    "m^2": Fraction(1),
    "cm^2": Fraction(1, 10**4),
    "m/s^2": Fraction(1),
    "cm/s2": Fraction(1, 100),
}


@dataclass(frozen=True)
class Sample:
    """What one message says of a signal, in the unit of its field."""

    time: int
    value: Number


@dataclass(frozen=True)
class Signal:
    unit: str
    samples: tuple[Sample, ...]
    """In the order of the file."""
    max_age: int | None


@dataclass(frozen=True)
class Proposition:
    expression: Expression
    aggregate: str
    on_unknown: Truth


@dataclass(frozen=True)
class Run:
    """Times in nanoseconds; `topics` are the times of the messages of each bound topic."""

    tick: int
    phase: int
    end: str
    signals: dict[str, Signal]
    propositions: dict[str, Proposition]
    topics: dict[str, tuple[int, ...]]
    clock_topic: str | None = None
    slow: dict[str, _Slow] = field(default_factory=dict)
    """What is known of each proposition; the same at all phases."""

    @property
    def first(self) -> int:
        return min(time for times in self.topics.values() for time in times)

    @property
    def last(self) -> int:
        return max(time for times in self.topics.values() for time in times)

    @property
    def ticks(self) -> list[int]:
        """When each tick is."""
        if self.clock_topic is not None:
            return sorted(self.topics[self.clock_topic])
        latest = max(min(times) for times in self.topics.values() if times)
        begin = latest if latest - self.first < self.tick else self.first
        return list(range(begin + self.phase, self.last + 1, self.tick))

    def columns(self, name: str) -> tuple[list[Truth], list[Truth]]:
        """What each tick sees of a proposition; and, if there is one, what the cut tick sees."""
        if name not in self.slow:
            self.slow[name] = _Slow(self, self.propositions[name])
        return self.slow[name].columns(self.ticks)


class _Slow:
    """One proposition of a run, at any phase."""

    def __init__(self, run: Run, proposition: Proposition) -> None:
        self.run, self.proposition = run, proposition
        self.names = sorted(_names(proposition.expression))
        self.at = cache(self._at)

    # Samples

    def now(self, name: str, time: int) -> list[Number]:
        """The samples of one instant, in their order."""
        return [s.value for s in self.run.signals[name].samples if s.time == time]

    def value(self, name: str, time: int, place: int) -> Number:
        """What a signal is at the step of that place within an instant, in base units."""
        signal = self.run.signals[name]
        now = self.now(name, time)
        if now:
            values = now[min(place, len(now) - 1)]
        else:
            before = [s for s in signal.samples if s.time < time]
            if not before:
                return None
            newest = max(s.time for s in before)
            if signal.max_age is not None and time - newest > signal.max_age:
                return None
            values = [s.value for s in before if s.time == newest][-1]
        return None if values is None else values * FACTORS[signal.unit]

    def places(self, time: int) -> int:
        """How many steps an instant has at most: as many as a signal has samples there."""
        return max([1, *(len(self.now(name, time)) for name in self.names)])

    # Expressions

    def _at(self, part: Expression, time: int, place: int) -> Truth:
        match part:
            case ("and", p, q):
                both = self.at(p, time, place), self.at(q, time, place)
                return False if False in both else None if None in both else True
            case ("or", p, q):
                both = self.at(p, time, place), self.at(q, time, place)
                return True if True in both else None if None in both else False
            case ("not", p):
                value = self.at(p, time, place)
                return None if value is None else not value
            case ("for", p, duration):
                return self.held(p, time, duration)
            case (op, left, right):
                one, two = self.number(left, time, place), self.number(right, time, place)
                if one is None or two is None:
                    return None
                return {
                    "<": one < two,
                    "<=": one <= two,
                    ">": one > two,
                    ">=": one >= two,
                    "=": one == two,
                    "!=": one != two,
                }[op]
        raise AssertionError(part)

    def held(self, part: Expression, time: int, duration: int) -> Truth:
        """`part` in force `duration` ago, and at all steps since."""
        begin = time - duration
        states: list[Truth] = []
        if begin < self.run.first:
            states.append(None)
        else:
            states.append(self.at(part, begin, self.places(begin) - 1))
        for moment in range(max(self.run.first, begin + 1), time + 1):
            states += [self.at(part, moment, place) for place in range(self.places(moment))]
        return False if False in states else None if None in states else True

    def number(self, part: Expression, time: int, place: int) -> Number:
        match part:
            case ("signal", name):
                return self.value(name, time, place)
            case ("constant", digits, unit):
                return Fraction(digits) * FACTORS[unit]
            case (op, *args):
                arguments = [self.number(arg, time, place) for arg in args]
                numbers = [one for one in arguments if one is not None]
                return _computed(op, numbers) if len(numbers) == len(arguments) else None
        raise AssertionError(part)

    # Steps

    @cached_property
    def steps(self) -> list[tuple[int, Truth]]:
        """Each step with its time, in order."""
        whole, run = self.proposition.expression, self.run
        times = {run.first}
        for name in self.names:
            signal = run.signals[name]
            own = sorted(s.time for s in signal.samples)
            times |= set(own)
            if signal.max_age is not None:
                for time in own:
                    old = time + signal.max_age + 1
                    if not any(time < other <= old for other in own):
                        times.add(old)
        for part in _durations(whole):
            states = [self.at(part, time, 0) for time in range(run.first, run.last + 1)]
            times |= {
                run.first + i for i in range(1, len(states)) if states[i] is not states[i - 1]
            }
        return [
            (time, self.at(whole, time, place))
            for time in sorted(times)
            if run.first <= time <= run.last
            for place in range(self.places(time))
        ]

    # Ticks

    def columns(self, ticks: Sequence[int]) -> tuple[list[Truth], list[Truth]]:
        run = self.run
        force: Truth = None
        columns = []
        for i, time in enumerate(ticks):
            states = self.window(ticks, i)
            if not i:
                force = next((s for at, s in reversed(self.steps) if at < time), None)
            columns.append(self.tick_value(states, force))
            force = states[-1] if states else force
        if not ticks or run.last <= ticks[-1]:
            return columns, []
        rest = [state for time, state in self.steps if ticks[-1] < time <= run.last]
        return columns, [self.tick_value(rest, force)]

    def window(self, ticks: Sequence[int], i: int) -> list[Truth]:
        """The steps that a tick sees."""
        time = ticks[i]
        if self.run.clock_topic is not None:
            same = [j for j, other in enumerate(ticks) if other == time]
            if len(same) > 1:
                now = [state for at, state in self.steps if at == time]
                rank = same.index(i)
                own = now[rank:] if i == same[-1] else now[rank : rank + 1]
                before = [s for at, s in self.steps if i and not rank and ticks[i - 1] < at < time]
                return [*before, *own]
            if not i:
                return [state for at, state in self.steps if at == time]
        if i:
            return [state for at, state in self.steps if ticks[i - 1] < at <= time]
        begun = self.begun
        steps = [(at, state) for at, state in self.steps if at <= time]
        states = [state for at, state in steps]
        for at, state in steps:  # what is unknown for want of a first message says nothing
            if state is not None or at >= begun or len(states) == 1:
                break
            states.pop(0)
        return states

    @property
    def begun(self) -> int:
        """When all of its signals have had a message."""
        run = self.run
        firsts = [
            min((s.time for s in run.signals[name].samples), default=run.last)
            for name in self.names
        ]
        return max(firsts, default=run.first)

    def tick_value(self, states: Sequence[Truth], force: Truth) -> Truth:
        """What a tick sees of the steps; without one, what was in force before."""
        if not states:
            value = force
        elif self.proposition.aggregate == "any":
            value = True if True in states else None if None in states else False
        elif self.proposition.aggregate == "all":
            value = False if False in states else None if None in states else True
        else:
            value = states[-1]
        return self.proposition.on_unknown if value is None else value


def _computed(op: str, args: Sequence[Fraction]) -> Number:
    match op:
        case "-":
            return -args[0]
        case "abs":
            return abs(args[0])
        case "min":
            return min(args)
        case "max":
            return max(args)
        case "+":
            return args[0] + args[1]
        case "*":
            return args[0] * args[1]
        case _:
            return args[0] / args[1] if args[1] else None


def _names(part: Expression) -> set[str]:
    if part[0] == "signal":
        return {part[1]}
    return {name for arg in part[1:] if isinstance(arg, tuple) for name in _names(arg)}


def _durations(part: Expression) -> list[Expression]:
    """The outermost `for`s."""
    if part[0] == "for":
        return [part]
    return [duration for arg in part[1:] if isinstance(arg, tuple) for duration in _durations(arg)]


# Requirements

Demand = Callable[[list[bool], list[bool], int], str]
"""Trigger, response, ticks of the timing → verdict."""


def _joined(verdicts: Sequence[str]) -> str:
    """One verdict on all triggers."""
    for verdict in ("violated", "open"):
        if verdict in verdicts:
            return verdict
    return "satisfied" if verdicts else "vacuous"


def _rises(column: Sequence[bool]) -> list[int]:
    return [i for i, now in enumerate(column) if now and not (i and column[i - 1])]


def _all(column: Sequence[bool]) -> list[int]:
    return [i for i, now in enumerate(column) if now]


def _within(i: int, q: Sequence[bool], n: int) -> str:
    if any(q[i : i + n + 1]):
        return "satisfied"
    return "violated" if i + n < len(q) else "open"


def _for(i: int, q: Sequence[bool], n: int) -> str:
    if not all(q[i : i + n + 1]):
        return "violated"
    return "satisfied" if i + n < len(q) else "open"


def _after(i: int, q: Sequence[bool], n: int) -> str:
    if any(q[i : i + n + 1]):
        return "violated"
    if i + n + 1 < len(q):
        return "satisfied" if q[i + n + 1] else "violated"
    return "open"


def _compatible(verdicts: list[str]) -> list[str]:
    """Two open demands of `after`: the first one's answer comes while the second forbids it."""
    return ["violated"] if verdicts.count("open") > 1 else verdicts


FORMS: dict[str, Demand] = {
    "the r shall always satisfy q": lambda p, q, n: "satisfied" if all(q) else "violated",
    "the r shall never satisfy p & q": lambda p, q, n: (
        "violated" if any(a and b for a, b in zip(p, q, strict=True)) else "satisfied"
    ),
    "whenever p the r shall immediately satisfy q": lambda p, q, n: _joined(
        [_within(i, q, 0) for i in _all(p)]
    ),
    "when p the r shall immediately satisfy q": lambda p, q, n: _joined(
        [_within(i, q, 0) for i in _rises(p)]
    ),
    "whenever p the r shall within {n} satisfy q": lambda p, q, n: _joined(
        [_within(i, q, n) for i in _all(p)]
    ),
    "when p the r shall within {n} satisfy q": lambda p, q, n: _joined(
        [_within(i, q, n) for i in _rises(p)]
    ),
    "whenever p the r shall for {n} satisfy q": lambda p, q, n: _joined(
        [_for(i, q, n) for i in _all(p)]
    ),
    "when p the r shall after {n} satisfy q": lambda p, q, n: _joined(
        _compatible([_after(i, q, n) for i in _rises(p)])
    ),
    "whenever p the r shall eventually satisfy q": lambda p, q, n: _joined(
        ["satisfied" if any(q[i:]) else "open" for i in _all(p)]
    ),
    "when p the r shall at the next timepoint satisfy q": lambda p, q, n: _joined(
        [("satisfied" if q[i + 1] else "violated") if i + 1 < len(q) else "open" for i in _rises(p)]
    ),
}


def verdicts(form: str, n: int, run: Run) -> set[str] | None:
    """The verdicts of all runs that this one may have been; None where there are too many.

    Args:
        form: one of `FORMS`, of the propositions `p` and `q`.
        n: how many ticks its timing counts.
        run: what was recorded.
    """
    whole, cut = zip(*(run.columns(name) for name in ("p", "q")), strict=True)
    ticks = len(whole[0])
    if not ticks:
        return {"no data"}
    every = [column + rest for column, rest in zip(whole, cut, strict=True)]
    unknown = [(c, i) for c, column in enumerate(every) for i, v in enumerate(column) if v is None]
    if len(unknown) > 6:
        return None
    words = set()
    for values in product((False, True), repeat=len(unknown)):
        for (c, i), value in zip(unknown, values, strict=True):
            every[c][i] = value
        words.add(
            _verdict(
                FORMS[form], n, [[bool(v) for v in column] for column in every], ticks, run.end
            )
        )
    return words


def _verdict(form: Demand, n: int, every: list[list[bool]], ticks: int, end: str) -> str:
    p, q = (column[:ticks] for column in every)
    verdict = form(p, q, n)
    if verdict == "open":
        return "violated" if end == "violated" else "inconclusive"
    if verdict != "violated" and len(every[0]) > ticks:
        same = all(column[ticks] == column[ticks - 1] for column in every)  # nothing has happened
        if not same and form(every[0], every[1], n) != verdict:
            return "inconclusive"
    return verdict
