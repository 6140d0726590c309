"""The analysis of whole sets: published answers, and laws that any answer keeps."""

import json
import re
from collections.abc import Mapping
from itertools import combinations
from pathlib import Path

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis import verdicts
from fretc.analysis.analysis import analyze
from fretc.analysis.arena.budget import Budget
from fretc.analysis.conflicts import Completeness
from fretc.analysis.conflicts import conflicts as conflicts_of
from fretc.analysis.findings import Conflict, OpenQuestion, RealizabilityVerdict
from fretc.analysis.games.squaring import IterativeSquaring
from fretish.bindings.declarations import Role
from tests.each import each
from tests.effort import FULL
from tests.requirement_sets import ROLES, analyzed, conflicts, drawn, requirement, roles, staged
from tests.requirement_sets import named as named_true

REALIZABLE, UNREALIZABLE = RealizabilityVerdict.REALIZABLE, RealizabilityVerdict.UNREALIZABLE
NOT_CHECKED = RealizabilityVerdict.NOT_CHECKED

# Published sets ---------------------------------------------------------------------------------


PUBLISHED = json.loads(
    (Path(__file__).parents[2] / "data/fret_case_studies.json").read_text("utf-8")
)
FSM_INPUTS = ("standby", "apfail", "limits", "supported", "request", "good", "state", "senstate")
FSM_CONSTANTS = {
    "ap_transition_state": 0, "ap_nominal_state": 1, "ap_maneuver_state": 2, "ap_standby_state": 3,
    "sen_nominal_state": 0, "sen_transition_state": 1, "sen_fault_state": 2,
}  # fmt: skip
MIXER_INPUTS = (
    "start_button", "emergency_button", "liquid_level_1", "liquid_level_2", "timer_60sec_expire",
    "timer_120sec_expire",
)  # fmt: skip
MIXER_OUTPUTS = (
    "valve_0", "valve_1", "valve_2", "stirring_motor", "timer_60sec_start", "timer_120sec_start",
)  # fmt: skip


def published(
    project: str, constants: Mapping[str, int] | None = None
) -> list[FormalizedRequirement]:
    """The requirements of a case study of NASA FRET, with its constants written out."""
    found = []
    for record in PUBLISHED:
        if record["project"] == project:
            sentence = record["fretish"]
            for name, value in (constants or {}).items():
                sentence = re.sub(rf"\b{name}\b", str(value), sentence)
            found.append(requirement(record["id"], sentence))
    return sorted(found, key=lambda each: each.id)


@pytest.mark.slow
def test_the_finite_state_machine_has_three_components_and_five_conflicts() -> None:
    named = roles(FSM_INPUTS, ("pullup", "STATE", "SENSTATE"))
    found = analyze(published("FSM", FSM_CONSTANTS), named)
    assert found.verdict is UNREALIZABLE
    assert [(each.requirements[0], each.verdict) for each in found.components] == [
        ("FSM-001", REALIZABLE), ("FSM-002", UNREALIZABLE), ("FSM-010", UNREALIZABLE),
    ]  # fmt: skip
    assert found.complete
    assert conflicts(found) == [
        ("FSM-002", "FSM-003"), ("FSM-004", "FSM-005"), ("FSM-006", "FSM-007"),
        ("FSM-008", "FSM-009"), ("FSM-010", "FSM-011"),
    ]  # fmt: skip
    assert found.conflicts[0].because == (
        "at tick 0 FSM-002 demands `(STATE = 3)`, and FSM-003 demands `(STATE = 1)`"
    )


def test_the_liquid_mixer_has_six_components_and_one_conflict() -> None:
    named = roles(MIXER_INPUTS, MIXER_OUTPUTS)
    found = analyze(published("Liquid_mixer"), named)
    assert len(found.components) == 6
    assert [each.requirements for each in found.components if each.verdict is UNREALIZABLE] == [
        ("LM-001", "LM-002", "LM-009")
    ]
    (conflict,) = found.conflicts
    assert conflict.requirements == ("LM-001", "LM-009")
    assert conflict.because == "at tick 0 LM-001 demands `valve_0`, and LM-009 forbids it"
    assert {"start_button", "emergency_button"} <= named_true(conflict.play[0])


