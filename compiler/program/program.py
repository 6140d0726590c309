"""Programs of monitors: typed cells, a block for each temporal operator, and the signals.

A program computes one of the two bounds: it is evaluated over literals, a proposition or its
negation each. With unknowns counted as false it computes certain values, and with unknowns counted
as true possible values.
"""

from __future__ import annotations

from collections.abc import Mapping

from compiler.program.columns import Column
from compiler.program.instructions import Instruction
from compiler.program.values import FALSE, Literal, Value
from fretish.classes.frozen import dataclass
from monitors.kernel.stepping import Marks
from monitors.kernel.verdicts import Signals

SIGNALS, MARKS = Signals._fields, Marks._fields
"""The signals of a program, and the ticks that it remembers, for each requirement."""
SOURCES: Mapping[str, str] = dict(
    zip(MARKS, ("violation", "violation_inevitable", "trigger", "obligation_pending"), strict=True)
)
"""The signal whose tick each mark remembers."""


@dataclass(frozen=True, slots=True)
class StoredFlag:
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
class WindowMemory:
    """The memory of `guard S[lo,hi] witness` about earlier ticks."""

    name: str
    lo: int
    hi: int
    comment: str


Cell = StoredFlag | Counter | WindowMemory


@dataclass(frozen=True, slots=True)
class Block:
    """The code of one temporal operator, for each tick and as a column over whole traces."""

    name: str
    """The variable or the counter that the block computes."""
    comment: str
    instructions: tuple[Instruction, ...]
    column: Column | None
    """None: the block is needed for ticks only. A block without instructions is needed for columns
    only."""


@dataclass(frozen=True, slots=True)
class RequirementProgram:
    """The signals of one requirement at this tick, after all blocks."""

    id: str
    signals: Signals[Value]
    deadline_ticks: int | None
    """Ticks from a trigger to its deadline; None: there is no deadline."""
    renewed: bool
    """A trigger replaces the demand of the trigger before it."""

    @property
    def marks(self) -> tuple[str, ...]:
        """The `MARKS` that can change, because their signal can be true."""
        return tuple(mark for mark in MARKS if getattr(self.signals, SOURCES[mark]) != FALSE)


@dataclass(frozen=True, slots=True)
class Program:
    """A program: its literals and cells, its blocks, and its signals."""

    literals: tuple[Literal, ...]
    cells: tuple[Cell, ...]
    blocks: tuple[Block, ...]
    requirements: tuple[RequirementProgram, ...]
