"""Evidence of nights, of which a test names only what it is about."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from compiler.files.records import UNSET
from fretc.audit.evidence.schema import (
    SCHEMA,
    BindingsRecord,
    EvidenceDocument,
    RequirementRecord,
    Result,
    Selection,
)
from fretc.audit.evidence.writer import text
from tests.fretc.audit.results import SHA, result

DAY = 86_400 * 10**9
FIRST = 20_400 * DAY
"""2025-11-08."""


def judged(
    run: str,
    verdict: str = "satisfied",
    requirement: str = "R1",
    *,
    night: int = 0,
    late: Sequence[float] = (),
    margin: float | None = None,
    sentence: str = SHA,
    log: int | None = None,
    **labels: str,
) -> Result:
    """What the audit of a run says; runs of one name and night have one log, if none is given."""
    start = FIRST + night * DAY
    thresholds = [
        {
            "proposition": "too_close",
            "signal": "clearance",
            "bound": 0.05,
            "unit": "m",
            "comparison": "crossed" if margin == 0 else "false",
            "margin": margin or None,
        }
    ]
    fields: dict[str, Any] = {
        "run": run,
        "requirement": requirement,
        "verdict": verdict,
        "start_ns": start,
        "end_ns": start + 10**9,
        "latencies_s": tuple(late),
        "latency_max_s": max(late, default=None),
        "latency_median_s": sorted(late)[len(late) // 2] if late else None,
        "thresholds": thresholds if margin is not None else [],
        "hashes": {
            "log": f"{hash_of(run, night) if log is None else log:064x}",
            "sentence": sentence,
        },
    }
    return result(**fields, labels=labels or UNSET)


def hash_of(run: str, night: int) -> int:
    return int.from_bytes(f"{night}{run}"[:30].encode(), "big")


def document(results: Iterable[Result], selection: Selection | None = None) -> EvidenceDocument:
    found = tuple(results)
    ids = dict.fromkeys(each.requirement for each in found)
    requirements = tuple(RequirementRecord(id, f"the robot shall satisfy {id}", SHA) for id in ids)
    bindings = BindingsRecord("bindings.toml", SHA)
    return EvidenceDocument(
        SCHEMA, "0", bindings, requirements, found, selection=selection or UNSET
    )


def sample(audited: int, of: int, since: str | None = None, older: int = 0) -> Selection:
    """What evidence says of a choice of logs."""
    seed = None if audited == of else 0
    return Selection(of + older, since, older, None if seed is None else of, seed, audited)


def evidence(path: Path, *results: Result, selection: Selection | None = None) -> str:
    """A file of evidence: the results of a run stand together."""
    runs = dict.fromkeys(each.run for each in results)
    ordered = [each for run in runs for each in results if each.run == run]
    path.write_text(text(document(ordered, selection)), encoding="utf-8")
    return str(path)
