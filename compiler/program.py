"""Past-time formulas → the straight-line Python that steps them.

Each value is computed on two rails: `must` (true whatever the unknown propositions are) and `may`
(true for some of their values). Negation swaps the rails; everything else is monotone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from compiler import formula as f
from compiler import printing
from compiler.past import Watch
from fretish.depth import deep

RAILS = ("must", "may")
_OR, _AND, _NOT, _ATOMIC = range(4)
"""How tight Python's operators bind."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A variable that lives from tick to tick."""

    name: str
    type: str
    initial: str
    comment: str


@dataclass(frozen=True, slots=True)
class Block:
    """The statements of one temporal operator, below a comment with its formula."""

    comment: str
    lines: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Program:
    """What a monitor keeps, does at each tick, and then tells."""

    cells: tuple[Cell, ...]
    blocks: tuple[Block, ...]
    signals: Mapping[str, tuple[str, str]]
    """Signal of the watch → its (must, may) expressions."""


@deep
def program(watch: Watch, parameters: Mapping[str, str]) -> Program:
    """Compile the signals of a watch; a sub-formula that comes twice is stepped once.

    Args:
        watch: past-time formulas only.
        parameters: a Python identifier for each proposition.
    """
    writer = _Writer(parameters)
    signals = {
        "trigger": watch.trigger,
        "breach": watch.breach,
        "owed": watch.owed,
        "fails": watch.fails,
        "answer": watch.answer if watch.answer is not None else f.FALSE,
    }
    told = {name: writer.both(signal) for name, signal in signals.items()}
    return Program(tuple(writer.cells), tuple(writer.blocks), told)


def locals_of(parameters: Iterable[str]) -> frozenset[str]:
    """The parameters of a step and the names of their rails."""
    return frozenset(name for p in parameters for name in (p, *(f"{p}_{rail}" for rail in RAILS)))


