"""Whatever an audit may have found, there is a report, and it never says more or less than that."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
import yaml
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from compiler.project.project import Project
from fretc.audit.evidence.verdicts import VERDICTS
from fretc.commands.report import _status
from fretc.report.forms.csv_rows import csv_text
from fretc.report.forms.gsn import gsn
from fretc.report.forms.junit import junit
from fretc.report.forms.markdown import markdown
from fretc.report.forms.sarif import sarif
from fretc.report.make import ReportBuild
from tests.effort import FULL
from tests.fretc.report import junit_schema
from tests.fretc.report.cases import (
    R1,
    as_html,
    as_json,
    moment,
    project,
    report_of,
    requirement,
    result,
)
from tests.json_schemas import validate

pytestmark = pytest.mark.filterwarnings("ignore:Generating overly large repr")

IDS = ("R1", "R2")
PAIRS = [(run, id) for run in ("a.mcap", "b.mcap") for id in IDS]
WORDS = ("violated", "no data", "inconclusive", "vacuous", "satisfied")
CHANGED = {"bindings": {"bindings": "0" * 64}, "sentence": {"sentence": "0" * 64}, "": {}}

_BRIEFLY = settings(
    deadline=None,
    max_examples=200 if FULL else 8,
    phases=(Phase.generate,),
    suppress_health_check=[HealthCheck.too_slow],
)

# Everything that JSON can hold: the least, the greatest, nothing, and what rounds to nothing.
_SIGNALS = ("clearance", "vx", "gone")
_EXTREME = [0.0, -0.0, 5e-324, -5e-324, 1.7976931348623157e308, -1.7976931348623157e308]
bounds = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from([*_EXTREME, 0.05, 0.050000001, 0.01, 3.0]),
)
finite = st.none() | bounds
numbers = finite | st.sampled_from(["+inf", "-inf"])
ticks = st.integers(0, 120)


@st.composite
def samples(draw: st.DrawFn) -> dict[str, Any]:
    """Of none, one, or many times, before, in, and after the window; several at one time."""
    pairs = st.tuples(st.integers(-(10**9), 14 * 10**9), numbers)
    several = draw(st.just([]) | st.lists(pairs, max_size=3))
    times, values = [time for time, _ in several], [value for _, value in several]
    often = draw(st.sampled_from([1, 1, 16]))
    return {"times_ns": sorted(times * often), "values": values * often}


@st.composite
def windows(draw: st.DrawFn) -> dict[str, Any]:
    start, end = sorted(draw(st.tuples(*[st.integers(-(10**9), 14 * 10**9)] * 2)))
    named = {name: draw(samples()) for name in draw(st.sampled_from([("vx",), _SIGNALS]))}
    return {"start_ns": start, "end_ns": end, "samples": named}


@st.composite
def violations(draw: st.DrawFn) -> dict[str, Any]:
    first, last = sorted(draw(st.tuples(ticks, ticks)))
    return {
        "first_tick": first,
        "last_tick": last,
        "start_ns": 10**9 + first * 10**8,
        "end_ns": 10**9 + last * 10**8,
        "start_s": first / 10,
        "end_s": last / 10,
        "trigger": draw(st.none() | ticks.map(moment)),
        "deadline": draw(st.none() | ticks.map(moment)),
        "missing": draw(st.sampled_from(["", "stopped"])),
        "values": draw(st.dictionaries(st.sampled_from(["clearance", "vx", "gone"]), finite)),
        "window": draw(windows() | st.none()),
    }


@st.composite
def thresholds(draw: st.DrawFn) -> dict[str, Any]:
    return {
        "proposition": draw(st.sampled_from(["near", "stopped"])),
        "signal": draw(st.sampled_from(["clearance", "abs(vx)", "vx", "gone"])),
        "operator": draw(st.sampled_from(["<", "<=", ">", ">="])),
        "bound": draw(bounds),
        "unit": draw(st.sampled_from(["m", "m/s", ""])),
        "least": draw(numbers),
        "greatest": draw(numbers),
        "comparison": draw(st.sampled_from([None, "true", "false", "crossed"])),
        "margin": draw(finite.map(lambda value: value and abs(value))),
        "nearest": draw(st.none() | st.just({"ns": 10**9, "seconds": -0.1})),
    }


@st.composite
def audits(draw: st.DrawFn) -> list[dict[str, Any]]:
    """Some runs of some requirements, each result current or of something else."""
    chosen = draw(st.lists(st.booleans(), min_size=len(PAIRS), max_size=len(PAIRS)))
    return [
        {"run": run, "id": id, **draw(outcomes())}
        for (run, id), is_there in zip(PAIRS, chosen, strict=True)
        if is_there
    ]


@st.composite
def courses(draw: st.DrawFn) -> dict[str, Any]:
    """A way of any form, and words at any times."""
    ns = st.integers(-(2**62), 2**62) | st.integers(0, 12 * 10**9)
    metres = st.floats(-1e9, 1e9) | st.sampled_from([0.0, 5e-324, 1e9, -1e9])
    points = draw(st.lists(st.tuples(metres, metres), max_size=5))
    size = len(points)
    starts = sorted(draw(st.sets(st.integers(0, size - 1)))) if size else []
    way = {
        "times_ns": sorted(draw(st.lists(ns, min_size=size, max_size=size))),
        "x": [x for x, _ in points],
        "y": [y for _, y in points],
        "starts": starts,
        "error": draw(st.floats(0, 1e9)),
        "lines_left_out": draw(st.integers(0, 2)),
    }
    words = draw(st.lists(st.none() | st.just("drive"), max_size=3))
    times = sorted(draw(st.lists(ns, min_size=len(words), max_size=len(words))))
    mode = {"times_ns": times, "words": words, "changes_left_out": draw(st.integers(0, 1))}
    return {"way": draw(st.just(way) | st.none()), "words": {"mode": mode}}


@st.composite
def outcomes(draw: st.DrawFn) -> dict[str, Any]:
    verdict = draw(st.sampled_from([*WORDS, "violated", "violated"]))
    is_red = verdict == "violated"
    size = draw(st.sampled_from([100, 1, 0]))
    return {
        "verdict": verdict,
        "violations": draw(st.lists(violations(), min_size=int(is_red), max_size=3 * is_red)),
        "ticks": size,
        "start_ns": draw(st.sampled_from([None, 10**9])),
        "triggers": draw(st.lists(ticks.map(moment), max_size=3)),
        "open": draw(st.lists(ticks.map(moment), max_size=3)),
        "latencies_s": draw(st.lists(st.floats(0, 1e9), max_size=3)),
        "unknown": draw(st.lists(st.tuples(ticks, ticks).map(sorted), max_size=2)),
        "thresholds": draw(st.lists(thresholds(), max_size=3)),
        "hashes": draw(st.sampled_from([*CHANGED.values()])),
        "health": {"intact": draw(st.booleans())},
        **draw(st.fixed_dictionaries({}, optional={"course": courses()})),
    }


TEXTS = (R1, requirement("R2", "whenever near the robot shall within 3 ticks satisfy stopped"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("any")


@pytest.fixture(scope="module")
def known(folder: Path) -> Project:
    return project(folder, *TEXTS)


@pytest.mark.slow
@given(drawn=audits())
@_BRIEFLY
def test_any_evidence_gives_a_report_that_fits_its_schema(
    drawn: list[dict[str, Any]], known: Project, folder: Path
) -> None:
    report = report_of(known, folder, *(result(known, **each) for each in drawn))
    validate("report.schema.json", as_json(report))
    as_html(report)


# One model ---------------------------------------------------------------------------------------


def expected(results: Sequence[Mapping[str, Any]], known: Project, id: str) -> tuple[str, bool]:
    """Verdict and currency of a requirement, written down from what they mean.

    Violated if any run violates it, and that is current if any such run is. Else the worst of the
    runs, which is current only if all of them are.
    """
    mine = [(r["verdict"], is_suspect(r, known)) for r in results if r["requirement"] == id]
    red = [suspect for verdict, suspect in mine if verdict == "violated"]
    if red:
        return "violated", all(red)
    word = min((verdict for verdict, _ in mine), key=WORDS.index, default="not exercised")
    return word, any(suspect for _, suspect in mine)


def is_suspect(one: Mapping[str, Any], known: Project) -> bool:
    """Whether something else was audited, or a damaged log is said to show that it held."""
    now = result(known, "satisfied", one["requirement"])["hashes"]
    changed = any(one["hashes"][name] != now[name] for name in ("sentence", "bindings"))
    damaged = not one["health"]["intact"] and one["verdict"] in ("satisfied", "vacuous")
    return changed or damaged


def forms(build: ReportBuild, results: Sequence[dict[str, Any]], known: Project) -> dict[str, Any]:
    assert build.report is not None, build.diagnostics[0].message
    assert build.details is not None
    whole = build.report
    log = json.loads(sarif(whole, build.details, known.formalized, []))["runs"][0]["results"]
    return {
        "marks": {v.id: (v.mark.word, v.mark.suspect) for v in whole.requirements},
        "status": _status(whole),
        "junit": outcomes_of(junit(whole), whole.project),
        "sarif": [(one["ruleId"], one["level"]) for one in log],
        "csv": list(csv.DictReader(io.StringIO(csv_text(whole)))),
        "markdown": markdown(whole, build.details),
        "gsn": yaml.safe_load(gsn(whole)),
    }


def outcomes_of(xml: str, project: str) -> dict[tuple[str, str], str]:
    """The element of each case by run and requirement; by an empty run what no run says."""
    root = ElementTree.fromstring(xml)
    assert list(junit_schema.complaints(root)) == []
    cases = {}
    for suite in root:
        run = "" if suite.attrib["name"] == project else suite.attrib["name"]
        for case in suite:
            key = (run, case.attrib["name"].split("(")[-1][:-1])
            assert key not in cases
            cases[key] = next((outcome.tag for outcome in case), "")
    return cases


ELEMENTS = {"violated": "failure", "no data": "error", "satisfied": ""}
"""Of verdicts; all others are skipped."""


def outcome(verdict: str, *, suspect: bool) -> str:
    kind = ELEMENTS.get(verdict, "skipped")
    return "failure" if suspect and kind in ("", "skipped") else kind


@pytest.mark.slow
@given(drawn=audits())
@_BRIEFLY
def test_each_requirement_and_run_is_one_test_case_and_no_red_is_lost(
    drawn: list[dict[str, Any]], known: Project, folder: Path
) -> None:
    results = [result(known, **each) for each in drawn]
    content = forms(report_of(known, folder, *results), results, known)
    cases = content["junit"]
    of_runs = {
        (one["run"], one["requirement"]): outcome(one["verdict"], suspect=is_suspect(one, known))
        for one in results
    }
    assert {key: kind for key, kind in cases.items() if key[0]} == of_runs
    for id in IDS:
        word, suspect = expected(results, known, id)
        assert outcome(word, suspect=suspect) in [
            kind for (_, other), kind in cases.items() if other == id
        ]
    kinds = set(cases.values())
    assert "failure" not in kinds or content["status"] == 1
    assert content["status"] != 1 or kinds & {"failure", "error"}


@pytest.mark.slow
@given(drawn=audits())
@_BRIEFLY
def test_all_forms_follow_one_model_of_verdict_and_currency(
    drawn: list[dict[str, Any]], known: Project, folder: Path
) -> None:
    results = [result(known, **each) for each in drawn]
    build = report_of(known, folder, *results)
    content = forms(build, results, known)
    right = {id: expected(results, known, id) for id in IDS}
    is_shown = {id: mark == ("satisfied", False) for id, mark in right.items()}
    red = [id for id, (word, _) in right.items() if word == "violated"]
    assert content["marks"] == right
    fails = any(word == "violated" or suspect for word, suspect in right.values())
    assert content["status"] == (1 if fails else 0 if all(is_shown.values()) else 3)
    first = content["markdown"].splitlines()[0]
    for id, (word, suspect) in right.items():
        if word == "violated":
            assert id in first
            assert f"({id}) is violated" not in first.replace("\\", "") or not suspect
        rows = [row for row in content["csv"] if row["requirement"] == id]
        currency = "suspect" if suspect else "current"
        assert {(row["verdict"], row["currency"]) for row in rows} == {(word, currency)}
        goal = content["gsn"][f"G_req_2d_{id}"]
        assert bool(goal.get("undeveloped")) is not is_shown[id]
    assert ("violated" in first) is bool(red)
    levels = {
        (r["requirement"], "error" if r["verdict"] == "violated" else level(r, known))
        for r in results
    }
    assert set(content["sarif"]) == {(id, level) for id, level in levels if level != "none"}


def level(one: Mapping[str, Any], known: Project) -> str:
    """Of a result that violates nothing: nothing to tell only where it shows its requirement."""
    return "none" if one["verdict"] == "satisfied" and not is_suspect(one, known) else "warning"


@pytest.mark.slow
@given(drawn=audits())
@_BRIEFLY
def test_reasons_come_by_severity_everywhere(
    drawn: list[dict[str, Any]], known: Project, folder: Path
) -> None:
    results = [result(known, **each) for each in drawn]
    build = report_of(known, folder, *results)
    report = build.report
    assert report is not None, build.diagnostics[0].message
    ranks = list(VERDICTS)
    for view in report.requirements:
        words = [
            reason.split(": ", 1)[1].split(",")[0] for reason in view.reasons if "Run" in reason
        ]
        if not any(r.mark.suspect for r in view.results):
            assert [ranks.index(word) for word in words] == sorted(map(ranks.index, words))
        if view.mark.word == "violated":
            assert "violated" in view.reasons[0]
            content = forms(build, results, known)
            assert _entry(content["markdown"], view.id).startswith("- ✘ violated")
    order = [ranks.index(each.mark.word) for each in report.not_shown if not each.mark.suspect]
    assert order == sorted(order)


def _entry(text: str, id: str) -> str:
    (line,) = [line for line in text.splitlines() if line.startswith("- ") and f"{id}\\)**" in line]
    return line
