"""The closed loop over the texts: what it keeps, and the runs by which it does not."""

from dataclasses import replace

import pytest

from compiler.logic import formula as f
from compiler.logic.claims import ClaimOutcome, ClaimResult, not_checked, vacuous
from compiler.logic.spot import ABSENT
from fretc.verification.loop.actuation_model import ActuationAssumptions
from fretc.verification.loop.search import is_safety, search
from monitors.interceptor import Options
from tests.each import each
from tests.effort import some
from tests.loops import (
    CORE,
    EVENTUALLY,
    LATCH,
    TIMER,
    WITHIN,
    case,
    edited,
    interceptor_options,
    with_safety,
)
from tests.monitoring import with_step, without_step

EDGE = ActuationAssumptions(1, edge=True)


def trace(outcome: ClaimOutcome) -> list[str]:
    """The rows of a run as digits, each with what happened."""
    assert outcome.result is ClaimResult.COUNTEREXAMPLE
    assert outcome.trace is not None
    rows = ["".join("-" if v is None else str(int(v)) for v in row) for row in outcome.trace.rows]
    return [f"{row} {action}" for row, action in zip(rows, outcome.trace.actions, strict=True)]


# The loops of the paper and their fixes -------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("settings", "channel", "kept", "released"),
    [
        (LATCH, ActuationAssumptions(1, edge=True), "counterexample", "counterexample"),
        (LATCH, ActuationAssumptions(1, edge=True, punctual=True), "proved", "counterexample"),
        (TIMER, ActuationAssumptions(1), "proved", "proved"),
        (TIMER, ActuationAssumptions(1, lost=2), "counterexample", "proved"),
        (TIMER, ActuationAssumptions(1, lost=2, edge=True), "counterexample", "counterexample"),
    ],
    ids=["the paper's", "with a busy planner", "timer", "lossy", "lossy and on change only"],
)
def test_what_each_loop_keeps_within_two_ticks(
    settings: Options, channel: ActuationAssumptions, kept: str, released: str
) -> None:
    results = search(case(WITHIN.format(2), settings, channel))
    assert (results.kept.result, results.released.result) == (kept, released)


