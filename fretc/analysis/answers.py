"""Answers of earlier analyses, so that a changed sentence asks again only what it touches.

Answers are kept by problem: the questions about the same requirements share what they compute, so
that all of them are reused or none. A fingerprint covers all that the answers depend on. The file
begins with a mark that only the user's key can make, for its path and its content: answers that
came with somebody's files are not believed.
"""

from __future__ import annotations

import hashlib
import hmac
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from importlib.metadata import version
from itertools import count
from pathlib import Path
from typing import Any

from compiler.files.build_id import build_id
from compiler.files.checked_json import SchemaError
from compiler.files.records import Record, decoded, decoded_json, json_bytes, plain
from compiler.files.text_files import read, write
from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.arena.roles import Roles, role
from fretc.analysis.conflicts import Completeness
from fretc.analysis.findings import (
    Component,
    Conflict,
    Inconsistency,
    OpenQuestion,
    Redundancy,
    Repair,
    Vacuity,
)
from fretc.analysis.games.job import Job
from fretc.analysis.implications import Consistency, ConstantRequirement, Removable
from fretc.analysis.worker import Interrupted
from fretc.analysis.worker import answers as of_worker
from fretish import expressions as e
from fretish.bindings import canonical
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.recursion import with_recursion_limit

_KINDS = {
    kind.__name__: kind
    for kind in (
        Completeness,
        Component,
        Conflict,
        Consistency,
        ConstantRequirement,
        Inconsistency,
        OpenQuestion,
        Redundancy,
        Removable,
        Repair,
        Vacuity,
    )
}
SUFFIX = ".answers"
"""Suffix of the file, which lies beside the analysis."""
_LIBRARIES = ("oxidd", "z3-solver")
"""The libraries that decide answers, beside those of the identity of the build."""
_MOST = 5_000
"""Maximum number of problems of a file; the oldest are left out."""


class _Finding(Record, frozen=True):
    kind: str
    value: dict[str, Any]


_Answers = tuple[tuple[_Finding, ...], ...]
"""The findings of each question about a problem, in the order of the questions."""


class _Content(Record, frozen=True):
    build: str
    """The identity of the tool and of its libraries."""
    problems: dict[str, _Answers]
    """Fingerprint → answers, the oldest first."""


# Fingerprints -------------------------------------------------------------------------------------


@with_recursion_limit
def fingerprint(
    kind: str,
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    roles: Roles,
    options: Sequence[object],
) -> str:
    """SHA-256 of all that the answers to some questions depend on, except the tool itself.

    Args:
        kind: which questions.
        requirements: the requirements, in the order of the files.
        assumptions: the assumptions that concern them.
        roles: roles of all variables.
        options: limits and other choices.
    """
    every = (*requirements, *assumptions)
    names = {name for each in every for name in each.variables}
    parts = (
        kind,
        repr(options),
        *(f"{name} {roles.get(name)}" for name in sorted(names)),
        *(line for each in requirements for line in _lines(each)),
        "assumptions",
        *(line for each in assumptions for line in _lines(each)),
    )
    return canonical.digest(parts)


def _lines(requirement: FormalizedRequirement) -> Iterator[str]:
    """All that the analysis reads of a requirement: its sentence, and what its names mean."""
    yield from (requirement.id, repr(requirement.written), repr(requirement.sentence))
    yield from (repr(requirement.ticks), repr(requirement.clock), repr(requirement.definitions))
    yield from map(str, (requirement.ft_infinite, requirement.ft_finite, requirement.pt))
    yield repr(requirement.watch)
    for name in requirement.variables:
        yield f"{name} {role(requirement, name)} {requirement.glossary.get(name)!r}"
    declared = requirement.declarations
    if declared is not None:
        yield from _declared(declared, {*requirement.variables, *requirement.propositions})


def _declared(declarations: Declarations, names: Iterable[str]) -> Iterator[str]:
    """What the bindings declare of some names, and of all names that these read."""
    waiting, seen = sorted(names), set[str]()
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        proposition = declarations.propositions.get(name)
        computed = declarations.computed.get(name)
        yield f"{name} {declarations.signals.get(name)!r} {proposition!r} {computed!r}"
        yield repr(sorted(key for key in declarations.mistakes if name in key))
        if proposition is not None:
            waiting.extend(each.id for each in e.names(proposition.expression))
            waiting.extend(proposition.signals)
        if computed is not None:
            waiting.extend(each.id for each in e.names(computed.value))


