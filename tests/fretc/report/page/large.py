"""Reports of any size, made of a small one: copies of its requirements in as many runs as asked."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from fretc.report.make import ReportBuild
from fretc.report.model.front import ColumnRun, RunGroup
from fretc.report.model.marks import Mark, verdict_mark
from fretc.report.model.results import ResultRow
from fretc.report.model.views import HazardRequirement, HazardView, ReportView, RequirementView
from fretc.report.page.html import html
from tests.fretc.report.cases import project, report_of, result

MARKS = [
    verdict_mark(word, suspect=suspect)
    for word in ("violated", "no data", "inconclusive", "vacuous", "satisfied")
    for suspect in (False, True)
]
Choose = Callable[[int, int], Mark | None]


def worst(marks: Sequence[Mark]) -> Mark:
    return min(marks, key=lambda mark: mark.severity, default=verdict_mark("not exercised"))


def enlarged(
    report: ReportView, requirements: int, groups: Sequence[tuple[str, int]], choose: Choose
) -> ReportView:
    """So many requirements, ten to a hazard, in so many runs of each group.

    `choose` says the mark of a requirement in a run; None: the run has no result of it.
    """
    (view,) = report.requirements
    (like,) = view.results
    (row,) = report.matrix
    runs = [
        ColumnRun(f"run-{group}-{n}", f"{name}-{n}", str(n))
        for group, (name, count) in enumerate(groups)
        for n in range(1, count + 1)
    ]
    columns = iter(runs)
    named = [RunGroup(name, tuple(next(columns) for _ in range(count))) for name, count in groups]
    views: list[RequirementView] = []
    rows: list[HazardRequirement] = []
    for number in range(requirements):
        results = _results(like, number, runs, choose)
        mark = worst([each.mark for each in results])
        id, anchor, title = f"R{number}", f"req-R{number}", f"Title {number}"
        views.append(
            replace(view, id=id, anchor=anchor, title=title, mark=mark, results=tuple(results))
        )
        count = sum(each.mark.word == mark.word for each in results)
        hazard = f"H{number // 10}"
        rows.append(
            replace(
                row, hazard=hazard, hazard_title=f"Hazard {hazard}", requirement=id, title=title,
                anchor=anchor, mark=mark, runs=count,
            )
        )  # fmt: skip
    (known,) = report.hazards
    hazards = [replace(known, id=f"H{n}") for n in range((requirements + 9) // 10)]
    return replace(
        report,
        requirements=tuple(views),
        matrix=tuple(rows),
        front=replace(report.front, groups=tuple(named)),
        hazards=tuple[HazardView, ...](hazards),
    )


def _results(
    like: ResultRow, number: int, runs: Sequence[ColumnRun], choose: Choose
) -> list[ResultRow]:
    results = []
    for column, run in enumerate(runs):
        mark = choose(number, column)
        if mark is not None:
            results.append(
                replace(
                    like, requirement=f"R{number}", section=f"req-R{number}", number=column + 1,
                    anchor=f"result-R{number}.{column + 1}",
                    run=run.anchor, run_file=run.name, mark=mark,
                )
            )  # fmt: skip
    return results


def page(
    build: ReportBuild, requirements: int, groups: Sequence[tuple[str, int]], choose: Choose
) -> str:
    """The page of such a report."""
    assert build.report is not None
    assert build.details is not None
    report = enlarged(build.report, requirements, groups, choose)
    (one,) = build.details.assessments.values()
    many = replace(one, audits=one.audits * sum(count for _, count in groups))
    assessments = {view.anchor: many for view in report.requirements}
    return html(report, replace(build.details, assessments=assessments))


def small(folder: Path) -> ReportBuild:
    """One requirement in one run."""
    known = project(folder)
    return report_of(known, folder, result(known, "satisfied"))


def mostly_satisfied(seed: int, share: float) -> Choose:
    """Of each mark but `satisfied` a share of all cells."""
    random_source = random.Random(seed)
    satisfied = verdict_mark("satisfied")

    def choose(requirement: int, run: int) -> Mark | None:
        return satisfied if random_source.random() > share else random_source.choice(MARKS)

    return choose
