"""What `fretc verify` prints: a line for each claim, runs as tables, and each assumption once."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import assert_never

from compiler.logic.claims import (
    Counterexample,
    Evidence,
    NotChecked,
    Proved,
    Result,
    Trace,
    Vacuous,
)
from fretish.diagnostics import signs
from fretish.diagnostics.signs import Sign
from monitors.kernel.verdicts import Truth

Line = tuple[str, str | None]
"""A line and its colour."""


def lines(evidence: Sequence[Evidence]) -> Iterator[Line]:
    """All of it, in the order of the evidence."""
    numbers = _numbers(evidence)
    widths = [
        max(len(one.requirement) for one in evidence),
        max(len(one.layer) for one in evidence),
    ]
    for one in evidence:
        sign = _sign(one.result)
        head = f"{sign.glyph} {one.requirement:<{widths[0]}}  {one.layer:<{widths[1]}}"
        yield f"{head}  {_result(one, numbers)}", sign.colour
        if isinstance(one.result, Counterexample) and one.result.trace is not None:
            for row in table(one.result.trace):
                yield f"    {row}", None
    if numbers:
        yield "assumptions", None
    for text, number in numbers.items():
        yield f"  {number:>2}  {text}", None


def _numbers(evidence: Sequence[Evidence]) -> Mapping[str, int]:
    """Each assumption with its number, in the order in which they come."""
    texts = dict.fromkeys(text for one in evidence for text in one.assumptions)
    return {text: number for number, text in enumerate(texts, 1)}


def _sign(result: Result) -> Sign:
    match result:
        case Proved():
            return signs.GOOD
        case Counterexample():
            return signs.BAD
        case Vacuous():
            return signs.EMPTY
        case NotChecked():
            return signs.UNKNOWN
        case _:
            assert_never(result)


def _result(one: Evidence, numbers: Mapping[str, int]) -> str:
    """`proved under (1-4): the claim; what was looked at`."""
    under = ""
    if one.assumptions:
        under = f" under ({_listed([numbers[text] for text in one.assumptions])})"
    match one.result:
        case Proved(detail):
            return f"proved{under}: {one.claim}; {detail}"
        case Counterexample(detail):
            return f"counterexample{under}: not true that {one.claim}; {detail}"
        case Vacuous(detail):
            return f"vacuous{under}: {one.claim}, but {detail}"
        case NotChecked(reason):
            return f"not checked: {one.claim}; {reason}"
        case _:
            assert_never(one.result)


def _listed(numbers: Sequence[int]) -> str:
    """`1-4, 6`."""
    runs = []
    for _, group in groupby(enumerate(sorted(numbers)), lambda pair: pair[1] - pair[0]):
        run = [number for _, number in group]
        runs.append(f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]))
    return ", ".join(runs)


# Runs -----------------------------------------------------------------------------------------


def table(trace: Trace) -> Iterator[str]:
    """The run under heads; equal ticks together, and what is repeated for ever marked."""
    stretches = list(_stretches(trace))
    heads = ("tick", *trace.names)
    rows = [
        (span, *map(_value, trace.rows[first], trace.names), action)
        for span, first, action in stretches
    ]
    widths = [max(len(row[i]) for row in (heads, *rows)) for i in range(len(heads))]
    yield "  ".join(head.rjust(width) for head, width in zip(heads, widths, strict=True))
    for row in rows:
        cells = (cell.rjust(width) for cell, width in zip(row[:-1], widths, strict=True))
        yield f"{'  '.join(cells)}  {row[-1]}".rstrip()
    if trace.cycle is not None:
        yield f"and from tick {trace.cycle} on the same again, for ever"


def _stretches(trace: Trace) -> Iterator[tuple[str, int, str]]:
    """`3` or `3..7`, the first tick of it, and what happens at each."""
    actions = trace.actions or ("",) * len(trace.rows)
    ticks = range(len(trace.rows))
    alike = groupby(
        ticks, lambda t: (trace.rows[t], actions[t], trace.cycle is not None and t >= trace.cycle)
    )
    for _, group in alike:
        run = list(group)
        span = str(run[0]) if len(run) == 1 else f"{run[0]}..{run[-1]}"
        yield span, run[0], actions[run[0]]


def _value(value: Truth, name: str) -> str:
    if value is None:
        return "-" if name == "delivered" else "?"
    return str(int(value))


def as_csv(trace: Trace, propositions: Sequence[str]) -> str:
    """The propositions of the run as the monitor's own command line reads them.

    Args:
        trace: of an endless run the part that is told.
        propositions: those of the monitor, all of them columns of the run.
    """
    places = [trace.names.index(name) for name in propositions]
    written = io.StringIO()
    writer = csv.writer(written, lineterminator="\n")
    writer.writerow(propositions)
    for row in trace.rows:
        writer.writerow("" if row[i] is None else int(row[i] or 0) for i in places)
    return written.getvalue()
