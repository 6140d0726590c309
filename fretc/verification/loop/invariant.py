"""The inductive invariant of the abstraction, which z3 proves for all times."""

from __future__ import annotations

from typing import Any

from fretc.verification.loop.abstraction import (
    ARRIVED,
    NONE,
    StepChoice,
    Times,
    TwinState,
    begins,
    relation,
)

_QUERY = 20_000
"""Milliseconds for each query of z3."""


def unproved(declared: Times) -> tuple[str | None, str]:
    """Why the invariant is not proved, None if it is; and z3's version.

    Args:
        declared: only `cells` and `heartbeat` count; the others are unknowns for z3.
    """
    import z3

    class Terms:
        """Terms of z3."""

        def both(self, *parts: Any) -> Any:
            return z3.And(*parts)

        def either(self, *parts: Any) -> Any:
            return z3.Or(*parts)

        def no(self, part: Any) -> Any:
            return z3.Not(part)

    logic = Terms()
    cells, beat = declared.cells, declared.heartbeat
    times = Times(cells, beat, *z3.Ints("latency lost braking"))
    bound, some = z3.Ints("D n")
    now, then = (TwinState(*z3.Ints(f"e{i} a{i} w{i} z{i} r{i} s{i}")) for i in (0, 1))
    stands, sent, lost = z3.Bools("stands is_sent is_lost")
    choice = StepChoice(stands, sent, lost, z3.Int("cell"))
    enough = cells * bound >= cells * beat * times.lost + times.latency + times.braking
    premises = z3.And(
        times.latency >= 0, times.lost >= 0, times.braking >= 0, bound > beat * times.lost, enough
    )
    here, there = (_invariant(numbers, times, bound, logic) for numbers in (now, then))
    queries = {
        "it does not hold initially": z3.And(begins(now, times, logic), z3.Not(here)),
        "a step does not preserve it": z3.And(
            here, relation(now, then, choice, times, logic), z3.Not(there)
        ),
        "it does not imply the bound": z3.And(here, some >= bound, now.open >= some),
    }
    for failure, query in queries.items():
        solver = z3.Solver()
        solver.set("timeout", _QUERY)
        solver.add(premises, query)
        verdict = solver.check()
        if verdict != z3.unsat:
            reason = "z3 gives no answer in time" if verdict == z3.unknown else failure
            return f"of the invariant: {reason}", z3.get_version_string()
    return None, z3.get_version_string()


def _invariant(at: TwinState, times: Times, bound: Any, logic: Any) -> Any:
    """The invariant at the end of each tick: why a response comes in time.

    At most `lost` requests of a stop are lost in a row; the first other one is in flight for less
    than the latency; from its arrival on, the wheels have zero. An open obligation is no older than
    its request.
    """
    k, beat, both, either = times.cells, times.heartbeat, logic.both, logic.either
    passed, tried = k * (at.open + 1), k * beat * times.lost
    in_time = at.open + 1 <= (at.losses - 1) * beat + at.silent
    lost = both(at.age == NONE, at.losses >= 1, at.silent >= 1, in_time)
    flying = both(at.age >= k, at.age < times.latency, passed - at.age <= tried)
    since = passed - tried - times.latency + 1
    still = either(at.still >= times.braking + 1, at.still >= since)
    arrival = both(at.age == ARRIVED, at.still >= 1, still)
    released = both(at.requested == 0, at.open == -1, at.age == NONE)
    request = both(at.requested == 1, at.open >= -1, at.open < bound, either(lost, flying, arrival))
    ranges = both(
        *(at.losses >= 0, at.losses <= times.lost, at.silent >= 0, at.silent <= beat),
        *(at.still >= -1, at.still <= times.braking + 1),
    )
    return both(ranges, either(released, request))
