"""The past-time formula of a sentence, and its monitor specification.

`past` is true at the last tick of a finite trace exactly if the trace satisfies the sentence, and
at every earlier tick for the trace up to there. `monitor_spec` expresses the same as signals that a
monitor computes at each tick: where a demand is triggered, broken and still open.

Source: SEMANTICS of FRETish, section 3; the shapes follow Giannakopoulou et al., IST 137 (2021),
section 5, rebuilt from the meaning.
"""

from __future__ import annotations

from typing import assert_never

from compiler.formalization.obligation import TRAITS, Demand, Obligation, ObligationKind, Trait
from compiler.logic import prefixes
from compiler.logic.formula import (
    EVER,
    FALSE,
    FIRST,
    TRUE,
    And,
    Atom,
    Formula,
    Historically,
    Implies,
    Interval,
    Not,
    Or,
    and_,
    historically,
    implies,
    not_,
    once,
    or_,
    previous,
    since,
    weak_previous,
)
from compiler.logic.printing import PLAIN, text
from fretish.classes.frozen import dataclass
from fretish.syntax import ConditionKind, ScopeKind
from monitors.kernel.verdicts import Signals


@dataclass(frozen=True, slots=True)
class MonitorSpec:
    """One sentence as signals over past-time formulas, for a monitor.

    The trace up to a tick satisfies the sentence, as FRET's finite semantics has it, when
    `violation` was true at no tick up to there and `violated_if_ended` is not true there.
    """

    trigger: Formula
    """A demand begins at this tick."""
    violation: Formula
    """A demand is broken at this tick, and nothing later can repair it."""
    violation_inevitable: Formula
    """Open demands that no endless trace can meet, though none of them is broken yet."""
    obligation_pending: Formula
    """A demand is open: later ticks decide it, unless a demand was broken before."""
    violated_if_ended: Formula
    """The trace violates the sentence if it ends at this tick, though nothing is broken yet."""
    satisfied_forever: Formula
    """No continuation on an infinite trace can break a demand, unless one was broken before."""
    answer: Formula | None
    """The response that meets a demand, if a demand waits for one."""
    deadline_ticks: int | None
    """Ticks from a trigger to its deadline; None if there is no deadline."""
    renewed: bool
    """A trigger replaces the demand of the trigger before it: only the latest one is open."""
    missing: str = ""
    """Why the signals say nothing: no formulas of the past have the meaning; empty: they do."""

    @property
    def signals(self) -> Signals[Formula]:
        """The signals that a monitor reports at each tick."""
        return Signals(
            self.trigger,
            self.violation,
            self.violation_inevitable,
            self.obligation_pending,
            self.violated_if_ended,
            self.satisfied_forever,
            self.answer if self.answer is not None else FALSE,
        )


@dataclass(frozen=True, slots=True)
class ScopeFormulas:
    """Formulas for the ticks at which a sentence is enforced, and at which demands begin."""

    inside: Formula
    """The present tick lies in an interval of the scope."""
    left: Formula
    """It is the first of its interval."""
    trigger: Formula
    """A demand begins here (and the tick lies inside)."""
    leaves: Formula
    """It is the first tick after an interval."""
    over: Formula
    """No interval is here or follows."""
    recurs: bool
    """Whether demands can begin at more than one tick."""

    @property
    def endless(self) -> bool:
        """Whether an interval lasts for ever once it has begun."""
        return self.leaves == FALSE

    def open(self, kept: Formula, ago: Interval = EVER) -> Formula:
        """Formula: this interval had a trigger `ago` ticks back, and `kept` has held since."""
        if self.trigger == self.left and ago == EVER:
            if kept == TRUE:
                return self.inside  # every tick inside has the first of its interval behind it
            if self.left == FIRST and self.inside == TRUE:
                return historically(kept)
        return since(and_(kept, self.inside), and_(self.trigger, kept), ago)


def past(obligation: Obligation) -> Formula:
    """The formula about the trace up to now, in FRET's operators."""
    stage, demand = scope_formulas(obligation), obligation.demand
    broken = or_(_broken_plainly(demand, stage), _broken_at_end(demand, stage))
    return and_(historically(_unless(broken)), _unless(_violated_if_ended(demand, stage)))


