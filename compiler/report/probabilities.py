"""What all runs say of a requirement with a probability: read, held against the runs, and shown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import get_args

from compiler.estimates import GLYPHS, Estimated, shown
from compiler.odds import INCONCLUSIVE, REFUTED, SUPPORTED, Bounds
from compiler.report.shapes import Shape
from compiler.report.views import BoundsView, Mark, ProbabilityView
from fretish import syntax
from fretish.expressions import ComparisonOperator
from monitors import kernel
from monitors.trials import Trials

_KINDS = {
    SUPPORTED: str(kernel.SATISFIED),
    REFUTED: str(kernel.VIOLATED),
    INCONCLUSIVE: str(kernel.INCONCLUSIVE),
}
ANSWERS = {word: Mark(word, GLYPHS[word][0], kind) for word, kind in _KINDS.items()}
"""Answer → how it is shown."""


def probability(at: Shape) -> Estimated:
    """One of the evidence's `probabilities`; a wrong shape raises `MisshapenError`."""
    operators: dict[str, ComparisonOperator] = {op: op for op in get_args(ComparisonOperator)}
    logs, triggers = at.field("logs"), trials(at.field("triggers"))
    return Estimated(
        requirement=at.field("requirement").text(),
        operator=operators[at.field("operator").one_of(list(operators))],
        bound=_bound(at.field("bound")),
        answer=at.field("answer").one_of(list(GLYPHS)),
        reason=at.field("reason").text(),
        confidence=_share(at.field("confidence")),
        answered=triggers.answered,
        failed=triggers.failed,
        open=triggers.open,
        logs=logs.field("counted").count(),
        silent=logs.field("silent").count(),
        damaged=logs.field("damaged").count(),
        copies=logs.field("copies").count(),
        estimate=at.field("estimate").or_none(_share),
        exact=_bounds(at.field("exact")),
        resampled=at.field("resampled").or_none(_bounds),
        needed=at.field("needed").or_none(Shape.count),
    )


def trials(at: Shape) -> Trials:
    """What triggers came to."""
    return Trials(*(at.field(name).count() for name in ("answered", "failed", "open")))


def _bounds(at: Shape) -> Bounds:
    return Bounds(_share(at.field("low")), _share(at.field("high")))


def _bound(at: Shape) -> str:
    """A probability as it is written."""
    try:
        stated = Fraction(at.text())
    except (ValueError, ZeroDivisionError):
        stated = Fraction(-1)
    if not 0 <= stated <= 1:
        raise at.wrong("a number from 0 to 1, as text")
    return at.text()


def _share(at: Shape) -> float:
    if not 0 <= at.number() <= 1:
        raise at.wrong("a number from 0 to 1")
    return at.number()


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
    if sums != (told.answered, told.failed, told.open):
        yield "the evidence contradicts itself: its runs do not add up to what it says of all"
    elif told.answer == SUPPORTED and not all(intact for intact, _ in once):
        yield "a log is damaged, and no damaged log supports a probability"


# The view --------------------------------------------------------------------------------------


def probability_view(told: Estimated, suspicions: Sequence[str]) -> ProbabilityView:
    """What is shown in the section of the requirement."""
    bars = [BoundsView("Clopper-Pearson", told.exact.low, told.exact.high)]
    if told.resampled is not None:
        bars.append(BoundsView("logs resampled", told.resampled.low, told.resampled.high))
    stretches = " and ".join(f"{shown(Bounds(b.low, b.high))} ({b.name})" for b in bars)
    share = "not known" if told.estimate is None else f"{told.estimate:.4f}"
    return ProbabilityView(
        mark=ANSWERS[told.answer],
        suspicions=tuple(suspicions),
        stated=told.text,
        bound=float(told.bound),
        reason=told.reason,
        lines=told.lines[1:],
        estimate=told.estimate,
        bars=tuple(bars),
        text=f"Estimate {share}; bounds {stretches}; the bound of the sentence is {told.bound}.",
    )
