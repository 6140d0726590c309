"""The outcome of each requirement over a whole trace, from the columns of the monitor's signals.

Two engines give the columns: `evaluate` computes all ticks at once, `stepped` steps the monitor
tick by tick. Both compute a certain and a possible column of each signal.

The text below the imports is copied into every generated monitor exactly, names and comments
included: a change of it changes all of them. Types of dataclasses are in parentheses: for others
that are texts, `dataclass` looks its module up in `sys.modules`, where an executed text has none.
"""

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from monitors.kernel.columns import (
    LARGE,
    Column,
    Tape,
    first_of,
    reuse_memory,
    rows_of,
    ticks_of,
    until,
)
from monitors.kernel.listings import Listing, run_list, tick_list
from monitors.kernel.stepping import Approximation, Monitor, Row, finite_verdict, literals_of
from monitors.kernel.verdicts import (
    INCONCLUSIVE,
    NO_DATA,
    VIOLATED,
    Requirement,
    Signals,
    Truth,
    Verdict,
    at_end,
    same_length,
    truth,
)


@dataclass(frozen=True)
class Outcome:
    """The result of one requirement on a whole trace; intervals of ticks include both ends.

    `evaluate` gives the lists as `Listing`, which are computed when they are first read.
    """

    requirement: str
    ticks: int
    verdict: Verdict
    finite: Truth
    """FRET's verdict on the finite trace."""
    first_violation: "(int | None)"
    violations: "(Sequence[tuple[int, int]])"
    """Intervals of ticks at which an obligation was violated, or was overdue without response."""
    unknown: "(Sequence[tuple[int, int]])"
    """Intervals of ticks at which it is unknown whether an obligation was violated."""
    triggers: "(Sequence[int])"
    answers: "(Sequence[tuple[int, int]])"
    """Trigger and first response of each obligation that was met."""
    open: "(Sequence[tuple[int, int | None]])"
    """Trigger and deadline (None: no deadline) of each obligation that is open at the end."""
    uncertain: "(Sequence[int])" = ()
    """Triggers whose response or open obligation depends on unknown values; all others do not
    depend on them."""

    def as_json(self) -> "dict[str, Any]":
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
    monitor: Monitor, columns: "Mapping[str, Column]", ticks: int, end: Verdict = INCONCLUSIVE
) -> "tuple[Outcome, ...]":
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
    certain = possible = monitor.columns(
        every, **literals_of(monitor, columns, every, is_possible=False)
    )
    if any(columns[name].unknown for name in monitor.PROPOSITIONS):
        possible = monitor.columns(every, **literals_of(monitor, columns, every, is_possible=True))
    same_length(monitor.REQUIREMENTS, certain, possible)
    return tuple(
        _outcome(requirement, ticks, low, high, end)
        for requirement, low, high in zip(monitor.REQUIREMENTS, certain, possible)
    )


def stepped(
    monitor: Monitor, columns: "Mapping[str, Column]", ticks: int, end: Verdict = INCONCLUSIVE
) -> "tuple[Outcome, ...]":
    """The outcomes, as from `evaluate`, by stepping the monitor from tick 0 over every tick.

    Args, raises: as for `evaluate`.
    """
    monitor.reset()
    rows = rows_of([columns[name] for name in monitor.PROPOSITIONS], ticks)
    certain, possible = _Record(monitor), _Record(monitor)
    while some := list(itertools.islice(rows, _TICKS)):
        if any(None in row for row in some):
            monitor._fork()
        codes = _signal_codes(monitor.certain, some)
        certain.append(codes)
        if monitor.possible is monitor.certain:
            possible.append(codes)
        else:
            possible.append(_signal_codes(monitor.possible, some))
            monitor._meet()
    columns_of_both = tuple(certain.columns()), tuple(possible.columns())
    same_length(monitor.REQUIREMENTS, *columns_of_both)
    return tuple(
        _outcome(requirement, ticks, low, high, end)
        for requirement, low, high in zip(monitor.REQUIREMENTS, *columns_of_both)
    )


_TICKS = 512
"""Ticks over which the signals of one approximation are gathered, and then those of the other."""


def _signal_codes(approximation: Approximation, rows: "Iterable[Row]") -> bytes:
    """The codes of all signals after each row, one row after the other."""
    values: list[bool] = []
    for row in rows:
        approximation.advance((row,))
        for signals in approximation.signals():
            values += signals
    return bytes(values)


