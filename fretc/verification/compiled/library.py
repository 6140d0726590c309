"""A monitor in a shared library as a machine whose state can be saved, restored and stepped.

The state is the bytes of the cells on which the requirement depends. The checked layout guarantees
that a step accesses no other memory. Memory is filled with nonzero bytes before initialization and
each step, so that missing assignments are detected.
"""

from __future__ import annotations

import ctypes
import hashlib
import struct
import sys
from collections.abc import Hashable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from compiler.formalization.letters import Valuation
from fretc.verification.compiled.delays import DelayLine, FreeLetter
from fretc.verification.compiled.plan import RequirementPosition
from fretc.verification.compiled.readings import VERDICTS, ApproximationReading, judged
from fretc.verification.compiled.tools import Binary, ToolError
from fretc.verification.monitor.approximations import Letter
from fretc.verification.monitor.equivalence import Judgement
from fretish.classes.frozen import dataclass
from monitors.kernel.verdicts import Truth

_OUTCOME = struct.Struct("@i7Bxi7BxIBB2x")
_TRUTHS: tuple[Truth, ...] = (False, True, None)
_CODES = {False: 0, True: 1, None: 2}
_GARBAGE = 0xA5
_HEAD = 6
"""Numbers in the layout before those of cells."""


@dataclass(frozen=True, slots=True)
class LibraryFile:
    """A shared library in a form that can be loaded."""

    path: Path
    base: str
    """Prefix of the function names."""
    cells: tuple[str, ...]
    """All cells of an approximation, in the order of the layout."""

    @contextmanager
    def running(self, plan: RequirementPosition) -> Iterator[Library]:
        """The loaded library, as a machine of one requirement.

        A process must not load two libraries from the same file, because the loader identifies a
        file by its inode.

        Raises:
            ToolError: it cannot be loaded, or its structs have another layout.
        """
        try:
            yield Library(self, plan)
        except OSError as error:
            raise ToolError(f"the library cannot be used: {error}") from None


def saved(
    binary: Binary, folder: Path, base: str, cells: tuple[str, ...]
) -> tuple[LibraryFile, str]:
    """The library written to its own folder, and its SHA-256."""
    path = folder / "monitor.so"
    path.write_bytes(binary.data)
    return LibraryFile(path, base, cells), hashlib.sha256(binary.data).hexdigest()


class Library:
    """The loaded library, with memory for one state."""

    def __init__(self, file: LibraryFile, plan: RequirementPosition) -> None:
        """The library before the first tick.

        Raises:
            OSError: the library cannot be loaded.
            ToolError: its structs have another layout.
        """
        library: Any = ctypes.CDLL(str(file.path))
        count = _HEAD + 2 * len(file.cells)
        numbers = [*(ctypes.c_size_t * count).in_dll(library, "fretc_layout")]
        size, certain, possible, inputs, outcomes, outcome = numbers[:_HEAD]
        if outcome != _OUTCOME.size or inputs != max(plan.width, 1):
            raise ToolError("this compiler lays out structs in another way")
        places = dict(
            zip(
                file.cells,
                zip(numbers[_HEAD::2], numbers[_HEAD + 1 :: 2], strict=True),
                strict=True,
            )
        )
        needed = [name for name in file.cells if name in plan.needed]
        self._cells = _joined([places[name] for name in needed])
        names = [name.removesuffix("_at") for name in needed if is_place(name)]
        self.rings = tuple(
            RingOffsets(places[name], places[f"{name}_at"], _clear(name) in needed)
            for name in names
        )
        kept = [each for each in needed if not is_place(each) and each not in names]
        self.others = _joined([places[name] for name in kept])
        self._is_original = plan.is_original
        self._approximations = (certain, possible)
        self._inputs = (ctypes.c_uint8 * inputs)()
        self._outcomes = (ctypes.c_uint8 * outcomes)()
        self._state = (ctypes.c_uint8 * size)()
        ctypes.memset(self._state, _GARBAGE, size)
        self.order = [(i, index) for i, index in enumerate(plan.inputs) if index >= 0]
        self._at = plan.outcome * outcome
        self._step = getattr(library, f"{file.base}_step")
        self._step.restype = None
        self._arguments = tuple(map(ctypes.byref, (self._state, self._inputs, self._outcomes)))
        getattr(library, f"{file.base}_init")(ctypes.byref(self._state))
        self._library = library
        self._starts = self.save(0), self.save(1)

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
        """Cells of an approximation: 0 the certain one, 1 the possible one."""
        return self.read(approximation, self._cells)

    def load(self, approximation: int, saved: bytes) -> None:
        """Restore saved cells."""
        self.write(approximation, self._cells, saved)

    def read(self, approximation: int, places: Sequence[tuple[int, int]]) -> bytes:
        """Bytes of an approximation at some offsets."""
        start = ctypes.addressof(self._state) + self._approximations[approximation]
        return b"".join([ctypes.string_at(start + at, size) for at, size in places])

    def write(self, approximation: int, places: Sequence[tuple[int, int]], saved: bytes) -> None:
        """Replace bytes of an approximation."""
        start, done = ctypes.addressof(self._state) + self._approximations[approximation], 0
        for at, size in places:
            ctypes.memmove(start + at, saved[done : done + size], size)
            done += size

    def step(
        self, letter: Sequence[Truth]
    ) -> tuple[ApproximationReading, ApproximationReading, tuple[object, ...]]:
        """Both readings after a tick, and the verdicts from them.

        An input without a value is false.
        """
        for i, index in self.order:
            self._inputs[index] = _CODES[letter[i]]
        ctypes.memset(self._outcomes, _GARBAGE, len(self._outcomes))
        self._step(*self._arguments)
        values = _OUTCOME.unpack_from(self._outcomes, self._at)
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

    def __init__(self, library: Library) -> None:
        """The machine in the library's present state."""
        self._library = library

    def save(self) -> Hashable:
        """The cells of both approximations."""
        return self._library.save(0), self._library.save(1)

    def load(self, state: Any) -> None:
        """Restore a state."""
        for approximation, cells in enumerate(state):
            self._library.load(approximation, cells)

    def step(self, letter: Valuation) -> Judgement:
        """The verdict after a tick, and FRET's finite verdict."""
        _, _, (verdict, finite, _) = self._library.step(letter)
        return str(verdict), finite is True