@pytest.mark.parametrize(
    ("chooser", "verdict"), [(Role.INPUT, UNREALIZABLE), (Role.OUTPUT, REALIZABLE)]
)
def test_who_chooses_a_mode_decides(chooser: Role, verdict: RealizabilityVerdict) -> None:
    """FRET's issue 88."""
    sentences = (
        "in m mode the sw shall always satisfy x",
        "in m mode the sw shall never satisfy x",
    )
    found = analyzed(*sentences, roles={"m": chooser, "x": Role.OUTPUT})
    assert found.verdict is verdict


# Laws -------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_conflicts_are_minimal_and_all_there_are() -> None:
    """Each set of requirements fights just where it holds one of them."""
    fought = 0
    for seed in range(60 if FULL else 24):
        sentences = drawn(("cores", seed), most=5)
        found = analyzed(*sentences)
        cores = [set(each) for each in conflicts(found)]
        assert found.complete
        ids = [f"R{i}" for i in range(1, len(sentences) + 1)]
        setting = staged(*sentences)
        for size in range(1, len(ids) + 1):
            for members in combinations(ids, size):
                game = setting.game(setting.counters(members), Budget(60))
                fights = any(core <= set(members) for core in cores)
                assert game.solution().is_realizable is not fights, (sentences, members)
        assert (found.verdict is UNREALIZABLE) is bool(cores)
        fought += bool(cores)
    assert fought > (15 if FULL else 6)


@pytest.mark.slow
def test_names_order_and_form_change_nothing() -> None:
    for seed in range(40 if FULL else 12):
        sentences = list(drawn(("same", seed), most=4))
        found = analyzed(*sentences)
        turned = analyzed(*reversed(sentences))
        back = {f"R{i}": f"R{len(sentences) + 1 - i}" for i in range(1, len(sentences) + 1)}
        assert {tuple(sorted(back[id] for id in each)) for each in conflicts(turned)} == {
            *conflicts(found)
        }
        assert turned.consistent is found.consistent
        other = dict(zip("abxy", "dcba", strict=True))  # the order of variables turns, too
        renamed = ["".join(_renamed(each, other)) for each in sentences]
        named = {other[name]: role for name, role in ROLES.items()}
        again = analyzed(*renamed, roles=named)
        assert conflicts(again) == conflicts(found)
        assert [each.requirement for each in again.redundant] == [
            each.requirement for each in found.redundant
        ]


def _renamed(sentence: str, other: dict[str, str]) -> str:
    return " ".join(
        word.replace(word.lstrip("!"), other[word.lstrip("!")])
        if word.lstrip("!") in other
        else word
        for word in sentence.split()
    )


def test_a_further_requirement_never_helps() -> None:
    for seed in range(60 if FULL else 25):
        (more, *rest) = drawn(("more", seed), most=4)
        if rest and analyzed(*rest).verdict is UNREALIZABLE:
            assert analyzed(*rest, more).verdict is UNREALIZABLE


def test_a_conjunction_may_be_split() -> None:
    for seed in range(20 if FULL else 8):
        rest = drawn(("split", seed), most=2)
        whole = analyzed(*rest, "whenever a the sw shall immediately satisfy x & (y | b)")
        parts = analyzed(
            *rest,
            "whenever a the sw shall immediately satisfy x",
            "whenever a the sw shall immediately satisfy y | b",
        )
        assert whole.verdict is parts.verdict


@pytest.mark.slow
@each("scale", [1, 7, 30] if FULL else [1, 5])
def test_scaled_durations_give_the_same_answers(scale: int) -> None:
    answered = (
        f"whenever a the sw shall within {4 * scale} ticks satisfy x",
        f"upon b the sw shall for {3 * scale} ticks satisfy !x",
    )
    held = f"upon b the sw shall for {5 * scale} ticks satisfy !x"
    after = f"upon a the sw shall after {2 * scale} ticks satisfy y"
    (fight,) = analyzed(*answered, "whenever y the sw shall immediately satisfy x").conflicts
    assert fight.requirements == ("R1", "R2")  # b comes again before the first hold is over
    assert len(fight.play) == 4 * scale + 1
    assert conflicts(analyzed(answered[0], held, after)) == [("R3",), ("R1", "R2")]


