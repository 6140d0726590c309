"""Tests from requirements find planted faults, and accuse no program that keeps them."""

from __future__ import annotations

import pytest

from benchmarks.planted_faults import SAFETY, is_found, ours, planted


@pytest.mark.slow
def test_each_fault_of_the_safety_function_is_found_and_the_right_one_not_accused() -> None:
    runs = ours(SAFETY)
    assert not is_found(SAFETY, SAFETY.texts(), runs)
    for fault in SAFETY.faults:
        assert is_found(SAFETY, planted(SAFETY.texts(), fault), runs), fault.words
