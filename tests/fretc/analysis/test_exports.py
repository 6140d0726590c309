"""FRET's exports straight: published case studies, imported and analyzed as their users do it."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from compiler.project.folder import load_folder
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.roles import roles
from fretc.analysis.findings import RealizabilityVerdict
from fretc.analysis.realizability_problem import stage
from fretc.analysis.verdicts import verdict
from fretish.diagnostics.diagnostic import Diagnostic
from tests.command import Fretc, write
from tests.effort import full_only

STUDIES = json.loads((Path(__file__).parents[2] / "data/fret_case_studies.json").read_text("utf-8"))
"""Source: NASA FRET (Apache-2.0), its case studies."""
INPUT, OUTPUT, INTERNAL = "Input", "Output", "Internal"
Variables = Mapping[str, tuple[str, str, str]]
"""Name → kind, data type and assignment, as FRET has them."""


def numbered(names: str) -> Variables:
    return {name: (INTERNAL, "integer", str(i)) for i, name in enumerate(names.split())}


FSM: Variables = {
    **numbered("ap_transition_state ap_nominal_state ap_maneuver_state ap_standby_state"),
    **numbered("sen_nominal_state sen_transition_state sen_fault_state"),
    **dict.fromkeys(("state", "senstate"), (INPUT, "integer", "")),
    **dict.fromkeys(("STATE", "SENSTATE"), (OUTPUT, "integer", "")),
    "pullup": (OUTPUT, "boolean", ""),
}
MIXER: Variables = dict.fromkeys(
    ("valve_0", "valve_1", "valve_2", "stirring_motor", "timer_60sec_start", "timer_120sec_start"),
    (OUTPUT, "boolean", ""),
)
PLANE: Variables = {
    **numbered("wing_borne semi_wing_borne semi_thrust_borne thrust_borne"),
    "lift_mode": (OUTPUT, "integer", ""),
    "hover_control_mode": (OUTPUT, "boolean", ""),
    **dict.fromkeys(("kias", "kgs"), (OUTPUT, "double", "")),
}
DELAYED: Variables = {**PLANE, "kias_before": (INTERNAL, "double", "0.0 -> pre kias")}


def export(project: str, variables: Variables, without: str = "", delayed: bool = False) -> str:
    """The file of a project as FRET writes it; names that are not given are Boolean inputs."""
    records: list[dict[str, Any]] = []
    names: dict[str, None] = dict.fromkeys(variables)
    for study in STUDIES:
        if study["project"] == project and study["id"] != without:
            text = study["fretish"]
            if delayed:
                text = text.replace("preReal(0.0, kias)", "kias_before")
            records.append(
                {
                    "reqid": study["id"],
                    "parent_reqid": "",
                    "project": project,
                    "rationale": "",
                    "fulltext": text,
                    "semantics": {"ft": "of another sentence"},
                }
            )
            names |= dict.fromkeys(study["variables"])
            component = study["component"]
    declared = [
        {
            "project": project,
            "component_name": component,
            "variable_name": name,
            "reqs": [],
            "dataType": type_,
            "idType": kind,
            "moduleName": "",
            "description": "",
            "assignment": assignment,
            "modeRequirement": "",
            "modeldoc": False,
            "completed": True,
            "_id": f"{project}{component}{name}",
        }
        for name in names
        for kind, type_, assignment in [variables.get(name, (INPUT, "boolean", ""))]
    ]
    return json.dumps({"requirements": records, "variables": declared})


def analysis(fretc: Fretc, text: str, *options: str) -> dict[str, Any]:
    """The answer for an export, from the file to the verdict."""
    run = fretc("import", write("export.json", text), "-o", "set")
    assert run.status == 0, run.err
    run = fretc("analyze", "set", *options, "--format", "json")
    assert run.status in (0, 1, 3), run.err
    found: dict[str, Any] = json.loads(run.out)
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("project", "variables", "verdicts", "conflicts"),
    [
        (
            "FSM",
            FSM,
            ["realizable", "unrealizable", "unrealizable"],
            [
                ["FSM-002", "FSM-003"], ["FSM-004", "FSM-005"], ["FSM-006", "FSM-007"],
                ["FSM-008", "FSM-009"], ["FSM-010", "FSM-011"],
            ],
        ),
        ("Liquid_mixer", MIXER, [*["realizable"] * 5, "unrealizable"], [["LM-001", "LM-009"]]),
    ],
)  # fmt: skip
def test_a_published_set_has_its_published_answer(
    fretc: Fretc,
    project: str,
    variables: Variables,
    verdicts: Sequence[str],
    conflicts: Sequence[Sequence[str]],
) -> None:
    found = analysis(fretc, export(project, variables))
    assert sorted(each["verdict"] for each in found["components"]) == verdicts
    assert [each["requirements"] for each in found["conflicts"]] == conflicts
    assert found["complete"]
    assert all(each["play"] for each in found["conflicts"])


@full_only("seconds each")
@pytest.mark.parametrize(
    ("without", "delayed", "answer"),
    [
        ("LPC_REACH_HOVER_12", True, RealizabilityVerdict.UNREALIZABLE),
        ("LPC_REACH_HOVER_06", True, RealizabilityVerdict.REALIZABLE),
        ("LPC_REACH_HOVER_06", False, RealizabilityVerdict.REALIZABLE),
    ],
)
def test_hover_is_reached_within_twelve_ticks_and_not_within_six(
    fretc: Fretc, without: str, delayed: bool, answer: RealizabilityVerdict
) -> None:
    """A plane that slows down by 10 knots a tick; `0.0 -> pre kias` says the same as `preReal`.

    These are the published answers. Of all questions only this one is asked: the others take long.
    """
    text = export("LPC_mini", DELAYED if delayed else PLANE, without, delayed)
    assert fretc("import", write("export.json", text), "-o", "set").status == 0
    project = load_folder("set")
    assert not isinstance(project, Diagnostic)
    named, mistakes = roles(project.formalized)
    assert not mistakes
    assert "kias_before" not in named
    found, _ = verdict(stage(project.formalized, (), named), Budget(60))
    assert found.verdict is answer


def test_an_assignment_that_is_not_read_is_told(fretc: Fretc) -> None:
    variables: Variables = {**DELAYED, "kias_before": (INTERNAL, "double", "pre kias")}
    fretc(
        "import", write("export.json", export("LPC_mini", variables, "", delayed=True)), "-o", "s"
    )
    run = fretc("analyze", "s")
    assert run.status == 2
    assert "F354 `kias_before` has no role, and its assignment `pre kias` is not read" in run.err