@pytest.mark.slow
def test_without_spot_only_finite_runs_are_searched(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compiler.logic.spot.is_installed", lambda: False)
    bounded = search(case(WITHIN.format(2)))
    assert bounded.kept.result is ClaimResult.PROVED
    assert bounded.released == not_checked(ABSENT)
    endless = search(case(EVENTUALLY))
    assert endless.kept == not_checked(f"no finite run violates it; for endless ones {ABSENT}")


def test_without_a_bound_only_what_is_sent_once_is_lost() -> None:
    results = {
        lost: search(
            case(EVENTUALLY, TIMER, ActuationAssumptions(1, lost=2, edge=edge))
        ).kept.result
        for lost, edge in (("level", False), ("edge", True))
    }
    assert results == {"level": "proved", "edge": "counterexample"}


@pytest.mark.slow
def test_a_heartbeat_repairs_what_is_lost_on_change_only() -> None:
    """Two messages may be lost, three ticks apart: after six ticks the third one is heard."""
    lossy = ActuationAssumptions(1, lost=2, edge=True, heartbeat=3)
    results = {n: search(case(WITHIN.format(n), TIMER, lossy)) for n in (6, 7)}
    assert (results[6].kept.result, results[7].kept.result) == ("counterexample", "proved")
    assert results[7].released.result == "proved"
    assert search(case(EVENTUALLY, TIMER, lossy)).kept.result == "proved"
    assert trace(results[6].kept)[1:] == [
        "101-01 a stop is requested, and the message is lost",
        "001-01 a stop is requested, and no message is sent",
        "001-01 a stop is requested, and no message is sent",
        "001-01 a stop is requested, and the message is sent again, and lost",
        "001-01 a stop is requested, and no message is sent",
        "001-01 a stop is requested, and no message is sent",
        "001110 a stop is requested, and the message is sent again; `true` is received",
    ]


@pytest.mark.parametrize(("timeout", "released"), [(6, "counterexample"), (7, "proved")])
def test_a_watchdog_lets_go_where_the_heartbeat_is_faster(timeout: int, released: str) -> None:
    """Two cells to a tick: three ticks of silence, and no more."""
    beating = ActuationAssumptions(2, edge=True, heartbeat=3)
    results = search(case(WITHIN.format(3), interceptor_options(stop_timeout=timeout), beating))
    assert (results.kept.result, results.released.result) == ("proved", released)


def test_a_heartbeat_of_one_tick_speaks_at_every_tick() -> None:
    traces = {
        search(case(WITHIN.format(3), TIMER, channel)).kept
        for channel in (
            ActuationAssumptions(1, lost=2),
            ActuationAssumptions(1, lost=2, edge=True, heartbeat=1),
        )
    }
    (result,) = {one.result for one in traces}
    assert result == "proved"


def test_the_latch_of_the_paper_lets_the_wheels_turn_where_the_planner_falls_silent() -> None:
    results = search(case(WITHIN.format(2), LATCH, EDGE))
    assert trace(results.kept) == [
        "010-01 no stop is requested; a command to move is received",
        "101111 a stop is requested, and the message is sent; `true` is received",
        "001-11 a stop is requested, and no message is sent",
        "001-11 a stop is requested, and no message is sent",
    ]


def test_without_a_bound_that_run_has_no_end() -> None:
    kept = search(case(EVENTUALLY, LATCH, EDGE)).kept
    assert trace(kept) == [
        "010-01 no stop is requested; a command to move is received",
        "101111 a stop is requested, and the message is sent; `true` is received",
        "001-11 a stop is requested, and no message is sent",
    ]
    assert kept.result is ClaimResult.COUNTEREXAMPLE
    assert kept.trace is not None
    assert (kept.trace.names, kept.trace.cycle) == (
        ("near", "stopped", "request", "delivered", "halt", "wheels"),
        2,
    )


def test_a_loop_that_loses_two_messages_keeps_a_bound_of_three() -> None:
    lossy = ActuationAssumptions(1, lost=2)
    results = {n: search(case(WITHIN.format(n), TIMER, lossy)).kept.result for n in (2, 3)}
    assert results == {2: "counterexample", 3: "proved"}
    assert trace(search(case(WITHIN.format(2), TIMER, lossy)).kept)[1:] == [
        "101-01 a stop is requested, and the message is lost",
        "001-01 a stop is requested, and the message is lost",
        "001110 a stop is requested, and the message is sent; `true` is received",
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("channel", "least"),
    some(
        [
            (ActuationAssumptions(2, latency=2, lost=1, braking=4), 4),
            (ActuationAssumptions(2, latency=2, braking=4), 3),
            (ActuationAssumptions(2, latency=1, braking=1), 1),
            (ActuationAssumptions(2, latency=2, braking=1), 2),
        ],
        2,
    ),
)
def test_latency_losses_and_braking_add_up(channel: ActuationAssumptions, least: int) -> None:
    settings = interceptor_options(hold=4, stop_timeout=24)
    kept = search(case(WITHIN.format(least), settings, channel)).kept.result
    short = "immediately" if least == 1 else f"within {least - 1} ticks"
    sentence = f"whenever near the sw shall {short} satisfy stopped"
    assert (kept, search(case(sentence, settings, channel)).kept.result) == (
        "proved",
        "counterexample",
    )


def test_a_robot_may_stand_earlier_than_it_must() -> None:
    """Else nobody could refute that it moves on for three ticks after the trigger."""
    sentence = "upon near the sw shall after 3 ticks satisfy stopped"
    results = search(case(sentence, TIMER, ActuationAssumptions(1, braking=3)))
    assert results.kept.result == "counterexample"


def test_a_watchdog_stops_a_robot_for_good_where_silence_is_normal() -> None:
    results = search(case(WITHIN.format(2), interceptor_options(stop_timeout=3), EDGE))
    assert (results.kept.result, results.released.result) == ("proved", "counterexample")


# Texts that are wrong -------------------------------------------------------------------------


FORWARDS = "return after, ZERO if halted(after, options) else command"
SCANNED = "return replace(state, scan_age=0), None"
KEEPS = "command=command, command_age=0"
LOOKS = "it reads the content of a command: a proof with one command would not hold for all"
UNREADABLE = "fretc cannot read its core"


def test_an_interceptor_that_forwards_while_it_is_stopped_is_refuted() -> None:
    wrong = edited(CORE, FORWARDS, "return after, command")
    kept = search(case(WITHIN.format(2), core=wrong)).kept
    assert kept.result == "counterexample"
    assert "`true` is received" in trace(kept)[1]


def test_a_safety_function_that_is_a_tick_late_is_refuted() -> None:
    """The observer is the monitor that fretc makes, not the one that is late."""
    known = case(WITHIN.format(2), TIMER, ActuationAssumptions(1, lost=1))
    assert search(known).kept.result is ClaimResult.PROVED
    signals = "self.r1_signals = (near, since_1, False, since_2, "
    late = edited(known.safety, signals, "self.r1_signals = (False, since_1, False, since_1, ")
    assert search(with_safety(known, with_step(late))).kept.result == "counterexample"


@pytest.mark.slow
@each(
    "fault",
    [
        (FORWARDS, "return after, ZERO if command.vx > 1 else command", LOOKS),
        (SCANNED, f"print(state)\n    {SCANNED}", f"{UNREADABLE}: `print(state)`"),
        (
            SCANNED,
            f"{SCANNED[:-4]}Velocity(1.0)",
            "it publishes a velocity that it has not received",
        ),
        (
            SCANNED,
            "after = replace(state, command=ZERO)\n    return (after, ZERO) if after == state "
            "else (state, None)",
            LOOKS,
        ),
        (FORWARDS, "return (after, None) if after == state else (after, command)", LOOKS),
        (SCANNED, "return state.command", "a step returns no state and command"),
        (KEEPS, f"stop=command, {KEEPS}", LOOKS),
        (KEEPS, f"held=command, {KEEPS}", LOOKS),
        ("def halted(", "def stopped(", "its core has no `halted`"),
        ("ZERO = Velocity()", "ZERO = Velocity(1.0)", f"{UNREADABLE}: `ZERO = Velocity(1.0)`"),
    ],
)
def test_what_is_no_pure_interceptor_is_not_checked(fault: tuple[str, str, str]) -> None:
    old, new, reason = fault
    results = search(
        case(
            WITHIN.format(2),
            channel=ActuationAssumptions(1, scans=True),
            core=edited(CORE, old, new),
        )
    )
    assert results.kept == results.released == not_checked(reason)


def test_an_interceptor_whose_numbers_grow_for_ever_is_not_checked() -> None:
    grows = edited(CORE, SCANNED, "return replace(state, scan_age=state.scan_age + 1), None")
    known = case(WITHIN.format(2), channel=ActuationAssumptions(1, scans=True), core=grows)
    reason = "its State takes more than 500 values"
    assert search(replace(known, limit=500)).kept == not_checked(reason)


# Vacuity and limits ---------------------------------------------------------------------------


def test_a_demand_that_never_begins_is_vacuous() -> None:
    results = search(case("whenever near & !near the sw shall within 2 ticks satisfy stopped"))
    assert results.kept.result is ClaimResult.VACUOUS
    assert results.kept.detail.startswith("no demand ever begins")


def test_a_robot_that_never_moves_is_vacuous() -> None:
    frozen = edited(CORE, "        stop=False,\n", "        stop=True,\n")
    results = search(case(WITHIN.format(2), interceptor_options(latching=True), core=frozen))
    assert results.kept.result is ClaimResult.VACUOUS
    assert results.kept.detail.startswith("the robot never moves")


def test_a_stop_that_is_never_in_force_is_vacuous() -> None:
    deaf = edited(CORE, "stop=requested or", "stop=False and requested or")
    results = search(case(WITHIN.format(2), core=deaf))
    assert results.released == vacuous("no stop is ever in force")


def test_too_many_states_are_not_checked() -> None:
    known = replace(case(WITHIN.format(2), TIMER, ActuationAssumptions(1, lost=2)), limit=3)
    assert search(known).kept == not_checked("more than 3 states")


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        (f.globally(f.eventually(f.Atom("p"))), False),
        (f.globally(f.eventually(f.Atom("p"), f.Interval(0, 3))), True),
        (f.not_(f.eventually(f.Atom("p"))), True),
        (f.until(f.Atom("p"), f.Atom("q")), False),
        (f.release(f.Atom("p"), f.Atom("q")), True),
        (f.implies(f.globally(f.Atom("p")), f.Atom("q")), False),
    ],
)
def test_what_finite_runs_can_refute(formula: f.Formula, expected: bool) -> None:
    assert is_safety(formula) == expected


