"""A compiled monitor as a machine whose state can be saved, restored and stepped.

The state is the bytes of the cells on which the requirement depends; where they lie is the matter
of each kind of binary.
"""

from __future__ import annotations

import struct
import sys
from abc import ABC, abstractmethod
from collections.abc import Hashable, Mapping, Sequence
from typing import Any, NamedTuple

from compiler.formalization.letters import Valuation
from fretc.verification.compiled.delays import DelayLine, FreeLetter
from fretc.verification.compiled.plan import RequirementPosition
from fretc.verification.compiled.readings import VERDICTS, ApproximationReading, judged
from fretc.verification.monitor.approximations import Letter
from fretc.verification.monitor.equivalence import Judgement
from monitors.kernel.verdicts import Truth

OUTCOME = struct.Struct("@i7Bxi7BxIBB2x")
"""A record of an outcome: both readings, the verdict, and two truth values."""
_TRUTHS: tuple[Truth, ...] = (False, True, None)
_CODES = {False: 0, True: 1, None: 2}


class MonitorMemory(ABC):
    """A monitor with memory for one state, seen as one requirement."""

    def __init__(self, places: Mapping[str, tuple[int, int]], plan: RequirementPosition) -> None:
        """The monitor before the first tick.

        Args:
            places: offset and size of each cell of an approximation, in bytes.
            plan: position of the requirement.
        """
        needed = [name for name in places if name in plan.needed]
        self._cells = _joined([places[name] for name in needed])
        names = [name.removesuffix("_at") for name in needed if is_place(name)]
        self.rings = tuple(
            RingOffsets(places[name], places[f"{name}_at"], _clear(name) in needed)
            for name in names
        )
        kept = [each for each in needed if not is_place(each) and each not in names]
        self.others = _joined([places[name] for name in kept])
        self._is_original = plan.is_original
        self.order = [(i, index) for i, index in enumerate(plan.inputs) if index >= 0]
        self._starts = self.save(0), self.save(1)

    @abstractmethod
    def read(self, approximation: int, places: Sequence[tuple[int, int]]) -> bytes:
        """Bytes of an approximation at some offsets: 0 the certain one, 1 the possible one."""

    @abstractmethod
    def write(self, approximation: int, places: Sequence[tuple[int, int]], saved: bytes) -> None:
        """Replace bytes of an approximation."""

    @abstractmethod
    def outcome(self, codes: Sequence[tuple[int, int]]) -> bytes:
        """The record `OUTCOME` after a tick.

        Args:
            codes: index of each input with a value, and its code.
        """

    def judging(self) -> CompiledMonitorMachine:
        """A machine of both approximations, before the first tick."""
        self._restart()
        return CompiledMonitorMachine(self)

    def approximation(
        self, letters: Sequence[Letter], *, is_possible: bool
    ) -> CompiledApproximation:
        """One of the approximations, before the first tick."""
        self._restart()
        return CompiledApproximation(self, is_possible=is_possible)

    def delayed(self, *, is_possible: bool) -> CompiledDelayed | None:
        """An approximation without the bits of its delay lines, before the first tick.

        None: there are none, or the text is not the one that fretc writes.
        """
        if not self.rings or not self._is_original:
            return None
        self._restart()
        return CompiledDelayed(self, is_possible=is_possible)

    def _restart(self) -> None:
        for approximation, start in enumerate(self._starts):
            self.load(approximation, start)

    def save(self, approximation: int) -> bytes:
        """Cells of an approximation."""
        return self.read(approximation, self._cells)

    def load(self, approximation: int, saved: bytes) -> None:
        """Restore saved cells."""
        self.write(approximation, self._cells, saved)

    def step(
        self, letter: Sequence[Truth]
    ) -> tuple[ApproximationReading, ApproximationReading, tuple[object, ...]]:
        """Both readings after a tick, and the verdicts from them.

        An input without a value is false.
        """
        record = self.outcome([(index, _CODES[letter[i]]) for i, index in self.order])
        values = OUTCOME.unpack(record)
        verdict, *truths = values[16:]
        told = (
            VERDICTS[verdict] if verdict < len(VERDICTS) else f"verdict {verdict}",
            *(_TRUTHS[each] if each < len(_TRUTHS) else f"truth value {each}" for each in truths),
        )
        return ApproximationReading(*values[:8]), ApproximationReading(*values[8:16]), told


class RingOffsets(NamedTuple):
    """Memory of a delay line in an approximation: offsets and sizes in bytes."""

    bits: tuple[int, int]
    place: tuple[int, int]
    """Offset and size of the index of the oldest bit."""
    guarded: bool
    """Whether the window counts ticks together with its guard."""


