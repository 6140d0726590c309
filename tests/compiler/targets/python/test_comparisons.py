"""Comparisons in generated monitors: the truth that an audit computes of samples."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import monitor as target
from compiler.targets.python.comparisons import (
    FUNCTIONS,
    NUMBER,
    ComparisonWriter,
    CompiledComparison,
    NotCompiledError,
    StepInput,
    fraction_text,
)
from fretc.logs.signals.measures import ExpressionError, NameValues
from fretc.logs.signals.propositions import truth, truth_values
from fretc.logs.signals.samples import widest
from fretish import expressions as e
from fretish.bindings.declarations import Declarations, Signal, path
from fretish.clock import Clock
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.units import unit
from monitors.kernel import Monitor, readings
from monitors.kernel.readings import number
from monitors.kernel.verdicts import Truth
from monitors.loading import load
from tests.bound_requirements import bound_requirement
from tests.monitoring import emitted, monitor

NAMES = ("x", "y", "z")
UNITS = ("m", "cm", "km", "mm")
SIGNS = ("<", "<=", ">", ">=", "=", "!=")
EDGES = (0, 1, 2, 3, 2**52 - 1, 2**52 + 1, 2**53 - 1, 2**53, 2**53 + 1, 2**63, 2**64 - 1)

digits = st.one_of(
    st.sampled_from(
        ["0", "0.1", "0.35", "0.9", "3", "1e400", "1e-400", "5e-324", "3.5e38", "1e308"]
    ),
    st.sampled_from(EDGES).map(str),
    st.sampled_from([f"{2**52}.5", f"{2**53 + 1}.5", f"{2**63 + 1}"]),
    st.integers(0, 20).map(str),
    st.fractions(0, 4, max_denominator=8).map(lambda f: str(float(f))),
)
floats = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True),
    st.sampled_from([0.0, -0.0, 0.1, 0.35, 0.9, 5e-324, -5e-324, 2.0**52, 2.0**53 + 2, 1e308]),
    st.integers(-20, 20).map(float),
)
whole = st.one_of(
    st.sampled_from([sign * n for n in EDGES for sign in (1, -1)]), st.integers(-9, 9)
)
singles = st.one_of(
    st.floats(width=32, allow_nan=True, allow_infinity=True),
    st.sampled_from([0.1, 0.35, 0.9, 1e-45, 3.4e38]),
).map(np.float32)
given_numbers = st.one_of(st.none(), floats, whole.filter(lambda n: n >= -(2**63)), singles)


def trees(leaves: st.SearchStrategy[e.Expression]) -> st.SearchStrategy[e.Comparison]:
    """Comparisons of numbers, of the kinds that bindings have, too."""

    def grown(parts: st.SearchStrategy[e.Expression]) -> st.SearchStrategy[e.Expression]:
        powers = st.integers(1, 4).map(lambda n: e.Number(str(n)))
        return st.one_of(
            st.builds(e.Negation, parts),
            st.builds(e.Arithmetic, st.sampled_from(["+", "-", "*", "/", "mod"]), parts, parts),
            st.builds(e.Arithmetic, st.just("^"), parts, powers),
            st.builds(e.Call, st.just("abs"), st.tuples(parts)),
            st.builds(e.Call, st.sampled_from(["min", "max"]), st.tuples(parts, parts)),
            st.builds(e.Call, st.sampled_from(["min", "max"]), st.tuples(parts, parts, parts)),
        )

    sides = st.recursive(leaves, grown, max_leaves=5)
    return st.builds(e.Comparison, st.sampled_from(SIGNS), sides, sides)


bare = trees(st.one_of(st.sampled_from(NAMES).map(e.Name), digits.map(e.Number)))
with_units = trees(
    st.one_of(
        st.sampled_from(NAMES).map(e.Name),
        st.builds(e.Quantity, digits, st.sampled_from(UNITS)),
    )
)
FACTORS = {name: found.factor for name in UNITS if (found := unit(name))}


def compiled(
    tree: e.Comparison, units: Mapping[str, tuple[str, Fraction]]
) -> Callable[[Mapping[str, Any]], Truth]:
    """The text of the comparison, executed as in a monitor."""
    names = {name.id for name in e.names(tree)}
    inputs = {name: StepInput(NUMBER) for name in sorted(names)}
    kept = {name: unit for name, unit in units.items() if name in names}
    text = ComparisonWriter({name: name for name in names}).comparison(
        CompiledComparison(inputs, tree, kept)
    )
    code = compile(text, "comparison", "eval")
    functions = {name: getattr(readings, name) for name in FUNCTIONS}

    def at(row: Mapping[str, Any]) -> Truth:
        values = {name: number(row[name], name) for name in names}
        result = eval(code, {**functions, **values})
        assert result in (None, True, False)
        return bool(result) if result is not None else None

    return at


def audited(tree: e.Comparison, row: Mapping[str, Any], scales: Mapping[str, Fraction]) -> Truth:
    """What an audit says of the same numbers as samples."""
    numbers = {name: widest(np.array([_sample(value)])) for name, value in row.items()}
    (value,) = truth_values(truth(tree, NameValues(1, numbers, scales=scales)))
    return value


def _sample(value: Any) -> Any:
    if value is None:
        return math.nan
    if isinstance(value, int):
        return np.uint64(value) if value > 2**63 - 1 else np.int64(value)
    return value


def both(tree: e.Comparison, row: Mapping[str, Any], units: Mapping[str, str]) -> None:
    known = {name: (each, FACTORS[each]) for name, each in units.items()}
    scales = {name: factor for name, (_, factor) in known.items()}
    try:
        by_monitor = compiled(tree, known)
    except NotCompiledError:
        assume(False)
        raise
    try:
        by_audit = audited(tree, row, scales)
    except (ExpressionError, ValueError):
        assume(False)
        raise
    assert by_monitor(row) is by_audit


rows = st.fixed_dictionaries(dict.fromkeys(NAMES, given_numbers))
X = e.Name("x")
HALF = e.Number(f"{2**52}.5")
NEXT = np.nextafter(np.float32(1), np.float32(2))
"""And beside it, numbers whose nearest 64-bit float is nearer to another 32-bit float."""
ABOVE = e.Number(f"1.{(2**36 + 1) * 5**60:060}")
BELOW = e.Number(f"1.{(3 * 2**36 - 1) * 5**60:060}")


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@given(bare, rows)
@example(e.Comparison("=", X, HALF), {"x": math.inf})
@example(e.Comparison("=", e.Arithmetic("+", X, HALF), HALF), {"x": 0.5})
@example(e.Comparison("<", X, e.Number("0.9")), {"x": np.float32(0.9)})
@example(e.Comparison("<", X, e.Number(str(2**53 + 1))), {"x": 2**53})
@example(e.Comparison("<", e.Call("min", (X, e.Name("y"))), e.Number("1")), {"x": 0, "y": math.nan})
@example(e.Comparison("=", e.Arithmetic("/", X, X), X), {"x": -0.0})
@example(e.Comparison("<=", X, ABOVE), {"x": NEXT})
@example(e.Comparison(">=", X, BELOW), {"x": NEXT})
@example(e.Comparison("<", X, e.Number(f"{2**53 + 1}.5")), {"x": 2**53 + 1})
@example(e.Comparison(">", e.Negation(X), e.Negation(e.Number("0.9"))), {"x": np.float32(0.9)})
@example(
    e.Comparison("<", e.Call("min", (X, e.Name("y"))), e.Number("0.9")),
    {"x": np.float32(0.9), "y": np.float32(2)},
)
@example(
    e.Comparison("<", e.Call("max", (X, e.Name("y"))), e.Number(str(2**53 + 5))),
    {"x": 2**53 + 1, "y": 2.0**53 + 4},
)
@example(
    e.Comparison("=", e.Call("min", (X, e.Number(str(2**60)))), e.Number(str(2**53))),
    {"x": 2**53 + 1},
)
def test_bare_numbers_compare_as_in_an_audit(tree: e.Comparison, row: dict[str, Any]) -> None:
    both(tree, row, {})


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@given(with_units, rows, st.fixed_dictionaries(dict.fromkeys(NAMES, st.sampled_from(UNITS))))
@example(e.Comparison("<", X, e.Name("y")), {"x": 35.0, "y": 0.35, "z": 0}, {"x": "cm", "y": "m"})
@example(e.Comparison("<", X, e.Quantity("35", "cm")), {"x": 0.35}, {"x": "m"})
def test_numbers_with_units_compare_as_in_an_audit(
    tree: e.Comparison, row: dict[str, Any], units: dict[str, str]
) -> None:
    both(tree, row, {name: each for name, each in units.items() if name in row})


# Without rounding -----------------------------------------------------------------------------

small = st.integers(-64, 64).map(lambda n: n / 8)


def exactly(tree: e.Expression, row: Mapping[str, float]) -> Fraction:
    match tree:
        case e.Number(text):
            return Fraction(text)
        case e.Name(id):
            return Fraction(row[id])
        case e.Negation(arg):
            return -exactly(arg, row)
        case e.Arithmetic(op, left, right):
            a, b = exactly(left, row), exactly(right, row)
            return {"+": a + b, "-": a - b, "*": a * b}[op]
        case e.Call(name, args):
            values = [exactly(arg, row) for arg in args]
            return abs(values[0]) if name == "abs" else (min if name == "min" else max)(values)
        case _:
            raise AssertionError(tree)


def _is_exact(tree: e.Expression) -> bool:
    parts = [tree]
    for part in parts:
        parts.extend(e.children(part))
    return not any(isinstance(part, e.Arithmetic) and part.op not in "+-*" for part in parts)


dyadic = trees(
    st.one_of(
        st.sampled_from(NAMES).map(e.Name),
        small.filter(lambda n: n >= 0).map(lambda n: e.Number(str(n))),
    )
).filter(_is_exact)


@pytest.mark.slow
@given(dyadic, st.fixed_dictionaries(dict.fromkeys(NAMES, small)))
def test_where_nothing_is_rounded_both_are_exact(tree: e.Comparison, row: dict[str, float]) -> None:
    left, right = exactly(tree.left, row), exactly(tree.right, row)
    op = tree.op
    expected = {
        "<": left < right,
        "<=": left <= right,
        ">": left > right,
        ">=": left >= right,
        "=": left == right,
        "!=": left != right,
    }[op]
    assert compiled(tree, {})(row) is expected
    assert audited(tree, row, {}) is expected


@given(st.fractions(), st.integers(0, 14))
def test_a_constant_is_written_exactly(fraction: Fraction, places: int) -> None:
    for value in (fraction, Fraction(fraction.numerator, 10**places)):
        assert Fraction(fraction_text(value)) == value


# Monitors -------------------------------------------------------------------------------------


def step(machine: Monitor, **values: object) -> str:
    return str(machine.step(**values))  # type: ignore[attr-defined]


def own(text: str) -> str:
    """What is of the one monitor, from the names of its variables on."""
    return text[text.index("# The requirements ---") :]


BATTERY = "whenever battery < 20 the agv shall within 1 ticks satisfy docking"


def test_a_monitor_is_stepped_by_numbers() -> None:
    machine = monitor(BATTERY)
    assert step(machine, battery=19.9, docking=False) == "pending"
    assert step(machine, battery=20, docking=False) == "violated"
    machine.reset()
    assert step(machine, battery=math.nan, docking=False) == "pending"
    assert step(machine, battery=None, docking=False) == "pending"
    assert machine.statuses()[0].verdict == "no data"


def test_rows_of_a_run_are_variables_in_their_order_or_by_name() -> None:
    for rows in ([(19, False), (30, False)], [{"battery": 19, "docking": 0 > 1}] * 2):
        assert monitor(BATTERY).run(rows) == "violated"  # type: ignore[attr-defined]
    with pytest.raises(ValueError, match="a row has 1 values for 2 variables"):
        monitor(BATTERY).run([(19,)])  # type: ignore[attr-defined]
    with pytest.raises(KeyError, match="docking"):
        monitor(BATTERY).run([{"battery": 19}])  # type: ignore[attr-defined]


def test_the_truth_of_comparisons_is_what_a_monitor_advances_by() -> None:
    machine: Any = monitor(BATTERY)
    assert tuple(machine.PROPOSITIONS) == ("(battery < 20)", "docking")
    row = machine.truths(battery=19, docking=np.bool_(False))
    assert row == (True, False)
    machine.advance([row])
    machine.advance([{"(battery < 20)": False, "docking": None}])
    assert machine.verdicts() == ("pending",)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"battery": "19", "docking": True},
            "`battery` is a number, or None or NaN .unknown., not '19'",
        ),
        ({"battery": True, "docking": True}, "`battery` is a number, .* not True"),
        ({"battery": np.bool_(True), "docking": True}, "`battery` is a number"),
        ({"battery": [1], "docking": True}, "`battery` is a number"),
        ({"battery": 1 + 0j, "docking": True}, "`battery` is a number"),
        ({"battery": 1, "docking": 1}, "`docking` is True, False or None"),
        ({"battery": 1, "docking": math.nan}, "`docking` is True, False or None"),
    ],
)
def test_a_value_of_another_kind_is_refused_and_changes_nothing(
    values: dict[str, object], message: str
) -> None:
    machine = monitor(BATTERY)
    with pytest.raises(TypeError, match=message):
        step(machine, **values)
    assert machine.tick == -1


@given(st.sampled_from([np.float64, np.float16, np.int8, np.uint64, np.longdouble, float, int]))
def test_numbers_of_numpy_are_numbers(kind: type) -> None:
    assert number(kind(7), "x") == 7
    assert type(number(kind(7), "x")) is float


def test_large_whole_numbers_stay_what_they_are() -> None:
    machine = monitor(f"the sw shall always satisfy x < {2**53 + 1}")
    for value in (2**53, np.int64(2**53), np.uint64(2**53)):
        machine.reset()
        assert step(machine, x=value) == "pending"
        assert step(machine, x=value + type(value)(1)) == "violated"


def test_what_is_compared_in_another_unit_is_converted() -> None:
    signals = {
        name: Signal(name, where, found, each)
        for name, each in (("v", "km/h"), ("w", "m/s"))
        if (where := path(f"/{name}.data")) and (found := unit(each))
    }
    declared = Declarations(Source("bindings.toml", ""), Clock(10**8), signals, {})
    source = Source("r.fret", "the sw shall always satisfy v <= w & v < 90")
    requirement, _ = formalize(RequirementEntry("R1", source.span()), declared)
    assert requirement is not None
    text = target.text(requirement)
    assert 'compared(in_base(v, exact("5/18")), "<=", in_base(w, exact("1")))' in text
    machine = load("monitor", text)
    assert step(machine, v=36, w=10) == "pending"
    assert step(machine, v=36.001, w=10) == "violated"


BINDINGS = """
[clock]
tick = "100 ms"
[signal.way]
path = "/way.data"
unit = "m"
[signal.gap]
path = "/gap.data"
unit = "cm"
[signal.v]
path = "/v.data"
unit = "m/s"
[signal.mode]
path = "/mode.data"
values = ["drive", "docking"]
[signal.wish]
path = "/wish.data"
values = ["drive", "docking"]
[proposition."(speed <= 150)"]
expr = "v <= 150 cm/s"
"""


def of(sentence: str) -> FormalizedRequirement:
    return bound_requirement(f"the sw shall always satisfy {sentence}", BINDINGS)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sentence", "values", "expected"),
    [
        ("50 % * way > gap", {"way": 1.0, "gap": 60.0}, False),
        ("50 % * way > gap", {"way": 1.0, "gap": 40.0}, True),
        ("50 % * way > 40", {"way": 1.0}, False),
        ("way > v * 2 s", {"way": 3.0, "v": 1.4}, True),
        ("way > v * 2 s", {"way": 3.0, "v": 1.6}, False),
        ("gap > v * 1 min", {"gap": 61.0, "v": 0.01}, True),
        ("gap > v * 1 min", {"gap": 59.0, "v": 0.01}, False),
        ("gap / 2 s < v", {"gap": 150.0, "v": 0.76}, True),
        ("gap / 2 s < v", {"gap": 150.0, "v": 0.74}, False),
        ("gap + way > 1 % * 20 m", {"way": 0.0, "gap": 19.0}, False),
        ("gap + way > 1 % * 20 m", {"way": 0.0, "gap": 21.0}, True),
        ("gap + way > 20 cm / 2", {"way": 0.0, "gap": 9.0}, False),
        ("gap + way > 20 cm / 2", {"way": 0.0, "gap": 11.0}, True),
        ("gap + way > 2 * minReal(10 cm, 1 m)", {"way": 0.0, "gap": 19.0}, False),
        ("gap + way > 2 * minReal(10 cm, 1 m)", {"way": 0.0, "gap": 21.0}, True),
        ("gap / 3 m < 50 %", {"gap": 149.0}, True),
        ("gap / 3 m < 50 %", {"gap": 151.0}, False),
    ],
)
def test_a_quantity_that_multiplies_is_one_in_audits_and_monitors(
    sentence: str, values: Mapping[str, float], expected: bool
) -> None:
    requirement = of(sentence)
    assert requirement.declarations is not None
    (proposition,) = (
        requirement.declarations.propositions[name] for name in requirement.propositions
    )
    signals = requirement.declarations.signals
    numbers = {name: np.array([value]) for name, value in values.items()}
    scales = {name: signals[name].scale for name in values}
    (audited,) = truth_values(truth(proposition.expression, NameValues(1, numbers, scales=scales)))
    machine: Any = load("monitor", target.text(requirement))
    assert (audited, machine.truths(**values)) == (expected, (expected,))


def test_two_signals_of_words_are_words_of_a_monitor() -> None:
    machine: Any = load("monitor", target.text(of("mode = wish")))
    rows = (("drive", "drive"), ("drive", "docking"), (None, "drive"))
    assert [machine.truths(*row) for row in rows] == [(True,), (False,), (None,)]


def test_a_comparison_that_is_bound_to_other_names_stays_a_proposition() -> None:
    """Its variables are none of the log's, and nothing says in which unit they are."""
    machine: Any = load("monitor", target.text(of("speed <= 150")))
    assert dict(machine.PROPOSITIONS) == {"(speed <= 150)": "speed_le_150"}
    assert not hasattr(machine, "VARIABLES")


