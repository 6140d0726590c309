"""Small projects and hand-made evidence about them."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from compiler.formalization.record import wording
from compiler.project.folder import load
from compiler.project.project import Project
from fretc.audit.evidence import reader as reading
from fretc.audit.evidence.result_summaries import ResultSummaries
from fretc.audit.evidence.verdict_inputs import BINDINGS as BINDINGS_PART
from fretc.audit.evidence.verdict_inputs import KINDS, of_all
from fretc.audit.project_inputs import all_verdict_inputs
from fretc.report.make import ReportBuild, make
from fretc.report.model.marks import verdict_mark
from fretc.report.model.results import ResultRow
from fretc.traceability.chain_builder import chains
from fretc.traceability.lock import Lock, accepted
from fretc.traceability.lock import text as lock_text
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.documents import RequirementEntry
from tests.command import write

BINDINGS = """\
[clock]
time = "log_time"
tick = "100 ms"
end = "inconclusive"

[signal.clearance]
path = "/scan.ranges[:]"
type = "sensor_msgs/LaserScan"
reduce = "min"
unit = "m"
max_age = "300 ms"

[signal.vx]
path = "/odom.twist.twist.linear.x"
type = "nav_msgs/Odometry"
unit = "m/s"
invalid = { nan = "unknown" }
max_age = "100 ms"

[proposition.near]
text = "an obstacle is near"
expr = "clearance < 5 cm"
role = "input"
kind = "belief"
agg = "any"

[proposition.stopped]
text = "the robot does not move"
expr = "abs(vx) < 0.01 m/s for 200 ms"
role = "output"
kind = "physical"
agg = "last"
"""

HAZARDS = """\
[HAZ-1]
title = "The robot hits something"
text = "A drum can break."
severity = "catastrophic"
source = "hazard analysis"
"""

R1 = """\
+++
id = "R1"
title = "Stop when something is near"
parents = ["HAZ-1"]
text = "The robot must stop."
rationale = "It would hit a drum."
status = "approved"
verify = ["audit"]
+++
whenever near the robot shall eventually satisfy stopped
"""

LOG = "ab" * 32


def requirement(id: str, sentence: str, **fields: object) -> str:
    """A `.fret` text with one requirement; fields as in its header."""
    header = {"id": id, "title": f"Title of {id}", "parents": ["HAZ-1"], "status": "approved"}
    lines = (f"{key} = {_toml(value)}" for key, value in {**header, **fields}.items())
    return "\n".join(["+++", *lines, "+++", sentence, ""])


def _toml(value: object) -> str:
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {json.dumps(v)}' for key, v in value.items())} }}"
    return json.dumps(value)


def project(
    folder: Path, *texts: str, bindings: str | None = BINDINGS, hazards: str | None = HAZARDS
) -> Project:
    """A project from the texts of its files; without texts, the requirement R1 alone."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for number, text in enumerate(texts or (R1,), 1):
        paths.append(folder / f"r{number}.fret")
        paths[-1].write_text(text, encoding="utf-8")
    for name, content in (("bindings.toml", bindings), ("hazards.toml", hazards)):
        if content is not None:
            (folder / name).write_text(content, encoding="utf-8")
    return load(
        [str(path) for path in paths],
        str(folder / "bindings.toml") if bindings is not None else None,
        str(folder / "hazards.toml") if hazards is not None else None,
    )


def moment(tick: int) -> dict[str, Any]:
    return {"tick": tick, "ns": 10**9 + tick * 10**8, "seconds": tick / 10}


def violation(first: int, last: int, trigger: int | None = None) -> dict[str, Any]:
    return {
        "first_tick": first,
        "last_tick": last,
        "start_ns": 10**9 + first * 10**8,
        "end_ns": 10**9 + last * 10**8,
        "start_s": first / 10,
        "end_s": last / 10,
        "trigger": None if trigger is None else moment(trigger),
        "deadline": None if trigger is None else moment(first),
        "missing": "stopped",
        "values": {"clearance": 0.0318, "vx": None},
        "window": WINDOW,
    }


WINDOW = {
    "start_ns": 10**9,
    "end_ns": 3 * 10**9,
    "samples": {"clearance": {"times_ns": [10**9, 2 * 10**9], "values": [0.0318, "+inf"]}},
}
THRESHOLDS = [
    {
        "proposition": "near",
        "signal": "clearance",
        "operator": "<",
        "bound": 0.05,
        "unit": "m",
        "least": 0.0318,
        "greatest": "+inf",
        "comparison": "crossed",
        "margin": None,
        "nearest": {"ns": 10**9, "seconds": 0.0},
    },
    {
        "proposition": "stopped",
        "signal": "abs(vx)",
        "operator": "<",
        "bound": 0.01,
        "unit": "m/s",
        "least": 0.0,
        "greatest": 0.0075,
        "comparison": "true",
        "margin": 0.0025,
        "nearest": {"ns": 9 * 10**8, "seconds": -0.1},
    },
]


