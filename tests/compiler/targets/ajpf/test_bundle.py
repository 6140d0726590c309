"""Bundles for AJPF: what is in them, and for which requirements there are none."""

import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from compiler.agents import gwendolen, psl
from compiler.agents.checking import agent_evidence
from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.ajpf.bundle import TARGET, emit, refusal
from compiler.targets.target import DEFAULT, TargetOptions
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from tests.bound_requirements import bound_requirement
from tests.command import Fretc
from tests.programs import installed, needs

ROOT = Path(__file__).parents[4]
requirement = bound_requirement
R1 = "whenever too_close agilex_agent shall eventually satisfy stopped"
WEAKEN = TargetOptions(weaken=True)


def bundle(made: FormalizedRequirement, options: TargetOptions = DEFAULT) -> dict[str, str]:
    diagnostic = refusal(made, options)
    assert diagnostic is None, render(diagnostic)
    return {str(artifact.path): artifact.text for artifact in emit([made], options)}


def plans(files: dict[str, str], name: str = "SIF.gwen") -> list[str]:
    (text,) = (text for path, text in files.items() if path.endswith(f"/{name}"))
    return text.partition(":Plans:")[2].split("\n")[2:-1]


def refused(sentence: str, bindings: str | None = None) -> Diagnostic:
    diagnostic = refusal(requirement(sentence, bindings=bindings))
    assert diagnostic is not None
    assert diagnostic.help
    return diagnostic


# The paper's requirement ------------------------------------------------------------------------


def test_the_bundle_of_the_papers_requirement(golden: Callable[[str, str], None]) -> None:
    bindings = (ROOT / "requirements/bindings.toml").read_text(encoding="utf-8")
    files = bundle(requirement(R1, bindings=bindings))
    assert sorted(files) == [
        f"r1_ajpf/{name}"
        for name in (
            *("Env.java", "R1.jpf", "R1_mutant.jpf", "R1_reach.jpf", "R1_resp.jpf", "README.md"),
            *("SIF.ail", "SIF.gwen", "SIF.psl", "SIF_mutant.ail", "SIF_mutant.gwen"),
            *("manifest.json", "run.py"),
        )
    ]
    for path, text in files.items():
        assert text.isascii()
        if not path.endswith(("run.py", "manifest.json")):
            golden(f"ajpf-bundle/{path}", text)
    manifest = json.loads(files["r1_ajpf/manifest.json"])
    digests = manifest.pop("files")
    golden("ajpf-bundle/r1_ajpf/manifest.json", f"{json.dumps(manifest, indent=1)}\n")
    assert digests == {
        path.partition("/")[2]: sha256(text)
        for path, text in files.items()
        if not path.endswith("manifest.json")
    }


def test_what_is_emitted_is_what_the_paper_lists_apart_from_its_environment() -> None:
    files = bundle(requirement(R1))
    agent = gwendolen.read(Source("SIF.gwen", files["r1_ajpf/SIF.gwen"]))
    assert not isinstance(agent, Diagnostic)
    assert agent.name == "agilex_agent"
    assert str(agent.plans[0].event) == "+too_close"
    assert str(agent.plans[0].deeds[-1]) == "+stopped"
    properties = psl.read(Source("SIF.psl", files["r1_ajpf/SIF.psl"]))
    listed = psl.read(
        Source("p", "R1: [] (B(agilex_agent,too_close) -> <> B(agilex_agent,stopped))")
    )
    assert not isinstance(properties, Diagnostic)
    assert not isinstance(listed, Diagnostic)
    assert properties[0].formula == listed[0].formula
    assert re.findall(r'^ +"(\w+)",', files["r1_ajpf/Env.java"], re.MULTILINE) == ["too_close"]