def monitor_spec(obligation: Obligation) -> MonitorSpec:
    """The signals of a monitor; counting operators look back from now, never from a deadline."""
    stage, demand = scope_formulas(obligation), obligation.demand
    violation = or_(_broken(demand, stage), _broken_at_end(demand, stage))
    pending, ended = _obligation_pending(demand, stage), _violated_if_ended(demand, stage)
    traits = TRAITS[demand.kind]
    return MonitorSpec(
        trigger=stage.trigger,
        violation=violation,
        violation_inevitable=_violation_inevitable(demand, stage),
        obligation_pending=pending,
        violated_if_ended=ended,
        satisfied_forever=TRUE
        if violation == pending == ended == FALSE
        else _satisfied_forever(demand, stage),
        answer=and_(stage.inside, demand.response) if Trait.WAITS in traits else None,
        deadline_ticks=_deadline_ticks(demand),
        renewed=Trait.RENEWED in traits,
    )


def monitor_spec_of_formula(formula: Formula) -> MonitorSpec:
    """The signals of a monitor of a formula of the future; it has one demand, from tick 0 on."""
    try:
        violation = prefixes.bad_prefix(formula)
        ended = prefixes.ends_badly(formula, strict=False)
        pending = prefixes.ends_badly(formula, strict=True)
    except prefixes.UntranslatableError as error:
        nothing = (FALSE,) * 6
        return MonitorSpec(*nothing, None, None, renewed=False, missing=str(error))
    return MonitorSpec(
        trigger=FIRST,
        violation=violation,
        violation_inevitable=FALSE,
        obligation_pending=pending,
        violated_if_ended=ended,
        satisfied_forever=once(prefixes.good_prefix(formula) or FALSE),
        answer=None,
        deadline_ticks=None,
        renewed=False,
    )


def past_of_formula(formula: Formula, watch: MonitorSpec) -> Formula:
    """The formula about the trace up to now; if there is none, the formula itself as an atom."""
    if watch.missing:
        return Atom(f"({text(formula, PLAIN)})")
    return and_(historically(not_(watch.violation)), not_(watch.violated_if_ended))


# Scope and condition -----------------------------------------------------------------------


def scope_formulas(obligation: Obligation) -> ScopeFormulas:
    """The scope and the condition of a sentence, as formulas about the ticks up to now."""
    inside, left, leaves = _interval(obligation.scope, obligation.mode)
    p = obligation.trigger
    match obligation.condition:
        case None:
            trigger = left
        case ConditionKind.HOLDING:
            trigger = and_(inside, p)
        case ConditionKind.TRIGGER:
            # p rises, or is true as the interval begins.
            enters = weak_previous(not_(p)) if left == FIRST else or_(left, previous(not_(p)))
            trigger = and_(inside, p, enters)
        case _:
            assert_never(obligation.condition)
    over = _over(obligation.scope, obligation.mode)
    recurs = obligation.condition is not None or obligation.scope in _REPEATED
    return ScopeFormulas(inside, left, trigger, leaves, over, recurs)


_REPEATED = (ScopeKind.IN, ScopeKind.NOT_IN, ScopeKind.ONLY_IN)
"""Scopes that have an interval for each stretch of the mode."""


def _over(scope: ScopeKind | None, m: Formula) -> Formula:
    """The scope's one interval has ended, or can never begin."""
    match scope:
        case ScopeKind.BEFORE:
            return once(m)
        case ScopeKind.ONLY_AFTER:
            return once(and_(not_(m), previous(m)))
        case _:
            return FALSE


def _interval(scope: ScopeKind | None, m: Formula) -> tuple[Formula, Formula, Formula]:
    """Inside an interval; at its first tick; at the first tick after it."""
    first_run_over = and_(not_(m), previous(m))
    match scope:
        case None:
            return TRUE, FIRST, FALSE
        case ScopeKind.IN:
            return m, and_(m, weak_previous(not_(m))), and_(not_(m), previous(m))
        case ScopeKind.NOT_IN | ScopeKind.ONLY_IN:
            return not_(m), and_(not_(m), weak_previous(m)), and_(m, previous(not_(m)))
        case ScopeKind.BEFORE:
            before = historically(not_(m))
            return before, and_(not_(m), FIRST), and_(m, previous(before))
        case ScopeKind.AFTER:
            after = once(first_run_over)
            return after, and_(first_run_over, not_(previous(after))), FALSE
        case ScopeKind.ONLY_BEFORE:
            return once(m), and_(m, not_(previous(once(m)))), FALSE
        case ScopeKind.ONLY_AFTER:
            until = not_(once(first_run_over))
            return until, FIRST, and_(first_run_over, previous(until))
        case _:
            assert_never(scope)


def first_marker(scope: ScopeKind | None, m: Formula) -> Formula:
    """True at the first tick of an interval, and at no other tick of it."""
    return _interval(scope, m)[1]


# Demands -----------------------------------------------------------------------------------


