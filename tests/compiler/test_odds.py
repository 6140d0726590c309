"""From counts to an answer, against binomial sums in fractions and against all that can happen."""

import sys
from fractions import Fraction
from itertools import pairwise
from math import comb, log

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler import odds
from compiler.odds import (
    Bounds,
    Estimate,
    answer,
    both_sides,
    estimated,
    highest,
    lowest,
    needed,
    resampled,
)
from fretish.diagnostic import Code
from fretish.expressions import ComparisonOperator
from monitors.trials import Trials


def spread(answered: int, failed: int, open_: int = 0, logs: int = 2) -> list[Trials]:
    """So many, over some logs as evenly as can be."""
    return [
        Trials(
            *(total * (i + 1) // logs - total * i // logs for total in (answered, failed, open_))
        )
        for i in range(logs)
    ]


def said(op: ComparisonOperator, bound: str, runs: list[Trials], confidence: float = 0.95) -> str:
    return answer(estimated(runs, both_sides(op, confidence)), op, Fraction(bound))


def of_exact(trials: Trials, op: ComparisonOperator, bound: Fraction) -> str:
    """The answer by the exact interval alone."""
    level = both_sides(op, 0.95)
    good, count = trials.answered, trials.count
    bounds = Bounds(lowest(good, count, level), highest(good + trials.open, count, level))
    return answer(Estimate(trials, 2, level, bounds, bounds), op, bound)


# Clopper-Pearson -------------------------------------------------------------------------------


def at_least(k: int, n: int, p: Fraction) -> Fraction:
    """The probability of k or more of n."""
    return sum((comb(n, i) * p**i * (1 - p) ** (n - i) for i in range(k, n + 1)), Fraction(0))


def exact(bound: float) -> Fraction:
    """A bound is a multiple of this."""
    return Fraction(round(bound * 10**9), 10**9)


def bisected(k: int, n: int, alpha: Fraction) -> Fraction:
    """The p with `at_least(k, n, p) == alpha`, to 2**-40."""
    low, high = Fraction(0), Fraction(1)
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if at_least(k, n, middle) <= alpha else (low, middle)
    return low


@pytest.mark.parametrize("confidence", [Fraction(9, 10), Fraction(95, 100), Fraction(99, 100)])
def test_the_bounds_are_those_of_exact_binomial_sums(confidence: Fraction) -> None:
    for n in (1, 2, 5, 12):
        for k in range(n + 1):
            low = bisected(k, n, 1 - confidence) if k else Fraction(0)
            high = 1 - bisected(n - k, n, 1 - confidence) if k < n else Fraction(1)
            assert lowest(k, n, float(confidence)) == pytest.approx(float(low), abs=2e-9)
            assert highest(k, n, float(confidence)) == pytest.approx(float(high), abs=2e-9)


@pytest.mark.parametrize(("k", "n"), [(59, 59), (299, 299), (298, 300), (7, 40)])
def test_rounding_never_makes_a_bound_tighter(k: int, n: int) -> None:
    assert at_least(k, n, exact(lowest(k, n, 0.95))) <= Fraction(5, 100)
    if k < n:
        assert 1 - at_least(k + 1, n, exact(highest(k, n, 0.95))) <= Fraction(5, 100)


def test_a_bound_is_wrong_no_more_often_than_stated() -> None:
    """Every outcome of n trials, weighed by its probability, for each p of a grid."""
    for n in (1, 3, 10, 20):
        lows = [exact(lowest(k, n, 0.95)) for k in range(n + 1)]
        highs = [exact(highest(k, n, 0.95)) for k in range(n + 1)]
        for p in (Fraction(i, 50) for i in range(51)):
            weights = [comb(n, k) * p**k * (1 - p) ** (n - k) for k in range(n + 1)]
            over = sum((w for w, low in zip(weights, lows, strict=True) if low > p), Fraction(0))
            under = sum(
                (w for w, high in zip(weights, highs, strict=True) if high < p), Fraction(0)
            )
            assert over <= Fraction(5, 100)
            assert under <= Fraction(5, 100)


@pytest.mark.parametrize("op", [">=", ">", "<=", "<", "=", "!="])
def test_a_wrong_answer_is_no_likelier_than_stated(op: ComparisonOperator) -> None:
    """The true probability is p; each answer that contradicts it, over all outcomes of 25."""
    n, bound = 25, Fraction(4, 5)
    answers = []
    for k in range(n + 1):
        answers.append(of_exact(Trials(k, n - k, 0), op, bound))
    for p in [Fraction(i, 40) for i in range(41)] + [bound - Fraction(1, 999)]:
        true = {
            ">=": p >= bound, ">": p > bound, "<=": p <= bound, "<": p < bound,
            "=": p == bound, "!=": p != bound,
        }[op]  # fmt: skip
        wrong = "refuted" if true else "supported"
        weight = sum(
            (comb(n, k) * p**k * (1 - p) ** (n - k) for k in range(n + 1) if answers[k] == wrong),
            Fraction(0),
        )
        assert weight <= Fraction(5, 100), p


# Answers ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("runs", "bound", "expected"),
    [
        (spread(59, 0), "0.95", "supported"),
        (spread(58, 0), "0.95", "inconclusive"),
        (spread(299, 0), "0.99", "supported"),
        (spread(298, 0), "0.99", "inconclusive"),
        (spread(298, 2), "0.99", "inconclusive"),
        (spread(297, 0, 2), "0.99", "inconclusive"),
        (spread(299, 0, 2), "0.99", "inconclusive"),
        (spread(2995, 0), "0.999", "supported"),
        (spread(2994, 0), "0.999", "inconclusive"),
        (spread(90, 10), "0.99", "refuted"),
        (spread(98, 2), "0.99", "inconclusive"),
    ],
)
def test_how_many_triggers_support_how_much(runs: list[Trials], bound: str, expected: str) -> None:
    assert said(">=", bound, runs) == expected


