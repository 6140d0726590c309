"""Results as JUnit XML."""

import unicodedata
from typing import Any
from xml.etree import ElementTree

from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.evidence.declared_units import without_samples
from fretc.audit.evidence.schema import Result
from fretc.audit.outputs.junit import junit
from tests.fretc.audit import results
from tests.fretc.logs.logs import declare
from tests.fretc.report.junit_schema import MAY, complaints


def result(verdict: str, run: str = "a.mcap", id: str = "R1", **more: Any) -> Result:
    times = {"start_ns": 10**9, "end_ns": 3 * 10**9, **more}
    return results.result(
        run=run, requirement=id, verdict=verdict, units={"x": "m/s", "y": ""}, **times
    )


ALL = [
    result("satisfied"),
    result("violated", id="R2"),
    result("inconclusive", id="R3"),
    result("vacuous", id="R4"),
    result("no data", id="R5", start_ns=None, end_ns=None),
    result("satisfied", run="b.mcap"),
]


def test_each_run_is_a_suite_and_each_requirement_a_case() -> None:
    root = ElementTree.fromstring(junit(ALL))
    first, second = root
    assert (first.get("name"), second.get("name")) == ("a.mcap", "b.mcap")
    counts = [first.get(name) for name in ("tests", "failures", "errors", "skipped")]
    assert counts == ["5", "1", "1", "2"]
    kinds = [[child.tag for child in case] for case in first]
    assert kinds == [[], ["failure"], ["skipped"], ["skipped"], ["error"]]
    assert [case.get("time") for case in first] == ["2.000"] * 4 + ["0.000"]
    assert first[1][0].get("message") == "violated: why"


def test_the_elements_are_those_of_the_schema_that_jenkins_has() -> None:
    broken = {"start_s": 1.5, "end_s": 2.0, "values": {"x": 0.25}}
    root = ElementTree.fromstring(junit([*ALL, result("violated", violations=[broken])]))
    assert list(complaints(root)) == []
    assert {element.tag for element in root.iter()} == set(MAY)


def test_a_violation_is_told_with_its_time_and_its_values() -> None:
    broken = {"start_s": 1.5, "end_s": 2.0, "values": {"x": 0.25, "y": None}}
    root = ElementTree.fromstring(junit([result("violated", violations=[broken])]))
    assert root[0][0][0].text == "at the message at 1.5 s: x = 0.25 m/s, y = unknown"


def test_values_are_in_the_units_that_the_bindings_declare() -> None:
    bindings = '[signal.x]\npath = "/a.x"\nunit = "km/h"\n[signal.y]\npath = "/a.y"\n'
    bound = declare(f'[clock]\ntick = "1 s"\n{bindings}')
    broken = {"start_s": 1.5, "end_s": 2.0, "values": {"x": 5 / 3.6, "y": 2.0}}
    near = [{"signal": "abs(y)", "bound": 2.0000001}]
    case = result("violated", violations=[broken], thresholds=near)
    text = junit(without_samples([case], bound))
    assert (
        ElementTree.fromstring(text)[0][0][0].text == "at the message at 1.5 s: x = 5 km/h, y = 2"
    )


@given(st.text())
def test_any_text_gives_xml_that_can_be_read(text: str) -> None:
    xml = junit([result("violated", run=text, reason=text, id=text)])
    assert len(ElementTree.fromstring(xml)[0]) == 1
    assert not {c for c in xml if unicodedata.category(c) == "Cc"} - {"\n", "\t", "\r"}
