"""The program of a monitor as Python: tick by tick, and over columns of whole traces."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple, assert_never

from compiler.formalization.past import MonitorSpec
from compiler.program import columns as c
from compiler.program import instructions as i
from compiler.program import program as p
from compiler.program import values as v
from compiler.program.lowering import program as lowered
from fretish.classes.frozen import dataclass
from fretish.reading.recursion import with_recursion_limit

_OR, _AND, _ATOMIC = range(3)
"""Precedence ranks of Python's operators, which columns share: a higher rank binds tighter."""


@dataclass(frozen=True, slots=True)
class StoredVariable:
    """A variable that is kept from tick to tick."""

    name: str
    initial: str
    comment: str


@dataclass(frozen=True, slots=True)
class OperatorStatements:
    """The statements of one temporal operator, below a comment with its formula."""

    comment: str
    lines: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class RequirementSignals:
    """The signals of one requirement: each an expression of a step, and one over columns."""

    id: str
    prefix: str
    """An identifier that is unique in the program."""
    step: Mapping[str, str]
    tight: Mapping[str, str]
    """As `step`, in parentheses if an operator before it needs them."""
    columns: Mapping[str, str]
    renewed: bool

    @property
    def possible(self) -> Mapping[str, bool]:
        """For each signal, whether it can be true at some tick."""
        return {name: text != "False" for name, text in self.step.items()}

    @property
    def is_always_triggered(self) -> bool:
        """Whether every tick is a trigger."""
        return self.step["trigger"] == "True"

    @property
    def marks(self) -> tuple[str, ...]:
        """The marks that can change, because their signal can be true."""
        return tuple(mark for mark in p.MARKS if self.possible[p.SOURCES[mark]])


@dataclass(frozen=True, slots=True)
class LiteralVariable:
    """A proposition or its negation, as a variable."""

    name: str
    proposition: str
    positive: bool


@dataclass(frozen=True, slots=True)
class ProgramCode:
    """The code of the cells, the steps and the signals; and of the same over columns."""

    literals: tuple[LiteralVariable, ...]
    cells: tuple[StoredVariable, ...]
    steps: tuple[OperatorStatements, ...]
    columns: tuple[OperatorStatements, ...]
    requirements: tuple[RequirementSignals, ...]


@with_recursion_limit
def program(
    watches: Mapping[str, MonitorSpec], parameters: Mapping[str, str], prefixes: Mapping[str, str]
) -> ProgramCode:
    """The Python code of monitor specifications.

    Args:
        watches: requirement id → monitor specification, with past-time formulas only.
        parameters: a Python identifier for each proposition.
        prefixes: a Python identifier for each requirement's id.
    """
    marks = {name for prefix in prefixes.values() for name in marks_of(prefix)}
    monitor_program = lowered(watches, marks | locals_of(parameters.values()))
    printer = _PythonPrinter(parameters)
    return ProgramCode(
        tuple(
            LiteralVariable(printer.name(x), x.proposition, x.positive)
            for x in monitor_program.literals
        ),
        tuple(
            StoredVariable(cell.name, _initial(cell), cell.comment)
            for cell in monitor_program.cells
        ),
        tuple(
            OperatorStatements(b.comment, printer.step(b))
            for b in monitor_program.blocks
            if b.instructions
        ),
        tuple(
            OperatorStatements(b.comment, lines)
            for b in monitor_program.blocks
            if (lines := printer.column(b))
        ),
        tuple(
            printer.signals(requirement, prefixes[requirement.id])
            for requirement in monitor_program.requirements
        ),
    )


def locals_of(parameters: Iterable[str]) -> frozenset[str]:
    """The parameters of a step and the names of their negations."""
    return frozenset(name for parameter in parameters for name in (parameter, negation(parameter)))


def negation(parameter: str) -> str:
    """The name of the negation of a proposition."""
    return f"not_{parameter}"


def marks_of(prefix: str) -> frozenset[str]:
    """The names of the marks of a requirement."""
    return frozenset(f"{prefix}_{name}" for name in (*p.MARKS, "signals"))


def _initial(cell: p.Cell) -> str:
    match cell:
        case p.StoredFlag() | p.Counter():
            return str(cell.initial)
        case p.WindowMemory():
            return f"Window({cell.lo}, {cell.hi})"
        case _:
            assert_never(cell)


class _Text(NamedTuple):
    """The code of one value: in a step and over columns, with its precedence."""

    step: str
    column: str
    rank: int = _ATOMIC

    def grouped(self, loosest: int) -> _Text:
        """The code, in parentheses if Python's operators need them."""
        if self.rank >= loosest:
            return self
        return _Text(f"({self.step})", f"({self.column})")