def _broken(demand: Demand, stage: ScopeFormulas) -> Formula:
    """A demand is broken here; a missed deadline stays broken until the answer comes."""
    q, n = demand.response, demand.ticks
    match demand.kind:
        case ObligationKind.WITHIN:
            return _overdue(q, n, stage)
        case ObligationKind.FOR:
            return and_(stage.open(TRUE, Interval(0, n)), not_(q))
        case ObligationKind.AFTER:
            early = and_(stage.open(TRUE, Interval(0, n)), q)
            return or_(early, _overdue(q, n + 1, stage))
        case ObligationKind.NOT_AFTER:
            silent = previous(stage.open(not_(q), Interval(n, n)))
            return and_(stage.inside, silent, q)
        case (
            ObligationKind.IMMEDIATELY
            | ObligationKind.NEXT
            | ObligationKind.FINALLY
            | ObligationKind.EVENTUALLY
            | ObligationKind.ALWAYS
        ):
            return _broken_plainly(demand, stage)
        case ObligationKind.UNTIL | ObligationKind.BEFORE:
            return _broken_plainly(demand, stage)
        case _:
            assert_never(demand.kind)


def _overdue(q: Formula, n: int, stage: ScopeFormulas) -> Formula:
    """A trigger n ticks ago or more has had no answer yet."""
    return stage.open(not_(q), Interval(n, None))


def _broken_plainly(demand: Demand, stage: ScopeFormulas) -> Formula:
    """As `_broken`, with the operators of FRET: a deadline is missed at one tick."""
    q, s, n = demand.response, demand.stop, demand.ticks
    match demand.kind:
        case ObligationKind.IMMEDIATELY:
            return and_(stage.trigger, not_(q))
        case ObligationKind.NEXT:
            return and_(stage.inside, previous(stage.trigger), not_(q))
        case ObligationKind.FINALLY | ObligationKind.EVENTUALLY:
            return FALSE
        case ObligationKind.ALWAYS:
            return and_(stage.open(TRUE), not_(q))
        case ObligationKind.WITHIN:
            return _missed(q, n, stage)
        case ObligationKind.FOR:
            return and_(_recent(n, stage), not_(q))
        case ObligationKind.AFTER:
            return or_(and_(_recent(n, stage), q), _missed(q, n + 1, stage))
        case ObligationKind.NOT_AFTER:
            asked = once(and_(stage.trigger, not_(q)), Interval(n + 1, n + 1))
            answered = once(q, Interval(1, n)) if n else FALSE
            return and_(stage.inside, asked, not_(or_(_began(n, stage), answered)), q)
        case ObligationKind.UNTIL:
            return and_(stage.open(not_(s)), not_(q))
        case ObligationKind.BEFORE:
            unanswered = and_(stage.inside, previous(stage.open(not_(q))))
            return and_(s, or_(stage.trigger, unanswered))
        case _:
            assert_never(demand.kind)


def _missed(q: Formula, n: int, stage: ScopeFormulas) -> Formula:
    """A trigger exactly n ticks ago, in this interval, has had no answer up to now."""
    asked = once(and_(stage.trigger, not_(q)), Interval(n, n))
    answered = once(or_(stage.left, q), Interval(0, n - 1)) if n else FALSE
    return and_(stage.inside, asked, not_(answered))


def _recent(n: int, stage: ScopeFormulas) -> Formula:
    """A trigger of this interval lies no more than n ticks back."""
    recently = once(stage.trigger, Interval(0, n))
    return recently if stage.inside == TRUE else and_(recently, stage.open(TRUE))


def _began(n: int, stage: ScopeFormulas) -> Formula:
    """The interval began no more than n ticks ago."""
    return once(stage.left, Interval(0, n))


def _broken_at_end(demand: Demand, stage: ScopeFormulas) -> Formula:
    """The interval is over, and its last tick left a demand unmet."""
    if stage.leaves == FALSE:
        return FALSE
    return and_(stage.leaves, previous(_violated_if_ended(demand, stage)))


def _violated_if_ended(demand: Demand, stage: ScopeFormulas) -> Formula:
    """The interval may not end here."""
    match demand.kind:
        case ObligationKind.FINALLY:
            return and_(stage.open(TRUE), not_(demand.response))
        case ObligationKind.EVENTUALLY:
            return stage.open(not_(demand.response))
        case (
            ObligationKind.IMMEDIATELY
            | ObligationKind.NEXT
            | ObligationKind.ALWAYS
            | ObligationKind.WITHIN
            | ObligationKind.FOR
            | ObligationKind.AFTER
        ):
            return FALSE
        case ObligationKind.NOT_AFTER | ObligationKind.UNTIL | ObligationKind.BEFORE:
            return FALSE
        case _:
            assert_never(demand.kind)


