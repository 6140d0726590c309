"""Runs as rows: what a table says of them, and what is taken for a table."""

import json
import sqlite3
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path
from typing import Any

import pyarrow
import pytest
from pyarrow import parquet as files

from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.reader import read as read_evidence
from fretc.audit.outputs.summary import run_query
from fretc.audit.outputs.table import parquet, read, row_of
from fretish.diagnostics.diagnostic import Diagnostic
from tests.fretc.audit.results import result as record
from tests.fretc.report.cases import LOG, evidence, moment, project, result, violation
from tests.stores import write_document


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def table(results: Iterable[dict[str, Any]], fretc: str) -> bytes:
    return parquet(row_of(record(**one), fretc) for one in results)


def read_rows(*paths: str) -> list[dict[str, Any]]:
    """The table of results in these files."""
    found = read(paths)
    assert not isinstance(found, Diagnostic), found.message
    with closing(found):
        found.row_factory = sqlite3.Row
        return [dict(row) for row in found.execute("SELECT * FROM results")]


def rows(*results: dict[str, Any]) -> list[dict[str, Any]]:
    """What is read of a table with these results."""
    Path("runs.parquet").write_bytes(table(results, "1.2.3"))
    return read_rows("runs.parquet")


def code(*paths: str) -> tuple[str, str]:
    diagnostic = read(paths)
    assert isinstance(diagnostic, Diagnostic)
    return diagnostic.code.number, diagnostic.message


def test_a_row_has_the_numbers_of_its_run() -> None:
    own_project = project(Path("known"))
    record = result(
        own_project,
        "violated",
        reason="broken",
        finite=False,
        triggers=[moment(3), moment(40)],
        violations=[violation(41, 44, 40), violation(60, 60)],
        unknown=[[0, 1], [70, 70]],
        open=[moment(99)],
        latencies_s=[0.4, 0.1, 0.2],
    )
    (row,) = rows(record)
    hashes = record["hashes"]
    assert row == {
        "run": "logs/a.mcap",
        "requirement": "R1",
        "verdict": "violated",
        "finite": False,
        "reason": "broken",
        "clock": record["clock"],
        "ticks": 100,
        "start_ns": record["start_ns"],
        "end_ns": record["end_ns"],
        "triggers": 2,
        "violations": 2,
        "violated_ticks": 5,
        "first_violation_ns": 5_100_000_000,
        "first_violation_s": 4.1,
        "unknown_ticks": 3,
        "open": 1,
        "answers": 3,
        "latency_median_s": 0.2,
        "latency_max_s": 0.4,
        "intact": True,
        "size": 1234567,
        "gaps": 0,
        "findings": 0,
        "log_sha256": LOG,
        "sentence_sha256": hashes["sentence"],
        "bindings_sha256": hashes["bindings"],
        "monitor_sha256": hashes["monitor"],
        "fretc": "1.2.3",
        "log_summary_sha256": None,
    }


def test_what_a_run_does_not_have_is_null() -> None:
    own_project = project(Path("known"))
    record = result(own_project, "no data", finite=None, start_ns=None, end_ns=None)
    del record["hashes"]["log"]
    (row,) = rows(record | {"health": record["health"] | {"size": None, "intact": False}})
    absent = {name for name, value in row.items() if value is None}
    assert absent >= {
        "finite", "start_ns", "end_ns", "first_violation_ns", "first_violation_s", "size",
        "log_sha256",
        "log_summary_sha256",
    }  # fmt: skip
    assert row["intact"] == 0


def test_a_time_beyond_a_column_is_null_and_no_failure() -> None:
    own_project = project(Path("known"))
    (row,) = rows(result(own_project, "no data", start_ns=0, end_ns=2**64 - 1))
    assert (row["start_ns"], row["end_ns"]) == (0, None)


def test_a_table_without_the_last_column_is_read_as_well() -> None:
    (row,) = rows(result(project(Path("known")), "satisfied", hashes={"log_summary": "1" * 64}))
    assert row["log_summary_sha256"] == "1" * 64
    whole = files.read_table("runs.parquet")
    older = whole.drop_columns(["log_summary_sha256"])
    older = older.replace_schema_metadata({"schema": "fretc-table-1"})
    files.write_table(older, "older.parquet")
    older_row = {**row, "log_summary_sha256": None}
    assert read_rows("older.parquet", "runs.parquet") == [older_row, row]
    files.write_table(older.replace_schema_metadata({"schema": "fretc-table-2"}), "odd.parquet")
    assert code("odd.parquet")[0] == "F503"


def test_no_run_is_a_table_too() -> None:
    assert rows() == []


