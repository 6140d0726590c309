"""The demand of a sentence at each trigger, as formulas without time.

This is the step between syntax tree and temporal formulas: expressions become Boolean formulas,
durations become ticks, and `only` scopes get their negated timing (SEMANTICS: the negated forms are
duals). Source: Giannakopoulou, Pressburger, Mavridou, Schumann, Automated formalization of
structured natural language requirements, IST 137 (2021), section 4.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum, Flag, auto
from functools import partial
from typing import Protocol, assert_never

from compiler.logic import formula as f
from compiler.logic.printing import identifier, is_compound
from fretish import expressions as e
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.printer import identifier as quoted


class ObligationKind(Enum):
    """The timings, after `never` has become `always not` and a missing one `eventually`."""

    IMMEDIATELY = auto()
    NEXT = auto()
    FINALLY = auto()
    EVENTUALLY = auto()
    ALWAYS = auto()
    WITHIN = auto()
    FOR = auto()
    AFTER = auto()
    NOT_AFTER = auto()
    """The dual of `AFTER`: the response comes too early, or not right after."""
    UNTIL = auto()
    BEFORE = auto()


class Trait(Flag):
    """Properties of kinds of demand."""

    STEPS = auto()
    """Its verdict may change where a trace stutters."""
    COUNTS = auto()
    """A counter of ticks records how long the demand has been open."""
    DOWN = auto()
    """The counter counts down to where the demand ends."""
    REGISTERS = auto()
    """The counter is a register with a bit for each trigger."""
    WAITS = auto()
    """One response meets the demand."""
    RENEWED = auto()
    """A trigger replaces the demand of the trigger before it."""
    STOPS = auto()
    """It has a stop condition."""
    FORBIDS = auto()
    """It only forbids, without a deadline: it is met unless it is broken."""
    OPPOSITES = auto()
    """It asks for the response at a tick and for its opposite at others: so does its dual."""
    LAST = auto()
    """It is about the last tick of its interval alone."""
    UNMET = auto()
    """It fails where its interval ends too soon."""


TRAITS: Mapping[ObligationKind, Trait] = {
    ObligationKind.IMMEDIATELY: Trait(0),
    ObligationKind.NEXT: Trait.STEPS | Trait.RENEWED,
    ObligationKind.FINALLY: Trait.LAST | Trait.UNMET,
    ObligationKind.EVENTUALLY: Trait.WAITS | Trait.UNMET,
    ObligationKind.ALWAYS: Trait.FORBIDS,
    ObligationKind.WITHIN: Trait.STEPS | Trait.COUNTS | Trait.WAITS,
    ObligationKind.FOR: Trait.STEPS | Trait.COUNTS | Trait.DOWN | Trait.RENEWED,
    ObligationKind.AFTER: Trait.STEPS | Trait.COUNTS | Trait.WAITS | Trait.OPPOSITES,
    ObligationKind.NOT_AFTER: Trait.STEPS
    | Trait.COUNTS
    | Trait.REGISTERS
    | Trait.RENEWED
    | Trait.OPPOSITES,
    ObligationKind.UNTIL: Trait.STOPS | Trait.FORBIDS,
    ObligationKind.BEFORE: Trait.STOPS | Trait.FORBIDS,
}


@dataclass(frozen=True, slots=True)
class Demand:
    """At each trigger: `response`, as `kind` says, counting `ticks` or watching for `stop`."""

    kind: ObligationKind
    response: f.Formula
    ticks: int = 0
    stop: f.Formula = f.FALSE


@dataclass(frozen=True, slots=True)
class Obligation:
    """A whole sentence: where (scope), when (condition), what (demand).

    `scope` None is the whole trace, `condition` None triggers once, at the start of the scope.
    """

    scope: s.ScopeKind | None
    mode: f.Formula
    condition: s.ConditionKind | None
    trigger: f.Formula
    demand: Demand

    @property
    def atoms(self) -> tuple[str, ...]:
        """The atoms of all parts, each once."""
        parts = (self.mode, self.trigger, self.demand.response, self.demand.stop)
        return tuple(dict.fromkeys(name for part in parts for name in f.atoms(part)))


Expand = Callable[[str, tuple[e.Expression, ...], "Read"], f.Formula | None]
"""Expands a call (name, arguments, reader of arguments) into a formula; None keeps it a
proposition."""

Read = Callable[[e.Expression], f.Formula]


class TemporalPredicates(Protocol):
    """The meaning of temporal predicates, in the past or in the future."""

    def alone(self) -> Expand:
        """The expansion in the expression of a scope, where no interval exists yet."""

    def inside(self, scope: s.ScopeKind | None, mode: f.Formula) -> Expand:
        """The expansion in condition, stop condition and response, within the interval."""


class Uninterpreted:
    """A vocabulary in which every predicate stays a proposition."""

    def alone(self) -> Expand:
        """Expand nothing."""
        return lambda name, args, read: None

    def inside(self, scope: s.ScopeKind | None, mode: f.Formula) -> Expand:
        """Expand nothing."""
        return self.alone()


def obligation(
    sentence: s.Sentence, ticks: int, vocabulary: TemporalPredicates | None = None
) -> Obligation:
    """The obligation of a sentence.

    Args:
        sentence: a checked sentence.
        ticks: the duration in ticks; 0 if there is none.
        vocabulary: the meaning of temporal predicates; None leaves them propositions.
    """
    words = vocabulary or Uninterpreted()
    scope, condition = sentence.scope, sentence.condition
    kind = scope.kind if scope else None
    mode = boolean(scope.mode, words.alone()) if scope else f.TRUE
    read = partial(boolean, expand=words.inside(kind, mode))
    demand = _demand(sentence.timing, read, sentence.response, ticks)
    return Obligation(
        kind,
        mode,
        condition.kind if condition else None,
        read(condition.expression) if condition else f.TRUE,
        dual(demand) if scope and scope.kind.negates else demand,
    )


def _demand(timing: s.Timing, read: Read, satisfied: e.Expression, ticks: int) -> Demand:
    response = read(satisfied)
    match timing:
        case s.Immediately():
            return Demand(ObligationKind.IMMEDIATELY, response)
        case s.Next():
            return Demand(ObligationKind.NEXT, response)
        case s.Finally():
            return Demand(ObligationKind.FINALLY, response)
        case s.Eventually():
            return Demand(ObligationKind.EVENTUALLY, response)
        case s.Always():
            return Demand(ObligationKind.ALWAYS, response)
        case s.Never():
            return Demand(ObligationKind.ALWAYS, f.not_(response))
        case s.Within():
            return Demand(ObligationKind.WITHIN, response, ticks)
        case s.For():
            return Demand(ObligationKind.FOR, response, ticks)
        case s.After():
            return Demand(ObligationKind.AFTER, response, ticks)
        case s.Until(stop):
            return Demand(ObligationKind.UNTIL, response, stop=read(stop))
        case s.Before(stop):
            return Demand(ObligationKind.BEFORE, response, stop=read(stop))
        case _:
            assert_never(timing)


_DUALS: Mapping[ObligationKind, ObligationKind] = {
    ObligationKind.IMMEDIATELY: ObligationKind.IMMEDIATELY,
    ObligationKind.NEXT: ObligationKind.NEXT,
    ObligationKind.FINALLY: ObligationKind.FINALLY,
    ObligationKind.EVENTUALLY: ObligationKind.ALWAYS,
    ObligationKind.ALWAYS: ObligationKind.EVENTUALLY,
    ObligationKind.WITHIN: ObligationKind.FOR,
    ObligationKind.FOR: ObligationKind.WITHIN,
    ObligationKind.AFTER: ObligationKind.NOT_AFTER,
    ObligationKind.NOT_AFTER: ObligationKind.AFTER,
    ObligationKind.UNTIL: ObligationKind.BEFORE,
    ObligationKind.BEFORE: ObligationKind.UNTIL,
}


def dual(demand: Demand) -> Demand:
    """The negated timing, which an `only` scope demands outside of the scope."""
    kind = _DUALS[demand.kind]
    response = demand.response if Trait.OPPOSITES in TRAITS[kind] else f.not_(demand.response)
    return Demand(kind, response, demand.ticks, demand.stop)


def boolean(expression: e.Expression, expand: Expand) -> f.Formula:
    """A Boolean expression as a formula; comparisons become atoms, and calls that stay."""
    read = partial(boolean, expand=expand)
    match expression:
        case e.Truth(value):
            return f.Const(value)
        case e.Name("FTP"):
            return expand("FTP", (), read) or f.Atom("FTP")
        case e.Name(id):
            return f.Atom(variable(id))
        case e.Comparison():
            return f.Atom(atom(expression))
        case e.Call(name, args):
            return expand(name, args, read) or f.Atom(atom(expression))
        case e.Not(arg):
            return f.not_(read(arg))
        case e.And(args):
            return f.and_(*map(read, args))
        case e.Or(args):
            return f.or_(*map(read, args))
        case e.Xor(left, right):
            return f.xor(read(left), read(right))
        case e.Implies(left, right):
            return f.implies(read(left), read(right))
        case e.Iff(left, right):
            return f.iff(read(left), read(right))
        case e.Temporal(operator, args, bounds):
            return _temporal(operator, tuple(map(read, args)), bounds)
        case (
            e.Number()
            | e.Quantity()
            | e.Word()
            | e.Negation()
            | e.Arithmetic()
            | e.Calculation()
            | e.Persistence()
        ):
            raise AssertionError(f"not a truth value of a sentence: {expression}")
        case _:
            assert_never(expression)


def _temporal(
    operator: e.TemporalOperator, args: tuple[f.Formula, ...], bounds: tuple[int, int] | None
) -> f.Formula:
    ahead = f.EVER if bounds is None else f.Interval(*bounds)
    left, right = args[0], args[-1]
    match operator:
        case "X":
            return f.next_(right)
        case "F":
            return f.eventually(right, ahead)
        case "G":
            return f.globally(right, ahead)
        case "U":
            return f.until(left, right)
        case "R":
            return f.release(left, right)
        case "W":
            return f.release(right, f.or_(left, right))
        case _:
            assert_never(operator)


def variable(id: str) -> str:
    """The name of an atom that is a variable.

    A quoted name may look like the text of a comparison: then it keeps its quotes.
    """
    return f'"{id}"' if is_compound(id) else id


def atom(expression: e.Expression) -> str:
    """FRET's text of an atom: every operator in parentheses, `(x + (2 * y))`."""
    match expression:
        case e.Comparison(op, left, right) | e.Arithmetic(op, left, right):
            return f"({atom(left)} {op} {atom(right)})"
        case e.Negation(arg):
            return f"(- {atom(arg)})"
        case e.Call(name, args):
            return f"{identifier(name)}({','.join(atom(arg) for arg in args)})"
        case e.Name(id):
            return identifier(id)  # as everywhere in formulas: `a.b` is `a_DOT_b`
        case e.Number(digits):
            return digits
        case e.Quantity(digits, unit):
            return f"{digits} {unit}"
        case e.Word(text):
            return quoted(text)
        case e.Truth(value):
            return str(value).upper()
        case _:
            return f"({_boolean_atom(expression)})"


def _boolean_atom(expression: e.Expression) -> str:
    """A Boolean argument of a call."""
    match expression:
        case e.Not(arg):
            return f"! {atom(arg)}"
        case e.And(args):
            return " & ".join(map(atom, args))
        case e.Or(args):
            return " | ".join(map(atom, args))
        case e.Xor(left, right):
            return f"{atom(left)} xor {atom(right)}"
        case e.Implies(left, right):
            return f"{atom(left)} -> {atom(right)}"
        case e.Iff(left, right):
            return f"{atom(left)} <-> {atom(right)}"
        case _:
            raise AssertionError(f"not an argument: {expression}")
