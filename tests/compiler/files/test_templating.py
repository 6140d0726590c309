import ast
import json
import re
import tomllib
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from compiler.files.templating import (
    c_comment,
    c_remark,
    comment,
    data,
    java,
    java_comment,
    python,
    quoted,
    script,
    to_json,
    toml,
)

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


@pytest.mark.slow
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


# Text of a user within the text of another language ----------------------------------------------

TEXTS = st.text(max_size=30) | st.text("*/?\\\"'<!-> \n\r\t\u2028a", max_size=12)


def hostile(test: Any) -> Any:
    """The test with texts that end comments, strings and scripts."""
    for text in ("*/*/", "/*/ **/", "???/", '\\" \\', "</script>", "<!-- ]]>", "a\nb\\", "\x00"):
        test = example(text)(test)
    return given(TEXTS)(test)


def is_plain(line: str) -> bool:
    return line.isascii() and line.isprintable()


@hostile
def test_a_string_is_read_back(text: str) -> None:
    assert ast.literal_eval(python(text)) == text
    assert json.loads(script(text)) == text
    assert is_plain(python(text).replace("\x7f", ""))
    assert is_plain(script(text).replace("\x7f", ""))


@hostile
def test_no_text_ends_the_script_that_it_stands_in(text: str) -> None:
    assert "<" not in script(text)
    assert "<" not in data({text: [text]})
    assert json.loads(data({text: [text]})) == {text: [text]}


@hostile
def test_no_text_ends_the_comment_that_it_stands_in(text: str) -> None:
    assert is_plain(comment(text))
    for inner in (c_comment(text).removeprefix(" * "), c_remark(text)[3:-3]):
        assert is_plain(inner)
        assert not re.search(r"\*/|/\*|\?\?", inner)
    assert re.fullmatch(r"/\* .* \*/", c_remark(text))


def read_by_java(text: str) -> str:
    """What Java makes of a text before its lexer: Unicode escapes become characters (JLS 3.3)."""
    escape = re.compile(r"(?<!\\)((?:\\\\)*)\\u+([0-9a-fA-F]{4})")
    return escape.sub(lambda match: match[1] + chr(int(match[2], 16)), text)


@hostile
@example("\\u000a")
@example("\\\\uu000A x")
@example("\\u")
@example('\\u0022 + "')
@example("\U0001f916 \ud800")
def test_no_text_ends_the_comment_or_the_string_of_java_that_it_stands_in(text: str) -> None:
    remark = java_comment(text)
    assert is_plain(remark)
    assert "\\u" not in remark
    written = read_by_java(java(text))
    inner = re.fullmatch(r'"((?:[^"\\\r\n]|\\[0-7]{3})*)"', written)
    assert inner is not None
    told = re.sub(r"\\([0-7]{3})", lambda match: chr(int(match[1], 8)), inner[1])
    assert told.encode("utf-16-be", "surrogatepass") == text.encode("utf-16-be", "surrogatepass")


@hostile
def test_no_text_ends_the_string_of_an_automaton(text: str) -> None:
    written = quoted(text)
    assert re.fullmatch(r'"([^"\\]|\\.)*"', written)
    assert re.sub(r"\\(.)", r"\1", written[1:-1]) == " ".join(text.split())


@given(st.text(st.characters(codec="utf-8"), max_size=30))
@example("\\\n'''\x00\"\"\"")
def test_a_text_of_toml_is_read_back(text: str) -> None:
    assert tomllib.loads(f"x = {toml(text)}") == {"x": text}
    assert "\n" not in toml(text)
