"""The readings of an approximation after a tick, in any language and of the monitor in Python.

The monitor in Python is the reference for unknown values, triggers, responses, deadlines and open
obligations: `fretc.verification.monitor` proves it from its own text.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any, NamedTuple

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import Valuation
from compiler.program.lowering import program
from compiler.program.program import MARKS
from fretc.verification.monitor.approximations import Letter
from fretc.verification.monitor.equivalence import Judgement
from fretc.verification.monitor.machine import ApproximationState, Stepped
from monitors.kernel import Monitor
from monitors.kernel.verdicts import Truth


class ApproximationReading(NamedTuple):
    """Result of one approximation for a requirement after a tick."""

    left: int
    """Ticks to the deadline of the open obligation; -1: there is no deadline ahead."""
    violated: int
    failed: int
    trigger: int
    violation: int
    open: int
    satisfied_forever: int
    answer: int


VERDICTS = ("pending", "satisfied", "violated")
"""Verdicts in the order of their numbers."""
NAMES = (
    *(f"value of `{name}`" for name in ApproximationReading._fields),
    "verdict, or what is pending, from the two readings",
)
"""Names of the values that a step returns."""


def judged(
    certain: ApproximationReading, possible: ApproximationReading
) -> tuple[str, Truth, Truth]:
    """Final verdict, FRET's finite verdict, and open obligation, from both approximations."""
    if certain.violated == 1:
        verdict = "violated"
    else:
        forever = certain.satisfied_forever == 1 and possible.violated == 0
        verdict = "satisfied" if forever else "pending"
    finite: Truth = False if certain.failed == 1 else None if possible.failed == 1 else True
    is_pending, may_be = (1 in (each.trigger, each.open) for each in (certain, possible))
    return verdict, finite, False if not may_be else True if is_pending else None


class PythonApproximation:
    """An approximation of a monitor in Python, with stored ticks relative to the present one."""

    def __init__(
        self,
        monitor: Monitor,
        requirement: FormalizedRequirement,
        atoms: Sequence[str],
        *,
        is_possible: bool,
    ) -> None:
        """The approximation before the first tick.

        Args:
            monitor: monitor of the requirement alone, as fretc writes it.
            requirement: the requirement.
            atoms: order of the values in a valuation.
            is_possible: whether unknown values count as true.
        """
        self._approximation: Any = monitor.APPROXIMATION(is_possible=is_possible)
        self._cells = ApproximationState(self._approximation)
        self._deadline_ticks = monitor.REQUIREMENTS[0].deadline_ticks
        self._order = tuple(atoms.index(name) for name in monitor.PROPOSITIONS)
        (prefix,) = (
            n[: -len("_open")] for n in self._approximation.__slots__ if n.endswith("_open")
        )
        self._names = {mark: f"{prefix}_{mark}" for mark in MARKS}
        (entry,) = program({requirement.id: requirement.watch}).requirements
        self._ages: tuple[str, ...] = () if self._deadline_ticks is None else ("open",)
        if entry.renewed and self._ages:
            self._ages = ("open", "last")
        self._now = 0 if self._deadline_ticks is None else self._deadline_ticks + 2

    def windows(self) -> list[Any]:
        """Windows of the approximation, in the order of the text."""
        return [getattr(self._approximation, name) for name in self._cells.windows]

    def replace_windows(self, windows: Sequence[object]) -> None:
        """Replace the windows by others with the same methods."""
        for name, window in zip(self._cells.windows, windows, strict=True):
            setattr(self._approximation, name, window)

    def save(self) -> Hashable:
        """Cells, whether the requirement is violated or will be, and the age of an obligation."""
        latched = tuple(self._mark(name) >= 0 for name in ("broken", "violation_inevitable"))
        ages = tuple([self._age(name) for name in self._ages])
        return self._cells.save(), latched, ages

    def step(self, state: Any, letter: Letter) -> tuple[object, ...]:
        """The reading after a tick; the verdict always follows from it."""
        cells, latched, ages = state
        self._cells.load(cells)
        self._approximation.tick = self._now
        values: Mapping[str, int] = dict(zip(self._ages, ages, strict=True))
        for name, is_on in zip(("broken", "violation_inevitable"), latched, strict=True):
            setattr(self._approximation, self._names[name], 0 if is_on else -1)
        for name in ("open", "last"):
            age = values.get(name, -1)
            setattr(self._approximation, self._names[name], self._now - age if age >= 0 else -1)
        self._approximation.advance((tuple([letter[index] for index in self._order]),))
        return (*reading_of(self._approximation, self._deadline_ticks), True)

    def _mark(self, name: str) -> int:
        return int(getattr(self._approximation, self._names[name]))

    def _age(self, name: str) -> int:
        """Age in ticks, at most one more than matters; -1: there is none."""
        tick = self._mark(name)
        assert self._deadline_ticks is not None
        return min(self._approximation.tick - tick, self._deadline_ticks + 1) if tick >= 0 else -1


def reading_of(approximation: Any, deadline_ticks: int | None) -> ApproximationReading:
    """The reading of an approximation in Python for its only requirement.

    Args:
        approximation: the approximation after a tick.
        deadline_ticks: ticks from a trigger to its deadline; None: there is none.
    """
    signals, marks = approximation.signals()[0], approximation.marks()[0]
    left = -1
    if marks.open >= 0 and deadline_ticks is not None:
        left = max(-1, marks.open + deadline_ticks - approximation.tick)
    return ApproximationReading(
        left,
        marks.violated >= 0,
        bool(marks.broken >= 0 or signals.violated_if_ended),
        bool(signals.trigger),
        bool(signals.violation),
        bool(signals.obligation_pending),
        bool(signals.satisfied_forever),
        bool(signals.answer),
    )


class PythonJudging:
    """The monitor in Python with both verdicts, which must follow from the readings."""

    def __init__(self, monitor: Monitor, atoms: Sequence[str]) -> None:
        """The monitor before the first tick.

        Args:
            monitor: monitor of one requirement, as fretc writes it.
            atoms: order of the values in a valuation.
        """
        self._machine = Stepped(monitor, 0, atoms)
        self._approximation: Any = monitor.certain
        self._deadline_ticks = monitor.REQUIREMENTS[0].deadline_ticks

    def save(self) -> Hashable:
        """All cells."""
        return self._machine.save()

    def load(self, state: Hashable) -> None:
        """Restore a state."""
        self._machine.load(state)

    def step(self, letter: Valuation) -> Judgement:
        """Both verdicts after a tick; no verdict if they do not follow from the reading."""
        judgement = self._machine.step(letter)
        reading = reading_of(self._approximation, self._deadline_ticks)
        verdict, finite, _ = judged(reading, reading)
        follows = judgement == (verdict, finite is True)
        return judgement if follows else ("no verdict of its reading", judgement[1])
