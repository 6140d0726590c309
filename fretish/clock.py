"""The declared clock: the length of a tick, and durations in ticks."""

from __future__ import annotations

import re
from dataclasses import replace
from enum import StrEnum
from fractions import Fraction
from math import ceil, floor
from typing import assert_never

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.expressions import (
    COUNTING,
    Call,
    Expression,
    Number,
    Quantity,
    children,
    has_unit,
    with_children,
)
from fretish.syntax import (
    SHAPES,
    Duration,
    Extent,
    Quantifier,
    Sentence,
    TimeUnit,
    Timing,
    duration,
    timing_key,
    with_expressions,
)
from fretish.units import nanoseconds, number

NANOSECONDS: dict[TimeUnit, int] = {
    "microsecond": 10**3,
    "millisecond": 10**6,
    "second": 10**9,
    "minute": 60 * 10**9,
    "hour": 3600 * 10**9,
}

SYMBOLS: dict[str, TimeUnit] = {
    "us": "microsecond",
    "ms": "millisecond",
    "s": "second",
    "min": "minute",
    "h": "hour",
}
"""The symbols of the units of time."""
SYMBOL_OF: dict[TimeUnit, str] = {unit: symbol for symbol, unit in SYMBOLS.items()}


class TimeSource(StrEnum):
    """Which time of a message the clock uses."""

    LOG_TIME = "log_time"
    PUBLISH_TIME = "publish_time"
    HEADER_STAMP = "header.stamp"


class End(StrEnum):
    """The verdict on an obligation that is open when the log ends."""

    INCONCLUSIVE = "inconclusive"
    VIOLATED = "violated"


class Rounding(StrEnum):
    """How a duration that is not a whole number of ticks is rounded."""

    EXACT = "exact"
    """It is an error."""
    CONSERVATIVE = "conservative"
    """It is rounded to the stricter side, never to 0; an error if neither side is stricter."""


@dataclass(frozen=True, slots=True)
class Clock:
    """A tick every `period` nanoseconds, or one for each message of `topic`."""

    period: int | None
    topic: str | None = None
    time: TimeSource = TimeSource.LOG_TIME
    end: End = End.INCONCLUSIVE
    rounding: Rounding = Rounding.EXACT
    phase: int = 0
    """Nanoseconds by which all ticks are shifted; less than a tick."""
    lateness: int | None = None
    """Nanoseconds between a tick and its evaluation; None: evaluated when the run has ended."""

    @property
    def effective_lateness(self) -> int | None:
        """The effective lateness: 0 with log time, which is the time of arrival."""
        return 0 if self.time is TimeSource.LOG_TIME else self.lateness

    @property
    def declared(self) -> bool:
        """Whether a tick is declared; bindings without signals need no clock."""
        return self.period is not None or self.topic is not None

    def __str__(self) -> str:
        """`100 ms`, `100 ms at phase 50 ms` or `each message of /scan`."""
        if self.period is None:
            return f"each message of {self.topic}"
        shifted = f" at phase {in_words(self.phase)}" if self.phase else ""
        return f"{in_words(self.period)}{shifted}"


_PERIOD = re.compile(r"[0-9.]+ (?:s|ms|us|ns)")


def period_of(text: str) -> int | None:
    """The length of a tick in nanoseconds, from the text of a clock; None: a tick per message."""
    match = _PERIOD.match(text)
    return nanoseconds(match[0]) if match else None


def in_words(period: int) -> str:
    """Nanoseconds as `2 s`, `100 ms`, `1.5 ms`, `250 us` or `7 ns`: never rounded."""
    if period % 10**9 == 0:
        return f"{period // 10**9} s"
    size, unit = next(
        ((size, unit) for size, unit in ((10**6, "ms"), (10**3, "us")) if period >= size), (1, "ns")
    )
    return f"{_exactly(Fraction(period, size))} {unit}"


def _exactly(value: Fraction) -> str:
    """The exact number as a decimal if it has one, else as a fraction."""
    for digits in range(10):
        if (value * 10**digits).denominator == 1:
            whole, part = divmod(int(value * 10**digits), 10**digits)
            return f"{whole}.{part:0{digits}d}" if digits else str(whole)
    return str(value)


def in_ticks(sentence: Sentence, clock: Clock | None) -> int | Diagnostic | None:
    """The duration of the sentence's timing in ticks.

    Without a clock every unit is read as ticks, as FRET does; `assumed_ticks` gives the warning.

    Returns:
        The number of ticks; None for a timing without a duration; F307 or F313 if the duration
        is not a whole number of ticks.
    """
    bound = duration(sentence.timing)
    if bound is None or clock is None or bound.unit == "tick":
        return bound.amount if bound else None
    if clock.period is None:
        return diagnostic("messages_cannot_count_time", bound.span, clock=clock, unit=bound.unit)
    exact = Fraction(bound.amount * NANOSECONDS[bound.unit], clock.period)
    if exact.denominator == 1:
        return int(exact)
    if clock.rounding is Rounding.EXACT:
        return _inexact(_as_written(bound), bound.span, clock, exact)
    fewer = _fewer_is_stricter(sentence)
    if fewer is None:
        return _no_stricter_side(sentence, bound, clock, exact)
    ticks = int(exact) if fewer else int(exact) + 1
    return ticks or _inexact(_as_written(bound), bound.span, clock, exact)


