"""A store of Parquet tables, as fretc wrote before, is read and then replaced."""

import json
import os
import shutil
import sys
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from zipfile import ZipFile

import pyarrow
import pytest
from pyarrow.parquet import read_table, write_table

from fretc.audit.evidence.writer import text
from fretc.audit.store.anywhere import read, source
from fretc.audit.store.earlier_store import is_store, remove_tables
from fretc.audit.store.reader import Store
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import Fretc, write
from tests.fretc.logs.logs import MS, X_TEXT, number
from tests.fretc.logs.logs import write as write_log
from tests.stores import write_document

BINDINGS = f'{X_TEXT}\n[proposition.x]\nexpr = "x > 0 m"\nagg = "last"\n'

STORED = Path(__file__).parents[3] / "data/earlier_store.zip"
"""A store, and the same evidence as a file; it has something in each column."""


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    with ZipFile(STORED) as files:
        files.extractall()
    return Path("store")


def refused(store: Path) -> str:
    found = read(str(store))
    assert isinstance(found, Diagnostic)
    assert found.code is Code.BAD_STORE
    return found.message


def change_table(store: Path, name: str, change: Callable[[pyarrow.Table], pyarrow.Table]) -> None:
    """Change a table, with a hash that fits."""
    (path,) = (store / name).iterdir()
    table = change(read_table(path))
    write_table(table, path)
    data = path.read_bytes()
    digest = sha256(data).hexdigest()
    path.rename(path.with_name(f"{digest[:32]}.parquet"))
    manifest = json.loads((store / "manifest.json").read_text())
    entry = {"sha256": digest, "size": len(data), "rows": len(table)}
    manifest["parts"][0]["tables"][name] = entry
    (store / "manifest.json").write_text(json.dumps(manifest))


def test_an_earlier_store_is_the_evidence_that_it_was(store: Path) -> None:
    found = read("store")
    assert not isinstance(found, Diagnostic), found.message
    assert text(found.document) == Path("evidence.json").read_text()
    assert found.sha256 == sha256((store / "manifest.json").read_bytes()).hexdigest()


def test_an_audit_replaces_an_earlier_store(store: Path, fretc: Fretc) -> None:
    (store / "own").write_text("precious")
    write("requirements/r1.fret", "the sw shall always satisfy x")
    write("requirements/bindings.toml", BINDINGS)
    write_log(Path("a.mcap"), [number(1.0, 10**9 + tick * 100 * MS) for tick in range(4)])
    assert fretc("audit", "a.mcap", "-o", "store/").status == 0
    assert sorted(os.listdir(store)) == ["evidence.sqlite", "own"]
    assert isinstance(source("store"), Store)


def test_an_earlier_store_is_replaced_by_one_of_this_version(store: Path) -> None:
    before = read("store")
    assert not isinstance(before, Diagnostic)
    (store / "own").write_text("precious")
    assert isinstance(write_document(store, before.document), str)
    assert sorted(os.listdir(store)) == ["evidence.sqlite", "own"]
    assert isinstance(source("store"), Store)
    after = read("store")
    assert not isinstance(after, Diagnostic)
    assert text(after.document) == text(before.document)


def test_without_the_extra_it_is_said_how_to_install_it(
    store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "fretish.diagnostics.extras.find_spec", lambda name: None if name == "pyarrow" else sys
    )
    found = read("store")
    assert isinstance(found, Diagnostic)
    assert (found.code.number, found.message) == (
        "F908",
        "the store `store` has Parquet tables of an earlier fretc: they need `pyarrow`",
    )
    assert "pip install 'fretc[parquet]'" in (found.help or "")


def test_a_table_that_is_missing_or_another_one_is_refused(store: Path) -> None:
    for path in sorted(store.glob("*/*.parquet")):
        data = path.read_bytes()
        for other in (data[:-1] + b"x", data + b"x", b""):
            path.write_bytes(other)
            assert "is not the file that the manifest names" in refused(store)
        path.unlink()
        refused(store)
        path.write_bytes(data)
    assert not isinstance(read("store"), Diagnostic)


@pytest.mark.parametrize(
    ("name", "column", "value"),
    [
        ("results", "verdict", "satisfied"),
        ("results", "violations", 7),
        ("results", "run_row", -1),
        ("results", "run_row", 10**9),
        ("results", "exact", "{"),
        ("violations", "result_row", None),
        ("violations", "result_row", 0),
        ("violations", "first_tick", 77),
    ],
)
def test_a_row_that_contradicts_another_table_is_refused(
    store: Path, name: str, column: str, value: object
) -> None:
    def change(table: pyarrow.Table) -> pyarrow.Table:
        place = table.schema.get_field_index(column)
        values = [*table[column].to_pylist()[:-1], value]
        if (column, value) == ("verdict", "satisfied"):
            values = [value] * len(table)
        array = pyarrow.array(values, table.schema.field(place).type)
        return table.set_column(place, table.schema.field(place), array)

    change_table(store, name, change)
    refused(store)


@pytest.mark.parametrize("name", ["results", "events", "violations", "samples", "runs"])
def test_a_table_of_other_columns_is_refused(store: Path, name: str) -> None:
    change_table(store, name, lambda table: table.select([table.column_names[-1]]))
    refused(store)


def test_what_a_link_leads_to_is_neither_read_nor_removed(store: Path) -> None:
    shutil.move(store / "results", "elsewhere")
    os.symlink(os.path.abspath("elsewhere"), store / "results")
    assert not is_store(store)
    refused(store)
    remove_tables(store)
    assert any(Path("elsewhere").iterdir())
    assert (store / "manifest.json").exists()
