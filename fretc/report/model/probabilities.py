"""What all runs say of a requirement with a probability: held against the runs, and shown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretc.audit.evidence.probabilities import Estimated, shown
from fretc.audit.measurements.confidence_intervals import SUPPORTED
from fretc.audit.measurements.trials import Trials
from fretc.report.model.views import BoundsView, ProbabilityView, verdict_mark
from fretish import syntax


def contradictions(
    told: Estimated, stated: syntax.Probability, runs: Sequence[tuple[str, bool, Trials]]
) -> Iterator[str]:
    """Why it is not what its runs add up to.

    Args:
        told: what the evidence says of all runs.
        stated: the probability of the sentence.
        runs: of each run what tells its content from another, whether it is intact, its trials.
    """
    if (told.operator, told.bound) != (stated.op, stated.digits):
        yield "the evidence is about another probability"
    once = {content: (intact, counted) for content, intact, counted in reversed(runs)}.values()
    sums = tuple(
        sum(getattr(counted, name) for _, counted in once)
        for name in ("answered", "failed", "open")
    )
    triggers = told.triggers
    if sums != (triggers.answered, triggers.failed, triggers.open):
        yield "the evidence contradicts itself: its runs do not add up to what it says of all"
    elif told.answer == SUPPORTED and not all(intact for intact, _ in once):
        yield "a log is damaged, and no damaged log supports a probability"


# The view --------------------------------------------------------------------------------------


def probability_view(told: Estimated, suspicions: Sequence[str]) -> ProbabilityView:
    """What is shown in the section of the requirement."""
    bars = (BoundsView("by whole logs", told.bounds.low, told.bounds.high),)
    share = "not known" if told.estimate is None else f"{told.estimate:.4f}"
    return ProbabilityView(
        mark=verdict_mark(told.answer, suspect=bool(suspicions)),
        suspicions=tuple(suspicions),
        stated=told.text,
        bound=float(told.bound),
        reason=told.reason,
        lines=told.lines[1:],
        estimate=told.estimate,
        bars=bars,
        text=f"Estimate {share}; bounds, by whole logs, {shown(told.bounds)}; "
        f"the bound of the sentence is {told.bound}.",
    )
