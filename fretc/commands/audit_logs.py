"""The logs of a command: their selection, the progress of reading them, and an audit of them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from fretc.audit.evidence.schema import Selection
from fretc.audit.log_paths import logs as logs_of
from fretc.audit.many_logs import AuditOutcome, Engine, audit_logs
from fretc.audit.plan import Plan
from fretc.audit.selection.choice import chosen, in_words
from fretc.audit.selection.dates import since as time_of
from fretc.terminal.output import EXIT_INCONCLUSIVE, EXIT_INTERRUPTED, or_fail, print_status
from fretc.terminal.progress import progress


def selected(
    paths: Sequence[str], since: str | None = None, sample: int | None = None, seed: int = 0
) -> tuple[list[str], Selection | None]:
    """The selected logs; exits with status 3 if no log is left.

    Args:
        paths: logs as named by the user.
        since: date of the oldest log; None: any date.
        sample: size of the random sample; None: all logs.
        seed: seed of the random sample.
    """
    than = None if since is None else or_fail(time_of(since))
    some, selection = chosen(or_fail(logs_of(paths)), than, sample, seed)
    if selection is not None:
        print_status(in_words(selection))
    if not some:
        print_status("no log is audited; the evidence is unchanged")
        raise SystemExit(EXIT_INCONCLUSIVE)
    return some, selection


def audit_in_memory(plan: Plan, logs: Sequence[str], engine: Engine) -> AuditOutcome:
    """Audit the logs in memory; an interrupted audit saves nothing."""
    try:
        with shown(logs) as show:
            result = audit_logs(plan, logs, engine, tell=lambda log, _: show(log))
    except KeyboardInterrupt:
        print_status("stopped")
        raise SystemExit(EXIT_INTERRUPTED) from None
    return or_fail(result)


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
