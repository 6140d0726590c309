from dataclasses import replace
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from mcap.records import Channel, Schema

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages.decoding import shape
from fretc.logs.messages.definitions import DefinitionError, MessageField, types
from tests.effort import examples


def number(name: str, type_: str) -> MessageField:
    return MessageField(name, type_, many=False, count=None)


def array(name: str, type_: str, count: int | None = None) -> MessageField:
    return MessageField(name, type_, many=True, count=count)


def fields(text: str, *, ros1: bool = False) -> tuple[MessageField, ...]:
    return types("one/T", text, ros1=ros1)["one/T"]


BOTH = pytest.mark.parametrize("ros1", [False, True])


@BOTH
def test_fields_stand_in_their_order_without_comments_and_constants(*, ros1: bool) -> None:
    text = """
# a comment
float64 x
  # one that is indented
int32 LIMIT=5
int32 OTHER = 6  # with a comment
string NAME="a#b"
float64 y # a comment
float64 z  # this = that
"""
    assert fields(text, ros1=ros1) == tuple(number(name, "float64") for name in "xyz")


def test_ros_2_has_defaults_and_bounds() -> None:
    text = """
float64 x 1.5
string<=10 name "a b"
int32[<=5] some [1, 2]
float64[36] covariance
string<=3[<=2] names
bool[] flags
"""
    assert fields(text) == (
        number("x", "float64"),
        number("name", "string"),
        array("some", "int32"),
        array("covariance", "float64", 36),
        array("names", "string"),
        array("flags", "bool"),
    )


def test_white_space_may_be_of_any_kind_and_length() -> None:
    assert fields("\r\nfloat64\t x\r\n  int32   y  \r\n\r\n") == (
        number("x", "float64"),
        number("y", "int32"),
    )


def test_char_and_byte_are_what_each_decoder_takes_them_for() -> None:
    assert fields("char a\nbyte b") == (number("a", "int8"), number("b", "uint8"))
    assert fields("char a\nbyte b", ros1=True) == (number("a", "uint8"), number("b", "int8"))


NESTED = """two/A a
B b
two/A[3] many
====
MSG: two/A
B b
=====
MSG: two/B
int8 x
===
MSG: one/B
int16 x
"""


@BOTH
@pytest.mark.parametrize("msg", ["", "msg/"])
def test_a_type_without_a_package_is_of_the_package_around_it(msg: str, *, ros1: bool) -> None:
    text = NESTED.replace("MSG: two/", f"MSG: two/{msg}").replace("MSG: one/", f"MSG: one/{msg}")
    found = types(f"one/{msg}T", text, ros1=ros1)
    assert found["one/T"] == (
        number("a", "two/A"),
        number("b", "one/B"),
        array("many", "two/A", 3),
    )
    assert found["two/A"] == (number("b", "two/B"),)
    assert (found["two/B"], found["one/B"]) == ((number("x", "int8"),), (number("x", "int16"),))


def test_ros_1_knows_times_and_the_header_without_their_packages() -> None:
    text = "Header header\ntime t\nduration d\ntime[] many\n===\nMSG: std_msgs/Header\nuint32 seq"
    found = types("one/T", text, ros1=True)
    assert found["one/T"] == (
        number("header", "std_msgs/Header"),
        number("t", "time"),
        number("d", "duration"),
        array("many", "time"),
    )
    assert found["time"] == (number("secs", "uint32"), number("nsecs", "uint32"))
    assert found["duration"] == (number("secs", "int32"), number("nsecs", "int32"))


def test_an_array_of_headers_is_of_the_package_around_it() -> None:
    text = "Header[] many\n===\nMSG: one/Header\nfloat64 x"
    assert fields(text, ros1=True) == (array("many", "one/Header"),)


TIME = "builtin_interfaces/Time t\nbuiltin_interfaces/Duration d\n"


def test_times_of_ros_2_are_unsigned_where_they_are_not_defined() -> None:
    found = types("one/T", TIME, ros1=False)
    for name in ("Time", "Duration"):
        assert found[f"builtin_interfaces/{name}"] == (
            number("sec", "uint32"),
            number("nanosec", "uint32"),
        )


