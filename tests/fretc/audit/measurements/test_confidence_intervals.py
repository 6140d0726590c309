"""From counts to an answer: by exact sums and by simulation, whatever triggers of a run share."""

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from itertools import product
from math import comb, prod

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.measurements.confidence_intervals import (
    Bounds,
    Estimate,
    answer,
    both_sides,
    bounds,
    estimated,
    fewest,
    needed,
)
from fretc.audit.measurements.trials import Trials
from fretish.expressions import ComparisonOperator
from tests.effort import FULL, pairwise, some


def spread(answered: int, failed: int, open_: int = 0, logs: int = 100) -> list[Trials]:
    """So many, over some logs as evenly as can be."""
    return [
        Trials(
            *(total * (i + 1) // logs - total * i // logs for total in (answered, failed, open_))
        )
        for i in range(logs)
    ]


def answer_of(
    op: ComparisonOperator, bound: str, runs: list[Trials], confidence: float = 0.95
) -> str:
    return answer(estimated(runs, both_sides(op, confidence)), op, Fraction(bound))


def good(count: int, size: int = 1) -> list[Trials]:
    return [Trials(size, 0, 0)] * count


def bad(count: int, size: int = 1) -> list[Trials]:
    return [Trials(0, size, 0)] * count


# How often an answer is wrong, exactly ----------------------------------------------------------

OPERATORS: list[ComparisonOperator] = [">=", ">", "<=", "<", "=", "!="]


def holds(p: Fraction, op: ComparisonOperator, bound: Fraction) -> bool:
    return {
        ">=": p >= bound, ">": p > bound, "<=": p <= bound, "<": p < bound,
        "=": p == bound, "!=": p != bound,
    }[op]  # fmt: skip


@cache
def good_and_bad(count: int, others: int, confidence: float) -> Estimate:
    return estimated(good(count, 50) + bad(others, 50), confidence)


@pytest.mark.slow
@pytest.mark.parametrize("op", OPERATORS)
@pytest.mark.parametrize(("n", "bound"), [(25, "0.8"), (33, "0.9"), (60, "0.5"), (60, "0.05")])
def test_where_whole_runs_are_good_or_bad_no_answer_is_wrong_more_often_than_stated(
    op: ComparisonOperator, n: int, bound: str
) -> None:
    """The true probability is p; each answer that contradicts it, over all outcomes of n runs."""
    edge, confidence = Fraction(bound), both_sides(op, 0.95)
    answers = [answer(good_and_bad(k, n - k, confidence), op, edge) for k in range(n + 1)]
    for p in (edge, edge - Fraction(1, 999), *some([Fraction(i, 40) for i in range(41)], 8)):
        false_answer = "refuted" if holds(p, op, edge) else "supported"
        weight = sum(
            (
                comb(n, k) * p**k * (1 - p) ** (n - k)
                for k in range(n + 1)
                if answers[k] == false_answer
            ),
            Fraction(0),
        )
        assert weight <= Fraction(5, 100), p


@pytest.mark.slow
@pytest.mark.parametrize("confidence", some([0.95, 0.9, 0.99], 3))
def test_runs_of_different_lengths_and_chances_keep_the_level(confidence: float) -> None:
    """Short runs are better than long ones; what is bounded is their mean, weighed by triggers."""
    (small, many), (large, few) = (1, 12), (4, 8)
    estimates = {
        (i, j): bounds(
            good(i, small) + bad(many - i, small) + good(j, large) + bad(few - j, large), confidence
        )
        for i, j in product(range(many + 1), range(few + 1))
    }
    for p, q in [("1", "0.7"), ("0.99", "0.9"), ("0.2", "0.95"), ("0.5", "0.5"), ("1", "0.95")]:
        a, b = Fraction(p), Fraction(q)
        share = (a * small * many + b * large * few) / (small * many + large * few)
        below = above = Fraction(0)
        for (i, j), estimate in estimates.items():
            weight = (
                comb(many, i) * a**i * (1 - a) ** (many - i)
                * comb(few, j) * b**j * (1 - b) ** (few - j)
            )  # fmt: skip
            below += weight * (estimate.high < share)
            above += weight * (estimate.low > share)
        assert max(below, above) <= 1 - Fraction(str(confidence)), (p, q)


def test_the_bound_is_where_the_mean_of_the_bets_reaches_twenty() -> None:
    """Written down once more, in fractions: five bets of the mixture leave too little."""
    runs = [Trials(4, 1, 0), Trials(2, 0, 1), Trials(5, 0, 0)] * 9
    bets = [Fraction(1), Fraction(7, 8), Fraction(3, 4)] + [Fraction(1, 2**k) for k in range(1, 17)]
    stakes = [Fraction(1, 2), Fraction(1, 8), Fraction(1, 8)]
    stakes += [Fraction(1, 2 ** (k + 2)) for k in range(1, 16)] + [Fraction(1, 2**17)]
    assert sum(stakes) == 1

    def worth(share: Fraction) -> Fraction:
        return sum(
            (
                stake * prod(1 + bet * (run.answered / share - run.count) / 5 for run in runs)
                for bet, stake in zip(bets, stakes, strict=True)
            ),
            Fraction(0),
        )

    low = Fraction(str(bounds(runs, 0.95).low))
    assert worth(low) >= 20 > worth(low + Fraction(2, 10**9))


# How often an answer is wrong, by simulation ----------------------------------------------------

TRIGGERS = 50
Draw = Callable[[np.random.Generator, int, float], np.ndarray]
DRAWS: dict[str, Draw] = {
    "independent": lambda chance, n, p: chance.binomial(TRIGGERS, p, n),
    "beta-binomial": lambda chance, n, p: chance.binomial(
        TRIGGERS, chance.beta(p * 0.7 / 0.3, (1 - p) * 0.7 / 0.3, n)
    ),
    "whole runs": lambda chance, n, p: TRIGGERS * chance.binomial(1, p, n),
}
"""How many of the triggers of each of n runs are answered; in the second the correlation of two
triggers of a run is 0.3."""
REPETITIONS = 1000 if FULL else 30


def wrong(kind: str, n: int, p: float, confidence: float, repetitions: int) -> tuple[int, int]:
    """How often `> p` is supported and `>= p` is refuted, where the probability is p."""
    chance, edge = np.random.default_rng(20_240_229), Fraction(str(p))
    counts = {"supported": 0, "refuted": 0}
    for _ in range(repetitions):
        sample = DRAWS[kind](chance, n, p)
        estimate = estimated((Trials(int(k), TRIGGERS - int(k), 0) for k in sample), confidence)
        counts["supported"] += answer(estimate, ">", edge) == "supported"
        counts["refuted"] += answer(estimate, ">=", edge) == "refuted"
    return counts["supported"], counts["refuted"]


def most(repetitions: int, rate: float) -> int:
    """What a rate that is no higher exceeds in one of ten thousand such simulations at most."""
    rest, k = 1.0, -1
    while rest > 1e-4:
        k += 1
        rest -= comb(repetitions, k) * rate**k * (1 - rate) ** (repetitions - k)
    return k


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "n", "p"), pairwise([*DRAWS], [30, 100, 200], [0.9, 0.99]))
def test_triggers_that_depend_on_each_other_make_no_answer_wrong_more_often(
    kind: str, n: int, p: float
) -> None:
    for confidence in (0.95, 0.99) if REPETITIONS > 100 else (0.95,):
        allowed = most(REPETITIONS, 1 - confidence)
        assert max(wrong(kind, n, p, confidence, REPETITIONS)) <= allowed


