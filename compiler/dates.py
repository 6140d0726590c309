"""The date that an output carries, where it is to be made again with the same bytes.

Source: reproducible-builds.org, SOURCE_DATE_EPOCH specification 1.1.
"""

from __future__ import annotations

import os
from datetime import UTC, datetime


def source_date() -> datetime | None:
    """`SOURCE_DATE_EPOCH` in UTC; None where it is not set, or is no time."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    if epoch.isascii() and epoch.isdecimal() and int(epoch) < 10**11:
        return datetime.fromtimestamp(int(epoch), UTC)
    return None
