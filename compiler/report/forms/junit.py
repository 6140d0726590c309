"""`--junit`: a test case for each requirement, for a CI server.

Source: the JUnit schema of the Jenkins xUnit plugin, https://github.com/jenkinsci/xunit-plugin.
"""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree

from compiler.odds import REFUTED
from compiler.outputs import as_text, counted, valid
from compiler.report.claims import (
    NOT_EXERCISED,
    RETIRED,
    SUSPECT,
    UNFORMALIZED,
    WAIVED,
)
from compiler.report.views import Report, RequirementView
from monitors import kernel

_KINDS: Mapping[str, str] = {
    kernel.VIOLATED: "failure",
    REFUTED: "failure",
    UNFORMALIZED: "error",
    kernel.NO_DATA: "error",
    SUSPECT: "skipped",
    kernel.INCONCLUSIVE: "skipped",
    kernel.VACUOUS: "skipped",
    NOT_EXERCISED: "skipped",
    WAIVED: "skipped",
    RETIRED: "skipped",
}
"""What JUnit has for a verdict; nothing for one that shows the requirement."""


def junit(report: Report, *, strict: bool) -> str:
    """One test suite.

    Args:
        report: what it says.
        strict: whether a suspect requirement is a failure.
    """
    kinds = {**_KINDS, SUSPECT: "failure"} if strict else _KINDS
    root = ElementTree.Element("testsuites", name="fretc report")
    gone = {one.requirement: one.text for one in report.withdrawn}
    views = [view for view in report.requirements if view.id not in gone]
    known = [(view, kinds.get(view.mark.word)) for view in views]
    counts = counted([*(kind for _, kind in known), *(kinds[SUSPECT] for _ in gone)])
    name = valid(report.project)
    suite = ElementTree.SubElement(root, "testsuite", {"name": name, **counts})
    for view, kind in known:
        _case(suite, view, kind, name)
    for id, text in gone.items():
        case = ElementTree.SubElement(suite, "testcase", name=valid(id), classname=name, time="0")
        ElementTree.SubElement(case, kinds[SUSPECT], message=valid(f"withdrawn: {text}"))
    return as_text(root)


def _case(
    suite: ElementTree.Element, view: RequirementView, kind: str | None, project: str
) -> None:
    case = ElementTree.SubElement(
        suite,
        "testcase",
        name=valid(f"{view.id} {view.title}".strip()),
        classname=project,
        time="0",
    )
    if kind is not None:
        waiver = view.waiver
        excused = [f"{waiver.reason} (it is {waiver.covers.word})"] if waiver else []
        reasons = [*excused, *view.reasons]
        message = valid(f"{view.mark.word}: {reasons[0]}" if reasons else view.mark.word)
        told = ElementTree.SubElement(case, kind, message=message)
        if kind != "skipped":
            told.text = valid("\n".join((view.sentence, *view.reasons)))
