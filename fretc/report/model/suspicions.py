"""Why a verdict does not count: suspicions about a result, about a probability, since a review.

Each suspicion is a phrase. A verdict without suspicions is current.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretc.audit.evidence.basis import KINDS, MONITOR, Basis, why
from fretc.audit.evidence.briefs import Brief, Recorded
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.measurements.confidence_intervals import SUPPORTED
from fretc.audit.measurements.trials import Trials
from fretc.traceability.chain import outdated
from fretc.traceability.changes import in_words
from fretc.traceability.lock import Review, ReviewedRequirement
from fretish import syntax
from monitors import kernel


class AboutResults:
    """Why results of one requirement do not count; what many have in common is compared once."""

    def __init__(self, basis: Basis, audited_by: str, *, formalized: bool = True) -> None:
        """Begin with what a verdict would rest on now.

        Args:
            basis: of the requirement.
            audited_by: the version of fretc that wrote the evidence.
            formalized: whether the sentence is.
        """
        self._basis, self._audited_by, self._formalized = basis, audited_by, formalized
        self._outdated: dict[Recorded, tuple[str, ...]] = {}

    def of(self, result: Brief) -> tuple[str, ...]:
        """Why the result of one run does not count."""
        recorded = result.rests_on
        if recorded not in self._outdated:
            self._outdated[recorded] = tuple(self._changes(recorded))
        return (*self._outdated[recorded], *_about_log(result))

    def _changes(self, recorded: Recorded) -> Iterator[str]:
        if self._formalized:
            yield from map(why, outdated(recorded, self._audited_by, self._basis))
        elif recorded[KINDS.index(MONITOR)] == self._basis[MONITOR]:  # there was none, either
            yield "the sentence cannot be formalized, and could not at the audit"
        else:
            yield "the sentence could be formalized at the audit, and cannot be now"


def _about_log(result: Brief) -> Iterator[str]:
    if result.verdict in (kernel.SATISFIED, kernel.VACUOUS) and not result.intact:
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


def since_review(standing: ReviewedRequirement) -> tuple[str, ...]:
    """What has changed since the review, in one phrase; empty where the review stands."""
    if standing.review is None or not standing.is_suspect:
        return ()
    return (f"{changed_since(standing.review)}: {in_words(standing.changes)}",)


def changed_since(review: Review) -> str:
    """That something has changed since a review, without what it is."""
    return f"something has changed since the review of {review.date}"
