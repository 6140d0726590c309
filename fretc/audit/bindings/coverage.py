"""The truth values of the bound propositions in recorded runs: true, false or unknown."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from functools import partial
from typing import Any

from compiler.files.records import plain
from fretc.audit.constancy import PropositionTotal, never_changed
from fretc.audit.evidence.writer import phase_verdicts
from fretc.audit.measurements.tallies import NOTHING, PropositionTally, tally
from fretc.audit.one_log import examined, signals_of
from fretc.audit.phases.advice import Runs, proposal
from fretc.audit.phases.by_shift import Phases, phases
from fretc.audit.plan import Plan, monitored_requirements
from fretc.audit.pool import WorkerDied, killed_diagnostic, map_processes
from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from fretc.logs.signals.traces import trace
from fretish.bindings.declarations import Declarations, Signal
from fretish.classes.frozen import dataclass
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import as_json, visible


@dataclass(frozen=True, slots=True)
class LogCoverage:
    """One log: its ticks and the tally of each proposition (None: the log could not be read)."""

    run: str
    ticks: int
    tallies: Mapping[str, PropositionTally] | None
    findings: tuple[Diagnostic, ...]
    phases: Mapping[str, Phases] = field(default_factory=dict)
    """The verdict of each requirement at each phase of the ticks; empty: not computed."""


@dataclass(frozen=True, slots=True)
class PropositionCoverage:
    """The values of each proposition in each log."""

    declarations: Declarations
    logs: tuple[LogCoverage, ...]

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Diagnostics of each log, and then those of all logs together."""
        return (*self._findings, *self._of_all)

    @property
    def _of_all(self) -> tuple[Diagnostic, ...]:
        proposed = proposal(self._phased, self.declarations)
        return (*self._constant, *([proposed] if proposed else []))

    @property
    def _phased(self) -> Runs:
        return [(log.run, log.phases) for log in self.logs if log.phases]

    @property
    def _findings(self) -> tuple[Diagnostic, ...]:
        return tuple(finding for log in self.logs for finding in log.findings)

    @property
    def _constant(self) -> tuple[Diagnostic, ...]:
        return tuple(never_changed(self._totals, self.declarations, self._findings))

    @property
    def shown(self) -> bool:
        """Whether every proposition took both values in some log."""
        return all(map(self._took_both, self.declarations.propositions))

    @property
    def as_json(self) -> str:
        """A JSON object with the definition and the values of each proposition."""
        return f"{json.dumps(self._record(), indent=2, allow_nan=False)}\n"

    @property
    def text(self) -> tuple[tuple[str, str | None], ...]:
        """Lines of text, each with its colour."""
        names = self.declarations.propositions
        lines = [line for name in names for line in self._lines(name)]
        return tuple((visible(line), colour) for line, colour in (*lines, *self._phase_lines()))

    @property
    def _totals(self) -> dict[str, PropositionTotal]:
        return {
            name: PropositionTotal(sum(tallies, NOTHING), len(tallies))
            for name, tallies in self._tallies.items()
        }

    @property
    def _tallies(self) -> dict[str, list[PropositionTally]]:
        read = [log.tallies for log in self.logs if log.tallies is not None]
        return {name: [log[name] for log in read] for name in self.declarations.propositions}

    def _took_both(self, name: str) -> bool:
        return any(tally.true and tally.false for tally in self._tallies[name])

    def _lines(self, name: str) -> Iterator[tuple[str, str | None]]:
        took_both = self._took_both(name)
        sign = signs.GOOD if took_both else signs.UNKNOWN
        yield f"{sign.glyph} {name}: {_expression(self.declarations, name)}", sign.colour
        for signal in self.declarations.propositions[name].signals:
            yield f"    {_bound(self.declarations.signals[signal])}", None
        for signal in self.declarations.propositions[name].calculations:
            computed = self.declarations.computed[signal]
            yield f"    {signal} = {computed.text} {computed.unit_name}".rstrip(), None
        width = max((len(log.run) for log in self.logs), default=0)
        for log in self.logs:
            counts = "cannot be read" if log.tallies is None else _counted(log.tallies[name])
            yield f"  {log.run:<{width}}  {counts}", None
        if len(self.logs) > 1:
            yield f"  {'all logs':<{width}}  {_counted(sum(self._tallies[name], NOTHING))}", None

    def _phase_lines(self) -> Iterator[tuple[str, str | None]]:
        lines = [
            f"  {run}  {id} {phases.verdict}, {phases.text}"
            for run, phases_of in self._phased
            for id, phases in phases_of.items()
            if phases.text
        ]
        if lines:
            yield (
                f"{signs.UNKNOWN.glyph} phase of the ticks: verdicts depend on it",
                signs.UNKNOWN.colour,
            )
            yield from ((line, None) for line in lines)
        elif self._phased:
            yield (
                f"{signs.GOOD.glyph} phase of the ticks: no verdict depends on it",
                signs.GOOD.colour,
            )

    def _record(self) -> dict[str, Any]:
        return {
            "bindings": self.declarations.source.name,
            "logs": [
                {
                    "run": log.run,
                    "read": log.tallies is not None,
                    "ticks": log.ticks,
                    "findings": [as_json(finding) for finding in log.findings],
                    "phases": {
                        id: plain(phase_verdicts(phases)) for id, phases in log.phases.items()
                    },
                }
                for log in self.logs
            ],
            "propositions": [self._proposition(name) for name in self.declarations.propositions],
            "findings": [as_json(finding) for finding in self._of_all],
        }

    def _proposition(self, name: str) -> dict[str, Any]:
        signals = self.declarations.signals
        return {
            "name": name,
            "expression": _expression(self.declarations, name),
            "signals": {
                signal: signals[signal].origin
                for signal in self.declarations.propositions[name].signals
            },
            "took_both_values": self._took_both(name),
            "all": plain(sum(self._tallies[name], NOTHING)),
            "logs": {log.run: plain(log.tallies[name]) for log in self.logs if log.tallies},
        }


