"""Equivalence of two monitors without the bits in their delay lines.

A window `guard S[lo,hi] witness` keeps the witnesses of `lo` ticks: 2^lo states, where each tick
reads one bit and writes one. So both monitors are stepped without these bits. At each step the bit
that is read is arbitrary, but the same on both sides; besides the results of the step, the bits
that both sides write are compared.

This proves that the monitors are equal: assume that they differ on a trace, and take the first tick
at which a reading differs or different bits are written. Before it, both have written the same
bits. A delay line returns the bit of `lo` ticks ago, at first false, so with lines of the same
lengths both read the same bits up to that tick. Then this trace, with these bits, was explored and
has no difference. Arbitrary bits only add traces: a difference may be spurious, and then the
monitors are compared with all of their bits.

The proof relies on the behaviour of a delay line: a step reads its oldest bit, replaces it by the
new one, and does nothing else with it. Texts in the layout of fretc satisfy this, and only these
are stepped in this way. The length of each line is counted on the library itself.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any, NamedTuple, Protocol

from fretc.verification.compiled.readings import PythonApproximation
from fretc.verification.monitor.approximations import Letter


class DelayLine(NamedTuple):
    """A delay line, and the window that it belongs to."""

    length: int
    guarded: bool
    """Whether the window counts ticks together with its guard."""


class FreeLetter(NamedTuple):
    """Inputs of a tick."""

    values: Letter
    """Values of the propositions."""
    oldest: tuple[bool, ...]
    """The bit that each delay line returns."""


class Delayed(Protocol):
    """An approximation of a monitor without the bits of its delay lines."""

    @property
    def lines(self) -> tuple[DelayLine, ...]:
        """The delay lines, in the order of `FreeLetter.oldest`."""

    def save(self) -> Hashable:
        """All cells except the delay lines."""

    def step(self, state: Any, letter: FreeLetter) -> tuple[object, ...]:
        """The reading after a tick, whether the verdict follows, and the written bits."""


class FreeWindow:
    """A window whose oldest bit is an input, with the counters of a monitor's delay line.

    `guard S[lo,hi] witness` is true if a witness became `lo` ticks old at most `hi - lo` ticks ago,
    with the guard at each tick since the witness.
    """

    def __init__(self, lo: int, hi: int, *, guarded: bool) -> None:
        """The window before the first tick; an uncounted guard counts as always true."""
        self.lo, self.none = lo, hi - lo + 1
        self.oldest = self.written = False
        self._clear, self._age = (0 if guarded else lo), self.none

    def step(self, guard: bool, witness: bool) -> bool:
        """Step like the monitor's window."""
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
        """Restore saved counters."""
        self._clear, self._age = state


class PythonDelayed:
    """An approximation of the monitor in Python with free windows."""

    def __init__(self, approximation: PythonApproximation, lines: Sequence[DelayLine]) -> None:
        """The approximation before the first tick.

        Args:
            approximation: the approximation, whose windows are replaced.
            lines: delay lines of the other monitor, as many as there are windows.
        """
        self._approximation = approximation
        self._windows = [
            FreeWindow(window.lo, window.hi, guarded=line.guarded)
            for window, line in zip(approximation.windows(), lines, strict=True)
        ]
        approximation.replace_windows(self._windows)

    def save(self) -> Hashable:
        """All cells except the bits of windows."""
        return self._approximation.save()

    def step(self, state: Any, letter: FreeLetter) -> tuple[object, ...]:
        """The reading after a tick, and the written bits."""
        for window, oldest in zip(self._windows, letter.oldest, strict=True):
            window.oldest = oldest
        told = self._approximation.step(state, letter.values)
        return (*told, *(window.written for window in self._windows))
