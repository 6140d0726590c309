"""Truth patterns that numbers can satisfy: patterns of comparisons, and cells of inputs.

A pattern is the truth of each comparison of a group for some numbers. If both players choose
numbers of the group, two inputs are in one cell if and only if they leave the system the same
patterns; the inputs of a pattern are found by eliminating the outputs. So the abstraction is exact.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import z3

from compiler.formalization.numbers.terms import Term, read_by
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.arithmetic.projection import Limit, projected
from fretc.analysis.arithmetic.projection import model as next_model
from fretish.classes.frozen import dataclass

MOST = 4_096
"""Maximum number of patterns, or cells, of a group; larger groups are refused."""
Pattern = tuple[bool, ...]
"""The truth of each formula."""
Point = dict[str, Fraction]
"""A number for each variable."""


@dataclass(frozen=True, slots=True)
class InputClass:
    """Inputs that leave the same patterns to the system."""

    region: Term
    patterns: frozenset[Pattern]


def patterns(formulas: Sequence[Term], domain: Term, limit: Limit) -> tuple[Pattern, ...]:
    """Truth patterns that the formulas can have together.

    Formulas of a single variable are solved first, because many bounds of it have few patterns.

    Raises:
        UnsupportedError: there are too many patterns, or it takes too long.
    """
    alone: dict[frozenset[str], list[int]] = {}
    for number, formula in enumerate(formulas):
        read = read_by(formula)
        alone.setdefault(read if len(read) == 1 else frozenset(), []).append(number)
    rest = alone.pop(frozenset(), [])
    blocks = [numbers for numbers in alone.values() if len(numbers) > 1]
    rest += [numbers[0] for numbers in alone.values() if len(numbers) == 1]
    solver = z3.Solver()
    solver.add(domain)
    choices = [[*_seen([formulas[n] for n in numbers], domain, limit)] for numbers in blocks]
    order = [n for numbers in blocks for n in numbers] + rest
    signs: list[Pattern] = []
    for known in _joined(solver, formulas, [*zip(blocks, choices, strict=True)], limit):
        for others in _followed(solver, [formulas[n] for n in rest], limit):
            values = dict(zip(order, (*known, *others), strict=True))
            signs.append(tuple(values[number] for number in range(len(formulas))))
            if len(signs) > MOST:
                raise UnsupportedError(f"have more than {MOST} patterns")
    return tuple(signs)


def _joined(
    solver: z3.Solver,
    formulas: Sequence[Term],
    blocks: Sequence[tuple[Sequence[int], Sequence[Pattern]]],
    limit: Limit,
) -> Iterator[Pattern]:
    """Combinations of block patterns that are possible together."""
    if not blocks:
        yield ()
        return
    (numbers, choices), *others = blocks
    for pattern in choices:
        solver.push()
        solver.add(literals([formulas[number] for number in numbers], pattern))
        if not others or next_model(solver, limit) is not None:
            for more in _joined(solver, formulas, others, limit):
                yield (*pattern, *more)
        solver.pop()


def _followed(
    solver: z3.Solver, formulas: Sequence[Term], limit: Limit, model: z3.ModelRef | None = None
) -> Iterator[Pattern]:
    """Patterns of formulas under the solver's constraints; a model saves a query."""
    if model is None:
        model = next_model(solver, limit)
    if model is None:
        return
    if not formulas:
        yield ()
        return
    first, *others = formulas
    seen = z3.is_true(model.eval(first, model_completion=True))
    for value in (seen, not seen):
        solver.push()
        solver.add(first if value else z3.Not(first))
        for more in _followed(solver, others, limit, model if value is seen else None):
            yield (value, *more)
        solver.pop()


def another(formulas: Sequence[Term], known: Sequence[Pattern], domain: Term, limit: Limit) -> bool:
    """Whether the formulas can have a truth pattern that is not known.

    Raises:
        UnsupportedError: it takes too long.
    """
    if len(known) == 2 ** len(formulas):
        return False
    solver = z3.Solver()
    solver.add(domain)
    solver.add([z3.Not(z3.And(literals(formulas, each))) for each in known])
    return next_model(solver, limit) is not None


