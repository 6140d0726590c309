"""Stores of earlier versions: folders of Parquet tables. They are read, and never written.

The extra `parquet` is needed. Nothing in the tables is trusted: they are compared with the
manifest, and results with the counts that the tables state.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

from compiler.files.checked_json import SchemaError
from compiler.files.checked_json import plain as parsed
from compiler.files.records import UNSET, Count, Record, Sha256, UnsetType, decoded, types
from compiler.files.text_files import open_regular, sha256
from compiler.files.text_files import read as read_text
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.result_summaries import summary_of
from fretc.audit.evidence.schema import SCHEMA as EVIDENCE
from fretc.audit.evidence.schema import (
    BindingsRecord,
    EvidenceDocument,
    Hashes,
    RequirementRecord,
    Result,
    Selection,
)
from fretc.audit.store.container import LARGEST, bad_store
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import unless_installed

SCHEMA = "fretc-store-1"
MANIFESTS = ("manifest.json", "unfinished.json")
_OTHERS = ("reuse.json", "unfinished-reuse.json")
_MOST_VALUES = 2**25
"""The most values of a column of a table, with nested ones."""
_TABLES = ("results", "events", "violations", "samples", "runs")
_FOLDERS = (*_TABLES, "register")
_OWN = re.compile(r"[0-9a-f]{32}\.parquet|\.[0-9a-f]{32}\.parquet\.[0-9a-f]{8}\.tmp")
_COMPARED = ("run", "requirement", "verdict", "violations", "judgement")
_WORDS = {float("inf"): "+inf", float("-inf"): "-inf"}


class _Table(Record, frozen=True):
    sha256: Sha256
    size: Count
    rows: Count


class _Part(Record, frozen=True):
    runs: Count
    results: Count
    tables: dict[str, _Table]


class _Manifest(Record, frozen=True):
    schema: Literal["fretc-store-1"]
    fretc: str
    bindings: BindingsRecord
    requirements: tuple[RequirementRecord, ...]
    confidence: float | None
    parts: tuple[_Part, ...]
    register: _Table | UnsetType = UNSET
    probabilities: tuple[Estimated, ...] | UnsetType = UNSET
    selection: Selection | UnsetType = UNSET


def is_store(folder: Path) -> bool:
    """Whether an earlier fretc has written into a folder."""
    if any((folder / table).is_symlink() for table in _FOLDERS):
        return False  # a link leads out of this folder
    return any(_is_manifest(folder / name) for name in MANIFESTS)


def _is_manifest(path: Path) -> bool:
    try:
        with open_regular(path) as file:
            return SCHEMA.encode() in file.read(200)
    except OSError:
        return False


def remove_tables(folder: Path) -> None:
    """Remove the files that an earlier fretc has written into a folder."""
    if not is_store(folder):
        return
    for name in (*MANIFESTS, *_OTHERS):
        (folder / name).unlink(missing_ok=True)
    for table in _FOLDERS:
        for path in (folder / table).glob("*"):
            if _OWN.fullmatch(path.name):
                path.unlink()
        with suppress(OSError):  # there is none, or it is not empty
            (folder / table).rmdir()


def read(path: str) -> EvidenceFile | Diagnostic:
    """The whole store in memory; its identity is the SHA-256 of its manifest."""
    need = f"the store `{path}` has Parquet tables of an earlier fretc: they need"
    absent = unless_installed(need, ["pyarrow"], "parquet")
    if absent is not None:
        return absent
    source = read_text(f"{path}/{MANIFESTS[0]}")
    if isinstance(source, Diagnostic):
        return source
    try:
        manifest = decoded(parsed(source.text), _Manifest)
        parts = [_results(Path(path), part) for part in manifest.parts]
    except (SchemaError, OSError) as error:
        return bad_store(path, f"cannot be read: {error}")
    except (LookupError, TypeError, ValueError, AttributeError):
        return bad_store(path, "cannot be read: it has other tables than an earlier fretc wrote")
    document = EvidenceDocument(
        schema=EVIDENCE,
        fretc=manifest.fretc,
        bindings=manifest.bindings,
        requirements=manifest.requirements,
        results=tuple(result for part in parts for result in part),
        probabilities=manifest.probabilities,
        selection=manifest.selection,
    )
    return EvidenceFile(str(Path(path)), sha256(source.text), document)


def _results(folder: Path, part: _Part) -> list[Result]:
    tables = {name: _rows(folder / name, part.tables.get(name)) for name in _TABLES}
    main, events, runs = tables["results"], tables["events"], tables["runs"]
    if (len(main), len(events), len(runs)) != (part.results, part.results, part.runs):
        raise SchemaError("a table does not have the rows that the manifest says")
    windows = {row["violation_row"]: row for row in tables["samples"]}
    violations: list[list[Any]] = [[] for _ in main]
    for n, row in enumerate(tables["violations"]):
        _at(violations, row["result_row"]).append({**row, "window": windows.get(n)})
    results, last = [], None
    for row, more, broken in zip(main, events, violations, strict=True):
        run = _at(runs, row["run_row"])
        course = None if row["run_row"] == last else run["course"]
        last = row["run_row"]
        results.append(_result(row, {**more, "course": course}, run, broken))
    return results


def _at(rows: Sequence[Any], number: object) -> Any:
    if not isinstance(number, int) or not 0 <= number < len(rows):
        raise SchemaError("a table names a row that another one does not have")
    return rows[number]


def _result(
    row: Mapping[str, Any], more: Mapping[str, Any], run: Mapping[str, Any], broken: Sequence[Any]
) -> Result:
    """A result from its rows in `results`, `events`, `runs` and `violations`.

    Raises:
        SchemaError: they contradict each other.
    """
    if row["exact"] is not None:
        result = decoded(parsed(row["exact"]), Result)
    else:
        hashes = {name: row[f"{name}_sha256"] for name in Hashes.__struct_fields__}
        own = {"hashes": hashes, "violations": broken, "health": run, "labels": run["labels"]}
        record = {**row, **more, **own}
        result = decoded(_plain(types.type_info(Result), record), Result)
    known = summary_of(result)
    if any(row[name] != getattr(known, name) for name in _COMPARED):
        raise SchemaError("the counts in `results` differ from the other tables")
    return result


def _rows(folder: Path, table: _Table | None) -> list[dict[str, Any]]:
    """The rows of a table that is the one in the manifest.

    Raises:
        SchemaError: it is not.
        OSError: it cannot be read.
    """
    import pyarrow
    from pyarrow.parquet import ParquetFile

    if table is None or table.size > LARGEST:
        raise SchemaError("a table is missing, or larger than any that fretc writes")
    path = folder / f"{table.sha256[:32]}.parquet"
    if folder.is_symlink() or path.is_symlink():
        raise SchemaError(f"`{path}` is a link")
    with open_regular(path) as file:
        data = file.read(table.size + 1)
    if hashlib.sha256(data).hexdigest() != table.sha256:
        raise SchemaError(f"`{path}` is not the file that the manifest names")
    try:
        with ParquetFile(pyarrow.BufferReader(data)) as parquet:
            about = parquet.metadata
            groups = [about.row_group(number) for number in range(about.num_row_groups)]
            chunks = [group.column(n) for group in groups for n in range(group.num_columns)]
            if sum(group.total_byte_size for group in groups) > LARGEST or any(
                chunk.num_values > _MOST_VALUES for chunk in chunks
            ):
                raise SchemaError("a table is larger in memory than any that fretc writes")
            rows: list[dict[str, Any]] = parquet.read(use_threads=False).to_pylist()
            return rows
    except (pyarrow.ArrowException, OSError) as error:
        raise SchemaError(f"a table is damaged: {str(error).splitlines()[0]}") from None


# Values ------------------------------------------------------------------------------------------


def _plain(kind: Any, value: Any) -> Any:
    """The value of evidence that a column holds, by its type: null is a key that is left out."""
    while isinstance(kind, types.Metadata):
        kind = kind.type
    match kind:
        case types.UnionType(types=kinds):
            return _one_of(kinds, value)
        case _ if value is None:
            return None
        case types.StructType(fields=fields) | types.DataclassType(fields=fields):
            return dict(_fields(fields, value))
        case types.VarTupleType(item_type=item):
            return [_plain(item, each) for each in value]
        case types.TupleType(item_types=items):
            return [_plain(item, value[f"{n}"]) for n, item in enumerate(items, 1)]
        case types.DictType(value_type=item):
            if len(dict(value)) != len(value):
                raise SchemaError("a name occurs twice")
            return {name: _plain(item, each) for name, each in value}
        case _:
            return value


def _fields(fields: Sequence[Any], value: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for field in fields:
        each = _plain(field.type, value.get(field.encode_name))
        if field.required or each is not None:
            yield field.encode_name, each


def _one_of(kinds: Sequence[Any], value: Any) -> Any:
    if isinstance(value, dict) and value.keys() == {"number", "word"}:
        return value["number"] if value["word"] is None else value["word"]
    if isinstance(value, float):
        return _WORDS.get(value, value)
    inner = [each for each in kinds if not isinstance(each, types.NoneType)]
    return _plain(inner[0], value) if value is not None and len(inner) == 1 else value
