"""Counts, dates and durations in words."""

from __future__ import annotations

from datetime import UTC, date, datetime

from fretc.report.model import phrases

_WORDS = "no one two three four five six seven eight nine ten eleven twelve".split()
_DATED = 946_684_800
"""1 January 2000 in seconds; earlier times are not dates, because the clock began at 0."""


def number(count: int) -> str:
    """`five`; `13` from thirteen on."""
    return _WORDS[count] if count < len(_WORDS) else phrases.whole(count)


def capital(text: str) -> str:
    """The text with a capital letter at its beginning."""
    return text[:1].upper() + text[1:]


def day(ns: int | None) -> date | None:
    """The UTC day of a time; None if the clock has no date."""
    if ns is None or ns // 10**9 < _DATED:
        return None
    try:
        return datetime.fromtimestamp(ns // 10**9, UTC).date()
    except (OverflowError, ValueError, OSError):
        return None


def days(first: date, last: date) -> str:
    """`21 November 2026`, `2 October to 21 November 2026`."""
    if first == last:
        return _said(first)
    same_month = (first.year, first.month) == (last.year, last.month)
    beginning = (
        str(first.day)
        if same_month
        else f"{first.day} {first:%B}"
        if first.year == last.year
        else _said(first)
    )
    return f"{beginning} to {_said(last)}"


def _said(one: date) -> str:
    return f"{one.day} {one:%B} {one.year}"


def duration(seconds: float) -> str:
    """`45 s`, `58 min`, `3 h 20 min`, `5 days 3 h`."""
    if seconds < 90:
        return phrases.seconds(round(seconds) if seconds >= 10 else seconds)
    minutes = round(seconds / 60)
    if minutes < 90:
        return f"{minutes} min"
    hours, rest = divmod(minutes, 60)
    if hours < 48:
        return f"{hours} h {rest} min" if rest else f"{hours} h"
    whole, left = divmod(hours, 24)
    return f"{phrases.whole(whole)} days {left} h" if left else f"{phrases.whole(whole)} days"
