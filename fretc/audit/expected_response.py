"""What is missing where a requirement is violated: its response, in words and with its deadline."""

from __future__ import annotations

from compiler.formalization.rule import Rule
from fretc.audit.measurements.violations import Demand
from fretish import expressions as e
from fretish import syntax as s
from fretish.printer import expression, timing


def demand(rule: Rule) -> Demand:
    """What the sentence demands at each trigger.

    The response alone where it is all that can be missing; with its timing where more can be.
    """
    sentence = rule.sentence
    response = expression(sentence.response)
    if sentence.scope is not None and sentence.scope.kind.negates:
        return Demand(f"not ({timing(sentence.timing)} satisfy {response})".replace("( ", "("))
    match sentence.timing:
        case s.Never():
            return Demand(expression(e.Not(sentence.response)))
        case s.Until() | s.Before() | s.After():
            return Demand(f"{timing(sentence.timing)} satisfy {response}", _horizon(rule))
        case _:
            return Demand(response, _horizon(rule))


def _horizon(rule: Rule) -> int | None:
    """Ticks from a trigger to the latest response; what must hold all the time has no latest."""
    waits = isinstance(rule.sentence.timing, s.Immediately | s.Next | s.Within | s.After)
    return rule.watch.horizon if waits else None
