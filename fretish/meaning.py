"""The meaning of a sentence in English, from its tree.

It states what FRETish leaves implicit: which ticks trigger, whether the trigger itself counts, and
what happens at the end of a scope. Source: SEMANTICS of FRETish, section 3.
"""

from __future__ import annotations

from typing import assert_never

from fretish import syntax as s
from fretish.checking import is_formula
from fretish.clock import Clock, in_words
from fretish.printer import expression


def meaning(sentence: s.Sentence, ticks: int | None, clock: Clock | None) -> str:
    """The meaning of the sentence as one or two English sentences.

    Args:
        sentence: the sentence.
        ticks: its duration in ticks; None if it has no duration.
        clock: the declared clock; None if there is none.
    """
    if is_formula(sentence):
        return (
            "The whole run satisfies this formula of linear temporal logic from its first tick on. "
            "It is no sentence of FRETish."
        )
    where, close = _where(sentence.scope)
    q = f"`{expression(sentence.response)}`"
    negated = sentence.scope is not None and sentence.scope.kind.negates
    say = _forbidden if negated else _demanded
    lengths = (span(ticks or 0, clock), span((ticks or 0) + 1, clock))
    when = _when(sentence.condition, sentence.scope)
    demand = say(sentence.timing, q, close, lengths)
    return f"{where}: {when}, {demand}.{_odds(sentence.probability)}"


def _where(scope: s.Scope | None) -> tuple[str, str]:
    """The part of the run in which the sentence is enforced, and the name of that part."""
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
        return "from its first tick on"
    p = f"`{expression(condition.expression)}`"
    start = "the first tick there" if scope else "the first tick"
    match condition.kind:
        case s.ConditionKind.HOLDING:
            return f"at every tick at which {p} is true"
        case s.ConditionKind.TRIGGER:
            return f"at every tick at which {p} becomes true (or is true at {start})"
        case _:
            assert_never(condition.kind)


_Lengths = tuple[str, str]
"""The duration, and the duration plus one tick, as text."""


def _demanded(timing: s.Timing, q: str, close: str, lengths: _Lengths) -> str:
    match timing:
        case s.Immediately():
            return f"{q} must be true at that same tick"
        case s.Next():
            return f"{q} must be true at the next tick, if {close} has one"
        case s.Finally():
            return f"{q} must be true at the last tick of {close}"
        case s.Eventually():
            return _at_some(q, "true", close)
        case s.Always():
            return _at_all(q, "true", close)
        case s.Never():
            return _at_all(q, "false", close)
        case s.Within():
            return _soon(q, "true", close, lengths[0])
        case s.For():
            return _for(q, "true", close, lengths[0])
        case s.After():
            return (
                f"{q} must be false at that tick and for the next {lengths[0]}, or until {close} "
                f"ends, and true at the tick after those, if {close} has it"
            )
        case s.Until(stop):
            return _up_to(q, "true", close, expression(stop))
        case s.Before(stop):
            return _ahead_of(q, "true", close, expression(stop))
        case _:
            assert_never(timing)


def _forbidden(timing: s.Timing, q: str, close: str, lengths: _Lengths) -> str:
    """The negated timing, which `only` scopes require: the dual of `_demanded`."""
    match timing:
        case s.Immediately():
            return f"{q} must be false at that same tick"
        case s.Next():
            return f"{q} must be false at the next tick, if {close} has one"
        case s.Finally():
            return f"{q} must be false at the last tick of {close}"
        case s.Eventually():
            return _at_all(q, "false", close)
        case s.Always():
            return _at_some(q, "false", close)
        case s.Never():
            return _at_some(q, "true", close)
        case s.Within():
            return _for(q, "false", close, lengths[0])
        case s.For():
            return _soon(q, "false", close, lengths[0])
        case s.After():
            return (
                f"{q} must be true at that tick or within the next {lengths[0]}, or else be false "
                f"for the next {lengths[1]} (nothing is required if {close} ends before that)"
            )
        case s.Until(stop):
            return _ahead_of(q, "false", close, expression(stop))
        case s.Before(stop):
            return _up_to(q, "false", close, expression(stop))
        case _:
            assert_never(timing)


def _at_some(q: str, value: str, close: str) -> str:
    return f"{q} must be {value} at that tick or at a later one before {close} ends"


def _at_all(q: str, value: str, close: str) -> str:
    return f"{q} must be {value} at that tick and at every later one until {close} ends"


def _soon(q: str, value: str, close: str, ticks: str) -> str:
    return (
        f"{q} must be {value} at that tick or within the next {ticks} "
        f"(nothing is required if {close} ends before that)"
    )


def _for(q: str, value: str, close: str, ticks: str) -> str:
    return f"{q} must be {value} at that tick and for the next {ticks}, or until {close} ends"


def _up_to(q: str, value: str, close: str, stop: str) -> str:
    return (
        f"{q} must be {value} from that tick on, up to the tick before the first at which "
        f"`{stop}` is true, or until {close} ends"
    )


def _ahead_of(q: str, value: str, close: str, stop: str) -> str:
    return (
        f"if `{stop}` is true at that tick or at a later one before {close} ends, {q} must be "
        f"{value} at some tick from that tick on and before the first of those"
    )


def span(ticks: int, clock: Clock | None) -> str:
    """A number of ticks as text: `2 ticks (200 ms)`."""
    count = f"{ticks} tick{'' if ticks == 1 else 's'}"
    if clock is None or clock.period is None:
        return count
    return f"{count} ({in_words(ticks * clock.period)})"


def _odds(probability: s.Probability | None) -> str:
    if probability is None:
        return ""
    return f" This must hold with a probability {probability.op} {probability.digits}."
