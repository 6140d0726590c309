"""Requirements that the selection of logs may have left out of the newest round.

`fretc audit --since` and `--sample` select among the named logs, and evidence states how many they
left out, not which.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

from fretc.audit.evidence.schema import Selection
from fretc.trends.changes import RoundOutcome, VerdictChange, round_outcome
from fretc.trends.histories import Histories, HistoryRun, RunOutcome


def is_left_out(
    histories: Histories, requirement: str, judged: Sequence[RunOutcome], change: VerdictChange
) -> bool:
    """Whether the selection of logs may be the reason for a change.

    Args:
        histories: the histories of all evidence.
        requirement: its id.
        judged: all results of the requirement in one scenario.
        change: the change as if all logs had been selected.
    """
    newest = histories.rounds[-1]
    runs = histories.runs
    now = [
        runs[outcome.run]
        for outcome in judged
        if outcome.round == histories.newest and outcome.run >= 0
    ]
    before = [
        outcome for outcome in judged if outcome.round < histories.newest and outcome.run >= 0
    ]
    if change is VerdictChange.GONE and requirement in newest.requirements:
        last = max((one.round for one in before), default=-1)
        return any(
            _may_leave_out(selection, runs[one.run])
            for one in before
            if one.round == last
            for selection in newest.selections
        )
    if change is VerdictChange.FIXED:
        violated = [one for one in before if round_outcome([one.verdict]) is RoundOutcome.VIOLATED]
        last = max((outcome.round for outcome in violated), default=-1)
        names, logs = {run.name for run in now}, {run.content for run in now}
        contents = {runs[one.run].content for one in before}
        return any(
            _may_leave_out(selection, runs[outcome.run], by_date=logs <= contents)
            for outcome in violated
            if outcome.round == last
            and runs[outcome.run].name not in names
            and runs[outcome.run].content not in logs
            for selection in newest.selections
        )
    return False


def _may_leave_out(selection: Selection, run: HistoryRun, *, by_date: bool = True) -> bool:
    """Whether the selection may be the reason why the log of a run was not audited.

    Args:
        selection: the selection of the newest round.
        run: a run of an earlier round.
        by_date: whether its date counts. A newer log of its scenario replaces an older one; a log
            that a sample has left out may be as new as those in it.
    """
    if selection.sample_of is not None and selection.audited < selection.sample_of:
        return True
    if not by_date or selection.since is None or not selection.older:
        return False
    since = datetime.fromisoformat(selection.since).timestamp()
    return run.time is None or run.time / 10**9 < since
