"""Tests from a suite file that are up to date and correct.

The file is not trusted: a test counts if its name is a valid file name, its values suit the
monitors, and the monitor of its requirement gives the expected verdict.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from compiler.files.records import replace
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import monitor as emitted
from compiler.targets.python.comparisons import NUMBER, TRUTH, StepInput
from compiler.targets.python.input_adapter import input_adapter
from fretc.testing.exports.tables import TestTable, table, truths
from fretc.testing.suite import LONGEST_NAME, Suite, Test
from fretc.testing.words import outcome
from fretish.classes.frozen import dataclass
from monitors.kernel import Monitor
from monitors.loading import load

MOST = 1_000_000
"""Maximum number of ticks of all tests of a file."""
_NAME = re.compile(r"[a-z0-9]+(?:[-_][a-z0-9]+)*", re.ASCII)


class WrongError(Exception):
    """A test is wrong; the message names the test and the error."""


@dataclass(frozen=True, slots=True)
class Saved:
    """The usable tests of a file."""

    suite: Suite
    others: tuple[str, ...]
    """Ids of its requirements that are missing or have another sentence now."""


def saved(suite: Suite, formalized: Sequence[FormalizedRequirement]) -> Saved:
    """The tests of a file that are about the requirements.

    Raises:
        WrongError: a test is not one of its requirement.
    """
    known = {requirement.id: requirement for requirement in formalized}
    same = {
        each.id
        for each in suite.requirements
        if each.id in known and known[each.id].fingerprint == each.fingerprint
    }
    tests = tuple(test for test in suite.tests if test.requirement in same)
    if sum(test.ticks for test in tests) > MOST:
        raise WrongError(f"its tests have more than {MOST} ticks")
    names = Counter(test.name for test in tests)
    for test in tests:
        if not _NAME.fullmatch(test.name) or len(test.name) > LONGEST_NAME:
            raise WrongError(
                f"`{test.name}` is not a valid name for a test: use at most {LONGEST_NAME} "
                "lower-case letters, digits and `-`"
            )
        if names[test.name] > 1:
            raise WrongError(f"the name `{test.name}` comes twice")
    for id in same:
        monitor = load(f"{id}.py", emitted.text(known[id]))
        for test in tests:
            if test.requirement == id:
                _check(known[id], monitor, test)
    chosen = {
        part: tuple(each for each in getattr(suite, part) if each.requirement in same)
        for part in ("obligations", "mutants")
    }
    requirements = tuple(each for each in suite.requirements if each.id in same)
    others = tuple(each.id for each in suite.requirements if each.id not in same)
    return Saved(replace(suite, requirements=requirements, tests=tests, **chosen), others)


def _check(requirement: FormalizedRequirement, monitor: Monitor, test: Test) -> None:
    """Check that the monitor can read a test and gives the expected verdict.

    Raises:
        WrongError: it does not.
    """
    try:
        own = table(requirement, test)
        tables = (own,) if own.names == requirement.watched else (own, truths(requirement, test))
    except KeyError as error:
        raise WrongError(f"`{test.name}` lacks values of `{error.args[0]}`") from None
    for read in tables:
        _check_table(requirement, monitor, test, read)


def _check_table(
    requirement: FormalizedRequirement, monitor: Monitor, test: Test, read: TestTable
) -> None:
    variables = input_adapter((requirement,), requirement.watched)
    inputs = {} if variables is None or read.of_truths else variables.inputs
    for _, values in read.rows:
        for name, value in zip(read.names, values, strict=True):
            if not _is_value(value, inputs.get(name, StepInput(TRUTH))):
                raise WrongError(f"`{test.name}`: `{name}` cannot be {value!r}")
    expected = (test.verdict, test.finite, test.decided, test.first_violation)
    if (outcome := _outcome(monitor, read)) != expected:
        shown = ", ".join(f"{each}" for each in outcome)
        raise WrongError(f"`{test.name}` expects another result than the monitor gives: {shown}")


def _is_value(value: object, kind: StepInput) -> bool:
    match value:
        case None:
            return True
        case bool():
            return kind.kind == TRUTH
        case int() | float():
            return kind.kind == NUMBER
        case _:
            return value in kind.words


def _outcome(monitor: Monitor, read: TestTable) -> tuple[object, ...]:
    """Verdict at the end of the run, FRET's verdict, and the ticks of decision and violation."""
    step = monitor.advance if read.of_truths else getattr(monitor, "take", monitor.advance)
    said = outcome(monitor, step, _ticks(read))
    return said.verdict, said.finite, said.decided, said.first_violation


def _ticks(read: TestTable) -> Iterator[Mapping[str, Any]]:
    for count, values in read.rows:
        row = dict(zip(read.names, values, strict=True))
        for _ in range(count):
            yield row
