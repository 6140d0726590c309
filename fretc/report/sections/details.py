"""Reads the details behind the rows of the report: results with events, runs with topics.

To save memory, a page reads only the details that it shows, and a format with all details reads and
writes them in groups.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Any

from compiler.project.project import Project
from fretc.audit.evidence.declared_units import in_declared_units, thresholds_in_declared_units
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.evidence.schema import Result, ThresholdRecord
from fretc.report.model.assessments import Assessment
from fretc.report.model.pictures import Histogram
from fretc.report.model.results import ResultRow, ResultView
from fretc.report.model.views import RunSummary, RunView
from fretc.report.pictures.histograms import histograms
from fretc.report.sections.results import result_view
from fretc.report.sections.runs import AuditedFile, RunKey, run_key, topic_views
from fretish.classes.frozen import dataclass

Latencies = Mapping[int, Sequence[float]]
Thresholds = Mapping[int, Sequence[ThresholdRecord]]
"""Index of a result → its thresholds."""
_AT_ONCE = 16_000
"""Maximum number of results that are read at once, unless one requirement has more."""


@dataclass(frozen=True, slots=True)
class Details:
    """The evidence behind the rows of a report."""

    evidence: EvidenceSource | None
    """None if no run was audited."""
    project: Project
    assessments: Mapping[str, Assessment]
    """Anchor of a requirement → its assessment."""
    runs: Mapping[RunKey, AuditedFile]
    rows: Mapping[str, Sequence[ResultRow]]
    """Anchor of a requirement → its results, in the order of the runs."""

    @property
    def logs(self) -> tuple[str, ...]:
        """The names of all runs, as the user gave them."""
        return tuple(dict.fromkeys(run.facts.run for run in self.runs.values()))

    def audited(self, rows: Iterable[ResultRow]) -> Iterator[tuple[ResultRow, Result]]:
        """The result of each row in declared units, in the order of the evidence."""
        rows_at: dict[int, list[ResultRow]] = {}
        for row in rows:
            rows_at.setdefault(row.place, []).append(row)
        for index, result in self.evidence.details(rows_at) if self.evidence else ():
            known = in_declared_units(result, self.project.declarations)
            for row in rows_at[index]:
                yield row, known

    def results(self, rows: Iterable[ResultRow]) -> Iterator[tuple[ResultRow, ResultView]]:
        """The view of each row, in the order of the evidence."""
        for row, result in self.audited(rows):
            assessment = self.assessments[row.section]
            yield row, result_view(result, row, assessment, self.project.declarations)

    def histograms(self, anchors: Iterable[str]) -> Iterator[tuple[str, tuple[Histogram, ...]]]:
        """(anchor, histograms) of some requirements, in their order."""
        for assessment, latencies, thresholds in self._measures(anchors):
            yield assessment.anchor, histograms(assessment, latencies, thresholds)

    def thresholds(self, anchors: Iterable[str]) -> Iterator[tuple[Assessment, Thresholds]]:
        """(assessment, index of a result → thresholds in declared units) of some requirements."""
        for group in self._groups(anchors):
            thresholds = self._thresholds(group)
            yield from ((assessment, thresholds) for assessment in group)

    def _measures(
        self, anchors: Iterable[str]
    ) -> Iterator[tuple[Assessment, Latencies, Thresholds]]:
        for group in self._groups(anchors):
            ids = {assessment.id for assessment in group}
            latencies_of = self.evidence.latencies(ids) if self.evidence else ()
            latencies = {index: array("d", some) for index, some in latencies_of}
            thresholds = self._thresholds(group)
            yield from ((assessment, latencies, thresholds) for assessment in group)

    def _thresholds(self, group: Sequence[Assessment]) -> Thresholds:
        declared = self.project.declarations
        ids = {assessment.id for assessment in group}
        thresholds_of = self.evidence.thresholds(ids) if self.evidence else ()
        return {at: thresholds_in_declared_units(some, declared) for at, some in thresholds_of}

    def _groups(self, anchors: Iterable[str]) -> Iterator[list[Assessment]]:
        """The requirements in their order, in groups whose results are read at once."""
        group: list[Assessment] = []
        for assessment in (self.assessments[anchor] for anchor in anchors):
            if group and sum(len(each.audits) for each in (*group, assessment)) > _AT_ONCE:
                yield group
                group = []
            group.append(assessment)
        if group:
            yield group

    def run_views(self, summaries: Iterable[RunSummary]) -> tuple[RunView, ...]:
        """The runs with their topics, in the given order."""
        ordered = tuple(summaries)
        wanted = {summary.anchor for summary in ordered}
        topics = {}
        for facts in self.evidence.runs() if self.evidence else ():
            anchor = self.runs[run_key(facts)].anchor
            if anchor in wanted and anchor not in topics:
                topics[anchor] = topic_views(facts, self.project)
        return tuple(
            RunView(**_fields(summary), topics=topics[summary.anchor]) for summary in ordered
        )


def _fields(summary: RunSummary) -> dict[str, Any]:
    return {field.name: getattr(summary, field.name) for field in fields(summary)}
