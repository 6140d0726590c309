"""The column program of a monitor: as terms, and compared with its steps on random traces.

Equal terms are equal columns of any trace. A name represents its assigned term, a parameter its
literal. So two programs with equal terms differ only in the names of their variables, and a proof
about one, for all lengths of a trace, holds for the other. Random traces show where a program and
the steps of its monitor differ.
"""

from __future__ import annotations

import ast
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from functools import lru_cache
from typing import Any

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import impossible_combinations
from compiler.logic.orders import Exclusion
from compiler.program.program import SIGNALS
from fretc.verification.monitor.text_check import own
from fretish.classes.frozen import dataclass
from monitors.kernel import Column, Monitor
from monitors.kernel.columns import column, truths
from monitors.kernel.stepping import literals_of
from monitors.kernel.verdicts import Truth

DRAWN = 20
"""Number of random traces for comparing the column program, if the bound is small."""
_FEWEST, _TICKS = 4, 40_000
"""Minimum number of traces; maximum number of ticks in all, if there are more traces than that."""
_FALSE = Column(0, 0)

Word = tuple[tuple[Truth, ...], ...]
"""The values of the propositions at each tick; None: unknown."""


# Terms ------------------------------------------------------------------------------------------


@dataclass(slots=True)
class TermTable:
    """Terms as numbers, equal for equal terms; texts to compare share one table."""

    _numbers: dict[tuple[object, ...], int] = field(default_factory=dict)

    def of(self, text: str, index: int) -> tuple[int, ...]:
        """The terms of a requirement's signals, in their order.

        Args:
            text: text of a monitor, in the layout that fretc writes.
            index: index of the requirement in the monitor.

        Raises:
            KeyError, IndexError: a signal, or the requirement, is missing.
        """
        monitor = next(
            node
            for node in own(text).body
            if isinstance(node, ast.ClassDef) and node.name.endswith("Monitor")
        )
        names = {"every": self._number("every"), **self._literals(monitor)}
        (columns,) = (
            part
            for part in monitor.body
            if isinstance(part, ast.FunctionDef) and part.name == "columns"
        )
        *_, last = columns.body
        for statement in columns.body:
            match statement:
                case ast.Assign([ast.Name(name)], value):
                    names[name] = self._term(value, names)
        assert isinstance(last, ast.Return)
        assert isinstance(last.value, ast.Tuple)
        signals = last.value.elts[index]
        assert isinstance(signals, ast.Call)
        terms = {keyword.arg: self._term(keyword.value, names) for keyword in signals.keywords}
        return tuple(terms[name] for name in SIGNALS)

    def _literals(self, monitor: ast.ClassDef) -> dict[str, int]:
        for part in monitor.body:
            match part:
                case ast.Assign([ast.Name("LITERALS")], value):
                    literals: tuple[tuple[str, str, bool], ...] = ast.literal_eval(value)
                    return {
                        name: self._number("literal", proposition, positive)
                        for name, proposition, positive in literals
                    }
        return {}

    def _number(self, *term: object) -> int:
        return self._numbers.setdefault(term, len(self._numbers))

    def _term(self, node: ast.expr, names: Mapping[str, int]) -> int:
        match node:
            case ast.Name(name):
                return names[name]
            case ast.Constant(value):
                return self._number("constant", type(value), value)
            case ast.BinOp(left, operator, right):
                parts: Any = self._term(left, names), self._term(right, names)
                return self._number(type(operator), *parts)
            case ast.Call(ast.Name(name), args):
                return self._number(name, *(self._term(arg, names) for arg in args))
            case _:
                raise AssertionError(f"not laid out as fretc writes it: {ast.unparse(node)}")


# Drawn traces -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Disagreement:
    """A trace at whose last tick both programs differ."""

    word: Word


def agreed(
    requirement: FormalizedRequirement,
    monitor: Monitor,
    index: int,
    atoms: Sequence[str],
    never: Sequence[Exclusion] = (),
) -> int | Disagreement:
    """Number of ticks on which both programs agree; or a trace on which they do not.

    Args:
        requirement: the requirement.
        monitor: monitor with both programs.
        index: index of the requirement in the monitor.
        atoms: atoms on which the requirement depends.
        never: additional combinations that are excluded.
    """
    bound, never = requirement.ticks or 0, (*impossible_combinations(requirement), *never)
    is_alone = len(monitor.REQUIREMENTS) == 1
    traces = _traces(monitor, bound, *((tuple(atoms), never) if is_alone or never else ((), ())))
    for columns, ticks in traces:
        tick = ticks[index]
        if tick is not None:
            word = tuple(_rows({n: columns.get(n, _FALSE) for n in atoms}, tick + 1))
            return Disagreement(word)
    return len(traces) * _length(bound)


