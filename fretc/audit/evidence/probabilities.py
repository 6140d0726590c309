"""The outcomes of triggers and the probabilities over all runs, in the form of evidence."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import ceil, floor
from typing import Annotated, Literal

from compiler.files.records import Count, Meta, Name, Ordinal, Record, Share, about
from fretc.audit.measurements import confidence_intervals as intervals
from fretc.audit.measurements.confidence_intervals import Bounds
from fretish.expressions import ComparisonOperator
from fretish.units import number

AnswerWord = Literal["supported", "refuted", "inconclusive"]
AVERAGE = (
    "this is the average over the recorded triggers; PCTL demands the probability in "
    "every reachable state with a trigger, which is stronger"
)
"""The note that accompanies every answer."""


class Outcomes(Record, frozen=True):
    """The outcomes of triggers."""

    answered: Annotated[Count, about("triggers whose demand was met")]
    failed: Annotated[Count, about("triggers whose demand was broken")]
    open: Annotated[
        Count,
        about("triggers whose outcome the log does not show, and ticks that may be triggers"),
    ]


class Logs(Record, frozen=True):
    """The number of logs of each kind."""

    counted: Annotated[Count, about("with a trigger")]
    silent: Annotated[Count, about("intact, and without a trigger")]
    damaged: Annotated[Count, about("damaged or not readable; what could be read of them counts")]
    copies: Annotated[Count, about("copies of another log: not counted")]


class Estimated(Record, frozen=True):
    """The answer of all runs for one requirement."""

    requirement: Name
    operator: ComparisonOperator
    bound: Annotated[str, about("the probability, as it is written")]
    answer: AnswerWord
    reason: str
    confidence: Annotated[float, Meta(gt=0.5, lt=1)]
    triggers: Annotated[Outcomes, about("of all logs that count")]
    logs: Logs
    estimate: Annotated[
        Share | None,
        about("share of answered triggers among the decided ones; null: none is decided"),
    ]
    bounds: Annotated[
        Bounds, about("one-sided bounds, over whole logs; open triggers count against either bound")
    ]
    needed: Annotated[
        Ordinal | None,
        about(
            "number of further logs, with every trigger answered as required, that would "
            "support the requirement"
        ),
    ]
    meaning: Annotated[str, about("the meaning of the answer, and its difference from PCTL")]

    def __post_init__(self) -> None:
        """Raise ValueError if the bound is not a probability."""
        try:
            stated = number(self.bound)
        except (ValueError, ZeroDivisionError):
            stated = Fraction(-1)
        if not 0 <= stated <= 1:
            raise ValueError("Expected a `bound` from 0 to 1, as text")

    @property
    def text(self) -> str:
        """`with probability >= 0.99`."""
        return f"with probability {self.operator} {self.bound}"

    @property
    def lines(self) -> tuple[str, ...]:
        """Lines of text, the answer first."""
        return tuple(self._lines())

    def _lines(self) -> Iterator[str]:
        triggers, logs = self.triggers, self.logs
        count = triggers.answered + triggers.failed + triggers.open
        yield f"{self.answer:<12}  {self.reason}"
        outcomes = f"{triggers.answered} of {count} triggers answered, {triggers.failed} failed"
        yield f"{outcomes}, {triggers.open} open, in {times(logs.counted, 'log')}{_others(logs)}"
        share = "not known" if self.estimate is None else f"{self.estimate:.4f}"
        each = intervals.both_sides(self.operator, self.confidence)
        at = f"at {_percent(each)} each: {shown(self.bounds)}"
        stretch = f"bounds (the logs are the independent units) {at}"
        yield f"estimate {share}; {stretch}"
        if self.needed is not None:
            how = "no trigger" if self.operator in ("<", "<=") else "all triggers"
            yield f"at least {times(self.needed, 'more log')}, {how} answered, would be needed"
        yield AVERAGE


def _others(logs: Logs) -> str:
    groups = (
        (logs.silent, "without a trigger"),
        (logs.damaged, "damaged or not readable"),
        (logs.copies, "not counted: of the same content as another"),
    )
    return "".join(f", {count} {what}" for count, what in groups if count)


def shown(bounds: Bounds) -> str:
    """`0.9900 to 1.0000`, rounded outwards."""
    return f"{low(bounds.low)} to {high(bounds.high)}"


def low(bound: float) -> str:
    """The number rounded down: a lower bound."""
    return f"{floor(bound * 10**4) / 10**4:.4f}"


def high(bound: float) -> str:
    """The number rounded up: an upper bound."""
    return f"{ceil(bound * 10**4) / 10**4:.4f}"


def _percent(share: float) -> str:
    return f"{share * 100:.4g} %"


def times(count: int, thing: str) -> str:
    """`2 logs`."""
    return f"{count} {thing}{'' if count == 1 else 's'}"
