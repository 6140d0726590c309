import math
from collections.abc import Mapping, Sequence

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fretc.logs.signals.measures import ExpressionError, NameValues, number
from fretc.logs.signals.propositions import StepFunction, evaluate, truth
from fretc.logs.signals.samples import Recording, Samples
from fretish import expressions as e
from fretish.bindings import expressions as binding
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from tests.fretc.logs.logs import declare

NAN, INF = float("nan"), float("inf")
Pairs = Sequence[tuple[int, float]]
Value = bool | None


def recording(
    signals: Mapping[str, Pairs],
    gaps: Sequence[tuple[int, int]] = (),
    start: int = 0,
    end: int = 100,
) -> Recording:
    return Recording(
        name="log",
        sha256="",
        size=0,
        start_ns=start,
        end_ns=end,
        samples={
            name: Samples(
                np.array([time for time, _ in pairs], np.int64),
                np.array([value for _, value in pairs], np.float64),
            )
            for name, pairs in signals.items()
        },
        ticks=np.zeros(0, np.int64),
        gaps=tuple(gaps),
        topics={},
        nearest={},
        findings=(),
        intact=not gaps,
    )


def steps(expression: str, log: Recording, max_age: str = "", unit: str = "1") -> StepFunction:
    age = f'max_age = "{max_age}"\n' if max_age else ""
    signals = "".join(
        f'[signal.{name}]\npath = "/{name}.data"\nunit = "{unit}"\n{age}' for name in ("x", "y")
    )
    text = f'[clock]\ntick = "10 ns"\n{signals}[proposition.p]\nexpr = "{expression}"\n'
    declarations = declare(text)
    return evaluate(declarations.propositions["p"], declarations, log)


def proposition(expression: str) -> e.Expression:
    found = binding.parse(Source("b", expression).span())
    assert not isinstance(found, Diagnostic)
    return found


def pairs(found: StepFunction) -> list[tuple[int, Value]]:
    return list(zip(found.times.tolist(), found.values, strict=True))


# Samples


def test_each_sample_is_a_step_even_when_nothing_changes() -> None:
    found = steps("x < 5", recording({"x": [(10, 1.0), (20, 2.0), (30, 9.0)]}))
    assert pairs(found) == [(0, None), (10, True), (20, True), (30, False)]


def test_a_sample_counts_up_to_its_greatest_age_and_not_longer() -> None:
    found = steps("x < 5", recording({"x": [(10, 1.0), (20, 2.0), (60, 3.0)]}), "15 ns")
    assert pairs(found) == [
        (0, None),
        (10, True),
        (20, True),
        (36, None),
        (60, True),
        (76, None),
    ]


def test_a_sample_that_comes_just_in_time_leaves_nothing_unknown() -> None:
    found = steps("x < 5", recording({"x": [(0, 1.0), (16, 2.0)]}, end=20), "15 ns")
    assert pairs(found) == [(0, True), (16, True)]


def test_a_sample_of_just_the_greatest_age_still_counts() -> None:
    log = recording({"x": [(10, 1.0)], "y": [(25, 1.0), (26, 1.0)]})
    found = steps("x < 5 and y < 5", log, "15 ns")
    assert pairs(found) == [(0, None), (10, None), (25, True), (26, None), (42, None)]


def test_an_unknown_sample_is_unknown_and_does_not_keep_the_one_before() -> None:
    found = steps("x < 5", recording({"x": [(10, 1.0), (20, NAN), (30, 9.0)]}))
    assert pairs(found) == [(0, None), (10, True), (20, None), (30, False)]


def test_within_a_gap_and_until_the_next_sample_all_is_unknown() -> None:
    log = recording({"x": [(10, 1.0), (25, 2.0), (40, 3.0)]}, gaps=[(20, 30)])
    assert pairs(steps("x < 5", log)) == [
        (0, None),
        (10, True),
        (20, None),
        (25, None),  # a sample within the gap that survived
        (30, None),
        (40, True),
    ]


def test_a_sample_at_the_edge_of_a_gap_is_lost_with_it() -> None:
    log = recording({"x": [(10, 1.0), (20, 2.0), (30, 3.0), (31, 4.0)]}, gaps=[(20, 30)])
    assert pairs(steps("x < 5", log)) == [
        (0, None),
        (10, True),
        (20, None),
        (30, None),
        (31, True),
    ]