def result(
    known: Project, verdict: str, id: str = "R1", run: str = "logs/a.mcap", **changes: Any
) -> dict[str, Any]:
    """What an audit of 100 ticks of 100 ms would write, with the present hashes.

    `changes` replace fields; those of `hashes` and `health` are put into the present ones.
    """
    assert known.declarations is not None
    hashes = {"log": LOG, **verdict_inputs(known, id)}
    health = {
        "intact": True,
        "size": 1234567,
        "checked": {
            "by_index": True,
            "chunks": 9,
            "crc_checked": 4,
            "crc_unchecked": 2,
            "without_crc": 0,
            "skipped": 3,
        },
        "gaps": [],
        "findings": [],
        "topics": {"/odom": {**ODOM}},
    }
    return {
        "run": run,
        "requirement": id,
        "verdict": verdict,
        "finite": None,
        "reason": f"reason of {id}",
        "clock": "100 ms, by log_time",
        "ticks": 100,
        "start_ns": 10**9,
        "end_ns": 11 * 10**9,
        "states": [],
        "answers": [],
        "triggers": [moment(tick) for tick in (10, 11, 40)],
        "violations": [],
        "unknown": [],
        "open": [],
        "latencies_s": [2.5, 2.4, 0.0],
        "exercised": 3,
        "latency_median_s": 2.4,
        "latency_max_s": 2.5,
        "propositions": {"near": {"true": 3, "false": 97, "unknown": 0, "changes": 4}},
        "thresholds": THRESHOLDS,
        "units": {"clearance": "m", "vx": "m/s"},
        "assumptions": [],
        **changes,
        "hashes": {**hashes, **changes.get("hashes", {})},
        "health": {**health, **changes.get("health", {})},
    }


def verdict_inputs(known: Project, name: str) -> Mapping[str, str]:
    """What an audit would record of a requirement now."""
    if not _latest or _latest[0] is not known:  # asked once as long as one project is in use
        _latest[:] = known, all_verdict_inputs(known)
    found: Mapping[RequirementEntry, Mapping[str, str]] = _latest[1]
    requirement = next((each for each in known.requirements if each.id == name), None)
    return found[requirement] if requirement is not None else dict.fromkeys(KINDS, "0" * 64)


_latest: list[Any] = []
"""The latest project, and its verdict inputs."""


ODOM = {
    "type": "nav_msgs/msg/Odometry",
    "count": 501,
    "first_ns": 10**9,
    "last_ns": 11 * 10**9,
    "longest_gap_ns": 40_000_000,
    "median_period_ns": 20_000_000,
    "out_of_order": 3,
    "equal_stamps": 0,
    "unstamped": 0,
    "zero_stamps": 0,
    "clock_jumps": 0,
}


SITUATIONS = [
    {"key": key, "words": f"{key} <b>it</b>"} for key in ("at-once", "late", "while-open")
]
"""Of a requirement, where a result says which of them its run came by."""


def evidence(known: Project, *results: Mapping[str, Any]) -> dict[str, Any]:
    """A whole evidence file."""
    bound = {
        requirement.id: verdict_inputs(known, requirement.id)[BINDINGS_PART]
        for requirement in known.formalized
    }
    measured = {each["requirement"] for each in results if "situations" in each}
    return {
        "schema": "fretc-evidence-1",
        "fretc": "0.1.0",
        "bindings": {"file": "bindings.toml", "sha256": of_all(bound)},
        "requirements": [
            {
                "id": requirement.id,
                "sentence": wording(requirement.entry),
                "sha256": requirement.fingerprint,
            }
            | ({"situations": SITUATIONS} if requirement.id in measured else {})
            for requirement in known.formalized
        ],
        "results": list(results),
    }


def report_of(known: Project, folder: Path, *results: Mapping[str, Any]) -> ReportBuild:
    """The report about these results."""
    return make(known, write_evidence(known, folder, *results))


def write_evidence(known: Project, folder: Path, *results: Mapping[str, Any]) -> str:
    """The path of a file of evidence in the folder."""
    return write(str(folder / "evidence.json"), json.dumps(evidence(known, *results)))


def write_lock(known: Project, folder: Path, evidence: str, day: str = "2026-01-01") -> str:
    """The path of a lock in the folder, in which everything is accepted as it is now."""
    audited = reading.read(evidence)
    assert not isinstance(audited, Diagnostic)
    accepting = chains(known, ResultSummaries.of(audited))
    reviews = {each.requirement: accepted(each, "A", "B", day, "c") for each in accepting}
    return write(str(folder / "fretc.lock"), lock_text(Lock(reviews)))


def as_json(report: ReportBuild) -> dict[str, Any]:
    """What the report says, as plain data."""
    text = report.json  # made whenever it is asked for
    assert text is not None
    content: dict[str, Any] = json.loads(text)
    return content


def content_of(known: Project, folder: Path, *results: Mapping[str, Any]) -> dict[str, Any]:
    """What the report about these results says, as plain data."""
    return as_json(report_of(known, folder, *results))


def as_html(report: ReportBuild) -> str:
    """Its page."""
    text = report.html  # made whenever it is asked for
    assert text is not None
    return text


def words(marks: Sequence[Mapping[str, Any]]) -> list[str]:
    """The verdicts of views that have one, each with its currency where it is suspect."""
    return [word(each["mark"]) for each in marks]


def word(mark: Mapping[str, Any]) -> str:
    """`violated`, or `violated, suspect`."""
    return f"{mark['word']}, suspect" if mark["suspect"] else str(mark["word"])


def row(number: int, word: str = "satisfied", requirement: str = "R1", **changes: Any) -> ResultRow:
    """The row of a result; its run and its place have the same number."""
    values: dict[str, Any] = {
        "anchor": f"{requirement}.{number}",
        "run": f"run-{number}",
        "run_label": f"Run {number}",
        "run_file": f"{number}.mcap",
        "mark": verdict_mark(word),
        "suspicions": (),
        "reason": "",
        "triggers": 1,
        "place": number,
        "number": 1,
        "requirement": requirement,
        "section": f"req-{requirement}",
        "ticks": 1,
        "answers": 0,
        "at_once": 0,
        "open": 0,
        "unknown": 0,
        "violations_total": int(word == "violated"),
        "latency_median_s": None,
        "latency_max_s": None,
    }
    return ResultRow(**{**values, **changes})