GOOD, BAD, EVEN = spread(95, 5, logs=50), spread(5, 95, logs=50), spread(50, 50, logs=50)


@pytest.mark.parametrize(
    ("op", "good", "bad", "even"),
    [
        (">=", "supported", "refuted", "inconclusive"),
        (">", "supported", "refuted", "inconclusive"),
        ("<=", "refuted", "supported", "inconclusive"),
        ("<", "refuted", "supported", "inconclusive"),
        ("=", "refuted", "refuted", "inconclusive"),
        ("!=", "supported", "supported", "inconclusive"),
    ],
)
def test_every_operator(op: ComparisonOperator, good: str, bad: str, even: str) -> None:
    assert (said(op, "0.5", GOOD), said(op, "0.5", BAD), said(op, "0.5", EVEN)) == (good, bad, even)


@pytest.mark.parametrize(
    ("op", "bound", "all_good", "one_bad", "all_bad"),
    [
        (">=", "1", "inconclusive", "refuted", "refuted"),
        ("=", "1", "inconclusive", "refuted", "refuted"),
        ("<", "1", "inconclusive", "supported", "supported"),
        ("!=", "1", "inconclusive", "supported", "supported"),
        ("<=", "1", "supported", "supported", "supported"),
        (">=", "0", "supported", "supported", "supported"),
        (">", "0", "supported", "supported", "inconclusive"),
        ("<=", "0", "refuted", "refuted", "inconclusive"),
        ("=", "0", "refuted", "refuted", "inconclusive"),
        ("!=", "0", "supported", "supported", "inconclusive"),
    ],
)
def test_at_the_ends_one_trigger_can_tell(
    op: ComparisonOperator, bound: str, all_good: str, one_bad: str, all_bad: str
) -> None:
    found = (said(op, bound, spread(50, 0)), said(op, bound, spread(49, 1)))
    assert (*found, said(op, bound, spread(0, 50))) == (all_good, one_bad, all_bad)


def test_one_failure_of_one_log_refutes_certainty_and_nothing_less() -> None:
    assert said(">=", "1", [Trials(99, 1, 0)]) == "refuted"
    assert said(">=", "0.99", [Trials(0, 900, 0)]) == "inconclusive"
    assert said(">=", "0.99", [Trials(900, 0, 0)]) == "inconclusive"


@pytest.mark.parametrize("op", [">=", ">", "<=", "<", "=", "!="])
def test_without_a_trigger_nothing_is_known(op: ComparisonOperator) -> None:
    for bound in ("0", "0.5", "1"):
        assert said(op, bound, []) == "inconclusive"
        assert said(op, bound, [Trials(0, 0, 0)] * 40) == "inconclusive"


counts = st.integers(0, 40)
some_trials = st.lists(st.builds(Trials, counts, counts, counts), max_size=6)
OPERATORS: list[ComparisonOperator] = [">=", ">", "<=", "<", "=", "!="]
operators = st.sampled_from(OPERATORS)


@given(some_trials, operators, st.sampled_from(["0", "0.1", "0.5", "0.9", "1"]), st.data())
def test_an_answer_holds_whatever_the_open_triggers_come_to(
    runs: list[Trials], op: ComparisonOperator, bound: str, data: st.DataObject
) -> None:
    """By the exact interval; which trigger of which log it is does not matter there."""
    whole = estimated(runs).trials
    found = of_exact(whole, op, Fraction(bound))
    good = data.draw(st.integers(0, whole.open))
    dropped = data.draw(st.integers(0, whole.open - good))  # they were no triggers
    decided = Trials(whole.answered + good, whole.failed + whole.open - good - dropped, 0)
    if found != "inconclusive" and decided.count:
        assert of_exact(decided, op, Fraction(bound)) == found


