"""Agents and properties as requirements: each sentence means its property, all else is reported."""

import tomllib
from pathlib import Path

import pytest

from compiler.agents import psl
from compiler.formalization.formalize import formalize
from compiler.project.fret_import import ImportResult
from compiler.targets.ajpf import properties
from compiler.targets.ajpf.agent_import import read_agents
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry, requirements
from tests.command import Fretc, write

AGENT = """\
GWENDOLEN
:name: sw

:Initial Beliefs:

:Initial Goals:

:Plans:
+near: {True} <-
    print("NEAR"),
    halt,
    +stopped;
"""


def texts(result: ImportResult) -> dict[str, str]:
    return {str(artifact.path): artifact.text for artifact in result.artifacts}


def entries(result: ImportResult) -> list[RequirementEntry]:
    found: list[RequirementEntry] = []
    for name, text in texts(result).items():
        if name.endswith(".fret"):
            some, mistakes = requirements(Source(name, text))
            assert mistakes == ()
            found += some
    return found


def sentences(result: ImportResult) -> list[str]:
    return [entry.wording.text for entry in entries(result)]


def reported(result: ImportResult) -> list[tuple[str, int, str]]:
    return [(d.code.number, d.span.line if d.span else 0, d.message) for d in result.diagnostics]


def of_property(text: str) -> ImportResult:
    return read_agents([Source("x/a.psl", f"# a comment\n1a: {text}\n")])


TAKEN = {
    "[] (B(sw,near) -> <> B(sw,stopped))": "whenever near sw shall eventually satisfy stopped",
    "[] (B(sw,near) -> B(sw,stopped))": "whenever near sw shall immediately satisfy stopped",
    "[] (~ B(sw,contact))": "sw shall never satisfy contact",
    "[] (B(sw,awake))": "sw shall always satisfy awake",
    "<> (B(sw,home))": "sw shall eventually satisfy home",
    "[] ((B(sw,a) & (~B(sw,b))) -> (<> (B(sw,c) || B(sw,d))))": (
        "whenever (a & !b) sw shall eventually satisfy (c | d)"
    ),
    "[] (B(sw,near) -> <> D(sw,halt))": "whenever near sw shall eventually satisfy halt",
}


@pytest.mark.parametrize("text", TAKEN)
def test_a_property_becomes_the_sentence_that_means_it(text: str) -> None:
    result = of_property(text)
    assert reported(result) == []
    assert sentences(result) == [TAKEN[text]]
    (entry,) = entries(result)
    assert (entry.id, entry.status) == ("1a", "draft")
    assert entry.rationale == "the property on line 2 of a.psl"
    declared, _ = read_bindings(Source("b.toml", texts(result).get("bindings.toml", "")))
    requirement, _ = formalize(entry, declared)
    assert requirement is not None
    again = psl.read(Source("b.psl", properties.text(requirement)))
    first = psl.read(Source("a.psl", f"1a: {text}"))
    assert not isinstance(again, Diagnostic)
    assert not isinstance(first, Diagnostic)
    assert again[0].formula == first[0].formula


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("<> ([] (B(sw,home)))", "no sentence of FRETish has this form"),
        ("B(sw,a) U B(sw,b)", "no sentence of FRETish has this form"),
        ("[] (B(sw,a) -> ([] (B(sw,b))))", "no sentence of FRETish has this form"),
        ("[] (B(sw,a) -> <> B(ag,b))", "it is about several agents"),
        ("[] (B(sw,at(3)) -> <> B(sw,b))", "`B(sw,at(3))` has arguments"),
        ("[] (B(sw,a) -> <> D(sw,a))", "`a` has two modalities"),
    ],
)
def test_a_property_without_a_sentence_is_reported_with_its_line(text: str, why: str) -> None:
    result = of_property(text)
    assert reported(result) == [("F917", 2, f"the property `1a` is not imported: {why}")]
    assert result.artifacts == ()


def test_a_plan_becomes_a_draft_and_its_action_a_binding() -> None:
    result = read_agents([Source("agent.gwen", AGENT)])
    assert sentences(result) == ["whenever near sw shall eventually satisfy stopped"]
    assert tomllib.loads(texts(result)["bindings.toml"]) == {
        "variable": {"stopped": {"action": "halt"}}
    }
    ((code, line, message),) = reported(result)
    assert (code, line) == ("F917", 10)
    assert message.startswith("`print('NEAR')` is not imported: ")


@pytest.mark.parametrize(
    ("plan", "sentence", "missing"),
    [
        (
            "+a: {B b, ~B c, ~B r} <- go, +r;",
            "whenever a & b & !c sw shall eventually satisfy r",
            [],
        ),
        ("+a: {True} <- go, +r, turn, +q;", "whenever a sw shall eventually satisfy r & q", []),
        ("+a: {True} <- go, turn, +r;", "whenever a sw shall eventually satisfy r", ["`go`"]),
        ("+a: {True} <- +r, go;", "whenever a sw shall eventually satisfy r", ["`go`"]),
        ("+a: {True} <- move(3), +r;", "whenever a sw shall eventually satisfy r", ["`move(3)`"]),
        ("-a: {True} <- undo_r, -r;", "", ["`-r`", "`undo_r`", "the plan for `-a`"]),
        ("+at(3): {True} <- go, +r;", "", ["the plan for `+at(3)`"]),
    ],
)
def test_what_of_a_plan_is_taken(plan: str, sentence: str, missing: list[str]) -> None:
    text = AGENT[: AGENT.index("+near")] + plan + "\n"
    result = read_agents([Source("agent.gwen", text)])
    assert sentences(result) == ([sentence] if sentence else [])
    assert [code for code, _, _ in reported(result)] == ["F917"] * len(missing)
    assert [text.partition(" is not")[0] for _, _, text in reported(result)] == missing


def test_agent_and_properties_are_one_project(fretc: Fretc) -> None:
    """The published property names an action; the sentence of the plan is the one of the paper."""
    write("a.gwen", AGENT)
    write(
        "a.psl", "1a: [] (B(sw,halt) -> <> B(sw,stopped))\n1b: [] (B(sw,near) -> <> B(sw,stopped))"
    )
    run = fretc("import", "a.gwen", "a.psl", "-o", "out")
    assert run.status == 0
    assert "F918 warning: `halt` is an action of the agent, and the property on line 1" in run.err
    assert "imported 2 requirements, 1 variables" in run.err
    assert Path("out/a.fret").read_text().count("+++") == 4
    assert fretc("out", "--emit", "ajpf", "-o", "psl").status == 0
    assert fretc("import", "a.gwen", "export.json", "-o", "more").status == 2


def test_what_mcapl_would_misread_is_an_error(fretc: Fretc) -> None:
    write("a.gwen", AGENT.replace("{True}", "{}"))
    run = fretc("import", "a.gwen", "-o", "out")
    assert run.status == 2
    assert "F610" in run.err