class _Record:
    """The signals of an approximation, tick by tick, as columns that grow."""

    def __init__(self, monitor: Monitor) -> None:
        self._tapes = [Tape() for _ in monitor.REQUIREMENTS for _ in Signals._fields]

    def append(self, codes: bytes) -> None:
        """Append the signals of further ticks, tick by tick."""
        for index, tape in enumerate(self._tapes):
            tape.append(codes[index :: len(self._tapes)])

    def columns(self) -> "Iterator[Signals[int]]":
        """The signals of each requirement."""
        columns = (tape.column().true for tape in self._tapes)
        return map(Signals, *[columns] * len(Signals._fields))


def _outcome(
    requirement: Requirement,
    ticks: int,
    certain: "Signals[int]",
    possible: "Signals[int]",
    end: Verdict,
) -> Outcome:
    last = ticks - 1
    violated, perhaps = (
        certain.violation | certain.violation_inevitable,
        possible.violation | possible.violation_inevitable,
    )
    unknown = perhaps ^ violated
    verdict = NO_DATA
    finite: Truth = None
    if ticks:
        pending = truth(
            _at(certain.obligation_pending, last), _at(possible.obligation_pending, last)
        )
        triggered = truth(certain.trigger != 0, possible.trigger != 0)
        verdict = at_end(truth(violated != 0, perhaps != 0), pending, triggered)
        broken = truth(certain.violation != 0, possible.violation != 0)
        finite = finite_verdict(
            broken,
            truth(_at(certain.violated_if_ended, last), _at(possible.violated_if_ended, last)),
        )
    if end == VIOLATED and verdict == INCONCLUSIVE:
        verdict, violated = VIOLATED, 1 << last
    demands = _Demands(
        ticks,
        requirement.deadline_ticks,
        certain.trigger,
        certain.answer,
        possible.answer,
        certain.obligation_pending,
        possible.obligation_pending,
    )
    return Outcome(
        requirement=requirement.id,
        ticks=ticks,
        verdict=verdict,
        finite=finite,
        first_violation=first_of(violated),
        violations=run_list(violated),
        unknown=run_list(unknown),
        triggers=tick_list(certain.trigger),
        answers=Listing(lambda: demands.answered, demands.answers),
        open=Listing(lambda: demands.open, demands.deadlines),
        uncertain=Listing(lambda: demands.uncertain, lambda: ticks_of(demands.uncertain)),
    )


def _at(column: int, tick: int) -> bool:
    """Its truth at a tick; before the first, nothing is true."""
    return tick >= 0 and bool(column >> tick & 1)


@dataclass(frozen=True)
class _Demands:
    """The result of each obligation: columns with a bit at its trigger.

    A demand waits as long as one may be open, up to the first answer that is certain.
    """

    ticks: int
    deadline_ticks: "(int | None)"
    triggers: int
    must_answer: int
    may_answer: int
    must_pending: int
    may_pending: int

    @cached_property
    def answered(self) -> int:
        """The obligations that were met in time."""
        return self.triggers & until(self._waits, self.must_answer, self._most)

    @cached_property
    def open(self) -> int:
        """The obligations that are open at the end, before their deadline."""
        first = max(_last_run(self._waits, self.ticks), self.ticks - self._most)
        return self.triggers >> first << first

    @cached_property
    def uncertain(self) -> int:
        """The met or open obligations that were possibly not pending until then."""
        waits = self.must_pending ^ self.must_pending & self.may_answer
        first = _last_run(waits, self.ticks)
        certain = until(waits, self.must_answer, self._most) & self.answered
        return self.answered ^ certain | self.open ^ self.open >> first << first

    @property
    def _waits(self) -> int:
        """The ticks at which an obligation may be open, and no response is certain."""
        return self.may_pending ^ self.may_pending & self.must_answer

    @property
    def _most(self) -> int:
        """How many ticks an obligation can be pending within the trace."""
        return self.ticks if self.deadline_ticks is None else min(self.deadline_ticks, self.ticks)

    def answers(self) -> "Iterator[tuple[int, int]]":
        """Trigger and response, which is the first one from the trigger on."""
        answers, answer = ticks_of(self.must_answer), -1
        for trigger in ticks_of(self.answered):
            while answer < trigger:
                answer = next(answers)
            yield trigger, answer

    def deadlines(self) -> "Iterator[tuple[int, int | None]]":
        """Trigger and deadline of each open obligation."""
        for trigger in ticks_of(self.open):
            yield trigger, None if self.deadline_ticks is None else trigger + self.deadline_ticks


def _last_run(column: int, ticks: int) -> int:
    """The first tick from which the column is true up to the end; `ticks` if there is none."""
    return (column ^ (1 << ticks) - 1).bit_length()
