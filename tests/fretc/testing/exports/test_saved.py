"""Tests out of a file count as far as they are right and about requirements as they are."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from typing import Any

import pytest

from compiler.files.records import decoded, plain
from compiler.formalization.formalized import FormalizedRequirement
from fretc.testing.assembly import suite
from fretc.testing.exports.saved import WrongError, saved
from fretc.testing.generation import batch
from fretc.testing.suite import Suite
from tests.each import each
from tests.effort import FULL
from tests.monitoring import requirement

WITHIN = "whenever near the robot shall within 2 ticks satisfy stopped"
NUMBERS = "whenever battery < 20 the robot shall within 2 ticks satisfy docking"


@dataclass(frozen=True)
class Made:
    requirements: tuple[FormalizedRequirement, ...]
    document: Any


@cache
def made_once() -> Made:
    requirements = (requirement(WITHIN, "R1"), requirement(NUMBERS, "R2"))
    return Made(
        requirements,
        plain(suite(requirements, (), [batch(each, (), 60.0) for each in requirements])),
    )


@pytest.fixture
def made() -> Made:
    """Its document is one's own."""
    return Made(made_once().requirements, deepcopy(made_once().document))


@pytest.mark.slow
def test_what_was_made_is_taken_as_it_is(made: Made) -> None:
    written = decoded(made.document, Suite)
    found = saved(written, made.requirements)
    assert (found.suite, found.others) == (written, ())
    assert {test.requirement for test in found.suite.tests} == {"R1", "R2"}


@pytest.mark.slow
@each("length", [1, 40, 99, 100, 101, 150] if FULL else [1, 100, 101])
def test_what_was_made_is_taken_however_long_its_names_are(length: int) -> None:
    requirements = (
        requirement(f"the robot shall always satisfy {'n' * length} => s_{'m' * length}", "R1"),
        requirement("the robot shall always satisfy s => q", f"R{'2' * length}"),
        requirement("the robot shall always satisfy q => s", f"R{'2' * length}3"),
    )
    written = suite(requirements, (), [batch(each, (), 60.0) for each in requirements])
    found = saved(decoded(plain(written), Suite), requirements)
    assert found.suite == written
    names = {test.name for test in written.tests}
    assert len(names) == len(written.tests)
    assert names.issuperset(name for each in written.obligations for name in each.tests)


@pytest.mark.slow
def test_what_is_about_another_sentence_is_left_out(made: Made) -> None:
    changed = (requirement(WITHIN.replace("2", "3"), "R1"), made.requirements[1])
    found = saved(decoded(made.document, Suite), changed)
    assert found.others == ("R1",)
    for part in (found.suite.tests, found.suite.obligations, found.suite.mutants):
        assert {each.requirement for each in part} == {"R2"}


FAULTS: dict[str, tuple[str, Callable[[Any], object]]] = {
    "a place outside": ("is not a valid name for a test", lambda t: t.update(name="../../x")),
    "a line break": ("is not a valid name for a test", lambda t: t.update(name="x\n")),
    "a value that is not there": ("lacks values of `", lambda t: t["rows"][0].update(values={})),
    "a number for a truth value": (
        "cannot be 1",
        lambda t: t["rows"][0]["values"].update(near=1, docking=1),
    ),
    "a truth value for a number": (
        "cannot be True",
        lambda t: t["rows"][0]["values"].update(battery=True, near="x"),
    ),
    "a truth that its numbers do not have": (
        "expects another result than the monitor gives|lacks",
        lambda t: [
            row["values"].update({"(battery < 20)": None, "near": None}) for row in t["rows"]
        ],
    ),
    "no truth beside its numbers": (
        r"lacks values of `(near|\(battery < 20\))`",
        lambda t: [
            row["values"].pop(name, 0) for row in t["rows"] for name in ("(battery < 20)", "near")
        ],
    ),
    "another verdict": (
        "expects another result than the monitor gives",
        lambda t: t.update(verdict="no data"),
    ),
    "another tick": (
        "expects another result than the monitor gives",
        lambda t: t.update(decided=77),
    ),
    "too many ticks": ("more than 1000000 ticks", lambda t: t["rows"][0].update(count=2**40)),
}


@pytest.mark.slow
@each("requirement", ["R1", "R2"])
@each("name", FAULTS)
def test_a_test_that_is_none_is_refused(name: str, requirement: str) -> None:
    message, spoil = FAULTS[name]
    document = deepcopy(made_once().document)
    spoil(next(test for test in document["tests"] if test["requirement"] == requirement))
    if requirement == "R1" and name == "a truth value for a number":
        message = "cannot be 'x'"
    with pytest.raises(WrongError, match=message):
        saved(decoded(document, Suite), made_once().requirements)


def test_two_tests_of_one_name_are_refused(made: Made) -> None:
    made.document["tests"] = (*made.document["tests"], made.document["tests"][0])
    with pytest.raises(WrongError, match="comes twice"):
        saved(decoded(made.document, Suite), made.requirements)