def test_the_same_results_give_the_same_bytes() -> None:
    own_project = result(project(Path("known")), "satisfied")
    results = [own_project | {"run": f"{i}.mcap"} for i in range(50)]
    assert table(results, "1") == table(results, "1")


def test_evidence_is_read_as_the_table_of_it() -> None:
    own_project = project(Path("known"))
    results = [result(own_project, "satisfied"), result(own_project, "violated", run="b.mcap")]
    content = evidence(own_project, *results)
    Path("evidence.json").write_text(json.dumps(content), "utf-8")
    Path("runs.parquet").write_bytes(table(results, content["fretc"]))
    evidence_file = read_evidence("evidence.json")
    assert isinstance(evidence_file, EvidenceFile)
    assert isinstance(write_document(Path("store"), evidence_file.document), str)
    rows = read_rows("evidence.json")
    assert len(rows) == 2
    for paths in (["runs.parquet"], ["store"], ["evidence.json", "store", "runs.parquet"]):
        assert read_rows(*paths) == rows


def test_violations_and_runs_are_tables_if_a_query_names_them() -> None:
    own_project = project(Path("known"))
    found = [
        result(own_project, "violated", violations=[violation(41, 44, 40), violation(60, 60)]),
        result(own_project, "satisfied", run="b.mcap", labels={"version": "1"}),
    ]
    Path("evidence.json").write_text(json.dumps(evidence(own_project, *found)), "utf-8")
    document = read_evidence("evidence.json")
    assert isinstance(document, EvidenceFile)
    assert isinstance(write_document(Path("store"), document.document), str)
    for path in ("evidence.json", "store"):
        query = "SELECT run, first_tick, last_tick, \"trigger\" ->> 'tick' AS at FROM violations"
        assert answered(path, query) == [("logs/a.mcap", 41, 44, 40), ("logs/a.mcap", 60, 60, None)]
        query = "SELECT run, labels ->> 'version', size, json_array_length(gaps) FROM runs"
        assert answered(path, query) == [
            ("logs/a.mcap", None, 1234567, 0),
            ("b.mcap", "1", 1234567, 0),
        ]
        assert answered(path, "SELECT * FROM results WHERE verdict = 'unknown'") == []


def test_a_query_fills_the_tables_that_it_reads_however_it_names_them() -> None:
    own_project = project(Path("known"))
    found = result(own_project, "violated", violations=[violation(41, 44, 40)])
    Path("evidence.json").write_text(json.dumps(evidence(own_project, found)), "utf-8")
    cases: tuple[tuple[str, set[str]], ...] = (
        ("SELECT sum(violations) FROM results", {"results"}),
        ('SELECT count(*) FROM "RUNS"', {"runs"}),
        (
            "WITH v AS (SELECT * FROM Violations) SELECT 1 FROM v, results",
            {"violations", "results"},
        ),
        ("SELECT 'violations' -- runs", set()),
        ("no query", set()),
    )
    for query, filled in cases:
        tables = read(["evidence.json"], query)
        assert not isinstance(tables, Diagnostic)
        with closing(tables):
            counts = {name: tables.execute(f"SELECT count(*) FROM {name}").fetchone()[0]
                      for name in ("results", "violations", "runs")}  # fmt: skip
        assert {name for name, count in counts.items() if count} == filled, query


def answered(path: str, query: str) -> list[tuple[Any, ...]]:
    tables = read([path], query)
    assert not isinstance(tables, Diagnostic), tables.message
    with closing(tables):
        answer = run_query(tables, query)
        assert not isinstance(answer, Diagnostic), answer.message
        return [*answer.rows]


def test_what_is_no_table_is_told() -> None:
    assert code("no.parquet") == ("F901", "there is no file `no.parquet`")
    Path("log.mcap").write_bytes(b"\x89MCAP0\r\n")
    assert code("log.mcap") == ("F503", "`log.mcap` is neither a table nor evidence")
    Path("empty").write_bytes(b"")
    assert code("empty") == ("F503", "`empty` is neither a table nor evidence")
    Path("other.json").write_text('{"schema": "x"}')
    assert code("other.json")[0] == "F503"
    Path("folder").mkdir()
    assert code("folder")[0] == "F516"


def test_a_damaged_or_foreign_parquet_file_is_told() -> None:
    good = table([result(project(Path("known")), "satisfied")], "1")
    for part in (4, 100, len(good) - 1):
        Path("cut.parquet").write_bytes(good[:part])
        assert code("cut.parquet")[0] == "F503"
    files.write_table(pyarrow.table({"run": ["a"]}), "other.parquet")
    assert code("other.parquet") == ("F503", "`other.parquet` is not a table of `fretc-table-2`")
