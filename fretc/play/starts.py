"""Traces that the page can start from: examples, tests, conflicts.

Traces have values of variables and propositions; a missing value is unknown.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.explanation.explain import explanation
from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.evidence import AnalysisDocument
from fretc.testing.suite import Suite
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.printer import sentence as printed

Value = bool | int | float | str | None
Ticks = tuple[int, dict[str, Value]]
"""(number of consecutive equal ticks, their values)."""
MOST = 2_000
"""Maximum number of ticks of a trace on a page."""


@dataclass(frozen=True, slots=True)
class RecordedPlace:
    """The place of a trace in a recorded run."""

    run: str
    number: int
    """Number of the violation of its requirement in the run, from 1."""
    seconds: float
    """The time of the first tick of the trace, from the first tick of the run."""


@dataclass(frozen=True, slots=True)
class Start:
    """A trace, with a description."""

    group: str
    name: str
    about: str
    requirements: tuple[str, ...]
    """Ids of the requirements that the trace is about."""
    rows: tuple[Ticks, ...]
    place: RecordedPlace | None = None
    """None if the trace is not of a recorded run."""

    @property
    def ticks(self) -> int:
        """The length of the trace."""
        return sum(count for count, _ in self.rows)


def of_examples(requirements: Sequence[FormalizedRequirement]) -> Iterator[Start]:
    """The traces of `fretc explain`; a repeating part appears twice."""
    for requirement in requirements:
        if (requirement.ticks or 0) > MOST:
            continue
        explained = explanation(requirement)
        for shown in explained.traces:
            names = explained.propositions
            rows: list[Ticks] = [
                (row.last - row.first + 1, dict(zip(names, row.values, strict=True)))
                for row in shown.rows
            ]
            again = [row for row, each in zip(rows, shown.rows, strict=True) if each.repeats]
            word = "satisfied" if shown.satisfied else "violated"
            name = f"{requirement.id}, {word}: {shown.reason}"
            yield Start("Examples", name, name, (requirement.id,), (*rows, *again))


def of_suite(suite: Suite, requirements: Sequence[FormalizedRequirement]) -> Iterator[Start]:
    """The tests of requirements whose sentences have not changed."""
    fingerprints = {requirement.id: requirement.fingerprint for requirement in requirements}
    same = {
        requirement.id
        for requirement in suite.requirements
        if fingerprints.get(requirement.id) == requirement.fingerprint
    }
    for test in suite.tests:
        if test.requirement in same:
            rows = tuple((row.count, dict(row.values)) for row in test.rows)
            about = f"{test.name}: {test.words}"
            name = f"{test.requirement}: {test.words}"
            yield Start("Tests", name, about, (test.requirement,), rows)


def changed(suite: Suite, requirements: Sequence[FormalizedRequirement]) -> tuple[str, ...]:
    """The requirements that have changed since the tests were generated."""
    fingerprints = {requirement.id: requirement.fingerprint for requirement in requirements}
    return tuple(
        requirement.id
        for requirement in suite.requirements
        if fingerprints.get(requirement.id, requirement.fingerprint) != requirement.fingerprint
    )


def others(
    document: AnalysisDocument, requirements: Sequence[FormalizedRequirement]
) -> tuple[str, ...]:
    """The requirements of an analysis that have changed, or are not in the project."""
    sentences = {requirement.id: printed(requirement.written) for requirement in requirements}
    members = document.requirements.items()
    return tuple(id for id, member in members if sentences.get(id) != member.sentence)


def of_analysis(document: AnalysisDocument, changed: Sequence[str]) -> Iterator[Start]:
    """The runs of conflicts between unchanged requirements; a loop appears three times."""
    for conflict in document.analysis.conflicts:
        if not {*changed}.isdisjoint(conflict.requirements):
            continue
        rows = [(1, dict[str, Value](tick)) for tick in conflict.play]
        if rows:
            loop = rows[conflict.loop :] if conflict.loop is not None else []
            name = f"{', '.join(conflict.requirements)}: {conflict.because}"
            yield Start("Conflicts", name, name, conflict.requirements, (*rows, *loop, *loop))


def stale(path: str, why: str, again: str) -> Diagnostic:
    """A warning that traces of a file are left out because they are outdated."""
    return diagnostic("stale_traces", path=path, why=why, again=again)
