"""Components that are decided by a part of their requirements, against z3 asked by hand."""

import random
from collections.abc import Iterator, Sequence
from itertools import combinations

import pytest
import z3

from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.variables import Numbers, UnsupportedError
from fretc.analysis.arithmetic import cells, groups
from fretc.analysis.arithmetic.atoms import Atoms
from fretc.analysis.arithmetic.group_content import GroupContent
from fretc.analysis.arithmetic.projection import Limit
from fretc.analysis.conflicts import Completeness, conflicts
from fretc.analysis.findings import Conflict, RealizabilityVerdict
from fretc.analysis.realizability_problem import stage
from fretc.analysis.verdicts import verdict
from fretish.bindings.declarations import Role
from tests.effort import FULL
from tests.requirement_sets import requirements, roles

NAMED = roles(["t"], ["v", "w", "on", "off"])
T, V, W = z3.Reals("t v w")
DEMANDS = {
    "v = w": V == W,
    "v = w + t": V == W + T,
    "w = v + 1": W == V + 1,
    "v + w = t": V + W == T,
    "v >= t": V >= T,
    "w <= t - 2": W <= T - 2,
    "v < 3": V < 3,
    "w > 1": W > 1,
}
THRESHOLDS = (
    "the sw shall always satisfy (v > 2 => on) & (v > 4 => on) & (w > 2 => on)",
    "the sw shall always satisfy (w > 4 => off) & (v > 7 => off) & (w > 7 => off)",
)
"""Any numbers keep them, but they have too many patterns together with inputs."""


def can_be_kept(demands: Sequence[str]) -> bool:
    """Whether each input leaves outputs that keep all; nothing is remembered."""
    solver = z3.Solver()
    kept = z3.And([DEMANDS[each] for each in demands])
    solver.add(z3.ForAll([V, W], z3.Not(kept)))
    return bool(solver.check() == z3.unsat)


@pytest.fixture
def few_patterns(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Groups of comparisons with more than a dozen patterns are refused."""
    monkeypatch.setattr(cells, "MOST", 12)
    groups._SORTED.clear()
    yield
    groups._SORTED.clear()


@pytest.mark.slow
@pytest.mark.usefixtures("few_patterns")
def test_what_a_part_decides_is_so_and_its_conflicts_are_minimal() -> None:
    choose = random.Random(2)
    counts = dict.fromkeys(RealizabilityVerdict, 0)
    by_part = shown = 0
    for _ in range(400 if FULL else 5):
        demands = choose.sample([*DEMANDS], choose.randint(2, 4))
        sentences = [f"the sw shall always satisfy {each}" for each in demands]
        setting = stage(requirements(*sentences, *THRESHOLDS), (), NAMED)
        found, there = verdict(setting, Budget(60))
        counts[found.verdict] += 1
        if found.verdict is not RealizabilityVerdict.NOT_CHECKED:
            is_realizable = found.verdict is RealizabilityVerdict.REALIZABLE
            assert is_realizable is can_be_kept(demands), demands
        by_part += "wins against" in found.why
        for conflict in conflicts(there, Budget(60)):
            if isinstance(conflict, Conflict):
                shown += 1
                own = [demands[int(id[1:]) - 1] for id in conflict.requirements]
                assert not can_be_kept(own)
                assert all(map(can_be_kept, combinations(own, len(own) - 1)))
    assert counts[RealizabilityVerdict.UNREALIZABLE], counts
    assert by_part, "some are decided by a part"
    assert shown, "some have a conflict"


@pytest.mark.slow
def test_a_comparison_that_one_of_the_two_games_lacks_leaves_conflicts_open(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The environment wins by a large `t` at both ticks; a game with the system favoured shows it
    only if its comparisons are solved."""
    build = groups.ComparisonGroup.__init__

    def limited(
        self: groups.ComparisonGroup,
        choice: GroupContent,
        atoms: Atoms,
        fresh: Numbers,
        favoured: Role,
        limit: Limit,
    ) -> None:
        if choice.is_mixed and favoured is Role.OUTPUT:
            raise UnsupportedError("have too many patterns")
        build(self, choice, atoms, fresh, favoured, limit)

    monkeypatch.setattr(groups.ComparisonGroup, "__init__", limited)
    sentences = (
        "the sw shall within 1 ticks satisfy absReal(v - preReal(0.0, v)) <= 1",
        "the sw shall always satisfy v >= t",
    )
    found = [*conflicts(stage(requirements(*sentences), (), NAMED), Budget(2))]
    assert found
    assert not any(isinstance(each, Completeness) for each in found)
