"""Comparisons of sentences over signals: bare numbers are in the signals' own units."""

from __future__ import annotations

from fractions import Fraction
from operator import eq, ge, gt, le, lt, ne

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fretish import expressions as e
from fretish.bindings.comparisons import bound, in_own_units, is_measured, plain
from fretish.bindings.declarations import Path, Signal
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.parser import parse
from fretish.printer import expression
from fretish.syntax import Sentence
from fretish.units import unit

COMPARE = {"<": lt, "<=": le, ">": gt, ">=": ge, "=": eq, "!=": ne}
UNITS = {"m/s": ["m/s", "km/h", "cm/s"], "m": ["m", "cm", "km"], "%": ["%", "1"]}


def signal(name: str, unit_name: str) -> Signal:
    measure = unit(unit_name)
    assert measure is not None
    return Signal(name, Path("/t", (name,)), measure, "" if unit_name == "1" else unit_name)


SIGNALS = {
    "speed": signal("speed", "km/h"),
    "pace": signal("pace", "km/h"),
    "wind": signal("wind", "m/s"),
    "way": signal("way", "cm"),
    "time": signal("time", "s"),
    "battery": signal("battery", "%"),
    "tally": signal("tally", "1"),
}


def comparison(text: str) -> e.Comparison:
    sentence = parse(Source("r.fret", f"the agv shall always satisfy {text}").span())
    assert isinstance(sentence, Sentence), sentence
    assert isinstance(sentence.response, e.Comparison)
    return sentence.response


def rewritten(text: str) -> tuple[str, str] | Code:
    """In the signals' own units, and in the language of bindings."""
    tree = comparison(text)
    assert is_measured(tree, SIGNALS)
    place = Source("r.fret", text).span()
    own = in_own_units(tree, SIGNALS, place)
    if isinstance(own, Diagnostic):
        return own.code
    declared = bound(tree, SIGNALS, place)
    return (
        declared.code
        if isinstance(declared, Diagnostic)
        else (expression(own), expression(declared))
    )