def is_place(name: str) -> bool:
    """Whether a cell is the index of the oldest bit in a ring."""
    return name.startswith("ring_") and name.endswith("_at")


def _clear(ring: str) -> str:
    return f"clear_{ring.removeprefix('ring_')}"


def _joined(places: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Offsets and sizes in order, with adjacent ones joined."""
    ranges: list[tuple[int, int]] = []
    for at, size in sorted(places):
        if ranges and sum(ranges[-1]) == at:
            ranges[-1] = ranges[-1][0], ranges[-1][1] + size
        else:
            ranges.append((at, size))
    return ranges


class CompiledMonitorMachine:
    """A compiled monitor with known propositions, with both of its approximations."""

    def __init__(self, memory: MonitorMemory) -> None:
        """The machine in the memory's present state."""
        self._memory = memory

    def save(self) -> Hashable:
        """The cells of both approximations."""
        return self._memory.save(0), self._memory.save(1)

    def load(self, state: Any) -> None:
        """Restore a state."""
        for approximation, cells in enumerate(state):
            self._memory.load(approximation, cells)

    def step(self, letter: Valuation) -> Judgement:
        """The verdict after a tick, and FRET's finite verdict."""
        _, _, (verdict, finite, _) = self._memory.step(letter)
        return str(verdict), finite is True


class CompiledApproximation:
    """One approximation of a compiled monitor; the state of the other one is arbitrary."""

    def __init__(self, memory: MonitorMemory, *, is_possible: bool) -> None:
        """The approximation in its present state; with `is_possible` the possible one."""
        self._memory, self._approximation = memory, int(is_possible)

    def save(self) -> bytes:
        """Its cells."""
        return self._memory.save(self._approximation)

    def step(self, state: bytes, letter: Letter) -> tuple[object, ...]:
        """The reading after a tick, and whether the verdict follows from both approximations."""
        self._memory.load(self._approximation, state)
        *readings, told = self._memory.step(letter)
        return (*readings[self._approximation], told == judged(*readings))


class CompiledDelayed:
    """An approximation of a compiled monitor with arbitrary bits in its delay lines, at index 0."""

    def __init__(self, memory: MonitorMemory, *, is_possible: bool) -> None:
        """The approximation in its present state; with `is_possible` the possible one."""
        self._memory, self._approximation = memory, int(is_possible)
        start = memory.save(self._approximation)
        self._lengths = [self._length(ring) for ring in memory.rings]
        memory.load(self._approximation, start)

    @property
    def lines(self) -> tuple[DelayLine, ...]:
        """The delay lines in the order of the cells."""
        pairs = zip(self._lengths, self._memory.rings, strict=True)
        return tuple(DelayLine(length, ring.guarded) for length, ring in pairs)

    def save(self) -> bytes:
        """All cells except the delay lines."""
        return self._memory.read(self._approximation, self._memory.others)

    def step(self, state: bytes, letter: FreeLetter) -> tuple[object, ...]:
        """The reading, whether the verdict follows, and the written bits; or an error."""
        memory, approximation = self._memory, self._approximation
        memory.write(approximation, memory.others, state)
        for ring, oldest in zip(memory.rings, letter.oldest, strict=True):
            memory.write(approximation, [ring.bits], (b"\xff" if oldest else b"\0") * ring.bits[1])
            memory.write(approximation, [ring.place], bytes(ring.place[1]))
        *readings, told = memory.step(letter.values)
        written = [
            self._written(ring, length, oldest)
            for ring, length, oldest in zip(memory.rings, self._lengths, letter.oldest, strict=True)
        ]
        return (*readings[approximation], told == judged(*readings), *written)

    def _written(self, ring: RingOffsets, length: int, oldest: bool) -> bool | None:
        """The bit that replaced the oldest one; None if anything else has changed."""
        bits = int.from_bytes(self._memory.read(self._approximation, [ring.bits]), sys.byteorder)
        others = (1 << 8 * ring.bits[1]) - 2 if oldest else 0
        is_moved = self._place(ring) == (1 if length > 1 else 0)
        return bool(bits & 1) if is_moved and bits & ~1 == others else None

    def _place(self, ring: RingOffsets) -> int:
        return int.from_bytes(self._memory.read(self._approximation, [ring.place]), sys.byteorder)

    def _length(self, ring: RingOffsets) -> int:
        """Ticks until the index returns to 0, increasing by one at each; 0: it does not."""
        memory = self._memory
        letter, capacity = (False,) * len(memory.order), 8 * ring.bits[1]
        memory.write(self._approximation, [ring.place], bytes(ring.place[1]))
        for tick in range(1, capacity + 1):
            memory.step(letter)
            place = self._place(ring)
            if place != tick:
                return tick if place == 0 else 0
        return 0
