"""Vacuity: whether a property would hold even if it demanded less of the model.

Source: Kupferman, Vardi, Vacuity detection in temporal model checking, STTT 4 (2003); Beer et al.,
Efficient detection of vacuity in temporal model checking, FMSD 18 (2001).
"""

from __future__ import annotations

from compiler.logic import formula as f

Bare = tuple[tuple[f.Formula, ...], f.Formula]
"""The conditions within a formula, and the formula without what they imply."""


def without_consequences(formula: f.Formula) -> tuple[Bare, ...]:
    """The formula without the consequences of its innermost conditions.

    If the result holds as well, the conditions are never true where they matter. There is one
    result for each conjunct about all times, or one for the whole formula if there is no such
    conjunct. A condition is the left side of an implication, or `a` in `!a | b` if `a` has no
    temporal operator. A negation has no conditions, and neither has an implication among
    propositions only.
    """
    flat = _flat(formula)
    parts = flat.args if isinstance(flat, f.And) else (flat,)
    lasting = tuple(part for part in parts if isinstance(part, f.Globally))
    reductions = map(_bare, lasting or (flat,))
    return tuple((conditions, rest) for conditions, rest in reductions if conditions)


def _flat(formula: f.Formula) -> f.Formula:
    """The formula with each chain of `|` in one node, however it was parenthesized."""
    return f.rebuild(formula, _flat)


def _bare(formula: f.Formula) -> Bare:
    match formula:
        case f.Implies(left, right):
            inner, rest = _bare(right)
            return (inner, f.implies(left, rest)) if inner else ((left,), f.not_(left))
        case f.Or(args):
            return _disjunction(args)
        case f.And() | f.Globally() | f.Eventually() | f.Until() | f.Release():
            inner = tuple(c for part in f.children(formula) for c in _bare(part)[0])
            return inner, f.rebuild(formula, lambda part: _bare(part)[1])
        case _:
            return (), formula


def _disjunction(args: tuple[f.Formula, ...]) -> Bare:
    """`!a | b` is `a -> b`."""
    done = [((), arg) if _is_plain(arg) else _bare(arg) for arg in args]
    inner = tuple(condition for conditions, _ in done for condition in conditions)
    if inner:
        return inner, f.or_(*(rest for _, rest in done))
    negated = [arg for arg in args if isinstance(arg, f.Not) and _is_plain(arg)]
    if not negated or len(negated) == len(args):
        return (), f.or_(*args)
    return (f.and_(*(arg.arg for arg in negated)),), f.or_(*negated)


def _is_plain(formula: f.Formula) -> bool:
    """Whether the formula has no temporal operator."""
    logic = (f.Const, f.Atom, f.Not, f.And, f.Or, f.Xor, f.Implies, f.Iff)
    return isinstance(formula, logic) and all(map(_is_plain, f.children(formula)))


def positive_atoms(formula: f.Formula, positive: bool = True) -> frozenset[str]:
    """The atoms that occur positively: under an even number of negations."""
    match formula:
        case f.Atom(name):
            return frozenset({name} if positive else ())
        case f.Not(arg):
            return positive_atoms(arg, not positive)
        case f.Implies(left, right):
            return positive_atoms(left, not positive) | positive_atoms(right, positive)
        case f.Iff(left, right) | f.Xor(left, right):
            return frozenset(f.atoms(formula))
        case _:
            parts = (positive_atoms(part, positive) for part in f.children(formula))
            return frozenset().union(*parts)
