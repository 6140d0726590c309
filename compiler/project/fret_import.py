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
from dataclasses import dataclass, field
from itertools import chain
from pathlib import PurePosixPath
from typing import Any

import tomli_w

from compiler.files.artifact import Artifact
from compiler.files.checked_json import parsed
from compiler.project.lustre import fretish, lustre
from fretish import expressions as e
from fretish.bindings.declarations import Role
from fretish.bindings.definitions import find_cycle
from fretish.diagnostics.diagnostic import Diagnostic, Severity, did_you_mean
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.parser import parse, parse_value
from fretish.printer import expression
from fretish.reading.limits import with_budget

STATUSES = {"completed": "approved", "deprecated": "retired"}
"""FRET's status → the status of fretc; every other status becomes a draft."""

OWN = "fretc"
"""The key in a record of `--emit fret-json` for title and text, which FRET has no fields for."""
_FRET_FIELDS = ("project", "comments", "status", "_id", "reqid")
_VARIABLE_FIELDS = frozenset(
    "_id project component_name variable_name dataType idType description reqs".split()
)
_IGNORED_FIELDS = frozenset({"modeldoc", "_rev", OWN})
KEPT = "variable"
"""The table `[[fret.variable]]`: variables of FRET that are not imported."""


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
    declared = _variables(variables, source, diagnostics, kept)
    files = [*_documents(entries), *_glossary(declared, kept)]
    return ImportResult(tuple(files), tuple(diagnostics), len(entries), len(declared))


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
        reqid, fulltext = _text(record.get("reqid")), _text(record.get("fulltext")).strip()
        if not fulltext:
            diagnostics.append(
                _skipped(f"requirement {number} ({reqid or 'no id'}) has no text", source)
            )
            continue
        project = _text(record.get("project"))
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
        project = _text(record.get("project"))
        yield ImportedRequirement(id, _unfenced(fulltext), _header(id, record, ids), project)
        diagnostics.extend(_unread(id, fulltext))


def _unfenced(text: str) -> str:
    """The text with each line `+++` indented, so that it does not begin a header."""
    return re.sub(r"^\ufeff?(?=\+\+\+)", " ", text, flags=re.MULTILINE)


