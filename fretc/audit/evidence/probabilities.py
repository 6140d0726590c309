"""What triggers came to, and what all runs say of a probability, as the evidence has them."""

from __future__ import annotations

from fractions import Fraction
from typing import get_args

from compiler.files.checked_json import Shape
from fretc.audit.evidence.estimates import Estimated
from fretc.audit.measurements.confidence_intervals import ANSWERS, Bounds
from fretc.audit.measurements.trials import Trials
from fretish.expressions import ComparisonOperator
from fretish.units import number


def probability(at: Shape) -> Estimated:
    """One of the evidence's `probabilities`; a wrong shape raises `MisshapenError`."""
    operators: dict[str, ComparisonOperator] = {op: op for op in get_args(ComparisonOperator)}
    logs, triggers = at.field("logs"), trials(at.field("triggers"))
    return Estimated(
        requirement=at.field("requirement").text(),
        operator=operators[at.field("operator").one_of(list(operators))],
        bound=_bound(at.field("bound")),
        answer=at.field("answer").one_of(ANSWERS),
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
        bounds=_bounds(at.field("bounds")),
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
        stated = number(at.text())
    except (ValueError, ZeroDivisionError):
        stated = Fraction(-1)
    if not 0 <= stated <= 1:
        raise at.wrong("a number from 0 to 1, as text")
    return at.text()


def _share(at: Shape) -> float:
    if not 0 <= at.number() <= 1:
        raise at.wrong("a number from 0 to 1")
    return at.number()
