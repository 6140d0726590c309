"""A summary counts for its record only: one that contradicts it is an error, never a verdict."""

import json
import sqlite3
from collections.abc import Callable
from contextlib import closing
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
import zstandard

from compiler.files.checked_json import SchemaError
from compiler.files.user_key import user_key
from fretc.audit.evidence.result_summaries import ResultSummaries, summary_of
from fretc.audit.store import container, reader, register
from fretc.audit.store.anywhere import read, source
from fretc.audit.store.container import FILE, StoreError, next_unfinished, packed
from fretc.audit.store.reader import Store
from fretc.audit.store.run_summaries import run_summary, summary_from
from fretc.audit.store.writer import StoreFile, complete, publish
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.fretc.audit.results import result
from tests.fretc.audit.store.test_hostile import edit
from tests.fretc.audit.store.test_law import document

BROKEN = {"first_tick": 1, "last_tick": 2}
RUNS = [
    [result(run="a", verdict="violated", violations=[BROKEN, BROKEN], latencies_s=[0.5, 1])],
    [result(run="b", verdict="satisfied")],
]


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A store of two runs, each with the mark of the user."""
    monkeypatch.chdir(tmp_path)
    key, folder = user_key(), Path("store")
    assert isinstance(key, bytes)
    folder.mkdir()
    file = StoreFile(next_unfinished(folder), "plan")
    authenticity = register.Authenticity.of(folder, "plan", key)
    for place, results in enumerate(RUNS):
        run = packed(place, results)
        file.put(run, entry(), authenticity.mark(run.row, entry()))
    complete(file.path, document(), file.close())
    publish(file.path)
    return folder


def entry() -> str:
    texts = {"run": "a", "log": "a", "place": "/a", "known_by": "read", "sha256": ""}
    return json.dumps(texts | register.marks(None) | {"labels": {}, "diagnostics": []})


def forge(store: Path, change: Callable[[Any], None]) -> None:
    """Change the summary of the first run, with a hash that fits."""
    with closing(sqlite3.connect(store / FILE)) as connection:
        (data,) = connection.execute("SELECT summary FROM runs WHERE place = 0").fetchone()
    summary = json.loads(zstandard.decompress(data))
    change(summary)
    text = zstandard.compress(json.dumps(summary, separators=(",", ":")).encode())
    edit(store, "UPDATE runs SET summary = ?, summary_sha256 = ? WHERE place = 0",
         text, sha256(text).hexdigest())  # fmt: skip


def satisfied(summary: Any) -> None:
    summary["results"][0].update(verdict="satisfied", violations=0)


def counted(*, by_summaries: bool) -> Store:
    found = source("store", by_summaries=by_summaries)
    assert isinstance(found, Store), found
    return found


def test_counts_are_those_of_the_records(store: Path) -> None:
    expected = [*enumerate(summary_of(one) for run in RUNS for one in run)]
    for by_summaries in (True, False):
        found = counted(by_summaries=by_summaries)
        assert found.by_summaries is by_summaries
        assert [*found.summaries()] == expected
        assert [facts.run for facts in found.runs()] == ["a", "b"]
    late = expected[0][1]
    assert (late.violations, late.violated_ticks, late.latency_max_s) == (2, 4, 1)


def test_whole_numbers_and_others_stay_apart_in_a_summary() -> None:
    summary = run_summary(RUNS[0])
    again = summary_from(summary.text, 1)
    assert again == summary
    assert json.loads(again.text) == json.loads(summary.text)
    assert b'"latency_max_s":1,' in again.text == summary.text


def test_a_forged_summary_is_an_error_for_every_reader(store: Path) -> None:
    """The user's key does not authenticate it, so that queries read the records, too."""
    forge(store, satisfied)
    for by_summaries in (True, False):
        found = counted(by_summaries=by_summaries)
        assert not found.by_summaries
        with pytest.raises(StoreError, match="a summary contradicts its record"):
            [*found.summaries()]
    for whole in (read("store"), source("store", in_full=True)):
        assert isinstance(whole, Diagnostic)
        assert whole.code is Code.BAD_STORE
        assert whole.message.endswith("cannot be read: a summary contradicts its record")


