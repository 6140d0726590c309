"""Programs of monitors: typed cells, a block for each temporal operator, the signals.

A program is one rail: it computes everything from literals, a proposition or its negation. With
unknowns counted as false it computes what holds for certain, and counted as true, what may hold.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from compiler.program.columns import Column
from compiler.program.instructions import Instruction
from compiler.program.values import FALSE, Literal, Value
from monitors.kernel.stepping import Marks
from monitors.kernel.verdicts import Signals

SIGNALS, MARKS = Signals._fields, Marks._fields
"""The signals of a rail, and the ticks that it remembers, for each requirement."""
SOURCES: Mapping[str, str] = dict(zip(MARKS, ("breach", "doom", "trigger", "owed"), strict=True))
"""The signal of which each mark remembers a tick."""


@dataclass(frozen=True, slots=True)
class Flag:
    """A truth value that lives from tick to tick."""

    name: str
    initial: bool
    comment: str


@dataclass(frozen=True, slots=True)
class Counter:
    """A number of ticks that lives from tick to tick, from `least` to `most`, both included."""

    name: str
    initial: int
    least: int
    most: int
    comment: str


@dataclass(frozen=True, slots=True)
class Window:
    """What `guard S[lo,hi] witness` needs of the ticks before this one."""

    name: str
    lo: int
    hi: int
    comment: str


Cell = Flag | Counter | Window


@dataclass(frozen=True, slots=True)
class Block:
    """One temporal operator: at each tick, and as a column over whole traces."""

    name: str
    """The variable or the counter that it computes."""
    comment: str
    instructions: tuple[Instruction, ...]
    column: Column | None
    """None: only ticks need the block. A block without instructions is for columns alone."""


@dataclass(frozen=True, slots=True)
class Requirement:
    """The signals of one requirement at this tick, when all blocks are done."""

    id: str
    signals: Signals[Value]
    horizon: int | None
    """Ticks from a trigger to its deadline; None: there is no deadline."""
    renewed: bool
    """A trigger replaces the demand of the trigger before it."""

    @property
    def marks(self) -> tuple[str, ...]:
        """The `MARKS` that can change: those whose signal can ever be true."""
        return tuple(mark for mark in MARKS if getattr(self.signals, SOURCES[mark]) != FALSE)


@dataclass(frozen=True, slots=True)
class Program:
    """A rail: its literals and cells, what it does at each tick, and what it tells then."""

    literals: tuple[Literal, ...]
    cells: tuple[Cell, ...]
    blocks: tuple[Block, ...]
    requirements: tuple[Requirement, ...]
