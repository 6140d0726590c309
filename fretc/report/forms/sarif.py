"""`--sarif`: what the runs show, for code scanning, each verdict with its currency."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.formalization.formalized import Formalized
from fretc.audit.evidence.schema import Result
from fretc.audit.outputs import sarif as results
from fretc.report.model.views import Report
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.documents import Requirement


def sarif(
    report: Report,
    audited: Sequence[Result],
    rules: Sequence[Formalized],
    diagnostics: Sequence[Diagnostic],
    failed: Sequence[Requirement] = (),
) -> str:
    """One SARIF run.

    Args:
        report: what it says.
        audited: the results of the evidence, in its order.
        rules: all requirements of the project.
        diagnostics: what there is to say of requirements and evidence.
        failed: requirements of the project without a rule.
    """
    all_runs = list(_all_runs(report))
    return results.sarif(list(_single_runs(report, audited)), rules, diagnostics, all_runs, failed)


def _single_runs(report: Report, audited: Sequence[Result]) -> Iterator[results.OneRun]:
    """With verdict and currency as the report has them."""
    views = {view.id: iter(view.results) for view in report.requirements}
    for result in audited:
        view = next(views.get(result.requirement, iter(())), None)
        if view is None:
            continue  # evidence of what is not among the requirements is a diagnostic
        yield results.OneRun(result, view.mark.word, view.suspicions)


def _all_runs(report: Report) -> Iterator[results.AllRuns]:
    """What all runs say of each requirement with a probability."""
    for view in report.requirements:
        probability = view.probability
        if probability is not None:
            text = "; ".join((probability.reason, *probability.lines))
            why = probability.suspicions or view.suspicions
            yield results.AllRuns(view.id, probability.mark.word, text, why)
