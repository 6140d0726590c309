"""Requirements for one file: W1 to W4 in turn, on propositions that each has for itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.monitoring import always, requirement
from benchmarks.peers import WORKLOADS
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import formula as f

KINDS = ("W1", "W2", "W3", "W4")
BOUNDS = {"W2": 10, "W3": 100}
_PROPOSITIONS = 40
"""Of a file of many."""
_TICKS = 2_000_000
"""Of one requirement; many take fewer."""


@dataclass(frozen=True)
class Demand:
    """One of W1 to W4 on propositions of its own."""

    id: str
    kind: str
    names: Mapping[str, str]
    """The propositions that are its `a`, `b` and `c`."""
    bound: int = 0

    def requirement(self) -> FormalizedRequirement:
        """As fretc takes it."""
        a, b, c = (self.names.get(each, "") for each in "abc")
        match self.kind:
            case "W1":
                return requirement(f"whenever {a} sw shall eventually satisfy {b}", self.id)
            case "W2":
                return requirement(
                    f"whenever {a} sw shall within {self.bound} ticks satisfy {b}", self.id
                )
            case "W3":
                recent = f.once(f.Atom(b), f.Interval(0, self.bound))
                return always(f.Atom(a), recent, self.id)
            case _:
                rise = f.and_(f.Atom(a), f.previous(f.not_(f.Atom(a))))
                return always(rise, f.since(f.not_(f.Atom(c)), f.Atom(b)), self.id)


@dataclass(frozen=True)
class Task:
    """What is monitored in one file, and over which trace."""

    name: str
    demands: Sequence[Demand]
    rows: NDArray[np.bool_]
    """Shape (ticks, propositions)."""

    @property
    def propositions(self) -> list[str]:
        """In the order of the columns of `rows`, and of the inputs that fretc writes."""
        return _propositions(self.demands)


def _propositions(demands: Sequence[Demand]) -> list[str]:
    return list(dict.fromkeys(name for each in demands for name in each.requirement().watched))


def single(kind: str, bound: int | None = None) -> Task:
    """One requirement over the trace of its workload."""
    workload = WORKLOADS[kind]
    columns = workload.columns(_TICKS)
    names = {name: name for name in workload.signals}
    demand = Demand("R1", kind, names, BOUNDS.get(kind, 0) if bound is None else bound)
    name = kind if bound is None else f"{kind}, a bound of {bound:,}"
    return Task(
        name, [demand], np.stack([columns[each] for each in _propositions([demand])], axis=1)
    )


def many(count: int) -> Task:
    """So many requirements, no two of them equal, over random values."""
    demands = [_demand(i) for i in range(count)]
    rng = np.random.default_rng(0)
    shape = max(2_000, _TICKS // count), len(_propositions(demands))
    return Task(f"{count:,} requirements", demands, rng.random(shape) < 0.2)


def _demand(i: int) -> Demand:
    """Pairs of propositions are those of this requirement alone, so that none shares a part."""
    number, i = i % len(KINDS), i // len(KINDS)
    shift, a = i // _PROPOSITIONS, i + 10 * number
    places = {"a": a, "b": a + 1 + 7 * number + shift, "c": a + 39 - shift}
    kind = KINDS[number]
    used = {each: f"p{places[each] % _PROPOSITIONS}" for each in WORKLOADS[kind].signals}
    return Demand(f"R{len(KINDS) * i + number + 1}", kind, used, BOUNDS.get(kind, 0))