def cells(
    formulas: Sequence[Term],
    known: Sequence[Pattern],
    outputs: Sequence[Term],
    domains: tuple[Term, Term],
    limit: Limit,
) -> tuple[InputClass, ...]:
    """Cells of the inputs of a group.

    Args:
        formulas: formulas of the group.
        known: all their patterns.
        outputs: variables that the system chooses.
        domains: domains of the inputs, and of the outputs.
        limit: time limit of the group.

    Raises:
        UnsupportedError: there are too many cells, or it takes too long.
    """
    of_inputs, of_outputs = domains
    free = [number for number, each in enumerate(formulas) if reads(each, outputs)]
    given = [number for number in range(len(formulas)) if number not in free]
    regions: dict[Pattern, Term] = {}
    for pattern in known:
        part = _part(pattern, free)
        if part not in regions:
            kept = literals([formulas[number] for number in free], part)
            regions[part] = projected(z3.And(*kept, of_outputs), outputs, limit)
    marks = [*(formulas[number] for number in given), *regions.values()]
    found = []
    for signs in _seen(marks, of_inputs, limit):
        inside = {part for part, on in zip(regions, signs[len(given) :], strict=True) if on}
        left = frozenset(
            pattern
            for pattern in known
            if _part(pattern, free) in inside and _part(pattern, given) == signs[: len(given)]
        )
        found.append(InputClass(z3.And(of_inputs, *literals(marks, signs)), left))
    return tuple(found)


def _part(pattern: Pattern, numbers: Sequence[int]) -> Pattern:
    return tuple(pattern[number] for number in numbers)


def _seen(formulas: Sequence[Term], domain: Term, limit: Limit) -> Iterator[Pattern]:
    """Same as `patterns`, for many formulas with few patterns: a query for each pattern."""
    solver = z3.Solver()
    solver.add(domain)
    names = [z3.Bool(f"mark!{number}") for number in range(len(formulas))]
    solver.add([name == formula for name, formula in zip(names, formulas, strict=True)])
    count = 0
    while (model := next_model(solver, limit)) is not None:
        signs = tuple(z3.is_true(model.eval(name, model_completion=True)) for name in names)
        yield signs
        count += 1
        if count > MOST:
            raise UnsupportedError(f"have more than {MOST} cells")
        solver.add(z3.Not(z3.And(literals(names, signs))))


def reads(formula: Term, variables: Sequence[Term]) -> bool:
    """Whether a formula reads one of the variables."""
    names = read_by(formula)
    return any(variable.decl().name() in names for variable in variables)


def literals(formulas: Sequence[Term], pattern: Sequence[bool]) -> list[Term]:
    """The formulas or their negations, as the pattern says."""
    pairs = zip(formulas, pattern, strict=True)
    return [formula if value else z3.Not(formula) for formula, value in pairs]


def point(constraints: Sequence[Term], variables: Sequence[Term]) -> Point:
    """Numbers that satisfy satisfiable constraints; whole numbers if possible."""
    solver = z3.Solver()
    solver.set("timeout", _PATIENCE)
    solver.add(*constraints)
    solver.push()
    solver.add([z3.IsInt(variable) for variable in variables if z3.is_real(variable)])
    if solver.check() != z3.sat:
        solver.pop()
        solver.set("timeout", 0)
        answer = solver.check()
        assert answer == z3.sat, "the pattern has been seen"
    model = solver.model()
    variables = [variable for variable in variables if z3.is_arith(variable)]
    values = [model.eval(variable, model_completion=True) for variable in variables]
    return {
        str(each): Fraction(str(value.as_fraction() if value.is_real() else value.as_long()))
        for each, value in zip(variables, values, strict=True)
    }


_PATIENCE = 1_000
"""Milliseconds to search for whole numbers, which are easier to read."""


def fixed(point_: Point, variables: Sequence[Term]) -> list[Term]:
    """Constraints that fix the numbers."""
    return [
        variable
        == (
            z3.RealVal(str(point_[str(variable)]))
            if variable.is_real()
            else int(point_[str(variable)])
        )
        for variable in variables
    ]