def test_the_layer_shows_what_the_manifest_expects() -> None:
    made = requirement(R1)
    files = {path.partition("/")[2]: text for path, text in bundle(made).items()}
    found = agent_evidence(made, files, ["too_close"])
    assert [(line.requirement, line.result) for line in found] == [("R1", "proved")] * 4
    vacuous = agent_evidence(made, files, ["stopped"])
    assert vacuous[0].result == "vacuous"
    broken = {**files, "SIF.gwen": files["SIF_mutant.gwen"]}
    assert agent_evidence(made, broken, ["too_close"])[0].result == "counterexample"
    misread = {**files, "SIF.gwen": files["SIF.gwen"].replace("{True}", "{}")}
    (line,) = agent_evidence(made, misread, ["too_close"])
    assert line.result == "not checked"
    same = {**files, "SIF_mutant.gwen": files["SIF.gwen"]}
    assert agent_evidence(made, same, ["too_close"])[1].result == "vacuous"


# Other requirements -----------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sentence", "agent", "mutant"),
    [
        (
            "upon a the ag shall eventually satisfy r",
            ["+a : {True} <- do_r, +r;", "-a : {True} <- undo_r, -r;"],
            ["+a : {True} <- do_r;", "-a : {True} <- undo_r, -r;"],
        ),
        (
            "whenever a & !b the ag shall satisfy r",
            ["+a : {~B r} <- do_r, +r;", "-b : {~B r} <- do_r, +r;"],
            ["+a : {~B r} <- do_r;", "-b : {~B r} <- do_r;"],
        ),
        (
            "whenever a & b the ag shall satisfy r",
            ["+a : {B b, ~B r} <- do_r, +r;", "+b : {B a, ~B r} <- do_r, +r;"],
            ["+a : {B b, ~B r} <- do_r;", "+b : {B a, ~B r} <- do_r;"],
        ),
        (
            "whenever a | b the ag shall satisfy r",
            ["+a : {~B r} <- do_r, +r;", "+b : {~B r} <- do_r, +r;"],
            ["+a : {~B r} <- do_r;", "+b : {~B r} <- do_r;"],
        ),
        (
            "whenever a the ag shall satisfy r & q",
            ["+a : {~B q} <- do_r, +r, do_q, +q;"],
            ["+a : {~B q} <- do_r, do_q;"],
        ),
    ],
)
def test_a_plan_for_each_event_that_can_make_the_condition_true(
    sentence: str, agent: list[str], mutant: list[str]
) -> None:
    files = bundle(requirement(sentence))
    assert plans(files) == agent
    assert plans(files, "SIF_mutant.gwen") == mutant


@pytest.mark.slow
def test_an_agent_that_responds_too_often_says_so() -> None:
    made = requirement("whenever a & !b the ag shall eventually satisfy r")
    assert TARGET.remark is not None
    diagnostic = TARGET.remark(made)
    assert diagnostic is not None
    assert diagnostic.code is Code.OVER_RESPONDS
    assert not diagnostic.is_error
    files = bundle(made)
    assert json.loads(files["r1_ajpf/manifest.json"])["over_responds"]
    assert "// It responds to every event" in files["r1_ajpf/SIF.gwen"]
    for sentence in ("whenever a & b the ag shall satisfy r", "whenever a the ag shall satisfy r"):
        assert TARGET.remark(requirement(sentence)) is None
        files = bundle(requirement(sentence))
        assert not json.loads(files["r1_ajpf/manifest.json"])["over_responds"]
        assert "// It responds to every event" not in files["r1_ajpf/SIF.gwen"]


def test_where_neither_form_is_shown_to_keep_it_there_is_none() -> None:
    diagnostic = refused("whenever a & !b the ag shall always satisfy r")
    assert diagnostic.code is Code.NOT_KEPT


def test_a_response_that_is_an_action_is_that_action() -> None:
    modality = '[variable.halt]\nmodality = "D"\n'
    files = bundle(requirement("whenever a the ag shall satisfy halt", bindings=modality))
    assert plans(files) == ["+a : {True} <- halt;"]
    assert plans(files, "SIF_mutant.gwen") == ["+a : {True};"]
    assert "D(ag,halt)" in files["r1_ajpf/SIF.psl"]


