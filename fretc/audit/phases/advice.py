"""Diagnostics about phases: verdicts that depend on the phase, and a better phase.

Phases are nanoseconds modulo the tick: after the last one comes the first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from fretc.audit.phases.by_shift import Phases
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.clock import in_words
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from monitors import kernel

_STAMPS = 'or use the stamps of the messages: `time = "header.stamp"`'


def findings(phases_of: Mapping[str, Phases], declarations: Declarations) -> Iterator[Diagnostic]:
    """F425 for each requirement that one log violates at some phases and not at others, and F426.

    Args:
        phases_of: the verdicts of one log at each phase, by requirement.
        declarations: the bindings with the clock.
    """
    for id, phases in phases_of.items():
        if phases.varies and kernel.VIOLATED in phases.verdicts:
            yield diagnostic("phase_dependent", place(declarations), id=id, stamps=_STAMPS)
        if not phases.exact:
            yield diagnostic("phases_not_judged", place(declarations), id=id)


def place(declarations: Declarations) -> Span:
    """The place of the table `[clock]`."""
    source = declarations.source
    start = max(0, source.text.find("[clock]"))
    return source.span(start, start + len("[clock]") if source.text[start:] else start)


@dataclass(frozen=True, slots=True)
class Arc:
    """An interval of phases, modulo the tick, at which no verdict changes."""

    first: int
    length: int

    def offset(self, phase: int, period: int) -> int:
        """The distance of a phase from the first one."""
        return (phase - self.first) % period

    def margin(self, phase: int, period: int) -> int:
        """Nanoseconds from a phase within the interval to the nearest one outside."""
        behind = self.offset(phase, period)
        return min(behind + 1, self.length - behind)

    def middle(self, period: int) -> int:
        """The roundest phase of the middle fifth."""
        low, high = self.first + 2 * self.length // 5, self.first + 3 * self.length // 5
        unit = 1
        while low <= high // (10 * unit) * (10 * unit):
            unit *= 10
        centre = self.first + self.length // 2
        near = [n for n in (centre // unit * unit, (centre // unit + 1) * unit) if low <= n <= high]
        return min(near, key=lambda n: abs(n - centre), default=centre) % period


def longest(phases_of_all: Sequence[Phases]) -> Arc | None:
    """The longest interval of phases at which no verdict changes; None: no verdict ever does.

    Args:
        phases_of_all: the phases of any logs and requirements, with one clock.
    """
    edges = sorted({edge for phases in phases_of_all for edge in _edges(phases)})
    if not edges:
        return None
    period = phases_of_all[0].period
    after = [*edges[1:], edges[0] + period]
    arcs = [Arc(edge, then - edge) for edge, then in zip(edges, after, strict=True)]
    decided = [arc for arc in arcs if all(_at(phases, arc.first) for phases in phases_of_all)]
    return max(decided, key=lambda arc: arc.length, default=None)


def _edges(phases: Phases) -> Iterator[int]:
    """The phases at which another verdict begins, or at which none was computed."""
    yield from (stretch.first for stretch in phases.stretches[1:])
    if phases.stretches[0].verdict != phases.stretches[-1].verdict:
        yield 0


def _at(phases: Phases, phase: int) -> str | None:
    return next(s.verdict for s in phases.stretches if s.first <= phase <= s.last)


Runs = Sequence[tuple[str, Mapping[str, Phases]]]
"""Each log with the phases of its requirements."""


def proposal(runs: Runs, declarations: Declarations) -> Diagnostic | None:
    """F427: a phase that is farther from any change of a verdict than the declared one.

    None if no verdict depends on the phase, or the declared one is about as good.
    """
    every = [phases for _, phases_of in runs for phases in phases_of.values()]
    arc = longest(every)
    if arc is None:
        return None
    period, declared = every[0].period, every[0].declared
    best = arc.middle(period)
    now = min(phases.nearest for phases in every if phases.nearest is not None)
    if 2 * now >= arc.margin(best, period):
        return None
    others = [
        f"{id} in `{run}` is {_at(phases, best)} there, and {phases.verdict} as declared"
        for run, phases_of in runs
        for id, phases in phases_of.items()
        if _at(phases, best) != phases.verdict
    ]
    more = f", and {len(others) - 1} more such" if len(others) > 1 else ""
    return Diagnostic(
        Code.PHASE_PROPOSED,
        f"at phase {in_words(best)} no verdict changes within "
        f"{in_words(arc.margin(best, period))}, at the declared one "
        f"({in_words(declared)}) one does within {in_words(now)}"
        + (f"; {others[0]}{more}" if others else ""),
        place(declarations),
        help=f'write `phase = "{in_words(best)}"` under `[clock]`, {_STAMPS}',
        severity=Severity.NOTE,
    )
