"""An untrusted store: what does not fit its hashes is F516, and costs little."""

import json
import os
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
import zstandard

from compiler.files.checked_json import SchemaError
from compiler.files.records import Raw, decoded_json
from fretc.audit.evidence.writer import text
from fretc.audit.store import container
from fretc.audit.store.anywhere import read, source
from fretc.audit.store.container import FILE, RunRecord, identity, rows, whole_results
from fretc.audit.store.reader import Store
from fretc.audit.store.run_summaries import run_summary
from fretc.audit.store.writer import is_store, remove
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import made_once
from tests.fretc.audit.results import result
from tests.fretc.audit.store.test_law import document
from tests.stores import write_document

BROKEN = {"first_tick": 1, "last_tick": 2}
RESULTS = (
    result(run="a", verdict="violated", violations=[BROKEN, BROKEN], latencies_s=[0.5]),
    result(run="b", verdict="satisfied"),
)
SOUND = text(document(*RESULTS))


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


def edit(store: Path, statement: str, *values: object) -> None:
    with closing(sqlite3.connect(store / FILE, isolation_level=None)) as connection:
        connection.execute(statement, values)


def with_text(store: Path, content: bytes, place: int = 0, **row: object) -> None:
    """Put another JSON in place of the results of a run, with hashes that fit."""
    record = zstandard.compress(content)
    own = {
        "size": len(content),
        "sha256": sha256(content).hexdigest(),
        "packed_sha256": sha256(record).hexdigest(),
        "record": record,
        **_summary_of(content),
    } | row
    names = ", ".join(f"{name} = ?" for name in own)
    edit(store, f"UPDATE runs SET {names} WHERE place = ?", *own.values(), place)
    seal(store)


def _summary_of(content: bytes) -> dict[str, object]:
    """The summary that fits a record; none, if it is no record."""
    try:
        run = decoded_json(content, RunRecord[Raw])
        results = [*whole_results(run, range(len(run.results)))]
    except SchemaError:
        return {}
    summary = zstandard.compress(run_summary(results).text) if results else b""
    return {"summary": summary, "summary_sha256": sha256(summary).hexdigest()}


def seal(store: Path) -> None:
    """Write the SHA-256 of the evidence as it is now."""
    with closing(sqlite3.connect(store / FILE, isolation_level=None)) as connection:
        (head,) = connection.execute("SELECT head FROM about").fetchone()
        digest = identity(head, rows(connection))
        connection.execute("UPDATE about SET sha256 = ?", (digest,))


def with_record(store: Path, change: Callable[[Any], None], place: int = 0) -> None:
    """Change the record of a run, with hashes that fit."""
    with closing(sqlite3.connect(store / FILE)) as connection:
        query = "SELECT record FROM runs WHERE place = ?"
        (record,) = connection.execute(query, (place,)).fetchone()
    run = json.loads(zstandard.decompress(record))
    change(run)
    with_text(store, json.dumps(run).encode(), place)


def test_a_store_is_read_whatever_writer_has_written_its_json(store: Path) -> None:
    with_record(store, lambda _: None)
    found = read(str(store))
    assert not isinstance(found, Diagnostic)
    assert text(found.document) == SOUND


# Files -------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_file_of_which_a_byte_is_another_is_refused_or_the_same(store: Path) -> None:
    path = store / FILE
    data = path.read_bytes()
    for place in range(0, len(data), 97):
        path.write_bytes(data[:place] + bytes([data[place] ^ 0x55]) + data[place + 1 :])
        found = read(str(store))
        if isinstance(found, Diagnostic):
            assert found.code is Code.BAD_STORE, place
        else:
            assert text(found.document) == SOUND, place


@pytest.mark.slow
def test_a_file_that_is_cut_is_refused(store: Path) -> None:
    path = store / FILE
    data = path.read_bytes()
    for size in (0, 15, 71, 72, 100, 4095, 4096, len(data) - 4096, len(data) - 1):
        path.write_bytes(data[:size])
        refused(store)


