"""The metadata records that a watch writes into its recording, and checks of untrusted ones.

The record `fretc.grid` states where the grid of ticks begins, as soon as it is placed, and
`fretc.watch`, at the end, the time up to which was watched and the times of missed messages. Both
state the clock by which they count. If messages came after later ones whose ticks had been judged,
`fretc.watch` has their number (`disordered`), and the grid is ignored. A record is also ignored if
it has another clock, is malformed, or states a start that no grid of the log can have. Times are
nanoseconds.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from fretc.logs.mcap.damage import LATEST
from fretc.logs.signals.samples import Gap
from fretc.logs.topic_columns import Columns
from fretish.bindings.amounts import seconds
from fretish.classes.frozen import dataclass
from fretish.clock import Clock, TimeSource, in_words
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span

GRID, WATCH = "fretc.grid", "fretc.watch"
"""The names of the records."""
_OF_GRID = (f"{GRID}.clock", f"{GRID}.origin", f"{WATCH}.clock", f"{WATCH}.until")
KEYS = frozenset({*_OF_GRID, f"{WATCH}.missed", f"{WATCH}.disordered"})
"""The keys of the records."""
_TIME = re.compile(r"[1-9][0-9]{0,18}")
_SPANS = re.compile(r"[1-9][0-9]{0,18}-[1-9][0-9]{0,18}( [1-9][0-9]{0,18}-[1-9][0-9]{0,18})*")


@dataclass(frozen=True, slots=True)
class Watched:
    """The facts about the watch that recorded a log, as far as they fit the log."""

    origin: int | None = None
    """The start of the grid of ticks."""
    until: int = 0
    """The end of the watch, on the declared clock."""
    missed: tuple[Gap, ...] = ()
    """Intervals of lost messages: first and last receive time."""
    lost: bool = False
    """Whether any messages were lost."""
    findings: tuple[Diagnostic, ...] = ()


def clock_text(clock: Clock) -> str:
    """The parts of a clock on which the grid depends."""
    by_stamps = clock.time is not TimeSource.LOG_TIME and clock.lateness is not None
    waits = f", late after {in_words(clock.lateness or 0)}" if by_stamps else ""
    return f"{clock}, by {clock.time}{waits}"


def grid_record(clock: Clock, origin: int) -> dict[str, str]:
    """The record of the start of a grid."""
    return {"clock": clock_text(clock), "origin": str(origin)}


def watch_record(
    clock: Clock, until: int, missed: tuple[Gap, ...], disordered: int = 0
) -> dict[str, str]:
    """The record of a watch that has ended."""
    behind = {"disordered": str(disordered)} if disordered else {}
    spans = {"missed": " ".join(f"{a}-{b}" for a, b in missed)} if missed else {}
    return {"clock": clock_text(clock), "until": str(until), **spans, **behind}


_SHOWN = 80
"""The most characters of an untrusted text."""


def watched(columns: Columns, described: Mapping[str, tuple[str, ...]], span: Span) -> Watched:
    """The facts in the records of a log, with a diagnostic for each.

    Missed messages count whatever the clock, and even at unknown times: they only make propositions
    unknown.
    """
    lost, gaps = _missed(described.get(f"{WATCH}.missed", ()))
    findings = [_missing(gaps, span)] if lost else []
    if not columns.clock.declared:
        return Watched(missed=gaps, lost=lost, findings=tuple(findings))
    stated = {key: described[key] for key in _OF_GRID if key in described}
    if f"{WATCH}.disordered" in described:
        stated.pop(f"{GRID}.origin", None)
    grid = _grid(stated, columns)
    if isinstance(grid, str):
        return Watched(None, 0, gaps, lost, (*findings, _refused(grid, span)))
    origin, until = grid
    if origin is not None or until:
        findings.append(_taken_over(origin, until, columns, span))
    return Watched(origin, until, gaps, lost, tuple(findings))


def _missed(texts: Sequence[str]) -> tuple[bool, tuple[Gap, ...]]:
    """Whether messages were missed, and when."""
    spans = [
        (int(a), int(b))
        for text in texts
        if _SPANS.fullmatch(text)
        for a, _, b in (span.partition("-") for span in text.split(" "))
    ]
    return bool(texts), tuple((a, b) for a, b in spans if a <= b < LATEST)


def _grid(stated: Mapping[str, tuple[str, ...]], columns: Columns) -> tuple[int | None, int] | str:
    """The start of the grid and the end of the watch, or the reason why they are ignored."""
    for key, values in stated.items():
        if len(values) > 1:
            return f"it has {len(values)} values of `{key}`"
    clock = clock_text(columns.clock)
    for record in (GRID, WATCH):
        named = stated.get(f"{record}.clock", (clock,))[0]
        if named != clock:
            return f"it uses the clock `{named[:_SHOWN]}`, not `{clock}`"
    texts = [stated.get(key, ("",))[0] for key in (f"{GRID}.origin", f"{WATCH}.until")]
    for text in texts:
        if text and not (_TIME.fullmatch(text) and int(text) < LATEST):
            return f"`{text[:_SHOWN]}` is no time in nanoseconds"
    origin, until = (int(text) if text else 0 for text in texts)
    if origin and not _fits(origin, columns):
        return f"no grid of this log can begin at {origin}"
    return origin or None, until


def _fits(origin: int, columns: Columns) -> bool:
    """Whether a watch can have placed its grid there.

    It has done so by the messages that had arrived by some moment, and less than a period after the
    first of their times. All messages that arrived until the first tick was judged had arrived
    then, and none that arrived a period after the time of the message that arrived first.
    """
    clock = columns.clock
    read = [column for column in columns.topics.values() if column.bound and len(column.logs)]
    if clock.period is None or not read:
        return False
    patience = clock.effective_lateness or 0
    arrivals = np.concatenate([np.array(column.logs, np.int64) for column in read])
    times = np.concatenate([column.stamps() for column in read])
    came_first = arrivals == arrivals.min()
    had_come = arrivals <= origin + clock.phase + patience
    least = times[had_come if had_come.any() else came_first]
    could_have_come = arrivals <= int(times[came_first].max()) + clock.period + patience
    most = times[had_come | came_first | could_have_come]
    latest = int(least.min() if had_come.any() else least.max())
    return int(most.min()) <= origin < latest + clock.period


def _taken_over(origin: int | None, until: int, columns: Columns, span: Span) -> Diagnostic:
    start = columns.span((origin or until, 0))[0]
    parts = []
    if origin is not None:
        parts.append(f"the grid of ticks begins {in_words(origin - start)} after the first message")
    if until > start:
        parts.append(f"it was watched for {seconds((until - start) / 1e9)}")
    return diagnostic("watch_grid_taken", span, taken=", and ".join(parts))


def _refused(why: str, span: Span) -> Diagnostic:
    return diagnostic("watch_grid_ignored", span, why=why)


def _missing(gaps: Sequence[Gap], span: Span) -> Diagnostic:
    length = sum(b - a for a, b in gaps)
    times = "once" if len(gaps) == 1 else f"{len(gaps)} times"
    how = f"{times}, for {seconds(length / 1e9)} in all: messages of these times are unknown"
    return diagnostic("watch_missed_messages", span, when=how if gaps else "at unknown times")
