"""A program is tested by inputs that react to it: right ones conform, planted faults are found."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import pytest

from compiler.formalization.formalized import Formalized
from fretc.testing.conformance.campaign import Campaign
from fretc.testing.conformance.findings import Conformance, Failure
from fretc.testing.conformance.program import Program
from fretc.testing.suite import Repeat
from fretc.testing.words import Word, defined, letters
from tests.each import each
from tests.fretc.testing.controllers import FAULTS, INPUTS, OUTPUTS, PROMISE, SENTENCES, program
from tests.requirement_sets import roles, rule, rules

ASSUMED = rule("A1", PROMISE)
RULES: Mapping[str, Formalized] = {each.id: each for each in rules(*SENTENCES)}


def seen_of(folder: Path, text: str) -> Conformance:
    """What is seen of a program."""
    path = folder / "program.py"
    path.write_text(text)
    command = [sys.executable, "-ISE", str(path)]
    campaign = Campaign([*RULES.values()], [ASSUMED], roles(INPUTS, OUTPUTS), 60)
    columns = campaign.referee.inputs, campaign.referee.outputs
    campaign.run(partial(Program, command, *columns, seconds=60), lambda words: None)
    return campaign.findings(command)


def is_broken(rule: Formalized, rows: tuple[Repeat, ...]) -> list[bool]:
    """Whether some demand is broken at each tick or before it, by the definition."""
    ticks = [row.values for row in rows for _ in range(row.count)]
    columns = {
        name: sum(bool(values[name]) << tick for tick, values in enumerate(ticks))
        for name in rule.watched
    }
    broken, _ = defined(rule, letters(rule, Word(rows, columns, len(ticks))))
    return [broken is not None and tick >= broken for tick in range(len(ticks))]


def check(failure: Failure) -> None:
    """It violates the requirement at its last tick, and keeps the assumption."""
    found = is_broken(RULES[failure.requirement], failure.rows)
    assert found == [False] * (len(found) - 1) + [True]
    assert not any(is_broken(ASSUMED, failure.rows))
    assert failure.again


@pytest.mark.slow
def test_a_right_program_conforms(tmp_path: Path) -> None:
    found = seen_of(tmp_path, program())
    assert not found.failures
    assert found.is_complete


@each("fault", ["alarm ends a tick early"])
def test_a_planted_fault_is_found(fault: str, tmp_path: Path) -> None:
    found = seen_of(tmp_path, program(fault))
    assert found.failures
    for failure in found.failures:
        check(failure)


@pytest.mark.slow
@each("fault", FAULTS)
def test_each_planted_fault_is_found(fault: str, tmp_path: Path) -> None:
    found = seen_of(tmp_path, program(fault))
    assert found.failures, fault
    for failure in found.failures:
        check(failure)
