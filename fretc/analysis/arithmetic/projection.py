"""Quantifier elimination with checked results: inputs for which outputs satisfy a formula.

A model of the formula tells where each output lies between the bounds of comparisons, and so gives
a term over inputs that satisfies the formula wherever these bounds are in the same order.
Substituting the terms always gives a part of the answer; when no model is left outside, the answer
is complete. `qe2` of z3 5.4 is not used: it makes `u = 1 & u < 0` true.

Source: Loos, Weispfenning, Applying linear quantifier elimination, The Computer Journal 36 (1993);
Bjorner, Janota, Playing with quantified satisfaction, LPAR 2015 (model-guided).
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import field
from fractions import Fraction

import z3

from compiler.formalization.numbers.terms import Term
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.variables import UnsupportedError
from fretish.classes.frozen import dataclass

SECONDS = 10.0
"""CPU seconds for a group of comparisons."""


@dataclass(frozen=True, slots=True)
class Limit:
    """Time limit of a group, within that of the question."""

    budget: Budget
    start: float = field(default_factory=time.process_time)

    @property
    def milliseconds(self) -> int:
        """Remaining milliseconds.

        Raises:
            UnsupportedError: the time of the group is over.
            OutOfTimeError: the time of the question is over.
        """
        self.budget.check()
        left = SECONDS - (time.process_time() - self.start)
        if left <= 0:
            raise UnsupportedError(f"were not solved within {SECONDS:g} CPU seconds")
        return max(1, int(1000 * min(left, self.budget.left)))


def model(solver: z3.Solver, limit: Limit) -> z3.ModelRef | None:
    """A model of the constraints; None: they are unsatisfiable.

    Raises:
        UnsupportedError: z3 gives no answer.
        OutOfTimeError: the time of the question was too short.
    """
    patience = limit.milliseconds
    solver.set("timeout", patience)
    answer = solver.check()
    if answer == z3.unknown:
        if patience < 1000 * SECONDS / 2:
            raise limit.budget.over
        raise UnsupportedError("are too complex for z3")
    return solver.model() if answer == z3.sat else None


def projected(formula: Term, variables: Sequence[Term], limit: Limit) -> Term:
    """The formula with the variables eliminated.

    Raises:
        UnsupportedError: it takes too long.
    """
    solver = z3.Solver()
    solver.add(formula)
    parts: list[Term] = []
    while (found := model(solver, limit)) is not None:
        part = formula
        for variable in variables:
            part = z3.substitute(part, (variable, _between(variable, part, found)))
        part = z3.simplify(part)
        if not z3.is_true(found.eval(part, model_completion=True)):
            raise UnsupportedError("have regions of inputs that z3 does not find")
        parts.append(part)
        solver.add(z3.Not(part))
    return z3.simplify(z3.Or(parts))


def _between(variable: Term, formula: Term, values: z3.ModelRef) -> Term:
    """A term with the variable's position in a model, between the adjacent bounds."""
    here = _value(values, variable)
    bounds = [(_value(values, bound), bound) for bound in _bounds(variable, formula, values)]
    at = next((bound for value, bound in bounds if value == here), None)
    below = max(((v, n) for n, (v, _) in enumerate(bounds) if v < here), default=None)
    above = min(((v, n) for n, (v, _) in enumerate(bounds) if v > here), default=None)
    whole = variable.is_int()
    if at is not None:
        return _floor(at) if whole else at
    if below is not None:
        least = bounds[below[1]][1]
        if whole:
            return _floor(least) + 1
        return (least + bounds[above[1]][1]) / 2 if above is not None else least + 1
    if above is not None:
        most = bounds[above[1]][1]
        return -_floor(-most) - 1 if whole else most - 1
    return z3.IntVal(0) if whole else z3.RealVal(0)


def _bounds(variable: Term, formula: Term, values: z3.ModelRef) -> Iterator[Term]:
    """Bounds of a variable in the comparisons of a formula, as real or integer terms."""
    for left, right in _comparisons(formula, values):
        zero, one = (
            z3.simplify(z3.substitute(left - right, (variable, _number(variable, n))))
            for n in (0, 1)
        )
        factor = z3.simplify(one - zero)
        if not (z3.is_rational_value(factor) or z3.is_int_value(factor)):
            continue
        exact = Fraction(str(factor))
        if exact == 0:
            continue
        if zero.is_int() and abs(exact) == 1:
            yield zero * int(-exact)
        else:
            real = z3.ToReal(zero) if zero.is_int() else zero
            yield real * z3.RealVal(str(-1 / exact))


def _comparisons(formula: Term, values: z3.ModelRef) -> Iterator[tuple[Term, Term]]:
    """Sides of all comparisons, with the alternatives that a model selects."""
    waiting, seen = [formula], set()
    while waiting:
        term = waiting.pop()
        if term.get_id() in seen:
            continue
        seen.add(term.get_id())
        sides = term.children()
        if len(sides) == 2 and z3.is_bool(term) and all(map(z3.is_arith, sides)):
            left, right = (_decided(side, values) for side in sides)
            yield left, right
        waiting.extend(sides)


def _decided(term: Term, values: z3.ModelRef) -> Term:
    """A number term without alternatives."""
    if z3.is_app_of(term, z3.Z3_OP_ITE):
        condition, then, otherwise = term.children()
        taken = z3.is_true(values.eval(condition, model_completion=True))
        return _decided(then if taken else otherwise, values)
    if not term.children():
        return term
    return term.decl()(*(_decided(each, values) for each in term.children()))


def _floor(term: Term) -> Term:
    return z3.ToInt(term) if term.is_real() else term


def _number(like: Term, value: int) -> Term:
    return z3.IntVal(value) if like.is_int() else z3.RealVal(value)


def _value(values: z3.ModelRef, term: Term) -> Fraction:
    return Fraction(str(z3.simplify(values.eval(term, model_completion=True))))
