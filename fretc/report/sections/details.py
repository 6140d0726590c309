"""What the report has in rows only, read in full: results with their events, runs with topics.

A report of many runs never holds all of it: a page reads the few that it shows, and a form that has
them all reads and writes them one after the other.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any

from compiler.project.folder import Project
from fretc.audit.evidence.briefs import EvidenceSource
from fretc.audit.evidence.declared_units import in_declared_units
from fretc.audit.evidence.schema import Result
from fretc.report.model.assessments import Assessment
from fretc.report.model.views import ResultRow, ResultView, RunSummary, RunView
from fretc.report.sections.results import result_view
from fretc.report.sections.runs import Run, RunKey, run_key, topic_views


@dataclass(frozen=True, slots=True)
class Details:
    """The evidence behind the rows of a report."""

    evidence: EvidenceSource | None
    """None where no run has been audited."""
    project: Project
    assessments: Mapping[str, Assessment]
    """Each with the anchor of its requirement."""
    runs: Mapping[RunKey, Run]

    @property
    def logs(self) -> tuple[str, ...]:
        """The names of all runs, as the user gave them."""
        return tuple(dict.fromkeys(run.facts.run for run in self.runs.values()))

    def audited(self, rows: Iterable[ResultRow]) -> Iterator[tuple[ResultRow, Result]]:
        """The result of each row in declared units, in the order of the evidence."""
        rows_at: dict[int, list[ResultRow]] = {}
        for row in rows:
            rows_at.setdefault(row.place, []).append(row)
        for place, result in self.evidence.details(rows_at) if self.evidence else ():
            known = in_declared_units(result, self.project.declarations)
            for row in rows_at[place]:
                yield row, known

    def results(self, rows: Iterable[ResultRow]) -> Iterator[tuple[ResultRow, ResultView]]:
        """The view of each row, in the order of the evidence."""
        for row, result in self.audited(rows):
            assessment = self.assessments[row.requirement]
            yield row, result_view(result, row, assessment, self.project.declarations)

    def run_views(self, summaries: Iterable[RunSummary]) -> tuple[RunView, ...]:
        """The runs with their topics, in the order in which they are given."""
        ordered = tuple(summaries)
        wanted = {each.anchor for each in ordered}
        topics = {}
        for facts in self.evidence.runs() if self.evidence else ():
            anchor = self.runs[run_key(facts)].anchor
            if anchor in wanted and anchor not in topics:
                topics[anchor] = topic_views(facts, self.project)
        return tuple(RunView(**_fields(each), topics=topics[each.anchor]) for each in ordered)


def _fields(summary: RunSummary) -> dict[str, Any]:
    return {field.name: getattr(summary, field.name) for field in fields(summary)}
