"""The date of a log, and whether it is before a given time.

The date of a log is the start of its recording if its summary states it, else its last change. A
clock that counts from its own zero states none.
"""

from __future__ import annotations

import os
import re
from datetime import UTC, datetime, timedelta

from compiler.files.dates import now
from fretc.audit.log_paths import files_of
from fretc.logs.mcap.container import MAGIC, summary
from fretc.logs.storage.folders import Folder, folder, is_folder
from fretc.logs.storage.inputs import opened
from fretc.logs.storage.listings import changed, is_store
from fretc.logs.storage.log_names import STDIN, is_url, name_of
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.reading.limits import with_budget
from fretish.units import nanoseconds

_FIRST_DATE = 10**17
"""Nanoseconds, in 1973: an earlier time is that of a simulated clock."""
_DAYS = re.compile(r"\s*([0-9]{1,5})\s*d\s*")


def since(text: str) -> datetime | Diagnostic:
    """The time that a user gives: `2026-11-22`, `2026-11-22T18:00+01:00`, `24 h`, `7 d` ago.

    The default time zone is UTC. Now is `SOURCE_DATE_EPOCH`, if it is set.
    """
    days, length = _DAYS.fullmatch(text), nanoseconds(text)
    try:
        if days is not None:
            return now() - timedelta(days=int(days[1]))
        if length is not None:
            return now() - timedelta(microseconds=length // 1000)
        moment = datetime.fromisoformat(text)
        return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).astimezone(UTC)
    except (ValueError, OverflowError):
        return diagnostic("bad_since", text=text)


def is_older(log: str, than: datetime) -> bool:
    """Whether a log is older than a time: a log without a date is not."""
    limit = int(than.timestamp()) * 10**9 + than.microsecond * 1000
    if is_store(log):
        change = changed(log)
        if change is not None and change < limit:
            return True  # an object store has its own clock, but it is later than the recording
    date = _recorded(log) or _changed(log)
    return date is not None and date < limit


def _recorded(log: str) -> int | None:
    """The start of the recording in nanoseconds since 1970, if the log states a date."""
    try:
        start = _start_of_folder(log) if is_folder(log) else _start_of_file(log)
    except OSError:  # the reader of the log reports what is wrong with it
        return None
    return start if start is not None and start >= _FIRST_DATE else None


def _start_of_folder(path: str) -> int | None:
    about = folder(path)
    return about.span[0] if isinstance(about, Folder) and about.span is not None else None


def _start_of_file(log: str) -> int | None:
    if log == STDIN or not (is_url(log) or os.path.isfile(log)):
        return None
    with opened(log, whole=False) as source:
        if isinstance(source, Diagnostic) or source.stream.read(len(MAGIC)) != MAGIC:
            return None
        span = Source(name_of(log), "").span()
        file_summary = with_budget(source.size, span, lambda: summary(source.stream, source.size))
        if (
            file_summary is None
            or isinstance(file_summary, Diagnostic)
            or file_summary.statistics is None
        ):
            return None
        return int(file_summary.statistics.message_start_time)


def _changed(log: str) -> int | None:
    """The time of the last change of any file of the log."""
    if log == STDIN or is_url(log):
        return changed(log) if is_store(log) else None
    try:
        return max(os.stat(file).st_mtime_ns for file in files_of([log]))
    except (OSError, ValueError):
        return None
