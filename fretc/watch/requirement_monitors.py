"""The monitors of requirements, stepped tick by tick, with ticks that may become unknown later."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from operator import itemgetter

from fretc.audit.evidence.verdicts import of_kind
from fretc.audit.measurements.judgement import judge
from fretc.audit.plan import Plan
from fretc.logs.stream import ClockTick, Withdrawn
from monitors import kernel
from monitors.kernel import Column, Monitor, Outcome
from monitors.kernel.stepping import RequirementStatus
from monitors.kernel.verdicts import Truth, Verdict
from monitors.loading import load
from monitors.ticking import Ledger


class RequirementMonitors:
    """One monitor for each requirement of a plan."""

    def __init__(self, plan: Plan, kept: int = 0) -> None:
        """Monitors before the first tick; the last `kept` ticks (0: all) can become unknown."""
        self._end = Verdict(plan.declarations.clock.end)
        self.monitors = tuple(load(f"{claim.id}_monitor", claim.monitor) for claim in plan.claims)
        self.propositions = tuple(
            dict.fromkeys(name for monitor in self.monitors for name in monitor.PROPOSITIONS)
        )
        self._picks = tuple(_pick(tuple(monitor.PROPOSITIONS)) for monitor in self.monitors)
        self.counted = frozenset(claim.id for claim in plan.claims if claim.chance is not None)
        """Requirements with a probability: no single run shows whether they hold."""
        self._assumed = frozenset(claim.id for claim in plan.claims if claim.is_assumption)
        self.ledger = Ledger(self.monitors, kept)
        self._statuses: tuple[RequirementStatus, ...] | None = None
        """The statuses after the last tick, once they were read."""
        self._pending: list[tuple[list[tuple[Truth, ...]], Truth]] = []
        """For each monitor the further ticks that were last tried, and whether an obligation was
        open; empty: there are none since the last tick."""

    @property
    def count(self) -> int:
        """The number of judged ticks."""
        return len(self.ledger)

    def step(self, tick: ClockTick) -> None:
        """Judge one more tick."""
        self._forget()
        self.ledger.advance(tick.time, tick.truth)

    def withdraw(self, late: Withdrawn) -> None:
        """Mark ticks as unknown, and possibly insert one."""
        self._forget()
        if late.tick is not None:
            self.ledger.insert(late.tick, self.propositions)
        self.ledger.withdraw(late.first, late.last, late.propositions)

    def _forget(self) -> None:
        self._statuses = None
        self._pending.clear()

    def statuses(self) -> tuple[RequirementStatus, ...]:
        """The state of each requirement if the trace ended here; the same tuple until a tick."""
        if self._statuses is None:
            self._statuses = tuple(
                status for monitor in self.monitors for status in monitor.statuses()
            )
        return self._statuses

    def obligation_pending(self, rows: Iterable[Mapping[str, Truth]] = ()) -> tuple[Truth, ...]:
        """For each requirement, whether an obligation is open.

        Args:
            rows: further ticks, without an effect on the monitors.
        """
        ahead = tuple(rows)
        if not ahead:
            return tuple(status.obligation_pending for status in self.statuses())
        picked = [[pick(row) for row in ahead] for pick in self._picks]
        if not self._pending:
            self._pending = [([], None)] * len(self.monitors)
        for i, monitor in enumerate(self.monitors):
            if self._pending[i][0] != picked[i]:
                (pending,) = monitor.obligation_pending_after(picked[i])
                self._pending[i] = picked[i], pending
        return tuple(pending for _, pending in self._pending)

    def last_triggers(self) -> tuple[int | None, ...]:
        """For each requirement, the time of the last tick with a certain trigger."""
        marks = (monitor.certain.marks()[0] for monitor in self.monitors)
        return tuple(self.ledger.time(mark.last) if mark.last >= 0 else None for mark in marks)

    def verdicts(self, cut: Mapping[str, Truth] | None, *, intact: bool) -> dict[str, str]:
        """The verdicts of an audit of a log that ends here."""
        return {
            monitor.REQUIREMENTS[0].id: self._verdict(monitor, cut, intact=intact)
            for monitor in self.monitors
        }

    def _verdict(self, monitor: Monitor, cut: Mapping[str, Truth] | None, *, intact: bool) -> str:
        """The verdict of an audit; the monitor need not store the ticks before the last one."""
        ticks, last = min(1, self.count), self.ledger.last or {}
        columns = {name: _column(last.get(name), ticks) for name in monitor.PROPOSITIONS}
        engine = partial(_outcome, before=ticks)
        (own,) = judge(monitor, columns, cut, ticks, intact=intact, end=self._end, engine=engine)
        return self.audit_verdict(monitor.REQUIREMENTS[0].id, str(own.verdict))

    def audit_verdict(self, requirement: str, verdict: str) -> str:
        """The verdict in an audit of the run; a run that alone decides nothing is inconclusive."""
        verdict = of_kind(verdict, is_assumption=requirement in self._assumed)
        decides = requirement not in self.counted or verdict in (kernel.VACUOUS, kernel.NO_DATA)
        return verdict if decides else str(kernel.INCONCLUSIVE)


def _pick(names: Sequence[str]) -> Callable[[Mapping[str, Truth]], tuple[Truth, ...]]:
    """A function that gives the row of some propositions."""
    if len(names) < 2:
        return lambda truth: tuple(truth[name] for name in names)
    return itemgetter(*names)


def _column(truth: Truth, ticks: int) -> Column:
    """The column of the last tick alone."""
    return Column(int(truth is True), int(truth is None)) if ticks else Column(0, 0)


def _outcome(
    monitor: Monitor, columns: Mapping[str, Column], ticks: int, end: Verdict, before: int
) -> tuple[Outcome, ...]:
    """The outcome of a monitor after its steps, and possibly one more, which it does not keep."""
    more = [{name: columns[name].at(before) for name in monitor.PROPOSITIONS}] * (ticks > before)
    (status,) = monitor.statuses_after(more)
    verdict = status.verdict
    if end == kernel.VIOLATED and verdict == kernel.INCONCLUSIVE:
        verdict = kernel.VIOLATED
    nothing: tuple[()] = ()
    first = status.first_violation
    return (
        Outcome(
            status.requirement,
            monitor.tick + 1 + len(more),
            verdict,
            status.finite,
            first,
            *(nothing,) * 5,
        ),
    )
