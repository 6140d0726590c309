"""The column of a table that holds the time of each row, and its unit.

A unit is the last word of the column's name (`t_ms`), or follows from the values: a date, a number
of seconds or of smaller units since 1970, or decimals, which are seconds. Whole numbers of another
size can be anything, and are refused: a wrong unit would make each verdict wrong.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from decimal import Decimal, InvalidOperation

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span

_NAMES = (
    "log_time", "timestamp", "time_stamp", "time", "stamp", "datetime", "date_time", "t",
)  # fmt: skip
"""Names of time columns without their unit, the likeliest first."""
_UNITS = {
    "s": "s", "sec": "s", "secs": "s", "seconds": "s", "ms": "ms", "msec": "ms",
    "milliseconds": "ms", "us": "us", "usec": "us", "microseconds": "us", "ns": "ns", "nsec": "ns",
    "nanoseconds": "ns",
}  # fmt: skip
"""Last words of names of time columns, each with the symbol of the unit."""
_EPOCH = (Decimal(978_307_200), Decimal(4_102_444_800))
"""Seconds from 1970 to the years 2001 and 2100."""
UNITS = {
    "s": "in seconds",
    "ms": "in milliseconds",
    "us": "in microseconds",
    "ns": "in nanoseconds",
    "date": "as dates",
}
"""The units of a column, in words."""
_SIZES = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}
_LONGEST = 40
"""Characters of a time."""


@dataclass(frozen=True, slots=True)
class TimeColumn:
    """A column of times."""

    name: str
    unit: str
    """`s`, `ms`, `us`, `ns`; or `date`."""
    is_assumed: bool = False
    """Whether only decimals say that the unit is seconds."""

    def nanoseconds(self, text: str) -> int | None:
        """The time of a row, rounded to a nanosecond; None: the text is not a time."""
        if self.unit == "date":
            return _date(text)
        number = _number(text)
        if number is None:
            return None
        return round(number * _SIZES[self.unit])


def time_column(
    columns: Sequence[str], first: Sequence[str], units: Mapping[str, str], span: Span
) -> TimeColumn | Diagnostic:
    """The time column of a table.

    Args:
        columns: the names of the columns.
        first: the texts of the first row, as many.
        units: the units of columns whose types state them.
        span: the table, as named on the command line.
    """
    candidates = [
        (rank, i, unit) for i, column in enumerate(columns) for rank, unit in _parsed(column)
    ]
    if not candidates:
        return diagnostic("table_without_time", span, columns=", ".join(columns[:8]))
    _, i, unit = min(candidates)
    column, text = columns[i], first[i]
    unit = units.get(column, unit)
    if unit:
        return TimeColumn(column, unit)
    unit = _unit_of(text)
    if not unit:
        return diagnostic("time_without_unit", span, column=column, value=text[:_LONGEST])
    number = _number(text)
    return TimeColumn(column, unit, unit == "s" and number is not None and not _is_epoch(number))


def _parsed(column: str) -> list[tuple[int, str]]:
    """The rank and the unit of a name of a time column; empty: it is none."""
    words = [word.lower() for word in re.findall(r"[A-Za-z]+", column)]
    unit = _UNITS.get(words[-1], "") if len(words) > 1 else ""
    name = "_".join(words[:-1] if unit else words)
    return [(_NAMES.index(name), unit)] if name in _NAMES else []


def _unit_of(text: str) -> str:
    """The unit that a value shows; empty: none."""
    number = _number(text)
    if number is None:
        return "date" if _date(text) is not None else ""
    sizes = [unit for unit, size in _SIZES.items() if _is_epoch(number * size / 10**9)]
    if sizes:
        return sizes[0]
    return "s" if re.search(r"[.eE]", text) else ""


def _is_epoch(seconds: Decimal) -> bool:
    return _EPOCH[0] <= seconds <= _EPOCH[1]


def _number(text: str) -> Decimal | None:
    try:
        number = Decimal(text.strip()) if len(text) <= _LONGEST else None
    except InvalidOperation:
        return None
    is_small = number is not None and number.is_finite() and abs(number.adjusted()) <= 20
    return number if is_small or number == 0 else None


def _date(text: str) -> int | None:
    """Nanoseconds since 1970 of an ISO date with a time; without a zone it is UTC."""
    match = re.fullmatch(r"(.{10}[T ].*?)(?:[.,]([0-9]{1,9}))?(Z|[+-][0-9:]+)?", text.strip())
    if match is None or len(text) > _LONGEST:
        return None
    whole, part, zone = match.groups()
    try:
        moment = datetime.fromisoformat(f"{whole}{'+00:00' if zone in (None, 'Z') else zone}")
    except ValueError:
        return None
    since = moment - datetime(1970, 1, 1, tzinfo=UTC)
    return (since.days * 86_400 + since.seconds) * 10**9 + int((part or "").ljust(9, "0"))
