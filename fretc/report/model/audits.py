"""The audits of one requirement: a result for each run, or a probability over all runs."""

from __future__ import annotations

from dataclasses import dataclass

from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.result_summaries import ResultSummary
from fretc.report.model.views import Mark, verdict_mark
from monitors import kernel


@dataclass(frozen=True, slots=True)
class SingleAudit:
    """The result of one run, and the reasons why it is suspect."""

    result: ResultSummary
    suspicions: tuple[str, ...]
    place: int = 0
    """Index of the result in the evidence."""

    @property
    def verdict(self) -> str:
        """The verdict of the result; `violated` if the result lists a violation."""
        violations = self.result.violations and self.result.trials is None
        return kernel.VIOLATED if violations else self.result.verdict

    @property
    def is_stale(self) -> bool:
        """Whether the result is about another version."""
        return bool(self.suspicions)

    @property
    def mark(self) -> Mark:
        """Verdict and currency."""
        return verdict_mark(self.verdict, suspect=self.is_stale)

    def since(self, review: tuple[str, ...]) -> SingleAudit:
        """The audit, with the reasons why it is suspect since a review.

        Args:
            review: what has changed since the review; "" if nothing has.
        """
        return SingleAudit(self.result, review, self.place) if review and self.mark.shows else self


@dataclass(frozen=True, slots=True)
class ProbabilityAudit:
    """The answer of all runs about a probability, and the reasons why it is suspect."""

    estimation: Estimated
    suspicions: tuple[str, ...]

    @property
    def mark(self) -> Mark:
        """Answer and currency."""
        return verdict_mark(self.estimation.answer, suspect=bool(self.suspicions))
