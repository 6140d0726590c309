"""A monitor's text as a machine whose state can be saved, restored and stepped.

That is sound only if a step depends only on cells and propositions:
`fretc.verification.monitor.text_check` checks that on the text before anything of it is executed.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from typing import Any

from compiler.formalization.letters import Valuation
from fretc.verification.monitor.equivalence import Judgement
from monitors.kernel import Monitor


class ApproximationState:
    """All cells of an approximation: a step reads no other stored value."""

    def __init__(self, approximation: Any, among: Collection[str] | None = None) -> None:
        """The cells of an approximation.

        Args:
            approximation: approximation in the layout that fretc writes.
            among: the relevant cells; the others have no influence.
        """
        self._approximation = approximation
        cells = [name for name in approximation.CELLS if among is None or name in among]
        # The text has its own class for windows.
        self._windows = [n for n in cells if hasattr(getattr(approximation, n), "restore")]
        self._plain = [name for name in cells if name not in self._windows]

    @property
    def windows(self) -> tuple[str, ...]:
        """Names of the windows, in the order of the text."""
        return tuple(self._windows)

    def save(self) -> Hashable:
        """Values of the cells."""
        approximation = self._approximation
        cells = tuple([getattr(approximation, name) for name in self._plain])
        return cells, tuple([getattr(approximation, name).state() for name in self._windows])

    def load(self, state: Any) -> None:
        """Restore saved values."""
        approximation, (cells, windows) = self._approximation, state
        for name, value in zip(self._plain, cells, strict=True):
            setattr(approximation, name, value)
        for name, value in zip(self._windows, windows, strict=True):
            getattr(approximation, name).restore(value)


class Stepped:
    """A monitor with known propositions."""

    def __init__(
        self,
        monitor: Monitor,
        index: int,
        atoms: Sequence[str],
        cells: Collection[str] | None = None,
    ) -> None:
        """The monitor before its first tick.

        Args:
            monitor: monitor in the layout that fretc writes; it is reset.
            index: index of the requirement in the monitor.
            atoms: order of the values in a valuation; at least the monitor's propositions.
            cells: cells on which the requirement depends; None: all.
        """
        monitor.reset()
        approximation: Any = monitor.certain
        self._approximation, self._place = approximation, index
        self._alone = len(monitor.REQUIREMENTS) == 1
        self._step = _stepping(monitor, atoms)
        self._cells = ApproximationState(approximation, cells)
        self._fates = [
            n for n in approximation.__slots__ if n.endswith(("_broken", "_violation_inevitable"))
        ]

    def save(self) -> Hashable:
        """All cells."""
        return self._cells.save()

    def load(self, state: Any) -> None:
        """Restore a state without violation."""
        self._cells.load(state)
        for name in self._fates:
            setattr(self._approximation, name, -1)

    def step(self, letter: Valuation) -> Judgement:
        """Verdict of the text's own step, and FRET's finite verdict."""
        verdicts = self._step(letter)
        approximation = self._approximation
        signals, marks = approximation.signals()[self._place], approximation.marks()[self._place]
        verdict = verdicts if self._alone else verdicts[self._place]
        return str(verdict), marks.broken < 0 and not signals.violated_if_ended

    def demands(self) -> tuple[bool, bool]:
        """Whether an obligation began at the last tick, and whether one is open after it."""
        signals = self._approximation.signals()[self._place]
        return bool(signals.trigger), bool(signals.obligation_pending)


def _stepping(monitor: Any, atoms: Sequence[str]) -> Callable[[Valuation], Any]:
    """A step of the monitor by truth values, through its own `step` if that takes them.

    A monitor of variables computes truth values from them, and advances by these.
    """
    parameters = [(p, atoms.index(name)) for name, p in monitor.PROPOSITIONS.items()]
    if not isinstance(getattr(monitor, "VARIABLES", None), Mapping):
        return lambda letter: monitor.step(**{p: letter[i] for p, i in parameters})
    is_alone = len(monitor.REQUIREMENTS) == 1

    def step(letter: Valuation) -> Any:
        monitor.advance((tuple([letter[i] for _, i in parameters]),))
        verdicts = monitor.verdicts()
        return verdicts[0] if is_alone else verdicts

    return step