class _Writer:
    """Walks formulas from the leaves up and writes one block for each temporal operator."""

    def __init__(self, parameters: Mapping[str, str]) -> None:
        self.parameters = parameters
        self.taken = locals_of(parameters.values())
        self.cells: list[Cell] = []
        self.blocks: list[Block] = []
        self._names: dict[f.Formula, str] = {}

    def both(self, formula: f.Formula) -> tuple[str, str]:
        """The (must, may) expressions of the formula at the present tick."""
        return self.rail(formula, "must"), self.rail(formula, "may")

    def rail(self, formula: f.Formula, rail: str) -> str:
        """The expression of the formula on one rail."""
        return self._ranked(formula, rail)[1]

    def _grouped(self, formula: f.Formula, rail: str, loosest: int) -> str:
        """The expression, in parentheses where Python's operators ask for them."""
        rank, text = self._ranked(formula, rail)
        return text if rank >= loosest else f"({text})"

    def _ranked(self, formula: f.Formula, rail: str) -> tuple[int, str]:
        other = "may" if rail == "must" else "must"
        match formula:
            case f.Const(value):
                return _ATOMIC, str(value)
            case f.Atom(name):
                return _ATOMIC, f"{self.parameters[name]}_{rail}"
            case f.Not(arg):
                return _NOT, f"not {self._grouped(arg, other, _NOT)}"
            case f.And(args):
                return _AND, " and ".join(self._grouped(arg, rail, _NOT) for arg in args)
            case f.Or(args):
                return _OR, " or ".join(self._grouped(arg, rail, _AND) for arg in args)
            case f.Implies(left, right):
                return self._ranked(f.or_(f.not_(left), right), rail)
            case f.Iff(left, right):
                return self._ranked(f.not_(f.xor(left, right)), rail)
            case f.Xor():
                return _ATOMIC, f"{self._differing(formula)}_{rail}"
            case f.WeakPrevious(f.Const(False)):
                return _ATOMIC, self._first()
            case f.Historically(arg, ago) if ago != f.EVER:
                return self._ranked(f.not_(f.once(f.not_(arg), ago)), rail)
            case _:
                return _ATOMIC, f"{self._stepped(formula)}_{rail}"

    def _first(self) -> str:
        """True at tick 0, on both rails."""
        if f.FIRST not in self._names:
            self._names[f.FIRST] = "first"
            self.cells.append(Cell("first", "bool", "True", "(Z FALSE): no tick came before"))
            self.blocks.append(Block("(Z FALSE)", ("first, self.first = self.first, False",)))
        return "first"

    def _differing(self, formula: f.Xor) -> str:
        """The name of a difference: each rail of it needs both rails of both sides."""
        if formula not in self._names:
            (left_must, left_may), (right_must, right_may) = (
                (self._grouped(side, "must", _NOT), self._grouped(side, "may", _NOT))
                for side in (formula.left, formula.right)
            )
            name = self._named(formula, "differ")
            comment = printing.readable(formula)
            lines = tuple(
                f"{name}_{rail} = {left} and not {right} or not {other_left} and {other_right}"
                for rail, left, right, other_left, other_right in (
                    ("must", left_must, right_may, left_may, right_must),
                    ("may", left_may, right_must, left_must, right_may),
                )
            )
            self.blocks.append(Block(comment, lines))
        return self._names[formula]

    def _stepped(self, formula: f.Formula) -> str:
        """The name under which a temporal operator keeps its value; its block is written once."""
        if formula not in self._names:
            for child in f.children(formula):
                self.both(child)  # the blocks of the operands come first
            name = self._named(formula, _KINDS[type(formula)])
            comment = printing.readable(formula)
            lines: list[str] = []
            for rail in RAILS:
                lines.extend(self._step(formula, f"{name}_{rail}", rail, comment))
            self.blocks.append(Block(comment, tuple(lines)))
        return self._names[formula]

    def _named(self, formula: f.Formula, kind: str) -> str:
        """A name for the value of the formula, as no parameter and no rail of one is called."""
        name = f"{kind}_{1 + sum(n.startswith(kind) for n in self._names.values())}"
        while any(f"{name}_{rail}" in self.taken for rail in RAILS):
            name += "_"
        self._names[formula] = name
        return name

    def _step(self, formula: f.Formula, name: str, rail: str, comment: str) -> list[str]:
        """Compute `name` for this tick on one rail, and keep what the next tick needs."""
        match formula:
            case f.Previous(arg) | f.WeakPrevious(arg):
                weak = isinstance(formula, f.WeakPrevious)
                self._keep(name, "bool", str(weak), comment)
                return [f"{name}, self.{name} = self.{name}, {self.rail(arg, rail)}"]
            case f.Once(arg, f.EVER):
                self._keep(name, "bool", "False", comment)
                return [f"{name} = self.{name} = self.{name} or {self._grouped(arg, rail, _AND)}"]
            case f.Historically(arg, f.EVER):
                self._keep(name, "bool", "True", comment)
                return [f"{name} = self.{name} = self.{name} and {self._grouped(arg, rail, _NOT)}"]
            case f.Since(left, right, f.EVER):
                self._keep(name, "bool", "False", comment)
                kept = f"{self._grouped(left, rail, _NOT)} and self.{name}"
                return [f"{name} = self.{name} = {self._grouped(right, rail, _AND)} or {kept}"]
            case f.Once(arg, ago):
                return self._counted(f.TRUE, arg, ago, name, rail, comment)
            case f.Since(left, right, ago):
                return self._counted(left, right, ago, name, rail, comment)
            case _:
                raise AssertionError(f"not a past-time operator: {formula}")

    def _counted(
        self, left: f.Formula, right: f.Formula, ago: f.Interval, name: str, rail: str, comment: str
    ) -> list[str]:
        """`left S[lo,hi] right` by counting ticks; the cost does not depend on the bounds."""
        kept, seen = self.rail(left, rail), self.rail(right, rail)
        if ago.hi is not None and ago.lo > 0:
            self._keep(f"{name}_window", "Window", f"Window({ago.lo}, {ago.hi})", comment)
            return [f"{name} = self.{name}_window.step({kept}, {seen})"]
        age = f"{name}_age"
        if ago.hi is not None:
            none = ago.hi + 1
            self._keep(age, "int", str(none), f"ticks since the youngest witness of {comment}")
            return [
                *_chosen(seen, f"self.{age} = 0"),
                *_otherwise(
                    kept, f"self.{age} = min(self.{age} + 1, {none})", f"self.{age} = {none}"
                ),
                f"{name} = self.{age} < {none}",
            ]
        self._keep(age, "int", "-1", f"ticks since the oldest witness, up to {ago.lo}; -1: none")
        older = f"self.{age} >= 0 and {self._grouped(left, rail, _NOT)}"
        if left == f.TRUE:
            older = f"self.{age} >= 0"
        return [
            *_chosen(older, f"self.{age} = min(self.{age} + 1, {ago.lo})"),
            *_otherwise(seen, f"self.{age} = 0", f"self.{age} = -1"),
            f"{name} = self.{age} == {ago.lo}",
        ]

    def _keep(self, name: str, type_: str, initial: str, comment: str) -> None:
        self.cells.append(Cell(name, type_, initial, comment))


def _chosen(condition: str, statement: str) -> list[str]:
    return [f"if {condition}:", f"    {statement}"]


def _otherwise(condition: str, statement: str, last: str) -> list[str]:
    """The rest of an `if`: a condition that is a constant leaves one branch."""
    if condition == "True":
        return ["else:", f"    {statement}"]
    return [f"elif {condition}:", f"    {statement}", "else:", f"    {last}"]


_KINDS: dict[type[f.Formula], str] = {
    f.Previous: "before",
    f.WeakPrevious: "before",
    f.Once: "once",
    f.Historically: "always",
    f.Since: "since",
}
