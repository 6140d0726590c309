"""The future-time formula of a sentence, evaluated at tick 0.

One construction serves both kinds of trace: the formula about finite traces mentions `LAST`; on
infinite traces `LAST` is false, and the same formula folds to the other (`formula.endless`).

An interval [L, R] is a stretch of ticks on which the scope is active. Inside of it `end` is true
at R and not before, so that `end R x` says x on all of the interval from here on, and `!end U x`
says x somewhere on it. Source: SEMANTICS of FRETish, scopes and timings; the shapes follow
Giannakopoulou et al., IST 137 (2021), section 5, rebuilt from the meaning.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from compiler.formalization.obligation import Demand, Obligation, ObligationKind
from compiler.logic.formula import (
    FALSE,
    LAST,
    And,
    Formula,
    Implies,
    Interval,
    ProbabilityBound,
    Release,
    and_,
    endless,
    eventually,
    globally,
    implies,
    next_,
    not_,
    or_,
    release,
    until,
)
from fretish.syntax import ConditionKind, ScopeKind


def future(obligation: Obligation) -> Formula:
    """The formula about finite traces, evaluated at tick 0."""
    return _everywhere(obligation, lambda demanded: demanded)


def probabilistic(obligation: Obligation, op: str, bound: str) -> Formula:
    """PCTL*: almost surely, each demand is met with a probability `op bound` from its trigger on.

    The shape is FRET's, `P>=1[ ... P op bound[demand] ... ]`, around our own formulas: what is
    demanded, scope by scope, is what the sentence demands without a probability.
    """
    met = _everywhere(obligation, lambda demanded: ProbabilityBound(op, bound, demanded))
    return ProbabilityBound(">=", "1", endless(met))


def _everywhere(obligation: Obligation, form: Callable[[Formula], Formula]) -> Formula:
    m = obligation.mode
    end = end_marker(obligation.scope, m)
    enforced = _enforced(obligation, end, form)
    match obligation.scope:
        case None | ScopeKind.ONLY_AFTER:
            return enforced
        case ScopeKind.IN:
            return _on_runs(m, end, enforced)
        case ScopeKind.NOT_IN | ScopeKind.ONLY_IN:
            return _on_runs(not_(m), end, enforced)
        case ScopeKind.BEFORE:
            return or_(m, enforced)
        case ScopeKind.AFTER:
            # left: the last tick of the first run of m; the interval begins one tick later.
            left = and_(m, not_(LAST), next_(not_(m)))
            return release(or_(left, LAST), implies(left, next_(enforced)))
        case ScopeKind.ONLY_BEFORE:
            return release(or_(m, LAST), implies(m, enforced))
        case _:
            assert_never(obligation.scope)


def end_marker(scope: ScopeKind | None, m: Formula) -> Formula:
    """True at the last tick of an interval and at no tick of it before, seen from inside of it."""
    match scope:
        case None | ScopeKind.AFTER | ScopeKind.ONLY_BEFORE:
            return LAST
        case ScopeKind.IN:
            return or_(LAST, next_(not_(m)))
        case ScopeKind.NOT_IN | ScopeKind.ONLY_IN | ScopeKind.BEFORE:
            return or_(LAST, next_(m))
        case ScopeKind.ONLY_AFTER:
            return or_(LAST, and_(m, next_(not_(m))))
        case _:
            assert_never(scope)


def _on_runs(inside: Formula, end: Formula, enforced: Formula) -> Formula:
    """Formula: `enforced` holds at the first tick of every maximal run of `inside`.

    A part `end R x` says x at every tick of the run: then it is claimed of every tick inside.
    """
    parts = enforced.args if isinstance(enforced, And) else (enforced,)
    throughout = [p.right for p in parts if isinstance(p, Release) and p.left == end]
    at_first = and_(*(p for p in parts if not (isinstance(p, Release) and p.left == end)))
    enters = and_(not_(LAST), not_(inside), next_(inside))
    return and_(
        *(release(LAST, _given(inside, claim)) for claim in throughout),
        release(LAST, implies(enters, next_(at_first))),
        implies(inside, at_first),
    )


def _given(inside: Formula, claim: Formula) -> Formula:
    """`inside -> (a -> b)` as `inside & a -> b`."""
    if isinstance(claim, Implies):
        return implies(and_(inside, claim.left), claim.right)
    return implies(inside, claim)


def _enforced(obligation: Obligation, end: Formula, form: Callable[[Formula], Formula]) -> Formula:
    """At the first tick of an interval: the demand, in the given form, at every trigger."""
    met = form(demanded_at(obligation.demand, end))
    p = obligation.trigger
    match obligation.condition:
        case None:
            return met
        case ConditionKind.HOLDING:
            return release(end, implies(p, met))
        case ConditionKind.TRIGGER:
            rises = and_(not_(p), not_(end), next_(p))
            return and_(
                release(end, implies(rises, next_(met))),
                implies(p, met),
            )
        case _:
            assert_never(obligation.condition)


def demanded_at(demand: Demand, end: Formula) -> Formula:
    """The demand at a trigger at the present tick; `end` marks the last tick of the interval."""
    q, s, n = demand.response, demand.stop, demand.ticks
    match demand.kind:
        case ObligationKind.IMMEDIATELY:
            return q
        case ObligationKind.NEXT:
            return or_(end, next_(q))
        case ObligationKind.FINALLY:
            return release(end, implies(end, q))
        case ObligationKind.EVENTUALLY:
            return until(not_(end), q)
        case ObligationKind.ALWAYS:
            return release(end, q)
        case ObligationKind.WITHIN:
            return _within(q, n, end)
        case ObligationKind.FOR:
            return _for(q, n, end)
        case ObligationKind.AFTER:
            return and_(_for(not_(q), n, end), _within(q, n + 1, end))
        case ObligationKind.NOT_AFTER:
            return or_(_within(q, n, end), _for(not_(q), n + 1, end))
        case ObligationKind.UNTIL:
            return release(or_(s, end), or_(s, q))
        case ObligationKind.BEFORE:
            return release(or_(q, end), not_(s))
        case _:
            assert_never(demand.kind)


def _within(q: Formula, n: int, end: Formula) -> Formula:
    """Q within n ticks, or the interval ends before the n-th."""
    ends = eventually(end, Interval(0, n - 1)) if n > 0 else FALSE
    return or_(eventually(q, Interval(0, n)), ends)


def _for(q: Formula, n: int, end: Formula) -> Formula:
    """Q for n ticks and the present one, or up to the end of the interval."""
    return or_(globally(q, Interval(0, n)), release(end, q)) if n else q
