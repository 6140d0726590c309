"""All minimal conflicts of some requirements.

Source: Liffiton, Previti, Malik, Marques-Silva, Fast, flexible MUS enumeration, Constraints 21
(2016): a map of the undecided sets, here a decision diagram; each seed grows or shrinks to a
border, and all sets beyond the border are removed from the map.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations

from compiler.logic.diagrams import decision_diagrams as bdd

MOST_PAIRS = 2_000
"""Maximum number of pairs that are tried first."""
Members = frozenset[int]


def cores(
    size: int,
    is_conflict: Callable[[Members], bool],
    near: Callable[[int, int], bool],
    smaller: Callable[[Members], Members] = lambda members: members,
) -> Iterator[Members]:
    """Each minimal set with a conflict, as soon as it is found.

    Args:
        size: the members are 0..size-1.
        is_conflict: monotone: every superset of a conflict is one.
        near: whether two members may conflict by themselves; these are tried first.
        smaller: a conflict within a conflict, if one is known.
    """
    open_sets = bdd.true()
    for found in _small(size, is_conflict, near):
        yield found
        open_sets = open_sets - bdd.point(dict.fromkeys(found, True))
    while open_sets != bdd.false():
        seed = _largest(open_sets, size)
        if is_conflict(seed):
            core = _shrunk(smaller(seed), size, open_sets, is_conflict)
            yield core
            open_sets = open_sets - bdd.point(dict.fromkeys(core, True))
        else:
            rest = set(range(size)) - seed
            open_sets = open_sets - bdd.point(dict.fromkeys(rest, False))


def _small(
    size: int, is_conflict: Callable[[Members], bool], near: Callable[[int, int], bool]
) -> Iterator[Members]:
    """Single members, and pairs of others."""
    alone = [frozenset({i}) for i in range(size) if is_conflict(frozenset({i}))]
    yield from alone
    fit = [i for i in range(size) if frozenset({i}) not in alone]
    if len(fit) * (len(fit) - 1) // 2 > MOST_PAIRS:
        return
    for i, j in combinations(fit, 2):
        if near(i, j) and is_conflict(frozenset({i, j})):
            yield frozenset({i, j})


def _largest(open_sets: bdd.Function, size: int) -> Members:
    """A maximal set on the map: every superset contains a known conflict."""
    values = bdd.witness(open_sets, prefer=True)
    return frozenset(i for i in range(size) if values.get(i, True))


def _shrunk(
    members: Members,
    size: int,
    open_sets: bdd.Function,
    is_conflict: Callable[[Members], bool],
) -> Members:
    """A minimal conflict within a conflict; sets removed from the map have none."""

    def is_open(some: Members) -> bool:
        return bool(bdd.at(open_sets, bdd.point({i: i in some for i in range(size)})) == bdd.true())

    for member in sorted(members):
        fewer = members - {member}
        if is_open(fewer) and is_conflict(fewer):
            members = fewer
    return members


def minimal(members: Sequence[str], holds: Callable[[Sequence[str]], bool]) -> tuple[str, ...]:
    """A minimal subset with a monotone property that the whole set has."""
    kept = list(members)
    for member in members:
        rest = [other for other in kept if other != member]
        if holds(rest):
            kept = rest
    return tuple(kept)
