"""What is the same in bindings however it is written, and what is not."""

from dataclasses import fields, replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.signals.measures import NameValues
from fretc.logs.signals.propositions import truth
from fretish import units
from fretish.bindings.canonical import bound, clock, expression, parameter
from fretish.bindings.declarations import (
    REP_117,
    Aggregate,
    Declarations,
    FramePose,
    GoalChoice,
    GoalStatus,
    Memory,
    Modality,
    Path,
    PoseNumber,
    Reduce,
    Role,
)
from fretish.bindings.expressions import parse
from fretish.bindings.tables.reader import read_bindings
from fretish.clock import Clock, End, Rounding, TimeSource
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.expressions import Expression

TEXT = """\
[clock]
tick = "100 ms"

[signal.x]
path = "/a.x[:]"
unit = "m"
reduce = "min"

[proposition.p]
expr = "x > 1 m"
"""


def declared() -> Declarations:
    found, wrong = read_bindings(Source("bindings.toml", TEXT))
    assert found is not None, wrong
    return found


def read(text: str) -> Expression:
    found = parse(Source("e", text).span())
    assert not isinstance(found, Diagnostic), found
    return found


SIGNAL: dict[str, Any] = {
    "path": Path("/a", ("x",), 3),
    "unit": units.unit("cm"),
    "type": "S",
    "reduce": Reduce.MAX,
    "valid": read("x < 9"),
    "invalid": REP_117,
    "max_age": 5,
    "values": ("a", "b"),
    "memory": Memory("max", "x", 5, None, units.ONE),
    "pose": FramePose("base_link", "map", PoseNumber.YAW),
    "goals": GoalStatus("/a", GoalChoice.ANY, ("aborted",)),
}
PROPOSITION: dict[str, Any] = {
    "expression": read("x > 2 m"),
    "aggregate": Aggregate.ANY,
    "on_unknown": True,
}
CLOCK: dict[str, Any] = {
    "period": 5,
    "topic": "/a",
    "time": TimeSource.PUBLISH_TIME,
    "end": End.VIOLATED,
    "phase": 7,
}
OUTLINE: dict[str, Any] = {
    "footprint": ((0.0, 0.0), (1.0, 0.0), (0.0, 2.0)),
    "sensor": (1.0, 0.0, 0.0),
}
APART = {
    "signal": {"name", "unit_name", "role", "aggregate", "span", "numbers", *OUTLINE},
    "proposition": {"name", "text", "role", "kind", "modality", "action", "span"},
    "clock": {"rounding", "lateness"},
}
"""What no verdict depends on but through its formulas; the outline only where it is asked for."""


@pytest.mark.parametrize("field", SIGNAL)
def test_each_field_of_a_signal_counts(field: str) -> None:
    known = declared()
    other = replace(known.signals["x"], **{field: SIGNAL[field]})
    assert bound(replace(known, signals={"x": other}), ["p"]) != bound(known, ["p"])


@pytest.mark.parametrize("field", OUTLINE)
def test_the_outline_counts_where_it_is_measured_from(field: str) -> None:
    known = declared()
    for reduce, counts in ((Reduce.OUTLINE, True), (Reduce.MIN, False)):
        one = replace(known.signals["x"], reduce=reduce)
        other = replace(one, **{field: OUTLINE[field]})
        meanings = [bound(replace(known, signals={"x": each}), ["p"]) for each in (one, other)]
        assert (meanings[0] != meanings[1]) is counts


def test_the_number_of_each_word_counts_and_the_order_of_words_does_not() -> None:
    def meaning(values: tuple[str, ...], numbers: tuple[int, ...]) -> Any:
        signal = replace(declared().signals["x"], values=values, numbers=numbers)
        return bound(replace(declared(), signals={"x": signal}), ["p"])

    assert meaning(("a", "b"), ()) == meaning(("b", "a"), ())
    assert meaning(("a", "b"), (0, 4)) == meaning(("b", "a"), (4, 0))
    both = ("a", "b")
    cases = [((), ()), (("a",), ()), (both, ()), (both, (0, 1)), (both, (1, 0))]
    assert len({str(meaning(*each)) for each in cases}) == len(cases)


@pytest.mark.parametrize("field", PROPOSITION)
def test_each_field_of_a_proposition_counts(field: str) -> None:
    known = declared()
    other = replace(known.propositions["p"], **{field: PROPOSITION[field]})
    assert bound(replace(known, propositions={"p": other}), ["p"]) != bound(known, ["p"])


def test_what_is_told_to_people_and_to_other_tools_does_not_count() -> None:
    known = declared()
    other = replace(
        known.propositions["p"],
        text="t",
        role=Role.INPUT,
        kind="belief",
        modality=Modality.GOAL,
        action="a",
    )
    assert bound(replace(known, propositions={"p": other}), ["p"]) == bound(known, ["p"])


@pytest.mark.parametrize("field", CLOCK)
def test_each_field_of_the_clock_counts(field: str) -> None:
    assert clock(replace(Clock(10**8), **{field: CLOCK[field]})) != clock(Clock(10**8))


