"""Verdicts at the end of a trace, from what is known of it."""

from itertools import product

import pytest

from monitors.kernel.stepping import finite_verdict
from monitors.kernel.verdicts import Truth, at_end, truth

CASES: list[tuple[Truth, Truth, Truth, str]] = [
    (False, False, False, "vacuous"),
    (False, False, True, "satisfied"),
    (False, False, None, "no data"),
    (False, True, True, "inconclusive"),
    (False, None, True, "no data"),
    (True, False, True, "violated"),
    (True, None, None, "violated"),
    (None, False, True, "no data"),
    (None, True, True, "no data"),
]


@pytest.mark.parametrize(("broken", "obligation_pending", "triggered", "verdict"), CASES)
def test_a_verdict_is_as_definite_as_what_it_rests_on(
    broken: Truth, obligation_pending: Truth, triggered: Truth, verdict: str
) -> None:
    assert at_end(broken, obligation_pending, triggered) == verdict


def filled(value: Truth) -> tuple[bool, ...]:
    return (False, True) if value is None else (value,)


def test_no_completion_contradicts_a_definite_verdict() -> None:
    for known in product((False, True, None), repeat=3):
        verdict = at_end(*known)
        for values in product(*map(filled, known)):
            assert verdict in ("no data", at_end(*values)), (known, values)


def test_frets_finite_verdict_is_false_as_soon_as_one_reason_is_certain() -> None:
    for known in product((False, True, None), repeat=2):
        verdicts = {finite_verdict(*values) for values in product(*map(filled, known))}
        assert finite_verdict(*known) == (verdicts.pop() if len(verdicts) == 1 else None), known


def test_both_approximations_make_one_truth_value() -> None:
    assert [
        truth(*approximations) for approximations in ((False, False), (True, True), (False, True))
    ] == [
        False,
        True,
        None,
    ]