class CompiledApproximation:
    """One approximation of a compiled monitor; the state of the other one is arbitrary."""

    def __init__(self, library: Library, *, is_possible: bool) -> None:
        """The approximation in its present state; with `is_possible` the possible one."""
        self._library, self._approximation = library, int(is_possible)

    def save(self) -> bytes:
        """Its cells."""
        return self._library.save(self._approximation)

    def step(self, state: bytes, letter: Letter) -> tuple[object, ...]:
        """The reading after a tick, and whether the verdict follows from both approximations."""
        self._library.load(self._approximation, state)
        *readings, told = self._library.step(letter)
        return (*readings[self._approximation], told == judged(*readings))


class CompiledDelayed:
    """An approximation of a compiled monitor with arbitrary bits in its delay lines, at index 0."""

    def __init__(self, library: Library, *, is_possible: bool) -> None:
        """The approximation in its present state; with `is_possible` the possible one."""
        self._library, self._approximation = library, int(is_possible)
        start = library.save(self._approximation)
        self._lengths = [self._length(ring) for ring in library.rings]
        library.load(self._approximation, start)

    @property
    def lines(self) -> tuple[DelayLine, ...]:
        """The delay lines in the order of the cells."""
        pairs = zip(self._lengths, self._library.rings, strict=True)
        return tuple(DelayLine(length, ring.guarded) for length, ring in pairs)

    def save(self) -> bytes:
        """All cells except the delay lines."""
        return self._library.read(self._approximation, self._library.others)

    def step(self, state: bytes, letter: FreeLetter) -> tuple[object, ...]:
        """The reading, whether the verdict follows, and the written bits; or an error."""
        library, approximation = self._library, self._approximation
        library.write(approximation, library.others, state)
        for ring, oldest in zip(library.rings, letter.oldest, strict=True):
            library.write(approximation, [ring.bits], (b"\xff" if oldest else b"\0") * ring.bits[1])
            library.write(approximation, [ring.place], bytes(ring.place[1]))
        *readings, told = library.step(letter.values)
        written = [
            self._written(ring, length, oldest)
            for ring, length, oldest in zip(
                library.rings, self._lengths, letter.oldest, strict=True
            )
        ]
        return (*readings[approximation], told == judged(*readings), *written)

    def _written(self, ring: RingOffsets, length: int, oldest: bool) -> bool | None:
        """The bit that replaced the oldest one; None if anything else has changed."""
        bits = int.from_bytes(self._library.read(self._approximation, [ring.bits]), sys.byteorder)
        others = (1 << 8 * ring.bits[1]) - 2 if oldest else 0
        is_moved = self._place(ring) == (1 if length > 1 else 0)
        return bool(bits & 1) if is_moved and bits & ~1 == others else None

    def _place(self, ring: RingOffsets) -> int:
        return int.from_bytes(self._library.read(self._approximation, [ring.place]), sys.byteorder)

    def _length(self, ring: RingOffsets) -> int:
        """Ticks until the index returns to 0, increasing by one at each; 0: it does not."""
        library = self._library
        letter, capacity = (False,) * len(library.order), 8 * ring.bits[1]
        library.write(self._approximation, [ring.place], bytes(ring.place[1]))
        for tick in range(1, capacity + 1):
            library.step(letter)
            place = self._place(ring)
            if place != tick:
                return tick if place == 0 else 0
        return 0
