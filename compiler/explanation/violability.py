"""Whether any run can violate a requirement: of one that none can violate, `satisfied` says little.

A run violates where no endless continuation keeps the sentence any more, as its monitor tells by
`breach` and `doom`; or where it ends with an open demand, if the clock says that this is a
violation. Source: Alpern, Schneider, Defining liveness, Information Processing Letters 21 (1985):
what no finite run can violate is a liveness property.
"""

from __future__ import annotations

from compiler.formalization.anticipation import SHORT
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import occurring, temporal_predicate
from compiler.formalization.reference import BROKEN, TooManyStatesError, explore, template
from compiler.logic.formula import FALSE
from fretish.clock import End

_MOST_STATES = 500


def is_violable(requirement: FormalizedRequirement) -> bool:
    """Whether a run can get the verdict `violated`; where that is not found out, it can."""
    watch = requirement.watch
    if (
        requirement.clock is not None
        and requirement.clock.end is End.VIOLATED
        and watch.owed != FALSE
    ):
        return True
    if watch.breach == FALSE and watch.doom == FALSE:
        return False
    return _is_lost_somewhere(requirement)


def limit(requirement: FormalizedRequirement) -> str:
    """Why no run can violate it, as one sentence; empty where one can."""
    if is_violable(requirement):
        return ""
    if requirement.watch.owed == FALSE:
        return f"No run can violate {requirement.id}: every run satisfies it."
    return (
        f"No run can violate {requirement.id}: it sets no bound, so an answer that has not come "
        "may "
        "always come later."
    )


def _is_lost_somewhere(requirement: FormalizedRequirement) -> bool:
    """Whether the automaton of the sentence, over the letters that can occur, has a lost state."""
    sentence = requirement.sentence
    if temporal_predicate(sentence):
        return True
    short = template(sentence, min(requirement.ticks or 0, SHORT))
    try:
        automaton = explore(short, occurring(sentence), _MOST_STATES)
    except TooManyStatesError:
        return True
    return "violated" in automaton.verdicts or any(BROKEN in row for row in automaton.moves)
