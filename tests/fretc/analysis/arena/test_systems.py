"""Sets with variables that lack a role, and with one name in several systems."""

import json
from pathlib import Path

import pytest

from fretc.analysis.analysis import AnalysisOptions, analyze
from fretc.analysis.findings import RealizabilityVerdict
from tests.command import Fretc
from tests.effort import FULL
from tests.requirement_sets import OUTPUTS, ROLES, drawn, requirements, synthesized

SENTENCES = {
    "A1": "the door shall always satisfy lock = speed",
    "B1": "the motor shall always satisfy speed => power",
    "C1": "the lamp shall always satisfy alarm <=> light",
    "C2": "the lamp shall never satisfy light & mystery",
    "D1": "the bell shall always satisfy alarm => ring",
    "D2": "the bell shall always satisfy !ring",
}
BINDINGS = """
[variable.speed]
component = "door"
role = "input"
[variable.speed.of.motor]
role = "output"
[variable.lock]
role = "output"
[variable.power]
role = "output"
[variable.alarm]
role = "input"
[variable.light]
role = "output"
[variable.ring]
role = "output"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    pairs = (f'+++\nid = "{id}"\n+++\n{text}\n' for id, text in SENTENCES.items())
    (tmp_path / "set.fret").write_text("\n".join(pairs).replace("lock = speed", "(lock <=> speed)"))
    (tmp_path / "bindings.toml").write_text(BINDINGS)
    return tmp_path


@pytest.mark.slow
def test_a_variable_without_a_role_leaves_only_its_component_open(
    fretc: Fretc, folder: Path
) -> None:
    run = fretc("analyze", str(folder), "--format", "json")
    assert run.status == 2
    assert run.err.count("F354") == 1
    assert "F354 `mystery` has no role" in run.err
    found = json.loads(run.out)
    answers = {tuple(each["requirements"]): each["verdict"] for each in found["components"]}
    assert answers == {
        ("A1",): "realizable",
        ("B1",): "realizable",
        ("C1", "C2"): "not checked",
        ("D1", "D2"): "unrealizable",
    }
    whys = {each["requirements"][0]: each["why"] for each in found["components"]}
    assert whys["C1"] == "C2: `mystery` has no single role"


@pytest.mark.slow
def test_one_name_has_a_role_in_each_system(fretc: Fretc, folder: Path) -> None:
    found = json.loads(fretc("analyze", str(folder), "--format", "json").out)
    assert {name: own for name, own in found["roles"].items() if "speed" in name} == {
        "speed of door": "input",
        "speed of motor": "output",
    }
    (folder / "bindings.toml").write_text(BINDINGS.replace("lock", "key"))
    (folder / "set.fret").write_text(
        '+++\nid = "A1"\n+++\nthe door shall always satisfy speed <=> key\n'
        '+++\nid = "A2"\n+++\nthe door shall never satisfy key\n'
        '+++\nid = "B1"\n+++\nthe motor shall always satisfy speed\n'
    )
    run = fretc("analyze", str(folder))
    assert run.status == 1
    assert "    speed (input)  1\n    key (output)   1\n" in run.out
    assert "inputs: speed of door\n" in run.out
    assert fretc("analyze", str(folder), "--emit", "python").status == 1
    (folder / "set.fret").write_text(
        '+++\nid = "A1"\n+++\nthe door shall always satisfy speed <=> key\n'
        '+++\nid = "B1"\n+++\nthe motor shall always satisfy speed\n'
    )
    run = fretc("analyze", str(folder), "--emit", "python")
    assert run.status == 2
    assert "there are several systems" in run.err


def test_nothing_is_analyzed_if_no_requirement_can_be_examined(fretc: Fretc, folder: Path) -> None:
    (folder / "bindings.toml").write_text("")
    run = fretc("analyze", str(folder))
    assert (run.status, run.out) == (2, "")


@pytest.mark.slow
def test_what_is_answered_without_a_role_holds_for_each_role() -> None:
    """Spot solves the same sets with `b` as an input, and with `b` as an output."""
    known = {name: own for name, own in ROLES.items() if name != "b"}
    answered = dict.fromkeys(RealizabilityVerdict, 0)
    for seed in range(2_000 if FULL else 40):
        some = requirements(*drawn(seed, 4))
        found = analyze(some, known, (), AnalysisOptions(repairs=False))
        for component in found.components:
            own = [each for each in some if each.id in component.requirements]
            answered[component.verdict] += 1
            if component.verdict is not RealizabilityVerdict.NOT_CHECKED:
                is_realizable = component.verdict is RealizabilityVerdict.REALIZABLE
                for outputs in (OUTPUTS, ("b", *OUTPUTS)):
                    assert synthesized(own, (), outputs) is is_realizable, own
    assert all(answered.values()), answered
