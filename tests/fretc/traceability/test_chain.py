from collections.abc import Mapping
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.project.project import Project
from fretc.audit.evidence import reader as reading
from fretc.audit.evidence.result_summaries import ResultSummaries
from fretc.traceability.chain import Chain, ChainItem, Link
from fretc.traceability.chain_builder import chains
from fretc.traceability.suspects import suspects
from fretish.diagnostics.diagnostic import Diagnostic
from tests.fretc.report import cases

R1 = """\
+++
id = "R1"
title = "Stop"
parents = ["HAZ-1"]
params = { near = "5 cm" }
status = "approved"
+++
whenever near the robot shall within 300 milliseconds satisfy stopped
"""


def chain(project: Project, *results: Mapping[str, Any]) -> Chain:
    audited = reading.read(cases.write_evidence(project, Path(), *results))
    assert not isinstance(audited, Diagnostic), audited
    (only,) = chains(project, ResultSummaries.of(audited))
    return only


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def read(
    folder: Path, text: str = R1, bindings: str = cases.BINDINGS, hazards: str = cases.HAZARDS
) -> Chain:
    project = cases.project(folder / "requirements", text, bindings=bindings, hazards=hazards)
    return chain(project, cases.result(project, "satisfied"))


def pairs(before: Chain, after: Chain) -> set[tuple[str, str]]:
    links = suspects(after, before.prints)
    return {(str(s.link.source), str(s.link.target)) for s in links}


RUN = "verdict:R1 logs/a.mcap"
LAST = {(RUN, "review:R1")}


def test_the_chain_leads_from_the_hazard_to_the_review(folder: Path) -> None:
    links = {f"{link.source} {link.target}" for link in read(folder).links}
    assert {
        "hazard:HAZ-1 text:R1",
        "text:R1 sentence:R1",
        "sentence:R1 formulas:R1",
        "clock:clock formulas:R1",
        "formulas:R1 artefact:r1_monitor.py",
        f"artefact:r1_monitor.py {RUN}",
        f"bindings:R1 {RUN}",
        f"params:R1 {RUN}",
        f"clock:clock {RUN}",
        f"log:logs/a.mcap {RUN}",
        f"{RUN} review:R1",
    } <= links


@pytest.mark.parametrize(
    "text",
    [
        R1.replace("within 300 milliseconds", "within   300\n    milliseconds"),
        R1.replace('"Stop"', '"Stop"   # a comment'),
        f"\n\n{R1}",
        R1.replace('title = "Stop"\nparents = ["HAZ-1"]', 'parents = [ "HAZ-1" ]\ntitle = "Stop"'),
    ],
)
def test_white_space_order_and_comments_change_nothing(folder: Path, text: str) -> None:
    assert pairs(read(folder), read(folder, text)) == set()


def test_white_space_in_an_expression_changes_nothing(folder: Path) -> None:
    spaced = cases.BINDINGS.replace("clearance < 5 cm", "clearance  <\\t5 cm ")
    assert pairs(read(folder), read(folder, bindings=spaced)) == set()


def test_another_hazard_makes_everything_below_it_suspect(folder: Path) -> None:
    before = read(folder)
    after = read(folder, hazards=cases.HAZARDS.replace("A drum", "A wall"))
    links = pairs(before, after)
    assert ("hazard:HAZ-1", "text:R1") in links
    assert ("text:R1", "sentence:R1") in links
    assert ("log:logs/a.mcap", RUN) not in links
    assert ("bindings:R1", RUN) not in links


def test_another_threshold_makes_the_verdicts_suspect_and_no_formula(folder: Path) -> None:
    before = read(folder)
    after = read(folder, bindings=cases.BINDINGS.replace("clearance < 5 cm", "clearance < 90 cm"))
    assert pairs(before, after) == {("bindings:R1", RUN)} | LAST


def test_a_binding_that_the_requirement_does_not_use_changes_nothing(folder: Path) -> None:
    more = f'{cases.BINDINGS}\n[proposition.slow]\nexpr = "vx < 0.1 m/s"\n'
    assert pairs(read(folder), read(folder, bindings=more)) == set()


def test_another_parameter_makes_the_verdicts_suspect(folder: Path) -> None:
    after = read(folder, R1.replace('"5 cm"', '"6 cm"'))
    assert pairs(read(folder), after) == {("params:R1", RUN)} | LAST


def test_another_log_makes_its_verdict_suspect(folder: Path) -> None:
    project = cases.project(folder / "requirements", R1)
    before = chain(project, cases.result(project, "satisfied"))
    other = cases.result(project, "satisfied")
    other["hashes"] = {**other["hashes"], "log": "cd" * 32}
    assert pairs(before, chain(project, other)) == {("log:logs/a.mcap", RUN)} | LAST


def test_another_sentence_makes_formulas_and_artefacts_suspect_and_names_the_cause(
    folder: Path,
) -> None:
    before = read(folder)
    after = read(folder, R1.replace("300", "400"))
    links = {(str(s.link.source), str(s.link.target)): s for s in suspects(after, before.prints)}
    assert ("sentence:R1", "formulas:R1") in links
    assert ("formulas:R1", "artefact:r1_monitor.py") in links
    assert ("hazard:HAZ-1", "text:R1") not in links
    assert ("text:R1", "sentence:R1") not in links
    causes = links["artefact:r1_monitor.py", RUN].causes
    assert list(map(str, causes)) == ["sentence:R1"], "what follows from it is no cause of its own"


def test_a_run_that_is_gone_makes_the_review_suspect(folder: Path) -> None:
    project = cases.project(folder / "requirements", R1)
    before = chain(project, cases.result(project, "satisfied"))
    links = pairs(before, chain(project))
    assert (RUN, "review:R1") in links
    assert ("log:logs/a.mcap", "review:R1") in links


def test_requirements_that_name_each_other_as_parents_have_a_chain(folder: Path) -> None:
    texts = [
        cases.requirement(id, "the robot shall always satisfy stopped", parents=[other])
        for id, other in (("A", "B"), ("B", "A"))
    ]
    both = chains(cases.project(folder, *texts), None)
    assert [c.requirement for c in both] == ["A", "B"]
    assert suspects(both[0], both[0].prints) == ()


# Against reachability, written down directly ---------------------------------------------------

NODES = [ChainItem("text", str(i)) for i in range(7)]


@given(st.sets(st.sampled_from([*combinations(range(7), 2)])), st.sets(st.integers(0, 6)))
def test_a_link_is_suspect_exactly_if_a_change_reaches_its_source(
    edges: set[tuple[int, int]], wrong: set[int]
) -> None:
    links = tuple(Link(NODES[a], NODES[b]) for a, b in sorted(edges))
    prints = dict.fromkeys(NODES, "now")
    locked = {node: "then" if i in wrong else "now" for i, node in enumerate(NODES)}
    reached = set(wrong)
    for _ in NODES:
        reached |= {b for a, b in edges if a in reached}
    suspect_links = suspects(Chain("R1", prints, links), locked)
    assert {s.link for s in suspect_links} == {ln for ln in links if int(ln.source.name) in reached}
    assert len({s.link for s in suspect_links}) == len(suspect_links)
    for suspect in suspect_links:
        assert suspect.causes
        assert {int(cause.name) for cause in suspect.causes} <= wrong
