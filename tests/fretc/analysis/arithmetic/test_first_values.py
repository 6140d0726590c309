"""Earlier numbers that begin with an output of the first tick, against z3 unrolled by hand."""

import random
from collections.abc import Sequence
from typing import Any

import pytest
import z3

from fretc.analysis.arena.budget import Budget
from fretc.analysis.findings import RealizabilityVerdict
from fretc.analysis.realizability_problem import stage
from fretc.analysis.verdicts import verdict
from tests.effort import FULL
from tests.requirement_sets import analyzed, requirements, roles

NAMED = roles(["t"], ["v"])
RELATIONS = {"<": lambda a, b: a < b, ">=": lambda a, b: a >= b, "!=": lambda a, b: a != b}
FIRSTS = {"v": lambda t, v: v, "v + 1.0": lambda t, v: v + 1, "t": lambda t, v: t,
          "v - t": lambda t, v: v - t}  # fmt: skip
GUARDS = {"": lambda t, v: z3.BoolVal(True), "t > 0 => ": lambda t, v: t > 0,
          "v > 2 => ": lambda t, v: v > 2}  # fmt: skip
TICKS = 3
Demand = tuple[str, str, str, int]


def kept_for(demands: Sequence[Demand], tick: int = 0, before: Any = None) -> Any:
    """Whether the system can keep all for some ticks, whatever the inputs are."""
    if tick == TICKS:
        return z3.BoolVal(True)
    t, v = z3.Real(f"t{tick}"), z3.Real(f"v{tick}")
    now = [
        z3.Implies(
            GUARDS[guard](t, v),
            RELATIONS[relation](v - (FIRSTS[first](t, v) if before is None else before), bound),
        )
        for guard, first, relation, bound in demands
    ]
    return z3.ForAll([t], z3.Exists([v], z3.And(*now, kept_for(demands, tick + 1, v))))


def is_kept(demands: Sequence[Demand]) -> bool:
    solver = z3.Solver()
    solver.add(kept_for(demands))
    answer = solver.check()
    assert answer != z3.unknown
    return bool(answer == z3.sat)


def sentence(demand: Demand) -> str:
    guard, first, relation, bound = demand
    term = f"v - preReal({first}, v) {relation} {bound}"
    return f"the sw shall always satisfy {guard}{term}"


@pytest.mark.slow
def test_the_first_tick_is_as_it_is() -> None:
    choose = random.Random(7)
    counts = dict.fromkeys(RealizabilityVerdict, 0)
    for _ in range(300 if FULL else 8):
        demands = [
            (
                choose.choice([*GUARDS]),
                choose.choice([*FIRSTS]),
                choose.choice([*RELATIONS]),
                choose.randint(-1, 1),
            )
            for _ in range(choose.randint(1, 2))
        ]
        setting = stage(requirements(*map(sentence, demands)), (), NAMED)
        found, _ = verdict(setting, Budget(60 if FULL else 2))
        counts[found.verdict] += 1
        if found.verdict is not RealizabilityVerdict.NOT_CHECKED:
            is_realizable = found.verdict is RealizabilityVerdict.REALIZABLE
            assert is_realizable is is_kept(demands), demands
    assert counts[RealizabilityVerdict.REALIZABLE], counts
    assert counts[RealizabilityVerdict.UNREALIZABLE], counts


@pytest.mark.parametrize(
    ("response", "answer"),
    [
        ("v - preReal(v, v) > 0", "unrealizable"),
        ("v - preReal(v, v) >= 0", "realizable"),
        ("v != preReal(v, v) | t > 0", "unrealizable"),
        ("v != preReal(t, v)", "realizable"),
    ],
)
def test_a_number_that_begins_with_itself_does_not_differ_from_itself(
    response: str, answer: str
) -> None:
    assert analyzed(f"the sw shall always satisfy {response}", roles=NAMED).verdict == answer
