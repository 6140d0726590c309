"""Results of an audit for other tools: JUnit XML, and annotations of GitHub Actions.

Sources: the JUnit schema of the Jenkins xUnit plugin, https://github.com/jenkinsci/xunit-plugin;
GitHub, Workflow commands for GitHub Actions.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from xml.etree import ElementTree

from fretc.audit.evidence import verdicts
from fretc.audit.evidence.probabilities import AVERAGE, Estimated
from fretc.audit.evidence.result_summaries import audited_s
from fretc.audit.evidence.schema import Result
from fretc.audit.evidence.verdicts import Level
from fretc.audit.outputs.totals import runs
from fretc.audit.outputs.violated_values import reason, values
from fretish.bindings.amounts import seconds
from fretish.diagnostics.rendering import visible
from fretish.diagnostics.source import Span
from fretish.documents import RequirementEntry

_NOT_XML = re.compile("[^\t\n\r\u0020-~\u00a0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_GITHUB = {Level.ERROR: "error", Level.WARNING: "warning", Level.NONE: "notice"}


def junit(
    results: Iterable[Result],
    estimates: Sequence[Estimated] = (),
    requirements: Sequence[RequirementEntry] = (),
) -> str:
    """One test suite for each run, one test case for each requirement.

    Args:
        results: one for each run and requirement, in declared units.
        estimates: the answers of all runs, which form a suite of their own.
        requirements: the requirements, for the titles of the cases.
    """
    root = ElementTree.Element("testsuites", name="fretc audit")
    names = {requirement.id: requirement.name for requirement in requirements}
    for cases in runs(results):
        run = cases[0].run
        counts = counted([verdicts.junit(case.verdict) for case in cases])
        suite = ElementTree.SubElement(root, "testsuite", {"name": valid(run), **counts})
        for case in cases:
            _case(suite, run, case, names)
    if estimates:
        _suite_of_all(root, estimates, names)
    return as_text(root)


def as_text(root: ElementTree.Element) -> str:
    """The text of the whole file, indented."""
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def counted(kinds: Sequence[str]) -> dict[str, str]:
    """The attributes of a test suite with cases of these kinds; an empty kind: passed."""
    names = {"failures": "failure", "errors": "error", "skipped": "skipped"}
    return {"tests": str(len(kinds))} | {n: str(kinds.count(k)) for n, k in names.items()}


def _suite_of_all(
    root: ElementTree.Element, estimates: Sequence[Estimated], titled: Mapping[str, str]
) -> None:
    counts = counted([verdicts.junit(estimate.answer) for estimate in estimates])
    suite = ElementTree.SubElement(root, "testsuite", {"name": "all runs", **counts})
    for one in estimates:
        name = valid(titled.get(one.requirement, one.requirement))
        names = {"name": name, "classname": "all runs", "time": "0.000"}
        node = ElementTree.SubElement(suite, "testcase", names)
        _add_failure(node, one.answer, one.reason, one.lines)


def _case(suite: ElementTree.Element, run: str, case: Result, titled: Mapping[str, str]) -> None:
    node = ElementTree.SubElement(
        suite,
        "testcase",
        name=valid(titled.get(case.requirement, case.requirement)),
        classname=valid(run),
        time=f"{audited_s(case) or 0.0:.3f}",
    )
    _add_failure(node, case.verdict, case.reason, _lines(case))


def _add_failure(
    node: ElementTree.Element, verdict: str, reason: str, lines: Iterable[str]
) -> None:
    """Say why a test case has not passed, if it has not."""
    kind = verdicts.junit(verdict)
    if kind:
        element = ElementTree.SubElement(node, kind, message=valid(f"{verdict}: {reason}"))
        element.text = valid("\n".join(lines))


def _lines(case: Result) -> Iterator[str]:
    """A line for each interval of violation, with the values of its signals."""
    for broken in case.violations:
        stretch = f"{seconds(broken.start_s)} to {seconds(broken.end_s)}"
        yield f"{stretch}: {values(case, broken)}" if broken.values else stretch


def valid(text: str) -> str:
    """The text without characters that XML cannot hold or that control a terminal."""
    return _NOT_XML.sub("\ufffd", text)


def github(
    results: Iterable[Result],
    requirements: Sequence[RequirementEntry],
    estimates: Sequence[Estimated] = (),
) -> str:
    """A line for each result, at the sentence of its requirement.

    A run that only contributes to an estimate (`trials`) gives a notice: the answer of all runs
    follows.

    Args:
        results: one for each run and requirement, in declared units.
        requirements: the requirements of the results.
        estimates: the answers of all runs.
    """
    places = {requirement.id: requirement.wording for requirement in requirements}
    names = {requirement.id: requirement.name for requirement in requirements}
    lines = []
    for result in results:
        level = "notice" if result.trials is not None else _GITHUB[verdicts.level(result.verdict)]
        title = f"{names[result.requirement]} {result.verdict}"
        message = f"{result.run}: {reason(result)}"
        lines.append(_annotation(level, places[result.requirement], title, message))
    for estimate in estimates:
        level, title = (
            _GITHUB[verdicts.level(estimate.answer)],
            f"{names[estimate.requirement]} {estimate.answer}",
        )
        message = f"all runs: {estimate.reason}; {estimate.lines[1]}; {AVERAGE}"
        lines.append(_annotation(level, places[estimate.requirement], title, message))
    return "".join(lines)


def _annotation(level: str, place: Span, title: str, message: str) -> str:
    where = f"file={_property(place.source.name)},line={place.line},title={_property(title)}"
    return f"::{level} {where}::{_data(message)}\n"


def _data(text: str) -> str:
    return visible(text).replace("%", "%25")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
