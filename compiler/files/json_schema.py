"""Whether a value has the form of a schema in `templates/json`: nothing missing, nothing unknown.

The only module that imports fastjsonschema.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache

import fastjsonschema

from compiler.files.templating import template_root

_EXCERPT = 60


def misfit(value: object, name: str) -> str:
    """What is wrong with a value, with its place; empty: nothing is.

    Args:
        value: of JSON.
        name: of the schema: `evidence`.
    """
    try:
        _check(name)(value)
    except fastjsonschema.JsonSchemaValueException as error:
        return _message(error)
    return ""


@cache
def _check(name: str) -> Callable[[object], object]:
    file = template_root() / "json" / f"{name}.schema.json"
    check: Callable[[object], object] = fastjsonschema.compile(json.loads(file.read_text("utf-8")))
    return check


def _message(error: fastjsonschema.JsonSchemaValueException) -> str:
    name = error.name or ""
    place = name.removeprefix("data").removeprefix(".")
    subject, about = f"`{place}`" if place else "the whole file", error.definition
    match error.rule:
        case "required":
            key = next(key for key in about["required"] if key not in error.value)
            return f"{subject} has no `{key}`"
        case "additionalProperties":
            unknown = min(key for key in error.value if key not in about["properties"])
            return f"{subject} has `{_short(unknown)}`, which is unknown"
        case "anyOf":
            return f"{subject} has none of the forms that it may have"
        case _:
            rule = error.message.removeprefix(name).strip()
            return f"{subject} {rule}{_value(error.value)}"


def _value(value: object) -> str:
    if isinstance(value, dict | list):
        return ""
    return f", and is `{_short(str(value))}`"


def _short(text: str) -> str:
    return f"{text[:_EXCERPT]}…" if len(text) > _EXCERPT else text
