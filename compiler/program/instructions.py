"""The instructions of a program for one tick: they set variables and move counters."""

from __future__ import annotations

from compiler.program.values import Value
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Assign:
    """Assign a truth value to a cell, or to a variable of this tick."""

    name: str
    value: Value


@dataclass(frozen=True, slots=True)
class Shift:
    """The variable gets the cell's old value, and the cell the value of this tick."""

    name: str
    cell: str
    value: Value


@dataclass(frozen=True, slots=True)
class SetCounter:
    """The counter gets this number."""

    counter: str
    number: int


@dataclass(frozen=True, slots=True)
class Advance:
    """The counter grows by one; at `most` it stays."""

    counter: str
    most: int


@dataclass(frozen=True, slots=True)
class Slide:
    """Push `guard` and `witness` of this tick into the window; the variable gets its value.

    `negated`: the variable gets the negation.
    """

    name: str
    window: str
    guard: Value
    witness: Value
    negated: bool


@dataclass(frozen=True, slots=True)
class Choose:
    """The instruction of the first condition that is true; `otherwise`, if none is."""

    branches: tuple[tuple[Value, SetCounter | Advance], ...]
    otherwise: SetCounter | Advance


Instruction = Assign | Shift | SetCounter | Advance | Slide | Choose
