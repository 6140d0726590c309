"""`--sarif`: the verdicts as code scanning results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from fretc.audit.evidence.declared_units import bare
from fretc.audit.outputs import sarif as results
from fretc.report.model.views import ReportView
from fretc.report.sections.details import Details
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.documents import RequirementEntry


def sarif(
    report: ReportView,
    details: Details,
    requirements: Sequence[FormalizedRequirement],
    diagnostics: Sequence[Diagnostic],
    failed: Sequence[RequirementEntry] = (),
) -> str:
    """One SARIF run.

    Args:
        report: the report.
        details: the evidence behind the report.
        requirements: all requirements of the project.
        diagnostics: diagnostics about requirements and evidence.
        failed: unformalized requirements of the project.
    """
    all_runs = list(_all_runs(report))
    return results.sarif(
        list(_single_runs(report, details)), requirements, diagnostics, all_runs, failed
    )


def _single_runs(report: ReportView, details: Details) -> Iterator[results.OneRun]:
    """The results of single runs, with the verdicts of the report, in the order of the evidence."""
    views = {view.id: view.results for view in report.requirements}
    for row, result in details.audited(row for rows in views.values() for row in rows):
        yield results.OneRun(bare(result), row.mark.word, row.suspicions)


def _all_runs(report: ReportView) -> Iterator[results.AllRuns]:
    """The estimate over all runs for each requirement with a probability."""
    for view in report.requirements:
        probability = view.probability
        if probability is not None:
            text = "; ".join((probability.reason, *probability.lines))
            why = probability.suspicions or view.suspicions
            yield results.AllRuns(view.id, probability.mark.word, text, why)
