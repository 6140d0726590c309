"""Suspicions: reasons why a result, a probability or a verdict since a review is out of date.

Each suspicion is a phrase. A verdict without suspicions is current.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.result_summaries import Recorded, ResultSummary
from fretc.audit.evidence.verdict_inputs import KINDS, MONITOR, VerdictInputs, why
from fretc.audit.measurements.confidence_intervals import SUPPORTED
from fretc.audit.measurements.trials import Trials
from fretc.traceability.changes import in_words
from fretc.traceability.fingerprints import outdated
from fretc.traceability.lock import Review, ReviewStatus
from fretish import syntax
from monitors import kernel


class AboutResults:
    """Reasons why results of one requirement are suspect; common inputs are compared only once."""

    def __init__(
        self, verdict_inputs: VerdictInputs, audited_by: str, *, formalized: bool = True
    ) -> None:
        """Store the present inputs of a verdict.

        Args:
            verdict_inputs: fingerprints of the present inputs.
            audited_by: the version of fretc that wrote the evidence.
            formalized: whether the sentence is formalized.
        """
        self._verdict_inputs, self._audited_by, self._formalized = (
            verdict_inputs,
            audited_by,
            formalized,
        )
        self._outdated: dict[Recorded, tuple[str, ...]] = {}

    def of(self, result: ResultSummary) -> tuple[str, ...]:
        """The reasons why the result of one run is suspect."""
        recorded = result.rests_on
        if recorded not in self._outdated:
            self._outdated[recorded] = tuple(self._changes(recorded))
        about_log = tuple(_about_log(result))
        outdated_inputs = self._outdated[recorded]
        return (*outdated_inputs, *about_log) if about_log else outdated_inputs

    def _changes(self, recorded: Recorded) -> Iterator[str]:
        if self._formalized:
            yield from map(why, outdated(recorded, self._audited_by, self._verdict_inputs))
        elif (
            recorded[KINDS.index(MONITOR)] == self._verdict_inputs[MONITOR]
        ):  # no monitor then either
            yield "the sentence cannot be formalized now, and could not be formalized at the audit"
        else:
            yield "the sentence could be formalized at the audit, but cannot be formalized now"


def _about_log(result: ResultSummary) -> Iterator[str]:
    if result.verdict in (kernel.SATISFIED, kernel.VACUOUS) and not result.intact:
        yield "the log is damaged, so it cannot show that the requirement holds"
    if result.verdict == kernel.SATISFIED and result.violations:
        yield "the evidence contradicts itself: it lists violations"


def about_estimation(
    estimation: Estimated,
    probability: syntax.Probability,
    runs: Sequence[tuple[str, bool, Trials]],
) -> Iterator[str]:
    """The reasons why an estimate over all runs is suspect.

    Args:
        estimation: the estimate in the evidence.
        probability: the probability in the sentence.
        runs: for each run its content hash, whether its log is intact, and its trials.
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
        yield (
            "the evidence contradicts itself: its results for single runs do not add up to "
            "its result over all runs"
        )
    elif estimation.answer == SUPPORTED and not all(intact for intact, _ in contents):
        yield "a log is damaged, so it cannot support a probability"


def since_review(status: ReviewStatus) -> tuple[str, ...]:
    """The changes since the review in one phrase; "" if the review is valid."""
    if status.review is None or not status.is_suspect:
        return ()
    return (f"{changed_since(status.review)}: {in_words(status.changes)}",)


def changed_since(review: Review) -> str:
    """The phrase for any change since a review."""
    return f"something has changed since the review of {review.date}"
