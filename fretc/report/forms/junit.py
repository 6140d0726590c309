"""`--junit`: a suite for each run with a test case for each requirement, for CI servers.

A first suite, named after the project, has cases without a single run: requirements that were not
audited, probabilities, counterexamples, and withdrawn requirements.

Source: the JUnit schema of the Jenkins xUnit plugin, https://github.com/jenkinsci/xunit-plugin.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

from fretc.audit.evidence import verdicts
from fretc.audit.evidence.verdicts import RETIRED, WAIVED
from fretc.audit.outputs.junit import as_text, counted, valid
from fretc.report.model.views import Report, RequirementView, ResultRow
from fretc.report.sections.proofs import is_refuted, refutations


@dataclass(frozen=True, slots=True)
class _Case:
    """A test case; `kind` is the XML element of its outcome, "" if it passes."""

    name: str
    kind: str
    message: str = ""
    text: str = ""


def junit(report: Report) -> str:
    """The JUnit XML; a case is a failure or an error if `--strict` would exit with 1."""
    root = ElementTree.Element("testsuites", name="fretc report")
    withdrawn = {withdrawal.requirement for withdrawal in report.withdrawn}
    views = [view for view in report.requirements if view.id not in withdrawn]
    of_project = [_of_requirement(view) for view in views if _needs_own_case(view)]
    of_project += [
        _Case(withdrawal.requirement, "failure", f"withdrawn: {withdrawal.text}")
        for withdrawal in report.withdrawn
    ]
    suite = _suite(root, report.project, of_project)
    _accepted(suite, report)
    _cases(suite, report.project, of_project)
    for run, cases in _by_run(views).items():
        _cases(_suite(root, run, cases), run, cases)
    return as_text(root)


def _by_run(views: Sequence[RequirementView]) -> dict[str, list[_Case]]:
    """Name of a run → its cases; runs of the same file are distinguished by their labels."""
    files = {result.run: result for view in views for result in view.results}
    names = Counter(result.run_file for result in files.values())
    cases: dict[str, list[_Case]] = {}
    for view in views:
        for result in view.results:
            again = names[result.run_file] > 1
            run = f"{result.run_file} ({result.run_label})" if again else result.run_file
            cases.setdefault(run, []).append(_of_run(view, result))
    return cases


def _of_run(view: RequirementView, result: ResultRow) -> _Case:
    kind = _kind_of_run(view, result)
    if not kind:
        return _Case(view.name, "")
    why = "; ".join((result.reason, *result.suspicions))
    waived = f"{view.mark.text}, {view.waiver.reason}: " if view.waiver and _is_waived(view) else ""
    return _Case(view.name, kind, f"{waived}{result.mark.text}: {why}", view.sentence)


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


def _of_requirement(view: RequirementView) -> _Case:
    kind, reasons = _kind(view), list(_reasons(view))
    message = f"{view.mark.text}: {reasons[0]}" if reasons else view.mark.text
    return _Case(view.name, kind, message, "\n".join((view.sentence, *reasons)))


def _reasons(view: RequirementView) -> Iterator[str]:
    """Reasons of the outcome: waiver and its verdict, runs (worst first), counterexamples."""
    if view.waiver:
        yield f"{view.waiver.reason} (it is {view.waiver.covers.text})"
    yield from view.reasons
    if is_refuted(view):
        yield from (f"{plan.method}: {plan.result}" for plan in view.planned if plan.refuted)
        yield from (f"{p.layer}: {p.mark.text}: {p.claim}" for p in refutations(view))


# XML -------------------------------------------------------------------------------------------


def _suite(root: ElementTree.Element, name: str, cases: Sequence[_Case]) -> ElementTree.Element:
    counts = counted([case.kind for case in cases])
    return ElementTree.SubElement(root, "testsuite", {"name": valid(name), **counts})


def _accepted(suite: ElementTree.Element, report: Report) -> None:
    """Add the accepted warnings, each with its reason."""
    accepted = [remark for remark in report.remarks if remark.accepted]
    properties = ElementTree.SubElement(suite, "properties") if accepted else suite
    for remark in accepted:
        name = valid(f"accepted {remark.code}: {remark.message}")
        ElementTree.SubElement(properties, "property", name=name, value=valid(remark.accepted))


def _cases(suite: ElementTree.Element, classname: str, cases: Sequence[_Case]) -> None:
    for case in cases:
        names = {"name": valid(case.name), "classname": valid(classname), "time": "0"}
        node = ElementTree.SubElement(suite, "testcase", names)
        if case.kind:
            outcome = ElementTree.SubElement(node, case.kind, message=valid(case.message))
            if case.kind != "skipped":
                outcome.text = valid(case.text)
