"""Requirements judged tick by tick, from the raw samples of a robot that runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from operator import index

from compiler.project.project import Project
from compiler.targets.python import monitor as python
from fretc.api.refusal import Refusal, accepted, bounded
from fretc.audit.plan import Plan, planned
from fretc.logs.stream import Stream as Truths
from fretc.logs.stream import Tick as Row
from fretc.watch.requirement_monitors import RequirementMonitors
from fretish.bindings.declarations import Signal
from fretish.diagnostics.diagnostic import Code, Diagnostic, suggestion
from monitors.kernel.stepping import Standing
from monitors.kernel.verdicts import Truth


@dataclass(frozen=True, slots=True)
class Tick:
    """One tick of the declared clock."""

    number: int
    """From 0 on."""
    time_ns: int
    truth: Mapping[str, Truth]
    """Of each proposition; None is unknown."""
    standings: tuple[Standing, ...]
    """What would be said of each requirement if the trace ended here."""


@dataclass(frozen=True, slots=True)
class End:
    """What an audit says of the same samples."""

    ticks: tuple[Tick, ...]
    """Those that were left."""
    verdicts: Mapping[str, str]
    """Of each requirement: satisfied, violated, inconclusive, vacuous or no data."""


class Stream:
    """The requirements of a project, judged while samples come.

    Ticks and verdicts are those of an audit of a log with the same samples, computed by the same
    functions. Times are nanoseconds of the clock that the bindings declare.
    """

    @bounded
    def __init__(self, project: Project) -> None:
        """Judge every requirement in force.

        Raises:
            Refusal: one of them cannot be judged, or has a probability: no single run shows that.
        """
        plan = _plan(project)
        self._plan, self._declared = plan, project.declarations
        self._monitors = RequirementMonitors(plan, kept=1)
        self._truths = Truths(plan.declarations, self._monitors.propositions)

    def add(self, signal: str, time_ns: int, value: object) -> None:
        """One sample of a signal.

        What its field holds is given, in the unit of the field: a number, or a word; for a path
        with `[:]` or an index, the whole array; None where it is unknown. The signal's `values`,
        `valid`, `invalid` and `reduce` say what that means. A sample of a signal that no
        requirement reads is passed by.

        Raises:
            Refusal: there is no such signal, the value is no number and no word, it needs other
                fields of its message (then use `add_message`), or it comes late. The stream is as
                it was.
        """
        if self._signal(signal) is not None:
            error = self._truths.add(signal, index(time_ns), value)
            if error is not None:
                raise Refusal((error,))

    def add_message(self, topic: str, time_ns: int, message: object) -> None:
        """One message: a sample of each signal that reads its topic.

        The message is a mapping of its fields, or an object that has them as attributes. A message
        of a topic that no requirement reads is passed by.

        Raises:
            Refusal: a field is missing, is no number, or the message comes late. The stream is as
                it was.
        """
        error = self._truths.message(topic, index(time_ns), message)
        if error is not None:
            raise Refusal((error,))

    @property
    def findings(self) -> tuple[Diagnostic, ...]:
        """About samples that are unknown: none of the values of their signal, or no truth value."""
        return self._truths.findings

    @property
    def waiting(self) -> tuple[str, ...]:
        """The topics that have to begin before the first tick can be placed."""
        return self._truths.waiting

    def until(self, time_ns: int) -> tuple[Tick, ...]:
        """Let time pass: nothing from before `time_ns` comes any more.

        Returns:
            The ticks before that time that are new.

        Raises:
            Refusal: a million ticks or more would pass at once, or the stream has ended.
        """
        return tuple(map(self._step, accepted(self._truths.until(index(time_ns)))))

    def end(self) -> End:
        """End the stream at its last sample, or at the time that has passed if that is later.

        Raises:
            Refusal: it has ended already.
        """
        last = accepted(self._truths.end())
        ticks = tuple(map(self._step, last.ticks))
        return End(ticks, self._monitors.verdicts(last.cut, intact=True))

    def _signal(self, name: str) -> Signal | None:
        """The signal, if a requirement reads it."""
        assert self._declared is not None, "a plan has bindings"
        if name not in self._declared.signal_names:
            raise Refusal((_no_signal(name, self._declared.signal_names),))
        return self._plan.declarations.signals.get(name)

    def _step(self, row: Row) -> Tick:
        self._monitors.step(row)
        return Tick(self._monitors.count - 1, row.time, row.truth, self._monitors.standings())


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
    near = suggestion(name, names)
    return Diagnostic(
        Code.UNKNOWN_NAME,
        f"the bindings declare no signal `{name}`",
        help=f"did you mean `{near}`?" if near else f"they declare {', '.join(names)}",
    )
