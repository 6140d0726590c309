"""Results as JUnit XML, for CI servers.

Source: the JUnit schema of the Jenkins xUnit plugin, https://github.com/jenkinsci/xunit-plugin.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from xml.etree import ElementTree

from fretc.audit.evidence import verdicts
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.result_summaries import audited_s
from fretc.audit.evidence.schema import Result
from fretc.audit.measurements.intervals import interval_words
from fretc.audit.outputs.totals import runs
from fretc.audit.outputs.violated_values import beliefs, values
from fretish.classes.frozen import dataclass
from fretish.documents import RequirementEntry

_NOT_XML = re.compile("[^\t\n\r\u0020-~\u00a0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass(frozen=True, slots=True)
class Case:
    """A test case; `kind` is the XML element of its outcome, "" if it passes."""

    name: str
    kind: str
    message: str = ""
    text: str = ""
    time: str = "0"
    """Its duration in seconds."""


@dataclass(frozen=True, slots=True)
class Suite:
    """The cases of one run, or of several together; `properties` are (name, value)."""

    name: str
    cases: Sequence[Case]
    properties: Sequence[tuple[str, str]] = ()


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
    names = {requirement.id: requirement.name for requirement in requirements}
    suites = [
        Suite(
            cases[0].run,
            [
                Case(
                    names.get(case.requirement, case.requirement),
                    verdicts.junit(case.verdict),
                    f"{case.verdict}: {case.reason}",
                    "\n".join(_lines(case)),
                    f"{audited_s(case) or 0.0:.3f}",
                )
                for case in cases
            ],
        )
        for cases in runs(results)
    ]
    of_all = [
        Case(
            names.get(one.requirement, one.requirement),
            verdicts.junit(one.answer),
            f"{one.answer}: {one.reason}",
            "\n".join(one.lines),
            "0.000",
        )
        for one in estimates
    ]
    return xml("fretc audit", [*suites, *([Suite("all runs", of_all)] if of_all else [])])


def _lines(case: Result) -> Iterator[str]:
    """A line for each interval of violation, with the values of its signals."""
    for broken in case.violations:
        stretch = interval_words(broken.first, broken.last, case.clock)
        yield f"{stretch}: {values(case, broken)}" if broken.values else stretch
        if broken.beliefs:
            yield beliefs(broken)


def xml(name: str, suites: Iterable[Suite]) -> str:
    """The text of the whole file, indented."""
    root = ElementTree.Element("testsuites", name=name)
    for suite in suites:
        kinds = [case.kind for case in suite.cases]
        words = {"failures": "failure", "errors": "error", "skipped": "skipped"}
        counts = {"tests": str(len(kinds)), **{n: str(kinds.count(k)) for n, k in words.items()}}
        node = _element(root, "testsuite", name=suite.name, **counts)
        properties = _element(node, "properties") if suite.properties else node
        for key, value in suite.properties:
            _element(properties, "property", name=key, value=value)
        for case in suite.cases:
            test = _element(node, "testcase", name=case.name, classname=suite.name, time=case.time)
            if case.kind:
                _element(test, case.kind, message=case.message).text = valid(case.text)
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _element(parent: ElementTree.Element, tag: str, **attributes: str) -> ElementTree.Element:
    texts = {name: valid(text) for name, text in attributes.items()}
    return ElementTree.SubElement(parent, tag, texts)


def valid(text: str) -> str:
    """The text without characters that XML cannot hold or that control a terminal."""
    return _NOT_XML.sub("\ufffd", text)
