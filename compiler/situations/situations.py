"""Coverage goals (situations): the ways in which a run can meet a sentence.

Each sentence has a list of goals, always in the order of `MEANINGS`. Meaningless goals are left out
(no last tick without a bound). Goals that cannot be reached are included, because only a search can
decide that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import assert_never

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import TRAITS, ObligationKind, Trait
from compiler.logic import formula as f
from compiler.situations.decisions import Operand, operands
from compiler.situations.demands import of_demand
from compiler.situations.thresholds import ThresholdPosition, threshold_positions
from compiler.situations.tick_predicates import TickPredicates, tick_predicates
from fretish import expressions as e
from fretish import syntax as s
from fretish.checking import LOOK_AHEAD, calls, conditions
from fretish.classes.frozen import dataclass
from fretish.clock import duration_text
from fretish.printer import expression
from fretish.reading.recursion import with_recursion_limit

MEANINGS: Mapping[str, str] = {
    "never-enforced": "the run never comes to the scope",
    "never-triggered": "{trigger} triggers nothing in the whole run",
    "triggered-at-start": "triggered at tick 0",
    "triggered-later": "triggered after the first tick of the scope",
    "triggered-while-open": "triggered again while a demand is open",
    "triggered-again": "triggered again, with no demand open",
    "condition-stays": "{trigger} is still true at the tick after a trigger",
    "condition-across-entry": "{trigger} is true before the scope begins, and as it begins",
    "condition-outside": "{trigger} is true outside of the scope",
    "first-interval": "triggered in the first interval of the scope",
    "second-interval": "triggered in a later interval of the scope",
    "mode-again": "{mode} changes again, and no interval begins or ends by it",
    "answered-at-once": "{answer} at the trigger",
    "answered-too-early": "{answer} at the tick before {last}, and not at that",
    "answered-later": "{answer} after the trigger, with time left",
    "answered-at-last-tick": "{answer} at {last}",
    "missed-at-once": "{none} at the trigger",
    "missed-later": "{none} at a later tick",
    "missed-by-one": "{none} at {last}",
    "one-tick-late": "{none} at {last}, and {answer} one tick later",
    "given-up-after": "{answer} up to {last}, and not one tick later",
    "never-answered": "{none} up to {last}, nor at the tick after it",
    "stopped-at-once": "{stop} at the trigger",
    "stopped-later": "{stop} while a demand is open, and {answer}",
    "stopped-unanswered": "{stop} while a demand is open, and {none}",
    "scope-ends-open": "the scope ends while a demand is open",
    "run-ends-open": "the run ends while a demand is open",
    "run-ends-answered": "{answer} at the last tick of the run, in the scope",
    "run-ends-missed": "{none} at the last tick of the run, in the scope",
    "alone-true": "`{operand}` alone makes the {part} true",
    "alone-false": "`{operand}` alone makes the {part} false",
    "threshold-below": "`{measured}` one step below the threshold of `{operand}` ({number})",
    "threshold-at": "`{measured}` at the threshold of `{operand}` ({number})",
    "threshold-above": "`{measured}` one step above the threshold of `{operand}` ({number})",
    "unknown": "`{operand}` is unknown where it decides the {part}",
}
"""The description of each goal, by the first part of its key."""


@dataclass(frozen=True, slots=True)
class Situation:
    """A coverage goal: a way to meet a sentence that a test or a recorded run should show.

    A run reaches the goal at the first tick at which all of its conditions hold.
    """

    key: str
    """A key of `MEANINGS`, a colon and its subject; unique within a requirement."""
    words: str
    """The description for people."""
    formula: f.Formula
    """A past-time formula over the atoms of the sentence."""
    at_end: bool = False
    """Whether only the last tick of a run counts."""
    unknown: str | None = None
    """An atom that must be unknown at that tick. The formula says that the value of the atom
    decides; if parts of the sentence share the atom, the formula must hold for both of its
    values."""
    place: ThresholdPosition | None = None
    """The required position of a number relative to a threshold at that tick: over signals as in
    the bindings, or over the variables of the sentence without bindings."""


@with_recursion_limit
def situations(requirement: FormalizedRequirement, *, exact: bool = False) -> tuple[Situation, ...]:
    """The coverage goals of a requirement, in the order of `MEANINGS`.

    A sentence with predicates that look ahead has none, because no past-time formula describes
    them.

    Args:
        requirement: the requirement.
        exact: whether formulas are exact after a missed deadline, too, for recorded runs
            (`compiler.situations.tick_predicates`); formulas for a search are not.
    """
    if any(
        name in LOOK_AHEAD
        for expression in conditions(requirement.sentence)
        for name in calls(expression)
    ):
        return ()
    predicates, read = tick_predicates(requirement, exact=exact), {*requirement.propositions}
    return tuple(
        goal
        for goal in (*_of_time(requirement, predicates), *_of_operands(requirement, predicates))
        if goal.formula != f.FALSE and read.issuperset(f.atoms(goal.formula))
    )


def _of_time(requirement: FormalizedRequirement, predicates: TickPredicates) -> Iterator[Situation]:
    """The goals about the time of events."""
    passing = dict([*_of_scope(predicates), *_of_triggers(predicates), *of_demand(predicates)])
    passing["scope-ends-open"] = _ends_open(predicates)
    ending = dict(_of_the_end(predicates))
    rows, words = {**passing, **ending}, _words(requirement, predicates)
    for key, meaning in MEANINGS.items():
        if key in rows:
            shown = meaning.format_map(words)
            yield Situation(key, shown, rows[key], at_end=key in ending)


_Rows = Iterator[tuple[str, f.Formula]]


def _of_scope(predicates: TickPredicates) -> _Rows:
    """The goals about the begin and the recurrence of intervals."""
    inside, triggered = predicates.inside, predicates.triggered
    scope, mode = predicates.whole.scope, predicates.whole.mode
    match scope:
        case None:
            return
        case s.ScopeKind.IN | s.ScopeKind.NOT_IN | s.ScopeKind.ONLY_IN:
            ended_before = f.once(predicates.ended)
            yield "first-interval", f.and_(triggered, f.not_(ended_before))
            yield "second-interval", f.and_(triggered, ended_before)
        case s.ScopeKind.BEFORE:
            yield "mode-again", f.and_(f.previous(f.once(mode)), f.not_(mode))
        case s.ScopeKind.AFTER:
            yield "mode-again", f.and_(inside, mode)
        case s.ScopeKind.ONLY_BEFORE:
            yield "mode-again", f.and_(inside, f.not_(mode))
        case s.ScopeKind.ONLY_AFTER:
            yield "mode-again", f.and_(f.not_(inside), mode)
        case _:
            assert_never(scope)
    if predicates.whole.condition is not None:
        p = predicates.whole.trigger
        yield "condition-outside", f.and_(p, f.not_(inside))
        if not _begins_with_run(scope):
            yield "condition-across-entry", f.and_(predicates.stage.left, p, f.previous(p))


def _begins_with_run(scope: s.ScopeKind) -> bool:
    """Whether the scope's single interval begins at tick 0, or never."""
    match scope:
        case s.ScopeKind.BEFORE | s.ScopeKind.ONLY_AFTER:
            return True
        case s.ScopeKind.IN | s.ScopeKind.NOT_IN | s.ScopeKind.ONLY_IN:
            return False
        case s.ScopeKind.AFTER | s.ScopeKind.ONLY_BEFORE:
            return False
        case _:
            assert_never(scope)


