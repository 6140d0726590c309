"""What one audit of one run against one requirement has shown, as plain values.

The JSON form is versioned; its schema is `templates/json/evidence.schema.json`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from fretish.diagnostic import Diagnostic
from fretish.rendering import as_json
from monitors.kernel import NO_DATA, Outcome
from monitors.samples import Recording

SCHEMA = "fretc-evidence-1"


@dataclass(frozen=True, slots=True)
class Moment:
    """A tick with its time; `ns` is the log's clock, `seconds` counts from the first tick."""

    tick: int
    ns: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Violation:
    """A stretch of ticks at which a demand was broken, with what the signals said."""

    first: Moment
    last: Moment
    trigger: Moment | None
    """The last trigger at or before it; None where it needs none."""
    values: Mapping[str, float | None]
    """Each signal of the sentence at the first tick, in base units; None: unknown."""


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
    clock: str
    answers: tuple[tuple[Moment, Moment], ...]
    """Trigger and answer, where a demand waits for one and it came."""
    states: tuple[tuple[Moment, str], ...]
    """When the state changed, and to what (`monitors.states`)."""
    triggers: tuple[Moment, ...]
    violations: tuple[Violation, ...]
    open: tuple[Moment, ...]
    """Triggers whose demand is open at the end of the log."""
    latencies: tuple[float, ...]
    """Seconds from each trigger to its answer, in the order of the triggers."""
    units: Mapping[str, str]
    """The base unit of each signal."""
    hashes: Mapping[str, str]
    """SHA-256 of the log, the sentence, the bindings and the monitor."""
    health: Mapping[str, Any]
    assumptions: tuple[str, ...]


def health(recording: Recording) -> dict[str, Any]:
    """Whether the data of the run can be trusted, and why not."""
    return {
        "intact": recording.intact,
        "size": recording.size,
        "gaps": [{"start_ns": start, "end_ns": end} for start, end in recording.gaps],
        "findings": [as_json(finding) for finding in recording.findings],
        "topics": {
            name: {
                "type": topic.type,
                "count": topic.count,
                "first_ns": topic.first_ns,
                "last_ns": topic.last_ns,
                "longest_gap_ns": topic.longest_gap_ns,
                "out_of_order": topic.out_of_order,
            }
            for name, topic in sorted(recording.topics.items())
        },
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
        "latencies_s": list(evidence.latencies),
        "units": dict(evidence.units),
        "hashes": dict(evidence.hashes),
        "health": dict(evidence.health),
        "assumptions": list(evidence.assumptions),
    }


def unread(
    run: str, requirement: str, diagnostic: Diagnostic, hashes: Mapping[str, str]
) -> dict[str, Any]:
    """The JSON object of a run whose log could not be read: nothing is shown."""
    return {
        "run": run,
        "requirement": requirement,
        "verdict": NO_DATA,
        "finite": None,
        "reason": diagnostic.message,
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
        "latencies_s": [],
        "units": {},
        "hashes": dict(hashes),
        "health": {
            "intact": False,
            "size": None,
            "gaps": [],
            "findings": [as_json(diagnostic)],
            "topics": {},
        },
        "assumptions": [],
    }


def _moment(moment: Moment) -> dict[str, Any]:
    return {"tick": moment.tick, "ns": moment.ns, "seconds": moment.seconds}


def _violation(violation: Violation) -> dict[str, Any]:
    return {
        "first_tick": violation.first.tick,
        "last_tick": violation.last.tick,
        "start_ns": violation.first.ns,
        "end_ns": violation.last.ns,
        "start_s": violation.first.seconds,
        "end_s": violation.last.seconds,
        "trigger": _moment(violation.trigger) if violation.trigger else None,
        "values": dict(violation.values),
    }
