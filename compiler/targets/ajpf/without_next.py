"""Sentences without the operator X: for languages whose steps are not ticks.

A sentence that counts no ticks has the same verdict when a trace stutters. So it has a form without
X, though its formula in `compiler/formalization/future.py` marks the ends of intervals by X. Here
the form is built from two dual operators that stay within an interval of the scope. Spot proves
each of its shapes equal to that formula, with plain propositions for the expressions: a result
about propositions holds for all expressions in their places. Source: Peled and Wilke,
Stutter-invariant temporal properties are expressible without the next-time operator, IPL 63 (1997),
for the existence of such forms; the forms are our own.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import assert_never

from compiler.formalization.future import future
from compiler.formalization.obligation import TRAITS, Demand, Obligation, ObligationKind, Trait
from compiler.logic import formula as f
from compiler.logic.formula import (
    FALSE,
    TRUE,
    Formula,
    and_,
    eventually,
    globally,
    implies,
    not_,
    or_,
    release,
    until,
)
from fretish.syntax import ConditionKind, ScopeKind, ends_with_run


def is_next_free(formula: Formula) -> bool:
    """Whether the formula has only Boolean operators, F, G, U and R, without bounds."""
    match formula:
        case f.Eventually(_, ahead) | f.Globally(_, ahead) if ahead != f.EVER:
            return False
        case (
            f.Const()
            | f.Atom()
            | f.Not()
            | f.And()
            | f.Or()
            | f.Xor()
            | f.Implies()
            | f.Iff()
            | f.Eventually()
            | f.Globally()
            | f.Until()
            | f.Release()
        ):
            return all(is_next_free(part) for part in f.children(formula))
        case _:
            return False


def next_free(obligation: Obligation) -> Formula | None:
    """The formula on infinite traces without X; None if the demand counts ticks."""
    if Trait.STEPS in TRAITS[obligation.demand.kind]:
        return None
    return _Interval(obligation.scope, obligation.mode).everywhere(obligation)


@cache
def is_proved(
    scope: ScopeKind | None, condition: ConditionKind | None, kind: ObligationKind
) -> bool:
    """Whether Spot finds the shape equal to the formula of `compiler/formalization/future.py`."""
    from compiler.logic.spot import equivalent

    shape = _shape(scope, condition, kind)
    ours = next_free(shape)
    return ours is not None and equivalent(ours, f.endless(future(shape)))


def unbounded(obligation: Obligation) -> Formula | None:
    """The formula of `within n` without n: the response, or the end of the interval, at some time.

    An interval that ends too soon satisfies `within` but not `eventually`, which would be stronger
    if intervals end. None for all other demands, and for the `only` scopes, where a demand within a
    bound means that the response is missed for that long.
    """
    scope = obligation.scope
    if not _has_deadline(obligation.demand.kind) or (scope is not None and scope.negates):
        return None
    interval = _Interval(scope, obligation.mode)
    met = or_(interval.outside, obligation.demand.response)
    weak = replace(obligation, demand=Demand(ObligationKind.EVENTUALLY, met))
    return interval.everywhere(weak, eventually(met))


def _has_deadline(kind: ObligationKind) -> bool:
    """Whether one response up to a deadline is enough."""
    traits = TRAITS[kind]
    return Trait.COUNTS | Trait.WAITS in traits and Trait.OPPOSITES not in traits


@cache
def is_weaker(scope: ScopeKind | None, condition: ConditionKind | None) -> bool:
    """Whether Spot proves the unbounded shape equal to `within n` without its bound.

    The bounds of the formula are under no negation, so the formula implies its unbounded form for
    any n; and the shape is equal to that form.
    """
    from compiler.logic.spot import equivalent

    shape = _shape(scope, condition, ObligationKind.WITHIN, 2)
    weak = unbounded(shape)
    return weak is not None and equivalent(_without_bounds(f.endless(future(shape))), weak)


def _without_bounds(formula: Formula) -> Formula:
    if isinstance(formula, f.Eventually):
        return eventually(_without_bounds(formula.arg))
    return f.rebuild(formula, _without_bounds)


def never_begins(obligation: Obligation) -> Formula | None:
    """The formula that the sentence never demands anything: no interval has a trigger.

    Without a condition, it says that no interval begins; if an interval begins at the start of
    every trace, that its mode never comes. None if the sentence has neither scope nor condition.
    """
    m, c = obligation.mode, obligation.trigger
    waits = obligation.condition is not None
    match obligation.scope:
        case None:
            return globally(not_(c)) if waits else None
        case ScopeKind.IN:
            return globally(not_(and_(m, c)))
        case ScopeKind.NOT_IN | ScopeKind.ONLY_IN:
            return globally(not_(and_(not_(m), c)))
        case ScopeKind.AFTER:
            return globally(implies(m, globally(implies(not_(m), globally(not_(c))))))
        case ScopeKind.ONLY_BEFORE:
            return globally(implies(m, globally(not_(c))))
        case ScopeKind.BEFORE | ScopeKind.ONLY_AFTER:
            if not waits:
                return globally(not_(m))
            never = _Interval(obligation.scope, m).throughout(not_(c))
            return or_(m, never) if obligation.scope is ScopeKind.BEFORE else never


def _shape(
    scope: ScopeKind | None, condition: ConditionKind | None, kind: ObligationKind, ticks: int = 0
) -> Obligation:
    """The obligation of a sentence over plain propositions."""
    m, c, r, q = map(f.Atom, ("m", "c", "r", "q"))
    return Obligation(
        scope,
        m if scope else TRUE,
        condition,
        c if condition else TRUE,
        Demand(kind, r, ticks, q),
    )


class _Interval:
    """An interval of the scope, seen from any tick inside of it.

    `inside` is true at the ticks of the interval. If it is None, the interval has no end, or (only
    after) it ends after the first run of the mode.
    """

    def __init__(self, scope: ScopeKind | None, mode: Formula) -> None:
        self.scope = scope
        self.m = mode
        self.last = mode if scope in (ScopeKind.IN, ScopeKind.ONLY_AFTER) else not_(mode)
        """A formula that is true where the interval may end, and false right after it."""

    @property
    def outside(self) -> Formula:
        """A formula that is false at each tick of the interval, and true after its end."""
        return FALSE if ends_with_run(self.scope) else not_(self.last)

    def release(self, frees: Formula, x: Formula) -> Formula:
        """X from here on, up to and including the first tick with `frees`, inside."""
        if ends_with_run(self.scope):
            return release(frees, x)
        here = release(or_(not_(self.last), frees), _given(self.last, x))
        if self.scope is not ScopeKind.ONLY_AFTER:
            return here
        return release(or_(self.m, frees), and_(or_(self.m, x), implies(self.m, here)))

    def until(self, g: Formula, h: Formula) -> Formula:
        """H at some tick from here on, and g at all ticks before it, inside."""
        if ends_with_run(self.scope):
            return until(g, h)
        here = until(and_(self.last, g), and_(self.last, h))
        if self.scope is not ScopeKind.ONLY_AFTER:
            return here
        before = not_(self.m)
        return until(and_(before, g), or_(and_(before, h), and_(self.m, here)))

    def throughout(self, x: Formula) -> Formula:
        """X from the present tick on, inside."""
        return self.release(FALSE, x)

    def everywhere(self, obligation: Obligation, demanded: Formula | None = None) -> Formula:
        """The obligation in all intervals of the scope, from the first tick of the trace."""
        m = self.m
        first, always = self._enforced(obligation, demanded)
        kept = and_(first, self.throughout(always))
        match self.scope:
            case None | ScopeKind.ONLY_AFTER:
                return kept
            case ScopeKind.IN | ScopeKind.NOT_IN | ScopeKind.ONLY_IN:
                entered = _given(self.last, first)
                at_entries = globally(or_(self.last, release(self.last, entered)))
                return and_(entered, at_entries, globally(_given(self.last, always)))
            case ScopeKind.BEFORE:
                return or_(m, kept)
            case ScopeKind.AFTER:
                left = release(not_(m), or_(m, kept))
                return release(m, implies(m, left))
            case ScopeKind.ONLY_BEFORE:
                return release(m, implies(m, kept))

    def _enforced(
        self, obligation: Obligation, demanded: Formula | None
    ) -> tuple[Formula, Formula]:
        """The formulas for the first tick of an interval, and for all of its ticks."""
        demand = demanded if demanded is not None else self._demanded(obligation.demand)
        c = obligation.trigger
        if obligation.condition is None:
            return demand, TRUE
        given = implies(c, demand)
        if obligation.condition is ConditionKind.HOLDING:
            return TRUE, given
        return given, or_(c, self.release(c, given))

    def _demanded(self, demand: Demand) -> Formula:
        """The demand at a trigger at the present tick."""
        r, q = demand.response, demand.stop
        match demand.kind:
            case ObligationKind.IMMEDIATELY:
                return r
            case ObligationKind.EVENTUALLY:
                return self.until(TRUE, r)
            case ObligationKind.ALWAYS:
                return self.throughout(r)
            case ObligationKind.UNTIL:
                return self.release(q, or_(q, r))
            case ObligationKind.BEFORE:
                return self.release(r, not_(q))
            case ObligationKind.FINALLY:
                return self._finally(r)
            case (
                ObligationKind.NEXT
                | ObligationKind.WITHIN
                | ObligationKind.FOR
                | ObligationKind.AFTER
                | ObligationKind.NOT_AFTER
            ):
                raise AssertionError(f"it counts ticks: {demand.kind}")
            case _:
                assert_never(demand.kind)

    def _finally(self, r: Formula) -> Formula:
        """No stretch without r leads up to the end of the interval."""
        if ends_with_run(self.scope):
            return TRUE
        idle = and_(self.last, not_(r))
        return self.throughout(not_(and_(idle, until(idle, not_(self.last)))))


def _given(inside: Formula, claim: Formula) -> Formula:
    """`inside -> (a -> b)` as `inside & a -> b`."""
    if isinstance(claim, f.Implies):
        return implies(and_(inside, claim.left), claim.right)
    return implies(inside, claim)
