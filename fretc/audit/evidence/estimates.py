"""The answers of all runs of an audit for the requirements with a probability."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import cast

from fretc.audit.evidence.claim import AuditedRequirement
from fretc.audit.evidence.probabilities import (
    AVERAGE,
    AnswerWord,
    Estimated,
    Logs,
    Outcomes,
    high,
    low,
    times,
)
from fretc.audit.evidence.result_summaries import ResultSummary
from fretc.audit.measurements import confidence_intervals as intervals
from fretc.audit.measurements.confidence_intervals import INCONCLUSIVE, SUPPORTED
from fretc.audit.measurements.trials import NO_TRIALS, Trials
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity


def estimates(
    claims: Sequence[AuditedRequirement], results: Sequence[ResultSummary], confidence: float
) -> tuple[Estimated, ...]:
    """The answer for each audited requirement with a probability.

    Args:
        claims: all requirements of an audit.
        results: the results of all runs.
        confidence: between 0.5 and 1.
    """
    return tuple(
        _estimated(claim, [r for r in results if r.requirement == claim.id], confidence)
        for claim in claims
        if claim.chance is not None
    )


def warnings(estimates: Sequence[Estimated]) -> Iterator[Diagnostic]:
    """F506 for each requirement that so few logs cannot support, whatever their triggers show."""
    for estimate in estimates:
        least = intervals.fewest(estimate.operator, Fraction(estimate.bound), estimate.confidence)
        if estimate.answer == INCONCLUSIVE and estimate.logs.counted < least:
            yield Diagnostic(
                Code.FEW_RUNS,
                f"the probability of {estimate.requirement} is estimated from "
                f"{times(estimate.logs.counted, 'log')} with a trigger",
                help=f"audit {least} or more: triggers of one log may depend on each other, so "
                "logs are counted, not triggers",
                severity=Severity.WARNING,
            )


def _estimated(
    claim: AuditedRequirement, results: Sequence[ResultSummary], level: float
) -> Estimated:
    assert claim.chance is not None
    op, bound = claim.chance.op, Fraction(claim.chance.bound)
    distinct = _distinct(results)
    runs = [_trials(result) for result in distinct]
    damaged = sum(not result.intact for result in distinct)
    estimate = intervals.estimated(runs, intervals.both_sides(op, level))
    answer = intervals.answer(estimate, op, bound)
    undecided = answer == SUPPORTED and damaged > 0
    return Estimated(
        requirement=claim.id,
        operator=op,
        bound=claim.chance.bound,
        answer=cast("AnswerWord", INCONCLUSIVE if undecided else answer),
        reason=_damaged(damaged) if undecided else _reason(estimate, answer, claim.chance.text),
        confidence=level,
        triggers=Outcomes(estimate.trials.answered, estimate.trials.failed, estimate.trials.open),
        logs=Logs(
            counted=estimate.runs,
            silent=sum(result.intact for result in distinct) - _intact(distinct),
            damaged=damaged,
            copies=len(results) - len(distinct),
        ),
        estimate=None if estimate.share is None else round(estimate.share, 9),
        bounds=estimate.bounds,
        needed=intervals.needed(estimate, op, bound) if answer == INCONCLUSIVE else None,
        meaning=AVERAGE,
    )


def _intact(results: Sequence[ResultSummary]) -> int:
    """The results of intact logs with a trigger."""
    return sum(bool(r.intact and _trials(r).count) for r in results)


def _distinct(results: Sequence[ResultSummary]) -> list[ResultSummary]:
    """One result for each content: a copy of a log adds no information."""
    first: dict[str, ResultSummary] = {}
    for result in results:
        first.setdefault(result.content, result)
    return list(first.values())


def _trials(result: ResultSummary) -> Trials:
    return result.trials or NO_TRIALS


# Texts -----------------------------------------------------------------------------------------


def _reason(estimate: intervals.Estimate, answer: str, text: str) -> str:
    least, most = low(estimate.bounds.low), high(estimate.bounds.high)
    if not estimate.trials.count:
        return "there was no trigger"
    if answer != INCONCLUSIVE:
        return (
            f"it lies between {least} and {most}, so {'' if answer == SUPPORTED else 'not '}{text}"
        )
    if estimate.runs < 2:
        return "one log is not enough for a probability: its triggers may depend on each other"
    return f"it lies between {least} and {most}, which leaves {text} open"


def _damaged(count: int) -> str:
    what = "log is" if count == 1 else "logs are"
    return (
        f"{count} {what} damaged or could not be read: the lost part could "
        "contradict the requirement"
    )
