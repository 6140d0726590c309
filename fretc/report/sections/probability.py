"""The answer of all runs about the probability of a requirement."""

from __future__ import annotations

from collections.abc import Sequence

from fretc.audit.evidence.probabilities import Estimated, shown
from fretc.report.model.views import BoundsView, ProbabilityView, verdict_mark


def probability_view(estimation: Estimated, suspicions: Sequence[str]) -> ProbabilityView:
    """The view of an estimation with its suspicions."""
    bars = (BoundsView("by whole logs", estimation.bounds.low, estimation.bounds.high),)
    share = "not known" if estimation.estimate is None else f"{estimation.estimate:.4f}"
    return ProbabilityView(
        mark=verdict_mark(estimation.answer, suspect=bool(suspicions)),
        suspicions=tuple(suspicions),
        stated=estimation.text,
        bound=float(estimation.bound),
        reason=estimation.reason,
        lines=estimation.lines[1:],
        estimate=estimation.estimate,
        bars=bars,
        text=f"Estimate {share}; bounds, by whole logs, {shown(estimation.bounds)}; "
        f"the bound of the sentence is {estimation.bound}.",
    )
