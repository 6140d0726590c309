"""A monitor's program as JavaScript: one function that advances the state by a tick.

Cells are properties of `approximation`. A proposition `p` is `is_p` and its negation `not_p`; no
other name begins so, and none is a key word.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import NamedTuple, assert_never

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
from compiler.program.values import Age, And, Constant, Literal, Not, Or, Value, Variable
from fretish.classes.frozen import dataclass

_OR, _AND, _COMPARED, _ATOMIC = range(4)
"""Precedence ranks of operators: a higher rank binds tighter."""


class _JavaScriptText(NamedTuple):
    text: str
    rank: int = _ATOMIC

    def at_least(self, loosest: int) -> str:
        """The text, in parentheses if the operator around it binds tighter."""
        return self.text if self.rank >= loosest else f"({self.text})"


@dataclass(frozen=True, slots=True)
class JavaScriptPrinter:
    """The syntax of JavaScript for a program."""

    program: Program
    names: Mapping[str, str]
    """An identifier for each proposition."""
    cells: Mapping[str, Cell]
    """The cells of the program, by their names."""

    @classmethod
    def of(cls, program: Program, names: Mapping[str, str]) -> JavaScriptPrinter:
        """A printer for a program, with an identifier for each proposition."""
        return cls(program, names, {cell.name: cell for cell in program.cells})

    def literals(self) -> Iterator[tuple[str, str, bool]]:
        """The name, the proposition and the sign of each literal."""
        for literal in self.program.literals:
            yield self._literal(literal), literal.proposition, literal.positive

    def initial(self, cell: Cell) -> str:
        """The value of a cell before the first tick."""
        match cell:
            case StoredFlag():
                return str(cell.initial).lower()
            case Counter():
                return str(cell.initial)
            case WindowMemory():
                return "{ intervals: [], first: 0 }"
            case _:
                assert_never(cell)

    def signals(self, requirement: RequirementProgram) -> dict[str, str]:
        """The signals of a requirement, by their names in JavaScript."""
        return {
            _camel_case(name): self._value(signal_value).text
            for name, signal_value in requirement.signals._asdict().items()
        }

    def lines(self, block: Block) -> Iterator[str]:
        """The statements of a block at one tick."""
        for instruction in block.instructions:
            yield from self._statement(instruction)

    def _statement(self, instruction: Instruction) -> Iterator[str]:
        match instruction:
            case Assign(name, value):
                yield self._assigned(name, self._value(value).text)
            case Shift(name, cell, value):
                yield self._assigned(name, f"approximation.{cell}")
                yield f"approximation.{cell} = {self._value(value).text};"
            case SetCounter(counter, number):
                yield f"approximation.{counter} = {number};"
            case Advance(counter, most):
                cell = f"approximation.{counter}"
                yield f"{cell} = {cell} < {most} ? {cell} + 1 : {most};"
            case Slide(name, window, guard, witness, negated):
                sides = f"{self._value(guard).text}, {self._value(witness).text}"
                kept = self.cells[window]
                assert isinstance(kept, WindowMemory)
                held = f"slide(approximation.{window}, tick, {kept.lo}, {kept.hi}, {sides})"
                yield self._assigned(name, f"{'!' if negated else ''}{held}")
            case Choose(branches, otherwise):
                for condition, then in branches:
                    (inner,) = self._statement(then)
                    yield f"if ({self._value(condition).text}) {inner}"
                    yield "else"
                (last,) = self._statement(otherwise)
                yield last
            case _:
                assert_never(instruction)

    def _assigned(self, name: str, value: str) -> str:
        place = self._place(name)
        return f"{place} = {value};" if place != name else f"const {name} = {value};"

    def _place(self, name: str) -> str:
        return f"approximation.{name}" if name in self.cells else name

    def _literal(self, literal: Literal) -> str:
        return f"{'is' if literal.positive else 'not'}_{self.names[literal.proposition]}"

    def _value(self, value: Value) -> _JavaScriptText:
        match value:
            case Constant(truth):
                return _JavaScriptText(str(truth).lower())
            case Literal():
                return _JavaScriptText(self._literal(value))
            case Variable(name):
                return _JavaScriptText(self._place(name))
            case Age(counter, comparison, number):
                return _JavaScriptText(
                    f"approximation.{counter} {comparison.value} {number}", _COMPARED
                )
            case Not(negated):
                return _JavaScriptText(f"!{self._value(negated).at_least(_ATOMIC)}")
            case And(values):
                texts = (self._value(operand).at_least(_AND) for operand in values)
                return _JavaScriptText(" && ".join(texts), _AND)
            case Or(values):
                return _JavaScriptText(
                    " || ".join(self._value(operand).text for operand in values), _OR
                )
            case _:
                assert_never(value)


def _camel_case(name: str) -> str:
    """`violation_inevitable` as `violationInevitable`."""
    return re.sub("_(.)", lambda letter: letter[1].upper(), name)