def test_there_is_power_where_triggers_are_independent() -> None:
    """A true 0.99 supports 0.9, and 0.95 too with 100 runs; a true 0.9 refutes 0.99."""
    chance = np.random.default_rng(7)
    for n, p, bound, expected in [
        (40, 0.99, "0.9", "supported"),
        (100, 0.99, "0.95", "supported"),
        (30, 0.9, "0.99", "refuted"),
    ]:
        for _ in range(20):
            sample = DRAWS["independent"](chance, n, p)
            runs = [Trials(int(k), TRIGGERS - int(k), 0) for k in sample]
            assert answer_of(">=", bound, runs) == expected


# Answers ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("runs", "bound", "expected"),
    [
        (good(33), "0.9", "supported"),
        (good(32), "0.9", "inconclusive"),
        (good(33, 50), "0.9", "supported"),
        (good(32, 50), "0.9", "inconclusive"),  # 1600 triggers, and 32 runs
        (good(339), "0.99", "supported"),
        (good(338), "0.99", "inconclusive"),
        (good(339) + bad(1), "0.99", "inconclusive"),
        (good(338) + [Trials(0, 0, 1)], "0.99", "inconclusive"),
        (good(30, 1000), "0.99", "inconclusive"),
        (spread(9900, 100), "0.99", "inconclusive"),
        (spread(9000, 1000), "0.99", "refuted"),
        (good(32) + [Trials(900, 0, 0)], "0.9", "inconclusive"),  # one run has nearly all triggers
    ],
)
def test_how_many_runs_support_how_much(runs: list[Trials], bound: str, expected: str) -> None:
    assert answer_of(">=", bound, runs) == expected


GOOD, BAD, EVEN = spread(950, 50), spread(50, 950), spread(500, 500)


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
    assert (answer_of(op, "0.5", GOOD), answer_of(op, "0.5", BAD), answer_of(op, "0.5", EVEN)) == (
        good,
        bad,
        even,
    )


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
    answers = (answer_of(op, bound, spread(50, 0)), answer_of(op, bound, spread(49, 1)))
    assert (*answers, answer_of(op, bound, spread(0, 50))) == (all_good, one_bad, all_bad)


