"""Past-time formulas → straight-line Python: tick by tick, and over columns of whole traces.

A rail computes everything from literals: a proposition or its negation. Negations are pushed down
to them, so every value is monotone in the literals, and the same code computes what holds for
certain and what may hold. Where a negation meets a temporal operator, its dual is computed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from compiler.formalization.past import Watch
from compiler.logic import formula as f
from compiler.logic import printing
from fretish.reading.recursion import deep
from monitors.kernel.stepping import Marks
from monitors.kernel.verdicts import Signals

_OR, _AND, _ATOMIC = range(3)
"""How tight Python's operators bind; a column's do in the same order."""

SIGNALS, MARKS = Signals._fields, Marks._fields
"""The signals of a rail, and the ticks that it remembers, for each requirement."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A variable that lives from tick to tick."""

    name: str
    initial: str
    comment: str


@dataclass(frozen=True, slots=True)
class Block:
    """The statements of one temporal operator, below a comment with its formula."""

    comment: str
    lines: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class RequirementSignals:
    """The signals of one requirement: each an expression of a step, and one over columns."""

    id: str
    prefix: str
    """An identifier, no other's in this program."""
    step: Mapping[str, str]
    tight: Mapping[str, str]
    """As `step`, in parentheses where an operator before it would ask for them."""
    columns: Mapping[str, str]
    renewed: bool

    @property
    def marks(self) -> tuple[str, ...]:
        """The `MARKS` that can change: those whose signal can ever be true."""
        sources = zip(MARKS, ("breach", "doom", "trigger", "owed"), strict=True)
        return tuple(mark for mark, signal in sources if self.step[signal] != "False")


@dataclass(frozen=True, slots=True)
class Literal:
    """A proposition or its negation, as a variable."""

    name: str
    proposition: str
    positive: bool


@dataclass(frozen=True, slots=True)
class Program:
    """A rail's cells, its steps at each tick and its signals; and the same over columns."""

    literals: tuple[Literal, ...]
    cells: tuple[Cell, ...]
    steps: tuple[Block, ...]
    columns: tuple[Block, ...]
    requirements: tuple[RequirementSignals, ...]


@deep
def program(
    watches: Mapping[str, Watch], parameters: Mapping[str, str], prefixes: Mapping[str, str]
) -> Program:
    """Compile the signals of watches; a sub-formula that comes twice is computed once.

    Args:
        watches: of each requirement's id; past-time formulas only.
        parameters: a Python identifier for each proposition.
        prefixes: a Python identifier for each requirement's id.
    """
    writer = _Writer(parameters, prefixes.values())
    requirements = tuple(_signals(writer, id, prefixes[id], watch) for id, watch in watches.items())
    return Program(
        tuple(writer.literals.values()),
        tuple(cell for part in writer.parts for cell in part.cells()),
        tuple(Block(part.comment, lines) for part in writer.parts if (lines := part.step())),
        tuple(Block(part.comment, part.column) for part in writer.parts if part.column),
        requirements,
    )


def _signals(writer: _Writer, id: str, prefix: str, watch: Watch) -> RequirementSignals:
    texts = {name: writer.text(signal) for name, signal in watch.signals._asdict().items()}
    return RequirementSignals(
        id,
        prefix,
        {name: text.step for name, text in texts.items()},
        {name: text.grouped(_ATOMIC).step for name, text in texts.items()},
        {name: text.column for name, text in texts.items()},
        watch.renewed,
    )


def locals_of(parameters: Iterable[str]) -> frozenset[str]:
    """The parameters of a step and the names of their negations."""
    return frozenset(name for p in parameters for name in (p, negation(p)))


def negation(parameter: str) -> str:
    """The name of the negation of a proposition."""
    return f"not_{parameter}"


def marks_of(prefix: str) -> frozenset[str]:
    """The names that a rail keeps for a requirement."""
    return frozenset(f"{prefix}_{name}" for name in (*MARKS, "signals"))


class _Text(NamedTuple):
    """One value: as an expression of a step and over columns, and how tight both bind."""

    step: str
    column: str
    rank: int = _ATOMIC

    def grouped(self, loosest: int) -> _Text:
        """In parentheses where Python's operators ask for them."""
        if self.rank >= loosest:
            return self
        return _Text(f"({self.step})", f"({self.column})")


_TRUE, _FALSE = _Text("True", "every"), _Text("False", "0")


