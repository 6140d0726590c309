import json
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from compiler.files.templating import to_json

SCALARS = st.none() | st.booleans() | st.integers() | st.text(max_size=60) | st.floats(
    allow_nan=False, allow_infinity=False
)  # fmt: skip
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=9), inner),
    max_leaves=20,
)


def by_definition(value: Any, indent: str = "") -> str:
    line = json.dumps(value)
    if len(line) + len(indent) <= 100 or not isinstance(value, dict | list):
        return line
    inner = f"{indent}  "
    if isinstance(value, dict):
        parts = [f"{json.dumps(key)}: {by_definition(each, inner)}" for key, each in value.items()]
    else:
        parts = [by_definition(each, inner) for each in value]
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    return opening + f"\n{inner}" + f",\n{inner}".join(parts) + f"\n{indent}" + closing


@given(VALUES)
@example(["x" * 96])
@example(["x" * 97])
@example([["x" * 92]])
@example([["x" * 93]])
@example({"a\n\ud800é": [True, 1, 1.0, -0.0, 1e300, None, {}, []] * 9})
def test_what_fits_on_a_line_stands_on_one(value: Any) -> None:
    assert to_json(value) == by_definition(value)


@pytest.mark.parametrize("number", [float("nan"), float("inf")])
def test_json_has_no_number_that_is_none(number: float) -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        to_json([number])
