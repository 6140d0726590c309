"""Variables of FRET's exports as tables of `bindings.toml`.

Input is FRET's records of variables. Output is the tables `[variable.NAME]`, and the records that
are stored as they are. Source: NASA FRET v3.1, its glossary and its export of variables.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import PurePosixPath
from typing import Any

import tomli_w

from compiler.files.artifact import Artifact
from compiler.project.lustre import fretish, lustre
from fretish import expressions as e
from fretish.bindings.declarations import Role
from fretish.bindings.definitions import find_cycle
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.parser import parse_value
from fretish.printer import expression

OWN = "fretc"
"""The key in a record of `--emit fret-json` for title and text, which FRET has no fields for."""
_VARIABLE_FIELDS = frozenset(
    "_id project component_name variable_name dataType idType description reqs".split()
)
_IGNORED_FIELDS = frozenset({"modeldoc", "_rev", OWN})
KEPT = "variable"
"""The table `[[fret.variable]]`: variables of FRET that are not imported."""


def text_of(value: Any) -> str:
    """The value as text; empty for the list or null that FRET writes for no text."""
    text = value if isinstance(value, str) else "" if value in (None, [], {}) else str(value)
    return text.encode("utf-8", "replace").decode()  # half of a character is none


def variables_of(
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
        name = unquoted(text_of(record.get("variable_name")))
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
        span = Source(source.name, "").span()
        yield diagnostic("circular_assignments", span, names=" -> ".join(names[:12]))


def _variable(record: Mapping[str, Any]) -> dict[str, Any]:
    """The `[variable.NAME]` table of one record."""
    role = text_of(record.get("idType")).lower()
    written = text_of(record.get(assignment_field(role)))
    value = _value(record, written)
    fret = {
        key: _plain(value)
        for key, value in sorted(record.items())
        if key not in _VARIABLE_FIELDS | _IGNORED_FIELDS and value not in ("", None, [], {}, False)
    }
    if value is not None and (lustre(value) or "") == written:
        fret.pop(assignment_field(role), None)
    table = {
        "component": text_of(record.get("component_name")),
        "type": text_of(record.get("dataType")),
        "role": role,
        "text": text_of(record.get("description")),
        "value": "" if value is None else expression(value),
        "fret": {**fret, **_id_of_variable(record), **_of_project(record)},
    }
    return {key: value for key, value in table.items() if value}


def _id_of_variable(record: Mapping[str, Any]) -> dict[str, str]:
    """The `_id`, unless FRET derives it from the names of project, component and variable."""
    names = ("project", "component_name", "variable_name")
    id = text_of(record.get("_id"))
    return {"_id": id} if id not in ("", "".join(text_of(record.get(n)) for n in names)) else {}


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
    defines = text_of(record.get("idType")).lower() in (Role.INTERNAL, Role.MODE)
    if not defines or record.get("variable_name") == "FTP":  # FRETish's own name of the first tick
        return None
    own = record.get(OWN)
    text = text_of(own.get("value")) if isinstance(own, dict) else ""
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
    span = Source(source.name, "").span()
    return diagnostic("merged_variable", span, name=name, differences=differences)


def _plain(value: Any) -> Any:
    """The value in TOML's types; other values become JSON text."""
    if isinstance(value, str):
        return text_of(value)
    if isinstance(value, int | float):
        return value
    if isinstance(value, list) and None not in value:
        return [_plain(item) for item in value]
    if isinstance(value, dict) and None not in value.values():
        return {key: _plain(item) for key, item in value.items()}
    return json.dumps(value)


def _of_project(record: Mapping[str, Any]) -> dict[str, str]:
    project = text_of(record.get("project"))
    return {"project": project} if project else {}


def glossary(
    tables: Mapping[str, Mapping[str, Any]], kept: Sequence[Mapping[str, Any]]
) -> Iterator[Artifact]:
    """`bindings.toml` with these variables and stored records; nothing if there are none."""
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
