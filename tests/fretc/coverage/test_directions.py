"""What a driver is reported, from the tests of `fretc test`."""

from __future__ import annotations

from typing import Any

from fretc.coverage.coverage import coverage
from fretc.coverage.directions import Way, directions, is_complete, steps, unseen
from fretc.testing import suite as made  # whose names pytest would take for its own
from fretc.testing.suite import GoalResult, GoalStatus, Polarity, Repeat, Suite
from monitors.kernel.verdicts import Verdict
from tests.fretc.audit.results import SHA
from tests.fretc.coverage.evidence import KEYS, evidence, of_run

SENTENCE = "whenever p the sw shall within 3 ticks satisfy speed < 0.5"


def run(name: str, *rows: tuple[int, dict[str, Any]]) -> made.Test:
    repeats = tuple(Repeat(count, values) for count, values in rows)
    verdict = Verdict.SATISFIED
    return made.Test(name, "R1", "", repeats, Polarity.KEPT, verdict, True, None, None, "", (), ())


KEPT = run("kept", (3, {"p": False, "pp": True}), (1, {"p": True, "pp": False}))
BROKEN = run("broken", (2, {"p": True, "pp": True}))


def obligation(key: str, polarity: Polarity, outcome: GoalStatus) -> GoalResult:
    tests = {Polarity.KEPT: ("kept",), Polarity.BROKEN: ("broken",)}[polarity]
    return GoalResult("R1", key, "", polarity, outcome, tests if outcome is GoalStatus.MET else ())


def suite(kept: GoalStatus, broken: GoalStatus, key: str = "late") -> Suite:
    both = (obligation(key, Polarity.KEPT, kept), obligation(key, Polarity.BROKEN, broken))
    tested = made.Tested("R1", SENTENCE, SHA, ())
    return Suite("fretc-tests-1", "1", "100 ms", (tested,), {}, (KEPT, BROKEN), both, ())


def way(kept: GoalStatus, broken: GoalStatus) -> Way | None:
    found = directions(suite(kept, broken), {"R1": SHA})
    return found["R1", "late"].way if found else None


def test_a_run_that_keeps_the_requirement_is_the_first_choice() -> None:
    assert way(GoalStatus.MET, GoalStatus.MET) is Way.KEPT
    assert way(GoalStatus.MET, GoalStatus.NOT_SEARCHED) is Way.KEPT
    assert way(GoalStatus.IMPOSSIBLE, GoalStatus.MET) is Way.BROKEN
    assert way(GoalStatus.EXCLUDED, GoalStatus.MET) is Way.BROKEN
    assert way(GoalStatus.IMPOSSIBLE, GoalStatus.IMPOSSIBLE) is Way.NONE
    assert way(GoalStatus.IMPOSSIBLE, GoalStatus.EXCLUDED) is Way.EXCLUDED


def test_what_was_not_searched_is_not_known() -> None:
    assert way(GoalStatus.NOT_SEARCHED, GoalStatus.MET) is None
    assert way(GoalStatus.IMPOSSIBLE, GoalStatus.NOT_SEARCHED) is None
    assert directions(suite(GoalStatus.MET, GoalStatus.MET), {"R1": "1" * 64}) == {}


def test_steps_tell_what_changes_of_the_names_in_the_sentence() -> None:
    rows: tuple[tuple[int, dict[str, Any]], ...] = (
        (2, {"p": False, "q": True, "speed": 0.25}),
        (1, {"p": False, "q": False, "speed": 0.25}),
        (5, {"p": True, "q": False, "speed": None}),
    )
    test = run("t", *rows)
    expected = "start with `p` false, `speed` 0.25; after 0.3 s `p` true, `speed` unknown"
    assert steps(test, SENTENCE, 10**8) == f"{expected}; after 0.5 s stop"
    assert steps(test, SENTENCE, None).endswith(
        "after 3 ticks `p` true, `speed` unknown; after 5 ticks stop"
    )
    assert steps(test, "the sw shall satisfy r", 10**8) == "start with anything; after 0.8 s stop"


def test_complete_is_what_no_run_could_make_more_complete() -> None:
    covered = coverage(evidence(of_run("a", {key: 1 for key in KEYS if key != "late"})))
    assert not is_complete(covered, {})
    for kept, complete in (
        (GoalStatus.MET, False),
        (GoalStatus.NOT_SEARCHED, False),
        (GoalStatus.IMPOSSIBLE, True),
    ):
        known = directions(suite(kept, GoalStatus.IMPOSSIBLE), {"R1": SHA})
        assert is_complete(covered, known) is complete
        assert [*unseen(covered, known)] == ([] if complete else [("R1", "late")])
    nothing = coverage(evidence(of_run("a", None)))
    assert not is_complete(nothing, {})
