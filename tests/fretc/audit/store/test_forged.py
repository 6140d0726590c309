"""A changed table, with its new hash in the manifest: every reader of the store sees it."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest

from compiler.files.records import decoded
from fretc.audit.evidence.schema import EvidenceDocument
from fretc.audit.evidence.writer import text
from fretc.audit.store.agreement import COLUMNS
from fretc.audit.store.anywhere import read, source
from fretc.audit.store.errors import StoreError
from fretc.audit.store.tables import TABLES, TableName, to_tables
from fretc.audit.store.writer import write_document
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.effort import FULL, some
from tests.fretc.audit.store.test_hostile import with_table
from tests.fretc.audit.store.test_whole_numbers import evidence

TICKS = ("results", 0, "ticks")
LATE = ("results", 0, "violations", 0, "start_ns")
DOCUMENT = decoded(json.loads(evidence((TICKS, 1), (TICKS, 2), (LATE, 2**63))), EvidenceDocument)
"""Three runs with something in each column, of which the last is not held by columns alone."""
Forgery = tuple[str, TableName, pa.Table]


def others(kind: pa.DataType, value: Any) -> Iterator[Any]:
    """Other values of a type."""
    if value is not None:
        yield None
    if pa.types.is_boolean(kind):
        yield not value
    elif pa.types.is_integer(kind):
        yield (value or 0) + 1
    elif pa.types.is_floating(kind):
        yield (value or 0.0) + 0.5
    elif pa.types.is_string(kind):
        yield f"{value or ''}x"
    elif pa.types.is_list(kind):
        items = value or []
        yield [] if items else [next(others(kind.value_type, None), None)]
        yield [*items, *items[:1]]
        for other in others(kind.value_type, items[0] if items else None):
            yield [other, *items[1:]]
    elif pa.types.is_map(kind):
        items = value or []
        yield []
        for other in others(kind.item_type, items[0][1] if items else None):
            yield [(items[0][0] if items else "x", other), *items[1:]]
    elif pa.types.is_struct(kind) and value is not None:
        for field in kind:
            for other in others(field.type, value[field.name]):
                yield {**value, field.name: other}


def forgeries() -> Iterator[Forgery]:
    """What is done, the table, and what it is then."""
    for name, table in to_tables(DOCUMENT.results, DOCUMENT.fretc).items():
        for place, field in enumerate(table.schema):
            values = table[field.name].to_pylist()
            for row in (0, len(values) - 1):
                for other in others(field.type, values[row]):
                    column = pa.array([*values[:row], other, *values[row + 1 :]], field.type)
                    changed = table.set_column(place, field, column)
                    yield f"{field.name} of row {row} is {other!r}", name, changed
        rows = [*range(len(table))]
        yield "the last row is there twice", name, table.take([*rows, rows[-1]])
        yield "the last row is left out", name, table.take(rows[:-1])
        yield "the rows are in another order", name, table.take(rows[::-1])


@pytest.mark.slow
def test_no_change_of_a_table_is_hidden(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The store is refused, or its results are others: then they are not what a new audit gives."""
    monkeypatch.chdir(tmp_path)
    assert isinstance(write_document(Path("store"), DOCUMENT, 0.95), str)
    manifest, before = Path("store/manifest.json"), text(DOCUMENT)
    sound = manifest.read_bytes()
    genuine = to_tables(DOCUMENT.results, DOCUMENT.fretc)
    all_of_them = [each for each in forgeries() if not each[2].equals(genuine[each[1]])]
    assert {name for _, name, _ in all_of_them} == {*TABLES}
    hidden = []
    for what, name, table in some(all_of_them, 47):
        manifest.write_bytes(sound)
        with_table(Path("store"), name, table)
        found = read("store")
        if isinstance(found, Diagnostic):
            assert found.code is Code.BAD_STORE
        elif text(found.document) == before:
            hidden.append((name, what))
    assert hidden == []


@pytest.mark.slow
def test_no_change_of_a_table_hides_what_is_violated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a store that is read little at a time, verdicts are those of the other tables."""
    monkeypatch.chdir(tmp_path)
    assert isinstance(write_document(Path("store"), DOCUMENT, 0.95), str)
    manifest = Path("store/manifest.json")
    sound = manifest.read_bytes()
    before = counted()
    hidden = []
    decisive = [each for each in forgeries() if each[0].split()[0] in COLUMNS[each[1]]]
    assert {name for _, name, _ in decisive} == {*TABLES}
    for what, name, table in forgeries() if FULL else decisive[::3]:
        manifest.write_bytes(sound)
        with_table(Path("store"), name, table)
        after = counted()
        if after != before and after is not None:
            hidden.append((name, what))
    assert before is not None
    assert hidden == []


def counted() -> list[tuple[str, str, str, int]] | None:
    """What is said of each result; None: the store is refused."""
    found = source("store")
    if isinstance(found, Diagnostic):
        return None
    try:
        briefs = [each for _, each in found.briefs()]
    except StoreError:
        return None
    return [(each.run, each.requirement, each.verdict, each.violations) for each in briefs]