@dataclass(slots=True)
class _Part:
    """The cells and the code of one temporal operator."""

    name: str
    comment: str
    column: tuple[str, ...]
    step: Callable[[], tuple[str, ...]]
    cells: Callable[[], tuple[Cell, ...]]


@dataclass(slots=True)
class _Counter:
    """Ticks since a witness of `left S right`; `most` is the largest bound of all its users."""

    name: str
    left: _Text
    right: _Text
    most: int = 0
    dual: bool = False

    def youngest(self) -> tuple[str, ...]:
        """Since the youngest witness, up to `most` + 1: none."""
        none = self.most + 1
        return (
            f"if {self._witness}:",
            f"    {self.name} = 0",
            *_otherwise(
                self._guard,
                f"{self.name} = {self.name} + 1 if {self.name} < {none} else {none}",
                f"{self.name} = {none}",
            ),
        )

    def oldest(self) -> tuple[str, ...]:
        """Since the oldest witness, up to `most`; -1: none."""
        guard = self._guard
        return (
            f"if {self.name} >= 0{'' if guard == 'True' else f' and {guard}'}:",
            f"    {self.name} = {self.name} + 1 if {self.name} < {self.most} else {self.most}",
            *_otherwise(self._witness, f"{self.name} = 0", f"{self.name} = -1"),
        )

    @property
    def _guard(self) -> str:
        return _holds(self.left, dual=self.dual)

    @property
    def _witness(self) -> str:
        return _holds(self.right, dual=self.dual)


def _holds(value: _Text, *, dual: bool) -> str:
    """The condition of a step; of a dual operator, its negation."""
    if not dual:
        return value.grouped(_AND).step
    if value.step in ("True", "False"):
        return str(value.step == "False")
    return f"not {value.grouped(_ATOMIC).step}"


def _otherwise(condition: str, statement: str, last: str) -> tuple[str, ...]:
    """The rest of an `if`: a condition that is a constant leaves one branch."""
    if condition == "True":
        return ("else:", f"    {statement}")
    if condition == "False":
        return ("else:", f"    {last}")
    return (f"elif {condition}:", f"    {statement}", "else:", f"    {last}")


