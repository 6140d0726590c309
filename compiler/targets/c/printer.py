"""A monitor's program as C99: members, expressions, statements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import assert_never

from compiler.program.program import Counter, StoredFlag
from compiler.program.statements import Statements
from compiler.program.stored_program import Cell, Ring
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class StructMember:
    """A member of the struct of the state."""

    declaration: str
    comment: str
    initial: tuple[str, ...]
    """The statements that give it its first value."""


class CPrinter(Statements):
    """The syntax of C: `approximation` points to the cells, `now` to the literals."""

    __slots__ = ()
    CELLS, LITERALS, LOCAL, IF = "approximation->", "now->", "const bool", ("(", ")")

    def members(self) -> tuple[StructMember, ...]:
        """The members, the widest first, so that there is no padding between them."""
        sizes = {Ring: 0, Counter: 1, StoredFlag: 2}
        cells = sorted(self.program.cells, key=lambda cell: sizes[type(cell)])
        return tuple(member for cell in cells for member in _members(cell))

    @property
    def bytes(self) -> int:
        """The size of the struct, if a `bool` has one byte and alignment is at most 4."""
        flags = sum(isinstance(cell, StoredFlag) for cell in self.program.cells)
        unused = -flags % 4 if flags < len(self.program.cells) else 0
        return sum(map(_bytes, self.program.cells)) + unused or 1

    def delay(self, name: str, ring: Ring, value: str) -> Iterator[str]:
        """Statements that read and overwrite one bit of a ring, and advance its position."""
        at, word, bit = f"approximation->{ring.name}_at", f"{name}_word", f"{name}_bit"
        yield f"uint32_t *const {word} = &approximation->{ring.name}[{at} / 32u];"
        yield f"const uint32_t {bit} = UINT32_C(1) << ({at} % 32u);"
        yield f"const bool {name} = (*{word} & {bit}) != 0u;"
        yield f"*{word} = ({value}) ? (*{word} | {bit}) : (*{word} & ~{bit});"
        yield f"{at} = ({at} == {ring.length - 1}u) ? 0u : ({at} + 1u);"


def _members(cell: Cell) -> Iterable[StructMember]:
    match cell:
        case StoredFlag(name, initial):
            yield StructMember(f"bool {name}", cell.comment, (f"{name} = {str(initial).lower()}",))
        case Counter(name, initial, least, most):
            comment = f"{cell.comment}; {least} to {most}"
            yield StructMember(f"int32_t {name}", comment, (f"{name} = {initial}",))
        case Ring(name, length):
            words = -(-length // 32)
            yield StructMember(f"uint32_t {name}[{words}]", cell.comment, ())
            place = f"{name}_at"
            yield StructMember(f"uint32_t {place}", "where this tick's is", (f"{place} = 0u",))
        case _:
            assert_never(cell)


def _bytes(cell: Cell) -> int:
    match cell:
        case StoredFlag():
            return 1
        case Counter():
            return 4
        case Ring():
            return 4 * -(-cell.length // 32) + 4
        case _:
            assert_never(cell)
