"""Tests from requirements find faults of robot programs, and accuse no program that keeps them."""

from __future__ import annotations

import pytest

from benchmarks.robot_faults import SAFETY, changed, is_found, ours
from tests.effort import some


@pytest.mark.slow
def test_each_fault_of_the_safety_function_is_found_and_the_right_one_not_accused() -> None:
    runs = ours(SAFETY)
    assert not is_found(SAFETY, SAFETY.texts(), runs)
    for fault in some(SAFETY.faults, 4):
        assert is_found(SAFETY, changed(SAFETY.texts(), fault), runs), fault.words