@pytest.mark.parametrize("time", TimeSource)
def test_lateness_counts_where_messages_can_be_late(time: TimeSource) -> None:
    of_before = clock(Clock(10**8, time=time))
    late = [clock(Clock(10**8, time=time, lateness=each)) for each in (None, 0, 5)]
    assert late[0] == of_before
    assert len({str(each) for each in late}) == (1 if time is TimeSource.LOG_TIME else 3)


def test_rounding_shows_in_the_formulas_of_those_that_are_rounded() -> None:
    rounded = replace(Clock(10**8), rounding=Rounding.CONSERVATIVE)
    assert clock(rounded) == clock(Clock(10**8))


def test_no_field_is_forgotten() -> None:
    known = declared()
    for kind, value, counted in (
        ("signal", known.signals["x"], SIGNAL),
        ("proposition", known.propositions["p"], PROPOSITION),
        ("clock", known.clock, CLOCK),
    ):
        assert {field.name for field in fields(value)} == {*counted, *APART[kind]}


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("x < 35 cm", "x < 0.35 m"),
        ("x < 35 cm", "x < 350 mm"),
        ("x < 35 %", "x < 0.35"),
        ("x < 1.50", "x < 1.5"),
        ("x < 1 m for 300 ms", "x < 1 m for 0.3 s"),
        ("(x < 1 m) and (y < 2 m)", "x < 1 m and y < 2 m"),
        ("x < 36 km/h", "x < 10 m/s"),
    ],
)
def test_the_same_in_other_words(one: str, other: str) -> None:
    assert expression(read(one)) == expression(read(other))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("x < 35 cm", "x <= 35 cm"),
        ("x < 35 cm", "x < 36 cm"),
        ("x < 1 m", "x < 1 s"),
        ("x < 0 m", "x < 0"),
        ("x < 1 m", "y < 1 m"),
        ("x < 1 m for 300 ms", "x < 1 m for 300 us"),
        ("x < 1 m for 300 ms", "x < 1 m"),
        ("x < 1 m and y < 1 m", "x < 1 m or y < 1 m"),
        ("not (x < 1 m)", "x < 1 m"),
        ("min(x, y) < 1 m", "max(x, y) < 1 m"),
        ("x + y < 1 m", "x - y < 1 m"),
        ("-x < 1 m", "x < 1 m"),
        ("x - (y - z) < 1 m", "x - y - z < 1 m"),
        ("x < 0.1 m", "x < 0.1000000000000000055 m"),
        ("true", "false"),
    ],
)
def test_something_else(one: str, other: str) -> None:
    assert expression(read(one)) != expression(read(other))


def test_in_valid_a_percentage_is_read_in_the_unit_of_the_field_and_a_number_is_not() -> None:
    one, other = read("x < 35 %"), read("x < 0.35")
    values = {"x": np.array([0.3, 3.0])}
    percent = units.unit("%")
    assert percent is not None
    scope = NameValues(2, values, unit=percent)
    assert truth(one, scope).tolist() != truth(other, scope).tolist()
    assert expression(one, plain=False) != expression(other, plain=False)


NAMES = {
    "mm": Fraction(1000),
    "cm": Fraction(100),
    "dm": Fraction(10),
    "m": Fraction(1),
    "km": Fraction(1, 1000),
}
LENGTHS = st.sampled_from([0, 1, 2, 3, 9]).flatmap(
    lambda digits: st.integers(0, 3 * 10**digits).map(lambda n: Fraction(n, 10**digits))
)


@pytest.mark.slow
@given(
    LENGTHS,
    st.sampled_from(sorted(NAMES)),
    st.sampled_from(sorted(NAMES)),
    st.sampled_from(["<", "<=", ">", ">=", "=", "!="]),
    st.sampled_from([np.float32, np.float64]),
    st.sampled_from(sorted(NAMES)),
)
def test_what_is_the_same_is_the_same_of_every_sample(
    length: Fraction, one: str, other: str, op: str, kind: type, field: str
) -> None:
    first, second = (
        read(f"x {op} {_decimal(length * NAMES[unit])} {unit}") for unit in (one, other)
    )
    assert expression(first) == expression(second)
    near: Any = np.array([float(length * NAMES[field])], kind)
    around = [np.nextafter(near, kind(-9e9)), near, np.nextafter(near, kind(9e9))]
    scale = 1 / Fraction(NAMES[field])
    scope = NameValues(3, {"x": np.concatenate(around)}, scales={"x": scale})
    assert truth(first, scope).tolist() == truth(second, scope).tolist()


def _decimal(value: Fraction) -> str:
    digits = f"{int(value * 10**12):013d}"
    return f"{digits[:-12]}.{digits[-12:]}"


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("5 cm", "0.05 m", True),
        ("5 cm", " 5.0  cm", True),
        ("5 cm", "5 m", False),
        ("5", "5 m", False),
        ("soon", "soon", True),
        ("soon", "later", False),
    ],
)
def test_numbers_that_a_requirement_states(one: str, other: str, same: bool) -> None:
    assert (parameter(one) == parameter(other)) is same