@pytest.mark.parametrize("last", [10, 20, 25, 30])
def test_what_was_known_before_a_gap_is_not_known_after_it(last: int) -> None:
    log = recording({"x": [(last, 1.0), (40, 1.0)], "y": [(35, 9.0)]}, gaps=[(20, 30)])
    assert pairs(steps("x < 5 or y < 5", log))[-2:] == [(35, None), (40, True)]


def test_samples_of_one_message_change_together() -> None:
    log = recording({"x": [(10, 1.0), (20, 9.0)], "y": [(10, 9.0), (20, 1.0)]})
    found = steps("x < 5 and y < 5", log)
    assert pairs(found) == [(0, None), (10, False), (20, False)]


def test_samples_with_equal_times_are_a_step_each() -> None:
    log = recording({"x": [(10, 9.0), (20, 1.0), (20, 9.0)], "y": [(20, 1.0), (20, 1.0)]})
    assert pairs(steps("x < 5", log)) == [(0, None), (10, False), (20, True), (20, False)]
    assert pairs(steps("x < 5 and y < 5", log)) == [
        (0, None),
        (10, False),
        (20, True),
        (20, False),
    ]


def test_a_signal_without_samples_is_unknown() -> None:
    assert pairs(steps("x < 5", recording({"x": []}))) == [(0, None)]
    assert pairs(steps("x < 5", recording({}))) == [(0, None)]
    assert pairs(steps("x < 5 or true", recording({}))) == [(0, True)]


def test_nothing_is_told_after_the_end() -> None:
    found = steps("x < 5", recording({"x": [(90, 1.0)]}, end=90), "15 ns")
    assert pairs(found) == [(0, None), (90, True)]


def test_numbers_are_compared_in_the_base_unit() -> None:
    log = recording({"x": [(0, 0.05)]})
    assert pairs(steps("x <= 5 cm", log, unit="m")) == [(0, True)]
    assert pairs(steps("x < 5 cm", log, unit="cm")) == [(0, False)]
    assert pairs(steps("x < 51 mm", log, unit="km")) == [(0, True)]


# Arithmetic and logic


def scope(**numbers: float) -> NameValues:
    return NameValues(1, {name: np.array([value]) for name, value in numbers.items()})


@pytest.mark.parametrize(
    ("op", "left", "right", "expected"),
    [
        ("+", 1.0, 2.0, 3.0),
        ("-", 1.0, 2.0, -1.0),
        ("*", 3.0, 2.0, 6.0),
        ("/", 3.0, 2.0, 1.5),
        ("/", 3.0, 0.0, NAN),
        ("/", 0.0, 0.0, NAN),
        ("/", 3.0, -0.0, NAN),
        ("/", 3.0, INF, 0.0),
        ("+", NAN, 2.0, NAN),
        ("*", INF, 2.0, INF),
        ("-", INF, INF, NAN),
        ("*", 0.0, INF, NAN),
    ],
)
def test_arithmetic(op: e.ArithmeticOperator, left: float, right: float, expected: float) -> None:
    found = number(e.Arithmetic(op, e.Name("x"), e.Name("y")), scope(x=left, y=right))
    assert found[0] == pytest.approx(expected, nan_ok=True)


@pytest.mark.parametrize(
    ("name", "expected"), [("abs", [3.0]), ("min", [NAN, -3.0]), ("max", [NAN, 2.0])]
)
def test_functions(name: str, expected: list[float]) -> None:
    x, y, z = e.Name("x"), e.Name("y"), e.Name("z")
    values = scope(x=-3.0, y=2.0, z=NAN)
    if name == "abs":
        assert number(e.Call("abs", (x,)), values).tolist() == expected
        return
    assert math.isnan(number(e.Call(name, (x, z)), values)[0])
    assert number(e.Call(name, (x, y)), values)[0] == expected[1]
    assert number(e.Call(name, (y, x)), values)[0] == expected[1]


@pytest.mark.parametrize(
    ("op", "below", "equal", "above"),
    [
        ("<", True, False, False),
        ("<=", True, True, False),
        (">", False, False, True),
        (">=", False, True, True),
        ("=", False, True, False),
        ("!=", True, False, True),
    ],
)
def test_comparisons(op: e.ComparisonOperator, below: bool, equal: bool, above: bool) -> None:
    compare = e.Comparison(op, e.Name("x"), e.Number("5"))
    for value, expected in [(4.0, 2 * below), (5.0, 2 * equal), (6.0, 2 * above), (NAN, 1)]:
        assert truth(compare, scope(x=value)).tolist() == [expected]