def _of_triggers(predicates: TickPredicates) -> _Rows:
    """The goals about first and repeated triggers."""
    triggered = predicates.triggered
    scope, is_unconditional = predicates.whole.scope, predicates.whole.condition is None
    if not (
        is_unconditional and (scope is None or _begins_with_run(scope))
    ):  # else each first one does
        yield "triggered-at-start", f.and_(f.FIRST, triggered)
    if is_unconditional:
        return
    p = predicates.whole.trigger
    yield "triggered-later", f.and_(triggered, f.not_(predicates.stage.left))
    yield "triggered-while-open", f.and_(triggered, predicates.was_open)
    yield "condition-stays", f.and_(p, f.previous(triggered))
    if not _lasts(predicates.demand.kind):
        before = f.previous(f.once(triggered))
        yield "triggered-again", f.and_(triggered, before, f.not_(predicates.was_open))


def _lasts(kind: ObligationKind) -> bool:
    """Whether a demand stays open as long as its interval, whatever is answered."""
    match kind:
        case ObligationKind.FINALLY | ObligationKind.ALWAYS:
            return True
        case (
            ObligationKind.IMMEDIATELY
            | ObligationKind.NEXT
            | ObligationKind.EVENTUALLY
            | ObligationKind.WITHIN
            | ObligationKind.FOR
        ):
            return False
        case (
            ObligationKind.AFTER
            | ObligationKind.NOT_AFTER
            | ObligationKind.UNTIL
            | ObligationKind.BEFORE
        ):
            return False
        case _:
            assert_never(kind)


def _ends_open(predicates: TickPredicates) -> f.Formula:
    """Formula: the interval is over, and its end decided or cancelled an open demand."""
    if Trait.LAST in TRAITS[predicates.demand.kind]:
        return f.FALSE  # it says already which last ticks there are
    return f.and_(predicates.ended, f.previous(predicates.open))


def _of_the_end(predicates: TickPredicates) -> _Rows:
    """The goals about the last tick of the run."""
    if predicates.stage.left != f.FIRST:  # else the first tick lies in it
        yield "never-enforced", f.not_(f.once(predicates.inside))
    if predicates.whole.condition is not None:
        yield "never-triggered", f.not_(f.once(predicates.triggered))
    if Trait.LAST in TRAITS[predicates.demand.kind]:
        yield "run-ends-answered", f.and_(predicates.waiting, predicates.answer)
        yield "run-ends-missed", f.and_(predicates.waiting, f.not_(predicates.answer))
    elif not _lasts(predicates.demand.kind):
        yield "run-ends-open", predicates.open


