"""`... for 200 ms` over ticks: a count of the ticks since the last interruption.

The duration is true at a tick if its argument was in force at the tick that lies so far back, and
true at all steps since. A tick records whether the argument is true at all steps and whether it is
in force at the end; a count stores the rest. In the first 200 ms of a log the value is left open.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import product

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.memory import (
    Memory,
    constant,
    either,
    equals,
    only,
    some,
    successor,
)
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.arithmetic.readings import AtomReading
from fretish import expressions as e
from fretish.bindings.declarations import Aggregate
from fretish.classes.frozen import dataclass
from fretish.printer import expression as printed

_MOST = 3
"""Maximum number of durations in a proposition; each doubles its cases."""


@dataclass(frozen=True, slots=True)
class StoredDuration:
    """A duration that has to be stored."""

    throughout: str
    """Atom: the argument is true at all steps of a tick."""
    at_last: str
    """Atom: the argument is in force at the end of a tick."""
    ticks: int


@dataclass(frozen=True, slots=True)
class DurationProposition:
    """A proposition with durations."""

    durations: tuple[StoredDuration, ...]
    cases: Mapping[tuple[bool, ...], str]
    """Truth values of the durations → atom that then equals the proposition."""

    @property
    def atoms(self) -> Iterator[str]:
        """All atoms that decide the proposition."""
        for each in self.durations:
            yield from (each.throughout, each.at_last)
        yield from self.cases.values()


def parted(
    name: str, reading: AtomReading
) -> tuple[Mapping[str, AtomReading], DurationProposition | None]:
    """A reading as readings of single ticks, and their combination; None: it is a single one.

    Raises:
        UnsupportedError: a duration cannot be counted in ticks.
    """
    spans = list(dict.fromkeys(_durations(reading.expression)))
    if not spans:
        return {name: reading}, None
    if reading.aggregate is not Aggregate.LAST or reading.on_unknown is not None:
        raise UnsupportedError(
            "has a duration that is measured between ticks or over unknown values"
        )
    if len(spans) > _MOST:
        raise UnsupportedError("has too many durations")
    readings: dict[str, AtomReading] = {}
    durations = []
    for span in spans:
        if reading.period is None or span.duration % reading.period or span.duration == 0:
            raise UnsupportedError("has a duration that is not a whole number of ticks")
        if any(_durations(span.arg)):
            raise UnsupportedError("has a duration within another one")
        text = printed(span.arg)
        made = StoredDuration(
            f"{text} throughout", f"{text} at last", span.duration // reading.period
        )
        readings[made.throughout] = replace(reading, expression=span.arg, aggregate=Aggregate.ALL)
        readings[made.at_last] = replace(reading, expression=span.arg)
        durations.append(made)
    cases = {}
    for values in product((True, False), repeat=len(spans)):
        expression = _put(reading.expression, dict(zip(spans, values, strict=True)))
        cases[values] = f"{name} where {values}"
        readings[cases[values]] = replace(reading, expression=expression)
    return readings, DurationProposition(tuple(durations), cases)


def _durations(part: e.Expression) -> Iterator[e.Persistence]:
    """The outermost durations."""
    if isinstance(part, e.Persistence):
        yield part
        return
    for each in e.children(part):
        yield from _durations(each)


def _put(part: e.Expression, values: Mapping[e.Persistence, bool]) -> e.Expression:
    if isinstance(part, e.Persistence):
        return e.Truth(values[part])
    return e.with_children(part, [_put(each, values) for each in e.children(part)])


@dataclass(frozen=True, slots=True)
class DurationValue:
    """Truth of a duration, over a valuation and stored bits."""

    is_so: Function
    is_open: Function
    """Function: the value depends on ticks before the first one."""


def held(
    memory: Memory, ticks: int, throughout: Function, at_last: Function, open_: Function
) -> DurationValue:
    """Whether something has lasted for a number of ticks.

    Args:
        memory: memory for the bits.
        ticks: at least one.
        throughout: whether it is true at all steps of a tick.
        at_last: whether it is in force at the end of a tick; true if it is true throughout.
        open_: whether it counts as lasting since before the first tick.
    """
    bits, known = memory.word(ticks)
    is_enough = equals(known, ticks)
    more = either(is_enough, constant(ticks, known), successor(known))
    memory.set(bits, only(at_last, either(throughout & some(known), more, constant(1, known))))
    broken = memory.bit()
    was = bdd.variable(broken.now)
    memory.steps[broken] = was | -throughout
    is_open = throughout - was - is_enough
    return DurationValue((throughout & is_enough) | (is_open & open_), is_open)
