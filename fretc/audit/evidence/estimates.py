"""What all runs of an audit say of the requirements with a probability, in numbers and in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor
from typing import Any

from fretc.audit.evidence.claim import Claim
from fretc.audit.measurements import confidence_intervals as odds
from fretc.audit.measurements.confidence_intervals import INCONCLUSIVE, SUPPORTED, Bounds
from fretc.audit.measurements.trials import NO_TRIALS, Trials
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.expressions import ComparisonOperator

AVERAGE = (
    "this is the average over the triggers seen; PCTL demands it of every reachable state with a "
    "trigger, which is more"
)
"""Said with every answer."""


@dataclass(frozen=True, slots=True)
class Estimated:
    """What all runs say of one requirement."""

    requirement: str
    operator: ComparisonOperator
    bound: str
    """As it is written."""
    answer: str
    reason: str
    confidence: float
    answered: int
    failed: int
    open: int
    logs: int
    """With a trigger."""
    silent: int
    """Without a trigger."""
    damaged: int
    """That are damaged, or could not be read."""
    copies: int
    """That have the content of another one: they are not counted again."""
    estimate: float | None
    """Answered ones of those that are decided."""
    bounds: Bounds
    """By whole logs."""
    needed: int | None
    """Further logs, all of whose triggers are as they should be, that would support it; None: that
    does not help."""

    @property
    def text(self) -> str:
        """`with probability >= 0.99`."""
        return f"with probability {self.operator} {self.bound}"

    @property
    def as_record(self) -> dict[str, Any]:
        """The JSON object."""
        return {
            "requirement": self.requirement,
            "operator": self.operator,
            "bound": self.bound,
            "answer": self.answer,
            "reason": self.reason,
            "confidence": self.confidence,
            "triggers": {"answered": self.answered, "failed": self.failed, "open": self.open},
            "logs": {
                "counted": self.logs,
                "silent": self.silent,
                "damaged": self.damaged,
                "copies": self.copies,
            },
            "estimate": self.estimate,
            "bounds": {"low": self.bounds.low, "high": self.bounds.high},
            "needed": self.needed,
            "meaning": AVERAGE,
        }

    @property
    def lines(self) -> tuple[str, ...]:
        """For a person, the answer first."""
        return tuple(self._lines())

    def _lines(self) -> Iterator[str]:
        count = self.answered + self.failed + self.open
        yield f"{self.answer:<12}  {self.reason}"
        told = f"{self.answered} of {count} triggers answered, {self.failed} failed"
        yield f"{told}, {self.open} open, in {_times(self.logs, 'log')}{self._others}"
        known = "not known" if self.estimate is None else f"{self.estimate:.4f}"
        each = odds.both_sides(self.operator, self.confidence)
        stretch = f"bounds, by whole logs, at {_percent(each)} each: {shown(self.bounds)}"
        yield f"estimate {known}; {stretch}"
        if self.needed is not None:
            how = "no trigger" if self.operator in ("<", "<=") else "all triggers"
            yield f"at least {_times(self.needed, 'more log')}, {how} answered, would be needed"
        yield AVERAGE

    @property
    def _others(self) -> str:
        found = (
            (self.silent, "without a trigger"),
            (self.damaged, "damaged or not readable"),
            (self.copies, "not counted: of the same content as another"),
        )
        return "".join(f", {count} {what}" for count, what in found if count)


def estimates(
    claims: Sequence[Claim], results: Sequence[Mapping[str, Any]], confidence: float
) -> tuple[Estimated, ...]:
    """One for each claim with a probability.

    Args:
        claims: all of an audit.
        results: their records, of all runs.
        confidence: between 0.5 and 1.
    """
    return tuple(
        _estimated(claim, [r for r in results if r["requirement"] == claim.id], confidence)
        for claim in claims
        if claim.chance is not None
    )


def warnings(found: Sequence[Estimated]) -> Iterator[Diagnostic]:
    """F506 for each that so few logs cannot support, whatever their triggers came to."""
    for one in found:
        least = odds.fewest(one.operator, Fraction(one.bound), one.confidence)
        if one.answer == INCONCLUSIVE and one.logs < least:
            yield Diagnostic(
                Code.FEW_RUNS,
                f"the probability of {one.requirement} is estimated from "
                f"{_times(one.logs, 'log')} with a trigger",
                help=f"audit {least} or more: triggers of one log may depend on each other, so "
                "logs count",
                severity=Severity.WARNING,
            )


def _estimated(claim: Claim, results: Sequence[Mapping[str, Any]], level: float) -> Estimated:
    assert claim.chance is not None
    op, bound = claim.chance.op, Fraction(claim.chance.bound)
    distinct = _distinct(results)
    runs = [_trials(result) for result in distinct]
    damaged = sum(not result["health"]["intact"] for result in distinct)
    found = odds.estimated(runs, odds.both_sides(op, level))
    answer = odds.answer(found, op, bound)
    lost = answer == SUPPORTED and damaged > 0
    return Estimated(
        requirement=claim.id,
        operator=op,
        bound=claim.chance.bound,
        answer=INCONCLUSIVE if lost else answer,
        reason=_damaged(damaged) if lost else _reason(found, answer, claim.chance.text),
        confidence=level,
        answered=found.trials.answered,
        failed=found.trials.failed,
        open=found.trials.open,
        logs=found.runs,
        silent=sum(result["health"]["intact"] for result in distinct) - _intact(distinct),
        damaged=damaged,
        copies=len(results) - len(distinct),
        estimate=None if found.share is None else round(found.share, 9),
        bounds=found.bounds,
        needed=odds.needed(found, op, bound) if answer == INCONCLUSIVE else None,
    )


def _intact(results: Sequence[Mapping[str, Any]]) -> int:
    """Those that are intact and have a trigger."""
    return sum(bool(r["health"]["intact"] and _trials(r).count) for r in results)


def _distinct(results: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Each content once: a copy of a log tells nothing new, nor does one that was written again.

    What cannot be read has no hash.
    """
    first: dict[str, Mapping[str, Any]] = {}
    for place, result in enumerate(results):
        hashes = result["hashes"]
        known = (hashes.get(name) for name in ("messages", "log", "log_summary"))
        first.setdefault(next(filter(None, known), f"{place}"), result)
    return list(first.values())


