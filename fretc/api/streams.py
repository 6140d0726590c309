"""Requirements judged tick by tick, from raw samples of a running robot."""

from __future__ import annotations

from collections.abc import Mapping
from operator import index

from compiler.project.project import Project
from compiler.targets.python import monitor as python
from fretc.api.refusal import Refusal, accepted, bounded
from fretc.audit.plan import Plan, planned
from fretc.logs.stream import ClockTick as Row
from fretc.logs.stream import SampleStream as Truths
from fretc.watch.requirement_monitors import RequirementMonitors
from fretish.bindings.declarations import Signal
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic, did_you_mean
from fretish.diagnostics.messages import diagnostic
from monitors.kernel.stepping import RequirementStatus, renamed
from monitors.kernel.verdicts import Truth


@dataclass(frozen=True, slots=True)
class Tick:
    """One tick of the declared clock."""

    number: int
    """Index of the tick, from 0."""
    time_ns: int
    truth: Mapping[str, Truth]
    """Proposition → its value at the tick; None if unknown."""
    statuses: tuple[RequirementStatus, ...]
    """The verdict of each requirement if the trace ended here."""

    @property
    def standings(self) -> tuple[RequirementStatus, ...]:
        """The former name of `statuses`; deprecated."""
        renamed("standings", "statuses")
        return self.statuses


@dataclass(frozen=True, slots=True)
class End:
    """The end of a stream: the same verdicts as an audit of the same samples."""

    ticks: tuple[Tick, ...]
    """The last ticks."""
    verdicts: Mapping[str, str]
    """Requirement id → satisfied, violated, inconclusive, vacuous or no data."""


class Stream:
    """Judges the requirements of a project while samples arrive.

    Ticks and verdicts are those of an audit of a log with the same samples, computed by the same
    functions. Times are nanoseconds of the clock that the bindings declare.
    """

    @bounded
    def __init__(self, project: Project) -> None:
        """Judge every requirement in force.

        Raises:
            Refusal: a requirement cannot be judged, or has a probability, which needs many runs.
        """
        plan = _plan(project)
        self._plan, self._declared = plan, project.declarations
        self._monitors = RequirementMonitors(plan, kept=1)
        self._truths = Truths(plan.declarations, self._monitors.propositions)

    def add(self, signal: str, time_ns: int, value: object) -> None:
        """Add one sample of a signal.

        `value` is the raw content of the field, in its unit: a number or a word, or the whole array
        for a path with `[:]` or an index; None if unknown. The signal's `values`, `valid`,
        `invalid` and `reduce` are applied to it. A sample of a signal that no requirement reads is
        ignored.

        Raises:
            Refusal: the signal is unknown or computed, the value is neither a number nor a word,
                the signal needs other fields of its message (then use `add_message`), or the
                sample is late. The stream does not change.
        """
        if self._signal(signal) is not None:
            error = self._truths.add(signal, index(time_ns), value)
            if error is not None:
                raise Refusal((error,))

    def add_message(self, topic: str, time_ns: int, message: object) -> None:
        """Add one message: a sample of each signal of its topic.

        The message is a mapping of its fields, or an object that has them as attributes. A message
        of a topic that no requirement reads is ignored.

        Raises:
            Refusal: a field is missing or not a number, or the message is late. The stream does not
                change.
        """
        error = self._truths.message(topic, index(time_ns), message)
        if error is not None:
            raise Refusal((error,))

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        """Diagnostics about samples that count as unknown, because their value is not allowed."""
        return self._truths.findings

    @property
    def waiting(self) -> tuple[str, ...]:
        """The topics without a message, for which the first tick waits."""
        return self._truths.waiting

    def until(self, time_ns: int) -> tuple[Tick, ...]:
        """Let time pass: no sample from before `time_ns` follows.

        Returns:
            The new ticks before that time.

        Raises:
            Refusal: a million ticks or more would pass at once, or the stream has ended.
        """
        return tuple(map(self._step, accepted(self._truths.until(index(time_ns)))))

    def end(self) -> End:
        """End the stream at its last sample, or at the time of `until` if that is later.

        Raises:
            Refusal: the stream has ended already.
        """
        last = accepted(self._truths.end())
        ticks = tuple(map(self._step, last.ticks))
        return End(ticks, self._monitors.verdicts(last.cut, intact=True))

    def _signal(self, name: str) -> Signal | None:
        """The declared signal, or None if no requirement reads it."""
        assert self._declared is not None, "a plan has bindings"
        if name not in self._declared.signal_names:
            raise Refusal((_no_signal(name, self._declared.signal_names),))
        if name in self._declared.computed:
            text = self._declared.computed[name].text
            raise Refusal((diagnostic("sample_of_computed", name=name, text=text),))
        return self._plan.declarations.signals.get(name)

    def _step(self, row: Row) -> Tick:
        self._monitors.step(row)
        return Tick(self._monitors.count - 1, row.time, row.truth, self._monitors.statuses())


def _plan(project: Project) -> Plan:
    plan = planned(project)
    if not isinstance(plan, Plan):
        raise Refusal(plan)
    if plan.refusals:
        raise Refusal(plan.refusals)
    claimed = {claim.id for claim in plan.claims}
    refused = (
        python.refuse(requirement)
        for requirement in project.formalized
        if requirement.id in claimed
    )
    errors = [diagnostic for diagnostic in refused if diagnostic is not None]
    if errors:
        raise Refusal(errors)
    return plan


def _no_signal(name: str, names: tuple[str, ...]) -> Diagnostic:
    return diagnostic(
        "undeclared_signal",
        name=name,
        help=did_you_mean(name, names, f"they declare {', '.join(names)}"),
    )
