"""Past-time formulas about one tick: triggered, open, answered k ticks later.

A demand is open after a tick if later ticks can still break or meet it: the counter of the
reference automaton is not 0 then, unless something was broken. The formulas are also true after a
violation.

Two forms measure the distance to the first open trigger. They differ only after a deadline of
`within`, `after` or the dual of `after` has passed without an answer. The exact form is for
recorded runs: it remembers every trigger, which is cheap over columns. The other form is for
searches over all runs: a counter that starts with a trigger, so that a long bound costs the
logarithm of its ticks; after such a deadline it counts again once an answer has come.

Source: `compiler.formalization.reference`, the definition as counters, with which tests compare
this module.
"""

from __future__ import annotations

from functools import cached_property
from typing import assert_never

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import (
    TRAITS,
    Demand,
    Obligation,
    ObligationKind,
    Trait,
    obligation,
)
from compiler.formalization.past import ScopeFormulas, scope_formulas
from compiler.formalization.predicates import Past
from compiler.logic import formula as f
from fretish.classes.frozen import dataclass
from fretish.syntax import ConditionKind, ScopeKind


@dataclass(frozen=True)
class TickPredicates:
    """Formulas about a tick, over the atoms of the sentence."""

    whole: Obligation
    exact: bool = False
    """Whether distances are exact after a missed deadline, too; see the module's description."""

    @cached_property
    def stage(self) -> ScopeFormulas:
        """Where the sentence is enforced, and where its demands begin."""
        return scope_formulas(self.whole)

    @property
    def demand(self) -> Demand:
        """The demand of a trigger; for an `only` scope, the dual of the written timing."""
        return self.whole.demand

    @property
    def inside(self) -> f.Formula:
        """The tick lies in an interval of the scope."""
        return self.stage.inside

    @property
    def ended(self) -> f.Formula:
        """The tick is the first one after an interval; FALSE if no interval ends."""
        return self.stage.leaves

    @property
    def triggered(self) -> f.Formula:
        """A demand begins at this tick."""
        return self.stage.trigger

    @property
    def answer(self) -> f.Formula:
        """The response has the demanded value: for `never`, it is false."""
        return self.demand.response

    @cached_property
    def open(self) -> f.Formula:
        """After this tick a demand is open."""
        stage, n = self.stage, self.demand.ticks
        q, silent = self.answer, f.not_(self.answer)
        match self.demand.kind:
            case ObligationKind.IMMEDIATELY:
                return f.FALSE
            case ObligationKind.NEXT:
                return stage.trigger
            case ObligationKind.FINALLY:
                return stage.open(f.TRUE)
            case ObligationKind.ALWAYS:
                return stage.open(q)
            case ObligationKind.EVENTUALLY:
                return stage.open(silent)
            case ObligationKind.WITHIN:
                return stage.open(silent, f.Interval(0, n - 1)) if n else f.FALSE
            case ObligationKind.AFTER | ObligationKind.NOT_AFTER:
                return stage.open(silent, f.Interval(0, n))
            case ObligationKind.FOR:
                return stage.open(q, f.Interval(0, n - 1)) if n else f.FALSE
            case ObligationKind.UNTIL:
                return stage.open(f.and_(q, f.not_(self.demand.stop)))
            case ObligationKind.BEFORE:
                return stage.open(f.and_(silent, f.not_(self.demand.stop)))
            case _:
                assert_never(self.demand.kind)

    @cached_property
    def was_open(self) -> f.Formula:
        """A demand that was open after the tick before still applies at this one."""
        return f.and_(self.inside, f.previous(self.open))

    @cached_property
    def waiting(self) -> f.Formula:
        """A demand begins at this tick, or was open after the tick before."""
        return f.or_(self.triggered, self.was_open)

    def oldest(self, ticks: int) -> f.Formula:
        """The first open trigger lies `ticks` ticks back.

        The answer at this tick is ignored.
        """
        if self.exact:
            older = self._unanswered(ticks + 1, self._longest)
            here = self._unanswered(ticks, ticks) if ticks else self.triggered
            return f.and_(here, f.not_(older))
        unanswered = f.and_(self.inside, f.previous(self.stage.open(f.not_(self.answer))))
        first = f.and_(self.triggered, f.not_(unanswered))
        if ticks == 0:
            return first
        near = f.once(first, f.Interval(0, ticks - 1))
        return f.and_(unanswered, f.previous(near), f.not_(near))

    @cached_property
    def has_time(self) -> f.Formula:
        """A demand was open, and the first open trigger lies less than the bound back."""
        n = self.demand.ticks
        if self.exact:
            late = self._unanswered(n, self._longest)
            return f.and_(self.was_open, f.not_(late))
        return f.and_(self.was_open, f.once(self.oldest(0), f.Interval(0, n - 1)))

    @property
    def _longest(self) -> int:
        """The maximum number of ticks for which a demand is open."""
        n = self.demand.ticks
        match self.demand.kind:
            case ObligationKind.WITHIN:
                return n
            case (
                ObligationKind.AFTER | ObligationKind.NOT_AFTER
            ):  # the answer comes a tick after the bound
                return n + 1
            case (
                ObligationKind.IMMEDIATELY
                | ObligationKind.NEXT
                | ObligationKind.FINALLY
                | ObligationKind.EVENTUALLY
                | ObligationKind.ALWAYS
                | ObligationKind.FOR
                | ObligationKind.UNTIL
                | ObligationKind.BEFORE
            ):
                raise AssertionError("no trigger of these is asked for by its age")
            case _:
                assert_never(self.demand.kind)

    def _unanswered(self, least: int, most: int) -> f.Formula:
        """A trigger lies `least` to `most` ticks back, at least one, without an answer since."""
        if most < least:
            return f.FALSE
        back = f.Interval(least - 1, most - 1)
        return f.and_(self.inside, f.previous(self.stage.open(f.not_(self.answer), back)))

    def newest(self, ticks: int, kept: f.Formula = f.TRUE) -> f.Formula:
        """The last trigger of this interval lies `ticks` ticks back.

        Args:
            ticks: from the trigger to this tick.
            kept: a formula that has held since, this tick excluded.
        """
        if ticks == 0:
            return self.triggered
        near = f.Interval(0, ticks - 1)
        since = f.previous(self.stage.open(kept, near))
        return f.and_(self.inside, since, f.not_(self.stage.open(f.TRUE, near)))

    # What decides here -------------------------------------------------------------------------

    @cached_property
    def asks_for_mode(self) -> f.Formula:
        """The mode at this tick decides where the sentence is enforced."""
        match self.whole.scope:
            case None:
                return f.FALSE
            case ScopeKind.IN | ScopeKind.NOT_IN | ScopeKind.ONLY_IN:
                return f.TRUE
            case ScopeKind.BEFORE | ScopeKind.ONLY_AFTER:
                return f.not_(f.previous(self.stage.over))
            case ScopeKind.AFTER | ScopeKind.ONLY_BEFORE:
                return f.not_(f.previous(self.inside))
            case _:
                assert_never(self.whole.scope)

    @cached_property
    def asks_for_condition(self) -> f.Formula:
        """The condition at this tick decides whether a demand begins that changes anything."""
        match self.whole.condition:
            case None:
                return f.FALSE
            case ConditionKind.HOLDING:
                can_trigger = self.inside
            case ConditionKind.TRIGGER:
                p = self.whole.trigger
                fell = f.weak_previous if self.stage.left == f.FIRST else f.previous
                rises = f.or_(self.stage.left, fell(f.not_(p)))
                can_trigger = f.and_(self.inside, rises)
            case _:
                assert_never(self.whole.condition)
        return f.and_(can_trigger, self._takes_a_trigger)

    @property
    def _takes_a_trigger(self) -> f.Formula:
        """A trigger at this tick would change what is demanded."""
        unanswered, closed = f.not_(self.answer), f.not_(self.was_open)
        match self.demand.kind:
            case ObligationKind.IMMEDIATELY | ObligationKind.NOT_AFTER:
                return unanswered
            case ObligationKind.NEXT:
                return f.or_(closed, self.answer)
            case ObligationKind.FOR:
                return f.or_(closed, self.answer) if self.demand.ticks else unanswered
            case ObligationKind.AFTER:
                in_order = f.iff(self.answer, self.oldest(self.demand.ticks + 1))
                return f.or_(closed, in_order)
            case ObligationKind.FINALLY | ObligationKind.ALWAYS:
                return closed
            case ObligationKind.EVENTUALLY | ObligationKind.WITHIN:
                return f.and_(closed, unanswered)
            case ObligationKind.UNTIL:
                return f.and_(closed, f.not_(self.demand.stop))
            case ObligationKind.BEFORE:
                return f.and_(closed, f.or_(self.demand.stop, unanswered))
            case _:
                assert_never(self.demand.kind)

    @cached_property
    def asks_for_answer(self) -> f.Formula:
        """The response at this tick decides something, if only one more violation."""
        stage, demand = self.stage, self.demand
        match demand.kind:
            case ObligationKind.IMMEDIATELY:
                return self.triggered
            case ObligationKind.NEXT:
                return self.was_open
            case ObligationKind.ALWAYS:
                return stage.open(f.TRUE)
            case ObligationKind.FOR:
                return stage.open(f.TRUE, f.Interval(0, demand.ticks))
            case (
                ObligationKind.FINALLY
                | ObligationKind.EVENTUALLY
                | ObligationKind.WITHIN
                | ObligationKind.NOT_AFTER
            ):
                return self.waiting
            case ObligationKind.AFTER:
                clash = f.and_(self.triggered, self.oldest(demand.ticks + 1))
                return f.and_(self.waiting, f.not_(clash))
            case ObligationKind.UNTIL:
                return stage.open(f.not_(demand.stop))
            case ObligationKind.BEFORE:
                return f.and_(self.waiting, f.not_(demand.stop))
            case _:
                assert_never(demand.kind)

    @cached_property
    def asks_for_stop(self) -> f.Formula:
        """The stop condition at this tick decides something."""
        return self.waiting if Trait.STOPS in TRAITS[self.demand.kind] else f.FALSE


def tick_predicates(requirement: FormalizedRequirement, *, exact: bool = False) -> TickPredicates:
    """The predicates of a requirement, with temporal predicates as past-time formulas."""
    return TickPredicates(obligation(requirement.sentence, requirement.ticks or 0, Past()), exact)
