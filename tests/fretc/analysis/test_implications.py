"""What requirements say of one another, against Spot's automata of their formulas."""

from collections.abc import Iterable, Sequence
from itertools import combinations
from typing import Any

import pytest
import spot

from compiler.logic import printing
from fretc.analysis.arena.budget import Budget
from fretc.analysis.findings import Analysis, Inconsistency
from fretc.analysis.games.squaring import IterativeSquaring
from fretc.analysis.implications import inconsistencies
from tests.effort import FULL, some
from tests.requirement_sets import analyzed, drawn, requirements, staged, terse

SETS = range(50) if FULL else range(33, 48)


def formulas(sentences: Sequence[str]) -> dict[str, str]:
    """The future-time formula of each, by its id."""
    return {
        requirement.id: f"({printing.future(requirement.ft_infinite)})"
        for requirement in requirements(*sentences)
    }


def possible(parts: Iterable[str]) -> bool:
    return not spot.translate(" & ".join(parts) or "1").is_empty()


def implies(parts: Iterable[str], other: str) -> bool:
    return not possible([*parts, f"!{other}"])


def assert_implications(sentences: Sequence[str], found: Analysis) -> None:
    known = formulas(sentences)
    assert found.consistent is possible(known.values())
    assert set(found.never) == {id for id, each in known.items() if not possible([each])}
    assert set(found.always) == {id for id, each in known.items() if implies([], each)}
    by = {each.requirement: each.by for each in found.redundant}
    if not found.consistent:
        return
    for id, formula in known.items():
        others = [other for other in known if other != id]
        assert (id in by) is implies([known[other] for other in others], formula), (sentences, id)
    for id, least in by.items():
        assert implies([known[other] for other in least], known[id])
        for fewer in combinations(least, len(least) - 1) if least else ():
            assert not implies([known[other] for other in fewer], known[id])
    left = [known[id] for id in known if id not in found.removable]
    assert all(implies(left, known[id]) for id in found.removable)
    for id in by.keys() - set(found.removable):
        rest = [known[other] for other in known if other not in (*found.removable, id)]
        assert not implies(rest, known[id]), "it could go, too"


@pytest.mark.slow
def test_consistency_and_redundancy_are_spot_s() -> None:
    redundant = inconsistent = 0
    for seed in SETS:
        sentences = (terse if seed % 2 else drawn)(("say", seed), most=4)
        found = analyzed(*sentences)
        assert_implications(sentences, found)
        redundant += any(each.by for each in found.redundant)
        inconsistent += found.consistent is False
    assert redundant > len(SETS) / 20
    assert inconsistent > 0 or not FULL


@pytest.mark.slow
def test_a_trigger_is_excluded_where_spot_says_so() -> None:
    excluded = 0
    for seed in SETS:
        others = (terse if seed % 2 else drawn)(("never", seed), most=2)
        for p in some(("a", "!a & x", "x & y"), 3, seed % 3):
            found = analyzed(*others, f"whenever {p} the sw shall eventually satisfy x | b")
            known = [*formulas(others).values()]
            id = f"R{len(others) + 1}"
            mine = [each for each in found.vacuous if each.requirement == id]
            never = possible(known) and not possible([*known, f"F({p})"])
            assert bool(mine) is never, (others, p)
            excluded += never
            for each in mine:
                assert each.what == "trigger"
                chosen = [formulas(others)[other] for other in each.by]
                assert not possible([*chosen, f"F({p})"])
    assert excluded > 0


def clash(parts: Sequence[str]) -> int | None:
    """The least number of ticks to where all parts can go on, and not together."""
    if not all(possible([part]) for part in parts):
        return None
    if not possible(parts):
        return 0
    together = safe_transitions(" & ".join(parts))
    product = spot.complete(together)
    sink = product.num_states() - 1 if product.num_states() > together.num_states() else None
    if sink is None:
        return None
    return _depth([safe_transitions(part) for part in parts], product, sink)


