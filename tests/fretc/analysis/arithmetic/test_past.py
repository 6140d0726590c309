"""Numbers of the tick before: what is certain of them, and what is left open."""

import random
from itertools import pairwise
from typing import Any

import pytest

from compiler.targets.python import monitor as target
from fretc.analysis.analysis import AnalysisOptions, analyze
from fretc.analysis.findings import RealizabilityVerdict
from fretc.analysis.games import game_traces, squaring
from monitors.loading import load
from tests.each import each
from tests.effort import FULL
from tests.requirement_sets import analyzed, conflicts, requirement, requirements, roles

RATE = "the sw shall always satisfy absReal(v - preReal(0.0, v)) <= 1"
NAMED = roles(["t", "a"], ["v", "x"])


@pytest.mark.slow
@each(
    "others",
    [
        ["the sw shall always satisfy v <= 10"],
        [
            "the sw shall always satisfy v >= 0 & v <= 10",
            "when a the sw shall eventually satisfy x",
        ],
        ["whenever preReal(0.0, v) > 3 the sw shall immediately satisfy v > 2 & v < 9"],
        ["whenever preReal(0.0, t) > 2 the sw shall immediately satisfy v < 0.5"],
    ],
)
def test_a_rate_can_be_kept(others: list[str]) -> None:
    found = analyzed(RATE, *others, roles=NAMED)
    assert found.verdict is RealizabilityVerdict.REALIZABLE, found.why


def test_the_first_tick_has_the_number_that_stands_there() -> None:
    late = "whenever preReal({}, v) > 3 the sw shall immediately satisfy v > 9"
    rest = ("the sw shall always satisfy v <= 3",)
    assert (
        analyzed(late.format("0.0"), *rest, roles=NAMED).verdict is RealizabilityVerdict.REALIZABLE
    )
    assert conflicts(analyzed(late.format("4.0"), *rest, roles=NAMED)) == [("R1", "R2")]


@pytest.mark.slow
def test_a_bound_is_reached_step_by_step() -> None:
    """From 0 by steps of 1 it takes two ticks to 2, and three to 3."""
    for ticks, goal, answer in (
        *[(1, 3, RealizabilityVerdict.UNREALIZABLE)] * FULL,
        (0, 2, RealizabilityVerdict.UNREALIZABLE),
        (2, 3, RealizabilityVerdict.REALIZABLE),
    ):
        climb = f"upon a the sw shall within {ticks} ticks satisfy v >= {goal}"
        found = analyzed(RATE, climb, "the sw shall always satisfy v <= 4", roles=NAMED)
        assert found.verdict is answer, found.why
        assert found.complete
        assert conflicts(found) == (
            [] if answer is RealizabilityVerdict.REALIZABLE else [("R1", "R2")]
        )


