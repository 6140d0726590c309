"""The examples of docs/coverage.md are what the commands print."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

from compiler.project.folder import load
from compiler.project.paths import requirement_files
from compiler.project.project import Project
from fretc.audit.many_logs import SEQUENTIAL, AuditOutcome, audit_logs
from fretc.audit.plan import Plan, planned
from fretc.coverage import mutation_output, mutation_record, record, text_output
from fretc.coverage.coverage import Coverage, coverage
from fretc.coverage.mutation import MutationResult, mutation_job, survey
from fretish.diagnostics.diagnostic import Diagnostic
from tests.docs.pages import FOLDER, is_current

ROOT = Path(__file__).parents[2]
LOG = "traces/mission-seed15.mcap"


@pytest.fixture(autouse=True)
def _at_home(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)


@cache
def mission() -> tuple[Project, Plan]:
    files = requirement_files("requirements/mission")
    assert not isinstance(files, Diagnostic)
    project = load(files, "requirements/mission/bindings.toml")
    plan = planned(project)
    assert isinstance(plan, Plan)
    return project, plan


@cache
def covered() -> Coverage:
    _, plan = mission()
    audit = audit_logs(plan, [LOG], SEQUENTIAL)
    assert isinstance(audit, AuditOutcome)
    return coverage(audit.source)


@cache
def surveyed() -> MutationResult:
    return survey(mutation_job(*mission()), [LOG], 1, lambda _: None)


def titles() -> dict[str, str]:
    return {each.id: each.name for each in mission()[0].requirements}


def of(lines: list[str], name: str) -> str:
    """What is printed of one requirement, and the last line."""
    first = next(n for n, line in enumerate(lines) if f"{name}:" in line)
    below = next((n for n in range(first + 1, len(lines)) if lines[n][:1] != " "), len(lines))
    parts = [*lines[first:below], *(["…"] if below < len(lines) - 2 else []), "", lines[-1]]
    return "\n".join(f"    {line}".rstrip() for line in parts)


def seen(subject: str) -> str:
    found = [text for text, _ in text_output.lines(covered(), titles(), every=True)]
    return of(found, titles()[subject])


def noticed(subject: str) -> str:
    found = [text for text, _ in mutation_output.lines(surveyed(), titles(), every=False)]
    return of(found, titles()[subject])


def counted(_: str) -> str:
    return f"    {text_output.in_counts(covered().requirements)}: `fretc coverage` lists them"


MAKERS = {"coverage": seen, "mutants": noticed, "count": counted}


@pytest.mark.slow
def test_the_examples_are_what_is_printed(request: pytest.FixtureRequest) -> None:
    is_current("coverage.md", MAKERS, request)


@pytest.mark.parametrize(
    ("heading", "record"),
    [
        ("## As JSON", record.CoverageDocument),
        ("## As JSON", record.CoveredRequirement),
        ("## As JSON", record.CoveredSituation),
        ("### As JSON", mutation_record.MutationDocument),
        ("### As JSON", mutation_record.RequirementMutants),
        ("### As JSON", mutation_record.RecordedMutant),
    ],
)
def test_every_key_of_the_json_is_told(heading: str, record: type) -> None:
    page = (FOLDER / "coverage.md").read_text("utf-8").partition(f"\n{heading}\n")[2]
    told = set(re.findall(r"`(\w+)`", page.partition("\n## ")[0]))
    names: tuple[str, ...] = record.__struct_fields__  # type: ignore[attr-defined]
    assert {*names} - {"schema", "fretc"} <= told
