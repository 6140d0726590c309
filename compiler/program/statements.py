"""The statements of a rail, but for what languages with braces write differently.

Cells stand behind what points to the rail, literals behind what points to those of the tick, as
`is_` and `not_`: none of these names is that of a local variable, of a macro or of a key word,
whatever the user calls propositions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, Self, assert_never

from compiler.program.instructions import Advance, Assign, Choose, Count, Shift
from compiler.program.rails import Cell, Delay, Rail, Ring, StatementGroup, Step
from compiler.program.values import Age, And, Constant, Literal, Not, Or, Value, Variable


@dataclass(frozen=True, slots=True)
class Statements(ABC):
    """A language's words for a rail."""

    CELLS: ClassVar[str]
    """What stands before the name of a cell."""
    LITERALS: ClassVar[str]
    """What stands before that of a literal."""
    LOCAL: ClassVar[str]
    """What declares a local truth value."""
    IF: ClassVar[tuple[str, str]]
    """What stands before a condition, and behind it."""

    rail: Rail
    names: Mapping[str, str]
    """An identifier for each proposition."""
    cells: Mapping[str, Cell]
    """Of the rail, by their names."""

    @classmethod
    def of(cls, rail: Rail, names: Mapping[str, str]) -> Self:
        """Of a rail, with an identifier for each proposition."""
        return cls(rail, names, {cell.name: cell for cell in rail.cells})

    @abstractmethod
    def negated(self, value: Value) -> str:
        """The negation of a value."""

    @abstractmethod
    def capped(self, counter: str, most: int) -> str:
        """A counter one tick later, where it stays at the most."""

    @abstractmethod
    def delay(self, name: str, ring: Ring, value: str) -> Iterator[str]:
        """One bit of a ring is read and written; its place goes round."""

    def literals(self) -> Iterator[tuple[str, str, bool]]:
        """The name of each literal, the input that it reads, and its sign."""
        for literal in self.rail.literals:
            yield self._literal(literal), self.names[literal.proposition], literal.positive

    def _literal(self, literal: Literal) -> str:
        return f"{'is' if literal.positive else 'not'}_{self.names[literal.proposition]}"

    def value(self, value: Value) -> str:
        """An expression of truth values.

        It joins them by `&` and `|`, which evaluate both sides: where `&&` may jump, the processor
        guesses, and is wrong as often as propositions change.
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
        """Whether its expression joins or compares others."""
        return isinstance(value, And | Or | Age)

    def grouped(self, value: Value) -> str:
        """In parentheses, if it joins or compares others."""
        return f"({self.value(value)})" if self.joins(value) else self.value(value)

    def _place(self, name: str) -> str:
        return f"{self.CELLS}{name}" if name in self.cells else name

    def lines(self, stage: StatementGroup) -> Iterator[str]:
        """The statements of a stage."""
        for step in stage.steps:
            yield from self._statement(step)

    def _statement(self, step: Step) -> Iterator[str]:
        match step:
            case Assign(name, value):
                yield self._assigned(name, self.value(value))
            case Shift(name, cell, value):
                yield self._assigned(name, f"{self.CELLS}{cell}")
                yield f"{self.CELLS}{cell} = {self.value(value)};"
            case Count(counter, number):
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
