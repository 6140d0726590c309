"""Tables of signals with memory: their units, what they keep of their signal, and each mistake."""

from __future__ import annotations

import pytest

from fretish.bindings.canonical import bound, digest
from fretish.bindings.declarations import Declarations, Memory
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.units import ONE, unit

RECORDED = """
[clock]
tick = "100 ms"
[signal.speed]
path = "/odom.twist.twist.linear.x"
unit = "km/h"
max_age = "1 s"
valid = "x < 90 km/h"
[signal.bumper]
path = "/bumper.state"
[signal.mode]
path = "/m.data"
values = ["a", "b"]
[signal.twice]
value = "2 * speed"
[signal.x]
frame = "base_link"
in = "map"
path = "x"
[signal.goal]
action = "/go"
"""


def read(text: str) -> tuple[Declarations, tuple[Diagnostic, ...]]:
    declarations, wrong = read_bindings(Source("bindings.toml", RECORDED + text))
    assert declarations is not None, wrong
    return declarations, wrong


@pytest.mark.parametrize(
    ("value", "name", "over"),
    [
        ("rate(speed)", "km/h/s", None),
        ("rate(bumper)", "Hz", None),
        ("rate(speed, over = 500 ms)", "km/h/s", 500_000_000),
        ("mean(speed, over = '0.5 s')", "km/h", 500_000_000),
        ("max(over = 2 s, speed)", "km/h", 2_000_000_000),
        ("count(bumper, over = 1 min)", "", 60_000_000_000),
    ],
)
def test_a_signal_with_memory_has_samples_in_its_unit(
    value: str, name: str, over: int | None
) -> None:
    declarations, wrong = read(f'[signal.v]\nvalue = "{value}"\nrole = "input"\n')
    assert wrong == ()
    made = declarations.signals["v"]
    source = "bumper" if "bumper" in value else "speed"
    read_signal = declarations.signals[source]
    assert made.unit_name == name
    assert made.unit == unit(name or "1")
    assert made.memory == Memory(
        value.partition("(")[0], source, over, read_signal.max_age, read_signal.unit, value
    )
    assert (made.path, made.valid) == (read_signal.path, read_signal.valid)
    assert made.field_unit == read_signal.unit
    assert made.max_age is None  # old samples of the signal that it reads count in its values


def test_max_without_a_window_is_that_of_one_instant() -> None:
    declarations, wrong = read('[signal.v]\nvalue = "max(speed, twice)"\n')
    assert wrong == ()
    assert "v" in declarations.computed


def test_the_window_changes_the_fingerprint_and_its_spelling_does_not() -> None:
    def fingerprint(over: str) -> str:
        text = f'[signal.v]\nvalue = "max(speed, over = {over})"\n'
        declarations, _ = read(text + '[proposition.p]\nexpr = "v < 5 km/h"\n')
        return digest(bound(declarations, ["p"]))

    assert fingerprint("500 ms") == fingerprint("0.5 s") != fingerprint("501 ms")


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("rate(speed) * 2", "`rate` has memory, and must be the whole value of its signal"),
        ("mean(speed)", "`mean` takes one signal and the length of its window"),
        ("max(speed, bumper, over = 2 s)", "`max` takes one signal and the length of its window"),
        ("max(speed, over = 2 m)", "`over` must be a duration greater than 0"),
        ("max(speed, over = 0 s)", "`over` must be a duration greater than 0"),
        ("rate(twice)", "`rate` needs a recorded signal of numbers, and this is a computed signal"),
        ("rate(mode)", "`rate` needs a recorded signal of numbers, and this is one of words"),
        ("rate(x)", "`rate` needs a recorded signal of numbers, and this is a pose"),
        ("rate(goal)", "`rate` needs a recorded signal of numbers, and this is an action"),
        ("rate(-speed)", "`rate` needs a recorded signal of numbers, and this is an expression"),
        ("rate(spede)", "there is no signal `spede`"),
        (
            "count(speed, over = 1 s)",
            "`count` needs a signal of truth values, and `speed` is in km/h",
        ),
        ('rate(speed)"\nunit = "m/s', "the value is in km/h/s, not in m/s"),
    ],
)
def test_each_mistake_has_one_message(table: str, message: str) -> None:
    declarations, wrong = read(f'[signal.v]\nvalue = "{table}"\n')
    assert [f"{each.code.number} {each.message}" for each in wrong] == [f"F356 {message}"]
    assert "v" not in declarations.measured


def test_a_mistake_names_the_place_and_the_remedy() -> None:
    _, (wrong,) = read('[signal.v]\nvalue = "max(speed, over = 2 m)"\n')
    assert render(wrong) == (
        "F356 `over` must be a duration greater than 0\n"
        "  --> bindings.toml:23:28\n"
        '   | value = "max(speed, over = 2 m)"\n'
        "   |                            ^^^\n"
        "help: state it as in `max(x, over = 500 ms)`"
    )


def test_a_proposition_cannot_call_a_function_with_memory() -> None:
    _, (wrong,) = read('[proposition.p]\nexpr = "rate(speed) > 1 m/s^2"\n')
    assert wrong.message == "only the `value` of a computed signal can call `rate`"


def test_a_recorded_signal_has_no_memory() -> None:
    declarations, _ = read("")
    assert declarations.signals["bumper"].memory is None
    assert declarations.signals["bumper"].field_unit == ONE
