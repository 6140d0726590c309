"""Selection of the logs of an audit, and its time limits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fretc.terminal.output import EXIT_INCONCLUSIVE, fail, print_status
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fretc.audit.evidence.schema import Selection
    from fretc.audit.pool import Limits


def selected(
    paths: Sequence[str], since: str | None, sample: int | None, seed: int
) -> tuple[list[str], Selection | None]:
    """The selected logs; exits with status 3 if no log is left.

    Args:
        paths: logs as named by the user.
        since: date of the oldest log; None: any date.
        sample: size of the random sample; None: all logs.
        seed: seed of the random sample.
    """
    from fretc.audit.log_paths import logs as logs_of
    from fretc.audit.selection.choice import chosen, in_words
    from fretc.audit.selection.dates import since as time_of

    than = None if since is None else time_of(since)
    if isinstance(than, Diagnostic):
        fail(than)
    logs = logs_of(paths)
    if isinstance(logs, Diagnostic):
        fail(logs)
    some, selection = chosen(logs, than, sample, seed)
    if selection is not None:
        print_status(in_words(selection))
    if not some:
        print_status("no log is audited; the evidence is unchanged")
        raise SystemExit(EXIT_INCONCLUSIVE)
    return some, selection


def time_limits(log: str | None, whole: str | None, logs: Sequence[str], engine: str) -> Limits:
    """Time limits for each log and for all logs.

    Args:
        log: `--log-time`; None: no limit.
        whole: `--time`; None: no limit.
        logs: the logs to audit.
        engine: name of the engine.
    """
    from fretc.audit.pool import ENDLESS, Limits
    from fretc.logs.storage.log_names import STDIN

    limits = Limits(_seconds("--log-time", log), _seconds("--time", whole))
    if limits != ENDLESS and (STDIN in logs or engine != "local"):
        what = "standard input" if STDIN in logs else f"`--engine {engine}`"
        fail(diagnostic("no_time_limits", what=what))
    return limits


def _seconds(option: str, text: str | None) -> float | None:
    from fretish.units import nanoseconds

    length = None if text is None else nanoseconds(text)
    if text is not None and length is None:
        fail(diagnostic("bad_duration_option", option=option, text=text))
    return None if length is None else length / 1e9
