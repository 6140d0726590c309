"""`fretc analyze` as its users meet it."""

import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import jsonschema  # type: ignore[import-untyped]
import pytest

from fretc.analysis import findings
from tests.command import Fretc, write

FIGHT = (
    "whenever start the line shall within 2 ticks satisfy run",
    "upon stop the line shall for 3 ticks satisfy !run",
)
ROOT = Path(__file__).parents[3]
ROLES = {"start": "input", "stop": "input", "run": "output"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return written(tmp_path, FIGHT)


def written(
    folder: Path, sentences: Sequence[str], roles: dict[str, str] = ROLES, more: str = ""
) -> Path:
    for number, sentence in enumerate(sentences, 1):
        (folder / f"r{number}.fret").write_text(f'+++\nid = "R{number}"\n+++\n{sentence}\n')
    tables = "".join(f'[variable.{name}]\nrole = "{role}"\n' for name, role in roles.items())
    (folder / "bindings.toml").write_text(tables + more)
    return folder


@pytest.mark.slow
def test_a_conflict_is_shown_tick_by_tick(fretc: Fretc, folder: Path) -> None:
    run = fretc("analyze", str(folder))
    assert run.status == 1
    assert run.out.startswith(
        "✘ unrealizable: no system can satisfy all requirements\n"
        "  ✘ R1, R2 (about run): the environment wins\n"
        "\n"
        "✘ conflict 1: R1 and R2 cannot be satisfied together\n"
        "  at tick 2 R1 demands `run` (since tick 0, by tick 2), and R2 forbids it "
        "(since tick 0, up to tick 3)\n"
    )
    assert "    run (output)   0  0  1\n" in run.out


@pytest.mark.slow
def test_a_conflict_of_propositions_about_one_number_has_their_lanes(
    fretc: Fretc, tmp_path: Path
) -> None:
    sentences = (
        "the line shall within 2 ticks satisfy fast",
        "the line shall never satisfy fast",
        "the line shall always satisfy slow",
    )
    more = '[clock]\ntick = "100 ms"\n[signal.v]\npath = "/v.data"\nrole = "output"\n' + "".join(
        f'[proposition.{name}]\nexpr = "{expr}"\n'
        for name, expr in (("fast", "v > 2"), ("slow", "v < 3"))
    )
    run = fretc("analyze", str(written(tmp_path, sentences, {}, more)))
    assert run.status == 1
    assert "  at tick 2 R1 demands `fast`, and R2 forbids it\n  R1  the line" in run.out
    assert "    fast (output)     0  1\n" in run.out
    assert fretc("report", "--requirements", str(tmp_path), "-o", "r.html").status == 0


@pytest.mark.slow
def test_what_would_settle_a_conflict_is_suggested(fretc: Fretc, tmp_path: Path) -> None:
    fight = (
        "upon start the line shall immediately satisfy run",
        "upon stop the line shall for 3 ticks satisfy !run",
    )
    folder = written(tmp_path, fight)
    run = fretc("analyze", str(folder))
    (line,) = [line for line in run.out.splitlines() if "assume: " in line]
    sentence = line.partition("assume: ")[2]
    assert sentence == "whenever stop the environment shall for 3 ticks satisfy !start"
    more = f'[[assume.requirement]]\nid = "A1"\nsentence = "{sentence}"\n'
    assert fretc("analyze", str(written(tmp_path, fight, more=more))).status == 0


@pytest.mark.slow
def test_json_is_as_its_schema_says(fretc: Fretc, folder: Path) -> None:
    run = fretc("analyze", str(folder), "--format", "json")
    assert run.status == 1
    found = json.loads(run.out)
    jsonschema.validate(found, findings.schema())
    (conflict,) = found["conflicts"]
    assert conflict["requirements"] == ["R1", "R2"]
    assert conflict["play"][0] == {"run": False, "start": True, "stop": True}
    assert found["roles"] == {"run": "output", "start": "input", "stop": "input"}


def test_an_assumption_makes_it_realizable(fretc: Fretc, tmp_path: Path) -> None:
    assumed = (
        '[[assume.requirement]]\nid = "A1"\ntext = "one button"\n'
        'sentence = "upon stop the man shall for 3 ticks satisfy !start"\n'
        '[[assume.requirement]]\nid = "A2"\n'
        'sentence = "whenever start the man shall for 3 ticks satisfy !stop"\n'
    )
    run = fretc("analyze", str(written(tmp_path, FIGHT, more=assumed)))
    assert run.status == 0, run.out
    assert run.out.startswith(
        "✔ realizable: a system can satisfy all requirements, while the assump"
    )
    assert " satisfy !start (one button)\nassumed A2: whenever start the man shall" in run.out


@pytest.mark.parametrize(
    ("table", "code", "place"),
    [
        ('id = "R1"\nsentence = "m shall never satisfy stop"', "F201", "bindings.toml:9:"),
        ('id = "A1"\nsentence = "m shall newer satisfy stop"', "F1", "bindings.toml:9:"),
        ('id = "A1"', "F303", "bindings.toml:"),
        ('id = "A1"\nsentence = "m shall never satisfy stop"\nsince = 3', "F302", "toml:10:1"),
        ('id = "A1"\nsentence = "m shall never satisfy fog"', "F354", "bindings.toml:9:"),
    ],
)
def test_a_mistaken_assumption_is_told_where_it_stands(
    fretc: Fretc, tmp_path: Path, table: str, code: str, place: str
) -> None:
    folder = written(tmp_path, FIGHT, more=f"[[assume.requirement]]\n{table}\n")
    run = fretc("analyze", str(folder))
    assert run.status == 2
    assert run.err.startswith(code), run.err
    assert place in run.err


def test_a_variable_without_a_role_is_an_error_with_lines_to_paste(
    fretc: Fretc, tmp_path: Path
) -> None:
    folder = written(tmp_path, FIGHT, {"start": "input", "stop": "mode"})
    run = fretc("analyze", str(folder))
    assert run.status == 2
    assert "F354 `run` has no role: it may be chosen by the environment or by the system" in run.err
    assert '[variable.run]\nrole = "output"' in run.err
    assert (
        "F354 `stop` is a mode without a role: it may be chosen by the system or by the environment"
        in run.err
    )
    assert '[variable.stop]\nrole = "input"' in run.err


def test_a_component_is_asked_about_alone(fretc: Fretc, tmp_path: Path) -> None:
    other = "whenever start the lamp shall immediately satisfy glow"
    folder = written(tmp_path, (*FIGHT, other), ROLES | {"glow": "output"})
    run = fretc("analyze", str(folder), "--component", "lamp")
    assert run.status == 0
    assert "R1" not in run.out
    run = fretc("analyze", str(folder), "--component", "lamb")
    assert run.status == 2
    assert "no requirement is about the component `lamb`" in run.err
    assert "did you mean `lamp`?" in run.err


def test_what_is_not_checked_exits_with_3(fretc: Fretc, tmp_path: Path) -> None:
    ahead = "whenever start the line shall immediately satisfy persists(2, run)"
    run = fretc("analyze", str(written(tmp_path, [ahead], {"start": "input", "run": "output"})))
    assert run.status == 3
    assert run.out.startswith("? not checked: R1: `persists(2,run)` is not a value at a single")


def test_a_retired_requirement_is_no_part_of_the_set(fretc: Fretc, folder: Path) -> None:
    path = folder / "r2.fret"
    path.write_text(path.read_text().replace('"R2"', '"R2"\nstatus = "retired"'))
    assert fretc("analyze", str(folder)).status == 0


@pytest.mark.slow
def test_as_fret_eventually_means_at_once(fretc: Fretc, tmp_path: Path) -> None:
    sentences = (
        "whenever start the line shall eventually satisfy run",
        "upon stop the line shall immediately satisfy !run",
    )
    folder = str(written(tmp_path, sentences))
    assert fretc("analyze", folder).status == 0
    assert fretc("analyze", folder, "--as-fret").status == 1


KEPT = (
    "whenever start the line shall within 2 ticks satisfy run",
    "upon stop the line shall immediately satisfy !run",
)


@pytest.mark.slow
def test_a_strategy_is_a_program_that_runs(fretc: Fretc, tmp_path: Path) -> None:
    folder, out = written(tmp_path, KEPT), tmp_path / "out"
    run = fretc("analyze", str(folder), "--emit", "python", "--emit-to", str(out))
    assert run.status == 0, run.err
    program = [sys.executable, str(out / "controller.py")]
    ticks = [{"start": True, "stop": True}] + 2 * [{"start": False, "stop": False}]
    lines = "".join(f"{json.dumps(tick)}\n" for tick in ticks)
    done = subprocess.run(program, input=lines, capture_output=True, text=True, check=True)
    outputs = [json.loads(line)["run"] for line in done.stdout.splitlines()]
    assert not outputs[0]
    assert any(outputs)
    wrong = subprocess.run(program, input="{}\n", capture_output=True, text=True, check=False)
    assert wrong.returncode == 2
    assert wrong.stderr == "line 1: the input start is to be true or false at each tick\n"


@pytest.mark.slow
@pytest.mark.parametrize(("form", "begin"), [("hoa", "HOA: v1\n"), ("dot", "digraph ")])
def test_a_strategy_is_an_automaton_for_each_component(
    fretc: Fretc, tmp_path: Path, form: str, begin: str
) -> None:
    other = "whenever start the lamp shall immediately satisfy glow"
    folder, out = written(tmp_path, (*KEPT, other), ROLES | {"glow": "output"}), tmp_path / "out"
    assert fretc("analyze", str(folder), "--emit", form, "--emit-to", str(out)).status == 0
    texts = [path.read_text() for path in sorted(out.iterdir())]
    assert [path.name for path in sorted(out.iterdir())] == [f"controller-{i}.{form}" for i in "12"]
    assert all(text.startswith(begin) for text in texts)
    assert "glow" in texts[1]
    printed = fretc("analyze", str(folder), "--emit", form, "--emit-to", "-")
    assert printed.out == "".join(texts)


@pytest.mark.slow
def test_no_strategy_is_written_where_there_is_none(fretc: Fretc, folder: Path) -> None:
    run = fretc("analyze", str(folder), "--emit", "python", "--emit-to", str(folder / "out"))
    assert run.status == 1
    assert "no controller is written: cannot be satisfied together: R1, R2" in run.err
    assert not (folder / "out").exists()


@pytest.mark.slow
def test_a_strategy_that_is_too_large_is_refused(fretc: Fretc, tmp_path: Path) -> None:
    folder = written(tmp_path, ["upon start the line shall for 5000 ticks satisfy run"])
    run = fretc("analyze", str(folder), "--emit", "hoa", "--emit-to", str(tmp_path / "out"))
    assert run.status == 2
    assert "F670 no controller can be written: its automaton has more than 1000 states" in run.err
    assert not (tmp_path / "out").exists()
    assert fretc("analyze", str(folder), "--emit", "python", "--emit-to", str(tmp_path)).status == 0


# FRET's exports --------------------------------------------------------------------------------


def exported(folder: Path, sentences: dict[str, str], variables: Sequence[dict[str, str]]) -> str:
    """An export of FRET: sentences by their ids, and its records of variables."""
    requirements = [{"reqid": id, "fulltext": text} for id, text in sentences.items()]
    path = folder / "export.json"
    path.write_text(json.dumps({"requirements": requirements, "variables": list(variables)}))
    return str(path)


def variable(component: str, name: str, kind: str, type_: str, value: str = "") -> dict[str, str]:
    names = {"component_name": component, "variable_name": name}
    return {**names, "idType": kind, "dataType": type_, "assignment": value}


def test_an_export_of_fret_is_analyzed_straight(fretc: Fretc, tmp_path: Path) -> None:
    """Roles are FRET's, and a constant stands for its value: `state` cannot be two at once."""
    sentences = {
        "R1": "the sw shall always satisfy button -> state = idle",
        "R2": "the sw shall always satisfy button -> state = busy",
    }
    variables = [
        variable("sw", "button", "Input", "boolean"),
        variable("sw", "state", "Output", "double"),
        variable("sw", "idle", "Internal", "double", "0.0"),
        variable("sw", "busy", "Internal", "double", "1.0"),
    ]
    folder = str(tmp_path / "in")
    assert fretc("import", exported(tmp_path, sentences, variables), "-o", folder).status == 0
    run = fretc("analyze", folder, "--format", "json")
    found = json.loads(run.out)
    assert found["roles"] == {"button": "input", "state": "output"}
    assert [each["requirements"] for each in found["conflicts"]] == [["R1", "R2"]]


def test_components_of_an_export_are_told_apart(fretc: Fretc, tmp_path: Path) -> None:
    """What is an output of one component is an input of the other one, which has to bear it."""
    sentences = {
        "S1": "the sender shall always satisfy link",
        "R1": "the receiver shall always satisfy link",
    }
    variables = [
        variable("sender", "link", "Output", "boolean"),
        variable("receiver", "link", "Input", "boolean"),
    ]
    folder = str(tmp_path / "in")
    assert fretc("import", exported(tmp_path, sentences, variables), "-o", folder).status == 0
    assert fretc("analyze", folder, "--component", "sender").status == 0
    assert fretc("analyze", folder, "--component", "receiver").status == 1
    both = fretc("analyze", folder)
    assert both.status == 1
    assert "  ✔ S1 (about link): the system has a strategy\n" in both.out
    assert "  ✘ R1: the environment wins\n" in both.out
    assert "inputs: link of receiver\noutputs: link of sender\n" in both.out


# Assumptions by their kind ---------------------------------------------------------------------

ASSUMED = "the operator shall never satisfy start & stop"


def with_assumption(folder: Path, sentence: str = ASSUMED) -> str:
    written(folder, FIGHT)
    (folder / "a1.fret").write_text(f'+++\nid = "A1"\nkind = "assumption"\n+++\n{sentence}\n')
    return str(folder)


@pytest.mark.slow
def test_a_requirement_of_this_kind_is_assumed_as_a_sentence_of_the_bindings(
    fretc: Fretc, tmp_path: Path
) -> None:
    by_kind, by_table = (tmp_path / name for name in ("kind", "table"))
    for each in (by_kind, by_table):
        each.mkdir()
    table = f'[[assume.requirement]]\nid = "A1"\nsentence = "{ASSUMED}"\n'
    folders = with_assumption(by_kind), str(written(by_table, FIGHT, more=table))
    runs = [fretc("analyze", folder, "--format", "json") for folder in folders]
    found, other = (json.loads(run.out) for run in runs)
    for each in (*found["components"], *other["components"]):
        del each["seconds"]
    assert found == other
    assert [each["id"] for each in found["assumptions"]] == ["A1"]


def test_check_lists_assumptions_and_warns_of_one_about_outputs(
    fretc: Fretc, tmp_path: Path
) -> None:
    run = fretc("check", "--requirements", with_assumption(tmp_path))
    assert "assumptions about the environment: A1\n3 requirements: " in run.err
    assert "F563" not in run.err
    run = fretc("check", "--requirements", with_assumption(tmp_path, "m shall always satisfy run"))
    assert (
        "F563 warning: A1 is an assumption about outputs alone: `run`\n"
        f"  --> {tmp_path}/a1.fret:3:8\n"
    ) in run.err
    counts = json.loads(fretc("check", "--requirements", str(tmp_path), "--format", "json").out)
    assert counts["assumptions"] == ["A1"]


def test_assumptions_alone_are_nothing_to_analyze(fretc: Fretc, tmp_path: Path) -> None:
    write("a.fret", f'+++\nid = "A1"\nkind = "assumption"\n+++\n{ASSUMED}\n')
    assert fretc("analyze", "a.fret").err.startswith("F909 there is no requirement to analyze")


# `fretc check --analyze` -----------------------------------------------------------------------


@pytest.mark.slow
def test_check_names_each_conflict(fretc: Fretc, folder: Path) -> None:
    run = fretc("check", "--requirements", str(folder), "--analyze")
    assert (
        "F561 warning: R1 and R2 cannot be satisfied together: at tick 2 R1 demands `run`"
        in run.err
    )
    assert "F561" not in fretc("check", "--requirements", str(folder)).err


@pytest.mark.slow
def test_check_takes_an_answer_only_while_it_is_about_these(fretc: Fretc, tmp_path: Path) -> None:
    """The answer in the file was changed by hand, so that it shows where it is taken."""
    good = (FIGHT[0], "upon stop the line shall within 3 ticks satisfy !run")
    written(tmp_path, good)
    assert fretc("analyze", str(tmp_path)).status == 0
    assert "F56" not in fretc("check", "--requirements", str(tmp_path), "--analyze").err
    text = Path("build/analysis.json").read_text().replace('"realizable"', '"not checked"')
    Path("build/analysis.json").write_text(text)
    assert "F562 warning" in fretc("check", "--requirements", str(tmp_path), "--analyze").err
    written(tmp_path, FIGHT)
    assert "F561 warning" in fretc("check", "--requirements", str(tmp_path), "--analyze").err


def test_check_says_what_has_no_role(fretc: Fretc, folder: Path) -> None:
    written(folder, FIGHT, {"start": "input", "run": "output"})
    assert "F354" in fretc("check", "--requirements", str(folder), "--analyze").err


@pytest.mark.slow
def test_the_mission_cannot_be_kept_without_scans(fretc: Fretc, tmp_path: Path) -> None:
    """Who is released has to move, who moves needs a scan, and nobody has to send one."""
    run = fretc(
        *("analyze", str(ROOT / "requirements/mission"), "--format", "json"),
        *("-o", str(tmp_path / "analysis.json")),
    )
    assert run.status == 1
    found = json.loads(run.out)
    verdicts = {each["requirements"][0]: each["verdict"] for each in found["components"]}
    assert verdicts == {"R1": "unrealizable", "R9": "realizable", "R14": "realizable"}
    (conflict,) = found["conflicts"]
    assert set(conflict["requirements"]) == {"R7", "R8", "R13", "R15"}
    play = conflict["play"]
    assert not any(tick["scan_fresh"] for tick in play)
    assert all(tick["alive"] for tick in play)
    assert all(tick["stop_requested"] is not tick["released"] for tick in play)
    begun = next(n for n, tick in enumerate(play) if tick["released"])
    assert begun <= 200
    assert len(play) == begun + 51
    assert [n for n, tick in enumerate(play) if tick["moving"]] in ([], [len(play) - 1])


def test_an_answer_says_without_which_requirements_it_is(fretc: Fretc) -> None:
    """That others can be kept is no claim about all; a component is named in the other's file."""
    write("requirements/bindings.toml", '[variable.p]\nrole = "output"\n')
    write("requirements/a.fret", "the alpha shall always satisfy p")
    write("requirements/b.fret", "the beta shall allways satisfy q")
    for words in (("analyze",), ("analyze", "--component", "alpha")):
        run = fretc(*words)
        assert run.status == 2
        assert run.out.startswith("✔ realizable: a system can satisfy all other requirements, ")
        assert run.out.splitlines()[1] == "? without b: see the errors"
        assert run.err.startswith("F107 ")
        assert "left out because of errors: 1 of 2 requirements\n  F107 requirements/b." in run.err
        assert json.loads(Path("build/analysis.json").read_text())["requirements"].keys() == {"a"}
