"""Tests as one C file, for targets with only a C compiler."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.c.monitor import Interface, interface
from fretc.testing.exports.tables import Cell, truths
from fretc.testing.suite import Test
from fretish.classes.frozen import dataclass
from monitors.kernel.verdicts import Verdict

NAME = PurePosixPath("fretc_self_test.c")
_CODES: Mapping[Cell, int] = {False: 0, True: 1, None: 2}
"""Codes of truth values in the headers of monitors."""


@dataclass(frozen=True, slots=True)
class _Requirement:
    """Values of a requirement for the template."""

    id: str
    sentence: str
    names: Interface
    before: int
    """Number of tests of earlier requirements."""
    tests: tuple[Mapping[str, Any], ...]


def self_test(formalized: Sequence[FormalizedRequirement], tests: Sequence[Test]) -> Artifact:
    """Self-test of monitors in C, which are in the same folder.

    Args:
        formalized: requirements with at least one test each.
        tests: their tests, numbered requirement by requirement from 1 on.
    """
    requirements = [*_requirements(formalized, tests)]
    text = render("tests/self_test.c.j2", requirements=requirements, version=__version__)
    return Artifact(NAME, text)


def _requirements(
    requirements: Sequence[FormalizedRequirement], tests: Sequence[Test]
) -> Iterator[_Requirement]:
    before = 0
    for requirement, names in zip(requirements, interface(requirements), strict=True):
        own = [test for test in tests if test.requirement == requirement.id]
        numbered = tuple(
            _test(requirement, test, number) for number, test in enumerate(own, before + 1)
        )
        yield _Requirement(requirement.id, requirement.entry.wording.text, names, before, numbered)
        before += len(own)


def _test(requirement: FormalizedRequirement, test: Test, number: int) -> dict[str, Any]:
    rows = truths(requirement, test).rows
    return {
        "number": number,
        "name": test.name,
        "words": test.words,
        "rows": [(count, [_CODES[value] for value in values] or [0]) for count, values in rows],
        "decided": _tick(test.decided),
        "violated": _tick(test.first_violation),
        "verdict": _verdict(test),
        "finite": _CODES[test.finite],
    }


def _verdict(test: Test) -> str:
    """The verdict, from the tick on at which it is decided."""
    if test.decided is None:
        return "FRETC_PENDING"
    return "FRETC_VIOLATED" if test.verdict is Verdict.VIOLATED else "FRETC_SATISFIED"


def _tick(tick: int | None) -> str:
    return "FRETC_NEVER" if tick is None else f"{tick}u"
