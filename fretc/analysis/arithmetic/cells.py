"""What numbers can make true together: patterns of comparisons, and cells of the inputs.

A pattern is the truth of each comparison of a group, for some numbers. Where both players choose
numbers of the group, two inputs are in one cell just where they leave the same patterns to the
system; the region of inputs of a pattern is computed by quantifier elimination. So nothing is lost
and nothing is added.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import z3

from fretc.analysis.arena.alphabet import BeyondError
from fretc.analysis.arithmetic.terms import Term

MOST = 4_096
"""Patterns, or cells, of a group; one with more is refused."""
SECONDS = 10.0
"""Of a processor, for a group."""
Pattern = tuple[bool, ...]
"""The truth of each formula."""
Point = dict[str, Fraction]
"""A number for each variable."""


@dataclass(frozen=True, slots=True)
class Cell:
    """Inputs that leave the same patterns to the system."""

    region: Term
    patterns: frozenset[Pattern]


@dataclass(frozen=True, slots=True)
class Limit:
    """Time for a group."""

    start: float = field(default_factory=time.process_time)

    @property
    def milliseconds(self) -> int:
        """What is left of it; at its end BeyondError."""
        left = SECONDS - (time.process_time() - self.start)
        if left <= 0:
            raise BeyondError(f"are not sorted out within {SECONDS:g} s of a processor")
        return max(1, int(1000 * left))


def patterns(formulas: Sequence[Term], domain: Term, limit: Limit) -> tuple[Pattern, ...]:
    """The truth values that the formulas can have together.

    Raises:
        BeyondError: there are too many, or it takes too long.
    """
    solver = z3.Solver()
    solver.add(domain)
    found: list[Pattern] = []

    def follow(known: Pattern, model: z3.ModelRef | None) -> None:
        """Find those that begin so; a model of these spares a question."""
        if model is None:
            model = _model(solver, limit)
        if model is None:
            return
        if len(known) == len(formulas):
            found.append(known)
            if len(found) > MOST:
                raise BeyondError(f"have more than {MOST} patterns")
            return
        formula = formulas[len(known)]
        seen = z3.is_true(model.eval(formula, model_completion=True))
        for value in (seen, not seen):
            solver.push()
            solver.add(formula if value else z3.Not(formula))
            follow((*known, value), model if value is seen else None)
            solver.pop()

    follow((), None)
    return tuple(found)


def cells(
    formulas: Sequence[Term],
    known: Sequence[Pattern],
    outputs: Sequence[Term],
    domains: tuple[Term, Term],
    limit: Limit,
) -> list[Cell]:
    """The cells of the inputs of a group.

    Args:
        formulas: of the group.
        known: all their patterns.
        outputs: the variables that the system chooses.
        domains: of the inputs, and of the outputs.
        limit: for the group.

    Raises:
        BeyondError: there are too many, or it takes too long.
    """
    of_inputs, of_outputs = domains
    regions: dict[Term, set[Pattern]] = {}
    for pattern in known:
        region = _projected(z3.And(*literals(formulas, pattern), of_outputs), outputs, limit)
        regions.setdefault(region, set()).add(pattern)
    every = list(regions)
    return [
        Cell(
            z3.And(of_inputs, *literals(every, signs)),
            frozenset().union(*(regions[r] for r, on in zip(every, signs, strict=True) if on)),
        )
        for signs in patterns(every, of_inputs, limit)
    ]


def literals(formulas: Sequence[Term], pattern: Pattern) -> list[Term]:
    """The formulas, each as true or false as the pattern has it."""
    pairs = zip(formulas, pattern, strict=True)
    return [formula if value else z3.Not(formula) for formula, value in pairs]


def point(constraints: Sequence[Term], variables: Sequence[Term]) -> Point:
    """Numbers that keep constraints which some keep; whole ones, if they can be."""
    solver = z3.Solver()
    solver.set("timeout", _PATIENCE)
    solver.add(*constraints)
    solver.push()
    solver.add([z3.IsInt(each) for each in variables if each.is_real()])
    if solver.check() != z3.sat:
        solver.pop()
        solver.set("timeout", 0)
        answer = solver.check()
        assert answer == z3.sat, "the pattern has been seen"
    model = solver.model()
    values = [model.eval(each, model_completion=True) for each in variables]
    return {
        str(each): Fraction(str(value.as_fraction() if value.is_real() else value.as_long()))
        for each, value in zip(variables, values, strict=True)
    }


_PATIENCE = 1_000
"""Milliseconds to look for whole numbers, which read better."""


def fixed(point_: Point, variables: Sequence[Term]) -> list[Term]:
    """Constraints that say the numbers."""
    return [
        each == (z3.RealVal(str(point_[str(each)])) if each.is_real() else int(point_[str(each)]))
        for each in variables
    ]


def _projected(formula: Term, variables: Sequence[Term], limit: Limit) -> Term:
    """`formula` for some values of the variables, without them."""
    goal = z3.Goal()
    goal.add(z3.Exists(list(variables), formula))
    try:
        parts = z3.TryFor(z3.Then("simplify", "qe2", "simplify"), limit.milliseconds)(goal)
    except z3.Z3Exception:
        raise BeyondError("have regions of inputs that z3 does not find") from None
    found = z3.simplify(z3.Or([z3.And(list(each)) for each in parts]))
    if _has_quantifier(found):
        raise BeyondError("have regions of inputs that z3 does not find")
    return found


def _has_quantifier(formula: Term) -> bool:
    waiting, seen = [formula], set()
    while waiting:
        term = waiting.pop()
        if term.get_id() in seen:
            continue
        seen.add(term.get_id())
        if z3.is_quantifier(term):
            return True
        waiting.extend(term.children())
    return False


def _model(solver: z3.Solver, limit: Limit) -> z3.ModelRef | None:
    """What keeps the constraints; None: nothing does."""
    solver.set("timeout", limit.milliseconds)
    answer = solver.check()
    if answer == z3.unknown:
        raise BeyondError("are more than z3 can sort out")
    return solver.model() if answer == z3.sat else None
