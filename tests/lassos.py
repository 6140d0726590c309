"""The meaning of a formula on an endless run that repeats itself: slow and obvious."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.logic import formula as f
from compiler.logic.kripke import Kripke, Lasso


def satisfies(formula: f.Formula, labels: Sequence[frozenset[str]], back: int, at: int = 0) -> bool:
    """Whether the formula holds at a place of the word; after the last place comes `back`."""

    def holds(part: f.Formula, place: int = at) -> bool:
        return satisfies(part, labels, back, place)

    def following(place: int) -> int:
        return place + 1 if place + 1 < len(labels) else back

    def ahead(start: int) -> list[int]:
        """Twice around: every place that ever comes, in its order."""
        places = [start]
        while len(places) <= 2 * len(labels):
            places.append(following(places[-1]))
        return places

    match formula:
        case f.Const(value):
            return value
        case f.Atom(name):
            return name in labels[at]
        case f.Not(arg):
            return not holds(arg)
        case f.And(args):
            return all(holds(arg) for arg in args)
        case f.Or(args):
            return any(holds(arg) for arg in args)
        case f.Implies(left, right):
            return not holds(left) or holds(right)
        case f.Iff(left, right):
            return holds(left) is holds(right)
        case f.Xor(left, right):
            return holds(left) is not holds(right)
        case f.Next(arg):
            return holds(arg, following(at))
        case f.Eventually(arg, f.EVER):
            return any(holds(arg, place) for place in ahead(at))
        case f.Globally(arg, f.EVER):
            return all(holds(arg, place) for place in ahead(at))
        case f.Until(left, right):
            places = ahead(at)
            return any(
                holds(right, place) and all(holds(left, before) for before in places[:i])
                for i, place in enumerate(places)
            )
        case f.Release(left, right):
            places = ahead(at)
            return all(
                holds(right, place) or any(holds(left, before) for before in places[:i])
                for i, place in enumerate(places)
            )
        case _:
            raise AssertionError(f"not of these tests: {formula}")


def keeps(formula: f.Formula, kripke: Kripke, lasso: Lasso) -> bool:
    labels = [kripke.labels[state] for state in lasso.states]
    return satisfies(formula, labels, len(lasso.prefix))


def lassos(kripke: Kripke, longest: int) -> Iterator[Lasso]:
    """Every run that repeats itself after that many states or fewer."""
    ways: list[tuple[int, ...]] = [(kripke.initial,)]
    for _ in range(longest):
        for way in ways:
            for back, state in enumerate(way):
                if state in kripke.successors(way[-1]):
                    yield Lasso(way[:back], way[back:])
        ways = [(*way, state) for way in ways for state in kripke.successors(way[-1])]