@pytest.mark.parametrize(
    ("text", "own", "declared"),
    [
        ("battery < 20 %", "battery < 20", "battery < 20 %"),
        ("battery < 20", "battery < 20", "battery < 20 %"),
        ("battery < 0.2 %", "battery < 0.2", "battery < 0.2 %"),
        ("speed <= 1.5 m/s", "speed <= 5.4", "speed <= 1.5 m/s"),
        ("wind <= 1 km/h", "wind <= 5 / 18", "wind <= 1 km/h"),
        ("speed * 2 < 3", "speed * 2 < 3", "speed * 2 < 3 km/h"),
        ("2 * 3 < speed", "2 * 3 < speed", "2 * 3 * 1 km/h < speed"),
        ("speed - pace > 1 m/s + 1", "speed - pace > 3.6 + 1", "speed - pace > 1 m/s + 1 km/h"),
        ("absReal(speed - 1) < 5", "absReal(speed - 1) < 5", "abs(speed - 1 km/h) < 5 km/h"),
        ("-speed < -1", "-speed < -1", "-speed < -1 km/h"),
        ("wind * time < 5", "wind * time < 5", "wind * time < 5 m*s/s"),
        ("50 % * way > 4", "0.5 * way > 4", "50 % * way > 4 cm"),
        ("way / 2 s < 1 cm/s", "way / 2 < 1", "way / 2 s < 1 cm/s"),
        ("time * 1 km/h > way", "time * (5 / 18) > way", "time * 1 km/h > way"),
        ("way / time < 5 cm/s", "way / time < 5", "way / time < 5 cm/s"),
        ("speed < wind", "speed < wind", "speed < wind"),
        ("speed < wind + 0", "speed < wind + 0", "speed < wind + 0 km/h"),
        ("speed < wind + 1 m/s", "speed < wind + 1 m/s", "speed < wind + 1 m/s"),
        ("tally < 5", "tally < 5", "tally < 5"),
        ("way ^ 2 < 4", "way ^ 2 < 4", "way ^ 2 < 4 cm*cm"),
        ("way ^ 2.0 < 4 m^2", "way ^ 2.0 < 40000", "way ^ 2 < 4 m^2"),
        ("way * 1 cm < (2 m) ^ 2", "way * 0.01 < 2 ^ 2 * 100", "way * 1 cm < 2 m ^ 2"),
        ("tally < 10 ^ 3", "tally < 10 ^ 3", "tally < 10 ^ 3"),
        ("battery mod 5 < 1", "battery mod 5 < 1", "battery mod 5 % < 1 %"),
        ("way mod 2 m < 5 cm", "way mod 200 < 5", "way mod 2 m < 5 cm"),
        (
            "speed - preReal(0, speed) < 1 m/s",
            "speed - preReal(0, speed) < 3.6",
            "speed - pre(0 km/h, speed) < 1 m/s",
        ),
        ("preInt(1, tally) = 2", "preInt(1, tally) = 2", "pre(1, tally) = 2"),
        ("tally > preInt(1, 2)", "tally > preInt(1, 2)", "tally > pre(1, 2)"),
        ("speed < maxReal(1, 2)", "speed < maxReal(1, 2)", "speed < max(1, 2) * 1 km/h"),
        ("tally < 10 ^ 2.0", "tally < 10 ^ 2.0", "tally < 10 ^ 2"),
        ("tally < absInt(5)", "tally < absInt(5)", "tally < abs(5)"),
        ("speed < -maxReal(1, 2)", "speed < -maxReal(1, 2)", "speed < -(max(1, 2) * 1 km/h)"),
        ("way < 2 m * 3", "way < 2 * 3 * 100", "way < 2 m * 3"),
    ],
)
def test_a_number_is_in_the_unit_of_the_signal_beside_it(
    text: str, own: str, declared: str
) -> None:
    assert rewritten(text) == (own, declared)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("battery < 20 m", Code.UNIT_MISMATCH),
        ("speed < way", Code.UNIT_MISMATCH),
        ("speed + time < 3", Code.UNIT_MISMATCH),
        ("speed < wind + 1", Code.WHICH_UNIT),
        ("speed * time < 5", Code.WHICH_UNIT),
        ("speed / wind < 2", Code.WHICH_UNIT),
        ("battery * way < 20", Code.WHICH_UNIT),
        ("way / 5 m < 2", Code.WHICH_UNIT),
        ("way / 1 h < 2", Code.WHICH_UNIT),
        ("way * (1 h + 2) < 3 m*s", Code.WHICH_UNIT),
        ("wind < (1 m/s + 2) * 3", Code.WHICH_UNIT),
        ("tally < 1e9999", Code.BAD_EXPRESSION),
    ],
)
def test_what_has_no_certain_unit_is_refused(text: str, code: Code) -> None:
    assert rewritten(text) == code


@pytest.mark.parametrize(
    "text",
    [
        "speed ^ 0.5 < 1",
        "speed ^ 17 < 1",
        "tally ^ tally < 1",
        "(speed ^ 2) ^ 2 < 1",
        "(2 + 3) ^ 2 < tally",
        "preReal(speed) < 1",
        "preReal(0, height) < 1",
        f"{'preReal(0, ' * 17}speed{')' * 17} < 1",
    ],
)
def test_what_bindings_cannot_compute_stays_a_proposition(text: str) -> None:
    assert not is_measured(comparison(text), SIGNALS)


# The law: raw arithmetic, as FRET has it, is the physical one


def raw(tree: e.Expression, values: dict[str, Fraction]) -> Fraction | None:
    """Numbers as they are written, signals as they are recorded; None where it divides by zero."""
    match tree:
        case e.Number(digits):
            return Fraction(digits)
        case e.Name(id):
            return values[id]
        case _:
            return computed(tree, [raw(part, values) for part in e.children(tree)])


def physical(tree: e.Expression, values: dict[str, Fraction]) -> Fraction | None:
    """In base units."""
    match tree:
        case e.Number(digits):
            return Fraction(digits)
        case e.Quantity(digits, name):
            measure = unit(name)
            assert measure is not None
            return Fraction(digits) * measure.factor
        case e.Name(id):
            return values[id] * SIGNALS[id].unit.factor
        case _:
            return computed(tree, [physical(part, values) for part in e.children(tree)])