@pytest.mark.slow
@pytest.mark.parametrize("ticks", [10, 1_000_000])
def test_a_million_ticks_are_answered_as_ten_are(ticks: int) -> None:
    """The trigger comes at the first tick at the earliest, and the hold is over `held` later."""
    soon = f"upon a the sw shall within {ticks} ticks satisfy x"
    for held, verdict in ((ticks - 1, REALIZABLE), (ticks, UNREALIZABLE)):
        setting = staged(soon, f"the sw shall for {held} ticks satisfy !x")
        found, _ = verdicts.verdict(setting, Budget(60))
        assert found.verdict is verdict
    conflict, complete = conflicts_of(setting, Budget(60))
    assert isinstance(conflict, Conflict)
    assert isinstance(complete, Completeness)
    assert conflict.because == (
        f"at tick {ticks} R1 demands `x` (since tick 0, by tick {ticks}), and R2 forbids it"
    )
    assert len(conflict.play) == (ticks + 1 if ticks == 10 else 0), "a million are not written down"


# Reasons, roles and readings ----------------------------------------------------------------------


def test_as_fret_eventually_means_at_once() -> None:
    sentences = (
        "whenever a the sw shall eventually satisfy x",
        "whenever b the sw shall immediately satisfy !x",
        "whenever b the sw shall at the next timepoint satisfy !b",
    )
    patient = analyzed(*sentences[:2])
    assert conflicts(patient) == [("R1", "R2")]  # b may come at every tick
    (patient_play,) = patient.conflicts
    assert patient_play.loop is not None
    (hasty,) = analyzed(*sentences[:2], as_fret=True).conflicts
    assert hasty.loop is None
    assert len(hasty.play) == 1
    alone = "whenever a the sw shall eventually satisfy x & !a"
    assert analyzed(alone).verdict is UNREALIZABLE
    late = ("whenever a the sw shall eventually satisfy x", "before y the sw shall never satisfy x")
    assert analyzed(*late).verdict is REALIZABLE
    assert analyzed(*late, as_fret=True).verdict is REALIZABLE  # y comes in time


def test_what_looks_back_is_understood() -> None:
    found = analyzed(
        "the sw shall always satisfy preBool(false, a) -> x",
        "the sw shall always satisfy occurred(2, b) -> !x",
    )
    (conflict,) = found.conflicts
    assert conflict.requirements == ("R1", "R2")
    assert len(conflict.play) == 2
    assert "before the first tick every proposition is false" in found.terms[-1]


def test_what_looks_ahead_is_not_checked_and_hides_no_conflict() -> None:
    ahead = "whenever a the sw shall immediately satisfy persists(2, x)"
    found = analyzed(ahead)
    assert found.verdict is NOT_CHECKED
    assert "R1" in found.why
    assert not found.complete
    fight = ("whenever a the sw shall immediately satisfy x", "the sw shall never satisfy x")
    found = analyzed(ahead, *fight)
    assert conflicts(found) == [("R2", "R3")]
    assert found.verdict is UNREALIZABLE
    assert not found.complete


def test_comparisons_that_exclude_each_other_are_not_free() -> None:
    named = roles(["t"], ["v"])
    found = analyzed(
        "whenever t > 30 the sw shall immediately satisfy v > 5",
        "whenever t < 20 the sw shall immediately satisfy v < 3",
        roles=named,
    )
    assert found.verdict is REALIZABLE
    found = analyzed(
        "whenever t > 30 the sw shall immediately satisfy v > 5",
        "whenever t > 20 the sw shall immediately satisfy v < 3",
        roles=named,
    )
    assert conflicts(found) == [("R1", "R2")]


