"""The operands of a sentence, and the formula for the ticks at which each alone decides.

An operand decides at a tick if its opposite value would change the whole expression, and that would
change what the sentence demands. Each operand has to be shown true and shown false at such a tick.
Operands that cannot change alone, because they read the same numbers, need no pair of ticks that
are otherwise equal: that is the masking form of the criterion.

Source: Chilenski, An investigation of three forms of the modified condition decision coverage
criterion, DOT/FAA/AR-01/18, 2001.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import Read, boolean
from compiler.formalization.predicates import Past
from compiler.logic import formula as f
from compiler.situations.changes import is_large
from compiler.situations.tick_predicates import TickPredicates
from fretish import expressions as e
from fretish import syntax as s
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Operand:
    """An operand of Boolean operators: a name, a comparison, or a call."""

    part: str
    """`mode`, `condition`, `response` or `stop condition`."""
    expression: e.Expression
    atom: str | None
    """The name in formulas; None if the operand refers to other ticks."""
    whole: f.Formula
    """The expression that contains the operand."""
    decides: f.Formula
    """Formula: the value of the operand at this tick decides; independent of that value."""
    alone: bool
    """Whether the operand is the whole expression, or its negation."""


def operands(requirement: FormalizedRequirement, predicates: TickPredicates) -> Iterator[Operand]:
    """The operands of each part of a sentence; none of a large part."""
    sentence = requirement.sentence
    scope, condition, stop = sentence.scope, sentence.condition, s.stop(sentence.timing)
    past, kind = Past(), scope.kind if scope else None
    inside = partial(boolean, expand=past.inside(kind, predicates.whole.mode))
    if scope is not None:
        read = partial(boolean, expand=past.alone())
        yield from _operands("mode", scope.mode, read, predicates.asks_for_mode)
    if condition is not None:
        asked = predicates.asks_for_condition
        yield from _operands("condition", condition.expression, inside, asked)
    yield from _operands("response", sentence.response, inside, predicates.asks_for_answer)
    if stop is not None:
        yield from _operands("stop condition", stop, inside, predicates.asks_for_stop)


def _operands(part: str, whole: e.Expression, read: Read, asked: f.Formula) -> Iterator[Operand]:
    if is_large(whole):
        return
    joined = [*dict.fromkeys(_joined(whole))]
    for operand in joined:
        value = read(operand)
        name = value.name if isinstance(value, f.Atom) else None
        changes = f.xor(
            read(_with(whole, operand, value=True)), read(_with(whole, operand, value=False))
        )
        decides = f.and_(asked, changes)
        yield Operand(part, operand, name, read(whole), decides, alone=len(joined) == 1)


def _joined(whole: e.Expression) -> Iterator[e.Expression]:
    match whole:
        case e.Not() | e.And() | e.Or() | e.Xor() | e.Implies() | e.Iff():
            for child in e.children(whole):
                yield from _joined(child)
        case e.Truth():
            return
        case _:
            yield whole


def _with(whole: e.Expression, operand: e.Expression, *, value: bool) -> e.Expression:
    """The expression with an operand replaced by a truth value everywhere."""
    match whole:
        case e.Not() | e.And() | e.Or() | e.Xor() | e.Implies() | e.Iff():
            parts = [_with(child, operand, value=value) for child in e.children(whole)]
            return e.with_children(whole, parts)
        case _:
            return e.Truth(value) if whole == operand else whole