@pytest.mark.slow
def test_a_play_with_numbers_of_before_has_each_of_its_ticks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Leaps begin at once; but no number of the tick before is known after one."""
    monkeypatch.setattr(squaring.IterativeSquaring, "is_due", lambda self: True)
    monkeypatch.setattr(game_traces, "_LONG", 0)
    ticks = 6 if FULL else 2
    low = f"the sw shall for {ticks} ticks satisfy v <= 0"
    high = f"upon a the sw shall within {ticks + 1} ticks satisfy v >= 2"
    found = analyzed(RATE, low, high, roles=NAMED)
    (conflict,) = found.conflicts
    assert conflict.requirements == ("R1", "R2", "R3")
    values = [0.0, *(float(tick["v"]) for tick in conflict.play)]
    assert len(values) == ticks + 3
    assert all(v <= 0 for v in values[:-1])
    assert all(abs(v - before) <= 1 for before, v in pairwise(values[:-1]))
    assert values[-1] < 2 or values[-1] - values[-2] > 1


@pytest.mark.slow
def test_what_is_not_remembered_is_left_open() -> None:
    """What the environment keeps of its own numbers is not remembered well enough."""
    named = roles(["t"], ["v"])
    slow = "the op shall always satisfy absReal(t - preReal(0.0, t)) <= 1"
    late = "whenever t >= 2 the sw shall immediately satisfy v < 0 & v > 0"
    found = analyze(
        requirements(late),
        named,
        [requirement("A1", slow)],
        AnalysisOptions(1 if FULL else 0.3, repairs=False),
    )
    assert found.verdict is RealizabilityVerdict.NOT_CHECKED
    assert "only the truth of its comparisons is kept" in found.why


@pytest.mark.slow
def test_conflicts_with_the_past_and_beside_it_are_found() -> None:
    fight = (
        "whenever a the sw shall immediately satisfy v > 3",
        "the sw shall never satisfy v > 2",
    )
    found = analyzed(RATE, *fight, roles=NAMED)
    assert found.verdict is RealizabilityVerdict.UNREALIZABLE
    assert conflicts(found) == [("R1", "R2"), ("R2", "R3")]
    assert found.complete
    assert all(conflict.play for conflict in found.conflicts)


def drawn(seed: int) -> list[str]:
    """A rate, and sentences that ask for a number that is near or far."""
    choose = random.Random(seed)
    rate = choose.choice(["absReal(v - preReal({}, v)) {} {}", "v - preReal({}, v) {} {}"])
    start, most = choose.choice(["0.0", "2.0"]), choose.choice(["1", "1.5"])
    sentences = [
        f"the sw shall always satisfy {rate.format(start, choose.choice(['<=', '<']), most)}"
    ]
    for _ in range(choose.randint(1, 3)):
        condition = choose.choice(["whenever a", "upon a", "upon !a", "whenever t > 2"])
        timing = choose.choice(["immediately", "within 2 ticks", "within 3 ticks", "for 1 tick"])
        bound = choose.choice(["v > 3", "v < 1", "v >= 4", "v <= 0", "v >= 2 & v <= 3", "v > t"])
        sentences.append(f"{condition} the sw shall {timing} satisfy {bound}")
    return sentences


@pytest.mark.slow
def test_plays_follow_their_own_numbers() -> None:
    """Each play breaks something at its last tick, as monitors see the very numbers."""
    shown = 0
    for seed in range(12) if FULL else (0, 3):  # which are answered in no time
        sentences = drawn(seed)
        found = analyze(
            requirements(*sentences), NAMED, (), AnalysisOptions(seconds=5, repairs=False)
        )
        for conflict in found.conflicts:
            if not conflict.play or conflict.loop is not None:
                continue
            shown += any(id == "R1" for id in conflict.requirements)
            kept = [sentences[int(id[1:]) - 1] for id in conflict.requirements]
            machine: Any = load("monitor.py", target.text(*requirements(*kept)))
            verdicts = []
            for tick in conflict.play:
                machine.step(**tick)
                verdicts.append({str(verdict) for verdict in machine.verdicts()})
            *before, last = verdicts
            assert "violated" in last, (sentences, conflict)
            assert not any("violated" in each for each in before), (sentences, conflict)
    assert shown > (1 if FULL else 0)


@pytest.mark.slow
def test_sorting_numbers_out_takes_the_time_of_the_question() -> None:
    many = [f"the sw shall always satisfy v{i} + v{i + 1} > v{i + 2}" for i in range(9)]
    named = roles(["a"], [f"v{i}" for i in range(11)])
    found = analyze(requirements(*many), named, (), AnalysisOptions(seconds=0.02))
    assert found.verdict is RealizabilityVerdict.NOT_CHECKED
    assert found.why == "not answered within 0.02 CPU seconds"


@pytest.mark.slow
def test_what_no_number_before_helps_cannot_be_kept() -> None:
    """Anyone who comes from below 1 by steps of 1 is not above 5 at the next tick."""
    sentences = (
        "the sw shall always satisfy v - preReal(0.0, v) <= 1",
        "whenever !a the sw shall immediately satisfy v < 1",
        "whenever a the sw shall immediately satisfy v > 5",
    )
    found = analyzed(*sentences, roles=NAMED)
    assert found.verdict is RealizabilityVerdict.UNREALIZABLE
    assert conflicts(found) == [("R1", "R3")]  # a may come at the first tick
    later = [each.replace("0.0", "7.0") for each in sentences]
    assert conflicts(analyzed(*later, roles=NAMED)) == [("R1", "R2", "R3")]
