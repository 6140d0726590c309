"""`--junit`: a test case for each requirement, for a CI server.

Source: the JUnit schema of the Jenkins xUnit plugin, https://github.com/jenkinsci/xunit-plugin.
"""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree import ElementTree

from fretc.audit.evidence import verdicts
from fretc.audit.outputs.junit import as_text, counted, valid
from fretc.report.model.views import Report, RequirementView
from fretc.report.sections.proofs import is_refuted, refutations


def junit(report: Report) -> str:
    """One test suite; a case fails exactly where `--strict` would end with 1."""
    root = ElementTree.Element("testsuites", name="fretc report")
    withdrawn = {one.requirement: one.text for one in report.withdrawn}
    views = [view for view in report.requirements if view.id not in withdrawn]
    counts = counted([*map(_kind, views), *("failure" for _ in withdrawn)])
    name = valid(report.project)
    suite = ElementTree.SubElement(root, "testsuite", {"name": name, **counts})
    _accepted(suite, report)
    for view in views:
        _case(suite, view, name)
    for id, text in withdrawn.items():
        case = ElementTree.SubElement(suite, "testcase", name=valid(id), classname=name, time="0")
        ElementTree.SubElement(case, "failure", message=valid(f"withdrawn: {text}"))
    return as_text(root)


def _accepted(suite: ElementTree.Element, report: Report) -> None:
    """The warnings that the project accepts, each with its reason."""
    accepted = [remark for remark in report.remarks if remark.accepted]
    properties = ElementTree.SubElement(suite, "properties") if accepted else suite
    for one in accepted:
        name = valid(f"accepted {one.code}: {one.message}")
        ElementTree.SubElement(properties, "property", name=name, value=valid(one.accepted))


def _kind(view: RequirementView) -> str:
    """The element for it; empty: it passes."""
    if is_refuted(view):
        return "failure"
    return verdicts.junit(view.mark.word, suspect=view.mark.suspect)


def _case(suite: ElementTree.Element, view: RequirementView, project: str) -> None:
    case = ElementTree.SubElement(
        suite,
        "testcase",
        name=valid(f"{view.id} {view.title}".strip()),
        classname=project,
        time="0",
    )
    kind = _kind(view)
    if kind:
        reasons = list(_reasons(view))
        message = valid(f"{view.mark.text}: {reasons[0]}" if reasons else view.mark.text)
        outcome = ElementTree.SubElement(case, kind, message=message)
        if kind != "skipped":
            outcome.text = valid("\n".join((view.sentence, *reasons)))


def _reasons(view: RequirementView) -> Iterator[str]:
    """The waiver and the verdict behind it, the worst of the runs first, then counterexamples."""
    if view.waiver:
        yield f"{view.waiver.reason} (it is {view.waiver.covers.text})"
    yield from view.reasons
    if is_refuted(view):
        yield from (f"{plan.method}: {plan.result}" for plan in view.planned if plan.refuted)
        yield from (f"{p.layer}: {p.mark.text}: {p.claim}" for p in refutations(view))
