"""JSON as others write it, read as it is meant; what is not certain is unknown."""

import json
from math import inf
from pathlib import Path
from typing import Any

import pytest

from fretc.logs.messages.json_messages import message_leaves, schema_leaves
from fretc.logs.messages.leaves import FieldKind, Leaf
from fretc.logs.reader import look
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code
from tests.fretc.logs.logs import MS, S, Sent, declare, recorded, times, values, write

TEXT = """
[clock]
time = "log_time"
tick = "100 ms"

[signal.s]
path = "{path}"
{more}
[proposition.p]
expr = "s < 5"
"""

NUMBER = Leaf(FieldKind.NUMBER)


def log(path: Path, payloads: list[bytes], type_: str = "Thing", schema: bytes = b"{}") -> Path:
    sent = [Sent("/j", type_, p, S + i * 100 * MS, encoding="json") for i, p in enumerate(payloads)]
    return write(path / "log.mcap", sent, definitions={type_: schema})


def reading(
    tmp_path: Path, field: str, payloads: list[Any], more: str = "", time: str = "log_time"
) -> Recording:
    raw = [p if isinstance(p, bytes) else json.dumps(p).encode() for p in payloads]
    text = TEXT.format(path=f"/j.{field}", more=more).replace("log_time", time)
    return recorded(log(tmp_path, raw), declare(text))


def found(tmp_path: Path, field: str, payloads: list[Any], more: str = "") -> list[float | None]:
    """The values of the signal; None for unknown."""
    recording = reading(tmp_path, field, payloads, more)
    return [None if value != value else value for value in values(recording, "s")]


def test_numbers_within_objects_and_arrays_are_read(tmp_path: Path) -> None:
    payloads = [{"a": {"b": [1, 2.5, -3]}}, {"a": {"b": [4]}}]
    assert found(tmp_path, "a.b[1]", payloads) == [2.5, None]
    assert found(tmp_path, "a.b[:]", payloads, 'reduce = "max"') == [2.5, 4.0]
    assert found(tmp_path, "a", [{"a": True}, {"a": -7}, {"a": 1e3}]) == [1.0, -7.0, 1000.0]


def test_what_a_message_leaves_out_or_calls_null_is_unknown_there(tmp_path: Path) -> None:
    payloads = [{"a": {"b": 1}}, {"a": {}}, {}, {"a": None}, {"a": {"b": None}}, {"a": {"b": 2}}]
    assert found(tmp_path, "a.b", payloads) == [1.0, None, None, None, None, 2.0]


def test_null_in_an_array_is_unknown_whatever_an_invalid_reading_means(tmp_path: Path) -> None:
    more = 'reduce = "min"\ninvalid = { nan = "drop", "+inf" = "far", "-inf" = "near" }'
    assert found(tmp_path, "a[:]", [{"a": [3, None]}, {"a": [3, 2]}], more) == [None, 2.0]
    assert found(tmp_path, "a[0]", [{"a": [3, None]}]) == [3.0]


@pytest.mark.parametrize("word", ["NaN", '"NaN"'])
def test_nan_is_what_the_bindings_say_of_it(tmp_path: Path, word: str) -> None:
    payload = f'{{"a": [3, {word}]}}'.encode()
    assert found(tmp_path, "a[:]", [payload], 'reduce = "min"') == [None]
    more = 'reduce = "min"\ninvalid = { nan = "drop" }'
    assert found(tmp_path, "a[:]", [payload], more) == [3.0]


@pytest.mark.parametrize("word", ["Infinity", '"Infinity"'])
def test_an_infinity_is_far_where_the_bindings_say_so(tmp_path: Path, word: str) -> None:
    payload = f'{{"a": {word}}}'.encode()
    assert found(tmp_path, "a", [payload]) == [None]
    assert found(tmp_path, "a", [payload], 'invalid = { "+inf" = "far" }') == [inf]


@pytest.mark.parametrize(
    "payload",
    [
        b"no json", b"", b"[1]", b"7", b'{"a": 1', b'{"a": 1, "a": 2}', b"\xff{}", b'{"a": 1e400}',
        b'{"a": ' + b"9" * 400 + b"}", b'{"a": ' + b"9" * 9000 + b"}",
        b'{"a": ' + b"[" * 200_000 + b"]" * 200_000 + b"}",
        b'{"a": 1}\n{"a": 2}',
    ],
    ids=range(12),
)  # fmt: skip
def test_a_payload_that_is_no_message_is_unknown_and_told(tmp_path: Path, payload: bytes) -> None:
    recording = reading(tmp_path, "a", [{"a": 1}, payload, {"a": 3}])
    assert [str(value) for value in values(recording, "s")] == ["1.0", "nan", "3.0"]
    (finding,) = recording.findings
    assert finding.code is Code.BAD_MESSAGE
    assert finding.message.startswith("1 of 3 messages of `/j` cannot be decoded")


@pytest.mark.parametrize("value", ["7", {"b": 1}, [1, 2]])
def test_what_is_no_number_is_an_error(tmp_path: Path, value: object) -> None:
    (finding,) = reading(tmp_path, "a", [{"a": 1}, {"a": value}]).findings
    assert finding.code is Code.NO_FIELD


