"""Evaluation of formulas over whole finite traces: one bit for each tick, all ticks at once.

A column is an integer whose bit i is a truth value at tick i. Operators of the past are those of
the generated monitors (`monitors.kernel.columns`); an operator of the future is one of the past on
the trace read backwards.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import assert_never

from compiler.logic import formula as f
from fretish.reading.recursion import with_recursion_limit
from monitors.kernel import columns as c


@with_recursion_limit
def evaluate(formula: f.Formula, columns: Mapping[str, int], ticks: int) -> int:
    """The formula's truth at each tick, as `compiler.logic.definition.holds` defines it.

    Args:
        formula: past-time or future-time, on a finite trace; `LAST` is the last tick.
        columns: one for each atom.
        ticks: the length of the trace.

    Raises:
        KeyError: an atom has no column.
        ValueError: the formula speaks of probabilities.
    """
    return _Evaluation(columns, ticks, (1 << ticks) - 1).at_each_tick(formula)


def evaluate_unknown(formula: f.Formula, columns: Mapping[str, c.Column], ticks: int) -> c.Column:
    """The formula's value at each tick (true, false or unknown) where atoms may be unknown.

    True and false hold for all values of the unknown atoms. Unknown is reported too often: a
    formula can be true by two parts that are unknown. Source: Kleene, Introduction to
    Metamathematics, 1952, section 64.
    """
    (column,) = evaluate_unknown_all([formula], columns, ticks)
    return column


@with_recursion_limit
def evaluate_unknown_all(
    formulas: Sequence[f.Formula], columns: Mapping[str, c.Column], ticks: int
) -> tuple[c.Column, ...]:
    """As `evaluate_unknown` for several formulas; shared sub-formulas are computed once."""
    every = (1 << ticks) - 1
    sure = _Evaluation({name: column.true for name, column in columns.items()}, ticks, every)
    may = sure
    if any(column.unknown for column in columns.values()):
        open_ = {name: column.true | column.unknown for name, column in columns.items()}
        may = _Evaluation(open_, ticks, every)
        sure.dual, may.dual = may, sure
    true = [sure.at_each_tick(formula) for formula in formulas]
    possible = [may.at_each_tick(formula) for formula in formulas]
    return tuple(c.Column(t, p & ~t) for t, p in zip(true, possible, strict=True))


class _Evaluation:
    """The evaluation of formulas on one trace; a shared sub-formula is computed once.

    A sub-formula is recognized by its identity, because hashing a tree takes as long as the tree is
    large, and hashing each of its sub-trees the square of that.

    The result is the certain or the possible value: every operator but the negation is monotone,
    and the negation of one is the negation of the other (`dual`).
    """

    def __init__(self, columns: Mapping[str, int], ticks: int, every: int) -> None:
        self._columns, self._ticks, self._every = columns, ticks, every
        self._cache: dict[int, tuple[f.Formula, int]] = {}
        self.dual = self

    def at_each_tick(self, formula: f.Formula) -> int:
        """The column of the formula."""
        entry = self._cache.get(id(formula))
        if entry is None:
            entry = self._cache[id(formula)] = (formula, self._column(formula))
        return entry[1]

    def _column(self, formula: f.Formula) -> int:
        read, negated, every = self.at_each_tick, self._negated, self._every
        match formula:
            case f.Const(value):
                return every if value else 0
            case f.Atom(name):
                return self._columns[name]
            case f.Last():
                return every ^ every >> 1
            case f.Not(arg):
                return negated(arg)
            case f.And(args):
                column = every
                for arg in args:
                    column &= read(arg)
                return column
            case f.Or(args):
                column = 0
                for arg in args:
                    column |= read(arg)
                return column
            case f.Xor(left, right):
                return read(left) & negated(right) | negated(left) & read(right)
            case f.Implies(left, right):
                return negated(left) | read(right)
            case f.Iff(left, right):
                return read(left) & read(right) | negated(left) & negated(right)
            case f.ProbabilityBound():
                raise ValueError("one trace does not show a probability")
            case f.Next() | f.Eventually() | f.Globally() | f.Until() | f.Release():
                return self._future(formula)
            case _:
                return self._past(formula)

    def _negated(self, formula: f.Formula) -> int:
        return self._every ^ self.dual.at_each_tick(formula)

    def _past(
        self, formula: f.Previous | f.WeakPrevious | f.Once | f.Historically | f.Since
    ) -> int:
        read, every = self.at_each_tick, self._every
        match formula:
            case f.Previous(arg):
                return c.previous(read(arg), every)
            case f.WeakPrevious(arg):
                return c.weak_previous(read(arg), every)
            case f.Once(arg, ago):
                return c.once(read(arg), ago.lo, ago.hi, every)
            case f.Historically(arg, ago):
                return c.historically(read(arg), ago.lo, ago.hi, every)
            case f.Since(left, right, ago):
                return c.since_between(read(left), read(right), ago.lo, ago.hi, every)
            case _:
                assert_never(formula)

    def _future(self, formula: f.Next | f.Eventually | f.Globally | f.Until | f.Release) -> int:
        every = self._every
        match formula:
            case f.Next(arg):
                return self.at_each_tick(arg) >> 1
            case f.Eventually(arg, ahead):
                return self._mirrored(c.once(self._mirror(arg), ahead.lo, ahead.hi, every))
            case f.Globally(arg, ahead):
                return self._mirrored(c.historically(self._mirror(arg), ahead.lo, ahead.hi, every))
            case f.Until(left, right):
                return self._mirrored(c.since(self._mirror(left), self._mirror(right)))
            case f.Release(left, right):
                return self._mirrored(c.released(self._mirror(left), self._mirror(right)))
            case _:
                assert_never(formula)

    def _mirror(self, formula: f.Formula) -> int:
        return self._mirrored(self.at_each_tick(formula))

    def _mirrored(self, column: int) -> int:
        """The column read backwards."""
        size = (self._ticks + 7) // 8
        data = column.to_bytes(size, "little").translate(_MIRRORED)[::-1]
        return int.from_bytes(data, "little") >> (8 * size - self._ticks)


_MIRRORED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))
