"""A monitor's program as Java: fields, expressions, statements, and methods of limited size."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, assert_never

from compiler.program.instructions import Assign, Shift
from compiler.program.program import Counter, StoredFlag
from compiler.program.statements import Statements
from compiler.program.stored_program import Delay, Ring
from compiler.program.values import And, Or, Value

_MOST_OPERANDS = 16
"""Maximum number of operands in a row: `javac` recurses into each, so a long row is nested."""
_MOST_CHARACTERS = 4_000
"""Characters of a method. A virtual machine compiles methods up to 8 000 bytes; `this.x >= 1` has
as many bytes as characters, and other expressions fewer."""


class JavaField(NamedTuple):
    """A field of the class of an approximation."""

    kind: str
    name: str
    initial: str
    """The first value; empty: a step assigns it before it is read."""
    comment: str


class JavaPrinter(Statements):
    """The syntax of Java: cells and variables are fields of `this`, literals are fields of `now`.

    Variables are no locals, so that a step can be divided into methods.
    """

    __slots__ = ()
    CELLS, LITERALS, LOCAL, IF = "this.", "now.", "", ("(", ")")
    VARIABLES = CELLS

    def fields(self) -> Iterator[JavaField]:
        """The fields of all cells and variables."""
        for cell in self.program.cells:
            match cell:
                case StoredFlag(name, initial, comment):
                    yield JavaField("boolean", name, str(initial).lower(), comment)
                case Counter(name, initial, least, most, comment):
                    yield JavaField("int", name, str(initial), f"{comment}; {least} to {most}")
                case Ring(name, length, comment):
                    yield JavaField("int[]", name, f"new int[{-(-length // 32)}]", comment)
                    yield JavaField("int", f"{name}_at", "0", "where this tick's is")
                case _:
                    assert_never(cell)
        for name in self.variables():
            yield JavaField("boolean", name, "", "a value of this tick")

    def variables(self) -> tuple[str, ...]:
        """The truth values that a step computes and no later step reads."""
        steps = (step for stage in self.program.stages for step in stage.steps)
        assigned = (step.name for step in steps if isinstance(step, Assign | Shift | Delay))
        return tuple(dict.fromkeys(name for name in assigned if name not in self.cells))

    def value(self, value: Value) -> str:
        """An expression of truth values, with long rows of operands nested."""
        match value:
            case And(values) | Or(values) if len(values) > _MOST_OPERANDS:
                size = -(-len(values) // _MOST_OPERANDS)
                rows = (values[start : start + size] for start in range(0, len(values), size))
                parts = (row[0] if len(row) == 1 else replace(value, values=row) for row in rows)
                return Statements.value(self, replace(value, values=tuple(parts)))
            case _:
                return Statements.value(self, value)

    def delay(self, name: str, ring: Ring, value: str) -> Iterator[str]:
        """Statements that read and overwrite one bit of a ring, and advance its position."""
        at = f"this.{ring.name}_at"
        word, bit = f"this.{ring.name}[{at} / 32]", f"1 << ({at} % 32)"
        yield f"this.{name} = ({word} & ({bit})) != 0;"
        yield f"if ({value}) {{"
        yield f"    {word} |= {bit};"
        yield "} else {"
        yield f"    {word} &= ~({bit});"
        yield "}"
        yield f"{at} = ({at} == {ring.length - 1}) ? 0 : ({at} + 1);"


def methods(groups: Iterable[Sequence[str]]) -> list[list[str]]:
    """The lines of methods, none of which is too large to be compiled while the program runs.

    Args:
        groups: the lines that stay together, in their order.
    """
    bodies, size = list[list[str]](), _MOST_CHARACTERS
    for lines in groups:
        more = sum(map(len, lines))
        if size + more > _MOST_CHARACTERS:
            bodies.append([])
            size = 0
        bodies[-1] += lines
        size += more
    return bodies