def _length(bound: int) -> int:
    """Length of the traces for a bound, in ticks."""
    return 4 * bound + 50


@lru_cache(maxsize=16)
def _traces(
    monitor: Monitor, bound: int, atoms: tuple[str, ...], never: tuple[Exclusion, ...]
) -> tuple[tuple[Mapping[str, Column], tuple[int | None, ...]], ...]:
    """Random traces, with the first tick at which the programs differ, for each requirement.

    Requirements of one file and one bound share them.

    Args:
        monitor: monitor of one requirement or several.
        bound: bound on which edges depend.
        atoms: propositions with random values; empty: all of the monitor.
        never: combinations that cannot occur.
    """
    choose, length = random.Random(bound), _length(bound)
    traces = []
    for number in range(min(DRAWN, max(_FEWEST, _TICKS // length))):
        odds = 0.02 if number % 2 else 0.0
        names = atoms or monitor.PROPOSITIONS
        drawn = {name: _drawn(choose, length, bound, odds) for name in names}
        drawn = _possible(drawn, never, length)
        traces.append((drawn, _first_differences(monitor, drawn, length)))
    return tuple(traces)


def _possible(
    columns: Mapping[str, Column], excluded: Sequence[Exclusion], length: int
) -> dict[str, Column]:
    """The columns with unknown values in place of impossible combinations."""
    every, possible = (1 << length) - 1, dict(columns)
    for exclusion in excluded:
        at = every
        for name, value in exclusion:
            true, unknown = possible[name]
            at &= true if value else every ^ (true | unknown)
        for name, _ in exclusion:
            true, unknown = possible[name]
            possible[name] = Column(true & ~at, unknown | at)
    return possible


def _first_differences(
    monitor: Monitor, columns: Mapping[str, Column], length: int
) -> tuple[int | None, ...]:
    """For each requirement, the first tick at which an approximation of the programs differs.

    Propositions without a column are false.
    """
    every, places = (1 << length) - 1, range(len(monitor.REQUIREMENTS))
    columns = {**dict.fromkeys(monitor.PROPOSITIONS, _FALSE), **columns}
    try:
        certain, possible = (
            monitor.columns(every, **literals_of(monitor, columns, every, is_possible))
            for is_possible in (False, True)
        )
        beyond = [any(each >> length for each in (*certain[i], *possible[i])) for i in places]
    except Exception:
        return (length - 1,) * len(places)
    ticks: list[int | None] = [length - 1 if is_beyond else None for is_beyond in beyond]
    monitor.reset()
    values = [truths(columns[name], length) for name in monitor.PROPOSITIONS]
    for tick in range(length):
        monitor.advance([tuple([column[tick] for column in values])])
        for approximation, expected in ((monitor.certain, certain), (monitor.possible, possible)):
            signals = approximation.signals()
            for index in [index for index in places if ticks[index] is None]:
                now = [bool(column >> tick & 1) for column in expected[index]]
                if [bool(value) for value in signals[index]] != now:
                    ticks[index] = tick
    return tuple(ticks)


def _drawn(choose: random.Random, length: int, bound: int, unknown: float) -> Column:
    """A random column, with its own probability or with runs about as long as the bound."""
    if choose.random() < 0.5:
        odds = choose.choice((0.02, 0.2, 0.5, 0.95))
        codes = bytearray(choose.random() < odds for _ in range(length))
    else:
        codes, value = bytearray(), choose.randrange(2)
        while len(codes) < length:
            run = choose.choice((1, 1, 2, bound - 1, bound, bound + 1, bound + 2))
            codes += bytes((value,)) * run
            value = 1 - value
        del codes[length:]
    if unknown:
        codes = bytearray(2 if choose.random() < unknown else code for code in codes)
    return column(codes)


def _rows(columns: Mapping[str, Column], length: int) -> Iterator[tuple[Truth, ...]]:
    return (tuple(column.at(tick) for column in columns.values()) for tick in range(length))