def test_one_failure_of_one_log_refutes_certainty_and_nothing_less() -> None:
    assert answer_of(">=", "1", [Trials(99, 1, 0)]) == "refuted"
    assert answer_of(">=", "0.99", [Trials(0, 900, 0)]) == "inconclusive"
    assert answer_of(">=", "0.01", [Trials(900, 0, 0)]) == "inconclusive"
    assert bounds([Trials(10, 10, 0)], 0.95) == Bounds(0.0, 1.0)


@pytest.mark.parametrize("op", OPERATORS)
def test_without_a_trigger_nothing_is_known(op: ComparisonOperator) -> None:
    for bound in ("0", "0.5", "1"):
        assert answer_of(op, bound, []) == "inconclusive"
        assert answer_of(op, bound, [Trials(0, 0, 0)] * 40) == "inconclusive"


def test_logs_that_differ_widen_the_interval_and_can_withhold_the_answer() -> None:
    """5000 triggers with 50 failures: in all logs alike, or all in one of them."""
    equal_runs, one = spread(4950, 50), good(99, 50) + bad(1, 50)
    assert answer_of(">=", "0.95", equal_runs) == "supported"
    assert answer_of(">=", "0.95", one) == "inconclusive"
    assert bounds(one, 0.95).low < bounds(equal_runs, 0.95).low


# What is open, and what does not matter ---------------------------------------------------------

counts = st.integers(0, 40)
some_trials = st.lists(st.builds(Trials, counts, counts, counts), max_size=6)
LARGEST = Trials(60, 60, 0)
"""With it the run with most triggers stays the same, whatever becomes of those of the others."""


@pytest.mark.slow
@given(some_trials, st.data())
def test_bounds_hold_whatever_the_open_triggers_come_to(
    runs: list[Trials], data: st.DataObject
) -> None:
    decided = [LARGEST]
    for run in runs:
        answered = data.draw(st.integers(0, run.open))
        dropped = data.draw(st.integers(0, run.open - answered))  # they were no triggers
        failed = run.failed + run.open - answered - dropped
        decided.append(Trials(run.answered + answered, failed, 0))
    bounds, really = estimated([LARGEST, *runs]).bounds, estimated(decided).bounds
    if len([run for run in decided if run.count]) > 1:
        assert bounds.low <= really.low <= really.high <= bounds.high


def test_open_triggers_count_against_either_bound() -> None:
    runs = [Trials(5, 0, 5)] * 100
    assert bounds(runs, 0.95).low == bounds([Trials(5, 5, 0)] * 100, 0.95).low
    assert bounds(runs, 0.95).high == 1


@pytest.mark.slow
@given(some_trials, st.randoms(use_true_random=False))
def test_the_order_of_the_logs_does_not_matter(runs: list[Trials], chance: object) -> None:
    shuffled = sorted(runs, key=lambda _: chance.random())  # type: ignore[attr-defined]
    one, other = estimated(shuffled), estimated(runs)
    assert (one.trials, one.bounds) == (other.trials, other.bounds)


@given(some_trials, st.integers(0, 5))
def test_a_failure_in_place_of_an_answer_raises_no_bound(runs: list[Trials], place: int) -> None:
    if place >= len(runs) or not runs[place].answered:
        return
    one = runs[place]
    worse = [*runs]
    worse[place] = Trials(one.answered - 1, one.failed + 1, one.open)
    before, after = estimated(runs).bounds, estimated(worse).bounds
    assert (after.low <= before.low, after.high <= before.high) == (True, True)


# How many more ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("bound", "total"),
    [("0.9", 33), ("0.95", 67), ("0.99", 339), ("0.999", 3402), ("0.9999", 34028)],
)
def test_so_many_runs_it_takes_without_failures(bound: str, total: int) -> None:
    assert fewest(">=", Fraction(bound), 0.95) == total
    assert needed(estimated(good(20)), ">", Fraction(bound)) == total - 20
    assert needed(estimated(bad(20, 3)), "<=", 1 - Fraction(bound)) == total - 20


@pytest.mark.parametrize(
    "runs", [good(298) + bad(2), spread(40, 1), good(299) + [Trials(0, 0, 2)], bad(3), good(1)]
)
def test_so_many_are_enough_and_one_less_is_not(runs: list[Trials]) -> None:
    more = needed(estimated(runs), ">=", Fraction("0.99"))
    assert more is not None
    size = max(run.count for run in runs)
    assert answer_of(">=", "0.99", runs + good(more, size)) == "supported"
    assert answer_of(">=", "0.99", runs + good(more - 1, size)) == "inconclusive"


def test_where_no_number_helps_there_is_none() -> None:
    assert needed(estimated(spread(50, 0)), ">=", Fraction(1)) is None
    assert needed(estimated(spread(50, 0)), "=", Fraction("0.5")) is None
    assert needed(estimated(spread(0, 50)), "<=", Fraction(0)) is None
    assert needed(estimated(good(339)), ">=", Fraction("0.99")) is None
    assert needed(estimated(bad(9)), ">", Fraction(0)) == 1
    assert fewest(">=", Fraction(1), 0.95) == fewest("!=", Fraction("0.5"), 0.95) == 2
