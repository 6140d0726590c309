"""Phases as users meet them: verdicts that depend on them, and a phase that is proposed."""

import json
from pathlib import Path

import pytest

from fretc.audit.phases.advice import Arc, longest
from fretc.audit.phases.by_shift import PhaseInterval, Phases
from tests.command import Fretc
from tests.command import write as put
from tests.fretc.audit.stepping import stepping
from tests.fretc.logs.logs import MS, number, write

BINDINGS = """[clock]
tick = "100 ms"
[signal.distance]
path = "/distance.data"
[signal.speed]
path = "/speed.data"
[proposition.near]
expr = "distance < 0.5"
[proposition.stopped]
expr = "speed < 0.01"
"""
WITHIN = "when near the robot shall within 300 milliseconds satisfy stopped"


def project(sentence: str = WITHIN, bindings: str = BINDINGS) -> None:
    put("requirements/r1.fret", f'+++\nid = "R1"\n+++\n{sentence}\n')
    put("requirements/bindings.toml", bindings)


@pytest.fixture
def robot(fretc: Fretc) -> Fretc:
    """Distances lie on the borders of ticks; one is near at 0.5 s, and it stands at 0.812 s."""
    distances = [number(0.1 if t == 500 else 2, t * MS, "/distance") for t in range(0, 2001, 100)]
    speeds = [number(0 if t >= 812 else 1, t * MS, "/speed") for t in range(0, 2000, 4)]
    write(Path("run.mcap"), sorted([*distances, *speeds], key=lambda sent: sent.time))
    project()
    return fretc


def test_a_verdict_that_depends_on_the_phase_is_said_with_its_shares_and_a_warning(
    robot: Fretc,
) -> None:
    run = robot("audit", "run.mcap")
    assert run.status == 1
    assert run.out.startswith(
        "run.mcap\n"
        "  ✘ R1  violated      from 0.8 s to 0.9 s (100 ms), triggered at 0.5 s; the "
        "verdict depends on where the ticks begin: violated in 12 % of cases, satisfied in 88 %; "
        "a shift of 1 ns changes it\n"
    )
    assert (
        "F425 warning: whether R1 is violated depends on where the grid of ticks begins\n"
        "  --> requirements/bindings.toml:1:1\n"
    ) in run.err


def test_the_evidence_lists_each_phase_with_its_verdict(robot: Fretc) -> None:
    robot("audit", "run.mcap")
    (result,) = json.loads(Path("build/evidence.json").read_text("utf-8"))["results"]
    assert result["phases"] == {
        "period_ns": 100 * MS,
        "declared_ns": 0,
        "exact": True,
        "nearest_ns": 1,
        "stretches": [
            {"first_ns": 0, "last_ns": 12 * MS - 1, "verdict": "violated"},
            {"first_ns": 12 * MS, "last_ns": 100 * MS - 1, "verdict": "satisfied"},
        ],
    }


@pytest.mark.parametrize(
    ("phase", "verdict", "nearest"),
    [("11999999 ns", "violated", 1), ("12 ms", "satisfied", 1), ("15 ms", "satisfied", 3 * MS + 1)],
)
def test_a_declared_phase_is_audited_and_told_how_near_it_is(
    robot: Fretc, phase: str, verdict: str, nearest: int
) -> None:
    project(bindings=BINDINGS.replace("[clock]", f'[clock]\nphase = "{phase}"'))
    robot("audit", "run.mcap")
    (result,) = json.loads(Path("build/evidence.json").read_text("utf-8"))["results"]
    assert (result["verdict"], result["phases"]["nearest_ns"]) == (verdict, nearest)


def test_a_satisfied_run_that_other_phases_violate_says_so(robot: Fretc) -> None:
    project(bindings=BINDINGS.replace("[clock]", '[clock]\nphase = "15 ms"'))
    run = robot("audit", "run.mcap")
    assert run.status == 0
    assert "satisfied in 88 % of cases, violated in 12 %; a shift of 3 ms changes it" in run.out
    assert "F425 warning" in run.err


@pytest.mark.slow
@pytest.mark.parametrize("form", ["junit", "sarif", "github", "json"])
def test_every_form_says_it(robot: Fretc, form: str) -> None:
    assert "violated in 12 %" in robot("audit", "run.mcap", "--format", form).out.replace(
        "%25", "%"
    )


