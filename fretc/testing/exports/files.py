"""Files of `fretc test --emit`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import replace
from enum import StrEnum
from pathlib import PurePosixPath
from typing import assert_never

from compiler.files.artifact import Artifact
from compiler.files.templating import to_json
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.c import monitor as c
from compiler.targets.java import monitor as java
from compiler.targets.python import monitor as emitted
from fretc.testing.exports import simulator
from fretc.testing.exports.pytest_file import MonitorLanguage, pytest_file, targets
from fretc.testing.exports.self_test import java_self_test, self_test
from fretc.testing.exports.tables import TestTable, csv_text, table, ticks
from fretc.testing.suite import Suite, Test


class SuiteFormat(StrEnum):
    """File format of tests; the values are those of `--emit`."""

    PYTEST = "pytest"
    CSV = "csv"
    FRET = "fret"
    C = "c"
    JAVA = "java"


INDEX = "tests.csv"
"""Name of the table of all tests, beside their files."""
Left = Mapping[str, str]
"""Name of a test without a file → the reason."""


def files(
    suite: Suite,
    requirements: Sequence[FormalizedRequirement],
    form: SuiteFormat,
    languages: Sequence[MonitorLanguage] = (MonitorLanguage.PYTHON,),
) -> tuple[tuple[Artifact, ...], Left]:
    """All files of a suite, and the tests that are in none of them.

    Args:
        suite: tests of the requirements.
        requirements: the requirements.
        form: file format.
        languages: languages of the monitors in pytest files.
    """
    by_id = {requirement.id: requirement for requirement in requirements}
    reasons = {
        each.name: _refusal(by_id[each.requirement], each, form, languages) for each in suite.tests
    }
    left = {name: reason for name, reason in reasons.items() if reason is not None}
    tests = [test for test in suite.tests if test.name not in left]
    tested = [by_id[id] for id in dict.fromkeys(test.requirement for test in tests)]
    match form:
        case SuiteFormat.PYTEST:
            made = [file for each in targets(languages) for file in each.emit(tested)]
            sentences = {each.id: each.sentence for each in suite.requirements}
            for requirement in tested:
                own = [test for test in tests if test.requirement == requirement.id]
                test_file = pytest_file(requirement, sentences[requirement.id], own, languages)
                made.append(_apart(test_file, {each.path for each in made}))
        case SuiteFormat.CSV:
            tables = {test.name: table(by_id[test.requirement], test) for test in tests}
            made = [*emitted.emit(tested), *(_csv(name, each) for name, each in tables.items())]
            made.append(_index(tests, tables))
        case SuiteFormat.FRET:
            made = [*_fret(tests, by_id)]
        case SuiteFormat.C:
            made = [*c.emit(tested), self_test(tested, tests)] if tested else []
        case SuiteFormat.JAVA:
            made = [*java.emit(tested), java_self_test(tested, tests)] if tested else []
        case _:
            assert_never(form)
    return tuple(made), left


def _apart(file: Artifact, taken: Set[PurePosixPath]) -> Artifact:
    """Whether its name is that of a monitor, as for requirements `x` and `x_monitor`."""
    path = file.path
    while path in taken:
        path = path.with_stem(f"{path.stem}_")
    return replace(file, path=path)


def _refusal(
    requirement: FormalizedRequirement,
    test: Test,
    form: SuiteFormat,
    languages: Sequence[MonitorLanguage],
) -> str | None:
    """Why a test cannot be written in the format, for example without a monitor; None: it can."""
    match form:
        case SuiteFormat.FRET:
            return simulator.refusal(requirement, test)
        case SuiteFormat.C:
            languages = (MonitorLanguage.C,)
        case SuiteFormat.CSV:
            if f"{test.name}.csv" == INDEX:
                return f"`{INDEX}` is the table of all tests"
            languages = (MonitorLanguage.PYTHON,)
        case SuiteFormat.PYTEST | SuiteFormat.JAVA:
            pass
        case _:
            assert_never(form)
    chosen = [java.TARGET] if form is SuiteFormat.JAVA else targets(languages)
    wrong = next(filter(None, (each.refuse(requirement) for each in chosen)), None)
    return None if wrong is None else wrong.message


def _csv(name: str, own: TestTable) -> Artifact:
    """`<name>.csv`."""
    return Artifact(PurePosixPath(f"{name}.csv"), csv_text(own.names, ticks(own.rows)))


_COLUMNS = ("file", "requirement", "ticks", "verdict", "finite", "decided", "first_violation")


def _index(tests: Sequence[Test], tables: Mapping[str, TestTable]) -> Artifact:
    """Expected results of each table, and the option with which a monitor reads it."""
    rows = (
        (
            f"{test.name}.csv",
            test.requirement,
            test.ticks,
            test.verdict,
            "" if test.finite is None else str(test.finite).lower(),
            test.decided,
            test.first_violation,
            "--propositions" if tables[test.name].of_truths else "",
            test.words,
        )
        for test in tests
    )
    return Artifact(PurePosixPath(INDEX), csv_text((*_COLUMNS, "option", "words"), rows))


def _fret(
    tests: Sequence[Test], requirements: Mapping[str, FormalizedRequirement]
) -> Iterator[Artifact]:
    """`ltlsim.json` with all traces, and each of them as CSV."""
    text = f"{to_json(simulator.traces(requirements, tests))}\n"
    yield Artifact(PurePosixPath("ltlsim.json"), text)
    for test in tests:
        path = PurePosixPath(f"{test.name}.csv")
        yield Artifact(path, simulator.table(requirements[test.requirement], test))