def _header(
    id: str, record: Mapping[str, Any], ids: Mapping[tuple[str, str], str]
) -> dict[str, Any]:
    """The `.fret` header; fields that fretc does not use go below `fret`."""
    fret = {key: _text(record.get(key)) for key in _FRET_FIELDS}
    if fret["reqid"] == id:
        del fret["reqid"]
    parent_text = _text(record.get("parent_reqid"))
    names = [part.strip() for part in parent_text.split(",") if part.strip()]
    parents = [ids.get((fret["project"], name), name) for name in names]
    if ", ".join(parents) != parent_text:
        fret["parent_reqid"] = parent_text
    own = record.get(OWN)
    own_texts = (
        {name: _text(own.get(name)) for name in ("title", "text")} if isinstance(own, dict) else {}
    )
    header: dict[str, Any] = {
        "id": id,
        **own_texts,
        "parents": parents,
        "rationale": _text(record.get("rationale")),
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


def _text(value: Any) -> str:
    """The value as text; empty for the list or null that FRET writes for no text."""
    text = value if isinstance(value, str) else "" if value in (None, [], {}) else str(value)
    return text.encode("utf-8", "replace").decode()  # half of a character is none


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


# Variables -------------------------------------------------------------------------------------


def _variables(
    records: Iterable[Mapping[str, Any]],
    source: Source,
    diagnostics: list[Diagnostic],
    kept: list[Mapping[str, Any]],
) -> dict[str, dict[str, Any]]:
    """The tables `[variable.NAME]`; names belong to the folder, not to a project.

    The meaning of a name for another component is a table `of` that component. Of several variables
    with the same name and component the first is read; F530 names the differences of the others.

    Args:
        records: the records of the export.
        source: the export.
        diagnostics: the list that receives diagnostics.
        kept: the list that receives records that are not read: FRET's models, and further records
            of a variable.
    """
    tables: dict[str, dict[str, Any]] = {}
    components: dict[str, dict[str, dict[str, Any]]] = {}
    for record in records:
        name = unquoted(_text(record.get("variable_name")))
        if not name or record.get("modeldoc") is True:
            kept.append(_record(record))
            continue
        table = _variable(record)
        component = table.get("component", "")
        first = tables.setdefault(name, table)
        if component and component != first.get("component", ""):
            own = {key: value for key, value in table.items() if key != "component"}
            first, table = components.setdefault(name, {}).setdefault(component, own), own
        if first != table:
            kept.append(_record(record))
            diagnostics.append(_merged(name, first, table, source))
    for component in ("", *dict.fromkeys(chain.from_iterable(components.values()))):
        own = {name: components.get(name, {}).get(component, tables[name]) for name in tables}
        diagnostics.extend(_without_circles(own, source))
    return {
        name: {**table, "of": components[name]} if name in components else table
        for name, table in tables.items()
    }


def unquoted(name: str) -> str:
    """The name without the quotes that FRET keeps; in a sentence `"T"` is `T`."""
    return name[1:-1] if re.fullmatch(r'"[^"\n]+"', name) else name


def _without_circles(tables: Mapping[str, dict[str, Any]], source: Source) -> Iterator[Diagnostic]:
    """F342 for variables with circular assignments; each keeps its assignment as text."""
    values: dict[str, e.Expression] = {}
    for name, table in tables.items():
        value = parse_value(Source(name, table.get("value", "")).span())
        if not isinstance(value, Diagnostic):
            values[name] = value
    while names := find_cycle(values):
        for name in dict.fromkeys(names):
            table = tables[name]
            kept = {assignment_field(table["role"]): lustre(values.pop(name)) or ""}
            table["fret"] = kept | table.get("fret", {})
            del table["value"]
        place = Source(source.name, "").span()
        yield diagnostic("circular_assignments", place, names=" -> ".join(names[:12]))


def _variable(record: Mapping[str, Any]) -> dict[str, Any]:
    """The `[variable.NAME]` table of one record."""
    role = _text(record.get("idType")).lower()
    written = _text(record.get(assignment_field(role)))
    value = _value(record, written)
    fret = {
        key: _plain(value)
        for key, value in sorted(record.items())
        if key not in _VARIABLE_FIELDS | _IGNORED_FIELDS and value not in ("", None, [], {}, False)
    }
    if value is not None and (lustre(value) or "") == written:
        fret.pop(assignment_field(role), None)
    table = {
        "component": _text(record.get("component_name")),
        "type": _text(record.get("dataType")),
        "role": role,
        "text": _text(record.get("description")),
        "value": "" if value is None else expression(value),
        "fret": {**fret, **_id_of_variable(record), **_of_project(record)},
    }
    return {key: value for key, value in table.items() if value}


def _id_of_variable(record: Mapping[str, Any]) -> dict[str, str]:
    """The `_id`, unless FRET derives it from the names of project, component and variable."""
    names = ("project", "component_name", "variable_name")
    id = _text(record.get("_id"))
    return {"_id": id} if id not in ("", "".join(_text(record.get(n)) for n in names)) else {}


def _record(record: Mapping[str, Any]) -> dict[str, Any]:
    """FRET's record of a variable as TOML values."""
    ignored = {"_rev", OWN}
    return {k: _plain(v) for k, v in record.items() if k not in ignored and v is not None}


def assignment_field(role: str) -> str:
    """The field of FRET for the assignment of a variable; modes have a different one."""
    return "modeRequirement" if role == Role.MODE else "assignment"


def _value(record: Mapping[str, Any], written: str) -> e.Expression | None:
    """The assignment of a variable, as fretc wrote it if FRET's copy still agrees.

    None if it has no assignment, as inputs and outputs, or the assignment has no equivalent in
    FRETish.
    """
    defines = _text(record.get("idType")).lower() in (Role.INTERNAL, Role.MODE)
    if not defines or record.get("variable_name") == "FTP":  # FRETish's own name of the first tick
        return None
    own = record.get(OWN)
    text = _text(own.get("value")) if isinstance(own, dict) else ""
    value = parse_value(Source(f"{OWN}.value", text).span()) if text else None
    if isinstance(value, Diagnostic) or value is None or (lustre(value) or "") != written:
        return fretish(written)
    return value


def _merged(
    name: str, first: Mapping[str, Any], second: Mapping[str, Any], source: Source
) -> Diagnostic:
    lost = [
        key
        for key in ("component", "type", "role", "text", "value")
        if first.get(key) != second.get(key)
    ]
    fields, second_fields = first.get("fret", {}), second.get("fret", {})
    lost += sorted(
        key
        for key in {*fields, *second_fields} - {"_id"}
        if fields.get(key) != second_fields.get(key)
    )
    differences = ", ".join(
        f"{key} `{second.get(key, second_fields.get(key, ''))}`" for key in lost
    )
    place = Source(source.name, "").span()
    return diagnostic("merged_variable", place, name=name, differences=differences)


def _plain(value: Any) -> Any:
    """The value in TOML's types; other values become JSON text."""
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, int | float):
        return value
    if isinstance(value, list) and None not in value:
        return [_plain(item) for item in value]
    if isinstance(value, dict) and None not in value.values():
        return {key: _plain(item) for key, item in value.items()}
    return json.dumps(value)


def _of_project(record: Mapping[str, Any]) -> dict[str, str]:
    project = _text(record.get("project"))
    return {"project": project} if project else {}


def _glossary(
    tables: Mapping[str, Mapping[str, Any]], kept: Sequence[Mapping[str, Any]]
) -> Iterator[Artifact]:
    if tables or kept:
        content: dict[str, Any] = {"variable": {name: dict(t) for name, t in tables.items()}}
        content |= {"fret": {KEPT: [dict(record) for record in kept]}} if kept else {}
        text = (
            "# The variables of the requirements, as FRET's glossary has them. To audit logs,\n"
            "# declare a [clock], and bind each variable by a [proposition.NAME] over signals.\n\n"
        )
        yield Artifact(
            PurePosixPath("bindings.toml"),
            text + tomli_w.dumps(content),
        )


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
    return ImportResult(tuple(_documents(entries)), tuple(diagnostics), len(entries), 0, chosen)


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
    text = _text(row.get(chosen["text"])).strip()
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
