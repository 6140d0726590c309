"""The change of a requirement in one scenario, from its verdicts round by round.

A round is violated if one of its runs is. It is shown if a run shows the requirement and no other
leaves it open. Else it is open: nothing is known, and nothing has improved. A requirement that was
violated and is open now is never called fixed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from itertools import pairwise

from fretc.audit.evidence.verdicts import BROKEN, SHOWN
from monitors import kernel


class RoundOutcome(StrEnum):
    """The combined verdict of a round."""

    VIOLATED = "violated"
    SHOWN = "shown"
    OPEN = "open"


class VerdictChange(StrEnum):
    """The change of a requirement in a scenario; the worst first."""

    NEW = "new"
    """Violated now, and not when it was last known."""
    FIRST_VIOLATED = "first seen, violated"
    STILL = "still violated"
    LOST = "lost"
    """Violated or shown before, and open now."""
    GONE = "gone"
    """Judged before, and not in the newest round."""
    NOT_SELECTED = "not selected"
    """Judged before, in runs that the selection of the newest round may have left out."""
    FIRST = "first seen"
    FIXED = "fixed"
    NEVER_SHOWN = "never shown"
    STEADY = "shown as before"


RED = (VerdictChange.NEW, VerdictChange.FIRST_VIOLATED)
"""The changes to violated."""
_NEUTRAL = (kernel.VACUOUS, "not exercised", "retired")
"""Verdicts that do not count beside others."""


def round_outcome(verdicts: Iterable[str]) -> RoundOutcome:
    """The combined verdict of a round from its verdicts, at least one."""
    words = {*verdicts}
    if words & {*BROKEN}:
        return RoundOutcome.VIOLATED
    left_open = words - {*SHOWN, *_NEUTRAL}
    return RoundOutcome.SHOWN if words & {*SHOWN} and not left_open else RoundOutcome.OPEN


def change(rounds: Sequence[Sequence[str]]) -> VerdictChange:
    """The change of a requirement.

    Args:
        rounds: the verdicts of each round, the newest last; empty for a round that did not judge
            it. At least one round has a verdict.
    """
    *before, now = [round_outcome(verdicts) if verdicts else None for verdicts in rounds]
    judged = [each for each in before if each is not None]
    last = last_known(rounds)
    if now is None:
        assert judged, "it was never judged"
        return VerdictChange.GONE
    if not judged:
        return VerdictChange.FIRST_VIOLATED if now is RoundOutcome.VIOLATED else VerdictChange.FIRST
    was_violated = last is not None and before[last] is RoundOutcome.VIOLATED
    match now:
        case RoundOutcome.VIOLATED:
            return VerdictChange.STILL if was_violated else VerdictChange.NEW
        case RoundOutcome.SHOWN:
            return VerdictChange.FIXED if was_violated else VerdictChange.STEADY
        case RoundOutcome.OPEN:
            return VerdictChange.LOST if last is not None else VerdictChange.NEVER_SHOWN


def last_known(rounds: Sequence[Sequence[str]]) -> int | None:
    """The index of the last round before the newest with a known outcome; None: none."""
    known_rounds = [
        i
        for i, one in enumerate(rounds[:-1])
        if one and round_outcome(one) is not RoundOutcome.OPEN
    ]
    return known_rounds[-1] if known_rounds else None


def is_flaky(rounds: Sequence[Sequence[str]], of_software: Mapping[str, Sequence[str]]) -> bool:
    """Whether violations came and went repeatedly, or one commit has both verdicts.

    Args:
        rounds: the verdicts of each round, the newest last.
        of_software: the verdicts of the runs of each commit.
    """
    round_outcomes = [round_outcome(verdicts) for verdicts in rounds if verdicts]
    decided = [
        round_outcome for round_outcome in round_outcomes if round_outcome is not RoundOutcome.OPEN
    ]
    turns = sum(a is not b for a, b in pairwise(decided))
    return turns > 1 or any(
        {*verdicts} & {*BROKEN} and {*verdicts} & {*SHOWN} for verdicts in of_software.values()
    )
