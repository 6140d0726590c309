"""Import of FRET's exchange formats as `.fret` files and `bindings.toml`.

The import reads what a person wrote: sentences, names, comments. It ignores FRET's formulas: an
export can contain those of an older sentence, so fretc derives formulas from the sentence. Source:
NASA FRET v3.1, its export of requirements and variables (JSON), and its import of CSV.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from pathlib import PurePosixPath
from typing import Any

import tomli_w

from compiler.files.artifact import Artifact
from compiler.files.checked_json import parsed
from compiler.project.fret_variables import OWN, glossary, text_of, variables_of
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity, did_you_mean
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import ASSUMPTION
from fretish.parser import parse
from fretish.reading.limits import with_budget

STATUSES = {"completed": "approved", "deprecated": "retired"}
"""FRET's status → the status of fretc; every other status becomes a draft."""

_FRET_FIELDS = ("project", "comments", "status", "_id", "reqid")


@dataclass(frozen=True, slots=True)
class ImportedRequirement:
    """One requirement of the export."""

    id: str
    fulltext: str
    header: Mapping[str, Any]
    project: str


@dataclass(frozen=True, slots=True)
class ImportResult:
    """The result of an import: files and diagnostics."""

    artifacts: tuple[Artifact, ...] = ()
    diagnostics: tuple[Diagnostic, ...] = ()
    requirements: int = 0
    variables: int = 0
    assumptions: int = 0
    """Number of requirements whose id makes them assumptions, as in FRET."""
    mapping: Mapping[str, str] = field(default_factory=dict)


def read_export(source: Source, columns: Mapping[str, str]) -> ImportResult:
    """Read FRET's JSON, or a CSV of any tool.

    Args:
        source: the file; `.csv` by its name, JSON otherwise.
        columns: for CSV, the names of the columns `id`, `text` and `project`.
    """
    result = with_budget(len(source.text), source.span(0, 0), lambda: _read(source, columns))
    return ImportResult((), (result,), 0, 0) if isinstance(result, Diagnostic) else result


def _read(source: Source, columns: Mapping[str, str]) -> ImportResult:
    if source.name.lower().endswith(".csv"):
        return _from_csv(source, columns)
    return _from_json(source)


# JSON ------------------------------------------------------------------------------------------


def _from_json(source: Source) -> ImportResult:
    try:
        data: Any = parsed(source.text).value
    except json.JSONDecodeError as error:
        return _failed(f"it is not JSON: {error.msg.lower()}", source, error.pos)
    except ValueError as error:  # a number of more digits than Python reads
        return _failed(f"it is not JSON: {error}", source)
    except RecursionError:
        return _failed("it is nested too deep", source)
    parts = _parts(data)
    if isinstance(parts, str):
        return _failed(parts, source)
    requirements, variables = parts
    diagnostics: list[Diagnostic] = []
    entries = list(_requirements(requirements, source, diagnostics))
    kept: list[Mapping[str, Any]] = []
    declared = variables_of(variables, source, diagnostics, kept)
    files = [*_documents(entries), *glossary(declared, kept)]
    assumed = sum("kind" in each.header for each in entries)
    return ImportResult(tuple(files), tuple(diagnostics), len(entries), len(declared), assumed)


def _parts(data: Any) -> tuple[list[Mapping[str, Any]], list[Mapping[str, Any]]] | str:
    """The requirements and the variables of an export, in any version; or the error."""
    if isinstance(data, list):
        records = _records(data)
        if len(records) < len(data):
            return "it is an array with items that are not objects"
        return (records, []) if records and "reqid" in records[0] else ([], records)
    if not isinstance(data, dict):
        return "it is neither an array nor an object"
    if "requirement" in data:  # one requirement, as FRET's external mode exports it
        data = {"requirements": [data["requirement"]], "variables": data.get("variables", [])}
    if "requirements" not in data and "variables" not in data:
        return "it has neither `requirements` nor `variables`"
    requirements, variables = data.get("requirements", []), data.get("variables", [])
    if isinstance(variables, dict):  # {"regular": [...], "modes": [...]}, or {"docs": [...]}
        variables = [record for part in variables.values() for record in _records(part)]
    return _records(requirements), _records(variables)


def _records(value: Any) -> list[Mapping[str, Any]]:
    if not isinstance(value, list):
        return []
    return [record for record in value if isinstance(record, dict)]