@pytest.mark.slow
def test_the_mode_of_a_scope_is_drawn_too() -> None:
    files = bundle(requirement("after m mode whenever a the ag shall eventually satisfy r"))
    manifest = json.loads(files["r1_ajpf/manifest.json"])
    assert manifest["percepts"] == ["m", "a"]
    assert manifest["responses"] == ["r"]


def test_a_deadline_is_lost_only_where_that_is_asked_for() -> None:
    sentence = "whenever a the ag shall within 3 ticks satisfy r"
    assert refused(sentence).code is Code.NOT_EXPRESSIBLE
    assert TARGET.weak is not None
    assert TARGET.weak.refuse(requirement(sentence)) is None
    manifest = json.loads(bundle(requirement(sentence), WEAKEN)["r1_ajpf/manifest.json"])
    assert manifest["weakened"].startswith("`within 3 ticks` has lost its bound")
    assert json.loads(bundle(requirement(R1))["r1_ajpf/manifest.json"])["weakened"] is None


@pytest.mark.parametrize(
    ("sentence", "what"),
    [
        ("the ag shall eventually satisfy r", "a sentence without a condition"),
        ("whenever !a the ag shall satisfy r", "a condition that only negates"),
        ("whenever (a & b) | !c the ag shall satisfy r", "a condition that only negates"),
        ("whenever a xor b the ag shall satisfy r", "the shape of the condition"),
        ("whenever a the ag shall satisfy r | q", "the shape of the response"),
        ("whenever a the ag shall satisfy !r", "the shape of the response"),
        ("whenever a & r the ag shall satisfy r", "`r` as trigger and response"),
    ],
)
def test_what_no_agent_is_made_of_is_refused(sentence: str, what: str) -> None:
    diagnostic = refused(sentence)
    assert diagnostic.code is Code.NOT_EXPRESSIBLE
    assert diagnostic.message == f"an agent cannot express {what} of R1"


def test_what_ajpf_cannot_say_is_refused_first() -> None:
    diagnostic = refused("whenever a the ag shall at the next timepoint satisfy r")
    assert diagnostic.message.startswith("AJPF cannot express")


@pytest.mark.parametrize(
    ("bindings", "what"),
    [
        ('[variable.a]\nmodality = "G"\n', "the trigger `a` (not a belief)"),
        ('[variable.r]\nmodality = "G"\n', "the response `r` (neither a belief nor an action)"),
    ],
)
def test_modalities_that_no_agent_brings_about_are_refused(bindings: str, what: str) -> None:
    diagnostic = refused("whenever a the ag shall satisfy r", bindings)
    assert diagnostic.message == f"an agent cannot express {what} of R1"


@pytest.mark.slow
@pytest.mark.parametrize(
    "sentence",
    [
        "whenever a the ag shall always satisfy r",
        "whenever a the ag shall immediately satisfy r",
        "whenever a the ag shall never satisfy r",
        "whenever a the ag shall until s satisfy r",
        "whenever a the ag shall before s satisfy r",
        "in m mode whenever a the ag shall eventually satisfy r",
    ],
)
def test_an_agent_that_would_break_its_requirement_is_not_emitted(sentence: str) -> None:
    diagnostic = refused(sentence)
    assert diagnostic.code is Code.NOT_KEPT
    assert re.search(r"a run of \d+ stages violates it", diagnostic.message)


def test_names_are_legal_in_every_language() -> None:
    made = requirement("whenever a the ag shall satisfy r", id="7-A.b/ü")
    files = bundle(made)
    assert {path.split("/")[0] for path in files} == {"r7_a_b_ajpf"}
    assert "package r7_a_b_ajpf;" in files["r7_a_b_ajpf/Env.java"]
    assert all(text.isascii() for path, text in files.items() if not path.endswith(".md"))
    assert all(re.fullmatch(r"[\w.]+/[\w.-]+", path, re.ASCII) for path in files)


