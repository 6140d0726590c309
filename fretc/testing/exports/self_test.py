"""Tests as one file of C or Java, for targets with only a C compiler or a JDK."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.c.monitor import interface as interface_in_c
from compiler.targets.java.monitor import interface as interface_in_java
from fretc.testing.exports.tables import Cell, truths
from fretc.testing.suite import Test
from fretish.classes.frozen import dataclass
from monitors.kernel.verdicts import Verdict

NAME = PurePosixPath("fretc_self_test.c")
JAVA_NAME = PurePosixPath("FretcSelfTest.java")


@dataclass(frozen=True, slots=True)
class _Syntax:
    """The values of a test in a language."""

    truths: Mapping[Cell, str]
    """Truth values of the finite verdict."""
    inputs: Mapping[Cell, str]
    tick: Callable[[int | None], str]
    verdict: str
    """The format of a verdict, by its name."""


_CODES: Mapping[Cell, str] = {False: "0", True: "1", None: "2"}
"""Codes of truth values in the headers of monitors in C."""
_C = _Syntax(_CODES, _CODES, lambda tick: "FRETC_NEVER" if tick is None else f"{tick}u", "FRETC_{}")
_JAVA = _Syntax(
    {False: "FALSE", True: "TRUE", None: "UNKNOWN"},
    {False: "0", True: "1", None: "?"},
    lambda tick: "NEVER" if tick is None else str(tick),
    "{}",
)


@dataclass(frozen=True, slots=True)
class _Requirement:
    """Values of a requirement for the template."""

    id: str
    sentence: str
    names: Any
    """The names in the interface of the monitor."""
    before: int
    """Number of tests of earlier requirements."""
    tests: tuple[Mapping[str, Any], ...]


def self_test(formalized: Sequence[FormalizedRequirement], tests: Sequence[Test]) -> Artifact:
    """Self-test of monitors in C, which are in the same folder.

    Args:
        formalized: requirements with at least one test each.
        tests: their tests, numbered requirement by requirement from 1 on.
    """
    requirements = [*_requirements(formalized, interface_in_c(formalized), tests, _C)]
    text = render("tests/self_test.c.j2", requirements=requirements, version=__version__)
    return Artifact(NAME, text)


def java_self_test(formalized: Sequence[FormalizedRequirement], tests: Sequence[Test]) -> Artifact:
    """Self-test of monitors in Java, which are in the same folder; arguments as of `self_test`."""
    requirements = [*_requirements(formalized, interface_in_java(formalized), tests, _JAVA)]
    text = render("tests/self_test.java.j2", requirements=requirements, version=__version__)
    return Artifact(JAVA_NAME, text)


def _requirements(
    requirements: Sequence[FormalizedRequirement],
    interfaces: Sequence[Any],
    tests: Sequence[Test],
    syntax: _Syntax,
) -> Iterator[_Requirement]:
    before = 0
    for requirement, names in zip(requirements, interfaces, strict=True):
        own = [test for test in tests if test.requirement == requirement.id]
        numbered = tuple(
            _test(requirement, test, number, syntax) for number, test in enumerate(own, before + 1)
        )
        yield _Requirement(requirement.id, requirement.entry.wording.text, names, before, numbered)
        before += len(own)


def _test(
    requirement: FormalizedRequirement, test: Test, number: int, syntax: _Syntax
) -> dict[str, Any]:
    rows = truths(requirement, test).rows
    return {
        "number": number,
        "name": test.name,
        "words": test.words,
        "rows": [(count, [syntax.inputs[value] for value in values]) for count, values in rows],
        "decided": syntax.tick(test.decided),
        "violated": syntax.tick(test.first_violation),
        "verdict": syntax.verdict.format(_verdict(test)),
        "finite": syntax.truths[test.finite],
    }


def _verdict(test: Test) -> str:
    """The verdict, from the tick on at which it is decided."""
    if test.decided is None:
        return "PENDING"
    return "VIOLATED" if test.verdict is Verdict.VIOLATED else "SATISFIED"
