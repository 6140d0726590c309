"""Two monitors compared without the bits in their delay lines.

A window `guard S[lo,hi] witness` keeps the witnesses of `lo` ticks: 2^lo states, where each tick
reads one bit and writes one. So both monitors are stepped without these bits. At each step the bit
that is read is any, false or true, and the same one on both sides; and beside what the step gives,
the bits that both sides write are compared.

Why that proves the monitors themselves equal: assume that they differ on a trace, and take the
first tick at which a reading differs or different bits are written. Before it, both have written
the same bits. A delay line gives the bit of `lo` ticks ago, at first false, so with lines of the
same lengths both read the same bits up to that tick. Then this trace, with these bits, is one of
those that were explored, and it has no difference. That the bits are any adds traces, and takes
none away: a difference that is found may be no real one, and then the monitors are compared with
all of their bits.

It rests on what a delay line is: that a step reads its oldest bit, puts the new one in its place,
and does nothing else with it. In a text that fretc writes it is so, and only such a text is stepped
like this. The length of each line is counted on the library itself.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any, NamedTuple, Protocol

from fretc.verification.compiled.readings import PythonRail
from fretc.verification.monitor.rails import Letter


class Line(NamedTuple):
    """A delay line, and the window that it belongs to."""

    length: int
    guarded: bool
    """Whether the window counts the ticks with its guard."""


class FreeLetter(NamedTuple):
    """What comes at a tick."""

    values: Letter
    """Of the propositions."""
    oldest: tuple[bool, ...]
    """The bit that each delay line gives."""


class Delayed(Protocol):
    """A rail of a monitor without the bits of its delay lines."""

    @property
    def lines(self) -> tuple[Line, ...]:
        """In the order of `FreeLetter.oldest`."""

    def save(self) -> Hashable:
        """All cells but the delay lines."""

    def step(self, state: Any, letter: FreeLetter) -> tuple[object, ...]:
        """The reading one tick after a state, whether the verdict follows, and the bits written."""


class FreeWindow:
    """A window whose oldest bit is given: the counters around a delay line, as monitors have them.

    `guard S[lo,hi] witness` is true where a witness became `lo` ticks old at most `hi - lo` ticks
    ago, with the guard at each tick since the witness.
    """

    def __init__(self, lo: int, hi: int, *, guarded: bool) -> None:
        """Before the first tick, where the guard counts as true for ever if it is not counted."""
        self.lo, self.none = lo, hi - lo + 1
        self.oldest = self.written = False
        self._clear, self._age = (0 if guarded else lo), self.none

    def step(self, guard: bool, witness: bool) -> bool:
        """As the window's own `step`."""
        self._clear = min(self._clear + 1, self.lo) if guard else 0
        if self.oldest and self._clear >= self.lo:
            self._age = 0
        elif guard:
            self._age = min(self._age + 1, self.none)
        else:
            self._age = self.none
        self.written = bool(witness)
        return self._age < self.none

    def state(self) -> tuple[int, int]:
        """Both counters."""
        return self._clear, self._age

    def restore(self, state: tuple[int, int]) -> None:
        """Go back to counters that were saved."""
        self._clear, self._age = state


class PythonDelayed:
    """A rail of the monitor in Python with free windows."""

    def __init__(self, rail: PythonRail, lines: Sequence[Line]) -> None:
        """Before the first tick.

        Args:
            rail: it; its windows are replaced.
            lines: those of the other monitor; as many as there are windows.
        """
        self._rail = rail
        self._windows = [
            FreeWindow(window.lo, window.hi, guarded=line.guarded)
            for window, line in zip(rail.windows(), lines, strict=True)
        ]
        rail.replace_windows(self._windows)

    def save(self) -> Hashable:
        """All cells but the bits of windows."""
        return self._rail.save()

    def step(self, state: Any, letter: FreeLetter) -> tuple[object, ...]:
        """The reading one tick after a state, and the bits that are written."""
        for window, oldest in zip(self._windows, letter.oldest, strict=True):
            window.oldest = oldest
        told = self._rail.step(state, letter.values)
        return (*told, *(window.written for window in self._windows))