def counts_in_ticks(sentence: Sentence, clock: Clock | None) -> Sentence | Diagnostic:
    """The sentence with the durations in `persisted(500 ms, p)` and its like as numbers of ticks.

    Returns:
        F108 for a unit that is none of time; F307 where there is no whole number of ticks.
    """
    mistakes: list[Diagnostic] = []

    def count(bound: Quantity) -> Number:
        ticks = _ticks(bound, clock)
        if isinstance(ticks, Diagnostic):
            mistakes.append(ticks)
            return Number("0", bound.span)
        return Number(str(ticks), bound.span)

    def rewritten(expression: Expression) -> Expression:
        if not has_unit(expression):
            return expression
        inside = with_children(expression, [rewritten(each) for each in children(expression)])
        if not isinstance(inside, Call) or inside.name not in COUNTING:
            return inside
        *bounds, last = inside.args
        numbers = [count(each) if isinstance(each, Quantity) else each for each in bounds]
        return replace(inside, args=(*numbers, last))

    counted = with_expressions(sentence, rewritten)
    return mistakes[0] if mistakes else counted


def _ticks(bound: Quantity, clock: Clock | None) -> int | Diagnostic:
    if bound.unit not in SYMBOLS:
        return diagnostic("duration_of_unknown_unit", bound.span, word=bound.unit)
    text = f"{bound.digits} {bound.unit}"
    if clock is None:
        return diagnostic("duration_without_tick", bound.span, duration=text)
    if clock.period is None:
        unit = SYMBOLS[bound.unit]
        return diagnostic("messages_cannot_count_time", bound.span, clock=clock, unit=unit)
    exact = number(bound.digits) * NANOSECONDS[SYMBOLS[bound.unit]] / clock.period
    return int(exact) if exact.denominator == 1 else _inexact(text, bound.span, clock, exact)


def whole_duration(length: Fraction, unit: TimeUnit, span: Span | None = None) -> Duration | None:
    """The duration in the unit if that is whole, else in a smaller one; None if in none.

    FRETish has whole numbers only: 1.5 seconds are 1500 milliseconds.
    """
    if length.denominator == 1:
        return Duration(int(length), unit, span)
    for smaller_unit in reversed(NANOSECONDS) if unit in NANOSECONDS else ():
        amount = length * NANOSECONDS[unit] / NANOSECONDS[smaller_unit]
        if NANOSECONDS[smaller_unit] < NANOSECONDS[unit] and amount.denominator == 1:
            return Duration(int(amount), smaller_unit, span)
    return None


def in_unit(ticks: int, unit: TimeUnit, clock: Clock | None) -> Duration:
    """A number of ticks as a duration: in the unit if exact, else in a smaller unit or in ticks."""
    if unit == "tick" or clock is None or clock.period is None:
        return Duration(ticks, unit)
    length = Fraction(ticks * clock.period, NANOSECONDS[unit])
    return whole_duration(length, unit) or Duration(ticks, "tick")


def _fewer_is_stricter(sentence: Sentence) -> bool | None:
    """Whether fewer ticks make the sentence stricter; None if neither direction does.

    Fewer ticks make `within` stricter and `for` weaker. An `only` scope and an upper bound of a
    probability reverse the direction. `after` requires the response at one tick, so neither
    direction is stricter.
    """
    odds = sentence.probability
    fewer = _fewer_asks_more(sentence.timing)
    if fewer is None or (odds and odds.op in ("=", "!=")):
        return None
    negated = sentence.scope is not None and sentence.scope.kind.negates
    rarely = odds is not None and odds.op in ("<", "<=")
    return fewer != (negated != rarely)


def _fewer_asks_more(timing: Timing) -> bool | None:
    """Whether fewer ticks make a timing with a duration stricter; None if neither does."""
    shape = SHAPES[type(timing)]
    match shape.extent:
        case Extent.DURATION:
            return shape.quantifier is Quantifier.SOME
        case Extent.BEYOND:
            return None
        case Extent.TRIGGER | Extent.NEXT | Extent.LAST | Extent.INTERVAL | Extent.STOP:
            raise AssertionError(f"timing without a duration: {timing}")
        case _:
            assert_never(shape.extent)


def assumed_ticks(sentence: Sentence, clock: Clock | None) -> Diagnostic | None:
    """F312 if the sentence has a unit of time, and no clock says how long a tick is."""
    bound = duration(sentence.timing)
    if clock is not None or bound is None or bound.unit == "tick":
        return None
    return diagnostic(
        "assumed_ticks", bound.span, duration=duration_text(bound), amount=bound.amount
    )


def duration_text(bound: Duration) -> str:
    """`1 tick`, `3 seconds`."""
    return f"{bound.amount} {bound.unit}{'' if bound.amount == 1 else 's'}"


def _as_written(bound: Duration) -> str:
    return bound.span.text if bound.span else duration_text(bound)


def _inexact(duration: str, span: Span | None, clock: Clock, exact: Fraction) -> Diagnostic:
    assert clock.period is not None
    whole = [count for count in (floor(exact), ceil(exact)) if count]
    near = " or ".join(in_words(count * clock.period) for count in whole)
    return diagnostic(
        "inexact_duration",
        span,
        duration=duration,
        ticks=_exactly(exact),
        period=in_words(clock.period),
        help=f"use a whole number of ticks ({near}), or a finer `tick`"
        if clock.rounding is Rounding.CONSERVATIVE
        else f"use a whole number of ticks ({near}), a finer `tick`, or "
        '`rounding = "conservative"` under `[clock]`',
    )


def _no_stricter_side(
    sentence: Sentence, bound: Duration, clock: Clock, exact: Fraction
) -> Diagnostic:
    odds = sentence.probability
    part = timing_key(sentence)
    if odds is not None and _fewer_asks_more(sentence.timing) is not None:
        part = odds.op
    inexact = _inexact(_as_written(bound), bound.span, clock, exact)
    return replace(
        inexact, message=f"{inexact.message}, and `{part}` has no stricter side to round to"
    )
