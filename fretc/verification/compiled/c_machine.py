"""A compiled monitor as a machine whose state can be saved, restored and stepped.

Its state is the bytes of the cells that the requirement depends on. The form of the text
(`c_form`) grants that a step reaches no other memory. Memory is not zero before `init` and `step`:
what they leave out is seen.
"""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from compiler.formalization.letters import Valuation
from fretc.verification.compiled.readings import Reading, judged
from fretc.verification.monitor.equivalence import Judgement
from fretc.verification.monitor.rails import Letter
from monitors.kernel.verdicts import Truth

_OUTCOME = struct.Struct("@i7Bxi7BxIB3x")
_VERDICTS = ("pending", "satisfied", "violated")
_TRUTHS: tuple[Truth, ...] = (False, True, None)
_CODES = {False: 0, True: 1, None: 2}
_GARBAGE = 0xA5
_HEAD = 5
"""Numbers in the layout before those of cells."""


class LayoutError(Exception):
    """The structs of the library are not laid out as we read them; the message says which."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Where the requirement is in a library; it can be sent to another process."""

    base: str
    """What the names of the functions begin with."""
    cells: tuple[str, ...]
    """All of a rail, in the order of the layout."""
    needed: frozenset[str]
    """Those that the requirement depends on."""
    outcome: int
    """The place of the requirement among the outcomes."""
    inputs: tuple[int, ...]
    """For each value of a letter, the place of its input; -1: there is none."""
    width: int
    """How many inputs there are."""


class Library:
    """The compiled text, with memory of its own for one state."""

    def __init__(self, path: Path, plan: Plan) -> None:
        """Before the first tick.

        A process must load no two of them: the loader knows a file by its inode, which the next
        file may get.

        Raises:
            OSError: the library cannot be loaded.
            LayoutError: its structs are not as we read them.
        """
        library: Any = ctypes.CDLL(str(path))
        count = _HEAD + 2 * len(plan.cells)
        numbers = [*(ctypes.c_size_t * count).in_dll(library, "fretc_layout")]
        size, possible, inputs, outcomes, outcome = numbers[:_HEAD]
        if outcome != _OUTCOME.size or inputs != max(plan.width, 1):
            raise LayoutError("this compiler lays out structs in another way")
        places = dict(zip(plan.cells, zip(numbers[5::2], numbers[6::2], strict=True), strict=True))
        self._cells = _joined([places[name] for name in plan.cells if name in plan.needed])
        self._rails = (0, possible)
        self._inputs = (ctypes.c_uint8 * inputs)()
        self._outcomes = (ctypes.c_uint8 * outcomes)()
        self._state = (ctypes.c_uint8 * size)()
        ctypes.memset(self._state, _GARBAGE, size)
        self._order = [(i, place) for i, place in enumerate(plan.inputs) if place >= 0]
        self._at = plan.outcome * outcome
        self._step = getattr(library, f"{plan.base}_step")
        self._step.restype = None
        self._arguments = tuple(map(ctypes.byref, (self._state, self._inputs, self._outcomes)))
        getattr(library, f"{plan.base}_init")(ctypes.byref(self._state))
        self._library = library

    def save(self, rail: int) -> bytes:
        """The cells of a rail: 0 the certain one, 1 the possible one."""
        start = ctypes.addressof(self._state) + self._rails[rail]
        return b"".join([ctypes.string_at(start + at, size) for at, size in self._cells])

    def load(self, rail: int, saved: bytes) -> None:
        """Go back to cells that were saved."""
        start, done = ctypes.addressof(self._state) + self._rails[rail], 0
        for at, size in self._cells:
            ctypes.memmove(start + at, saved[done : done + size], size)
            done += size

    def step(self, letter: Sequence[Truth]) -> tuple[Reading, Reading, tuple[object, Truth | str]]:
        """Both readings after a tick, and what is judged from them.

        An input that no value of the letter is for is false.
        """
        for i, place in self._order:
            self._inputs[place] = _CODES[letter[i]]
        ctypes.memset(self._outcomes, _GARBAGE, len(self._outcomes))
        self._step(*self._arguments)
        values = _OUTCOME.unpack_from(self._outcomes, self._at)
        verdict, finite = values[16:]
        told = (
            _VERDICTS[verdict] if verdict < len(_VERDICTS) else f"verdict {verdict}",
            _TRUTHS[finite] if finite < len(_TRUTHS) else f"truth value {finite}",
        )
        return Reading(*values[:8]), Reading(*values[8:16]), told


def _joined(places: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Offsets and sizes in order, with what lies side by side as one."""
    found: list[tuple[int, int]] = []
    for at, size in sorted(places):
        if found and sum(found[-1]) == at:
            found[-1] = found[-1][0], found[-1][1] + size
        else:
            found.append((at, size))
    return found


class Judging:
    """A compiled monitor whose propositions are all known, with both of its rails."""

    def __init__(self, library: Library) -> None:
        """From its present state."""
        self._library = library

    def save(self) -> Hashable:
        """The cells of both rails."""
        return self._library.save(0), self._library.save(1)

    def load(self, state: Any) -> None:
        """Go back to a state."""
        for rail, cells in enumerate(state):
            self._library.load(rail, cells)

    def step(self, letter: Valuation) -> Judgement:
        """The verdict that it tells, and FRET's finite one."""
        _, _, (verdict, finite) = self._library.step(letter)
        return str(verdict), finite is True


class CompiledRail:
    """One rail of a compiled monitor; the other one goes on from wherever it is."""

    def __init__(self, library: Library, *, doubt: bool) -> None:
        """From its present state; with `doubt` the rail of what may hold."""
        self._library, self._rail = library, int(doubt)

    def save(self) -> bytes:
        """Its cells."""
        return self._library.save(self._rail)

    def step(self, state: bytes, letter: Letter) -> tuple[object, ...]:
        """What it tells one tick after a state, and whether the verdict follows from both rails."""
        self._library.load(self._rail, state)
        *readings, told = self._library.step(letter)
        return (*readings[self._rail], told == judged(*readings))