def test_numbers_alone_need_no_variables() -> None:
    machine: Any = load("monitor", target.text(of("3 m > 20 cm")))
    assert machine.step(**dict.fromkeys(machine.PROPOSITIONS.values(), True)) == "pending"


# What looks back ------------------------------------------------------------------------------


def test_the_number_of_the_tick_before_is_kept_saved_and_forgotten() -> None:
    sentence = "the sw shall always satisfy preReal(0.5, x) <= x"
    machine = monitor(sentence)
    assert step(machine, x=0.5) == "pending"
    assert step(machine, x=2.0) == "pending"
    other = monitor(sentence)
    other.restore(machine.state())
    for each in (machine, other):
        assert step(each, x=1.5) == "violated"
    machine.reset()
    assert step(machine, x=0.25) == "violated"


@given(st.one_of(st.none(), floats, whole, singles))
def test_a_saved_state_holds_any_number(value: Any) -> None:
    machine: Any = LOOKS_BACK
    machine.reset()
    machine.take([(value,)])
    kept, state = machine.kept, machine.state()
    machine.reset()
    machine.restore(state)
    assert machine.kept == kept
    assert [type(each) for each in machine.kept] == [type(each) for each in kept]
    for changed in ({**state, "kept": None}, {**state, "program": "x"}, {}):
        with pytest.raises(ValueError, match="the state"):
            machine.restore(changed)


