"""The outcome of each trigger, for a requirement with a probability.

FRET's PCTL* puts the probability around what is demanded at each trigger; the trials are the
triggers of the runs, and each is met or not by that very formula, read at the tick of the trigger
(`compiler.formalization.future.demanded_at`). Triggers are those of the monitor
(`compiler.formalization.past.staged`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from compiler.formalization import predicates
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.future import demanded_at, end_marker
from compiler.formalization.obligation import TRAITS, Demand, Obligation, Trait, obligation
from compiler.formalization.past import scope_formulas
from compiler.logic.evaluation import evaluate_unknown
from compiler.logic.formula import FALSE, Formula
from fretc.audit.measurements.trials import Trials
from fretish.classes.frozen import dataclass
from fretish.expressions import ComparisonOperator
from fretish.reading.recursion import with_recursion_limit
from monitors.kernel import Column


@dataclass(frozen=True, slots=True)
class RequiredProbability:
    """The required probability, and the demand that it is about."""

    op: ComparisonOperator
    bound: str
    """The probability as it is written: `0.99`."""
    obligation: Obligation

    @property
    def text(self) -> str:
        """`>= 0.99`."""
        return f"{self.op} {self.bound}"


@with_recursion_limit
def chance(requirement: FormalizedRequirement) -> RequiredProbability | None:
    """The required probability; None: the sentence has none."""
    probability = requirement.sentence.probability
    if probability is None:
        return None
    return RequiredProbability(
        probability.op,
        probability.digits,
        obligation(requirement.sentence, requirement.ticks or 0, predicates.Past()),
    )


@with_recursion_limit
def trials(obligation: Obligation, columns: Mapping[str, Column], ticks: int) -> Trials:
    """The outcome of each trigger of one run.

    Propositions after the end of the log are unknown, for more ticks than any deadline lies ahead.

    Args:
        obligation: the formula that each trigger demands.
        columns: one for each proposition of the obligation.
        ticks: the length of the run.
    """
    if not ticks:
        return Trials(0, 0, 0)
    triggers = evaluate_unknown(scope_formulas(obligation).trigger, columns, ticks)
    # All deadlines after the end of the run are equivalent.
    demand = replace(obligation.demand, ticks=min(obligation.demand.ticks, ticks))
    met = _met(demand, end_marker(obligation.scope, obligation.mode))
    longer = ticks + demand.ticks + _BEYOND
    ahead = (1 << longer) - (1 << ticks)
    unending = {name: Column(c.true, c.unknown | ahead) for name, c in columns.items()}
    outcome = evaluate_unknown(met, unending, longer)
    forbids = Trait.FORBIDS in TRAITS[demand.kind]
    at_end = evaluate_unknown(met, columns, ticks).true if forbids else 0
    answered = triggers.true & (outcome.true | at_end)
    failed = triggers.true & ~(outcome.true | outcome.unknown)
    return Trials(
        answered=answered.bit_count(),
        failed=failed.bit_count(),
        open=((triggers.true | triggers.unknown) & ~(answered | failed)).bit_count(),
        met_by_end=(answered & ~outcome.true).bit_count(),
    )


def _met(demand: Demand, end: Formula) -> Formula:
    """The formula at a trigger; an interval whose end is unknown still counts as open."""
    if Trait.LAST in TRAITS[demand.kind] and demand.response == FALSE:
        return FALSE
    return demanded_at(demand, end)


_BEYOND = 3
"""The number of ticks after the latest deadline, so that the last tick of all is not before any
deadline."""
