"""`--sarif`: what the runs show, for code scanning, each verdict with its currency."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from fretc.audit.evidence.declared_units import bare
from fretc.audit.outputs import sarif as results
from fretc.report.model.views import Report
from fretc.report.sections.details import Details
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.documents import RequirementEntry


def sarif(
    report: Report,
    details: Details,
    requirements: Sequence[FormalizedRequirement],
    diagnostics: Sequence[Diagnostic],
    failed: Sequence[RequirementEntry] = (),
) -> str:
    """One SARIF run.

    Args:
        report: what it says.
        details: the evidence behind it.
        requirements: all requirements of the project.
        diagnostics: what there is to say of requirements and evidence.
        failed: requirements of the project without a rule.
    """
    all_runs = list(_all_runs(report))
    return results.sarif(
        list(_single_runs(report, details)), requirements, diagnostics, all_runs, failed
    )


def _single_runs(report: Report, details: Details) -> Iterator[results.OneRun]:
    """With verdict and currency as the report has them, in the order of the evidence."""
    views = {view.id: view.results for view in report.requirements}
    for row, result in details.audited(row for rows in views.values() for row in rows):
        yield results.OneRun(bare(result), row.mark.word, row.suspicions)


def _all_runs(report: Report) -> Iterator[results.AllRuns]:
    """What all runs say of each requirement with a probability."""
    for view in report.requirements:
        probability = view.probability
        if probability is not None:
            text = "; ".join((probability.reason, *probability.lines))
            why = probability.suspicions or view.suspicions
            yield results.AllRuns(view.id, probability.mark.word, text, why)
