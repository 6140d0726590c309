"""The text of the response that is missing when a requirement is violated, and its deadline."""

from __future__ import annotations

from typing import assert_never

from compiler.formalization.formalized import FormalizedRequirement
from fretc.audit.measurements.violations import DemandText
from fretish import expressions as e
from fretish import syntax as s
from fretish.printer import expression, timing


def demand(requirement: FormalizedRequirement) -> DemandText:
    """The demand of the sentence at each trigger.

    It is the response alone if nothing else can be missing, and the response with its timing
    otherwise.
    """
    sentence = requirement.sentence
    response = expression(sentence.response)
    if sentence.scope is not None and sentence.scope.kind.negates:
        return DemandText(f"not ({timing(sentence.timing)} satisfy {response})".replace("( ", "("))
    match sentence.timing:
        case s.Never():
            return DemandText(expression(e.Not(sentence.response)))
        case s.After():
            return DemandText(
                f"{timing(sentence.timing)} satisfy {response}", requirement.watch.deadline_ticks
            )
        case s.Until() | s.Before():
            return DemandText(f"{timing(sentence.timing)} satisfy {response}")
        case s.Immediately() | s.Next() | s.Within():
            return DemandText(response, requirement.watch.deadline_ticks)
        case s.Finally() | s.Eventually() | s.Always() | s.For():
            return DemandText(response)  # a response that must always hold has no deadline
        case _:
            assert_never(sentence.timing)
