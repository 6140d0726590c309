"""What many runs say as a whole, and questions to them, through the command."""

import json
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import pytest

from fretc.audit.outputs.table import parquet, row_of
from tests.command import Fretc, Run
from tests.effort import FULL
from tests.fretc.audit.results import result as record
from tests.fretc.report.cases import evidence, project, requirement, result, violation

R2 = requirement("R2", "whenever near the robot shall within 3 ticks satisfy stopped")


def table(results: list[dict[str, Any]], fretc: str) -> bytes:
    return parquet(row_of(record(**one), fretc) for one in results)


@pytest.fixture
def results(fretc: Fretc) -> list[dict[str, Any]]:
    """Three runs and two requirements, in a folder of their own."""
    made, files = audited()
    for name, content in files.items():
        Path(name).write_bytes(content)
    return made


@cache
def audited() -> tuple[list[dict[str, Any]], dict[str, bytes]]:
    """The results, and the files of them."""
    own_project = project(
        Path("known"), requirement("R1", "the robot shall always satisfy near"), R2
    )
    written_results = [
        result(own_project, "satisfied", run="a.mcap", latencies_s=[0.5]),
        result(own_project, "vacuous", "R2", run="a.mcap", reason="never triggered"),
        result(own_project, "satisfied", run="b.mcap", latencies_s=[0.2, 2.25, 0.3]),
        result(own_project, "satisfied", "R2", run="b.mcap", latencies_s=[]),
        result(
            own_project, "violated", run="c.mcap", reason="broken", violations=[violation(1, 2)] * 2
        ),
        result(own_project, "no data", "R2", run="c.mcap", health={"intact": False}),
    ]  # fmt: skip
    for number, one in enumerate(written_results):
        one["hashes"] = one["hashes"] | {"log": f"{number // 2:064x}"}
        one |= {"start_ns": 0, "end_ns": 3600 * 10**9}
        one["latencies_s"] = one["latencies_s"] if number in (0, 2) else []
    document = evidence(own_project, *written_results) | {"fretc": "1"}
    return written_results, {
        "runs.parquet": table(written_results, "1"),
        "evidence.json": json.dumps(document).encode(),
    }


SUMMARY = """\
3 runs, 2 requirements, 3.0 h, 1 damaged run

  requirement  runs  ✔ satisfied  ✘ violated  ◔ inconclusive  ∅ vacuous  ? no data  violations
  R1              3            2           1               0          0          0           2
  R2              3            1           0               0          1          1           0

worst runs
  run     violated  not shown  violations  why
  c.mcap         1          1           2  broken
  a.mcap         0          1           0  never triggered

slowest answers
  requirement  longest  median  run
  R1            2.25 s  0.30 s  b.mcap
  R1            0.50 s  0.50 s  a.mcap
"""