def _expression(declarations: Declarations, name: str) -> str:
    """The expression of a proposition in the bindings, or a comparison in a sentence."""
    data: Mapping[str, Any] = tomllib.loads(declarations.source.text)
    table = data.get("proposition", {}).get(name)
    return str(table["expr"]) if table else declarations.propositions[name].text


def _bound(signal: Signal) -> str:
    reduced = f"{signal.reduce} of " if signal.reduce else ""
    field = f"{reduced}{signal.origin}"
    value = field if signal.memory is None else f"{signal.memory.text} of {field},"
    return f"{signal.name} = {value} {signal.unit_name}".rstrip(" ,")


def _counted(tally: PropositionTally) -> str:
    ticks = tally.true + tally.false + tally.unknown
    times = f"{tally.changes} time{'' if tally.changes == 1 else 's'}"
    return (
        f"true {tally.true}, false {tally.false}, unknown {tally.unknown} "
        f"of {ticks} ticks; changed {times}"
    )


def coverage(
    declarations: Declarations, logs: Sequence[str], jobs: int, plan: Plan | None = None
) -> PropositionCoverage | Diagnostic:
    """Evaluate every proposition in every log.

    Args:
        declarations: clock, signals and propositions.
        logs: paths.
        jobs: how many processes share the logs.
        plan: the audit of the requirements, for the phases; None: they cannot be audited.
    """
    if not declarations.clock.declared or not declarations.propositions:
        what = "clock" if not declarations.clock.declared else "proposition"
        fix = "[clock]" if what == "clock" else "[proposition.NAME]"
        return diagnostic(
            "nothing_declared",
            declarations.source.span(0, 0),
            source=declarations.source.name,
            what=what,
            table=fix,
        )
    look = partial(_log_coverage, declarations=declarations, plan=plan)
    logs = tuple(dict.fromkeys(logs))
    of_logs = {
        index: LogCoverage(logs[index], 0, None, (killed_diagnostic(logs[index], str(result)),))
        if isinstance(result, WorkerDied)
        else result
        for index, result in map_processes(look, logs, jobs)
    }
    return PropositionCoverage(declarations, tuple(of_logs[index] for index in range(len(logs))))


def _log_coverage(log: str, declarations: Declarations, plan: Plan | None) -> LogCoverage:
    names = tuple(declarations.propositions)
    recording = read(log, declarations, signals_of(declarations, names))
    if isinstance(recording, Diagnostic):
        return LogCoverage(log, 0, None, (recording,))
    recording = examined(recording, declarations, names)
    truths = trace(declarations, recording, names)
    ticks = len(truths.timeline.times)
    tallies = {name: tally(column, ticks) for name, column in truths.columns.items()}
    phases_of = _phases(log, declarations, recording, plan) if plan is not None else {}
    return LogCoverage(log, ticks, tallies, recording.findings, phases_of)


def _phases(
    log: str, declarations: Declarations, recording: Recording, plan: Plan
) -> Mapping[str, Phases]:
    """The verdicts by phase, on the ticks of an audit: the requirements' topics set the first."""
    monitors = [requirement.monitor for requirement in monitored_requirements(plan)]
    if _topics(plan.declarations) != _topics(declarations):
        names = tuple(plan.declarations.signals)
        again = read(log, plan.declarations, names)
        if isinstance(again, Diagnostic):
            return {}
        recording = again
    return phases(plan.declarations, recording, monitors)


def _topics(declarations: Declarations) -> set[str]:
    return {signal.path.topic for signal in declarations.signals.values()}