def _trials(result: Mapping[str, Any]) -> Trials:
    told = result.get("trials")
    return Trials(**told) if told else NO_TRIALS


# In words --------------------------------------------------------------------------------------


def _reason(found: odds.Estimate, answer: str, text: str) -> str:
    low, high = _low(found.bounds.low), _high(found.bounds.high)
    if not found.trials.count:
        return "there was no trigger"
    if answer != INCONCLUSIVE:
        return f"it lies between {low} and {high}, so {'' if answer == SUPPORTED else 'not '}{text}"
    if found.runs < 2:
        return "one log does not tell a probability: its triggers depend on each other"
    return f"it lies between {low} and {high}, which leaves {text} open"


def _damaged(count: int) -> str:
    what = "log is" if count == 1 else "logs are"
    return f"{count} {what} damaged or could not be read: what is lost could speak against it"


def shown(bounds: Bounds) -> str:
    """`0.9900 to 1.0000`, rounded outwards."""
    return f"{_low(bounds.low)} to {_high(bounds.high)}"


def _low(bound: float) -> str:
    """Rounded down: never more than is known."""
    return f"{floor(bound * 10**4) / 10**4:.4f}"


def _high(bound: float) -> str:
    return f"{ceil(bound * 10**4) / 10**4:.4f}"


def _percent(share: float) -> str:
    return f"{share * 100:.4g} %"


def _times(count: int, thing: str) -> str:
    return f"{count} {thing}{'' if count == 1 else 's'}"
