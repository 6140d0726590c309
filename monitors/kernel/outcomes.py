"""The outcome of each requirement over a whole trace, from the columns of the monitor's signals.

Two engines give the columns: `evaluate` computes all ticks at once, `stepped` steps the monitor
tick by tick. Both compute a certain column (`must`) and a possible one (`may`) of each signal.

The text below the imports is copied into every generated monitor to the letter, names and comments
included: a change of it changes all of them.
"""

import itertools
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from monitors.kernel.columns import (
    LARGE,
    Column,
    Tape,
    reuse_memory,
    rows_of,
    runs_of,
    ticks_of,
)
from monitors.kernel.stepping import Monitor, Rail, Row, finite_verdict, literals_of
from monitors.kernel.verdicts import (
    INCONCLUSIVE,
    NO_DATA,
    VIOLATED,
    Requirement,
    Signals,
    Truth,
    Verdict,
    at_end,
    truth,
)


@dataclass(frozen=True)
class Outcome:
    """One requirement over one whole trace; ticks count from 0, intervals include both ends."""

    requirement: str
    ticks: int
    verdict: Verdict
    finite: Truth
    """FRET's verdict on the finite trace."""
    first_violation: int | None
    violations: tuple[tuple[int, int], ...]
    """Runs of ticks at which a demand was broken, or was overdue and still unanswered."""
    unknown: tuple[tuple[int, int], ...]
    """Runs of ticks at which it cannot be known whether a demand was broken."""
    triggers: tuple[int, ...]
    answers: tuple[tuple[int, int], ...]
    """Trigger and first answer to it, where a demand waits for one and it came."""
    open: tuple[tuple[int, int | None], ...]
    """Trigger and deadline (None: there is none) of each demand that is open at the end."""
    uncertain: tuple[int, ...] = ()
    """Triggers whose answer, or whose open demand, may be another where propositions are unknown;
    of all others it is the same whatever the unknown values were."""

    def as_json(self) -> dict[str, Any]:
        """Plain values, in a fixed order of keys."""
        return {
            "requirement": self.requirement,
            "ticks": self.ticks,
            "verdict": self.verdict,
            "finite": self.finite,
            "first_violation": self.first_violation,
            "violations": [list(run) for run in self.violations],
            "unknown": [list(run) for run in self.unknown],
            "triggers": list(self.triggers),
            "answers": [list(pair) for pair in self.answers],
            "open": [{"trigger": t, "deadline": d} for t, d in self.open],
            "uncertain": list(self.uncertain),
        }


def evaluate(
    monitor: Monitor, columns: Mapping[str, Column], ticks: int, end: str = INCONCLUSIVE
) -> tuple[Outcome, ...]:
    """The column program over a whole trace; the monitor's own state is not touched.

    Args:
        monitor: any monitor.
        columns: one for each proposition.
        ticks: the length of the trace.
        end: what a demand is that is open at the end: `inconclusive` or `violated`.

    Raises:
        KeyError: a proposition has no column.
    """
    if ticks >= LARGE:
        reuse_memory()
    every = (1 << ticks) - 1
    must = may = monitor.columns(every, **literals_of(monitor, columns, every, doubt=False))
    if any(columns[name].unknown for name in monitor.PROPOSITIONS):
        may = monitor.columns(every, **literals_of(monitor, columns, every, doubt=True))
    return tuple(
        _outcome(requirement, ticks, certain, possible, end)
        for requirement, certain, possible in zip(monitor.REQUIREMENTS, must, may, strict=True)
    )


def stepped(
    monitor: Monitor, columns: Mapping[str, Column], ticks: int, end: str = INCONCLUSIVE
) -> tuple[Outcome, ...]:
    """The same as `evaluate`, by stepping the monitor from tick 0 over every tick.

    Args, raises: as for `evaluate`.
    """
    monitor.reset()
    rows = rows_of([columns[name] for name in monitor.PROPOSITIONS], ticks)
    must, may = _Record(monitor), _Record(monitor)
    while some := list(itertools.islice(rows, _TICKS)):
        if any(None in row for row in some):
            monitor._fork()
        certain = _signal_codes(monitor.must, some)
        must.append(certain)
        may.append(certain if monitor.may is monitor.must else _signal_codes(monitor.may, some))
    rails = zip(must.columns(), may.columns(), strict=True)
    return tuple(
        _outcome(requirement, ticks, certain, possible, end)
        for requirement, (certain, possible) in zip(monitor.REQUIREMENTS, rails, strict=True)
    )


_TICKS = 512
"""Ticks over which the signals of one rail are gathered, and then those of the other."""