HALTED = """\
def halted(state: State, options: Options) -> bool:
    return 0 > 1


def kept_back(state: State, options: Options) -> bool:"""


@pytest.mark.slow
def test_what_a_core_says_of_itself_does_not_release_a_stop() -> None:
    """Its `halted` says no, and its steps go by another function."""
    lying = CORE.replace("halted(", "kept_back(")
    lying = edited(lying, "def kept_back(state: State, options: Options) -> bool:", HALTED)
    for settings, channel in ((LATCH, EDGE), (TIMER, ActuationAssumptions(1, lost=2, edge=True))):
        known = case(WITHIN.format(9), settings, channel)
        assert search(known).released.result == "counterexample"
        assert search(replace(known, interceptor=lying)).released.result == "counterexample"


@pytest.mark.parametrize(
    ("cell", "first", "step", "ignored"),
    [
        ("w_1", "Window(60, 3)", "far = w_1.step(True, near)", "far"),
        ("x_broken", "-1", "x_broken = x_broken + 1 if near else x_broken", "x_broken > 5"),
        (
            "x_violation_inevitable",
            "-1",
            "x_violation_inevitable = x_violation_inevitable + near",
            "x_violation_inevitable > 5",
        ),
    ],
)
def test_a_safety_function_that_remembers_more_than_is_put_back_is_not_stepped(
    cell: str, first: str, step: str, ignored: str
) -> None:
    known = case(WITHIN.format(3))
    text = without_step(known.safety)
    for old, new in (
        ('        "is_possible",\n', f'        "is_possible",\n        "{cell}",\n'),
        ('        "oldest_1",\n    )', f'        "oldest_1",\n        "{cell}",\n    )'),
        (
            "        self.oldest_1 = -1\n",
            f"        self.oldest_1 = -1\n        self.{cell} = {first}\n",
        ),
        ("= self.oldest_1\n", f"= self.oldest_1\n        {cell} = self.{cell}\n"),
        ("self.oldest_1 = oldest_1\n", f"self.oldest_1 = oldest_1\n        self.{cell} = {cell}\n"),
        (
            "            if oldest_1 >= 0 and",
            f"            {step}\n            if oldest_1 >= 0 and",
        ),
        ("elif near and not_stopped:", f"elif near and not_stopped and not ({ignored}):"),
    ):
        text = edited(text, old, new)
    kept = search(with_safety(known, with_step(text))).kept
    assert kept.result is ClaimResult.NOT_CHECKED
    assert "it is not laid out as fretc writes it" in kept.detail
