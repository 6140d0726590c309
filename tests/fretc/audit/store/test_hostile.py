"""A untrusted store: what does not fit its manifest is F516, and costs little."""

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest

from compiler.files.records import UNSET
from fretc.audit.store.anywhere import read
from fretc.audit.store.files import encoded
from fretc.audit.store.reader import Store, opened
from fretc.audit.store.tables import TABLES, TableName, to_tables
from fretc.audit.store.writer import is_store, remove, write_document
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import made_once
from tests.fretc.audit.results import result
from tests.fretc.audit.store.test_law import document

BROKEN = {"first_tick": 1, "last_tick": 2}
RESULTS = (
    result(run="a", verdict="violated", violations=[BROKEN, BROKEN], latencies_s=[0.5]),
    result(run="b", verdict="satisfied"),
)


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    made_once("a store of two runs", _written)
    return Path("store")


def _written() -> None:
    assert isinstance(write_document(Path("store"), document(*RESULTS)), str)
    assert not isinstance(read("store"), Diagnostic)


def refused(path: Path) -> str:
    found = read(str(path))
    assert isinstance(found, Diagnostic)
    assert found.code is Code.BAD_STORE
    assert found.is_error
    return found.message


def changed(store: Path, change: Callable[[Any], None]) -> None:
    manifest = json.loads((store / "manifest.json").read_text())
    change(manifest)
    (store / "manifest.json").write_text(json.dumps(manifest))


def with_table(store: Path, name: TableName, table: pa.Table) -> None:
    """Put another table in place of one, as its manifest says."""
    data, file = encoded(table)
    (store / name / f"{file.sha256[:32]}.parquet").write_bytes(data)

    def change(manifest: Any) -> None:
        about = {"sha256": file.sha256, "size": file.size, "rows": file.rows}
        manifest["parts"][0]["tables"][name] = about

    changed(store, change)


@pytest.mark.slow
def test_a_table_that_is_missing_or_another_one_is_refused(store: Path) -> None:
    for path in sorted(store.glob("*/*.parquet")):
        data = path.read_bytes()
        path.unlink()
        assert "does not fit its manifest" in refused(store)
        path.write_bytes(data[:-1] + b"x")
        assert "is not the file that the manifest names" in refused(store)
        path.write_bytes(data + b"x")
        assert "is not the file that the manifest names" in refused(store)
        path.write_bytes(data)
    assert not isinstance(read(str(store)), Diagnostic)


def test_links_and_pipes_are_not_followed(store: Path) -> None:
    (path,) = (store / "results").iterdir()
    shutil.move(path, "elsewhere")
    os.symlink(os.path.abspath("elsewhere"), path)
    assert "does not fit its manifest" in refused(store)
    path.unlink()
    os.mkfifo(path)
    assert "does not fit its manifest" in refused(store)


@pytest.mark.parametrize("table", TABLES)
def test_a_folder_of_tables_that_is_a_link_is_neither_read_nor_cleared(
    store: Path, table: TableName
) -> None:
    shutil.move(store / table, "elsewhere")
    os.symlink(os.path.abspath("elsewhere"), store / table)
    assert "does not fit its manifest" in refused(store)
    assert not is_store(store)
    remove(store)
    assert any(Path("elsewhere").iterdir())


@pytest.mark.parametrize(
    "change",
    [
        lambda m: m.update(schema="fretc-store-2"),
        lambda m: m.update(more=1),
        lambda m: m["parts"][0].update(runs=3),
        lambda m: m["parts"][0].update(results=1),
        lambda m: m["parts"][0]["tables"].pop("events"),
        lambda m: m["parts"][0]["tables"].update(others=m["parts"][0]["tables"]["events"]),
        lambda m: m["parts"][0]["tables"]["runs"].update(rows=5),
        lambda m: m["parts"][0]["tables"]["runs"].update(size=2**40),
        lambda m: m["parts"][0]["tables"]["runs"].update(sha256="../../x"),
    ],
)
def test_a_manifest_that_is_none_or_contradicts_itself_is_refused(
    store: Path, change: Callable[[Any], None]
) -> None:
    changed(store, change)
    refused(store)


@pytest.mark.parametrize("text", ["", "[]", "{", "\0", '{"schema": "fretc-store-1"}'])
def test_what_is_no_manifest_is_refused(store: Path, text: str) -> None:
    (store / "manifest.json").write_text(text)
    refused(store)
    (store / "manifest.json").unlink()
    assert refused(store) == "the store `store` has no manifest"


def test_a_store_whose_audit_was_stopped_says_so(store: Path) -> None:
    os.rename(store / "manifest.json", store / "unfinished.json")
    assert refused(store).endswith("has no manifest: its audit was not finished")


def tables() -> dict[TableName, pa.Table]:
    return dict(to_tables(RESULTS, "1"))


@pytest.mark.slow
@pytest.mark.parametrize("name", [*TABLES])
def test_a_table_of_other_columns_is_refused(store: Path, name: TableName) -> None:
    table = tables()[name]
    with_table(store, name, table.drop_columns([table.column_names[0]]))
    assert "does not have the columns of this version of fretc" in refused(store)


@pytest.mark.slow
def test_a_store_of_earlier_versions_is_read_and_has_no_situations(store: Path) -> None:
    now = opened(str(store))
    assert isinstance(now, Store)
    expected = [*now.details([0, 1])]
    with_table(store, "events", tables()["events"].drop_columns(["situations"]))
    found = opened(str(store))
    assert isinstance(found, Store)
    assert [*found.details([0, 1])] == expected
    assert [*found.situations(["R1"])] == [(0, UNSET), (1, UNSET)]
    assert not isinstance(read(str(store)), Diagnostic)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "column", "values"),
    [
        ("results", "verdict", ["shown", "satisfied"]),
        ("results", "verdict", ["satisfied", "satisfied"]),  # the violations are still there
        ("results", "violations", [0, 0]),
        ("results", "judgement", ["0" * 64, "0" * 64]),
        ("results", "run_row", [0, 7]),
        ("results", "run_row", [0, None]),
        ("results", "run_row", [0, -1]),
        ("results", "requirement", ["", "R1"]),
        ("results", "log_sha256", ["x", None]),
        ("results", "exact", ["{", None]),
        ("violations", "result_row", [0, 2]),
        ("violations", "result_row", [1, 0]),
        ("violations", "result_row", [-1, 0]),
        ("violations", "result_row", [None, 0]),
        ("violations", "first_tick", [None, 1]),
        ("violations", "start_s", [float("inf"), 1.0]),
        ("events", "exercised", [-1, 0]),
    ],
)
def test_a_row_that_no_evidence_has_is_refused(
    store: Path, name: TableName, column: str, values: list[Any]
) -> None:
    table = tables()[name]
    place = table.schema.get_field_index(column)
    field = table.schema.field(place)
    with_table(store, name, table.set_column(place, field, pa.array(values, field.type)))
    refused(store)


def test_what_a_table_would_take_in_memory_is_bounded(
    store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fretc.audit.store.files.MOST_VALUES", 1)
    found = opened(str(store))
    assert isinstance(found, Store)
    assert "larger in memory than any that fretc writes" in refused(store)