def _signal_codes(rail: Rail, rows: Iterable[Row]) -> bytes:
    """The codes of all signals after each row, one row after the other."""
    values: list[bool] = []
    for row in rows:
        rail.advance((row,))
        for signals in rail.signals():
            values += signals
    return bytes(values)


class _Record:
    """The signals of a rail, tick by tick, as columns that grow."""

    def __init__(self, monitor: Monitor) -> None:
        self._tapes = [Tape() for _ in monitor.REQUIREMENTS for _ in Signals._fields]

    def append(self, codes: bytes) -> None:
        """Go on with all signals of some ticks, one tick after the other."""
        for place, tape in enumerate(self._tapes):
            tape.append(codes[place :: len(self._tapes)])

    def columns(self) -> Iterator[Signals[int]]:
        """Those of each requirement."""
        columns = (tape.column().true for tape in self._tapes)
        return map(Signals, *[columns] * len(Signals._fields))


def _outcome(
    requirement: Requirement, ticks: int, must: Signals[int], may: Signals[int], end: str
) -> Outcome:
    last = ticks - 1
    lost, lost_perhaps = must.breach | must.doom, may.breach | may.doom
    owed = truth(_at(must.owed, last), _at(may.owed, last))
    triggers = tuple(ticks_of(must.trigger))
    violations = runs_of(lost)
    verdict = NO_DATA
    if ticks:
        violated = truth(lost != 0, lost_perhaps != 0)
        verdict = at_end(violated, owed, truth(must.trigger != 0, may.trigger != 0))
    if end == VIOLATED and verdict == INCONCLUSIVE:
        verdict, violations = VIOLATED, ((last, last),)
    horizon = requirement.horizon
    answers, waiting = _answered(triggers, must.answer, may.owed, ticks)
    deadlines = [(trigger, None if horizon is None else trigger + horizon) for trigger in waiting]
    answered = tuple((t, k) for t, k in answers if horizon is None or k - t <= horizon)
    still_open = tuple((t, d) for t, d in deadlines if d is None or d > last)
    uncertain: tuple[int, ...] = ()
    if must != may:
        ends = (*answered, *((trigger, ticks) for trigger, _ in still_open))
        uncertain = _uncertain(ends, must.owed & ~may.answer)
    broken = truth(must.breach != 0, may.breach != 0)
    fails = truth(_at(must.fails, last), _at(may.fails, last))
    return Outcome(
        requirement=requirement.id,
        ticks=ticks,
        verdict=verdict,
        finite=finite_verdict(broken, fails) if ticks else None,
        first_violation=violations[0][0] if violations else None,
        violations=violations,
        unknown=runs_of(lost_perhaps ^ lost),
        triggers=triggers,
        answers=answered,
        open=still_open,
        uncertain=uncertain,
    )


def _at(column: int, tick: int) -> bool:
    """Its truth at a tick; before the first, nothing is true."""
    return tick >= 0 and bool(column >> tick & 1)


def _answered(
    triggers: tuple[int, ...], answer: int, owed: int, ticks: int
) -> tuple[tuple[tuple[int, int], ...], tuple[int, ...]]:
    """Each trigger with its answer; and the triggers that still wait at the end.

    A trigger waits as long as a demand may be open, up to the first answer.
    """
    answered = answer.to_bytes((ticks + 7) // 8, "little")
    unanswered = runs_of(owed & ~answer)
    starts = [first for first, _ in unanswered]
    pairs: list[tuple[int, int]] = []
    waiting: list[int] = []
    for trigger in triggers:
        place = bisect_right(starts, trigger) - 1
        waits = place >= 0 and trigger <= unanswered[place][1]
        then = unanswered[place][1] + 1 if waits else trigger
        if then == ticks:
            waiting.append(trigger)
        elif answered[then >> 3] >> (then & 7) & 1:
            pairs.append((trigger, then))
    return tuple(pairs), tuple(waiting)


def _uncertain(ends: Iterable[tuple[int, int]], waits: int) -> tuple[int, ...]:
    """Triggers that do not wait for certain up to the tick at which that ends.

    Args:
        ends: trigger and the tick of its answer, or the tick after the last one.
        waits: at which ticks a demand is open for certain, and for certain not answered.
    """
    runs = runs_of(waits)
    starts = [first for first, _ in runs]
    triggers: list[int] = []
    for trigger, end in ends:
        place = bisect_right(starts, trigger) - 1
        if trigger < end and (place < 0 or runs[place][1] < end - 1):
            triggers.append(trigger)
    return tuple(sorted(triggers))
