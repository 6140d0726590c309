"""Progress of an audit, and what is saved if it ends early."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from fretc.terminal.output import (
    EXIT_INTERRUPTED,
    EXIT_USAGE,
    fail,
    print_diagnostics,
    print_status,
)
from fretc.terminal.progress import progress
from fretish.diagnostics.diagnostic import Diagnostic

if TYPE_CHECKING:
    from fretc.audit.into_store import StoredAudit, StoreWriter
    from fretc.audit.many_logs import Audit, Engine
    from fretc.audit.plan import Plan


def audit_in_memory(plan: Plan, logs: Sequence[str], engine: Engine) -> Audit:
    """Audit the logs in memory; an interrupted audit saves nothing."""
    from fretc.audit.many_logs import audit_logs

    try:
        with shown(logs) as show:
            result = audit_logs(plan, logs, engine, tell=lambda log, _: show(log))
    except KeyboardInterrupt:
        print_status("stopped")
        raise SystemExit(EXIT_INTERRUPTED) from None
    if isinstance(result, Diagnostic):
        fail(result)
    return result


def audit_into(session: StoreWriter, engine: Engine) -> StoredAudit:
    """Audit the logs of a session; an interrupted audit leaves finished results in the store."""
    if session.known:
        count = len(session.known) + len(session.new)
        print_status(
            f"{len(session.known)} of {count} logs are unchanged: their earlier results are reused"
        )
    elif session.earlier.claims:
        print_status(
            "requirements or bindings have changed: the results of "
            f"{len(session.earlier.claims)} unchanged requirements on unchanged logs are reused"
        )
    elif session.earlier.stale:
        print_status("requirements, bindings or fretc have changed: all logs are audited again")
    if session.missing:
        what = "log of the store is" if session.missing == 1 else "logs of the store are"
        whose = "its" if session.missing == 1 else "their"
        print_status(f"{session.missing} {what} not among the inputs: {whose} results are removed")
    if session.earlier.foreign:
        print_status(
            f"`{session.folder}` was written by another user or in another folder: its results "
            "are not reused"
        )
    try:
        with shown(session.new) as show:
            result = session.run(engine, show)
    except KeyboardInterrupt:
        print_status(f"stopped{_kept(session)}")
        raise SystemExit(EXIT_INTERRUPTED) from None
    if isinstance(result, Diagnostic):
        print_diagnostics([result])
        if session.kept:
            print_status(f"not finished{_kept(session)}")
        raise SystemExit(EXIT_USAGE)
    return result


def _kept(session: StoreWriter) -> str:
    """Message about the saved results and how to continue; empty if nothing is saved."""
    if not session.kept:
        return ""
    kept, count = session.kept + len(session.known), len(session.known) + len(session.new)
    return f": {kept} of {count} logs are saved; run the same command again to continue"


@contextmanager
def shown(logs: Sequence[str]) -> Iterator[Callable[[str], None]]:
    """Show the progress in bytes; yields a function to call with each finished log."""
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
    """Size of a log in bytes; 1 if it is unknown, so that the log counts."""
    try:
        return max(1, os.path.getsize(log))
    except OSError:
        return 1