def test_links_and_pipes_are_not_followed(store: Path) -> None:
    path = store / FILE
    shutil.move(path, "elsewhere")
    os.symlink(os.path.abspath("elsewhere"), path)
    assert "is not a file that fretc has written" in refused(store)
    assert not is_store(store)
    path.unlink()
    os.mkfifo(path)
    assert "is not a file that fretc has written" in refused(store)
    remove(store)
    assert Path("elsewhere").exists()


def test_a_journal_beside_the_file_is_not_read(store: Path) -> None:
    """SQLite would change the file by it, and remove the file that it names."""
    Path("precious").write_text("precious")
    for suffix in ("-journal", "-wal"):
        (store / f"{FILE}{suffix}").write_bytes(b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7" * 100)
    assert not isinstance(read(str(store)), Diagnostic)
    assert Path("precious").exists()
    assert (store / f"{FILE}-journal").exists()


def test_an_audit_writes_and_removes_nothing_that_a_link_or_a_journal_names(store: Path) -> None:
    Path("precious").write_text("precious")
    own = store / "unfinished-1.sqlite"
    shutil.copy(store / FILE, own)
    for name in ("unfinished-1.sqlite-wal", "unfinished-2.sqlite", "unfinished-3.sqlite-wal"):
        os.symlink(os.path.abspath("precious"), store / name)
    (store / f"{own.name}-journal").write_bytes(b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7" * 100)
    assert container.recovered(own)
    assert not container.recovered(store / "unfinished-2.sqlite")
    assert isinstance(write_document(store, document(*RESULTS)), str)
    assert Path("precious").read_text() == "precious"
    remove(store)
    assert Path("precious").read_text() == "precious"


@pytest.mark.parametrize(
    "statement",
    [
        "CREATE VIEW more AS SELECT 1",
        "CREATE TABLE more (x)",
        "CREATE INDEX more ON runs (size)",
        "CREATE TRIGGER more INSERT ON runs BEGIN SELECT 1; END",
        "ALTER TABLE runs ADD COLUMN more",
        "ALTER TABLE runs RENAME TO others",
        "DROP TABLE about",
    ],
)
def test_a_file_with_other_tables_is_refused(store: Path, statement: str) -> None:
    edit(store, statement)
    assert "does not have the tables of this version of fretc" in refused(store)


@pytest.mark.parametrize(
    "statement",
    [
        "DELETE FROM runs WHERE place = 1",
        "UPDATE runs SET place = 7 - place",
        "UPDATE runs SET results = 2",
        "UPDATE runs SET results = -1",
        "UPDATE runs SET results = 'x'",
        "UPDATE runs SET size = size + 1",
        "UPDATE runs SET size = 1 << 40",
        "UPDATE runs SET sha256 = packed_sha256",
        "UPDATE runs SET sha256 = NULL",
        "UPDATE runs SET packed_sha256 = sha256",
        "UPDATE runs SET packed_sha256 = x'00'",
        "UPDATE runs SET record = NULL",
        "UPDATE runs SET record = x'00'",
        "UPDATE runs SET record = 'text'",
        "UPDATE runs SET place = -place - 1",
        "UPDATE about SET sha256 = ''",
        "UPDATE about SET head = 1",
        "UPDATE about SET head = x'ff'",
        "UPDATE about SET head = CAST(x'ff' AS TEXT)",
        "UPDATE about SET head = '{}'",
        "UPDATE about SET head = replace(head, 'fretc-evidence-1', 'fretc-evidence-2')",
        "UPDATE about SET head = replace(head, 'bindings.toml', 'other.toml')",
        "INSERT INTO about SELECT * FROM about",
        "DELETE FROM about",
    ],
)
def test_rows_that_contradict_each_other_are_refused(store: Path, statement: str) -> None:
    edit(store, statement)
    refused(store)


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE runs SET results = 2 WHERE place = 0",
        "UPDATE runs SET size = size + 1",
        "UPDATE runs SET place = 7 - place",
        "UPDATE runs SET record = x'00', packed_sha256 = '{}'".format(sha256(b"\0").hexdigest()),
    ],
)
def test_a_row_that_its_record_contradicts_is_refused(store: Path, statement: str) -> None:
    """The SHA-256 of the evidence is that of these rows."""
    edit(store, statement)
    seal(store)
    if "place = 7" in statement:  # another order of the runs is other evidence
        found = read(str(store))
        assert not isinstance(found, Diagnostic)
        assert text(found.document) == text(document(*RESULTS[::-1]))
    else:
        refused(store)


