"""Compilation of past-time formulas into the program of a monitor.

Negations are pushed down to the propositions, so every value is monotone in the literals. Where a
negation meets a temporal operator, its dual is computed.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import field

from compiler.formalization.past import MonitorSpec
from compiler.logic import formula as f
from compiler.logic import printing
from compiler.program import columns
from compiler.program.columns import AtFirst, Column, PreviousColumn
from compiler.program.instructions import (
    Advance,
    Assign,
    Choose,
    Instruction,
    SetCounter,
    Shift,
    Slide,
)
from compiler.program.program import (
    Block,
    Cell,
    Counter,
    Program,
    RequirementProgram,
    StoredFlag,
    WindowMemory,
)
from compiler.program.values import (
    FALSE,
    TRUE,
    Age,
    And,
    Comparison,
    Literal,
    Value,
    Variable,
    and_,
    not_,
    or_,
)
from fretish.classes.frozen import dataclass
from fretish.reading.recursion import with_recursion_limit
from monitors.kernel.verdicts import Signals


@with_recursion_limit
def program(watches: Mapping[str, MonitorSpec], taken: Collection[str] = ()) -> Program:
    """The program for the signals of monitor specifications; shared sub-formulas are computed once.

    Args:
        watches: requirement id → monitor specification, with past-time formulas only.
        taken: reserved names for cells and variables.
    """
    writer = _FormulaLowering(frozenset(taken))
    requirements = tuple(
        RequirementProgram(id, Signals(*map(writer.value, w.signals)), w.deadline_ticks, w.renewed)
        for id, w in watches.items()
    )
    return Program(
        tuple(writer.literals),
        tuple(cell for part in writer.parts for cell in part.cells()),
        tuple(part.block() for part in writer.parts),
        requirements,
    )


@dataclass(frozen=True, slots=True)
class _BlockCells:
    """A block and its cells, built after all users of its counter are known."""

    block: Callable[[], Block]
    cells: Callable[[], tuple[Cell, ...]]


@dataclass(slots=True)
class _Counter:
    """Ticks since a witness of `left S right`; `most` is the largest bound of all its users."""

    name: str
    guard: Value
    witness: Value
    comment: str
    youngest: bool
    most: int = 0

    def cells(self) -> tuple[Cell, ...]:
        """Counters: the youngest witness to `most` + 1 (none), the oldest to `most` (-1: none)."""
        least, most = (0, self.most + 1) if self.youngest else (-1, self.most)
        none = self._none
        return (Counter(self.name, none, least, most, f"{self.comment}; {none}: none"),)

    def block(self) -> Block:
        """The block that moves the counter at a tick."""
        none, born = SetCounter(self.name, self._none), SetCounter(self.name, 0)
        if self.youngest:
            grown = Advance(self.name, self._none)
            choice = _choice((self.witness, born), (self.guard, grown), none)
        else:
            grown = Advance(self.name, self.most)
            there: Value = Age(self.name, Comparison.AT_LEAST, 0)
            kept = there if self.guard == TRUE else And((there, self.guard))
            choice = _choice((kept, grown), (self.witness, born), none)
        return Block(self.name, self.comment, (choice,), None)

    @property
    def _none(self) -> int:
        return self.most + 1 if self.youngest else -1


_Branch = tuple[Value, SetCounter | Advance]


def _choice(first: _Branch, second: _Branch, last: SetCounter | Advance) -> Choose:
    """A choice of three branches, or of two if the second condition is constant."""
    condition, then = second
    if condition in (TRUE, FALSE):
        return Choose((first,), then if condition == TRUE else last)
    return Choose((first, second), last)


@dataclass(frozen=True, slots=True)
class _Sides:
    """The sides of a since, or of its dual, as values over the literals."""

    left: f.Formula
    right: f.Formula
    positive: bool
    guard: Value
    witness: Value

    def conditions(self) -> tuple[Value, Value]:
        """The guard and the witness of the since itself."""
        if self.positive:
            return self.guard, self.witness
        return not_(self.guard), not_(self.witness)

    def column(self, ago: f.Interval = f.EVER, unbounded: str | None = None) -> columns.SinceColumn:
        """The column over whole traces."""
        guard = None if self.left == f.TRUE else self.guard
        return columns.SinceColumn(
            guard, self.witness, ago.lo, ago.hi, not self.positive, unbounded
        )


@dataclass(slots=True)
class _FormulaLowering:
    """A writer that visits formulas bottom-up, and makes one part for each temporal operator."""

    taken: frozenset[str]
    literals: dict[Literal, None] = field(default_factory=dict)
    parts: list[_BlockCells] = field(default_factory=list)
    _values: dict[tuple[f.Formula, bool], Value] = field(default_factory=dict)
    _counters: dict[tuple[bool, f.Formula, f.Formula, bool], _Counter] = field(default_factory=dict)
    _unbounded: dict[tuple[f.Formula, f.Formula, bool], str] = field(default_factory=dict)
    _counts: dict[str, int] = field(default_factory=dict)

    def value(self, formula: f.Formula, positive: bool = True) -> Value:
        """The formula, or its negation, at the present tick."""
        match formula:
            case f.Const(value):
                return TRUE if value == positive else FALSE
            case f.Atom(name):
                literal = Literal(name, positive)
                self.literals[literal] = None
                return literal
            case f.Not(arg):
                return self.value(arg, not positive)
            case f.And(args) | f.Or(args):
                values = [self.value(arg, positive) for arg in args]
                return and_(values) if isinstance(formula, f.And) == positive else or_(values)
            case f.Implies(left, right):
                return self.value(f.Or((f.Not(left), right)), positive)
            case f.Iff(left, right):
                return self.value(f.Xor(left, right), not positive)
            case _:
                return self._shared(formula, positive)

    def _shared(self, formula: f.Formula, positive: bool) -> Value:
        """A named value, whose part is written once."""
        key = formula, positive
        if key not in self._values:
            self._values[key] = self._value(formula, positive)
        return self._values[key]

    def _value(self, formula: f.Formula, positive: bool) -> Value:
        match formula:
            case f.Xor(left, right):
                return self._differing(formula, left, right, positive)
            case f.WeakPrevious(f.Const(False)) if positive:
                return self._first()
            case f.Previous(arg) | f.WeakPrevious(arg):
                weak = isinstance(formula, f.WeakPrevious)
                return self._before(self.value(arg, positive), weak == positive, formula, positive)
            case f.Once(arg, ago):
                return self._since(f.TRUE, arg, ago, formula, positive)
            case f.Historically(arg, ago):
                return self._since(f.TRUE, f.not_(arg), ago, formula, not positive, positive)
            case f.Since(left, right, ago):
                return self._since(left, right, ago, formula, positive)
            case _:
                raise AssertionError(f"not a past-time operator: {formula}")

    def _name(self, kind: str) -> str:
        """A fresh name."""
        while True:
            self._counts[kind] = self._counts.get(kind, 0) + 1
            name = f"{kind}_{self._counts[kind]}"
            if self.taken.isdisjoint((name, f"kept_{name}")):
                return name

    def _comment(self, formula: f.Formula, positive: bool) -> str:
        return printing.readable(formula if positive else f.not_(formula))

    def _first(self) -> Value:
        """True at tick 0."""
        return self._add(
            "first",
            "(Z FALSE): no tick came before",
            Shift("first", "kept_first", FALSE),
            AtFirst(),
            StoredFlag("kept_first", True, "whether the next tick is the first"),
        )

    def _differing(
        self, formula: f.Formula, left: f.Formula, right: f.Formula, positive: bool
    ) -> Value:
        """The difference of two formulas, or their agreement if negated."""
        value = or_(
            [
                and_([self.value(left), self.value(right, not positive)]),
                and_([self.value(left, False), self.value(right, positive)]),
            ]
        )
        name = self._name("differ" if positive else "agree")
        return self._add(name, self._comment(formula, positive), Assign(name, value), value)

    def _before(self, value: Value, weak: bool, formula: f.Formula, positive: bool) -> Value:
        """The value of the tick before; at tick 0 it is `weak`."""
        name, comment = self._name("before"), self._comment(formula, positive)
        kept = StoredFlag(f"kept_{name}", weak, comment)
        return self._add(
            name, comment, Shift(name, kept.name, value), PreviousColumn(value, weak), kept
        )

    def _since(
        self,
        left: f.Formula,
        right: f.Formula,
        ago: f.Interval,
        formula: f.Formula,
        positive: bool,
        displayed: bool | None = None,
    ) -> Value:
        """`left S[ago] right`, or its negation; `displayed` says which of them `formula` is."""
        if right == f.TRUE and ago.lo == 0:
            return TRUE if positive else FALSE
        comment = self._comment(formula, positive if displayed is None else displayed)
        guard, witness = self.value(left, positive), self.value(right, positive)
        sides = _Sides(left, right, positive, guard, witness)
        if ago == f.EVER:
            return self._ever(sides, comment)
        if ago.hi is not None and ago.lo > 0:
            return self._window(sides, ago.lo, ago.hi, comment)
        return self._by_count(sides, ago, comment)

    def _ever(self, sides: _Sides, comment: str) -> Value:
        """A since without bounds, kept in one truth value."""
        counter = self._counters.get((False, sides.left, sides.right, sides.positive))
        if counter is not None:
            column = Variable(self._without_bounds(sides))
            name = self._name("since")
            age = Comparison.AT_LEAST if sides.positive else Comparison.LESS
            return self._add(name, comment, Assign(name, Age(counter.name, age, 0)), column)
        name = self._name("since")
        witness, guard, before = sides.witness, sides.guard, Variable(name)
        if sides.positive:
            value = or_([witness, and_([guard, before])])
        else:
            value = and_([witness, or_([guard, before])])
        cell = StoredFlag(name, not sides.positive, comment)
        return self._add(name, comment, Assign(name, value), sides.column(), cell)

    def _by_count(self, sides: _Sides, ago: f.Interval, comment: str) -> Value:
        """A since with one bound, by counting ticks since one witness, at constant cost."""
        bound = ago.lo if ago.hi is None else ago.hi
        counter = self._counter(ago.hi is not None, sides)
        counter.most = max(counter.most, bound)
        unbounded = None
        if ago.hi is None:
            age = Comparison.AT_LEAST if sides.positive else Comparison.LESS
            if sides.positive and sides.left != f.TRUE:
                unbounded = self._without_bounds(sides)
        else:
            age = Comparison.AT_MOST if sides.positive else Comparison.MORE
        name = self._name("since")
        value = Age(counter.name, age, bound)
        return self._add(name, comment, Assign(name, value), sides.column(ago, unbounded))

    def _without_bounds(self, sides: _Sides) -> str:
        """The column of the operator without bounds, from which the bounded one is computed."""
        key = sides.left, sides.right, sides.positive
        if key not in self._unbounded:
            self._unbounded[key] = name = self._name("held")
            since = f.since(sides.left, sides.right)
            self._add(name, self._comment(since, sides.positive), None, sides.column())
        return self._unbounded[key]

    def _counter(self, youngest: bool, sides: _Sides) -> _Counter:
        key = youngest, sides.left, sides.right, sides.positive
        if key not in self._counters:
            kind = "youngest" if youngest else "oldest"
            witness = printing.readable(f.since(sides.left, sides.right))
            comment = f"ticks since the {kind} witness of {witness}"
            counter = _Counter(self._name(kind), *sides.conditions(), comment, youngest)
            self._counters[key] = counter
            self.parts.append(_BlockCells(counter.block, counter.cells))
        return self._counters[key]

    def _window(self, sides: _Sides, lo: int, hi: int, comment: str) -> Value:
        """A since with both bounds, which keeps the witnesses within the window."""
        name = self._name("since")
        cell = WindowMemory(f"kept_{name}", lo, hi, comment)
        slide = Slide(name, cell.name, *sides.conditions(), not sides.positive)
        return self._add(name, comment, slide, sides.column(f.Interval(lo, hi)), cell)

    def _add(
        self, name: str, comment: str, does: Instruction | None, column: Column, *cells: Cell
    ) -> Value:
        block = Block(name, comment, (does,) if does is not None else (), column)
        self.parts.append(_BlockCells(lambda: block, lambda: cells))
        return Variable(name)