def test_facts_are_taken_from_summaries_once_all_are_compared(
    store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    decoded: list[int] = []

    def counting(row: container.Row, *args: Any, **named: Any) -> Any:
        decoded.append(row.place)
        return container.unpacked(row, *args, **named)

    monkeypatch.setattr(reader, "unpacked", counting)
    found = counted(by_summaries=False)
    facts = [*found.runs()]
    known = ResultSummaries.of(found).source
    assert decoded == [0, 1, 0, 1]
    assert [*known.runs()] == facts
    assert [*known.summaries()] == [*enumerate(summary_of(one) for run in RUNS for one in run)]
    assert decoded == [0, 1, 0, 1]
    assert [index for index, _ in known.thresholds({"R1"})] == [0, 1]
    assert decoded == [0, 1, 0, 1, 0, 1]


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ("summary", "a summary is not the one that was written"),
        ("record", "a record is not the one that was written"),
    ],
)
def test_what_changes_after_the_comparison_is_an_error(store: Path, change: str, why: str) -> None:
    known = ResultSummaries.of(counted(by_summaries=False)).source
    edit(store, f"UPDATE runs SET {change} = (SELECT {change} FROM runs WHERE place = 1)")
    with pytest.raises(StoreError, match=why):
        [*known.runs(), *known.situations({"R1"})]


@pytest.mark.parametrize(
    "change",
    [
        "summary = x'00'",
        "summary = NULL",
        "summary_sha256 = NULL",
        "summary_sha256 = sha256",
        "record = x'00'",
        "mark = 'x'",
        "entry = NULL",
    ],
)
def test_summaries_count_only_if_all_of_their_run_is_authentic(store: Path, change: str) -> None:
    edit(store, f"UPDATE runs SET {change} WHERE place = 0")
    found = source("store", by_summaries=True)
    if isinstance(found, Diagnostic):
        assert found.code is Code.BAD_STORE
    else:
        assert isinstance(found, Store)
        assert not found.by_summaries


def test_another_user_counts_the_records(store: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(Path("other").absolute()))
    assert not counted(by_summaries=True).by_summaries
    assert not Path("other").exists(), "who only reads makes no key"


def test_a_store_that_was_moved_is_counted_by_its_records(store: Path) -> None:
    store.rename("moved")
    found = source("moved", by_summaries=True)
    assert isinstance(found, Store)
    assert not found.by_summaries


def test_a_summary_of_other_results_is_none() -> None:
    text = run_summary(RUNS[0]).text
    with pytest.raises(SchemaError, match="does not have the results of its run"):
        summary_from(text, 2)
    for old, new in ((b'"violations":2', b'"violations":-2'), (b'"ticks":', b'"tocks":')):
        assert old in text
        with pytest.raises(SchemaError):
            summary_from(text.replace(old, new), 1)


def test_a_store_without_summaries_is_read_as_before(store: Path) -> None:
    before = read("store")
    assert not isinstance(before, Diagnostic)
    (table,) = container._TABLES_WITHOUT_SUMMARIES[1:]
    kept = "place, results, size, sha256, packed_sha256, entry, mark, record"
    with closing(sqlite3.connect(store / FILE, isolation_level=None)) as connection:
        connection.execute("ALTER TABLE runs RENAME TO newer")
        connection.execute(table)
        connection.execute(f"INSERT INTO runs SELECT {kept} FROM newer")
        connection.execute("DROP TABLE newer")
    assert read("store") == before
    found = counted(by_summaries=True)
    assert not found.by_summaries
    assert [one.verdict for _, one in found.summaries()] == ["violated", "satisfied"]
    assert found.after_summaries() is found
    assert [facts.run for facts in ResultSummaries.of(found).source.runs()] == ["a", "b"]
