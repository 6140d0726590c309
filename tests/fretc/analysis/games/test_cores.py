"""All minimal conflicts, against every subset tried one by one."""

import random
from collections.abc import Sequence
from itertools import combinations

from fretc.analysis.games.cores import Members, cores, minimal


def every_minimal(size: int, conflicts: list[Members]) -> set[Members]:
    """The least of the given sets: those are all minimal sets of the closure."""
    return {each for each in conflicts if not any(other < each for other in conflicts)}


def all_pairs(i: int, j: int) -> bool:
    return True


def no_pair(i: int, j: int) -> bool:
    return False


def test_each_minimal_conflict_is_found_once() -> None:
    for seed in range(60):
        choose = random.Random(seed)
        size = choose.randint(1, 8)
        conflicts = [
            frozenset(choose.sample(range(size), choose.randint(1, size)))
            for _ in range(choose.randint(0, 6))
        ]

        def is_conflict(members: Members, known: list[Members] = conflicts) -> bool:
            return any(each <= members for each in known)

        for near in (all_pairs, no_pair):  # whether pairs are tried first changes nothing
            found = list(cores(size, is_conflict, near))
            assert len(found) == len(set(found))
            assert set(found) == every_minimal(size, conflicts)


def test_a_minimal_subset_loses_by_any_member() -> None:
    def holds(members: Sequence[str]) -> bool:
        return {"b", "d"} <= set(members)

    assert minimal("abcde", holds) == ("b", "d")


def test_nothing_is_asked_twice_of_what_one_answer_decides() -> None:
    asked: list[Members] = []

    def is_conflict(members: Members) -> bool:
        asked.append(members)
        return frozenset({0, 1}) <= members

    assert list(cores(20, is_conflict, lambda i, j: (i, j) == (0, 1))) == [frozenset({0, 1})]
    assert len(asked) < sum(1 for _ in combinations(range(20), 2)) / 2
