"""The JSON Schemas that are shipped are those of the types."""

import json
from typing import Any

import jsonschema  # type: ignore[import-untyped]
import pytest

from compiler.files.templating import template_root, to_json
from compiler.logic import claims
from fretc.analysis import evidence, findings
from fretc.audit.evidence import schema
from fretc.coverage import mutation_record, record
from fretc.testing import suite
from fretc.testing.conformance import findings as conformance
from fretc.watch import json_lines

SCHEMAS = {"evidence": schema.schema(), "verification": claims.schema()}
SCHEMAS |= {"analysis": findings.schema()}
SCHEMAS |= {"analyzed-set": evidence.schema(), "tests": suite.schema()}
SCHEMAS |= {"coverage": record.schema(), "mutation": mutation_record.schema()}

SCHEMAS |= {"watch": json_lines.schema()}
SCHEMAS |= {"conformance": conformance.schema()}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "made"), SCHEMAS.items())
def test_a_schema_is_that_of_its_types(
    name: str, made: dict[str, Any], request: pytest.FixtureRequest
) -> None:
    text = f"{to_json(made)}\n"
    file = template_root() / "json" / f"{name}.schema.json"
    if request.config.getoption("--update-golden"):
        file.write_text(text, encoding="utf-8")
    assert file.read_text("utf-8") == text, "pytest --update-golden writes it anew"
    jsonschema.Draft202012Validator.check_schema(json.loads(text))