@dataclass(slots=True)
class _Writer:
    """One walk over formulas from the leaves up: one part for each temporal operator."""

    parameters: Mapping[str, str]
    prefixes: Iterable[str]
    literals: dict[tuple[str, bool], Literal] = field(default_factory=dict)
    parts: list[_Part] = field(default_factory=list)
    _values: dict[tuple[f.Formula, bool], _Text] = field(default_factory=dict)
    _counters: dict[tuple[str, f.Formula, f.Formula, bool], _Counter] = field(default_factory=dict)
    _columns: dict[tuple[str, f.Formula, f.Formula, bool], str] = field(default_factory=dict)
    _reserved: set[str] = field(default_factory=set)
    _counts: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._reserved = {
            *locals_of(self.parameters.values()),
            *(name for prefix in self.prefixes for name in marks_of(prefix)),
        }

    def text(self, formula: f.Formula, positive: bool = True) -> _Text:
        """The formula, or its negation, at the present tick."""
        match formula:
            case f.Const(value):
                return _TRUE if value == positive else _FALSE
            case f.Atom(name):
                return self._literal(name, positive)
            case f.Not(arg):
                return self.text(arg, not positive)
            case f.And(args) | f.Or(args):
                texts = [self.text(arg, positive) for arg in args]
                return _both(texts) if isinstance(formula, f.And) == positive else _either(texts)
            case f.Implies(left, right):
                return self.text(f.Or((f.Not(left), right)), positive)
            case f.Iff(left, right):
                return self.text(f.Xor(left, right), not positive)
            case _:
                return self._shared(formula, positive)

    def _literal(self, proposition: str, positive: bool) -> _Text:
        parameter = self.parameters[proposition]
        name = parameter if positive else negation(parameter)
        self.literals[proposition, positive] = Literal(name, proposition, positive)
        return _Text(name, name)

    def _shared(self, formula: f.Formula, positive: bool) -> _Text:
        """A value with a name of its own; its part is written once."""
        key = formula, positive
        if key not in self._values:
            self._values[key] = self._value(formula, positive)
        return self._values[key]

    def _value(self, formula: f.Formula, positive: bool) -> _Text:
        match formula:
            case f.Xor(left, right):
                return self._differing(formula, left, right, positive)
            case f.WeakPrevious(f.Const(False)) if positive:
                return self._first()
            case f.Previous(arg) | f.WeakPrevious(arg):
                weak = isinstance(formula, f.WeakPrevious)
                return self._before(self.text(arg, positive), weak == positive, formula, positive)
            case f.Once(arg, ago):
                return self._since(f.TRUE, arg, ago, formula, positive)
            case f.Historically(arg, ago):
                return self._since(f.TRUE, f.not_(arg), ago, formula, not positive, positive)
            case f.Since(left, right, ago):
                return self._since(left, right, ago, formula, positive)
            case _:
                raise AssertionError(f"not a past-time operator: {formula}")

    def _name(self, kind: str) -> str:
        """A name that nothing else has."""
        while True:
            self._counts[kind] = self._counts.get(kind, 0) + 1
            name = f"{kind}_{self._counts[kind]}"
            if not {name, f"kept_{name}"} & self._reserved:
                return name

    def _comment(self, formula: f.Formula, positive: bool) -> str:
        return printing.readable(formula if positive else f.not_(formula))

    def _first(self) -> _Text:
        """True at tick 0."""
        part = _Part(
            "first",
            "(Z FALSE): no tick came before",
            (),
            lambda: ("first, kept_first = kept_first, False",),
            lambda: (Cell("kept_first", "True", "whether the next tick is the first"),),
        )
        self.parts.append(part)
        return _Text("first", "(every & 1)")

    def _differing(
        self, formula: f.Formula, left: f.Formula, right: f.Formula, positive: bool
    ) -> _Text:
        """A difference, or where it is negated, an agreement."""
        text = _either(
            [
                _both([self.text(left), self.text(right, not positive)]),
                _both([self.text(left, False), self.text(right, positive)]),
            ]
        )
        name = self._name("differ" if positive else "agree")
        self._add(name, self._comment(formula, positive), text.column, (f"{name} = {text.step}",))
        return _Text(name, name)

    def _before(self, arg: _Text, weak: bool, formula: f.Formula, positive: bool) -> _Text:
        """The value of the tick before; at tick 0 it is `weak`."""
        name, comment = self._name("before"), self._comment(formula, positive)
        self._add(
            name,
            comment,
            f"{'weak_previous' if weak else 'previous'}({arg.column}, every)",
            (f"{name}, kept_{name} = kept_{name}, {arg.step}",),
            Cell(f"kept_{name}", str(weak), comment),
        )
        return _Text(name, name)

    def _since(
        self,
        left: f.Formula,
        right: f.Formula,
        ago: f.Interval,
        formula: f.Formula,
        positive: bool,
        displayed: bool | None = None,
    ) -> _Text:
        """`left S[ago] right`, or its negation; `displayed` says which of them `formula` is."""
        if right == f.TRUE and ago.lo == 0:
            return _TRUE if positive else _FALSE
        comment = self._comment(formula, positive if displayed is None else displayed)
        sides = _Sides(left, right, positive, self.text(left, positive), self.text(right, positive))
        if ago == f.EVER:
            return self._ever(sides, comment)
        if ago.hi is not None and ago.lo > 0:
            return self._window(sides, ago.lo, ago.hi, comment)
        return self._by_count(sides, ago, comment)

    def _ever(self, sides: _Sides, comment: str) -> _Text:
        """Without bounds: one truth value is kept."""
        counter = self._counters.get(("oldest", sides.left, sides.right, sides.positive))
        column = self._unbounded(sides) if counter is not None else _ever_column(sides)
        name = self._name("since")
        if counter is not None:
            age = f"{counter.name} >= 0" if sides.positive else f"{counter.name} < 0"
            self._add(name, comment, column, (f"{name} = {age}",))
            return _Text(name, name)
        witness, guard = sides.witness, sides.guard
        if sides.positive:
            step = _either([witness, _both([guard, _Text(name, name)])])
        else:
            step = _both([witness, _either([guard, _Text(name, name)])])
        initial = str(not sides.positive)
        self._add(name, comment, column, (f"{name} = {step.step}",), Cell(name, initial, comment))
        return _Text(name, name)

    def _by_count(self, sides: _Sides, ago: f.Interval, comment: str) -> _Text:
        """By counting ticks since one witness; the cost does not depend on the bounds."""
        kind = "youngest" if ago.hi is not None else "oldest"
        bound = ago.lo if ago.hi is None else ago.hi
        counter = self._counter(kind, sides, comment)
        counter.most = max(counter.most, bound)
        operator = (
            (">=" if ago.hi is None else "<=")
            if sides.positive
            else ("<" if ago.hi is None else ">")
        )
        column = _between_column(sides, ago)
        if ago.hi is None and sides.positive and sides.left != f.TRUE:
            texts = f"{self._unbounded(sides)}, {sides.guard.column}, {sides.witness.column}"
            column = f"since_from({texts}, {ago.lo}, every)"
        name = self._name("since")
        self._add(name, comment, column, (f"{name} = {counter.name} {operator} {bound}",))
        return _Text(name, name)

    def _unbounded(self, sides: _Sides) -> str:
        """The column of the operator without bounds, from which one with bounds is made."""
        key = "held", sides.left, sides.right, sides.positive
        if key not in self._columns:
            self._columns[key] = name = self._name("held")
            since = f.since(sides.left, sides.right)
            comment = self._comment(since, sides.positive)
            lines = (f"{name} = {_ever_column(sides)}",)
            self.parts.append(_Part(name, comment, lines, tuple, tuple))
        return self._columns[key]

    def _counter(self, kind: str, sides: _Sides, comment: str) -> _Counter:
        key = kind, sides.left, sides.right, sides.positive
        if key not in self._counters:
            counter = _Counter(
                self._name(kind), sides.guard, sides.witness, dual=not sides.positive
            )
            self._counters[key] = counter
            witness = printing.readable(f.since(sides.left, sides.right))
            note = f"ticks since the {kind} witness of {witness}"
            lines = counter.youngest if kind == "youngest" else counter.oldest

            def cells() -> tuple[Cell, ...]:
                none = counter.most + 1 if kind == "youngest" else -1
                return (Cell(counter.name, str(none), f"{note}; {none}: none"),)

            self.parts.append(_Part(counter.name, note, (), lines, cells))
        return self._counters[key]

    def _window(self, sides: _Sides, lo: int, hi: int, comment: str) -> _Text:
        """Both bounds: the runs of witnesses inside of the window are kept."""
        name = self._name("since")
        window = f"kept_{name}"
        guard, witness = (
            _holds(side, dual=not sides.positive) for side in (sides.guard, sides.witness)
        )
        stepped = f"{window}.step({guard}, {witness})"
        self._add(
            name,
            comment,
            _between_column(sides, f.Interval(lo, hi)),
            (f"{name} = {stepped}" if sides.positive else f"{name} = not {stepped}",),
            Cell(window, f"Window({lo}, {hi})", comment),
        )
        return _Text(name, name)

    def _add(
        self, name: str, comment: str, column: str, step: tuple[str, ...], *cells: Cell
    ) -> None:
        self.parts.append(
            _Part(name, comment, (f"{name} = {column}",), lambda: step, lambda: cells)
        )


