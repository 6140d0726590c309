"""A program is tested by inputs that react to it: right ones conform, planted faults are found."""

from __future__ import annotations

from pathlib import Path

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from fretc.testing.conformance.findings import Failure
from fretc.testing.suite import Repeat
from fretc.testing.words import RunColumns, defined, letters
from tests.each import each
from tests.effort import some
from tests.fretc.testing.controllers import ASSUMED, FAULTS, RULES, program, seen_of


def is_broken(requirement: FormalizedRequirement, rows: tuple[Repeat, ...]) -> list[bool]:
    """Whether some demand is broken at each tick or before it, by the definition."""
    ticks = [row.values for row in rows for _ in range(row.count)]
    columns = {
        name: sum(bool(values[name]) << tick for tick, values in enumerate(ticks))
        for name in requirement.watched
    }
    broken, _ = defined(requirement, letters(requirement, RunColumns(rows, columns, len(ticks))))
    return [broken is not None and tick >= broken for tick in range(len(ticks))]


def check(failure: Failure) -> None:
    """It violates the requirement at its last tick, and keeps the assumption."""
    found = is_broken(RULES[failure.requirement], failure.rows)
    assert found == [False] * (len(found) - 1) + [True]
    assert not any(is_broken(ASSUMED, failure.rows))
    assert failure.again


@pytest.mark.slow
def test_a_right_program_conforms(tmp_path: Path) -> None:
    found = seen_of(program(), tmp_path)
    assert not found.failures
    assert found.is_complete


@pytest.mark.slow
@each("fault", some(FAULTS, 8))
def test_each_planted_fault_is_found(fault: str) -> None:
    found = seen_of(program(fault))
    assert found.failures, fault
    for failure in found.failures:
        check(failure)
