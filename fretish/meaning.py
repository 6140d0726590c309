"""The meaning of a sentence in English, made from its tree.

Says what FRETish leaves to be known: which ticks trigger, whether the trigger itself counts,
what happens at the end of a scope. Source: SEMANTICS of FRETish, section 3.
"""

from __future__ import annotations

from typing import assert_never

from fretish import syntax as s
from fretish.clock import Clock, milliseconds
from fretish.printer import expression


def meaning(sentence: s.Sentence, ticks: int | None, clock: Clock | None) -> str:
    """One or two English sentences.

    Args:
        sentence: the sentence.
        ticks: what its duration counts, None where it has none.
        clock: what a tick is, None where no clock is declared.
    """
    where, close = _where(sentence.scope)
    negated = sentence.scope is not None and sentence.scope.kind.negates
    demand = _demand(sentence.timing, expression(sentence.response), ticks, clock, close)
    if negated:
        demand = f"it must not be that {demand.replace(' must be ', ' is ')}"
    parts = f"{where}: {_when(sentence.condition, sentence.scope)}, {demand}."
    return parts + _odds(sentence.probability)


def _where(scope: s.Scope | None) -> tuple[str, str]:
    """Where the sentence is enforced, and what ends the stretch."""
    if scope is None:
        return "Over the whole run", "the run"
    m = f"`{expression(scope.mode)}`"
    match scope.kind:
        case s.ScopeKind.IN:
            return f"In every stretch of ticks on which {m} is true", "the stretch"
        case s.ScopeKind.NOT_IN:
            return f"In every stretch of ticks on which {m} is false", "the stretch"
        case s.ScopeKind.ONLY_IN:
            return f"Outside of {m}, in every stretch of ticks on which it is false", "the stretch"
        case s.ScopeKind.BEFORE:
            return f"Before the first tick at which {m} is true", "that part"
        case s.ScopeKind.AFTER:
            return f"After the first stretch of ticks on which {m} is true", "the run"
        case s.ScopeKind.ONLY_BEFORE:
            return f"From the first tick at which {m} is true", "the run"
        case s.ScopeKind.ONLY_AFTER:
            return f"Up to the end of the first stretch of ticks on which {m} is true", "that part"
        case _:
            assert_never(scope.kind)


def _when(condition: s.Condition | None, scope: s.Scope | None) -> str:
    if condition is None:
        return "from its first tick on" if scope else "from the first tick on"
    p = f"`{expression(condition.expression)}`"
    match condition.kind:
        case s.ConditionKind.HOLDING:
            return f"at every tick at which {p} is true"
        case s.ConditionKind.TRIGGER:
            return f"at every tick at which {p} becomes true (or is true at the start)"
        case _:
            assert_never(condition.kind)


def _demand(
    timing: s.Timing, response: str, ticks: int | None, clock: Clock | None, close: str
) -> str:
    q = f"`{response}`"
    match timing:
        case s.Immediately():
            return f"{q} must be true at that same tick"
        case s.Next():
            return f"{q} must be true at the next tick, if {close} has one"
        case s.Finally():
            return f"{q} must be true at the last tick of {close}"
        case s.Eventually():
            return f"{q} must be true at that tick or at a later one before {close} ends"
        case s.Always():
            return f"{q} must be true at that tick and at every later one until {close} ends"
        case s.Never():
            return f"{q} must be false at that tick and at every later one until {close} ends"
        case s.Until(stop):
            return (
                f"{q} must be true from that tick on, up to the tick before `{expression(stop)}` "
                f"becomes true or until {close} ends"
            )
        case s.Before(stop):
            return f"{q} must be true at some tick before `{expression(stop)}` is, if it ever is"
        case _:
            return _counted(timing, q, ticks or 0, clock, close)


def _counted(
    timing: s.Within | s.For | s.After, q: str, ticks: int, clock: Clock | None, close: str
) -> str:
    n = span(ticks, clock)
    match timing:
        case s.Within():
            return (
                f"{q} must be true at that tick or within the next {n} "
                f"(nothing is required if {close} ends before that)"
            )
        case s.For():
            return f"{q} must be true at that tick and for the next {n}, or until {close} ends"
        case s.After():
            return (
                f"{q} must be false at that tick and for the next {n}, and true at the tick "
                f"after those, unless {close} ends before"
            )
        case _:
            assert_never(timing)


def span(ticks: int, clock: Clock | None) -> str:
    """`2 ticks (200 ms)`."""
    count = f"{ticks} tick{'' if ticks == 1 else 's'}"
    if clock is None or clock.period is None:
        return count
    return f"{count} ({milliseconds(ticks * clock.period)})"


def _odds(probability: s.Probability | None) -> str:
    if probability is None:
        return ""
    return f" This must hold with a probability {probability.op} {probability.digits}."