def test_the_report_says_it(robot: Fretc) -> None:
    robot("audit", "run.mcap")
    robot("report", "--json", "report.json")
    assert "violated in 12 %" in Path("report.json").read_text("utf-8")


def test_both_ways_to_run_monitors_give_the_same_evidence(robot: Fretc) -> None:
    robot("audit", "run.mcap")
    content = Path("build/evidence.json").read_bytes()
    with stepping():
        robot("audit", "run.mcap")
    assert Path("build/evidence.json").read_bytes() == content


def test_a_check_proposes_the_middle_of_the_longest_stretch(robot: Fretc) -> None:
    run = robot("bind", "--check", "run.mcap")
    assert run.out.endswith(
        "? phase of the ticks: verdicts depend on it\n"
        "  run.mcap  R1 violated, the verdict depends on where the ticks begin: violated in 12 % "
        "of cases, satisfied in 88 %; a shift of 1 ns changes it\n"
    )
    assert (
        "F427 note: at phase 60 ms no verdict changes within 40 ms, at the declared one (0 s) one "
        "does within 1 ns; R1 in `run.mcap` is satisfied there, and violated as declared\n"
    ) in run.err
    assert 'write `phase = "60 ms"` under `[clock]`' in run.err
    project(bindings=BINDINGS.replace("[clock]", '[clock]\nphase = "60 ms"'))
    assert "F427" not in robot("bind", "--check", "run.mcap").err


def test_a_clock_by_message_has_no_phases(robot: Fretc) -> None:
    bindings = BINDINGS.replace('"100 ms"', '"/distance"')
    project(WITHIN.replace("300 milliseconds", "3 ticks"), bindings)
    robot("audit", "run.mcap")
    (result,) = json.loads(Path("build/evidence.json").read_text("utf-8"))["results"]
    assert "phases" not in result
    assert "phase" not in robot("bind", "--check", "run.mcap").out


def test_of_a_requirement_with_a_probability_the_run_alone_is_told(robot: Fretc) -> None:
    project(WITHIN.replace("shall", "shall with probability >= 0.9"))
    run = robot("audit", "run.mcap")
    assert (
        "inconclusive  0 of 1 trigger answered, 1 failed: judged over all runs; in this run "
        "alone, the verdict depends on where the ticks begin: violated in 12 % of cases"
    ) in run.out


def test_what_is_open_at_the_end_is_judged_as_the_clock_says_at_each_phase(robot: Fretc) -> None:
    strict = BINDINGS.replace("[clock]", '[clock]\nend = "violated"')
    project("when near the robot shall eventually satisfy speed_up", strict + (
        '[proposition.speed_up]\nexpr = "speed > 5"\n'
    ))  # fmt: skip
    run = robot("audit", "run.mcap")
    assert run.status == 1
    assert "where the ticks begin" not in run.out


# The longest stretch


def phases(*stretches: tuple[int, str | None], period: int = 100) -> Phases:
    """Stretches by their first phases; the declared one is 0."""
    ends = [*(first for first, _ in stretches[1:]), period]
    parts = [PhaseInterval(f, end - 1, v) for (f, v), end in zip(stretches, ends, strict=True)]
    return Phases(period, 0, tuple(parts))


def test_the_longest_stretch_is_one_of_all_logs_together_and_goes_round() -> None:
    one = phases((0, "violated"), (10, "satisfied"), (50, "violated"))
    other = phases((0, "satisfied"), (70, "vacuous"), (75, "satisfied"))
    assert longest([one]) == Arc(50, 60)
    assert longest([one, other]) == Arc(10, 40)
    assert longest([other]) == Arc(75, 95)


def test_what_was_not_judged_is_never_proposed() -> None:
    assert longest([phases((0, "satisfied"), (10, None))]) == Arc(0, 10)
    assert longest([phases((0, "satisfied"))]) is None


@pytest.mark.parametrize(
    ("arc", "middle"),
    [(Arc(12, 88), 60), (Arc(50, 60), 80), (Arc(75, 95), 20), (Arc(7, 1), 7), (Arc(98, 4), 0)],
)
def test_the_proposed_phase_is_a_round_one_near_the_middle(arc: Arc, middle: int) -> None:
    assert arc.middle(100) == middle
    assert arc.offset(middle, 100) < arc.length


def test_the_margin_is_the_distance_to_the_nearest_phase_outside() -> None:
    assert [Arc(98, 4).margin(phase, 100) for phase in (98, 99, 0, 1)] == [1, 2, 2, 1]