def safe_transitions(formula: str) -> Any:
    """A deterministic automaton that takes the words that some endless one begins with.

    Not Spot's own monitors: of `(y -> F !x) & G(x -> X x)` one takes `x & y`.
    """
    automaton = spot.scc_filter(spot.translate(formula, "parity", "det"))
    automaton.purge_dead_states()
    taken = spot.make_twa_graph(automaton, spot.twa_prop_set())  # without what was known of it
    taken.set_acceptance(0, "t")
    return taken


def _depth(alone: Sequence[Any], together: Any, sink: int) -> int | None:
    walk = together
    for automaton in alone:
        walk = spot.product(walk, automaton)
    start = walk.get_init_state_number()
    origin = _origins(walk, together, alone)
    depth, level, seen = 0, {start}, {start}
    while level:
        if any(origin[state] == sink for state in level):
            return depth
        level = {edge.dst for state in level for edge in walk.out(state)} - seen
        seen |= level
        depth += 1
    return None


def _origins(walk: Any, together: Any, alone: Sequence[Any]) -> dict[int, int]:
    """The state of `together` in each state of the product."""
    chain = [together]
    for automaton in alone:
        chain.append(spot.product(chain[-1], automaton))
    origin = {state: state for state in range(together.num_states())}
    for product in chain[1:]:
        pairs = product.get_product_states()
        origin = {state: origin[pairs[state][0]] for state in range(product.num_states())}
    return origin


@pytest.mark.slow
def test_pairs_clash_where_spot_s_automata_part() -> None:
    clashes = 0
    for seed in SETS:
        sentences = (terse if seed % 2 else drawn)(("clash", seed), most=3)
        found = {each.requirements: len(each.play) for each in analyzed(*sentences).inconsistent}
        known = formulas(sentences)
        for pair in combinations(known, 2):
            expected = clash([known[id] for id in pair])
            assert found.get(pair) == expected, (sentences, pair)
            clashes += expected is not None
    assert clashes > 1


def test_long_counts_are_compared_bit_by_bit() -> None:
    """One after the other, these two counters would take a hundred times as long."""
    setting = staged(
        "whenever a the sw shall within 900 ticks satisfy x",
        "whenever b the sw shall for 901 ticks satisfy !x",
    )
    (found,) = inconsistencies(setting, Budget(10))
    assert isinstance(found, Inconsistency)
    assert found.requirements == ("R1", "R2")
    assert found.play == ({"a": True, "b": True, "x": False},)


def test_what_goes_together_is_named_apart_from_what_goes_alone() -> None:
    same = "whenever a the sw shall immediately satisfy x"
    found = analyzed(same, same, "whenever a & b the sw shall immediately satisfy x")
    assert [(each.requirement, each.by) for each in found.redundant] == [
        ("R1", ("R2",)), ("R2", ("R1",)), ("R3", ("R1",)),
    ]  # fmt: skip
    assert found.removable == ("R1", "R3")


def test_a_scope_that_never_is_is_told_with_what_excludes_it() -> None:
    found = analyzed(
        "the sw shall never satisfy y",
        "whenever a the sw shall immediately satisfy x",
        "while y the sw shall always satisfy x",
        "whenever x & !x the sw shall immediately satisfy y",
    )
    assert [(each.requirement, each.by, each.what) for each in found.vacuous] == [
        ("R3", ("R1",), "scope"), ("R4", (), "trigger"),
    ]  # fmt: skip


@pytest.mark.slow
def test_leaps_over_many_ticks_change_no_finding(monkeypatch: pytest.MonkeyPatch) -> None:
    for seed in SETS:
        sentences = (terse if seed % 2 else drawn)(("leaps", seed), most=3)
        before = analyzed(*sentences)
        with monkeypatch.context() as patched:
            patched.setattr(IterativeSquaring, "is_due", lambda self: True)
            after = analyzed(*sentences)
        for name in ("consistent", "always", "never", "redundant", "removable", "vacuous"):
            assert getattr(after, name) == getattr(before, name), (name, sentences)
        shown = [[each.requirements for each in found.inconsistent] for found in (before, after)]
        assert shown[0] == shown[1], sentences