def test_times_of_ros_2_are_what_the_definition_says() -> None:
    text = TIME + "===\nMSG: builtin_interfaces/Time\nint32 sec\nuint16 parts\n"
    found = types("one/T", text, ros1=False)
    assert found["builtin_interfaces/Time"] == (number("sec", "int32"), number("parts", "uint16"))


def test_a_type_may_be_empty() -> None:
    assert types("one/T", "one/E e\n===\nMSG: one/E\n# nothing", ros1=False)["one/E"] == ()
    assert fields("") == ()


def deep(levels: int, width: int = 1) -> str:
    text = "".join(f"one/L1 f{i}\n" for i in range(width))
    for level in range(1, levels):
        parts = "".join(f"L{level + 1} f{i}\n" for i in range(width))
        text += f"===\nMSG: one/L{level}\n{parts}"
    return text + f"===\nMSG: one/L{levels}\nint8 x\n"


@BOTH
@pytest.mark.parametrize(
    "text",
    [
        "float64",
        "float64 1x",
        "float64 x-y",
        "float64x",
        "?! x",
        "float64[ x",
        "float64[-1] x",
        "float64[2][3] x",
        "wstring x",
        "wstring<=5 x",
        "wstring[] x",
        "one/Unknown x",
        "Unknown x",
        "float64 x\n---\nfloat64 y",
        "MSG: one/A\nfloat64 x",
        "float64 x\n===",
        "float64 x\n===\nfloat64 y",
        "float64 x\n===\nMSG: one/A\nint8 y\nMSG: one/B\nint8 z",
        "float64 x\n===\n===\nMSG: one/A\nint8 y",
        "float64 x\n===\nMSG: one\nint8 y",
        "float64 x\n===\nMSG: one/srv/A\nint8 y",
        "float64 x\n===\nMSG: one/T\nint8 y",
        "one/A a\n===\nMSG: one/A\nint8 y\n===\nMSG: one/msg/A\nint16 y",
        "T t",
        "T[] t",
        "one/A a\n===\nMSG: one/A\nB b\n===\nMSG: one/B\nA[3] a",
        deep(200),
        deep(40, width=2),
        "float64[" + "9" * 5000 + "] x",
    ],
)
def test_what_is_not_certain_is_refused(text: str, *, ros1: bool) -> None:
    with pytest.raises(ValueError, match=r"."):
        types("one/T", text, ros1=ros1)


@pytest.mark.parametrize("text", ["int32 x y = 3", "float64 x 1.5", "float64 x y"])
def test_what_stands_behind_a_name_is_refused_in_ros_1(text: str) -> None:
    with pytest.raises(DefinitionError):
        types("one/T", text, ros1=True)


@pytest.mark.parametrize("name", ["", "T", "one/", "/T", "one/two/T", "one/srv/T"])
def test_a_name_of_another_form_is_refused(name: str) -> None:
    with pytest.raises(DefinitionError):
        types(name, "float64 x", ros1=False)


def test_types_may_be_as_deep_as_anyone_makes_them() -> None:
    assert len(types("one/T", deep(40), ros1=False)) == 43


def stream(text: str, *, ros1: bool) -> ChannelDefinition:
    schema = Schema(1, text.encode(), "ros1msg" if ros1 else "ros2msg", "one/T")
    return ChannelDefinition(Channel(1, "/x", "ros1" if ros1 else "cdr", {}, 1), schema)


@given(st.text(), st.text())
@examples(10)
@example("a/b", "\0\0")
def test_hostile_text_is_refused_or_read(name: str, text: str) -> None:
    for ros1 in (False, True):
        try:
            found: Any = types(name, text, ros1=ros1)
        except DefinitionError:
            continue
        assert found


def test_a_definition_that_is_no_utf_8_has_no_shape() -> None:
    whole = stream("float64 x", ros1=False)
    assert whole.schema is not None
    assert shape(whole) is not None
    broken = replace(whole.schema, data=b"float64 x # \xff")
    assert shape(ChannelDefinition(whole.channel, broken)) is None
    assert shape(ChannelDefinition(whole.channel, None)) is None