@dataclass(frozen=True, slots=True)
class _PythonPrinter:
    """The syntax of Python for a program."""

    parameters: Mapping[str, str]

    def name(self, literal: v.Literal) -> str:
        """The variable of a literal."""
        parameter = self.parameters[literal.proposition]
        return parameter if literal.positive else negation(parameter)

    def signals(self, requirement: p.RequirementProgram, prefix: str) -> RequirementSignals:
        """The signals of a requirement with this prefix."""
        texts = {n: self.text(value) for n, value in requirement.signals._asdict().items()}
        return RequirementSignals(
            requirement.id,
            prefix,
            {name: text.step for name, text in texts.items()},
            {name: text.grouped(_ATOMIC).step for name, text in texts.items()},
            {name: text.column for name, text in texts.items()},
            requirement.renewed,
        )

    def text(self, value: v.Value) -> _Text:
        """The code of a value; negations and ages of counters occur only in steps."""
        match value:
            case v.Constant(truth):
                return _Text("True", "every") if truth else _Text("False", "0")
            case v.Literal():
                return _Text(self.name(value), self.name(value))
            case v.Variable("first"):
                return _Text("first", "(every & 1)")
            case v.Variable(name):
                return _Text(name, name)
            case v.Age(counter, comparison, number):
                return _Text(f"{counter} {comparison.value} {number}", "")
            case v.Not(negated):
                return _Text(f"not {self.text(negated).grouped(_ATOMIC).step}", "", _AND)
            case v.And(values):
                texts = [self.text(operand).grouped(_AND) for operand in values]
                return _Text(*_joined(texts, " and ", " & "), _AND)
            case v.Or(values):
                return _Text(*_joined([*map(self.text, values)], " or ", " | "), _OR)
            case _:
                assert_never(value)

    def _condition(self, value: v.Value) -> str:
        return self.text(value).grouped(_AND).step

    def step(self, block: p.Block) -> tuple[str, ...]:
        """The statements of a block at one tick."""
        return tuple(
            line for instruction in block.instructions for line in self._statement(instruction)
        )

    def _statement(self, instruction: i.Instruction) -> tuple[str, ...]:
        match instruction:
            case i.Assign(name, value):
                return (f"{name} = {self.text(value).step}",)
            case i.Shift(name, cell, value):
                return (f"{name}, {cell} = {cell}, {self.text(value).step}",)
            case i.SetCounter(counter, number):
                return (f"{counter} = {number}",)
            case i.Advance(counter, most):
                return (f"{counter} = {counter} + 1 if {counter} < {most} else {most}",)
            case i.Slide(name, window, guard, witness, negated):
                step = f"{window}.step({self._condition(guard)}, {self._condition(witness)})"
                return (f"{name} = {'not ' if negated else ''}{step}",)
            case i.Choose(branches, otherwise):
                return (*self._branches(branches), "else:", *self._inner(otherwise))
            case _:
                assert_never(instruction)

    def _branches(self, branches: Iterable[tuple[v.Value, i.Instruction]]) -> Iterable[str]:
        word = "if"
        for condition, then in branches:
            yield f"{word} {self._condition(condition)}:"
            yield from self._inner(then)
            word = "elif"

    def _inner(self, instruction: i.Instruction) -> Iterable[str]:
        return (f"    {line}" for line in self._statement(instruction))

    def column(self, block: p.Block) -> tuple[str, ...]:
        """The statement of a block over columns, if it has one."""
        if block.column is None or isinstance(block.column, c.AtFirst):
            return ()
        return (f"{block.name} = {self._column(block.column)}",)

    def _column(self, column: v.Value | c.PreviousColumn | c.SinceColumn) -> str:
        match column:
            case c.PreviousColumn(value, weak):
                return (
                    f"{'weak_previous' if weak else 'previous'}({self.text(value).column}, every)"
                )
            case c.SinceColumn():
                return self._since(column)
            case _:
                return self.text(column).column

    def _since(self, since: c.SinceColumn) -> str:
        bounds, witness = f"{since.lo}, {since.hi}, every", self.text(since.witness).column
        if since.guard is None:
            return f"{'historically' if since.dual else 'once'}({witness}, {bounds})"
        sides = f"{self.text(since.guard).column}, {witness}"
        if since.unbounded is not None:
            return f"since_from({since.unbounded}, {sides}, {since.lo}, every)"
        name = "released" if since.dual else "since"
        if (since.lo, since.hi) == (0, None):
            return f"{name}({sides})"
        return f"{name}_between({sides}, {bounds})"


def _joined(texts: Sequence[_Text], step: str, column: str) -> tuple[str, str]:
    return step.join(text.step for text in texts), column.join(text.column for text in texts)