@given(some_trials, st.randoms(use_true_random=False))
def test_the_order_of_the_logs_does_not_matter(runs: list[Trials], chance: object) -> None:
    shuffled = sorted(runs, key=lambda _: chance.random())  # type: ignore[attr-defined]
    assert estimated(shuffled) == estimated(runs)


# Whole logs ------------------------------------------------------------------------------------


def test_the_same_logs_give_the_same_interval() -> None:
    runs = [Trials(20 - i % 5, i % 5, 0) for i in range(40)]
    first = resampled(runs, 0.95)
    assert first == resampled(runs, 0.95)
    assert first.low == pytest.approx(0.882, abs=0.01)
    assert first.high == pytest.approx(0.918, abs=0.01)


def test_logs_that_differ_widen_the_interval_and_can_withhold_the_answer() -> None:
    """1000 triggers with 20 failures: in all logs alike, or all in one of them."""
    alike = spread(980, 20, logs=20)
    one = [Trials(50, 0, 0)] * 19 + [Trials(30, 20, 0)]
    assert estimated(alike).exact == estimated(one).exact
    assert said(">=", "0.965", alike) == "supported"
    assert said(">=", "0.965", one) == "inconclusive"
    assert estimated(one).resampled.low < estimated(alike).resampled.low


def test_one_log_cannot_be_resampled() -> None:
    assert resampled([Trials(10, 10, 0)], 0.95) == Bounds(0.0, 1.0)


def test_it_is_the_distribution_of_all_draws() -> None:
    """Two logs, one all good and one all bad: a quarter each at 0 and 1, half at 1/2."""
    runs = [Trials(10, 0, 0), Trials(0, 10, 0)]
    assert resampled(runs, 0.7) == Bounds(0.5, 0.5)
    assert resampled(runs, 0.8) == Bounds(0.0, 1.0)


def test_what_is_open_counts_both_ways_there_too() -> None:
    assert resampled([Trials(5, 0, 5), Trials(5, 0, 5)], 0.95) == Bounds(0.5, 1.0)


def test_a_table_too_large_for_one_draw_is_drawn_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = [Trials(20 - i % 5, i % 5, 0) for i in range(40)]
    whole = resampled(runs, 0.95)
    monkeypatch.setattr(odds, "_AT_ONCE", 1000)
    assert resampled(runs, 0.95) == whole


# How many more ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("bound", "total"),
    [("0.9", 29), ("0.95", 59), ("0.99", 299), ("0.999", 2995), ("0.9999", 29956)],
)
def test_without_failures_it_is_the_quotient_of_logarithms(bound: str, total: int) -> None:
    assert needed(estimated([]), ">=", Fraction(bound)) == total
    assert log(0.05) / log(float(bound)) <= total < log(0.05) / log(float(bound)) + 1
    assert needed(estimated(spread(20, 0)), ">", Fraction(bound)) == total - 20
    rest = 1 - Fraction(bound)
    assert needed(estimated(spread(0, 20)), "<=", rest) == total - 20


@pytest.mark.parametrize("runs", [spread(298, 2), spread(40, 1), spread(299, 0, 2), spread(0, 3)])
def test_so_many_are_enough_and_one_less_is_not(runs: list[Trials]) -> None:
    told = estimated(runs)
    more = needed(told, ">=", Fraction("0.99"))
    assert more is not None
    answered, count = told.trials.answered, told.trials.count
    for extra, enough in ((more, True), (more - 1, False)):
        assert (lowest(answered + extra, count + extra, 0.95) >= 0.99) is enough


def test_where_no_number_helps_there_is_none() -> None:
    assert needed(estimated(spread(50, 0)), ">=", Fraction(1)) is None
    assert needed(estimated(spread(50, 0)), "=", Fraction("0.5")) is None
    assert needed(estimated(spread(0, 50)), "<=", Fraction(0)) is None
    assert needed(estimated(spread(299, 0)), ">=", Fraction("0.99")) is None


def test_more_answers_never_lower_a_bound() -> None:
    assert all(a < b for a, b in pairwise([lowest(k, 20, 0.95) for k in range(21)]))


def test_without_scipy_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    monkeypatch.setattr(odds, "find_spec", lambda name: None)
    told = odds.missing()
    assert told is not None
    assert (told.code, told.help) == (
        Code.MISSING_EXTRA,
        "install the extra: pip install 'fretc[stats]' "
        "(in a checkout: .venv/bin/pip install '.[stats]')",
    )
