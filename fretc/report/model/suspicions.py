"""Why a verdict does not count: suspicions about a result, about a probability, since a review.

Each suspicion is a phrase. A verdict without suspicions is current.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretc.audit.evidence.basis import Basis, why
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.schema import Result
from fretc.audit.measurements.confidence_intervals import SUPPORTED
from fretc.audit.measurements.trials import Trials
from fretc.report.traceability.chain import outdated
from fretc.report.traceability.changes import in_words
from fretc.report.traceability.lock import Review, Standing
from fretish import syntax
from monitors import kernel


def about_result(result: Result, basis: Basis | None, audited_by: str) -> Iterator[str]:
    """Why the result of one run does not count.

    Args:
        result: as the evidence has it.
        basis: what a verdict would rest on now; None: the sentence cannot be formalized.
        audited_by: the version of fretc that wrote the evidence.
    """
    if basis is None:
        yield "the sentence cannot be formalized now"
    else:
        yield from map(why, outdated(result, audited_by, basis))
    if result.verdict in (kernel.SATISFIED, kernel.VACUOUS) and not result.health.intact:
        yield "the log is damaged, and a damaged log cannot show this"
    if result.verdict == kernel.SATISFIED and result.violations:
        yield "the evidence contradicts itself: it lists violations"


def about_estimation(
    estimation: Estimated,
    probability: syntax.Probability,
    runs: Sequence[tuple[str, bool, Trials]],
) -> Iterator[str]:
    """Why an estimation from all runs does not count: it does not agree with its runs.

    Args:
        estimation: what the evidence says of all runs together.
        probability: that of the sentence.
        runs: of each run the identity of its content, whether its log is intact, its trials.
    """
    if (estimation.operator, estimation.bound) != (probability.op, probability.digits):
        yield "the evidence is about another probability"
    contents = {content: (intact, trials) for content, intact, trials in reversed(runs)}.values()
    sums = tuple(
        sum(getattr(trials, name) for _, trials in contents)
        for name in ("answered", "failed", "open")
    )
    triggers = estimation.triggers
    if sums != (triggers.answered, triggers.failed, triggers.open):
        yield "the evidence contradicts itself: its runs do not add up to what it says of all"
    elif estimation.answer == SUPPORTED and not all(intact for intact, _ in contents):
        yield "a log is damaged, and no damaged log supports a probability"


def since_review(standing: Standing) -> tuple[str, ...]:
    """What has changed since the review, in one phrase; empty where the review stands."""
    if standing.review is None or not standing.is_suspect:
        return ()
    return (f"{changed_since(standing.review)}: {in_words(standing.changes)}",)


def changed_since(review: Review) -> str:
    """That something has changed since a review, without what it is."""
    return f"something has changed since the review of {review.date}"
