"""The date for outputs that are reproducible byte by byte.

Source: reproducible-builds.org, SOURCE_DATE_EPOCH specification 1.1.
"""

from __future__ import annotations

import os
from datetime import UTC, date, datetime, timedelta


def source_date() -> datetime | None:
    """`SOURCE_DATE_EPOCH` in UTC; None if it is unset or invalid."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    if epoch.isascii() and epoch.isdecimal() and int(epoch) < 10**11:
        return datetime.fromtimestamp(int(epoch), UTC)
    return None


def today() -> str:
    """The UTC day of `SOURCE_DATE_EPOCH`, or today in UTC if it is unset."""
    return now().date().isoformat()


def is_in_future(day: str) -> bool:
    """Whether a day such as `2026-11-22` has not begun anywhere on Earth; UTC+14 is first."""
    return date.fromisoformat(day) > (now() + timedelta(hours=14)).date()


def is_date(text: str) -> bool:
    """Whether the text is a date such as `2026-11-22`."""
    try:
        return date.fromisoformat(text).isoformat() == text
    except ValueError:
        return False


def now() -> datetime:
    """The time of `SOURCE_DATE_EPOCH` in UTC, or the present time if it is unset."""
    return source_date() or datetime.now(UTC)
