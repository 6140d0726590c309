"""Whether any run can violate a requirement; if none can, `satisfied` has little meaning.

A run violates if no endless continuation satisfies the sentence any more (`violation` or
`violation_inevitable` of its monitor), or if it ends with an open demand and the clock declares
that a violation. Source: Alpern, Schneider, Defining liveness, Information Processing Letters 21
(1985): a property that no finite run can violate is a liveness property.
"""

from __future__ import annotations

from compiler.formalization.anticipation import SHORT
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import possible_letters, temporal_predicate
from compiler.formalization.reference import BROKEN, TooManyStatesError, explore, template
from compiler.logic.formula import FALSE
from fretish.clock import End

_MOST_STATES = 500


def is_violable(requirement: FormalizedRequirement) -> bool:
    """Whether a run can get the verdict `violated`; True if that was not decided."""
    watch = requirement.watch
    if (
        requirement.clock is not None
        and requirement.clock.end is End.VIOLATED
        and watch.obligation_pending != FALSE
    ):
        return True
    if watch.violation == FALSE and watch.violation_inevitable == FALSE:
        return False
    return _is_lost_somewhere(requirement)


def limit(requirement: FormalizedRequirement) -> str:
    """The reason why no run can violate the requirement, as one sentence; empty if a run can."""
    if is_violable(requirement):
        return ""
    if requirement.watch.obligation_pending == FALSE:
        return f"No run can violate {requirement.id}: every run satisfies it."
    return (
        f"No run can violate {requirement.id}: it sets no bound, so an answer that has not come "
        "may always come later."
    )


def _is_lost_somewhere(requirement: FormalizedRequirement) -> bool:
    """Whether a state of the automaton, over the possible letters, makes a violation certain."""
    sentence = requirement.sentence
    if temporal_predicate(sentence):
        return True
    short = template(sentence, min(requirement.ticks or 0, SHORT))
    try:
        automaton = explore(short, possible_letters(sentence), _MOST_STATES)
    except TooManyStatesError:
        return True
    return "violated" in automaton.verdicts or any(BROKEN in row for row in automaton.moves)