def _requirements(
    records: Iterable[Mapping[str, Any]], source: Source, diagnostics: list[Diagnostic]
) -> Iterator[ImportedRequirement]:
    taken: set[str] = set()
    ids: dict[tuple[str, str], str] = {}
    entries: list[tuple[str, str, Mapping[str, Any]]] = []
    for number, record in enumerate(records, 1):
        reqid, fulltext = text_of(record.get("reqid")), text_of(record.get("fulltext")).strip()
        if not fulltext:
            diagnostics.append(
                _skipped(f"requirement {number} ({reqid or 'no id'}) has no text", source)
            )
            continue
        project = text_of(record.get("project"))
        wanted = _id(reqid or f"requirement-{number}")
        id = _unique(wanted, project, taken)
        if id != wanted:
            of = f" of project {project}" if project else ""
            diagnostics.append(
                diagnostic(
                    "renamed",
                    Source(source.name, "").span(),
                    number=number,
                    which=f"{reqid}{of}",
                    id=id,
                    wanted=wanted,
                )
            )
        ids[project, reqid] = id
        entries.append((id, fulltext, record))
    for id, fulltext, record in entries:
        project, header = text_of(record.get("project")), _header(id, record, ids)
        quoted = _quoted(id, fulltext, diagnostics)
        if quoted != fulltext:
            header["fret"] = {**header.get("fret", {}), "fulltext": fulltext}
        yield ImportedRequirement(id, _unfenced(quoted), header, project)
        diagnostics.extend(_unread(id, quoted))


def _unfenced(text: str) -> str:
    """The text with each line `+++` indented, so that it does not begin a header."""
    return re.sub(r"^\ufeff?(?=\+\+\+)", " ", text, flags=re.MULTILINE)


def _quoted(id: str, fulltext: str, diagnostics: list[Diagnostic]) -> str:
    """The sentence with quotes around each name that is a key word of FRETish.

    F109 reports each of them. A sentence with other errors is imported as it is.
    """
    text, remarks = fulltext, list[Diagnostic]()
    while len(remarks) <= _MOST_QUOTED:
        mistake = parse(Source(f"{id} (fulltext)", text).span())
        if not isinstance(mistake, Diagnostic):
            diagnostics.extend(remarks)
            return text
        span = mistake.span
        if mistake.code is not Code.RESERVED or span is None:
            break
        text = f'{text[: span.start]}"{span.text}"{text[span.end :]}'
        remarks.append(diagnostic("key_word_quoted", span, word=span.text))
    return fulltext


_MOST_QUOTED = 20


def _header(
    id: str, record: Mapping[str, Any], ids: Mapping[tuple[str, str], str]
) -> dict[str, Any]:
    """The `.fret` header; fields that fretc does not use go below `fret`."""
    fret = {key: text_of(record.get(key)) for key in _FRET_FIELDS}
    if fret["reqid"] == id:
        del fret["reqid"]
    parent_text = text_of(record.get("parent_reqid"))
    names = [part.strip() for part in parent_text.split(",") if part.strip()]
    parents = [ids.get((fret["project"], name), name) for name in names]
    if ", ".join(parents) != parent_text:
        fret["parent_reqid"] = parent_text
    own = record.get(OWN)
    own_texts = (
        {name: text_of(own.get(name)) for name in ("title", "text")}
        if isinstance(own, dict)
        else {}
    )
    header: dict[str, Any] = {
        "id": id,
        "kind": ASSUMPTION if ASSUMPTION in text_of(record.get("reqid")).lower() else "",
        **own_texts,
        "parents": parents,
        "rationale": text_of(record.get("rationale")),
        "status": STATUSES.get(fret["status"], "draft"),
        "fret": {key: value for key, value in fret.items() if value},
    }
    return {key: value for key, value in header.items() if value not in ("", [], {})}


def _unread(id: str, fulltext: str) -> Iterator[Diagnostic]:
    """A warning if the imported sentence is not FRETish; it is imported unchanged."""
    source = Source(f"{id} (fulltext)", fulltext)
    if re.fullmatch(r'"[^"]*"', fulltext):
        return
    tree = parse(source.span())
    if isinstance(tree, Diagnostic):
        yield Diagnostic(tree.code, tree.message, tree.span, tree.help, Severity.WARNING)


def _id(text: str) -> str:
    """The text with all characters replaced that an id must not have."""
    cleaned = re.sub(r"[^A-Za-z0-9_.-]+", "-", text).strip("-._")
    return cleaned or "requirement"


def _unique(id: str, project: str, taken: set[str]) -> str:
    """A unique id: ids of fretc are unique without case, FRET's only within a project."""
    candidates = [id, f"{_id(project)}-{id}" if project else f"{id}-2"]
    candidates += [f"{id}-{n}" for n in range(2, len(taken) + 3)]
    free = next(c for c in candidates if c.lower() not in taken)
    taken.add(free.lower())
    return free


