"""Variables are used as their types allow; what is not certainly wrong is passed by."""

import pytest

from compiler.formalization.formalize import formalize
from fretish.bindings.tables.reader import read_bindings
from fretish.bindings.types import Kind, kind
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Source
from fretish.documents import requirements

TYPES = {
    "flag": "boolean",
    "door": "boolean",
    "n": "integer",
    "u": "unsigned integer",
    "d": "double",
    "e": "tMode",
}
VALUES = {
    "half": ("double", "0.5"),
    "five": ("integer", "5"),
    "opposite": ("boolean", "!flag"),
    "wrong": ("integer", "2.5"),
    "odd": ("boolean", "d + 1"),
    "even": ("double", "d > 1"),
    "inner": ("double", "flag + 1"),
    "below": ("unsigned integer", "-1"),
}


def messages(text: str) -> list[str]:
    """What is wrong with the sentence, whatever its place."""
    tables = [f'[variable.{name}]\ntype = "{type_}"\n' for name, type_ in TYPES.items()]
    tables += [
        f'[variable.{name}]\ntype = "{type_}"\nvalue = "{value}"\n'
        for name, (type_, value) in VALUES.items()
    ]
    declarations, said = read_bindings(Source("bindings.toml", "".join(tables)))
    assert declarations is not None, said
    ((entry,), _) = requirements(Source("r.fret", f"the sw shall always satisfy {text}"))
    requirement, remarks = formalize(entry, declarations)
    mistakes = [each for each in remarks if each.is_error]
    assert (requirement is None) == bool(mistakes)
    assert all(each.code is Code.VARIABLE_TYPE for each in mistakes)
    return [each.message for each in mistakes]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("flag < 3", "`flag` is declared boolean, and a number is needed here"),
        ("3 = flag", "`flag` is declared boolean, and a number is needed here"),
        ("d = flag", "`flag` is declared boolean, and a number is needed here"),
        ("flag < door", "`flag` is declared boolean, and a number is needed here"),
        ("d + flag > 2", "`flag` is declared boolean, and a number is needed here"),
        ("absReal(flag) > 2", "`flag` is declared boolean, and a number is needed here"),
        ("preReal(0, flag) > 2", "`flag` is declared boolean, and a number is needed here"),
        ("preBool(false, d)", "`d` is declared double, and a truth value is needed here"),
        ("persisted(2, n)", "`n` is declared integer, and a truth value is needed here"),
        ("f(d, d + flag)", "`flag` is declared boolean, and a number is needed here"),
        ("n | flag", "`n` is declared integer, and a truth value is needed here"),
        ("n = 2.5", "`n` is declared integer, and 2.5 is not a whole number"),
        ("-2.5 != n", "`n` is declared integer, and -2.5 is not a whole number"),
        ("n = half", "`n` is declared integer, and half is not a whole number"),
        ("u = -3", "`u` is declared unsigned integer, and -3 is below 0"),
        ("n > wrong", "`wrong` is declared integer, and 2.5 is not a whole number"),
        ("odd", "`odd` is declared boolean, and its value is a number"),
        ("even > 2", "`even` is declared double, and its value is a truth value"),
        ("inner > 2", "`flag` is declared boolean, and a number is needed here"),
        ("n > below", "`below` is declared unsigned integer, and -1 is below 0"),
    ],
)
def test_what_is_certainly_wrong_is_a_mistake(text: str, message: str) -> None:
    assert message in messages(text)


@pytest.mark.parametrize(
    "text",
    [
        "flag & !door",
        "flag = door",
        "flag = other",
        "flag = f(2)",
        "n = 2.0",
        "n = 1e1",
        "n = -3",
        "n < 2.5",
        "n + 0.5 = 2.5",
        "n = half * 2",
        "d = 2.5",
        "n = five",
        "opposite | flag",
        "e = 3 & e",
        "f(flag, d)",
        "other < 3 & other",
        "preBool(false, flag) & persisted(2, flag) & occurs(1, 2, flag)",
        "preInt(0, n) = 2",
        "maxReal(n, d) > half",
    ],
)
def test_anything_else_is_passed_by(text: str) -> None:
    assert messages(text) == []


def test_types_are_those_of_fret_however_they_are_spelt() -> None:
    found = {name: kind(name) for name in ("Boolean", "unsigned  integer", "int32", "uint8",
                                           "single", "float64", "", "struct", "tMode")}  # fmt: skip
    assert found == {
        "Boolean": Kind.TRUTH,
        "unsigned  integer": Kind.NATURAL,
        "int32": Kind.WHOLE,
        "uint8": Kind.NATURAL,
        "single": Kind.NUMBER,
        "float64": Kind.NUMBER,
        "": None,
        "struct": None,
        "tMode": None,
    }
