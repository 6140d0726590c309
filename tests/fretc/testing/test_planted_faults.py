"""Tests from requirements find planted faults, and accuse no program that keeps them."""

from __future__ import annotations

import pytest

from benchmarks.planted_faults import SAFETY, SUBJECTS, Subject, is_found, ours, planted
from tests.each import each


@each("subject", SUBJECTS)
@pytest.mark.slow
def test_a_program_without_a_fault_is_not_accused(subject: Subject) -> None:
    assert not is_found(subject, subject.texts(), ours(subject))


@pytest.mark.slow
def test_each_fault_of_the_safety_function_is_found() -> None:
    runs = ours(SAFETY)
    for fault in SAFETY.faults:
        assert is_found(SAFETY, planted(SAFETY.texts(), fault), runs), fault.words
