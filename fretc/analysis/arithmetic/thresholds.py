"""From which numbers of the tick before a bound is within reach: bounds step by step.

Where `abs(v - preReal(0, v)) <= 1` is demanded, and `v >= 5` is compared, `v >= 5` comes next from
4 on, that from 3 on, and so on. What is remembered of a number decides as much of what can come as
bounds are remembered: with all of them up to a number of steps, a game of as many ticks is exact.

Source: Kurshan, Computer-aided verification of coordinating processes (1994); Graf, Saidi,
Construction of abstract state graphs with PVS, CAV 1997 (predicates as states); here they are
computed backwards, comparison by comparison.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import product

import z3
from z3 import z3util

from compiler.formalization.numbers.terms import Term, read_by
from fretish.classes.frozen import dataclass

_MOST = 64
"""Maximum number of alternatives of a comparison; beyond it no bound is computed."""
MOST_BOUNDS = 40
"""Maximum number of bounds of a variable; patterns grow with their square."""


@dataclass(frozen=True, slots=True)
class Bound:
    """A number that separates smaller numbers, or numbers at most so large, from the others."""

    number: Fraction
    is_below: bool


def reached(now: Term, then: Term, formulas: Sequence[Term], steps: int) -> tuple[Bound, ...]:
    """Bounds of a variable from which other bounds are reachable.

    If the comparison of both numbers is strict, the side of the bound itself is unclear, and both
    bounds are added. A superfluous bound does no harm; a missing one leaves a question open.

    Args:
        now: the variable.
        then: its number at the previous tick.
        formulas: all comparisons.
        steps: number of ticks to look back.
    """
    both = [*_lines(now, then, formulas)]
    newest = [*dict.fromkeys([*_own(now, formulas), *_own(then, formulas)])]
    known = dict.fromkeys(newest)
    for _ in range(steps):
        found = [
            Bound(-(a * bound.number + c) / b, is_below)
            for bound in newest
            for a, b, c, is_strict in both
            for is_below in ((True, False) if is_strict else (bound.is_below is (a * b < 0),))
        ]
        newest = [bound for bound in dict.fromkeys(found) if bound not in known]
        known |= dict.fromkeys(newest)
        if not newest or len(known) > MOST_BOUNDS:
            break
    return tuple([*known][:MOST_BOUNDS])


def _own(variable: Term, formulas: Sequence[Term]) -> Iterator[Bound]:
    """Bounds in the comparisons of a variable."""
    name = str(variable)
    for formula in formulas:
        if read_by(formula) == {name}:
            for factors, rest, kind in _linear(formula):
                factor = factors.get(name)
                if factor:
                    yield from (Bound(-rest / factor, each) for each in _sides(kind, factor > 0))


def _sides(kind: int, is_above: bool) -> tuple[bool, ...]:
    """Whether the comparison with 0 separates numbers below the bound, or at most it."""
    if kind in (z3.Z3_OP_LE, z3.Z3_OP_GT):
        return (not is_above,)
    if kind in (z3.Z3_OP_GE, z3.Z3_OP_LT):
        return (is_above,)
    return (True, False)


def _lines(
    now: Term, then: Term, formulas: Sequence[Term]
) -> Iterator[tuple[Fraction, Fraction, Fraction, bool]]:
    """`a`, `b`, `c` of each comparison of `a * now + b * then + c` with 0; whether it is strict."""
    for formula in formulas:
        if read_by(formula) == {str(now), str(then)}:
            for factors, rest, _ in _linear(formula):
                a, b = factors.get(str(now)), factors.get(str(then))
                if a and b:
                    yield a, b, rest, z3.is_not(formula) or z3.is_eq(formula)


def _linear(formula: Term) -> Iterator[tuple[dict[str, Fraction], Fraction, int]]:
    """Linear form of a comparison with 0: factor of each variable, constant, operator."""
    waiting, seen = [formula], set()
    while waiting:
        term = waiting.pop()
        if term.get_id() in seen:
            continue
        seen.add(term.get_id())
        sides = term.children()
        waiting.extend(sides)
        if len(sides) == 2 and z3.is_bool(term) and all(map(z3.is_arith, sides)):
            for left, right in product(*map(_alternatives, sides)):
                yield *_factors(left - right), term.decl().kind()


def _alternatives(term: Term) -> list[Term]:
    """Values of a number without alternatives; empty: too many."""
    if z3.is_app_of(term, z3.Z3_OP_ITE):
        _, then, otherwise = term.children()
        return [*_alternatives(then), *_alternatives(otherwise)]
    if not term.children():
        return [term]
    parts = [_alternatives(each) for each in term.children()]
    terms = [term.decl()(*each) for each in product(*parts)]
    return terms if len(terms) <= _MOST else []


def _factors(term: Term) -> tuple[dict[str, Fraction], Fraction]:
    variables = z3util.get_vars(term)

    def at(one: str) -> Fraction:
        values = [
            (variable, _number(variable, int(str(variable) == one))) for variable in variables
        ]
        return Fraction(str(z3.simplify(z3.substitute(term, *values))))

    rest = at("")
    return {str(variable): at(str(variable)) - rest for variable in variables}, rest


def _number(like: Term, value: int) -> Term:
    return z3.IntVal(value) if like.is_int() else z3.RealVal(value)
