"""An audit while it goes on: how far it is, what of it is kept, and that Ctrl-C ends it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from fretc.terminal.output import BAD, INTERRUPTED, say, say_line, stop
from fretc.terminal.progress import progress
from fretish.diagnostics.diagnostic import Diagnostic

if TYPE_CHECKING:
    from fretc.audit.journal import Journal
    from fretc.audit.many_logs import Audit, Engine, LogAudit
    from fretc.audit.plan import Plan


def audit_all(
    plan: Plan, logs: Sequence[str], engine: Engine, journal: Journal | None, *, resume: bool
) -> Audit:
    """Audit the logs; whatever ends that early, what is finished is in the journal.

    Args:
        plan: what the logs are judged by.
        logs: paths, each once.
        engine: where they are audited.
        journal: None: nothing is kept.
        resume: begin with what the journal has.
    """
    from fretc.audit.many_logs import audit_logs

    finished = journal.finished(logs) if journal is not None and resume else {}
    if isinstance(finished, Diagnostic):
        stop(finished)
    if resume:
        stale = journal is not None and journal.stale
        say_line(_resumed(len(finished), len(logs), stale=stale))
        if journal is not None and journal.foreign:
            say_line(f"`{journal.path}` was not kept by you in this place: that is not used")
    count = len(finished)

    def keep(log: str, audited: LogAudit) -> None:
        nonlocal count
        added = journal.keep(log, audited) if journal is not None else False
        if isinstance(added, Diagnostic):
            stop(added)
        count += added
        show(log)

    try:
        with _shown([log for log in logs if log not in finished]) as show:
            result = audit_logs(plan, logs, engine, finished, keep)
    except KeyboardInterrupt:
        say_line(f"stopped{_kept(count, len(logs))}")
        raise SystemExit(INTERRUPTED) from None
    if isinstance(result, Diagnostic):
        say([result])
        if count:
            say_line(f"not finished{_kept(count, len(logs))}")
        raise SystemExit(BAD)
    return result


def _resumed(finished: int, count: int, *, stale: bool) -> str:
    if not finished and not stale:
        return "no stopped audit was found: all logs are audited"
    why = ": requirements, bindings or fretc have changed since then" if stale else ""
    return f"{finished} of {count} logs are audited already{why}"


def _kept(kept: int, count: int) -> str:
    """What is not lost, and how to go on; nothing where nothing is kept."""
    return f": {kept} of {count} logs are kept, `--resume` goes on from there" if kept else ""


@contextmanager
def _shown(logs: Sequence[str]) -> Iterator[Callable[[str], None]]:
    """Show how many bytes of these logs are done; gives what is to be called with each of them."""
    sizes = {log: _size(log) for log in logs}
    logs_done = bytes_done = 0
    total = sum(sizes.values())
    with progress(total if len(logs) > 1 else 0, "auditing") as show:

        def tell(log: str) -> None:
            nonlocal logs_done, bytes_done
            logs_done, bytes_done = logs_done + 1, bytes_done + sizes[log]
            megabytes = f"{bytes_done / 1e6:.0f}/{total / 1e6:.0f} MB"
            show(bytes_done, f"{logs_done}/{len(logs)} logs, {megabytes}")

        yield tell


def _size(log: str) -> int:
    """In bytes; something even where it cannot be told, so that the log counts."""
    try:
        return max(1, os.path.getsize(log))
    except OSError:
        return 1
