"""Tables of computed signals: units through every function, and where each mistake is reported."""

from __future__ import annotations

import pytest

from fretish import expressions as e
from fretish.bindings.calculations import without_calculations
from fretish.bindings.canonical import proposition_fields
from fretish.bindings.declarations import Aggregate, Declarations, Role
from fretish.bindings.functions import OF_VALUES
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.units import base_name

SIGNALS = {"x": "m", "y": "cm", "t": "s", "a": "rad", "b": "deg", "n": "1", "charge": "%"}
RECORDED = '[clock]\ntick = "100 ms"\n[signal.mode]\npath = "/m.mode"\nvalues = ["on", "off"]\n'
RECORDED += "".join(
    f'[signal.{name}]\npath = "/{name}.data"\nunit = "{unit}"\n' for name, unit in SIGNALS.items()
)


def read(text: str) -> tuple[Declarations, tuple[Diagnostic, ...]]:
    declarations, wrong = read_bindings(Source("bindings.toml", RECORDED + text))
    assert declarations is not None, wrong
    return declarations, wrong


def good(text: str) -> Declarations:
    declarations, wrong = read(text)
    assert wrong == ()
    return declarations


def unit_of(value: str) -> str:
    signal = good(f'[signal.v]\nvalue = "{value}"\n').computed["v"]
    assert base_name(signal.unit.dimension) == signal.unit_name
    assert signal.unit.factor == 1
    return signal.unit_name


UNITS = {
    "sqrt(x * y)": "m",
    "sqrt(x^2 + y^2)": "m",
    "hypot(x, y)": "m",
    "norm(t)": "s",
    "norm(x, y, x, y)": "m",
    "sign(x - y)": "",
    "floor(x / y)": "",
    "ceil(charge)": "",
    "exp(n)": "",
    "log(x / 1 m)": "",
    "sin(a)": "",
    "cos(b - a)": "",
    "tan(2 * b)": "",
    "asin(x / y)": "rad",
    "acos(n)": "rad",
    "atan(n + 1)": "rad",
    "atan2(y, x)": "rad",
    "wrap_angle(a - b)": "rad",
    "yaw(n, n, n, n)": "rad",
    "pitch(n, n, n, n)": "rad",
    "roll(n, n, n, n)": "rad",
    "angle_between(n, n, n, n, n, n, n, n)": "rad",
    "haversine(a, b, a, b)": "m",
    "clamp(x, 1 cm, y)": "m",
    "x / t": "m/s",
    "x * x / t mod 3 m^2/s": "m^2/s",
    "-abs(min(x, y))": "m",
    "1 / t": "1/s",
}


@pytest.mark.parametrize(("value", "unit"), UNITS.items())
def test_a_value_has_the_unit_that_follows_from_its_functions(value: str, unit: str) -> None:
    assert unit_of(value) == unit


def test_the_units_of_all_functions_are_tried() -> None:
    assert {name for name in OF_VALUES if any(v.startswith(f"{name}(") for v in UNITS)} == {
        *OF_VALUES
    }


