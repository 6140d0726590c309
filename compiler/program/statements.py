"""Statements of a program for languages with braces, without the parts in which they differ.

Cells are written with a prefix that points to the state, and literals with one that points to the
inputs of the tick, as `is_` and `not_`. So no name is that of a local variable, a macro or a key
word, whatever the user's propositions are called.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Self, assert_never

from compiler.program.instructions import Advance, Assign, Choose, SetCounter, Shift
from compiler.program.stored_program import Cell, Deadline, Delay, Ring, Step, StoredProgram
from compiler.program.values import Age, And, Constant, Literal, Not, Or, Value, Variable
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Statements(ABC):
    """The syntax of a language for the statements of a program."""

    CELLS: ClassVar[str]
    """The prefix of cells."""
    LITERALS: ClassVar[str]
    """The prefix of literals."""
    LOCAL: ClassVar[str]
    """The declaration of a local truth value."""
    IF: ClassVar[tuple[str, str]]
    """The text before and after a condition."""
    VARIABLES: ClassVar[str] = ""
    """The prefix of variables; empty: they are local."""

    program: StoredProgram
    names: Mapping[str, str]
    """An identifier for each proposition."""
    cells: Mapping[str, Cell]
    """The cells by their names."""

    @classmethod
    def of(cls, program: StoredProgram, names: Mapping[str, str]) -> Self:
        """The statements of a program, with an identifier for each proposition."""
        return cls(program, names, {cell.name: cell for cell in program.cells})

    def negated(self, value: Value) -> str:
        """The negation of a value, with parentheses around any operator."""
        atomic = isinstance(value, Constant | Literal | Variable)
        return f"!{self.value(value)}" if atomic else f"!({self.value(value)})"

    def capped(self, counter: str, most: int) -> str:
        """The counter one tick later, limited to `most`."""
        return f"({counter} < {most}) ? ({counter} + 1) : {most}"

    @abstractmethod
    def delay(self, name: str, ring: Ring, value: str) -> Iterator[str]:
        """Statements that read and overwrite one bit of a ring, and advance its position."""

    def left(self, deadline: Deadline | None, is_open: Value) -> str:
        """The ticks left to a deadline; by default -1 if no deadline is ahead.

        A counter that requirements share may pass the deadlines of some of them.
        """
        if deadline is None:
            return "-1"
        counter, ticks = f"{self.CELLS}{deadline.counter}", deadline.deadline_ticks
        ahead = f"({counter} >= 0) & ({counter} <= {ticks})"
        return f"({self.grouped(is_open)} & {ahead}) ? ({ticks} - {counter}) : -1"

    def readings(self) -> list[dict[str, Any]]:
        """The expressions of all readings, as values for a template."""
        return [
            {
                "id": reading.id,
                "prefix": reading.prefix,
                "left": self.left(reading.deadline, reading.truths["open"]),
                "truths": {name: self.value(value) for name, value in reading.truths.items()},
            }
            for reading in self.program.readings
        ]

    def stages(self) -> list[dict[str, Any]]:
        """The statements of each group below its comment, as values for a template."""
        return [
            {
                "comment": stage.comment,
                "lines": [line for step in stage.steps for line in self._statement(step)],
            }
            for stage in self.program.stages
        ]

    def literals(self) -> Iterator[tuple[str, str, bool]]:
        """The name, the input and the sign of each literal."""
        for literal in self.program.literals:
            yield self._literal(literal), self.names[literal.proposition], literal.positive

    def _literal(self, literal: Literal) -> str:
        return f"{'is' if literal.positive else 'not'}_{self.names[literal.proposition]}"

    def value(self, value: Value) -> str:
        """An expression of truth values.

        Values are joined by `&` and `|`, which evaluate both sides: `&&` may compile to jumps,
        whose prediction fails as often as propositions change.
        """
        match value:
            case Constant(truth):
                return str(truth).lower()
            case Literal():
                return f"{self.LITERALS}{self._literal(value)}"
            case Variable(name):
                return self._place(name)
            case Age(counter, comparison, number):
                return f"{self.CELLS}{counter} {comparison.value} {number}"
            case Not(negated):
                return self.negated(negated)
            case And(values):
                return " & ".join(map(self.grouped, values))
            case Or(values):
                return " | ".join(map(self.grouped, values))
            case _:
                assert_never(value)

    def joins(self, value: Value) -> bool:
        """Whether the value's expression has an operator that joins or compares."""
        return isinstance(value, And | Or | Age)

    def grouped(self, value: Value) -> str:
        """The value, in parentheses if it joins or compares."""
        return f"({self.value(value)})" if self.joins(value) else self.value(value)

    def _place(self, name: str) -> str:
        return f"{self.CELLS if name in self.cells else self.VARIABLES}{name}"

    def _statement(self, step: Step) -> Iterator[str]:
        match step:
            case Assign(name, value):
                yield self._assigned(name, self.value(value))
            case Shift(name, cell, value):
                yield self._assigned(name, f"{self.CELLS}{cell}")
                yield f"{self.CELLS}{cell} = {self.value(value)};"
            case SetCounter(counter, number):
                yield f"{self.CELLS}{counter} = {number};"
            case Advance(counter, most):
                place = f"{self.CELLS}{counter}"
                yield f"{place} = {self.capped(place, most)};"
            case Delay(name, ring, value):
                bits = self.cells[ring]
                assert isinstance(bits, Ring)
                yield from self.delay(name, bits, self.value(value))
            case Choose():
                yield from self._choice(step)
            case _:
                assert_never(step)

    def _choice(self, step: Choose) -> Iterator[str]:
        word, (before, behind) = "if", self.IF
        for condition, then in step.branches:
            yield f"{word} {before}{self.value(condition)}{behind} {{"
            yield from self._inner(then)
            word = "} else if"
        yield "} else {"
        yield from self._inner(step.otherwise)
        yield "}"

    def _inner(self, step: Step) -> Iterator[str]:
        return (f"    {line}" for line in self._statement(step))

    def _assigned(self, name: str, value: str) -> str:
        place = self._place(name)
        return f"{place} = {value};" if place != name else f"{self.LOCAL} {name} = {value};"
