"""The drive computes each passage once, also for loops that share it."""

from fretc.verification.loop.actuation_model import ActuationAssumptions
from fretc.verification.loop.search import Parts, new_drive, reach
from tests.loops import EVENTUALLY, WITHIN, case, interceptor_options

CHANNEL = ActuationAssumptions(2, latency=2, lost=1, braking=1)
SETTINGS = interceptor_options(hold=1)


def test_a_state_is_one_object() -> None:
    drive = new_drive(case(EVENTUALLY, SETTINGS, CHANNEL))
    first = drive.initial
    assert drive.wheels(first.interceptor, first.still, first.queue) is first
    assert all(
        drive.wheels(each.interceptor, each.still, each.queue) is each
        for each in drive.passages(first)
    )


def test_loops_that_share_a_drive_are_explored_alike_and_it_computes_no_passage_again() -> None:
    drive = new_drive(case(EVENTUALLY, SETTINGS, CHANNEL))
    loops = [Parts.of(case(EVENTUALLY, SETTINGS, CHANNEL), drive).loop for _ in range(2)]
    before = reach(loops[0], 10**5)
    passages = drive.passages(drive.initial)
    assert reach(loops[1], 10**5) == before
    assert drive.passages(drive.initial) is passages


def test_a_shared_drive_changes_no_run() -> None:
    short = case(WITHIN.format(1), SETTINGS, CHANNEL)
    drive = new_drive(short)
    reach(Parts.of(case(EVENTUALLY, SETTINGS, CHANNEL), drive).loop, 10**5)
    alone, shared = (reach(Parts.of(short, each).loop, 10**5) for each in (None, drive))
    assert alone.violation is not None
    assert shared.violation is not None
    assert [tick for tick, _ in shared.violation] == [tick for tick, _ in alone.violation]
    assert (shared.states, shared.steps) == (alone.states, alone.steps)