MISTAKES = {
    "hypot(x, t)": (
        "F305",
        "a quantity in m cannot be compared with or added to a quantity in s",
        "t",
    ),
    "hypot(x, n)": (
        "F305",
        "a quantity in m cannot be compared with or added to a number without a unit",
        "n",
    ),
    "sqrt(x)": ("F305", "the square root of a quantity in m has no unit", "x"),
    "sin(x + y)": ("F305", "`sin` takes a quantity in rad, and this is a quantity in m", "x + y"),
    "cos(n)": (
        "F305",
        "`cos` takes a quantity in rad, and this is a number without a unit",
        "n",
    ),
    "asin(a)": ("F305", "`asin` takes a number without a unit, and this is a quantity in rad", "a"),
    "floor(2 * x)": (
        "F305",
        "`floor` takes a number without a unit, and this is a quantity in m",
        "2 * x",
    ),
    "haversine(a, b, x, a)": (
        "F305",
        "a quantity in rad cannot be compared with or added to a quantity in m",
        "x",
    ),
    "yaw(a, a, a, a)": (
        "F305",
        "`yaw` takes a number without a unit, and this is a quantity in rad",
        "a",
    ),
    "clamp(x, 0 s, y)": (
        "F305",
        "a quantity in m cannot be compared with or added to a quantity in s",
        "0 s",
    ),
    "hypot(x)": ("F308", "`hypot` takes 2 numbers", "hypot"),
    "sqrt(n, n)": ("F308", "`sqrt` takes 1 number", "sqrt"),
    "yaw(n, n, n)": ("F308", "`yaw` takes 4 numbers", "yaw"),
    "x < y": ("F308", "the value of a signal must be a number, and this is true or false", "x < y"),
    "max(x, y < x)": ("F308", "a number is needed, and this is a truth value", "y < x"),
    "pre(0 m, x)": (
        "F308",
        "a computed signal depends on the values of one instant, and this looks back",
        "pre(0 m, x)",
    ),
    "x for 2 s": (
        "F308",
        "a computed signal depends on the values of one instant, and this looks back",
        "x for 2 s",
    ),
    "3 m": ("F308", "the value names no signal", "3 m"),
    "hypot(n, mode)": ("F308", "`mode` is a word, and a number is needed", "mode"),
    "x + z": ("F309", "`z` is not declared", "z"),
    "size(x)": ("F309", "unknown function `size`", "size"),
    "v + 1": ("F342", "the values of signals form a cycle: v, v", '"v + 1"'),
    "-" * 60 + "x": (
        "F308",
        "the value has more than 1000 parts, or 50 levels, with the values that it names",
        f'"{"-" * 60}x"',
    ),
    " + ".join(["n"] * 501): (
        "F308",
        "the value has more than 1000 parts, or 50 levels, with the values that it names",
        f'"{" + ".join(["n"] * 501)}"',
    ),
    "__import__('os')": ("F308", "`'os'` is a word, and a number is needed", None),
    "x.real": ("F308", "`.` does not fit here", "."),
}


@pytest.mark.parametrize(("value", "told"), MISTAKES.items(), ids=lambda v: str(v)[:20])
def test_a_mistake_is_reported_where_it_is(value: str, told: tuple[str, str, str | None]) -> None:
    declarations, wrong = read(f'[signal.v]\nvalue = "{value}"\n')
    (only,) = wrong
    assert declarations.mistakes["signal", "v"] == (only,)
    assert "v" not in declarations.measured
    if told[2] is None:
        assert only.code.number == "F308"
        return
    assert only.span is not None
    assert (only.code.number, only.message, only.span.text) == told


def test_the_caret_of_a_unit_that_does_not_fit_is_in_the_value() -> None:
    _, (only,) = read('[signal.v]\nvalue = "2 * sin(x + y)"\n')
    line = RECORDED.count("\n") + 2
    assert render(only) == (
        "F305 `sin` takes a quantity in rad, and this is a quantity in m\n"
        f"  --> bindings.toml:{line}:18\n"
        '   | value = "2 * sin(x + y)"\n'
        "   |                  ^^^^^\n"
        "help: give the signal its `unit`; `x * 1 rad` makes an angle of a number, `x / 1 m` a "
        "number of a length"
    )


def test_a_computed_signal_has_no_fields_of_a_message() -> None:
    _, wrong = read('[signal.v]\nvalue = "x"\npath = "/a.b"\nmax_age = "1 s"\nunits = "m"\n')
    assert [(each.code.number, each.span and each.span.text) for each in wrong] == [
        ("F303", "path"),
        ("F303", "max_age"),
        ("F302", "units"),
    ]


def test_the_declared_unit_has_the_dimension_of_the_value() -> None:
    signal = good(
        '[signal.v]\nvalue = "x + y"\nunit = "mm"\nrole = "output"\nagg = "any"\n'
    ).computed["v"]
    assert (signal.unit_name, signal.text, signal.is_rounded) == ("mm", "x + y", False)
    assert (signal.role, signal.aggregate) == (Role.OUTPUT, Aggregate.ANY)
    _, (only,) = read('[signal.v]\nvalue = "x + y"\nunit = "s"\n')
    assert only.message == "the value is a quantity in m, and `unit` is s"
    assert only.span is not None
    assert only.span.text == '"s"'


def test_only_the_value_of_a_signal_calls_these_functions() -> None:
    _, (only,) = read('[proposition.p]\nexpr = "sqrt(x * x) < 3 m"\n')
    assert only.message == "only the `value` of a computed signal can call `sqrt`"
    assert only.help == 'add `[signal.NAME]` with `value = "sqrt(x)"`, and compare that signal'
    _, (other,) = read('[signal.z]\npath = "/z.data"\nvalid = "floor(x) > 3"\n')
    assert other.message == "only the `value` of a computed signal can call `floor`"


