"""Windows of recorded runs as traces to start from: a violation with its history.

The page judges a window without the ticks before it. So a window begins where these make no
difference: at each tick of the window the monitor has the same outputs as in the whole run. The
exception is an obligation that began earlier, which may begin with the window.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from types import MappingProxyType

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import monitor as emitted
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.plan import Plan
from fretc.logs.reader import read
from fretc.logs.signals.traces import WholeTicks, trace
from fretc.logs.storage.log_names import path_of
from fretc.play.starts import MOST, RecordedPlace, Start, Ticks
from fretc.report.model.phrases import times
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from monitors.kernel import Column, Monitor, evaluate
from monitors.kernel.stepping import literals_of
from monitors.kernel.verdicts import Signals
from monitors.loading import load

RUNS = 20
"""Maximum number of runs whose violations become traces; the others are counted."""
SHOWN = 20
"""Maximum number of violations of a requirement that become traces; the others are counted."""
_AROUND = 10
"""Ticks to show before the history of a violation, and after the violation."""
_AFTER = 200
"""Maximum ticks of a long violation."""
_BACK = (0, 10, 30, 100, 300, 1_000)
"""Numbers of ticks by which a window may begin earlier, if earlier ticks make a difference."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """The traces of recorded runs on a page."""

    starts: tuple[Start, ...]
    notes: tuple[str, ...]
    """Sentences about what is left out."""
    findings: tuple[Diagnostic, ...] = ()
    """Diagnostics about the log."""
    sha256: str = ""
    """SHA-256 of the log, if there is only one."""


def of_log(
    requirements: Sequence[FormalizedRequirement], plan: Plan, log: str
) -> Recorded | Diagnostic:
    """The violations of a recorded run, or why the log cannot be read.

    Args:
        requirements: those that the plan audits are looked at.
        plan: of an audit.
        log: its path.
    """
    audited = {claim.id for claim in plan.claims}
    chosen = [requirement for requirement in requirements if requirement.id in audited]
    recording = read(log, plan.declarations, tuple(plan.declarations.signals), plan.integrity)
    if isinstance(recording, Diagnostic):
        return recording
    names = dict.fromkeys(name for requirement in chosen for name in requirement.watched)
    truths = trace(plan.declarations, recording, tuple(names))
    starts: list[Start] = []
    notes: list[str] = []
    violations = 0
    for requirement in chosen:
        columns = {name: truths.columns[name] for name in requirement.watched}
        others = {name: truths.columns[name] for name in names}
        run = RecordedRun(requirement, columns, truths.timeline, recording.name, others)
        starts += run.starts()
        notes += run.notes()
        violations += run.violations
    if not violations:
        notes.append(f"{recording.name}: no tick violates a requirement")
    if not recording.intact:
        notes.append(
            f"{recording.name}: messages may be lost; values that depend on them are unknown"
        )
    return Recorded(tuple(starts), tuple(notes), recording.findings, recording.sha256)


def of_evidence(
    requirements: Sequence[FormalizedRequirement], plan: Plan, evidence: EvidenceSource
) -> Recorded:
    """The violations of audited runs whose logs are unchanged.

    Args:
        requirements: those that the plan audits are looked at.
        plan: the plan of the audit.
        evidence: the evidence of the audit; the names of its logs are their paths.
    """
    ids = {requirement.id for requirement in requirements}
    violated = dict.fromkeys(
        (each.run, each.log)
        for _, each in evidence.summaries()
        if each.violations and each.requirement in ids
    )
    starts: list[Start] = []
    notes: list[str] = []
    for name, sha256 in [*violated][:RUNS]:
        found = of_log(requirements, plan, path_of(name))
        if isinstance(found, Diagnostic):
            notes.append(f"violations of {name} are left out: {found.message}")
        elif found.sha256 != sha256:
            notes.append(f"violations of {name} are left out: the log differs from the audited one")
        else:
            starts += found.starts
            notes += found.notes
    if len(violated) > RUNS:
        notes.append(f"{len(violated) - RUNS} more runs with violations are left out")
    return Recorded(tuple(starts), tuple(notes))


class RecordedRun:
    """The violations of one requirement on one run."""

    def __init__(
        self,
        requirement: FormalizedRequirement,
        columns: Mapping[str, Column],
        timeline: WholeTicks,
        name: str,
        others: Mapping[str, Column] = MappingProxyType({}),
    ) -> None:
        self._id, self._name, self._columns = requirement.id, name, columns
        self._all = {**others, **columns}
        self._monitor: Monitor = load(f"{requirement.id}.py", emitted.text(requirement))
        self._times = timeline.times
        self._ticks = len(timeline.times)
        (self._outcome,) = evaluate(self._monitor, columns, self._ticks)
        self._whole = self._signals(columns, self._ticks)
        self._windows = [self._window(*violation) for violation in self._outcome.violations[:SHOWN]]

    @property
    def violations(self) -> int:
        """The number of violations."""
        return len(self._outcome.violations)

    def starts(self) -> Iterator[Start]:
        """The windows as traces."""
        for number, window in enumerate(self._windows, 1):
            if window is None:
                continue
            first, last = window
            begin = (int(self._times[first]) - int(self._times[0])) / 1e9
            name = f"{self._id}, violation {number} of {self._name}"
            about = f"{name}: ticks {first} to {last} of the run; tick 0 here is at {begin:.3f} s"
            if not self._is_alike(first, last, 0):
                about += "; an obligation from before this window starts at its first tick"
            if len(self._all) > len(self._columns):
                about += "; other requirements are judged as if the run began here"
            at = RecordedPlace(self._name, number, begin)
            rows = (*self._rows(first, last),)
            yield Start("Recorded runs", name, about, (self._id,), rows, at)

    def notes(self) -> Iterator[str]:
        """Sentences about violations that are left out."""
        for number, window in enumerate(self._windows, 1):
            if window is None:
                what = f"violation {number} of {self._name} is left out"
                yield f"{self._id}: {what}: what led to it takes more than {MOST} ticks"
        more = self.violations - SHOWN
        if more > 0:
            verb = "is" if more == 1 else "are"
            yield f"{self._id}: {times(more, 'more violation')} of {self._name} {verb} left out"

    def _window(self, first: int, last: int) -> tuple[int, int] | None:
        """First and last tick of a window that shows a violation; None if it would be too long."""
        end = min(self._ticks - 1, last + _AROUND, first + _AFTER)
        index = bisect_right(self._outcome.triggers, first)
        trigger = self._outcome.triggers[index - 1] if index else first
        deadline_ticks = self._monitor.REQUIREMENTS[0].deadline_ticks or 0
        for begin, older in (
            (min(trigger, first - deadline_ticks), 0),
            (first - deadline_ticks, 1),
        ):
            for back in (*_BACK, begin):
                start = max(0, begin - _AROUND - back)
                if end - start < MOST and self._is_alike(start, end, older):
                    return start, end
        return None

    def _is_alike(self, first: int, last: int, older: int) -> bool:
        """Whether the monitor outputs on the window alone equal those on the whole run.

        Args:
            first: the first tick.
            last: the last one.
            older: 1 if a trigger at the first tick may represent earlier triggers.
        """
        count = last - first + 1
        every = (1 << count) - 1
        part = {
            name: Column(column.true >> first & every, column.unknown >> first & every)
            for name, column in self._columns.items()
        }
        own = self._signals(part, count)
        return all(
            (whole >> first ^ alone) & every & ~(older if name == "trigger" else 0) == 0
            for name, whole, alone in zip(2 * Signals._fields, self._whole, own, strict=True)
        )

    def _signals(self, columns: Mapping[str, Column], ticks: int) -> tuple[int, ...]:
        """The monitor outputs for the certain and the possible value, as columns."""
        every = (1 << ticks) - 1
        approximations = [
            self._monitor.columns(every, **literals_of(self._monitor, columns, every, is_possible))
            for is_possible in (False, True)
        ]
        return tuple(column & every for (signals,) in approximations for column in signals)

    def _rows(self, first: int, last: int) -> Iterator[Ticks]:
        """Consecutive equal ticks, with their count."""
        rows = [
            {name: column.at(tick) for name, column in self._all.items()}
            for tick in range(first, last + 1)
        ]
        for values, equal in groupby(rows):
            yield sum(1 for _ in equal), dict(values)
