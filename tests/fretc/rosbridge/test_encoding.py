"""CBOR and JSON of messages: CBOR is read back by another library."""

import json
import math
from array import array
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.rosbridge.encoding import as_cbor, as_json
from tests.programs import package

values = st.recursive(
    st.one_of(
        st.none(), st.booleans(), st.integers(-(2**63), 2**64 - 1), st.floats(), st.text(),
        st.binary(),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=30), st.dictionaries(st.text(), inner, max_size=30)
    ),
    max_leaves=10,
)  # fmt: skip


def same(left: Any, right: Any) -> bool:
    if isinstance(left, float) and math.isnan(left):
        return isinstance(right, float) and math.isnan(right)
    if isinstance(left, list):
        return len(left) == len(right) and all(map(same, left, right))
    if isinstance(left, dict):
        return left.keys() == right.keys() and all(same(left[k], right[k]) for k in left)
    return type(left) is type(right) and bool(left == right)


@given(values)
def test_cbor_is_read_back_by_another_library(value: Any) -> None:
    assert same(value, package("cbor2").loads(as_cbor(value)))


@pytest.mark.parametrize(
    ("code", "tag", "size"),
    [("f", 85, 4), ("d", 86, 8), ("B", 64, 1), ("h", 77, 2), ("I", 70, 4), ("q", 79, 8)],
)
def test_an_array_has_the_tag_of_its_type(code: str, tag: int, size: int) -> None:
    data = as_cbor(array(code, [1, 2, 3]))
    assert data[:2] == bytes([0xD8, tag])
    assert data[2] == (0x40 | 3 * size if size < 8 else 0x58)
    assert data.endswith(array(code, [1, 2, 3]).tobytes())


def test_json_has_null_for_what_is_not_finite() -> None:
    message = {"ranges": array("f", [0.5, math.inf, math.nan]), "x": -math.inf, "data": b"ab"}
    assert json.loads(as_json(message)) == {"ranges": [0.5, None, None], "x": None, "data": "YWI="}


def test_what_cbor_cannot_hold_is_an_error() -> None:
    for value in (object(), 2**64):
        with pytest.raises(TypeError):
            as_cbor(value)
