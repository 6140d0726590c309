"""How long an answer takes at most: proved for all times, least under the declared ones."""

from dataclasses import replace

import pytest

from compiler.logic.claims import ClaimResult, not_checked, proved
from fretc.verification.loop import abstraction as looptwin
from fretc.verification.loop import invariant
from fretc.verification.loop.abstraction import Plain, Times, TwinState, covered
from fretc.verification.loop.actuation_model import ActuationAssumptions
from fretc.verification.loop.bounds import BoundsResult, Question, search
from fretc.verification.loop.model import Loop
from fretc.verification.loop.search import Parts
from monitors.interceptor import Options
from tests.effort import FULL, some
from tests.loops import CORE, EVENTUALLY, WITHIN, case, edited, interceptor_options
from tests.monitoring import requirement

HUNDRED_MS = 10**8
USUAL = interceptor_options(hold=4, stop_timeout=24)
DECLARED = ActuationAssumptions(2, latency=2, lost=1, braking=4)


def question(
    sentence: str,
    settings: Options = USUAL,
    channel: ActuationAssumptions = DECLARED,
    core: str = CORE,
) -> Question:
    parsed = requirement(sentence)
    return Question(
        case(sentence, settings, channel, core), parsed.sentence, parsed.ticks, HUNDRED_MS
    )


@pytest.mark.slow
def test_a_bound_that_is_long_enough() -> None:
    answer = search(question(WITHIN.format(4)))
    assert answer.answered.result is ClaimResult.PROVED
    assert answer.answered.detail.startswith("by an inductive invariant; ")
    assert answer.enough == proved(
        "the smallest satisfied bound is 4 ticks (400 ms); with one tick less a run of 5 ticks "
        "violates it"
    )


@pytest.mark.slow
def test_a_bound_that_is_a_tick_too_short_is_shown_by_a_run() -> None:
    answer = search(question(WITHIN.format(3)))
    assert answer.answered.result is ClaimResult.PROVED, "the law holds all the same"
    assert answer.enough.result is ClaimResult.COUNTEREXAMPLE
    assert answer.enough.detail == "the smallest satisfied bound is 4 ticks (400 ms)"
    assert answer.enough.trace is not None
    assert len(answer.enough.trace.rows) == 5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("channel", "least"),
    some(
        [
            (ActuationAssumptions(1), 1),
            (ActuationAssumptions(1, lost=2), 3),
            (ActuationAssumptions(3, latency=4, lost=1, braking=3), 4),
            (ActuationAssumptions(1, lost=2, edge=True, heartbeat=3), 7),
            (ActuationAssumptions(2, latency=3, lost=1, braking=2, edge=True, heartbeat=2), 5),
            (ActuationAssumptions(2, latency=1, braking=2, edge=True, heartbeat=4), 2),
            (DECLARED, 4),
        ],
        3,
    )[-2:],
)
def test_the_least_bound_is_the_one_that_is_proved(
    channel: ActuationAssumptions, least: int
) -> None:
    answer = search(question(EVENTUALLY, interceptor_options(), channel))
    plural = "" if least == 1 else "s"
    assert answer.enough == proved(
        f"the smallest satisfied bound is {least} tick{plural} ({least * 100} ms)"
    )


@pytest.mark.slow
def test_a_loop_that_does_something_else_is_not_checked() -> None:
    wrong = edited(
        CORE, "return after, ZERO if halted(after, options) else command", "return after, command"
    )
    reason = not_checked("the loop has a step that its integer model does not have")
    assert search(question(WITHIN.format(4), core=wrong)) == BoundsResult(reason, reason)


FORGETS = (
    ("    command_age: int\n\n", "    command_age: int\n    quiet: int = 0\n\n"),
    ("        stop_age=0,\n", "        stop_age=0,\n        quiet=0,\n"),
    ("        state.stop\n        or", "        (state.stop and state.quiet < 10)\n        or"),
    (
        "        state,\n        stop_age=min(",
        "        state,\n        quiet=min(state.quiet + 1, 10),\n        stop_age=min(",
    ),
)


@pytest.mark.slow
def test_small_times_say_nothing_of_long_ones_where_the_core_is_another() -> None:
    """It forgets a stop after 10 ticks without a message: as many lost ones are too many for it."""
    core = CORE
    for old, new in FORGETS:
        core = edited(core, old, new)
    small = search(question(WITHIN.format(4), interceptor_options(hold=1), core=core))
    assert small.enough.result is ClaimResult.PROVED, (
        "under the declared times it is as good as any"
    )
    assert small.answered.result is ClaimResult.NOT_CHECKED
    assert small.answered.detail.startswith("the interceptor's core is not the one that fretc")
    large = (
        ActuationAssumptions(1, latency=2, lost=14, braking=4)
        if FULL
        else ActuationAssumptions(1, lost=10)
    )
    answer = search(question(EVENTUALLY, interceptor_options(hold=1), large, core))
    assert answer.enough.result is not ClaimResult.PROVED


def test_a_twin_that_promises_too_much_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compared with the loop with one lost message less than there is."""
    loop = Parts.of(
        case(WITHIN.format(9), interceptor_options(), ActuationAssumptions(1, lost=2))
    ).loop
    assert covered(loop, 10**5, 9).uncovered is None
    loop.channel = replace(loop.channel, lost=1)
    monkeypatch.setattr(Loop, "_fates", lambda *_: [(True, 0), (False, 2)])
    uncovered = covered(loop, 10**5, 9).uncovered
    assert uncovered is not None
    assert uncovered[1].losses == 2


def test_a_twin_whose_heart_beats_too_fast_is_found() -> None:
    loop = Parts.of(
        case(
            WITHIN.format(9),
            interceptor_options(),
            ActuationAssumptions(1, lost=1, edge=True, heartbeat=3),
        )
    ).loop
    assert covered(loop, 10**5, 9).uncovered is None
    right = looptwin.times_of
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(looptwin, "times_of", lambda known: right(known)._replace(heartbeat=2))
        uncovered = covered(loop, 10**5, 9).uncovered
    assert uncovered is not None
    assert (uncovered[0].silent, uncovered[1].silent) == (2, 3)


@pytest.mark.slow
def test_an_invariant_that_is_too_strong_is_not_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    def too_strong(at: TwinState, times: Times, bound: object, logic: Plain) -> object:
        return logic.both(real(at, times, bound, logic), at.open <= 0)

    real = invariant._invariant
    monkeypatch.setattr(invariant, "_invariant", too_strong)
    answer = search(question(EVENTUALLY, interceptor_options(), ActuationAssumptions(1)))
    assert answer.answered == not_checked("of the invariant: a step does not preserve it")