def computed(tree: e.Expression, parts: list[Fraction | None]) -> Fraction | None:
    if any(part is None for part in parts):
        return None
    numbers = [part for part in parts if part is not None]
    match tree:
        case e.Negation():
            return -numbers[0]
        case e.Arithmetic("+"):
            return numbers[0] + numbers[1]
        case e.Arithmetic("-"):
            return numbers[0] - numbers[1]
        case e.Arithmetic("*"):
            return numbers[0] * numbers[1]
        case e.Arithmetic("/"):
            return numbers[0] / numbers[1] if numbers[1] else None
        case e.Arithmetic("mod"):
            return numbers[0] % numbers[1] if numbers[1] else None
        case e.Arithmetic("^"):
            return numbers[0] ** int(numbers[1])
        case e.Call(name):
            if name.startswith("abs"):
                return abs(numbers[0])
            return max(numbers) if name.startswith("max") else min(numbers)
        case _:
            raise AssertionError(tree)


def speeds() -> st.SearchStrategy[str]:
    """Terms in km/h."""
    leaf = st.sampled_from(
        [
            "speed",
            "pace",
            "3",
            "0.5",
            "1 m/s",
            "50 cm/s",
            "2 km/h",
            "speed * 2",
            "50 % * pace",
            "speed / 20 %",
            "3 * pace",
            "speed / 4",
            "speed ^ 3 / pace ^ 2",
        ]
    )

    def larger(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
        return st.one_of(
            st.tuples(inner, st.sampled_from("+-"), inner).map(lambda t: f"({t[0]} {t[1]} {t[2]})"),
            inner.map(lambda t: f"-({t})"),
            inner.map(lambda t: f"absReal({t})"),
            st.tuples(inner, inner).map(lambda t: f"maxReal({t[0]}, {t[1]})"),
            inner.map(lambda t: f"({t}) * 3"),
            inner.map(lambda t: f"({t}) / 7"),
            st.tuples(inner, inner).map(lambda t: f"(({t[0]}) mod ({t[1]}))"),
        )

    return st.recursive(leaf, larger, max_leaves=6)


@pytest.mark.slow
@given(speeds(), speeds(), st.sampled_from(sorted(COMPARE)), st.data())
def test_raw_arithmetic_is_the_physical_one(
    left: str, right: str, op: str, data: st.DataObject
) -> None:
    text = f"{left} {op} {right}"
    tree = comparison(text)
    assume(any(e.names(tree)))
    place = Source("r.fret", text).span()
    own = in_own_units(tree, SIGNALS, place)
    assume(not isinstance(own, Diagnostic) or own.code != Code.WHICH_UNIT)
    assert isinstance(own, e.Comparison), own
    declared = bound(tree, SIGNALS, place)
    assert isinstance(declared, e.Comparison), declared
    numbers = st.fractions(-20, 20, max_denominator=8)
    values = {"speed": data.draw(numbers), "pace": data.draw(numbers)}
    sides = [raw(own.left, values), raw(own.right, values)]
    bases = [physical(declared.left, values), physical(declared.right, values)]
    factor = SIGNALS["speed"].unit.factor
    assert [side and side * factor for side in sides] == bases


@given(st.fractions(min_value=0))
def test_a_number_is_written_exactly(exact: Fraction) -> None:
    tree = plain(exact)
    assert raw(tree, {}) == exact


@pytest.mark.parametrize(
    ("text", "place"),
    [("tally < 30 m", "30 m"), ("30 m > tally", "tally"), ("tally + 1 < way", "way")],
)
def test_a_signal_without_a_unit_is_named(text: str, place: str) -> None:
    wrong = in_own_units(comparison(text), SIGNALS, Source("r.fret", text).span())
    assert isinstance(wrong, Diagnostic)
    assert wrong.span is not None
    unit_name = "cm" if "way" in text else "m"
    assert (wrong.code, wrong.span.text) == (Code.UNIT_MISMATCH, place)
    assert wrong.message.startswith("`tally` has no unit in the bindings, so it cannot")
    assert (wrong.help or "").startswith(f'add `unit = "{unit_name}"` to `[signal.tally]` if')
