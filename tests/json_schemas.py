"""JSON documents compared with the schemas that are shipped."""

import json
from functools import cache
from typing import Any

import jsonschema  # type: ignore[import-untyped]

from compiler.files.templating import template_root


def validate(name: str, content: Any) -> None:
    """Raise the worst mistake of a document, if it does not fit `templates/json/{name}`."""
    mistake = jsonschema.exceptions.best_match(_validator(name).iter_errors(content))
    if mistake is not None:
        raise mistake


@cache
def _validator(name: str) -> jsonschema.Draft202012Validator:
    # `jsonschema.validate` checks the schema each time, which takes longer than the document does.
    schema = json.loads((template_root() / "json" / name).read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)