def test_what_is_no_store_is_refused(store: Path) -> None:
    (store / FILE).unlink()
    assert refused(store) == "the store `store` has no `evidence.sqlite`"
    (store / FILE).write_text("no database")
    assert "is not a file that fretc has written" in refused(store)


def test_a_store_whose_audit_was_stopped_says_so(store: Path) -> None:
    os.rename(store / FILE, store / "unfinished-1.sqlite")
    assert refused(store).endswith("has no `evidence.sqlite`: its audit was not finished")
    os.rename(store / "unfinished-1.sqlite", store / FILE)
    edit(store, "UPDATE about SET head = NULL, sha256 = NULL")
    assert refused(store).endswith("its audit was not finished")


# Records -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"[]",
        b"{}",
        b"\xff",
        b"[" * 100_000,
        b'{"run": "a", "health": 1, "results": [{}]}',
        b'{"run": "a", "health": "\xff", "results": [{}]}',
        b'{"run": "\\ud800", "health": {}, "results": []}',
    ],
)
def test_a_record_that_no_evidence_has_is_refused(store: Path, content: bytes) -> None:
    with_text(store, content)
    refused(store)
    found = source(str(store))
    assert isinstance(found, Store)
    for reading in (found.summaries, found.runs, found.tallies):
        with pytest.raises(container.StoreError):
            [*reading()]


@pytest.mark.parametrize(
    "change",
    [
        lambda r: r["results"].append(r["results"][0]),
        lambda r: r["results"].clear(),
        lambda r: r["results"][0].update(verdict="shown"),
        lambda r: r["results"][0].update(requirement=""),
        lambda r: r["results"][0].update(more=1),
        lambda r: r["results"][0].update(exercised=-1),
        lambda r: r["results"][0].update(end_ns=2**64),
        lambda r: r["results"][0].update(run="b"),
        lambda r: r["results"][0].update(labels={"a": "b"}),
        lambda r: r["results"][0].update(health=r["health"]),
        lambda r: r["results"][0]["hashes"].update(log="x"),
        lambda r: r["results"][0]["violations"][0].update(first_tick=None),
        lambda r: r["results"][0]["violations"][0].update(start_ns=-(2**63) - 1),
        lambda r: r["results"][0]["violations"][0].update(start_s=float("inf")),
        lambda r: r["health"].update(more=1),
        lambda r: r.update(labels={}),
        lambda r: r.update(more=1),
        lambda r: r.pop("health"),
    ],
)
def test_a_result_that_no_evidence_has_is_refused(
    store: Path, change: Callable[[Any], None]
) -> None:
    with_record(store, change)
    refused(store)


def test_a_key_that_appears_twice_is_refused(store: Path) -> None:
    twice = (
        b'{"run": "a", "health": {}, "results": [{"verdict": "violated", "verdict": "violated"}]}'
    )
    with_text(store, twice)
    assert "`verdict` appears twice in one object" in refused(store)


@pytest.mark.parametrize("size", [1, 100, 2**30 + 1])
def test_what_a_record_would_take_in_memory_is_bounded(store: Path, size: int) -> None:
    """A frame says its size before it is expanded, and a row says the same or is refused."""
    with_text(store, b" " * 10**7, size=10**7)
    edit(store, "UPDATE runs SET size = ?", size)
    with closing(sqlite3.connect(store / FILE, isolation_level=None)) as connection:
        if size > container.LARGEST:
            with pytest.raises(SchemaError):
                rows(connection)
        else:
            seal(store)
    refused(store)


def test_a_record_that_does_not_say_its_size_is_not_expanded(store: Path) -> None:
    record = zstandard.ZstdCompressor(write_content_size=False).compress(b"[]")
    with_text(store, b"[]", record=record, packed_sha256=sha256(record).hexdigest())
    assert "does not have the size that its row says" in refused(store)