LOOKS_BACK = monitor("the sw shall always satisfy preInt(0, x) <= x")


def test_what_was_unknown_is_unknown_a_tick_later() -> None:
    machine: Any = monitor("the sw shall always satisfy preReal(0, preReal(1, x)) + x > 0")
    told = [machine.truths(value)[0] for value in (1.0, math.nan, 3.0, 4.0, -9.0, 0.0)]
    assert told == [True, None, True, None, False, True]


def test_a_row_that_is_refused_is_no_tick_that_is_looked_back_at() -> None:
    machine: Any = monitor("the sw shall always satisfy preReal(0, x) < x")
    machine.take([(1.0,)])
    with pytest.raises(TypeError):
        machine.take([(5.0,), ("6",)])
    assert (machine.tick, machine.kept) == (0, (1.0,))


# What stays a proposition ---------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sentence", "variables"),
    [
        ("the sw shall always satisfy sinReal(x) < 1", None),
        ("the sw shall always satisfy x & x < 1", None),
        ("the sw shall always satisfy x ^ y < 1", None),
        ("the sw shall always satisfy x ^ 17 < 1", None),
        (f"the sw shall always satisfy x < {'9' * 61}", None),
        ("the sw shall always satisfy x < 1e1000", None),
        (f"the sw shall always satisfy minReal({', '.join('x' * 200)}) < 1", None),
        ("the sw shall always satisfy p & absReal(x, y) < 1", None),
        (
            "the sw shall always satisfy f(x) & cos(x) < 1 & x < 1",
            {"f(x)": "truth", "(cos(x) < 1)": "truth", "x": "number"},
        ),
        (
            "the sw shall always satisfy persisted(2, x > 1) & kept & number < 2",
            {"x": "number", "kept": "truth", "number": "number"},
        ),
    ],
)
def test_what_is_not_understood_stays_a_proposition(
    sentence: str, variables: dict[str, str] | None
) -> None:
    machine: Any = monitor(sentence)
    if variables is None:
        assert not hasattr(machine, "VARIABLES")
    else:
        assert {name: each.kind for name, each in machine.VARIABLES.items()} == variables


def test_a_comparison_that_divides_by_zero_is_unknown_and_one_of_numbers_is_decided() -> None:
    machine: Any = monitor("the sw shall always satisfy x < 1 / 0 & x = x & 1 / 3 < 0.5")
    assert machine.truths(x=3.0) == (None, True, True)
    assert machine.truths(x=1e308) == (None, True, True)
    assert machine.truths(x=math.inf) == (None, None, True)
    assert machine.truths(x=None) == (None, None, True)


def test_a_variable_of_one_requirement_is_of_the_same_kind_in_all_of_a_file() -> None:
    alone = emitted("the sw shall always satisfy x < 2")
    assert "VARIABLES" in own(alone)
    assert "VARIABLES" not in own(
        emitted("the sw shall always satisfy x < 2", "the sw shall satisfy x")
    )


def test_propositions_alone_need_no_numbers() -> None:
    assert "kind: str" not in emitted("whenever p the sw shall satisfy q")
