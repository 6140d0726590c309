"""From the reports of an agent in a log to the cause of a violation, in every output."""

import json
from pathlib import Path
from typing import Any

import pytest

from compiler.files.records import plain
from fretc.audit.evidence.reader import EvidenceFile, read
from fretc.audit.evidence.schema import Result
from fretc.audit.many_logs import audit_log
from fretc.audit.store.recordings import SampleCache
from tests.command import Fretc, Run
from tests.command import write as put
from tests.fretc.audit.test_results_taken_over import plan
from tests.fretc.logs.logs import MS, S, Sent, payload, write

NUMBER, STRING = "std_msgs/msg/Float64", "std_msgs/msg/String"
BINDINGS = """
[clock]
tick = "100 ms"
[signal.d]
path = "/d.data"
unit = "m"
[signal.v]
path = "/v.data"
unit = "m/s"
[proposition.TooClose]
expr = "d < 1 m"
[proposition.stopped]
expr = "v = 0 m/s"
"""
AGENT = '[agent]\ntrace = "/agent/trace"\n'
SENTENCE = "whenever TooClose the sw shall within 3 ticks satisfy stopped\n"
START = 1000 * S
ABSENT = (
    "`sw` did not believe `v_TooClose`, which was true from 1 s; its last report is of 0.9 s; "
    "its last action was `go`, at 0.2 s"
)
WRONG = "`sw` believed `stopped` from 1.1 s, and it was false; its last action was `halt`, at 1.1 s"
LATE = (
    "`sw` believed `v_TooClose` only from 1.28 s, 280 ms after it became true; its last action was "
    "`halt`, at 1.28 s"
)
SEEN = "`sw` believed `v_TooClose` from 1 s; its last action was `halt`, at 1.1 s"
REPORTS: dict[str, tuple[list[tuple[int, list[str], str | None]], tuple[str, ...]]] = {
    "absent": (
        [(0, [], None), (200, [], "go"), (900, [], None), (1800, ["v_TooClose"], None)],
        (ABSENT,),
    ),
    "late": ([(0, [], None), (1280, ["v_TooClose"], "halt")], (LATE,)),
    "wrong": (
        [(0, [], None), (1000, ["v_TooClose"], None), (1100, ["v_TooClose", "stopped"], "halt")],
        (SEEN, WRONG),
    ),
}


def log(name: str) -> Path:
    """The robot is near from 1 s on and drives; two seconds."""
    sent = []
    for tick in range(20):
        time = START + tick * 100 * MS
        near = payload(NUMBER, data=0.5 if tick >= 10 else 2.0)
        sent += [
            Sent("/d", NUMBER, near, time),
            Sent("/v", NUMBER, payload(NUMBER, data=1.0), time),
        ]
    for milliseconds, beliefs, action in REPORTS[name][0]:
        about = {"time": 1, "agent": "sw", "beliefs": beliefs, "goals": [], "action": action}
        data = payload(STRING, data=json.dumps(about))
        sent.append(Sent("/agent/trace", STRING, data, START + milliseconds * MS))
    return write(Path("log.mcap"), sorted(sent, key=lambda message: message.time))


def audited(fretc: Fretc, name: str, bindings: str = BINDINGS + AGENT) -> tuple[Result, Run]:
    put("requirements/r1.fret", SENTENCE)
    put("requirements/bindings.toml", bindings)
    log(name)
    run = fretc("audit", "log.mcap", "-v", "-o", "e.json")
    evidence = read("e.json")
    assert isinstance(evidence, EvidenceFile), evidence
    (result,) = evidence.results
    return result, run


@pytest.mark.slow
@pytest.mark.parametrize("name", REPORTS)
def test_a_violation_goes_back_to_a_belief(fretc: Fretc, name: str) -> None:
    result, run = audited(fretc, name)
    believed = REPORTS[name][1]
    assert run.status == 1
    (violation,) = result.violations
    assert tuple(each.in_words() for each in violation.beliefs or ()) == believed
    for text in believed:
        assert text in run.out
        for form in ("junit", "sarif", "github"):
            assert text in fretc("audit", "log.mcap", "--format", form).out
    assert fretc("report", "--evidence", "e.json", "--html", "r.html").status == 0
    page = Path("r.html").read_text().replace("<code>", "`").replace("</code>", "`")
    for text in believed:
        assert text in page
    assert page.count('data-signal="belief of sw"') == 1
    assert page.count('data-signal="last action of sw"') == 1
    assert fretc("verify-evidence", "e.json").status == 0


def test_the_trace_changes_nothing_else_of_the_evidence(fretc: Fretc) -> None:
    (before, _), (after, _) = (
        audited(fretc, "late", text) for text in (BINDINGS, BINDINGS + AGENT)
    )
    assert after.course
    assert after.course.words["belief of sw"].words == ("nothing", "v_TooClose")
    assert after.course.words["last action of sw"].times_ns == (START, START + 1280 * MS)
    assert without_agent(after) == without_agent(before)


def without_agent(result: Result) -> Any:
    """The result as plain values, without what is of the agent or its topic."""
    (violation,) = result.violations
    assert violation.surroundings is not None
    values: dict[str, Any] = plain(result)
    values["violations"][0].pop("beliefs", None)
    values["violations"][0]["window"].pop("words", None)
    values.pop("course", None)
    values["health"]["topics"].pop("/agent/trace")
    return values


def test_kept_samples_have_the_trace(fretc: Fretc, tmp_path: Path) -> None:
    path = str(log("wrong"))
    made = plan({"bindings": BINDINGS + AGENT, "R1": SENTENCE})
    cache = SampleCache(tmp_path / "columns", b"k" * 32)
    first = audit_log(made, path, kept=cache)
    again = audit_log(made, path, kept=cache)
    assert (first.known_by, again.known_by) != ("read", "read")
    assert again == first
    assert first.results[0].violations[0].beliefs