def test_numbers_that_are_not_linear_give_no_wrong_verdict() -> None:
    """`t * t > 625` and `t = 0` exclude each other, which nothing here tells."""
    sentences = (
        "whenever t * t > 625 the sw shall immediately satisfy x",
        "whenever t = 0 the sw shall immediately satisfy !x",
    )
    found = analyzed(*sentences, roles=roles(["t"], ["x"]))
    assert found.verdict is NOT_CHECKED
    assert found.why == "`t * t` is not computed, and may have any value"


def test_an_assumption_takes_a_conflict_away() -> None:
    fight = (
        "when a the sw shall immediately satisfy x",
        "when b the sw shall immediately satisfy !x",
    )
    assert conflicts(analyzed(*fight)) == [("R1", "R2")]
    assumed = analyzed(*fight, assumed=["the operator shall never satisfy a & b"])
    assert assumed.verdict is REALIZABLE
    assert [each.id for each in assumed.assumptions] == ["A1"]


def test_assumptions_that_nothing_keeps_prove_nothing() -> None:
    found = analyzed("the sw shall never satisfy x", assumed=["the op shall always satisfy x & !x"])
    assert found.verdict is NOT_CHECKED
    assert found.why == "no run satisfies the assumptions A1"


def test_an_assumption_may_be_about_time() -> None:
    requirements = (
        "whenever a the sw shall immediately satisfy x",
        "upon b the sw shall for 3 ticks satisfy !x",
    )
    apart = "upon b the operator shall for 3 ticks satisfy !a"
    assert analyzed(*requirements, assumed=[apart]).verdict is REALIZABLE
    near = "upon b the operator shall for 2 ticks satisfy !a"
    (conflict,) = analyzed(*requirements, assumed=[near]).conflicts
    assert conflict.requirements == ("R1", "R2")
    assert len(conflict.play) == 4


def test_a_promise_of_the_environment_may_be_waited_for() -> None:
    duty = "whenever a the sw shall eventually satisfy x"
    gate = "whenever !b the sw shall immediately satisfy !x"
    assert analyzed(duty, gate).verdict is UNREALIZABLE
    promise = "whenever a the operator shall eventually satisfy b"
    assert analyzed(duty, gate, assumed=[promise]).verdict is REALIZABLE


def test_the_environment_keeps_its_promises_while_it_wins() -> None:
    """Two promises in turn, and the response is withheld where neither is being kept."""
    (conflict,) = analyzed(
        "whenever a the sw shall eventually satisfy x",
        "whenever a | b the sw shall immediately satisfy !x",
        assumed=[
            "upon y the operator shall eventually satisfy a",
            "the operator shall eventually satisfy b",
            "while b the operator shall always satisfy !a",
            "whenever !a & !b the operator shall at the next timepoint satisfy a | b",
            "whenever b the operator shall at the next timepoint satisfy a",
            "whenever a the operator shall at the next timepoint satisfy b",
        ],
    ).conflicts
    assert conflict.requirements == ("R1", "R2")
    assert conflict.loop is not None
    assert {"a", "b"} <= {
        name for tick in conflict.play[conflict.loop :] for name in named_true(tick)
    }


@pytest.mark.slow
def test_what_takes_too_long_comes_with_a_clue(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(IterativeSquaring, "is_due", lambda self: False)
    setting = staged(
        "whenever a the sw shall within 1000000 ticks satisfy x",
        "whenever b the sw shall for 1000001 ticks satisfy !x",
        "whenever b the sw shall immediately satisfy x | y",
    )
    (found,) = conflicts_of(setting, Budget(0.3))
    assert isinstance(found, OpenQuestion)
    assert found.why == (
        "not answered within 0.3 CPU seconds; "
        "with all durations divided by 5001, R1 and R2 conflict"
    )


def test_a_requirement_that_can_never_hold_hides_no_memory_of_the_others() -> None:
    """All of them together are violated at each tick, so that nothing seems to be remembered."""
    found = analyzed(
        "only before !a when y the sw shall finally satisfy x | !x",
        "the sw shall never satisfy !x | x",
    )
    assert conflicts(found) == [("R2",)]
    assert found.complete