T, F, U = e.Truth(True), e.Truth(False), e.Comparison("<", e.Name("u"), e.Number("1"))


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (e.And((T, U)), 1),
        (e.And((F, U)), 0),
        (e.And((T, T)), 2),
        (e.Or((T, U)), 2),
        (e.Or((F, U)), 1),
        (e.Or((F, F)), 0),
        (e.Not(U), 1),
        (e.Not(T), 0),
        (e.Implies(F, U), 2),
        (e.Implies(U, T), 2),
        (e.Implies(U, F), 1),
        (e.Implies(T, F), 0),
        (e.Iff(U, U), 1),
        (e.Iff(F, F), 2),
        (e.Iff(T, F), 0),
        (e.Xor(T, F), 2),
        (e.Xor(T, T), 0),
        (e.Xor(T, U), 1),
    ],
)
def test_logic_is_kleenes(expression: e.Expression, expected: int) -> None:
    assert truth(expression, scope(u=NAN)).tolist() == [expected]


@pytest.mark.parametrize(
    "expression",
    [e.Number("1"), e.Comparison("<", T, e.Number("1")), U, e.Persistence(T, 5), e.Call("sin", ())],
)
def test_what_has_no_truth_is_refused(expression: e.Expression) -> None:
    with pytest.raises(ExpressionError):
        truth(expression, scope(x=1.0))


# Durations


def test_held_is_true_once_it_was_true_for_that_long() -> None:
    log = recording({"x": [(0, 1.0), (30, 1.0), (50, 9.0), (60, 1.0)]})
    assert pairs(steps("x < 5 for 20 ns", log)) == [
        (0, None),
        (20, True),
        (30, True),
        (50, False),
        (60, False),
        (80, True),
    ]


def test_held_is_unknown_at_the_start_unless_something_false_was_seen() -> None:
    assert pairs(steps("x < 5 for 20 ns", recording({"x": [(0, 9.0), (10, 1.0)]}))) == [
        (0, False),
        (10, False),
        (30, True),
    ]
    assert pairs(steps("x < 5 for 20 ns", recording({"x": [(0, 1.0), (10, 1.0)]}))) == [
        (0, None),
        (10, None),
        (20, True),
    ]


def test_a_moment_of_unknown_makes_held_unknown_for_that_long() -> None:
    log = recording({"x": [(0, 1.0), (40, NAN), (41, 1.0)]})
    assert pairs(steps("x < 5 for 20 ns", log)) == [
        (0, None),
        (20, True),
        (40, None),
        (41, None),
        (61, True),
    ]


def test_a_false_sample_among_equal_times_ends_what_was_held() -> None:
    log = recording({"x": [(0, 1.0), (40, 9.0), (40, 1.0)]})
    assert pairs(steps("x < 5 for 20 ns", log))[-3:] == [(40, False), (40, False), (60, True)]


def test_held_is_a_part_like_any_other() -> None:
    log = recording({"x": [(0, 1.0)], "y": [(0, 9.0), (10, 1.0)]})
    found = steps("(x < 5 for 20 ns) and not (y < 5 for 30 ns)", log)
    assert pairs(found) == [(0, None), (10, None), (20, True), (40, False)]


def slow_value(samples: Pairs, gaps: Sequence[tuple[int, int]], age: int, at: int) -> float:
    before = [(time, value) for time, value in samples if time <= at]
    if not before:
        return NAN
    time, value = before[-1]
    lost = any(start <= at and (at <= end or time <= end) for start, end in gaps)
    return NAN if lost or at - time > age else value


def slow_truth(value: float) -> Value:
    return None if math.isnan(value) else value < 5


def slow_held(column: Sequence[Value], at: int, duration: int) -> Value:
    window = [column[t] if t >= 0 else None for t in range(at - duration, at + 1)]
    return False if False in window else None if None in window else True


samples_strategy = st.lists(
    st.tuples(st.integers(0, 60), st.sampled_from([1.0, 9.0, NAN])),
    max_size=8,
    unique_by=lambda pair: pair[0],
).map(lambda found: sorted(found, key=lambda pair: pair[0]))


