"""The rail of a monitor as Rust: fields, expressions, statements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple, assert_never

from compiler.program.instructions import Advance, Assign, Choose, Count, Shift
from compiler.program.program import Counter, Flag
from compiler.program.rails import Cell, Deadline, Delay, Rail, Ring, Stage, Step
from compiler.program.values import (
    Age,
    And,
    Comparison,
    Constant,
    Literal,
    Not,
    Or,
    Value,
    Variable,
)


class Field(NamedTuple):
    """A field of the struct of a rail."""

    name: str
    kind: str
    initial: str
    comment: str


@dataclass(frozen=True, slots=True)
class Printer:
    """Rust's words for a rail: its cells are fields of `self`, its literals those of `now`."""

    rail: Rail
    names: Mapping[str, str]
    """An identifier for each proposition."""
    cells: Mapping[str, Cell]
    """Of the rail, by their names."""

    @classmethod
    def of(cls, rail: Rail, names: Mapping[str, str]) -> Printer:
        """Of a rail, with an identifier for each proposition."""
        return cls(rail, names, {cell.name: cell for cell in rail.cells})

    def fields(self) -> Iterator[Field]:
        """Those of all cells."""
        for cell in self.rail.cells:
            match cell:
                case Flag(name, initial, comment):
                    yield Field(name, "bool", str(initial).lower(), comment)
                case Counter(name, initial, least, most, comment):
                    yield Field(name, "i32", str(initial), f"{comment}; {least} to {most}")
                case Ring(name, length, comment):
                    words = -(-length // 32)
                    yield Field(name, f"[u32; {words}]", f"[0; {words}]", comment)
                    yield Field(f"{name}_at", "usize", "0", "where this tick's is")
                case _:
                    assert_never(cell)

    def literals(self) -> Iterator[tuple[str, str, bool]]:
        """The name of each literal, the field of the inputs that it reads, and its sign."""
        for literal in self.rail.literals:
            yield self._literal(literal), self.names[literal.proposition], literal.positive

    def _literal(self, literal: Literal) -> str:
        return f"{'is' if literal.positive else 'not'}_{self.names[literal.proposition]}"

    def value(self, value: Value) -> str:
        """An expression of type `bool`."""
        match value:
            case Constant(truth):
                return str(truth).lower()
            case Literal():
                return f"now.{self._literal(value)}"
            case Variable(name):
                return self._place(name)
            case Age(counter, comparison, number):
                return f"self.{counter} {comparison.value} {number}"
            case Not(Age(counter, comparison, number)):
                return self.value(Age(counter, _OPPOSITES[comparison], number))
            case Not(negated):
                return f"!{self._grouped(negated)}"
            case And(values):
                return " & ".join(map(self._grouped, values))
            case Or(values):
                return " | ".join(map(self._grouped, values))
            case _:
                assert_never(value)

    def _grouped(self, value: Value) -> str:
        """In parentheses, if it joins or compares others."""
        joined = isinstance(value, And | Or | Age) or isinstance(getattr(value, "value", None), Age)
        return f"({self.value(value)})" if joined else self.value(value)

    def _place(self, name: str) -> str:
        return f"self.{name}" if name in self.cells else name

    def lines(self, stage: Stage) -> Iterator[str]:
        """The statements of a stage."""
        for step in stage.steps:
            yield from self._statement(step)

    def _statement(self, step: Step) -> Iterator[str]:
        match step:
            case Assign(name, value):
                yield self._assigned(name, self.value(value))
            case Shift(name, cell, value):
                yield self._assigned(name, f"self.{cell}")
                yield f"self.{cell} = {self.value(value)};"
            case Count(counter, number):
                yield f"self.{counter} = {number};"
            case Advance(counter, most):
                grown = f"if self.{counter} < {most} {{ self.{counter} + 1 }} else {{ {most} }}"
                yield f"self.{counter} = {grown};"
            case Delay(name, ring, value):
                yield from self._delay(name, ring, self.value(value))
            case Choose(branches, otherwise):
                word = "if"
                for condition, then in branches:
                    yield f"{word} {self.value(condition)} {{"
                    yield from self._inner(then)
                    word = "} else if"
                yield "} else {"
                yield from self._inner(otherwise)
                yield "}"
            case _:
                assert_never(step)

    def _inner(self, step: Step) -> Iterator[str]:
        return (f"    {line}" for line in self._statement(step))

    def _assigned(self, name: str, value: str) -> str:
        place = self._place(name)
        return f"{place} = {value};" if place != name else f"let {name} = {value};"

    def _delay(self, name: str, ring: str, value: str) -> Iterator[str]:
        """One bit is read and written; its place goes round."""
        cell, at = self.cells[ring], f"self.{ring}_at"
        assert isinstance(cell, Ring)
        word, bit = f"self.{ring}[{at} / 32]", f"1 << ({at} % 32)"
        yield f"let {name} = {word} & ({bit}) != 0;"
        yield f"if {value} {{"
        yield f"    {word} |= {bit};"
        yield "} else {"
        yield f"    {word} &= !({bit});"
        yield "}"
        yield f"{at} = if {at} == {cell.length - 1} {{ 0 }} else {{ {at} + 1 }};"

    def left(self, deadline: Deadline | None, is_open: Value) -> str:
        """The ticks to a deadline, if there is one ahead."""
        if deadline is None:
            return "None"
        condition = f"{self._grouped(is_open)} & (self.{deadline.counter} >= 0)"
        ticks = f"u32::try_from({deadline.horizon} - self.{deadline.counter}).ok()"
        return f"if {condition} {{ {ticks} }} else {{ None }}"


_OPPOSITES: Mapping[Comparison, Comparison] = {
    Comparison.LESS: Comparison.AT_LEAST,
    Comparison.AT_LEAST: Comparison.LESS,
    Comparison.MORE: Comparison.AT_MOST,
    Comparison.AT_MOST: Comparison.MORE,
}
