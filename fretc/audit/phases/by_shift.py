"""The phases of the ticks at which each verdict holds.

A phase is where the grid of ticks begins: whole nanoseconds from where it would begin, less than a
tick. The verdict at a phase is that of an audit whose clock declares it. It changes at finitely
many phases: where a tick comes to see another state of a proposition.

Ranges of phases are judged at once: what changes within a range is unknown there, so a verdict that
is definite holds at each of its phases (Kleene: it holds whatever the unknown values are). A range
that leaves it open is divided.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from heapq import heappop, heappush
from itertools import pairwise

from fretc.audit.measurements.judgement import Judgement, judge
from fretc.audit.phases.sliding import PropositionByPhase, PropositionsByPhase, sliding
from fretc.logs.signals.samples import Recording
from fretish.bindings.amounts import duration
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from monitors.kernel import Monitor
from monitors.kernel.verdicts import Verdict

MOST = 1 << 22
"""The most ticks that are evaluated for the phases of one requirement and log; other phases are not
judged."""
FEWEST = 64
"""The fewest evaluations, however long the log is."""
_OVERHEAD = 4096
"""The fixed cost of an evaluation, in ticks."""


@dataclass(frozen=True, slots=True)
class PhaseInterval:
    """The phases `first..last`, in nanoseconds and both included; None: not judged."""

    first: int
    last: int
    verdict: str | None

    @property
    def length(self) -> int:
        """Nanoseconds."""
        return self.last - self.first + 1


@dataclass(frozen=True, slots=True)
class Phases:
    """The verdict at each phase: adjoining intervals from 0 to one tick."""

    period: int
    """Nanoseconds of a tick."""
    declared: int
    """The phase that is audited."""
    stretches: tuple[PhaseInterval, ...]

    @property
    def verdict(self) -> str:
        """The verdict at the declared phase."""
        (declared,) = (s.verdict for s in self.stretches if s.first <= self.declared <= s.last)
        assert declared is not None, "the declared phase is judged first"
        return declared

    @property
    def verdicts(self) -> dict[str | None, int]:
        """Each verdict with the nanoseconds of its phases; that of the declared phase is first."""
        lengths: dict[str | None, int] = {self.verdict: 0}
        for stretch in self.stretches:
            lengths[stretch.verdict] = lengths.get(stretch.verdict, 0) + stretch.length
        return lengths

    @property
    def exact(self) -> bool:
        """Whether all phases were judged."""
        return None not in self.verdicts

    @property
    def varies(self) -> bool:
        """Whether there are at least two verdicts."""
        return len(self.verdicts.keys() - {None}) > 1

    @property
    def nearest(self) -> int | None:
        """Nanoseconds from the declared phase to the nearest other verdict; None: there is none.

        Phases are modulo the tick: the grid of the last one is that of phase -1 ns, except for its
        first tick.
        """
        distances = [
            _apart(end, self.declared, self.period)
            for stretch in self.stretches
            if stretch.verdict != self.verdict
            for end in (stretch.first, stretch.last)
        ]
        return min(distances, default=None)

    @property
    def text(self) -> str:
        """A sentence about the verdicts by phase; empty: all phases have one verdict."""
        if self.nearest is None:
            return ""
        shares = [
            f"{'not computed' if verdict is None else verdict} in {_share(length, self.period)}"
            for verdict, length in self.verdicts.items()
        ]
        cases = ", ".join([f"{shares[0]} of cases", *shares[1:]])
        far = duration(self.nearest / 1e9)
        near = f"a shift of {far} changes it" if self.exact else f"no change within {far}"
        return f"the verdict depends on where the ticks begin: {cases}; {near}"


def _apart(one: int, other: int, period: int) -> int:
    return min((one - other) % period, (other - one) % period)


def _share(part: int, total: int) -> str:
    """A percentage: `0 %` only of nothing, and `100 %` only of all."""
    percent = Fraction(100 * part, total)
    if percent < 1:
        return "less than 1 %"
    return f"{min(round(percent), 99) if part < total else 100} %"


def phases(
    declarations: Declarations, recording: Recording, monitors: Sequence[Monitor]
) -> dict[str, Phases]:
    """The verdict of each requirement at each phase; empty: the clock ticks by message.

    Args:
        declarations: clock, signals and propositions.
        recording: the recording with the samples of all signals of all the monitors' propositions.
        monitors: monitors of one requirement each.
    """
    names = dict.fromkeys(name for monitor in monitors for name in monitor.PROPOSITIONS)
    slides, end = sliding(declarations, recording, names), Verdict(declarations.clock.end)
    if slides is None:
        return {}
    phases_of = {}
    for monitor in monitors:
        search = _PhaseSearch(slides, monitor, intact=recording.intact, end=end)
        stretches = tuple(_merged(search.stretches()))
        phases_of[monitor.REQUIREMENTS[0].id] = Phases(slides.period, slides.declared, stretches)
    return phases_of


class _PhaseSearch:
    """A search that divides the phases until each interval has one verdict, the longest first.

    A class is an interval of phases at which the values of all ticks are equal: `first..last`.
    """

    def __init__(
        self, slides: PropositionsByPhase, monitor: Monitor, *, intact: bool, end: Verdict
    ) -> None:
        self._slides, self._monitor = slides, monitor
        self._columns = {name: slides.of[name] for name in monitor.PROPOSITIONS}
        self._intact, self._end = intact, end
        own: Sequence[PropositionByPhase] = tuple(self._columns.values())
        self._breaks = slides.breaks(own)
        """Phases at which the end of the log changes."""
        self._starts = slides.starts(own, self._breaks)
        self._left = max(FEWEST, MOST // (slides.most_ticks + _OVERHEAD))
        self._waiting: list[tuple[int, int, int]] = []
        self._found: list[PhaseInterval] = []

    def stretches(self) -> list[PhaseInterval]:
        """The verdict of each interval, in order; an interval has one class or more."""
        declared = self._class_of(self._slides.declared)
        self._settle(declared, declared)
        edges = [self._class_of(phase) for phase in self._breaks]
        edges += [declared, declared + 1, len(self._starts)]
        for first, after in pairwise(sorted({*edges})):
            if first != declared:
                self._wait(first, after - 1)
        while self._waiting and self._left > 0:
            _, first, last = heappop(self._waiting)
            if not self._settle(first, last):
                middle = (first + last) // 2
                self._settle(middle, middle)
                self._wait(first, middle - 1)
                self._wait(middle + 1, last)
        self._found += [self._stretch(first, last, None) for _, first, last in self._waiting]
        return sorted(self._found, key=lambda stretch: stretch.first)

    def _settle(self, first: int, last: int) -> bool:
        """Judge the classes together; whether that gives one verdict for all of them."""
        judgement = self._judge(first, last)
        if first != last and not judgement.certain:
            return False
        self._found.append(self._stretch(first, last, judgement.verdict))
        return True

    def _judge(self, first: int, last: int) -> Judgement:
        self._left -= 1
        low, high = self._starts[first], self._starts[last]
        ticks = self._slides.ticks(low)
        columns = {name: slide.column(low, high, ticks) for name, slide in self._columns.items()}
        (judgement,) = judge(
            self._monitor,
            columns,
            self._slides.cut(self._columns, low),
            ticks,
            intact=self._intact,
            end=self._end,
        )
        return judgement

    def _class_of(self, phase: int) -> int:
        return int(self._starts.searchsorted(phase, "right")) - 1

    def _wait(self, first: int, last: int) -> None:
        if first <= last:
            stretch = self._stretch(first, last, None)
            heappush(self._waiting, (-stretch.length, first, last))

    def _stretch(self, first: int, last: int, verdict: str | None) -> PhaseInterval:
        to_the_end = last + 1 == len(self._starts)
        after = self._slides.period if to_the_end else int(self._starts[last + 1])
        return PhaseInterval(int(self._starts[first]), after - 1, verdict)


def _merged(stretches: Sequence[PhaseInterval]) -> Iterator[PhaseInterval]:
    """The intervals, with neighbours of one verdict merged."""
    first = stretches[0]
    for stretch in stretches[1:]:
        assert stretch.first == first.last + 1
        if stretch.verdict == first.verdict:
            first = PhaseInterval(first.first, stretch.last, first.verdict)
        else:
            yield first
            first = stretch
    yield first