@pytest.mark.parametrize("array", [["1"], [[1], [2]], [{"b": 1}], [1, "x"]])
def test_an_array_of_anything_else_is_an_error(tmp_path: Path, array: object) -> None:
    (finding,) = reading(tmp_path, "a[:]", [{"a": array}], 'reduce = "min"').findings
    assert (finding.code, finding.message) == (
        Code.NO_FIELD,
        "in `/j` `a` is no array of numbers",
    )


def test_a_field_that_no_message_states_is_an_error_with_the_nearest_one(tmp_path: Path) -> None:
    (finding,) = reading(tmp_path, "sped", [{"speed": 1.0}, {"speed": 2.0}]).findings
    assert finding.code is Code.NO_FIELD
    assert finding.message == "no message of `/j` states a number in `sped`"
    assert finding.help == "did you mean `speed`?"


def test_a_field_that_is_there_and_never_measured_is_no_error(tmp_path: Path) -> None:
    assert reading(tmp_path, "a", [b'{"a": NaN}']).findings == ()


@pytest.mark.parametrize(
    "message",
    [
        {"header": {"stamp": {"sec": 7, "nanosec": 5}}},
        {"header": {"stamp": {"secs": 7, "nsecs": 5}}},
        {"timestamp": {"sec": 7, "nsec": 5}},
    ],
)
def test_a_stamp_is_that_of_ros_or_of_foxglove(tmp_path: Path, message: dict[str, Any]) -> None:
    recording = reading(tmp_path, "a", [{"a": 1, **message}], time="header.stamp")
    assert times(recording, "s") == [7 * S + 5]
    assert recording.findings == ()


def test_a_schema_that_is_none_is_an_error(tmp_path: Path) -> None:
    path = log(tmp_path, [b'{"a": 1}'], schema=b"no schema")
    (finding,) = recorded(path, declare(TEXT.format(path="/j.a", more=""))).findings
    assert finding.code is Code.UNKNOWN_ENCODING
    assert "the definition of its messages cannot be read" in finding.message


def test_the_numbers_of_a_schema_are_listed_through_its_references() -> None:
    schema = {
        "$defs": {"v": {"type": "object", "properties": {"x": {"type": ["number", "null"]}}}},
        "properties": {
            "pose": {"$ref": "#/$defs/v"},
            "n": {"type": "integer"},
            "name": {"type": "string"},
            "r": {"type": "array", "items": {"type": "number"}},
            "one": {"anyOf": [{"type": "null"}, {"$ref": "#/$defs/v"}]},
            "not a name": {"type": "number"},
        },
    }
    assert schema_leaves(json.dumps(schema).encode()) == {
        "n": NUMBER,
        "name": Leaf(FieldKind.TEXT),
        "r[:]": NUMBER,
        "pose.x": NUMBER,
        "one.x": NUMBER,
    }


def test_a_schema_that_holds_itself_ends() -> None:
    schema = b'{"properties": {"x": {"type": "number"}, "next": {"$ref": "#"}}}'
    assert schema_leaves(schema) == {"x": NUMBER}
    assert schema_leaves(b'{"$ref": "#"}') == {}
    assert schema_leaves(b'{"properties": {"a": {"$ref": "#/no/where"}}, "type": 3}') == {}


def test_a_schema_whose_parts_multiply_ends() -> None:
    parts = {f"p{i}": {"$ref": "#/$defs/d{}"} for i in range(8)}
    levels = {
        f"d{n}": {"properties": {k: {"$ref": v["$ref"].format(n + 1)} for k, v in parts.items()}}
        for n in range(19)
    }
    assert schema_leaves(json.dumps({"$defs": levels, "$ref": "#/$defs/d0"}).encode()) == {}


def test_the_numbers_that_messages_hold_are_listed() -> None:
    sent = [b'{"a": {"b": 1}, "c": "x", "f": true}', b"bad", b'{"d": [1, null], "e": []}']
    assert message_leaves(sent) == {
        "a.b": NUMBER,
        "c": Leaf(FieldKind.TEXT),
        "f": Leaf(FieldKind.FLAG),
        "d[:]": NUMBER,
    }


def test_info_lists_what_the_schema_and_the_messages_tell(tmp_path: Path) -> None:
    schema = b'{"properties": {"x": {"type": "number"}}}'
    overview = look(str(log(tmp_path, [b'{"y": 1}'], schema=schema)))
    assert overview.numbers == {"/j": ("x", "y")}  # type: ignore[union-attr]
    overview = look(str(log(tmp_path, [b'{"y": 1}'], type_="")))
    assert overview.numbers == {"/j": ("y",)}  # type: ignore[union-attr]


def test_messages_without_a_schema_are_read(tmp_path: Path) -> None:
    path = log(tmp_path, [b'{"a": 1}', b'{"a": 2}'], type_="")
    recording = recorded(path, declare(TEXT.format(path="/j.a", more="")))
    assert values(recording, "s") == [1.0, 2.0]
