"""A changed result, with hashes that fit: every reader of the store sees the same."""

import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from compiler.files.records import decoded
from fretc.audit.evidence.result_summaries import run_facts, summary_of
from fretc.audit.evidence.schema import EvidenceDocument
from fretc.audit.evidence.writer import text
from fretc.audit.store.anywhere import read, source
from fretc.audit.store.container import StoreError, record_text
from fretc.audit.store.reader import Store
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.effort import some
from tests.fretc.audit.store.test_hostile import with_record
from tests.fretc.audit.store.test_whole_numbers import evidence, put
from tests.stores import runs_of, write_document

DOCUMENT = decoded(json.loads(evidence((("results", 0, "ticks"), 1))), EvidenceDocument)
"""One run with something in each field."""
Step = str | int


def others(value: Any) -> Iterator[Any]:
    """Other values in place of one."""
    match value:
        case None:
            yield from (0, "x")
        case bool():
            yield not value
        case int():
            yield from (value + 1, -1, 2**64, "1")
        case float():
            yield from (value + 0.5, None, -0.5)
        case str():
            yield from (f"{value}x", "", "satisfied", "violated", 1)
        case list():
            yield [] if value else [None]
            yield [*value, *value[:1]]
            yield None
        case dict():
            yield from ({}, None)


def forgeries(value: Any, at: tuple[Step, ...] = ()) -> Iterator[tuple[tuple[Step, ...], Any]]:
    """Each place of a value, with what may be put there."""
    for other in others(value) if at else ():
        if json.dumps(other) != json.dumps(value):
            yield at, other
    parts: Any = value.items() if isinstance(value, dict) else ()
    for key, inner in enumerate(value) if isinstance(value, list) else parts:
        yield from forgeries(inner, (*at, key))


def _put(at: tuple[Step, ...], other: Any, run: Any) -> None:
    put(run, at, other)


RECORD = json.loads(record_text(DOCUMENT.results))
ALL = [*forgeries(RECORD)]


@pytest.mark.slow
def test_no_change_of_a_result_is_hidden(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The store is refused, or all readers give the counts of the changed results."""
    monkeypatch.chdir(tmp_path)
    assert isinstance(write_document(Path("store"), DOCUMENT), str)
    sound, before = Path("store/evidence.sqlite").read_bytes(), text(DOCUMENT)
    assert len(ALL) > 300
    accepted = 0
    for at, other in some(ALL, 61):
        Path("store/evidence.sqlite").write_bytes(sound)
        with_record(Path("store"), partial(_put, at, other))
        whole = read("store")
        counted = counts()
        if isinstance(whole, Diagnostic):
            assert whole.code is Code.BAD_STORE
        else:
            accepted += 1
            assert text(whole.document) != before, (at, other)
            assert counted == (
                [summary_of(each) for each in whole.results],
                [run_facts(run) for run in runs_of(whole.results)],
            )
    assert accepted > 0


def counts() -> tuple[list[Any], list[Any]] | None:
    """What is said of each result and run; None: the store is refused."""
    found = source("store")
    assert isinstance(found, Store)
    try:
        return [each for _, each in found.summaries()], [*found.runs()]
    except StoreError:
        return None