# Reuse --------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class KeptAnswers:
    """Answers by the fingerprints of their problems."""

    problems: Mapping[str, _Answers] = field(default_factory=dict)

    def of(self, jobs: Sequence[Job[Any]]) -> Mapping[int, tuple[Any, ...]]:
        """The known findings of jobs, by their indices: of a problem all or none."""
        known: dict[int, tuple[Any, ...]] = {}
        for problem, indices in _by_problem(jobs).items():
            kept = self.problems.get(problem, ())
            if len(kept) == len(indices):
                findings = (tuple(map(_finding, each)) for each in kept)
                known |= zip(indices, findings, strict=True)
        return known

    def with_more(
        self, jobs: Sequence[Job[Any]], findings: Mapping[int, Sequence[Any]]
    ) -> KeptAnswers:
        """These answers and those of the problems whose questions all have been answered.

        Args:
            jobs: all questions.
            findings: the findings of the answered ones, by their indices.
        """
        problems = dict(self.problems)
        for problem, indices in _by_problem(jobs).items():
            if all(index in findings for index in indices):
                problems.pop(problem, None)  # the newest are last
                own = [tuple(findings[index]) for index in indices]
                stored = tuple(tuple(map(_stored, each)) for each in own)
                if [tuple(map(_finding, each)) for each in stored] == own:
                    problems[problem] = stored
        return KeptAnswers(dict([*problems.items()][-_MOST:]))


def answers(
    jobs: Sequence[Job[Any]], kept: KeptAnswers, progress: Callable[[int, str], None]
) -> tuple[list[Any], KeptAnswers, bool]:
    """Answers of questions, of which those that are known are not asked.

    Args:
        jobs: the questions.
        kept: what is known.
        progress: called with the number of questions that were asked and answered, and the title
            of the next one.

    Returns:
        The findings in the order of the questions, all answers that are known now, and whether
        Ctrl-C has stopped them.
    """
    known = kept.of(jobs)
    missing = [index for index in range(len(jobs)) if index not in known]
    given: dict[int, tuple[Any, ...]] = {**known}
    findings: dict[int, list[Any]] = {index: [*some] for index, some in known.items()}
    earlier = [finding for index in sorted(known) for finding in known[index]]
    numbers = count()

    def show(title: str) -> None:
        progress(next(numbers), title)

    is_stopped = False
    try:
        for number, finding in of_worker([jobs[index] for index in missing], show, earlier):
            own = findings.setdefault(missing[number], [])
            if finding is None:
                given[missing[number]] = tuple(own)
            else:
                own.append(finding)
    except Interrupted:
        is_stopped = True
    ordered = [finding for index in range(len(jobs)) for finding in findings.get(index, ())]
    return ordered, kept.with_more(jobs, given), is_stopped


def _by_problem(jobs: Sequence[Job[Any]]) -> Mapping[str, list[int]]:
    problems: dict[str, list[int]] = {}
    for index, job in enumerate(jobs):
        if job.problem is not None:
            problems.setdefault(job.problem(), []).append(index)
    return problems


def _stored(finding: object) -> _Finding:
    return _Finding(type(finding).__name__, plain(finding))


def _finding(stored: _Finding) -> object:
    if stored.kind not in _KINDS:
        raise SchemaError(f"`{stored.kind}` is no kind of finding")
    return decoded(stored.value, _KINDS[stored.kind])


# Files --------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class AnswerFile:
    """The file in which a user keeps answers."""

    path: Path
    key: bytes
    """The key of the user."""

    def read(self) -> KeptAnswers:
        """Its answers; none if it is missing, damaged, of another user, or of another build."""
        source = read(str(self.path)) if self.path.is_file() else None
        if source is None or isinstance(source, Diagnostic):
            return KeptAnswers()
        mark, _, body = source.text.partition("\n")
        if not hmac.compare_digest(mark.encode(), self._mark(body).encode()):
            return KeptAnswers()
        content = decoded_json(body.encode(), _Content)
        return KeptAnswers(content.problems if content.build == _build() else {})

    def write(self, kept: KeptAnswers) -> Diagnostic | None:
        """Replace its answers; a diagnostic if the file cannot be written."""
        body = json_bytes(_Content(_build(), dict(kept.problems))).decode()
        return write({self.path: f"{self._mark(body)}\n{body}"})

    def _mark(self, body: str) -> str:
        """What only the user's key can make of a path and a content."""
        content = hashlib.sha256(body.encode()).hexdigest()
        text = f"{os.path.realpath(self.path)}\n{content}"
        return hmac.digest(self.key, text.encode(), "sha256").hex()


def _build() -> str:
    return " ".join((build_id(), *map(version, _LIBRARIES)))
