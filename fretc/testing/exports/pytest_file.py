"""Tests of one requirement as a pytest file, with the monitors that it steps."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.c import monitor as c
from compiler.targets.javascript import monitor as javascript
from compiler.targets.python import monitor as python
from compiler.targets.target import Target
from fretc.testing.exports.tables import TestTable, table, truths
from fretc.testing.suite import Test
from fretish.classes.frozen import dataclass
from monitors.kernel.verdicts import Verdict


class MonitorLanguage(StrEnum):
    """Language of a monitor; the values are those of `--language`."""

    PYTHON = "python"
    C = "c"
    JAVASCRIPT = "js"


TARGETS = {
    MonitorLanguage.PYTHON: python.TARGET,
    MonitorLanguage.C: c.TARGET,
    MonitorLanguage.JAVASCRIPT: javascript.TARGET,
}
_IMPORTS = {
    MonitorLanguage.PYTHON: ("importlib.util", "sys"),
    MonitorLanguage.C: ("ctypes", "functools", "os", "shlex", "subprocess", "tempfile"),
    MonitorLanguage.JAVASCRIPT: ("atexit", "functools", "json", "subprocess"),
}


@dataclass(frozen=True, slots=True)
class _Case:
    """Values of a test for the template."""

    own: Test
    function: str
    table: TestTable
    truths: TestTable | None
    """Truth values of propositions for the monitor in C, if the other table has numbers."""


def targets(languages: Sequence[MonitorLanguage]) -> list[Target]:
    """Targets that generate the monitors."""
    return [TARGETS[language] for language in languages]


def pytest_file(
    requirement: FormalizedRequirement,
    sentence: str,
    tests: Sequence[Test],
    languages: Sequence[MonitorLanguage],
) -> Artifact:
    """`test_<id>.py`.

    Args:
        requirement: requirement that the targets of all languages accept.
        sentence: its sentence.
        tests: tests of the requirement.
        languages: languages of the monitors, without duplicates.
    """
    (names,) = c.interface([requirement]) if MonitorLanguage.C in languages else (None,)
    monitors = [each.emit([requirement])[0].path for each in targets(languages)]
    stem = monitors[0].stem
    text = render(
        "tests/test_monitor.py.j2",
        id=requirement.id,
        sentence=sentence,
        monitors=[path.name for path in monitors],
        stem=stem,
        languages=languages,
        imports=sorted({name for each in languages for name in _IMPORTS[each]}),
        c=names,
        tests=[_case(requirement, test, languages) for test in tests],
        violated=Verdict.VIOLATED,
        pending=Verdict.PENDING,
        satisfied=Verdict.SATISFIED,
        version=__version__,
    )
    return Artifact(PurePosixPath(f"test_{stem.removesuffix('_monitor')}.py"), text)


def _case(
    requirement: FormalizedRequirement, test: Test, languages: Sequence[MonitorLanguage]
) -> _Case:
    own = table(requirement, test)
    more = (
        truths(requirement, test)
        if MonitorLanguage.C in languages and own.names != requirement.watched
        else None
    )
    return _Case(test, f"test_{test.name.replace('-', '_')}", own, more)
