"""The JSON form of the report says what its schema says, field by field."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import NoneType
from typing import Any, get_args, get_origin, get_type_hints

import pytest

from fretc.report.model import views
from fretc.report.model.results import ResultRow, ResultView

ROOT = Path(__file__).parents[4]
SCHEMA = json.loads((ROOT / "templates/json/report.schema.json").read_text("utf-8"))


WHOLE = {ResultRow: ResultView, views.RunSummary: views.RunView}
"""What the report has in rows → what its JSON form has of it."""


def within(view: Any) -> Iterator[Any]:
    """Every dataclass of a field, whatever module it is in."""
    for hint in get_type_hints(view).values():
        waiting = [hint]
        for each in waiting:  # grows while it is read
            each = WHOLE.get(each, each)
            waiting += get_args(each)
            if is_dataclass(each):
                yield each


def reached() -> list[Any]:
    """The report and all that is in it."""
    classes: dict[Any, None] = {views.ReportView: None}
    for view in (waiting := [views.ReportView]):
        for each in within(view):
            if each not in classes:
                classes[each] = None
                waiting.append(each)
    return sorted(classes, key=lambda view: str(view.__name__))


VIEWS = reached()
PLAIN = {str: "string", int: "integer", float: "number", bool: "boolean", NoneType: "null"}


@pytest.mark.parametrize("view", VIEWS, ids=lambda view: str(view.__name__))
def test_the_schema_has_each_field_of_each_view_and_demands_it(view: Any) -> None:
    schema = SCHEMA if view is views.ReportView else SCHEMA["$defs"][view.__name__]
    names = sorted(field.name for field in fields(view))
    assert sorted(schema["properties"]) == names
    assert sorted(schema["required"]) == names
    assert schema["additionalProperties"] is False


def test_the_schema_has_no_more_than_the_views() -> None:
    assert {*SCHEMA["$defs"], "ReportView"} == {view.__name__ for view in VIEWS}
    assert SCHEMA["$id"] == SCHEMA["properties"]["schema"]["const"] == views.SCHEMA


def shapes(schema: Any) -> set[str]:
    """What a value may be: a type of JSON, or the name of a view."""
    if "$ref" in schema:
        return {schema["$ref"].removeprefix("#/$defs/")}
    if "const" in schema or "enum" in schema:
        known = [schema["const"]] if "const" in schema else schema["enum"]
        return {PLAIN[type(value)] for value in known}
    if "anyOf" in schema or "oneOf" in schema:
        return {
            shape for each in schema.get("anyOf", schema.get("oneOf")) for shape in shapes(each)
        }
    types = schema["type"]
    return set(types) if isinstance(types, list) else {types}


def meant(hint: Any) -> set[str]:
    """The same, of a field."""
    origin = get_origin(hint)
    if origin is tuple:
        return {"array"}
    if origin is Mapping:
        return {"object"}
    if origin is not None:
        return {shape for each in get_args(hint) for shape in meant(each)}
    return {PLAIN.get(hint, getattr(WHOLE.get(hint, hint), "__name__", ""))}


@pytest.mark.parametrize("view", VIEWS, ids=lambda view: str(view.__name__))
def test_the_schema_gives_each_field_its_type(view: Any) -> None:
    schema = SCHEMA if view is views.ReportView else SCHEMA["$defs"][view.__name__]
    for name, hint in get_type_hints(view).items():
        shape = schema["properties"][name]
        assert shapes(shape) == meant(hint), name
        element = next(iter(get_args(hint)), None)
        if get_origin(hint) is tuple and get_args(hint)[1:] == (...,):
            assert shapes(shape["items"]) == meant(element), name
