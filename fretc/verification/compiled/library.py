"""A monitor in a shared library, with memory for one state.

The checked layout guarantees that a step accesses no other memory. Memory is filled with nonzero
bytes before initialization and each step, so that missing assignments are detected.
"""

from __future__ import annotations

import ctypes
import hashlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fretc.verification.compiled.memory import OUTCOME, MonitorMemory
from fretc.verification.compiled.plan import RequirementPosition
from fretc.verification.compiled.tools import Binary, ToolError
from fretish.classes.frozen import dataclass

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


class Library(MonitorMemory):
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
        if outcome != OUTCOME.size or inputs != max(plan.width, 1):
            raise ToolError("this compiler lays out structs in another way")
        pairs = zip(numbers[_HEAD::2], numbers[_HEAD + 1 :: 2], strict=True)
        self._approximations = (certain, possible)
        self._inputs = (ctypes.c_uint8 * inputs)()
        self._outcomes = (ctypes.c_uint8 * outcomes)()
        self._state = (ctypes.c_uint8 * size)()
        ctypes.memset(self._state, _GARBAGE, size)
        self._at = plan.outcome * outcome
        self._step = getattr(library, f"{file.base}_step")
        self._step.restype = None
        self._arguments = tuple(map(ctypes.byref, (self._state, self._inputs, self._outcomes)))
        getattr(library, f"{file.base}_init")(ctypes.byref(self._state))
        self._library = library
        super().__init__(dict(zip(file.cells, pairs, strict=True)), plan)

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

    def outcome(self, codes: Sequence[tuple[int, int]]) -> bytes:
        """The record of the outcome after a tick."""
        for index, code in codes:
            self._inputs[index] = code
        ctypes.memset(self._outcomes, _GARBAGE, len(self._outcomes))
        self._step(*self._arguments)
        return bytes(self._outcomes[self._at : self._at + OUTCOME.size])