def _documents(requirements: Sequence[ImportedRequirement]) -> Iterator[Artifact]:
    """One `.fret` file for each project."""
    by_project: dict[str, list[ImportedRequirement]] = {}
    for requirement in requirements:
        by_project.setdefault(requirement.project, []).append(requirement)
    taken: set[str] = set()
    for project, members in sorted(by_project.items()):
        text = "\n".join(_pair(member) for member in members)
        name = _unique(_id(project or "requirements").lower(), "", taken)
        yield Artifact(PurePosixPath(f"{name}.fret"), text)


def _pair(requirement: ImportedRequirement) -> str:
    return f"+++\n{tomli_w.dumps(requirement.header)}+++\n{requirement.fulltext}\n"


# CSV -------------------------------------------------------------------------------------------

_GUESSES = {
    "id": ("id", "reqid", "requirement id", "requirement", "req id", "identifier", "key"),
    "text": ("fulltext", "text", "description", "requirement text", "summary", "statement"),
    "project": ("project", "module", "component"),
}


def _from_csv(source: Source, columns: Mapping[str, str]) -> ImportResult:
    delimiter = _delimiter(source.text)
    try:
        reader = csv.DictReader(
            io.StringIO(source.text), restkey="", strict=True, delimiter=delimiter
        )
        rows = list(reader)
        names = [name for name in reader.fieldnames or () if name]
    except csv.Error as error:
        return _failed(f"it is not CSV: {error}", source)
    if not rows:
        return _failed(
            "it has a header, but no rows" if source.text.strip() else "it is empty", source
        )
    chosen = _columns(names, columns, source)
    if isinstance(chosen, Diagnostic):
        return ImportResult((), (chosen,))
    diagnostics: list[Diagnostic] = []
    entries = list(_requirements((_row(row, chosen) for row in rows), source, diagnostics))
    files, assumed = tuple(_documents(entries)), sum("kind" in each.header for each in entries)
    return ImportResult(files, tuple(diagnostics), len(entries), 0, assumed, chosen)


_DELIMITERS = ",;\t"


def _delimiter(text: str) -> str:
    """The delimiter that splits the header into the most columns: comma, semicolon or tab.

    Spreadsheets write semicolons where the decimal separator is a comma. If two delimiters split it
    alike, the first one counts.
    """

    def columns(delimiter: str) -> int:
        try:
            return len(next(csv.reader(io.StringIO(text), delimiter=delimiter), ()))
        except csv.Error:
            return 0

    return max(_DELIMITERS, key=columns)


def _columns(
    names: Sequence[str], options: Mapping[str, str], source: Source
) -> dict[str, str] | Diagnostic:
    """The names of the columns, as requested or recognized."""
    chosen: dict[str, str] = {}
    for part, guesses in _GUESSES.items():
        wanted = options.get(part)
        if wanted is not None and wanted not in names:
            return _bad(
                f"there is no column `{wanted}`",
                source,
                did_you_mean(wanted, names, f"there are {', '.join(names)}"),
            )
        by_name = {name.strip().lower(): name for name in reversed(names) if name}
        guess = next((by_name[g] for g in guesses if g in by_name), None)
        if wanted or guess:
            chosen[part] = wanted or str(guess)
    if "text" not in chosen:
        return _bad(
            "no column looks like the text of a requirement",
            source,
            f"name it with `--text-column`; there are {', '.join(names)}",
        )
    return chosen


def _row(row: Mapping[str | None, Any], chosen: Mapping[str, str]) -> dict[str, Any]:
    """The row as a FRET record; text that is not FRETish is quoted, and kept as free text."""
    text = text_of(row.get(chosen["text"])).strip()
    if text and isinstance(parse(Source("row", text).span()), Diagnostic):
        text = '"' + text.replace('"', "'") + '"'
    chosen_names = set(chosen.values())
    rest = [
        f"{name}: {value}"
        for name, value in row.items()
        if name and name not in chosen_names and value
    ]
    return {
        "reqid": row.get(chosen.get("id", "")),
        "project": row.get(chosen.get("project", "")),
        "fulltext": text,
        "rationale": "\n".join(rest),
    }


# Mistakes --------------------------------------------------------------------------------------


def _failed(why: str, source: Source, at: int = 0) -> ImportResult:
    return ImportResult((), (_bad(why, source, "use an export of FRET (JSON), or a CSV file", at),))


def _bad(why: str, source: Source, fix: str, at: int = 0) -> Diagnostic:
    return diagnostic(
        "export_not_imported",
        source.span(at, min(at + 1, len(source.text))),
        source=source.name,
        why=why,
        help=fix,
    )


def _skipped(why: str, source: Source) -> Diagnostic:
    return diagnostic("left_out_of_import", Source(source.name, "").span(), why=why)