STUBS = {
    "ail/syntax/Predicate.java": "package ail.syntax; public class Predicate { "
    "public Predicate(String s) {} }",
    "ail/syntax/Message.java": "package ail.syntax; public class Message {}",
    "ail/mas/MAS.java": "package ail.mas; public class MAS {}",
    "choice/Bool.java": "package choice; public class Bool { "
    "public boolean nextBoolean() { return true; } }",
    "choice/Scheduler.java": "package choice; public class Scheduler { "
    "public java.util.List<String> getActiveJobbers() { return null; } }",
    "gwendolen/mas/VerificationofAutonomousSystemsEnvironment.java": """package gwendolen.mas;
import ail.syntax.*; import java.util.Set;
public abstract class VerificationofAutonomousSystemsEnvironment {
    protected choice.Bool random_bool_generator;
    protected ail.mas.MAS mas;
    public abstract Set<Predicate> generate_percepts();
    public abstract Set<Message> generate_messages();
    public boolean done() { return true; }
    public choice.Scheduler getScheduler() { return null; }
    public void clearPercepts() {}
    public void addPercept(Predicate p) {}
}""",
}


@pytest.mark.slow
@needs("javac")
def test_the_environment_compiles_against_what_it_uses_of_mcapl(tmp_path: Path) -> None:
    for name, text in STUBS.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    made = requirement("whenever a & b the ag shall satisfy r", id="7-A")
    (tmp_path / "Env.java").write_text(bundle(made)["r7_a_ajpf/Env.java"], encoding="utf-8")
    done = subprocess.run(
        [
            installed("javac"),
            "--release",
            "11",
            "-Xlint:all",
            "-Werror",
            "-d",
            "classes",
            "Env.java",
            *STUBS,
        ],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "classes/r7_a_ajpf/Env.class").is_file()


@pytest.mark.slow
def test_the_command_writes_a_folder_for_each_requirement(fretc: Fretc, tmp_path: Path) -> None:
    sentence = "whenever a the ag shall eventually satisfy r"
    for id in ("A-1", "A-2"):
        (tmp_path / f"{id}.fret").write_text(f'+++\nid = "{id}"\n+++\n{sentence}\n')
    result = fretc("A-1.fret", "A-2.fret", "--emit", "ajpf-bundle", "-o", "out")
    assert result.status == 0
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["a_1_ajpf", "a_2_ajpf"]
    (tmp_path / "A-1.fret").write_text("whenever a the ag shall always satisfy r")
    assert fretc("A-1.fret", "--emit", "ajpf-bundle", "-o", "other").status == 2
    assert not (tmp_path / "other").exists()


# Actions ----------------------------------------------------------------------------------------

NAMED = '[variable.too_close]\n[variable.stopped]\naction = "{}"\n'


def test_the_bindings_name_the_action_of_agent_and_mutant() -> None:
    files = bundle(requirement(R1, bindings=NAMED.format("stop_moving")))
    released = "-too_close : {True} <- undo_stopped, -stopped;"
    assert plans(files) == ["+too_close : {True} <- stop_moving, +stopped;", released]
    assert plans(files, "SIF_mutant.gwen") == ["+too_close : {True} <- stop_moving;", released]


@pytest.mark.parametrize("name", ["print", "achieve"])
def test_an_action_that_means_something_else_is_refused(name: str) -> None:
    diagnostic = refused(R1, NAMED.format(name))
    assert f"the action `{name}`" in diagnostic.message


def test_an_action_is_a_name_of_gwendolen() -> None:
    found, (diagnostic,) = read_bindings(Source("bindings.toml", NAMED.format("Stop-it")))
    assert found is None
    assert diagnostic.message.startswith("`action` must be a name of Gwendolen")
