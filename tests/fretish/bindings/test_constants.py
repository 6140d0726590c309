"""Numbers that are computed exactly, without a sample."""

from fractions import Fraction

import pytest

from fretish import expressions as e
from fretish.bindings.constants import computed


@pytest.mark.parametrize(
    ("op", "left", "right", "expected"),
    [
        ("mod", 7, 3, 1),
        ("mod", -7, 3, 2),
        ("mod", 7, -3, -2),
        ("mod", Fraction(5, 2), Fraction(2, 3), Fraction(1, 2)),
        ("mod", 7, 0, None),
        ("^", Fraction(1, 2), 3, Fraction(1, 8)),
        ("^", -3, 1, -3),
    ],
)
def test_remainders_and_powers_are_exact(
    op: e.ArithmeticOperator, left: Fraction, right: Fraction, expected: Fraction | None
) -> None:
    assert computed(op, Fraction(left), Fraction(right)) == expected


@pytest.mark.parametrize("exponent", [0, -1, 17, Fraction(1, 2)])
def test_an_exponent_is_small_and_whole(exponent: Fraction) -> None:
    with pytest.raises(ValueError, match="whole number from 1 to 16"):
        computed("^", Fraction(2), Fraction(exponent))


def test_a_power_of_a_power_does_not_grow_for_ever() -> None:
    large = computed("^", Fraction(2**4000), Fraction(16))
    assert large is not None
    with pytest.raises(ValueError, match="too large"):
        computed("^", large, Fraction(2))
