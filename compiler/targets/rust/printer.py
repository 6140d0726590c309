"""A monitor's program as Rust: fields, expressions, statements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple, assert_never

from compiler.program.program import Counter, StoredFlag
from compiler.program.statements import Statements
from compiler.program.stored_program import Deadline, Ring
from compiler.program.values import Age, Comparison, Not, Value


class StructField(NamedTuple):
    """A field of the struct of the state."""

    name: str
    kind: str
    initial: str
    comment: str


class RustPrinter(Statements):
    """The syntax of Rust: cells are fields of `self`, literals are fields of `now`."""

    __slots__ = ()
    CELLS, LITERALS, LOCAL, IF = "self.", "now.", "let", ("", "")

    def fields(self) -> Iterator[StructField]:
        """The fields of all cells."""
        for cell in self.program.cells:
            match cell:
                case StoredFlag(name, initial, comment):
                    yield StructField(name, "bool", str(initial).lower(), comment)
                case Counter(name, initial, least, most, comment):
                    yield StructField(name, "i32", str(initial), f"{comment}; {least} to {most}")
                case Ring(name, length, comment):
                    words = -(-length // 32)
                    yield StructField(name, f"[u32; {words}]", f"[0; {words}]", comment)
                    yield StructField(f"{name}_at", "usize", "0", "where this tick's is")
                case _:
                    assert_never(cell)

    def negated(self, value: Value) -> str:
        """The negation; a comparison gets the opposite operator, as clippy demands."""
        if isinstance(value, Age):
            return self.value(replace(value, comparison=_OPPOSITES[value.comparison]))
        return f"!{self.grouped(value)}"

    def joins(self, value: Value) -> bool:
        """Whether the expression has an operator; a negated comparison has one, too."""
        is_turned = isinstance(value, Not) and isinstance(value.value, Age)
        return is_turned or Statements.joins(self, value)

    def capped(self, counter: str, most: int) -> str:
        """The counter one tick later, limited to `most`."""
        return f"if {counter} < {most} {{ {counter} + 1 }} else {{ {most} }}"

    def delay(self, name: str, ring: Ring, value: str) -> Iterator[str]:
        """Statements that read and overwrite one bit of a ring, and advance its position."""
        at = f"self.{ring.name}_at"
        word, bit = f"self.{ring.name}[{at} / 32]", f"1 << ({at} % 32)"
        yield f"let {name} = {word} & ({bit}) != 0;"
        yield f"if {value} {{"
        yield f"    {word} |= {bit};"
        yield "} else {"
        yield f"    {word} &= !({bit});"
        yield "}"
        yield f"{at} = if {at} == {ring.length - 1} {{ 0 }} else {{ {at} + 1 }};"

    def left(self, deadline: Deadline | None, is_open: Value) -> str:
        """The ticks left to a deadline, if one is ahead."""
        if deadline is None:
            return "None"
        condition = f"{self.grouped(is_open)} & (self.{deadline.counter} >= 0)"
        ticks = f"u32::try_from({deadline.deadline_ticks} - self.{deadline.counter}).ok()"
        return f"if {condition} {{ {ticks} }} else {{ None }}"


_OPPOSITES: Mapping[Comparison, Comparison] = {
    Comparison.LESS: Comparison.AT_LEAST,
    Comparison.AT_LEAST: Comparison.LESS,
    Comparison.MORE: Comparison.AT_MOST,
    Comparison.AT_MOST: Comparison.MORE,
}
