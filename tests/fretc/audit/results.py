"""Results of audits, of which a test names only what it is about."""

from collections.abc import Callable, Mapping
from math import isinf
from types import MappingProxyType
from typing import Any

from compiler.files.records import decoded, plain, replace
from fretc.audit.evidence.probabilities import Outcomes
from fretc.audit.evidence.samples import RunPart, Surroundings
from fretc.audit.evidence.schema import (
    Answer,
    Hashes,
    Health,
    Result,
    StateChangeRecord,
    ThresholdRecord,
    Violation,
)
from fretc.audit.evidence.writer import unjudged_result
from fretc.audit.measurements.intervals import Moment
from fretc.audit.measurements.tallies import PropositionTally

SHA = "0" * 64
HEALTH = Health(True, 1000, None, (), (), {})
HASHES = {"sentence": SHA, "bindings": SHA, "monitor": SHA}
BLANK = unjudged_result("a.mcap", "R1", "why", HASHES, HEALTH)
BROKEN: dict[str, Any] = {
    "first_tick": 0,
    "last_tick": 0,
    "start_ns": 0,
    "end_ns": 0,
    "start_s": 0.0,
    "end_s": 0.0,
    "trigger": None,
    "deadline": None,
    "missing": "",
    "values": {},
    "window": None,
}
BOUND = {
    "proposition": "",
    "signal": "",
    "operator": "<",
    "bound": 0.0,
    "unit": "",
    "least": None,
    "greatest": None,
    "comparison": None,
    "margin": None,
    "nearest": None,
}


def result(**fields: Any) -> Result:
    """A result by the keys of its JSON object; texts and hashes may be any."""
    forms: dict[str, Callable[[Any], Any]] = {
        "states": lambda each: decoded(each, tuple[StateChangeRecord, ...]),
        "answers": lambda each: decoded(each, tuple[Answer, ...]),
        "triggers": lambda each: decoded(each, tuple[Moment, ...]),
        "open": lambda each: decoded(each, tuple[Moment, ...]),
        "violations": lambda each: decoded([BROKEN | one for one in each], tuple[Violation, ...]),
        "thresholds": lambda each: decoded(
            [BOUND | one for one in each], tuple[ThresholdRecord, ...]
        ),
        "propositions": lambda each: decoded(each, dict[str, PropositionTally]),
        "hashes": lambda each: Hashes(**HASHES | each),
        "health": lambda each: decoded(plain(HEALTH) | each, Health),
        "trials": lambda each: decoded(each, Outcomes),
    }
    names = {"hashes": "fingerprints", "trials": "outcomes", "latencies_s": "latencies"}
    fields = {names.get(k, k): forms[k](v) if k in forms else v for k, v in fields.items()}
    return replace(BLANK, **fields)


def moment(tick: int, seconds: float) -> Moment:
    """A tick of a run that begins at 0."""
    return Moment(tick, round(seconds * 10**9), seconds)


def violation(
    first: Moment,
    last: Moment,
    trigger: Moment | None = None,
    deadline: Moment | None = None,
    missing: str = "stopped",
    values: Mapping[str, float | None] = MappingProxyType({}),
    window: RunPart | None = None,
) -> Violation:
    """A violation in a run that begins at 0."""
    return Violation(
        first_tick=first.tick,
        last_tick=last.tick,
        start_ns=first.ns,
        end_ns=last.ns,
        start_s=first.seconds,
        end_s=last.seconds,
        trigger=trigger,
        deadline=deadline,
        missing=missing,
        values=dict(values),
        surroundings=None if window is None else _surroundings(window),
    )


def _surroundings(window: RunPart) -> Surroundings:
    def ns(seconds: float) -> int:
        return round(seconds * 10**9)

    def reading(value: float | None) -> float | str | None:
        return f"{value:+}" if value is not None and isinf(value) else value

    samples = {
        name: {"times_ns": list(map(ns, each.times)), "values": list(map(reading, each.values))}
        for name, each in window.samples.items()
    }
    record = {"start_ns": ns(window.start), "end_ns": ns(window.end), "samples": samples}
    return decoded(record, Surroundings)
