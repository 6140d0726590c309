"""What a program does at a tick: instructions that set variables and move counters."""

from __future__ import annotations

from dataclasses import dataclass

from compiler.program.values import Value


@dataclass(frozen=True, slots=True)
class Assign:
    """A truth value gets its name; it is a cell's, or lives for this tick."""

    name: str
    value: Value


@dataclass(frozen=True, slots=True)
class Shift:
    """The variable gets what the cell kept, and the cell the value of this tick."""

    name: str
    cell: str
    value: Value


@dataclass(frozen=True, slots=True)
class Count:
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
    """The window takes `guard` and `witness` of this tick; the variable says what it holds.

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

    branches: tuple[tuple[Value, Count | Advance], ...]
    otherwise: Count | Advance


Instruction = Assign | Shift | Count | Advance | Slide | Choose