@pytest.mark.slow
@settings(deadline=None)
@given(
    samples_strategy,
    st.lists(st.tuples(st.integers(0, 60), st.integers(0, 15)), max_size=2),
    st.integers(1, 30),
    st.integers(0, 25),
)
@example([(0, 1.0)], [], 30, 0)
@example([(0, 1.0), (20, 1.0)], [], 30, 7)
@example([(0, 1.0), (10, 9.0), (12, 1.0)], [(5, 3)], 20, 5)
def test_held_agrees_with_looking_at_every_nanosecond(
    samples: Pairs, lengths: Sequence[tuple[int, int]], age: int, duration: int
) -> None:
    gaps = [(start, start + length) for start, length in lengths]
    log = recording({"x": samples}, gaps=gaps, end=80)
    found = steps(f"x < 5 for {duration} ns", log, f"{age} ns")
    inner = [slow_truth(slow_value(samples, gaps, age, t)) for t in range(81)]
    expected = [slow_held(inner, t, duration) for t in range(81)]
    at = np.searchsorted(found.times, np.arange(81), "right") - 1
    assert [found.values[i] for i in at] == expected
    changes = [t for t in range(1, 81) if expected[t] != expected[t - 1]]
    assert set(changes) <= set(found.times.tolist())


# Several samples at one instant: the definition, moment by moment

Moment = tuple[int, int]
"""A nanosecond, and the place among the steps of that nanosecond."""
LAST = 40


class Slowly:
    """Expressions of two signals by their definition; a log from 0 to `LAST` without gaps."""

    def __init__(self, samples: Mapping[str, Pairs]) -> None:
        self.samples = samples

    def count(self, time: int) -> int:
        """How many steps there are at a nanosecond: as many as samples of one signal, or one."""
        return max(1, *(sum(t == time for t, _ in pairs) for pairs in self.samples.values()))

    def value(self, name: str, moment: Moment) -> float:
        time, place = moment
        now = [value for t, value in self.samples[name] if t == time]
        before = [value for t, value in self.samples[name] if t < time]
        return now[min(place, len(now) - 1)] if now else before[-1] if before else NAN

    def truth(self, expression: e.Expression, moment: Moment) -> Value:
        match expression:
            case e.Comparison(_, e.Name(name), _):
                value = self.value(name, moment)
                return None if math.isnan(value) else value < 5
            case e.Not(arg):
                found = self.truth(arg, moment)
                return None if found is None else not found
            case e.And(args):
                each = [self.truth(arg, moment) for arg in args]
                return False if False in each else None if None in each else True
            case e.Persistence(arg, duration):
                return self.held(arg, moment[0], duration)
            case _:
                raise AssertionError(expression)

    def held(self, arg: e.Expression, time: int, duration: int) -> Value:
        """What was in force `duration` ago, and all steps after that up to now, now's included."""
        begin = time - duration
        seen = [None if begin < 0 else self.truth(arg, (begin, self.count(begin) - 1))]
        for t in range(max(0, begin + 1), time + 1):
            seen += [self.truth(arg, (t, place)) for place in range(self.count(t))]
        return False if False in seen else None if None in seen else True


crowded = st.lists(
    st.tuples(st.integers(0, LAST // 4), st.sampled_from([1.0, 9.0, 9.0, NAN])), max_size=9
).map(lambda found: sorted(((4 * time, value) for time, value in found), key=lambda p: p[0]))


@pytest.mark.slow
@settings(deadline=None)
@given(
    crowded,
    crowded,
    st.sampled_from(
        [
            "x < 5 and not (y < 5 for {} ns)",
            "(x < 5 for {} ns) and y < 5",
            "(x < 5 and y < 5) for {} ns",
            "not ((x < 5 for {} ns) and not (y < 5 for {} ns))",
            "(not (x < 5 for {} ns) and y < 5) for {} ns",
        ]
    ),
    st.integers(1, 18),
    st.integers(1, 18),
)
@example([(0, 9.0), (20, 1.0), (20, 9.0)], [(0, 9.0)], "x < 5 and not (y < 5 for {} ns)", 7, 1)
@example([(0, 1.0), (20, 9.0), (20, 1.0)], [(0, 1.0)], "(x < 5 for {} ns) and y < 5", 8, 1)
def test_each_sample_of_an_instant_is_a_step_beside_any_duration(
    x: Pairs, y: Pairs, text: str, first: int, second: int
) -> None:
    log = recording({"x": x, "y": y}, end=LAST)
    whole = text.format(first, second)
    found = steps(whole, log)
    slowly, expression = Slowly({"x": x, "y": y}), proposition(whole)
    for time in range(LAST + 1):
        expected = [slowly.truth(expression, (time, n)) for n in range(slowly.count(time))]
        here = [value for at, value in pairs(found) if at == time]
        before = [value for at, value in pairs(found) if at < time]
        assert (here or before[-1:]) == expected