@dataclass(frozen=True, slots=True)
class _Sides:
    """Both sides of a since, or of its dual; the texts are those of the literals' rail."""

    left: f.Formula
    right: f.Formula
    positive: bool
    guard: _Text
    witness: _Text


def _both(texts: Sequence[_Text]) -> _Text:
    """The conjunction; constants fold."""
    rest = [text for text in texts if text != _TRUE]
    if _FALSE in rest:
        return _FALSE
    if len(rest) < 2:
        return rest[0] if rest else _TRUE
    parts = [text.grouped(_AND) for text in rest]
    return _Text(
        " and ".join(part.step for part in parts), " & ".join(part.column for part in parts), _AND
    )


def _either(texts: Sequence[_Text]) -> _Text:
    """The disjunction; constants fold."""
    rest = [text for text in texts if text != _FALSE]
    if _TRUE in rest:
        return _TRUE
    if len(rest) < 2:
        return rest[0] if rest else _FALSE
    return _Text(
        " or ".join(text.step for text in rest), " | ".join(text.column for text in rest), _OR
    )


def _ever_column(sides: _Sides) -> str:
    guard, witness = sides.guard.column, sides.witness.column
    if sides.left == f.TRUE:
        return f"{'once' if sides.positive else 'historically'}({witness}, 0, None, every)"
    return f"since({guard}, {witness})" if sides.positive else f"released({guard}, {witness})"


def _between_column(sides: _Sides, ago: f.Interval) -> str:
    guard, witness, bounds = sides.guard.column, sides.witness.column, f"{ago.lo}, {ago.hi}, every"
    if sides.left == f.TRUE:
        return f"{'once' if sides.positive else 'historically'}({witness}, {bounds})"
    name = "since_between" if sides.positive else "released_between"
    return f"{name}({guard}, {witness}, {bounds})"