# What decides -----------------------------------------------------------------------------------


def _of_operands(
    requirement: FormalizedRequirement, predicates: TickPredicates
) -> Iterator[Situation]:
    """The goals about single operands, in the order of `MEANINGS`."""
    goals = [
        goal
        for operand in operands(requirement, predicates)
        for goal in _of_operand(requirement, operand)
    ]
    order = [*MEANINGS]
    yield from sorted(goals, key=lambda goal: order.index(goal.key.partition(":")[0]))


def _of_operand(requirement: FormalizedRequirement, operand: Operand) -> Iterator[Situation]:
    declared = requirement.declarations.propositions if requirement.declarations else {}
    bound = declared.get(operand.atom or "")
    stated = operand.expression if bound is None else bound.expression
    shown = stated if isinstance(operand.expression, e.Comparison) else operand.expression
    about = f"{operand.part.partition(' ')[0]}:{_short(shown)}"
    texts = {"operand": expression(shown), "part": operand.part}

    def situation(
        key: str,
        formula: f.Formula,
        place: ThresholdPosition | None = None,
        unknown: str | None = None,
    ) -> Situation:
        numbers = {} if place is None else _numbers(place)
        words = MEANINGS[key].format(**texts, **numbers)
        return Situation(f"{key}:{about}", words, formula, unknown=unknown, place=place)

    if operand.decides == f.FALSE:
        return
    if not operand.alone:
        yield situation("alone-true", f.and_(operand.decides, operand.whole))
        yield situation("alone-false", f.and_(operand.decides, f.not_(operand.whole)))
    for comparison, key, place in _places(stated):
        goal = situation(key, operand.decides, place)
        several = "" if comparison == shown else f":{_short(comparison)}"
        yield replace(goal, key=f"{goal.key}{several}")
    if operand.atom is not None:
        yield situation("unknown", operand.decides, unknown=operand.atom)


def _numbers(place: ThresholdPosition) -> Mapping[str, str]:
    return {"measured": expression(place.measured), "number": expression(place.number)}


def _places(stated: e.Expression) -> Iterator[tuple[e.Comparison, str, ThresholdPosition]]:
    """The thresholds of each comparison in an operand, or in its proposition."""
    for part in dict.fromkeys(e.parts(stated)):
        if isinstance(part, e.Comparison):
            yield from (
                (part, f"threshold-{key}", place) for key, place in threshold_positions(part)
            )


def _short(part: e.Expression) -> str:
    return expression(part).replace(" ", "")


# Words ------------------------------------------------------------------------------------------


def _words(requirement: FormalizedRequirement, predicates: TickPredicates) -> Mapping[str, str]:
    """The words for the placeholders in `MEANINGS`."""
    sentence = requirement.written
    stop, response = s.stop(sentence.timing), expression(sentence.response)
    texts = {
        "mode": expression(sentence.scope.mode) if sentence.scope else "",
        "trigger": expression(sentence.condition.expression) if sentence.condition else "",
        "stop": "" if stop is None else expression(stop),
    }
    given = (f"`{response}`", f"no `{response}`")
    answer, none = reversed(given) if _is_negative(sentence, predicates.demand.kind) else given
    quoted = {name: f"`{text}`" for name, text in texts.items()}
    return {
        **quoted,
        "answer": answer,
        "none": none,
        "last": _last(sentence, predicates.demand.kind),
    }


def _is_negative(sentence: s.Sentence, kind: ObligationKind) -> bool:
    """Whether the response must be false."""
    never = s.SHAPES[type(sentence.timing)].quantifier is s.Quantifier.NONE
    negates = sentence.scope is not None and sentence.scope.kind.negates
    return never is not (negates and Trait.OPPOSITES not in TRAITS[kind])


def _last(sentence: s.Sentence, kind: ObligationKind) -> str:
    """The words for the last tick of a demand."""
    bound = s.duration(sentence.timing)
    span = "" if bound is None else duration_text(bound)
    several = sentence.condition is not None
    first = "the first open trigger" if several else "the trigger"
    newest = "the newest trigger" if several else "the trigger"
    match kind:
        case ObligationKind.IMMEDIATELY:
            return "the trigger"
        case ObligationKind.NEXT:
            return "the tick after the trigger"
        case ObligationKind.FINALLY | ObligationKind.EVENTUALLY | ObligationKind.ALWAYS:
            return "the last tick of the scope"
        case ObligationKind.FOR:
            return f"the last tick that counts ({span} after {newest})"
        case ObligationKind.WITHIN | ObligationKind.NOT_AFTER:
            return f"the last tick that counts ({span} after {first})"
        case ObligationKind.AFTER:
            return f"the one tick that counts ({span} after {first}, and one more)"
        case ObligationKind.UNTIL | ObligationKind.BEFORE:
            return "the last tick before the stop"
        case _:
            assert_never(kind)
