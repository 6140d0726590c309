"""The rail of a monitor as C99: members, expressions, statements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import assert_never

from compiler.program.instructions import Advance, Assign, Choose, Count, Shift
from compiler.program.program import Counter, Flag
from compiler.program.rails import Cell, Deadline, Delay, Rail, Ring, Stage, Step
from compiler.program.values import Age, And, Constant, Literal, Not, Or, Value, Variable


@dataclass(frozen=True, slots=True)
class Member:
    """A member of the struct of a rail."""

    declaration: str
    comment: str
    initial: tuple[str, ...]
    """The statements that give it its first value."""


@dataclass(frozen=True, slots=True)
class Printer:
    """C's words for a rail: `rail` points to its cells, `now` to its literals.

    Names of cells stand behind `rail->`, names of literals behind `now->is_` and `now->not_`: none
    is that of a local variable, of a macro or of a keyword, whatever the user calls propositions.
    """

    rail: Rail
    names: Mapping[str, str]
    """An identifier for each proposition."""
    cells: Mapping[str, Cell]
    """Of the rail, by their names."""

    @classmethod
    def of(cls, rail: Rail, names: Mapping[str, str]) -> Printer:
        """Of a rail, with an identifier for each proposition."""
        return cls(rail, names, {cell.name: cell for cell in rail.cells})

    def members(self) -> tuple[Member, ...]:
        """The widest first, so that no space is lost between them."""
        sizes = {Ring: 0, Counter: 1, Flag: 2}
        cells = sorted(self.rail.cells, key=lambda cell: sizes[type(cell)])
        return tuple(member for cell in cells for member in _members(cell))

    @property
    def bytes(self) -> int:
        """The size of the struct, where a `bool` has one byte and nothing is aligned beyond 4."""
        flags = sum(isinstance(cell, Flag) for cell in self.rail.cells)
        unused = -flags % 4 if flags < len(self.rail.cells) else 0
        return sum(map(_bytes, self.rail.cells)) + unused or 1

    def literals(self) -> Iterator[tuple[str, str, bool]]:
        """The name of each literal, the member of the inputs that it reads, and its sign."""
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
                return "true" if truth else "false"
            case Literal():
                return f"now->{self._literal(value)}"
            case Variable(name):
                return self._named(name)
            case Age(counter, comparison, number):
                return f"rail->{counter} {comparison.value} {number}"
            case Not(negated):
                return f"!{self._tight(negated)}"
            case And(values):
                return " & ".join(map(self._grouped, values))
            case Or(values):
                return " | ".join(map(self._grouped, values))
            case _:
                assert_never(value)

    def _grouped(self, value: Value) -> str:
        """In parentheses, if it joins or compares others."""
        joined = isinstance(value, And | Or | Age)
        return f"({self.value(value)})" if joined else self.value(value)

    def _tight(self, value: Value) -> str:
        """In parentheses, if it has an operator."""
        atomic = isinstance(value, Constant | Literal | Variable)
        return self.value(value) if atomic else f"({self.value(value)})"

    def _named(self, name: str) -> str:
        return f"rail->{name}" if name in self.cells else name

    def lines(self, stage: Stage) -> Iterator[str]:
        """The statements of a stage."""
        for step in stage.steps:
            yield from self._statement(step)

    def _statement(self, step: Step) -> Iterator[str]:
        match step:
            case Assign(name, value):
                yield self._set(name, self.value(value))
            case Shift(name, cell, value):
                yield self._set(name, f"rail->{cell}")
                yield f"rail->{cell} = {self.value(value)};"
            case Count(counter, number):
                yield f"rail->{counter} = {number};"
            case Advance(counter, most):
                grown = f"(rail->{counter} < {most}) ? (rail->{counter} + 1) : {most}"
                yield f"rail->{counter} = {grown};"
            case Delay(name, ring, value):
                yield from self._delay(name, ring, self.value(value))
            case Choose(branches, otherwise):
                word = "if"
                for condition, then in branches:
                    yield f"{word} ({self.value(condition)}) {{"
                    yield from self._inner(then)
                    word = "} else if"
                yield "} else {"
                yield from self._inner(otherwise)
                yield "}"
            case _:
                assert_never(step)

    def _inner(self, step: Step) -> Iterator[str]:
        return (f"    {line}" for line in self._statement(step))

    def _set(self, name: str, value: str) -> str:
        target = self._named(name)
        return f"{target} = {value};" if name != target else f"const bool {name} = {value};"

    def _delay(self, name: str, ring: str, value: str) -> Iterator[str]:
        """One bit is read and written; its place goes round."""
        cell, at = self.cells[ring], f"rail->{ring}_at"
        assert isinstance(cell, Ring)
        word, bit = f"{name}_word", f"{name}_bit"
        yield f"uint32_t *const {word} = &rail->{ring}[{at} / 32u];"
        yield f"const uint32_t {bit} = UINT32_C(1) << ({at} % 32u);"
        yield f"const bool {name} = (*{word} & {bit}) != 0u;"
        yield f"*{word} = ({value}) ? (*{word} | {bit}) : (*{word} & ~{bit});"
        yield f"{at} = ({at} == {cell.length - 1}u) ? 0u : ({at} + 1u);"

    def left(self, deadline: Deadline | None, is_open: Value) -> str:
        """The ticks to a deadline; -1: there is none ahead."""
        if deadline is None:
            return "-1"
        conditions = f"{self._grouped(is_open)} & (rail->{deadline.counter} >= 0)"
        return f"({conditions}) ? ({deadline.horizon} - rail->{deadline.counter}) : -1"


def _members(cell: Cell) -> Iterable[Member]:
    match cell:
        case Flag(name, initial):
            yield Member(f"bool {name}", cell.comment, (f"{name} = {str(initial).lower()}",))
        case Counter(name, initial, least, most):
            comment = f"{cell.comment}; {least} to {most}"
            yield Member(f"int32_t {name}", comment, (f"{name} = {initial}",))
        case Ring(name, length):
            words = -(-length // 32)
            yield Member(f"uint32_t {name}[{words}]", cell.comment, ())
            place = f"{name}_at"
            yield Member(f"uint32_t {place}", "where this tick's is", (f"{place} = 0u",))
        case _:
            assert_never(cell)


def _bytes(cell: Cell) -> int:
    match cell:
        case Flag():
            return 1
        case Counter():
            return 4
        case Ring():
            return 4 * -(-cell.length // 32) + 4
        case _:
            assert_never(cell)
