"""Random sets with numbers of earlier ticks, against z3 with the sentences unrolled by hand."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

import pytest
import z3

from fretc.analysis.analysis import AnalysisOptions, analyze
from fretc.analysis.findings import Analysis, RealizabilityVerdict
from fretish.classes.frozen import dataclass
from tests.effort import FULL
from tests.requirement_sets import requirements, roles

Term = Any
Point = Callable[[int], Term]
"""A truth value at a tick."""

FIRST = 0
"""`preReal(0.0, v)` at the first tick."""
FAR, NEAR = 10, 3
"""Ticks up to which a set is unrolled: without inputs, and with inputs that alternate."""


@dataclass(frozen=True)
class Trace:
    """z3 constants of each tick."""

    ticks: int

    def number(self, name: str, tick: int) -> Term:
        return z3.Real(f"{name}{tick}")

    def before(self, name: str, tick: int) -> Term:
        return self.number(name, tick - 1) if tick else z3.RealVal(FIRST)

    def truth(self, name: str, tick: int) -> Term:
        return z3.Bool(f"{name}{tick}")


def demand(choose: random.Random, trace: Trace, *, inputs: bool) -> tuple[str, Point]:
    """What outputs should satisfy at a tick: its text, and its meaning."""
    name, other = choose.choice([("v", "w"), ("w", "v")])
    bound, rate = choose.randint(-2, 4), choose.randint(0, 2)
    options: list[tuple[str, Point]] = [
        (f"{name} >= {bound}", lambda t: trace.number(name, t) >= bound),
        (f"{name} < {bound}", lambda t: trace.number(name, t) < bound),
        (
            f"absReal({name} - preReal(0.0, {name})) <= {rate}",
            lambda t: z3.And(
                trace.number(name, t) - trace.before(name, t) <= rate,
                trace.before(name, t) - trace.number(name, t) <= rate,
            ),
        ),
        (
            f"{name} <= preReal(0.0, {name}) + {rate}",
            lambda t: trace.number(name, t) <= trace.before(name, t) + rate,
        ),
        (
            f"{name} = {other} + {rate}",
            lambda t: trace.number(name, t) == trace.number(other, t) + rate,
        ),
        (
            f"on => {name} > {bound}",
            lambda t: z3.Implies(trace.truth("on", t), trace.number(name, t) > bound),
        ),
        ("on", lambda t: trace.truth("on", t)),
        ("!on", lambda t: z3.Not(trace.truth("on", t))),
    ]
    if inputs:
        options += [
            (f"{name} >= t", lambda t: trace.number(name, t) >= trace.number("t", t)),
            (
                f"a => {name} > {bound}",
                lambda t: z3.Implies(trace.truth("a", t), trace.number(name, t) > bound),
            ),
        ]
    return choose.choice(options)


def trigger(choose: random.Random, trace: Trace, *, inputs: bool) -> tuple[str, Point]:
    options: list[tuple[str, Point]] = [
        ("on", lambda t: trace.truth("on", t)),
        ("v > 1", lambda t: trace.number("v", t) > 1),
    ]
    if inputs:
        options += [
            ("a", lambda t: trace.truth("a", t)),
            ("t > 2", lambda t: trace.number("t", t) > 2),
        ]
    return choose.choice(options)


def sentence(
    choose: random.Random, trace: Trace, *, inputs: bool
) -> tuple[str, Callable[[int], Term]]:
    """A sentence, and what it demands of so many first ticks: no deadline has passed in vain."""
    said, holds = demand(choose, trace, inputs=inputs)
    kind, n = choose.randrange(6), choose.randint(0, 3)
    if kind == 0:
        return f"the sw shall always satisfy {said}", lambda k: z3.And([holds(t) for t in range(k)])
    if kind == 1:
        text = f"the sw shall within {n} ticks satisfy {said}"
        return (
            text,
            lambda k: z3.Or([holds(t) for t in range(n + 1)]) if k > n else z3.BoolVal(True),
        )
    if kind == 2:
        text = f"the sw shall for {n} ticks satisfy {said}"
        return text, lambda k: z3.And([holds(t) for t in range(min(k, n + 1))])
    when, is_so = trigger(choose, trace, inputs=inputs)
    if kind == 3:
        text = f"whenever {when} the sw shall immediately satisfy {said}"
        return text, lambda k: z3.And([z3.Implies(is_so(t), holds(t)) for t in range(k)])
    if kind == 4:
        text = f"whenever {when} the sw shall at the next timepoint satisfy {said}"
        return text, lambda k: z3.And([z3.Implies(is_so(t), holds(t + 1)) for t in range(k - 1)])
    text = f"whenever {when} the sw shall within {n} ticks satisfy {said}"
    return text, lambda k: z3.And(
        [z3.Implies(is_so(t), z3.Or([holds(t + i) for i in range(n + 1)])) for t in range(k - n)]
    )


@dataclass(frozen=True)
class Drawn:
    """Sentences, each with its meaning for so many first ticks."""

    sentences: tuple[str, ...]
    meanings: tuple[Callable[[int], Term], ...]
    trace: Trace
    has_inputs: bool

    def lasts(self, members: Sequence[int], ticks: int) -> bool | None:
        """Whether the system can keep some sentences for so many ticks; None: z3 gives up."""
        formula = z3.And([self.meanings[each](ticks) for each in members])
        for tick in reversed(range(ticks)):
            chosen = [self.trace.number(name, tick) for name in "vw"]
            formula = z3.Exists([*chosen, self.trace.truth("on", tick)], formula)
            if self.has_inputs:
                given = [self.trace.number("t", tick), self.trace.truth("a", tick)]
                formula = z3.ForAll(given, formula)
        solver = z3.Tactic("qsat").solver()
        solver.set("timeout", 2_000)
        solver.add(formula)
        answer = solver.check()
        return None if answer == z3.unknown else bool(answer == z3.sat)

    def broken(self, play: Sequence[Mapping[str, Any]], ticks: int) -> list[int]:
        """The sentences that some first ticks of a play violate."""
        solver = z3.Solver()
        for tick, values in enumerate(play[:ticks]):
            for name, value in values.items():
                if name in ("v", "w", "t"):
                    exact = z3.RealVal(str(Fraction(value)))
                    solver.add(self.trace.number(name, tick) == exact)
                elif name in ("on", "a"):
                    solver.add(self.trace.truth(name, tick) == bool(value))
        lost = []
        for number, meaning in enumerate(self.meanings):
            solver.push()
            solver.add(meaning(ticks))
            if solver.check() == z3.unsat:
                lost.append(number)
            solver.pop()
        return lost


def drawn(seed: object, *, inputs: bool) -> Drawn:
    choose, trace = random.Random(repr(seed)), Trace(FAR)
    made = [sentence(choose, trace, inputs=inputs) for _ in range(choose.randint(2, 5))]
    return Drawn(
        tuple(text for text, _ in made), tuple(meaning for _, meaning in made), trace, inputs
    )


def analyzed(case: Drawn) -> Analysis:
    named = roles(["t", "a"], ["v", "w", "on"])
    options = AnalysisOptions(seconds=30, repairs=False)
    return analyze(requirements(*case.sentences), named, (), options)


def is_confirmed(case: Drawn, found: Analysis) -> Iterator[str]:
    """Compare an analysis with z3; yields what was compared."""
    every, ticks = range(len(case.sentences)), NEAR if case.has_inputs else FAR
    cores = [tuple(int(id[1:]) - 1 for id in each.requirements) for each in found.conflicts]
    for core, conflict in zip(cores, found.conflicts, strict=True):
        length = len(conflict.play)
        if length and conflict.loop is None:
            assert not {*core} & {*case.broken(conflict.play, length - 1)}, case.sentences
            assert {*core} & {*case.broken(conflict.play, length)}, case.sentences
            if length <= ticks:
                assert case.lasts(core, length) is not True, (case.sentences, core)
                yield "play"
        if "perhaps fewer" not in conflict.because:
            for fewer in combinations(core, len(core) - 1):
                assert case.lasts(fewer, ticks) is not False, (case.sentences, core, fewer)
                yield "minimal"
    if found.verdict is RealizabilityVerdict.REALIZABLE:
        assert case.lasts(every, ticks) is not False, case.sentences
        yield "realizable"
    if found.complete:
        for size in range(1, len(every) + 1):
            for members in combinations(every, size):
                if not any({*core} <= {*members} for core in cores):
                    assert case.lasts(members, ticks) is not False, (case.sentences, members)
        yield "complete"
    yield found.verdict


@pytest.mark.slow
@pytest.mark.parametrize(("inputs", "seeds"), [(False, 10), (True, 6)])
def test_random_sets_agree_with_their_sentences_unrolled_by_hand(inputs: bool, seeds: int) -> None:
    counts: Counter[str] = Counter()
    for seed in range(500 if FULL else seeds):
        case = drawn((seed, inputs), inputs=inputs)
        counts.update(is_confirmed(case, analyzed(case)))
    assert counts[RealizabilityVerdict.UNREALIZABLE], counts
    assert counts[RealizabilityVerdict.REALIZABLE], counts
    assert counts["complete"], counts
    assert counts["play"], counts
    assert counts["minimal"], counts