@pytest.mark.slow
def test_a_summary_counts_verdicts_and_names_the_worst(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    assert fretc("audit", "--summary", "runs.parquet") == Run(1, SUMMARY, "")


@pytest.mark.slow
def test_evidence_is_summarized_as_its_table_and_a_row_counts_once(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    assert fretc("audit", "--summary", "evidence.json").out == SUMMARY
    assert fretc("audit", "--summary", "evidence.json", "runs.parquet").out == SUMMARY


def renamed(results: list[dict[str, Any]], **hashes: str) -> list[dict[str, Any]]:
    """The same logs under other names."""
    return [
        {**one, "run": f"copies/{one['run']}", "hashes": one["hashes"] | hashes} for one in results
    ]


@pytest.mark.slow
def test_a_log_counts_once_whatever_its_name_in_the_head_and_in_the_rows(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    Path("copies.parquet").write_bytes(table(renamed(results), "1"))
    for tables in (("runs.parquet", "copies.parquet"), ("copies.parquet", "evidence.json")):
        assert fretc("audit", "--summary", *tables) == Run(1, SUMMARY, "")


@pytest.mark.slow
def test_other_logs_under_the_same_names_count_as_others(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    others = [
        {**one, "hashes": one["hashes"] | {"log": f"{number // 2 + 100:064x}"}}
        for number, one in enumerate(results)
    ]
    Path("others.parquet").write_bytes(table(others, "1"))
    run = fretc("audit", "--summary", "runs.parquet", "others.parquet", "--format", "json")
    content = json.loads(run.out)
    assert (content["runs"], content["seconds"], content["damaged"]) == (6, 21600.0, 2)
    assert [row["runs"] for row in content["by_requirement"]] == [6, 6]
    assert (content["failed_runs"], [row["violated"] for row in content["by_requirement"]]) == (
        4,
        [2, 0],
    )


def test_a_log_that_was_not_hashed_is_told_by_its_summary_and_an_unread_one_by_its_name(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    hashes = {k: v for k, v in results[2]["hashes"].items() if k != "log"}
    one = {**results[2], "hashes": {**hashes, "log_summary": "1" * 64}}
    other = {**results[2], "hashes": {**hashes, "log_summary": "2" * 64}}
    unread = {**results[2], "hashes": hashes, "run": "unread.mcap"}
    copies = [{**one, "run": name} for name in ("x.mcap", "y.mcap")]
    Path("a.parquet").write_bytes(table([one, unread], "1"))
    Path("b.parquet").write_bytes(table([*copies, other, unread], "2"))
    run = fretc("audit", "--summary", "a.parquet", "b.parquet", "--format", "json")
    content = json.loads(run.out)
    assert content["runs"] == content["by_requirement"][0]["runs"] == 3


@pytest.mark.slow
def test_the_worst_of_several_verdicts_of_a_log_counts_and_that_is_said(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    order = ["violated", "no data", "inconclusive", "vacuous", "satisfied"]
    for verdict in order:
        Path(f"{verdict}.parquet").write_bytes(table([{**results[0], "verdict": verdict}], "1"))
    for worse, better in combinations(order, 2) if FULL else pairwise(order):
        tables = [f"{worse}.parquet", f"{better}.parquet"]
        for named in (tables, tables[::-1]):
            run = fretc("audit", "--summary", *named, "--format", "json")
            (row,) = json.loads(run.out)["by_requirement"]
            assert (row["runs"], row[worse.replace(" ", "_")]) == (1, 1)
            verdicts = " and ".join(sorted((worse, better)))
            assert run.err.startswith(
                f"F555 warning: R1 has several verdicts of the log of a.mcap: {verdicts}; the "
                "worst of each log counts\n"
            )


def test_a_summary_as_json(fretc: Fretc, results: list[dict[str, Any]]) -> None:
    content = json.loads(fretc("audit", "--summary", "runs.parquet", "--format", "json").out)
    assert content["by_requirement"][1] == {
        "requirement": "R2",
        "runs": 3,
        "satisfied": 1,
        "violated": 0,
        "assumption_broken": 0,
        "inconclusive": 0,
        "vacuous": 1,
        "no_data": 1,
        "triggers": sum(len(r["triggers"]) for r in results if r["requirement"] == "R2"),
        "violations": 0,
        "latency_max_s": None,
    }
    assert (content["schema"], content["runs"], content["seconds"]) == (
        "fretc-summary-1",
        3,
        10800.0,
    )
    assert [run["run"] for run in content["worst_runs"]] == ["c.mcap", "a.mcap"]
    assert content["failed_runs"] == 2


@pytest.mark.slow
def test_the_exit_status_is_that_of_the_audit(fretc: Fretc, results: list[dict[str, Any]]) -> None:
    for name, part, status in [("all", results[2:4], 0), ("part", results[:4], 3)]:
        Path(f"{name}.parquet").write_bytes(table(part, "1"))
        assert fretc("audit", "--summary", f"{name}.parquet").status == status


def test_only_the_worst_of_many_runs_are_listed(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    many = [
        {**results[4], "run": f"{n:02}.mcap", "hashes": results[4]["hashes"] | {"log": f"{n:064x}"}}
        for n in range(25)
    ]
    Path("many.parquet").write_bytes(table(many, "1"))
    run = fretc("audit", "--summary", "many.parquet")
    assert "worst runs (10 of 25)\n" in run.out
    assert "09.mcap" in run.out
    assert "10.mcap" not in run.out


def test_two_versions_of_a_requirement_are_not_counted_as_one_in_silence(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    other = {**results[0], "run": "d.mcap", "hashes": {**results[0]["hashes"], "bindings": "x"}}
    Path("two.parquet").write_bytes(table([*results, other], "1"))
    run = fretc("audit", "--summary", "two.parquet")
    assert run.err.startswith("F504 warning: R1 was audited as 2 different requirements: ")


def test_a_query_is_answered_for_a_person_and_for_a_program(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    query = "SELECT verdict, count(*) AS n FROM results GROUP BY verdict ORDER BY n DESC, verdict"
    assert fretc("audit", "runs.parquet", "--query", query) == Run(
        0,
        "  verdict    n\n  satisfied  3\n  no data    1\n  vacuous    1\n  violated   1\n",
        "",
    )
    run = fretc("audit", "runs.parquet", "--query", query, "--format", "json")
    assert json.loads(run.out)[0] == {"verdict": "satisfied", "n": 3}


def test_the_rows_of_a_table_are_in_the_order_of_runs_and_requirements(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    query = "SELECT run, requirement FROM results"
    run = fretc("audit", "runs.parquet", "--query", query, "--format", "json")
    rows = [(row["run"], row["requirement"]) for row in json.loads(run.out)]
    assert rows == sorted(rows)
    assert len(rows) == 6


def test_what_json_has_no_word_for_is_null_or_text(
    fretc: Fretc, results: list[dict[str, Any]]
) -> None:
    query = "SELECT 9e999 AS a, -9e999 AS b, date('2026-01-02') AS c, x'00ff' AS d"
    run = fretc("audit", "runs.parquet", "--query", query, "--format", "json")
    assert json.loads(run.out) == [{"a": None, "b": None, "c": "2026-01-02", "d": "b'\\x00\\xff'"}]


@pytest.mark.slow
@pytest.mark.parametrize(
    "query",
    [
        "",
        "SELEC 1",
        "SELECT nothing FROM results",
        "-- nothing",
        "SELECT * FROM 'evidence.json'",
        "SELECT 1; SELECT 2",
        "ATTACH 'x.db' AS x",
        "VACUUM INTO 'x.db'",
        "PRAGMA journal_mode=WAL",
        "SELECT load_extension('x')",
        "CREATE TABLE more (x)",
        "INSERT INTO results SELECT * FROM results",
        "DELETE FROM results",
        "SELECT '\ud800'",
        "SELECT 1\0",
        "SELECT zeroblob(1 << 40)",
    ],
)
def test_a_query_that_cannot_be_answered_is_told_and_touches_no_file(
    fretc: Fretc, results: list[dict[str, Any]], query: str
) -> None:
    before = sorted(Path().rglob("*"))
    run = fretc("audit", "runs.parquet", "--query", query)
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith("F913 the query fails: ")
    assert sorted(Path().rglob("*")) == before


def test_a_summary_has_two_forms(fretc: Fretc, results: list[dict[str, Any]]) -> None:
    run = fretc("audit", "--summary", "runs.parquet", "--format", "junit")
    assert (run.status, run.err.splitlines()[0]) == (
        2,
        "F907 a summary has no output format `junit`",
    )


def test_a_run_cannot_write_to_the_terminal(fretc: Fretc, results: list[dict[str, Any]]) -> None:
    Path("odd.parquet").write_bytes(table([{**results[4], "run": "\x1b[2J\n.mcap"}], "1"))
    run = fretc("audit", "--summary", "odd.parquet")
    assert "\x1b" not in run.out
    assert run.out.count(".mcap") == 1


def test_a_query_without_an_end_is_stopped(
    fretc: Fretc, results: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fretc.audit.outputs.summary._MOST_SECONDS", 0)
    endless = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT sum(x) FROM n"
    run = fretc("audit", "runs.parquet", "--query", endless)
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith("F913 the query fails: interrupted\n")