def _obligation_pending(demand: Demand, stage: ScopeFormulas) -> Formula:
    """A demand waits for what follows.

    Demands without a deadline that only forbid (`always`, `until`, `before`) wait for nothing:
    they are kept as long as they are not broken.
    """
    q, n = demand.response, demand.ticks
    match demand.kind:
        case ObligationKind.NEXT:
            return stage.trigger
        case ObligationKind.FINALLY:
            return stage.open(TRUE)
        case ObligationKind.EVENTUALLY:
            return stage.open(not_(q))
        case ObligationKind.WITHIN | ObligationKind.AFTER:
            return stage.open(not_(q))  # one that is overdue has been broken before
        case ObligationKind.FOR:
            return stage.open(TRUE, Interval(0, n - 1)) if n else FALSE
        case ObligationKind.NOT_AFTER:
            return stage.open(not_(q), Interval(0, n))
        case (
            ObligationKind.IMMEDIATELY
            | ObligationKind.ALWAYS
            | ObligationKind.UNTIL
            | ObligationKind.BEFORE
        ):
            return FALSE
        case _:
            assert_never(demand.kind)


def _violation_inevitable(demand: Demand, stage: ScopeFormulas) -> Formula:
    """Demands are open that cannot all be met.

    Where an interval can end before the deadline, its end would void them.
    """
    if not (stage.endless and stage.recurs):
        return FALSE
    match demand.kind:
        case ObligationKind.AFTER:
            # The response may not come up to n ticks after this trigger, and must come before.
            return and_(stage.trigger, previous(stage.open(not_(demand.response))))
        case (
            ObligationKind.IMMEDIATELY
            | ObligationKind.NEXT
            | ObligationKind.FINALLY
            | ObligationKind.EVENTUALLY
            | ObligationKind.ALWAYS
        ):
            return FALSE
        case (
            ObligationKind.WITHIN
            | ObligationKind.FOR
            | ObligationKind.NOT_AFTER
            | ObligationKind.UNTIL
            | ObligationKind.BEFORE
        ):
            return FALSE
        case _:
            assert_never(demand.kind)


def _satisfied_forever(demand: Demand, stage: ScopeFormulas) -> Formula:
    """Every demand has been met, and no other can begin."""
    if Trait.LAST in TRAITS[demand.kind] and stage.endless:
        return TRUE  # an interval without an end has no last tick
    return stage.over if stage.recurs else or_(stage.over, _met(demand, stage))


def _met(demand: Demand, stage: ScopeFormulas) -> Formula:
    """The one demand, of the first tick of the interval, has been met or has passed."""
    q, n = demand.response, demand.ticks
    match demand.kind:
        case ObligationKind.IMMEDIATELY:
            return once(stage.left)
        case ObligationKind.NEXT:
            return once(stage.left, Interval(1, None))
        case ObligationKind.FOR:
            return once(stage.left, Interval(n, None))
        case ObligationKind.EVENTUALLY | ObligationKind.WITHIN | ObligationKind.BEFORE:
            return once(and_(stage.inside, q))
        case ObligationKind.UNTIL:
            return once(and_(stage.inside, demand.stop))
        case ObligationKind.AFTER:
            return once(stage.left, Interval(n + 1, None))
        case ObligationKind.NOT_AFTER:
            return or_(once(and_(stage.inside, q)), once(stage.left, Interval(n + 1, None)))
        case ObligationKind.FINALLY | ObligationKind.ALWAYS:
            return FALSE
        case _:
            assert_never(demand.kind)


def _deadline_ticks(demand: Demand) -> int | None:
    match demand.kind:
        case ObligationKind.IMMEDIATELY:
            return 0
        case ObligationKind.NEXT:
            return 1
        case ObligationKind.WITHIN | ObligationKind.FOR:
            return demand.ticks
        case ObligationKind.AFTER | ObligationKind.NOT_AFTER:
            return demand.ticks + 1
        case (
            ObligationKind.FINALLY
            | ObligationKind.EVENTUALLY
            | ObligationKind.ALWAYS
            | ObligationKind.UNTIL
            | ObligationKind.BEFORE
        ):
            return None
        case _:
            assert_never(demand.kind)


def _unless(broken: Formula) -> Formula:
    """`! broken`, as a reader would write it: `a & !b` becomes `a -> b`."""
    match broken:
        case And(args):
            return implies(and_(*args[:-1]), _unless(args[-1]))
        case Or(args):
            return and_(*map(_unless, args))
        case Historically(arg, ago):
            return once(_unless(arg), ago)
        case Implies(left, right):
            return and_(left, _unless(right))
        case Not(arg):
            return arg
        case _:
            return not_(broken)
