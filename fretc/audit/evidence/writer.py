"""What one audit of one run against one requirement has shown, as plain values.

The JSON form is versioned; its schema is `templates/json/evidence.schema.json`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import isinf, isnan
from statistics import median
from typing import Any

from fretc.audit.measurements.margins import CROSSED, Margin
from fretc.audit.measurements.tallies import Tally
from fretc.audit.measurements.trials import Trials
from fretc.audit.measurements.violations import Moment, Violation, Window
from fretc.audit.phases.by_shift import Phases
from fretc.logs.signals.integrity import Checked
from fretc.logs.signals.samples import Recording, Samples
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import as_json
from monitors.kernel import NO_DATA, Outcome

SCHEMA = "fretc-evidence-1"


@dataclass(frozen=True, slots=True)
class Evidence:
    """One run, one requirement."""

    run: str
    requirement: str
    verdict: str
    reason: str
    outcome: Outcome
    start_ns: int
    end_ns: int
    first_ns: int
    """When the first tick is; the start of the run, where there is none."""
    clock: str
    answers: tuple[tuple[Moment, Moment], ...]
    """Trigger and answer, where a demand waits for one and it came."""
    states: tuple[tuple[Moment, str], ...]
    """When the state changed, and to what (`fretc.audit.measurements.states`)."""
    triggers: tuple[Moment, ...]
    violations: tuple[Violation, ...]
    open: tuple[Moment, ...]
    """Triggers whose demand is open at the end of the log."""
    latencies: tuple[float, ...]
    """Seconds from each trigger to its answer, in the order of the triggers."""
    propositions: Mapping[str, Tally]
    """Of each proposition of the sentence how often it was true, false and unknown."""
    margins: tuple[Margin, ...]
    """How near the signals came to the thresholds of the propositions."""
    units: Mapping[str, str]
    """The base unit of each signal."""
    hashes: Mapping[str, str]
    """SHA-256 of the log, the sentence, the bindings and the monitor."""
    health: Mapping[str, Any]
    assumptions: tuple[str, ...]
    trials: Trials | None = None
    """Of a requirement with a probability: what its triggers came to."""
    phases: Phases | None = None
    """The verdict at each phase of the ticks, of one with a probability that of the run alone; None
    where the clock ticks by message."""


def health(recording: Recording) -> dict[str, Any]:
    """Whether the data of the run can be trusted, and why not."""
    return {
        "intact": recording.intact,
        "size": recording.size,
        "checked": _checked(recording.checked),
        "gaps": [{"start_ns": start, "end_ns": end} for start, end in recording.gaps],
        "findings": [as_json(finding) for finding in recording.findings],
        "topics": {
            name: {
                "type": topic.type,
                "count": topic.count,
                "first_ns": topic.first_ns,
                "last_ns": topic.last_ns,
                "longest_gap_ns": topic.longest_gap_ns,
                "median_period_ns": topic.median_period_ns,
                "out_of_order": topic.out_of_order,
                "equal_stamps": topic.equal_stamps,
                "unstamped": topic.unstamped,
                "zero_stamps": topic.zero_stamps,
                "clock_jumps": topic.clock_jumps,
            }
            for name, topic in sorted(recording.topics.items())
        },
    }


def _checked(checked: Checked) -> dict[str, Any]:
    return {
        "by_index": checked.by_index,
        "chunks": checked.chunks,
        "crc_checked": checked.crc_checked,
        "crc_unchecked": checked.crc_unchecked,
        "without_crc": checked.without_crc,
        "skipped": checked.skipped,
    }


def as_record(evidence: Evidence) -> dict[str, Any]:
    """The JSON object of one run and requirement."""
    return {
        "run": evidence.run,
        "requirement": evidence.requirement,
        "verdict": evidence.verdict,
        "finite": evidence.outcome.finite,
        "reason": evidence.reason,
        "clock": evidence.clock,
        "ticks": evidence.outcome.ticks,
        "start_ns": evidence.start_ns,
        "end_ns": evidence.end_ns,
        "states": [{**_moment(moment), "state": state} for moment, state in evidence.states],
        "answers": [{**_moment(k), "trigger": t.tick} for t, k in evidence.answers],
        "triggers": [_moment(moment) for moment in evidence.triggers],
        "violations": [_violation(violation) for violation in evidence.violations],
        "unknown": [list(run) for run in evidence.outcome.unknown],
        "open": [_moment(moment) for moment in evidence.open],
        "uncertain": list(evidence.outcome.uncertain),
        "latencies_s": list(evidence.latencies),
        **_exercise(evidence),
        "propositions": {name: asdict(tally) for name, tally in evidence.propositions.items()},
        "thresholds": [_threshold(margin, evidence) for margin in evidence.margins],
        "units": dict(evidence.units),
        "hashes": dict(evidence.hashes),
        "health": dict(evidence.health),
        "assumptions": list(evidence.assumptions),
        **_trials(evidence.trials),
        **({} if evidence.phases is None else {"phases": evidence.phases.as_record}),
    }


def _trials(trials: Trials | None) -> dict[str, Any]:
    if trials is None:
        return {}
    counts = {"answered": trials.answered, "failed": trials.failed, "open": trials.open}
    return {"trials": counts}


def unread(
    run: str, requirement: str, diagnostic: Diagnostic, hashes: Mapping[str, str]
) -> dict[str, Any]:
    """The JSON object of a run whose log could not be read: nothing is shown."""
    health: dict[str, Any] = {
        "intact": False,
        "size": None,
        "checked": None,
        "gaps": [],
        "findings": [as_json(diagnostic)],
        "topics": {},
    }
    return unjudged(run, requirement, diagnostic.message, hashes, health)


def unjudged(
    run: str,
    requirement: str,
    reason: str,
    hashes: Mapping[str, str],
    health: Mapping[str, Any],
) -> dict[str, Any]:
    """The JSON object of a run and a requirement that could not be held against it."""
    return {
        "run": run,
        "requirement": requirement,
        "verdict": NO_DATA,
        "finite": None,
        "reason": reason,
        "clock": "",
        "ticks": 0,
        "start_ns": None,
        "end_ns": None,
        "states": [],
        "answers": [],
        "triggers": [],
        "violations": [],
        "unknown": [],
        "open": [],
        "uncertain": [],
        "latencies_s": [],
        "exercised": 0,
        "latency_median_s": None,
        "latency_max_s": None,
        "propositions": {},
        "thresholds": [],
        "units": {},
        "hashes": dict(hashes),
        "health": dict(health),
        "assumptions": [],
    }


def _moment(moment: Moment) -> dict[str, Any]:
    return {"tick": moment.tick, "ns": moment.ns, "seconds": moment.seconds}


def _exercise(evidence: Evidence) -> dict[str, Any]:
    latencies = evidence.latencies
    return {
        "exercised": len(evidence.triggers),
        "latency_median_s": round(median(latencies), 9) if latencies else None,
        "latency_max_s": max(latencies, default=None),
    }


def _threshold(margin: Margin, evidence: Evidence) -> dict[str, Any]:
    threshold, kept = margin.threshold, margin.comparison
    return {
        "proposition": threshold.proposition,
        "signal": threshold.text,
        "operator": threshold.operator,
        "bound": threshold.bound,
        "unit": threshold.unit,
        "least": _reading(margin.least),
        "greatest": _reading(margin.greatest),
        "comparison": kept if kept is None or kept == CROSSED else str(kept).lower(),
        "margin": margin.distance,
        "nearest": _instant(margin.nearest_ns, evidence),
    }


def _instant(ns: int | None, evidence: Evidence) -> dict[str, Any] | None:
    """A time of the log that need not be one of a tick; before the first tick it is negative."""
    if ns is None:
        return None
    return {"ns": ns, "seconds": round((ns - evidence.first_ns) / 1e9, 9)}


def _reading(value: float | None) -> float | str | None:
    """A number that may be unknown (null) or infinite, for which JSON has no number."""
    if value is None or isnan(value):
        return None
    return ("+inf" if value > 0 else "-inf") if isinf(value) else value


def _violation(violation: Violation) -> dict[str, Any]:
    return {
        "first_tick": violation.first.tick,
        "last_tick": violation.last.tick,
        "start_ns": violation.first.ns,
        "end_ns": violation.last.ns,
        "start_s": violation.first.seconds,
        "end_s": violation.last.seconds,
        "trigger": _moment(violation.trigger) if violation.trigger else None,
        "deadline": _moment(violation.deadline) if violation.deadline else None,
        "missing": violation.missing,
        "values": dict(violation.values),
        "window": _window(violation.window) if violation.window else None,
    }


def _window(window: Window) -> dict[str, Any]:
    return {
        "start_ns": window.start_ns,
        "end_ns": window.end_ns,
        "samples": {name: _samples(samples) for name, samples in window.samples.items()},
    }


def _samples(samples: Samples) -> dict[str, Any]:
    values = [_reading(value) for value in samples.base.tolist()]
    return {"times_ns": samples.times.tolist(), "values": values}