def test_a_computed_signal_is_no_truth_value() -> None:
    declared = '[signal.v]\nvalue = "n * n"\n[proposition.p]\nexpr = '
    for expression in ('"v"', '"not v or n"', '"v = true"'):
        _, (only,) = read(declared + expression)
        assert only.message == "`v` is computed, and a truth value is needed"


FAR = """
[signal.far]
value = "2 * distance + 1 m"
[signal.distance]
value = "hypot(x, clamp(y, 0 m, 9 m))"
[proposition.near]
expr = "far < 5 m and y < 3 m"
"""


def test_values_name_computed_signals_in_any_order_of_their_tables() -> None:
    declarations = good(FAR)
    assert set(declarations.computed) == {"far", "distance"}
    near = declarations.propositions["near"]
    assert near.signals == ("x", "y")
    assert near.calculations == ("far", "distance")
    assert declarations.computed["distance"].is_rounded
    assert not declarations.computed["far"].is_rounded
    named = e.Comparison("<", e.Name("far"), e.Quantity("5", "m"))
    assert isinstance(near.expression, e.And)
    assert without_calculations(near.expression.args[0]) == named
    kept = declarations.restricted_to(["near"])
    assert (set(kept.signals), set(kept.computed)) == ({"x", "y"}, {"far", "distance"})


def test_a_definition_has_the_meaning_of_its_expression() -> None:
    plain = '[proposition.p]\nexpr = "2 * x + max(y, 1 cm) < 5 m"\n'
    one = good('[signal.v]\nvalue = "2 * x"\n[proposition.p]\nexpr = "v + max(y, 1 cm) < 5 m"\n')
    two = good(
        '[signal.v]\nvalue = "2 * x + w"\n[signal.w]\nvalue = "max(y, 10 mm)"\nunit = "cm"\n'
        '[proposition.p]\nexpr = "v < 500 cm"\n'
    )
    other = good('[signal.v]\nvalue = "3 * x"\n[proposition.p]\nexpr = "v + max(y, 1 cm) < 5 m"\n')
    meanings = [proposition_fields(d.propositions["p"]) for d in (good(plain), one, two, other)]
    assert meanings[0] == meanings[1] == meanings[2] != meanings[3]


def test_a_mistake_of_a_signal_is_one_of_all_that_name_it() -> None:
    declarations, wrong = read(
        '[signal.w]\nvalue = "v * 2"\n[signal.v]\nvalue = "x + t"\n'
        '[proposition.p]\nexpr = "w < 3 m"\n[proposition.q]\nexpr = "x < 3 m"\n'
    )
    (only,) = wrong
    assert declarations.mistakes == {
        ("signal", "v"): wrong,
        ("signal", "w"): wrong,
        ("proposition", "p"): wrong,
    }
    assert only.code.number == "F305"
    unread, wrong = read('[signal.w]\nvalue = "v * 2"\n[signal.v]\nvalue = "x +"\n')
    assert {*unread.mistakes} == {("signal", "v"), ("signal", "w")}


def test_every_signal_of_a_cycle_is_reported_and_what_needs_it() -> None:
    declarations, wrong = read(
        '[signal.u]\nvalue = "v + x"\n[signal.v]\nvalue = "w + x"\n[signal.w]\nvalue = "x - v"\n'
        '[signal.good]\nvalue = "2 * x"\n'
    )
    assert [each.message for each in wrong] == [
        "the values of signals form a cycle: v, w, v",
        "the values of signals form a cycle: v, w, v",
        "the values of signals form a cycle: w, v, w",
    ]
    assert set(declarations.computed) == {"good"}


def test_values_that_double_each_other_stay_small() -> None:
    doubling = "".join(f'[signal.v{i + 1}]\nvalue = "v{i} + v{i}"\n' for i in range(40))
    declarations, wrong = read(f'[signal.v0]\nvalue = "x"\n{doubling}')
    assert {each.message for each in wrong} == {
        "the value has more than 1000 parts, or 50 levels, with the values that it names"
    }
    assert len(declarations.computed) == 9
