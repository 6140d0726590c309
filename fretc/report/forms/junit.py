"""`--junit`: a suite for each run with a test case for each requirement, for CI servers.

A first suite, named after the project, has cases without a single run: requirements that were not
audited, probabilities, counterexamples, and withdrawn requirements.

Source: the JUnit schema of the Jenkins xUnit plugin, https://github.com/jenkinsci/xunit-plugin.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from fretc.audit.evidence import verdicts
from fretc.audit.evidence.verdicts import RETIRED, WAIVED
from fretc.audit.outputs.junit import Case, Suite, xml
from fretc.report.model.results import ResultRow
from fretc.report.model.views import ReportView, RequirementView
from fretc.report.sections.proofs import is_refuted, refutations


def junit(report: ReportView) -> str:
    """The JUnit XML; a case is a failure or an error if `--strict` would exit with 1."""
    withdrawn = {withdrawal.requirement for withdrawal in report.withdrawn}
    views = [view for view in report.requirements if view.id not in withdrawn]
    of_project = [_of_requirement(view) for view in views if _needs_own_case(view)]
    of_project += [
        Case(withdrawal.requirement, "failure", f"withdrawn: {withdrawal.text}")
        for withdrawal in report.withdrawn
    ]
    accepted = [
        (f"accepted {remark.code}: {remark.message}", remark.accepted)
        for remark in report.remarks
        if remark.accepted
    ]
    runs = [Suite(run, cases) for run, cases in _by_run(views).items()]
    return xml("fretc report", [Suite(report.project, of_project, accepted), *runs])


def _by_run(views: Sequence[RequirementView]) -> dict[str, list[Case]]:
    """Name of a run → its cases; runs of the same file are distinguished by their labels."""
    files = {result.run: result for view in views for result in view.results}
    names = Counter(result.run_file for result in files.values())
    cases: dict[str, list[Case]] = {}
    for view in views:
        for result in view.results:
            again = names[result.run_file] > 1
            run = f"{result.run_file} ({result.run_label})" if again else result.run_file
            cases.setdefault(run, []).append(_of_run(view, result))
    return cases


def _of_run(view: RequirementView, result: ResultRow) -> Case:
    kind = _kind_of_run(view, result)
    if not kind:
        return Case(view.name, "")
    why = "; ".join((result.reason, *result.suspicions))
    waived = f"{view.mark.text}, {view.waiver.reason}: " if view.waiver and _is_waived(view) else ""
    text = "" if kind == "skipped" else view.sentence
    return Case(view.name, kind, f"{waived}{result.mark.text}: {why}", text)


def _kind_of_run(view: RequirementView, result: ResultRow) -> str:
    """The outcome of a run; waived and retired requirements pass."""
    kind = verdicts.junit(result.mark.word, suspect=result.mark.suspect)
    return "skipped" if kind and (_is_waived(view) or view.mark.word == RETIRED) else kind


def _is_waived(view: RequirementView) -> bool:
    return view.mark.word == WAIVED


def _needs_own_case(view: RequirementView) -> bool:
    """Whether the requirement needs a case in the first suite, beside the cases of its runs."""
    kinds = {_kind_of_run(view, result) for result in view.results}
    return view.probability is not None or _kind(view) not in kinds


def _kind(view: RequirementView) -> str:
    """The XML element of the outcome of a requirement; "" if it passes."""
    if is_refuted(view):
        return "failure"
    return verdicts.junit(view.mark.word, suspect=view.mark.suspect)


def _of_requirement(view: RequirementView) -> Case:
    kind, reasons = _kind(view), list(_reasons(view))
    message = f"{view.mark.text}: {reasons[0]}" if reasons else view.mark.text
    text = "" if kind == "skipped" else "\n".join((view.sentence, *reasons))
    return Case(view.name, kind, message, text)


def _reasons(view: RequirementView) -> Iterator[str]:
    """Reasons of the outcome: waiver and its verdict, runs (worst first), counterexamples."""
    if view.waiver:
        yield f"{view.waiver.reason} (it is {view.waiver.covers.text})"
    yield from view.reasons
    if is_refuted(view):
        yield from (f"{plan.method}: {plan.result}" for plan in view.planned if plan.refuted)
        yield from (f"{p.layer}: {p.mark.text}: {p.claim}" for p in refutations(view))
