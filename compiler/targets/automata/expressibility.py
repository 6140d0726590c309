"""Refusals of sentences that have no automaton, or one that is too large."""

from __future__ import annotations

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import temporal_predicate
from compiler.formalization.reference import TooManyStatesError
from compiler.targets.automata.chart import MOST_STATES, explored
from compiler.targets.target import not_expressible
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic


def refusal(requirement: FormalizedRequirement, target: str) -> Diagnostic | None:
    """F601 or F670 if the sentence has no automaton, or one that is too large."""
    return no_automaton(requirement, target) or _too_large(requirement)


def no_automaton(requirement: FormalizedRequirement, target: str) -> Diagnostic | None:
    """F601 for a sentence that a counter automaton cannot express."""
    if requirement.pctl is not None:
        return not_expressible(
            target, requirement, "the probability", "leave it out, or use `--emit prism`"
        )
    predicate = temporal_predicate(requirement.sentence)
    if predicate is not None:
        return not_expressible(
            target,
            requirement,
            f"the predicate `{predicate}`",
            "state it by a condition or a timing, or check it with `--emit monitor`",
        )
    return None


def _too_large(requirement: FormalizedRequirement) -> Diagnostic | None:
    try:
        explored(requirement)
    except TooManyStatesError:
        return diagnostic(
            "automaton_too_large",
            requirement.entry.wording,
            requirement=requirement.id,
            most=MOST_STATES,
        )
    return None
