"""What `fretc verify` prints: a line for each claim, runs as tables, and each assumption once."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import assert_never

from compiler.logic.claims import Proof, Result, Trace
from fretish.diagnostics import signs
from fretish.diagnostics.signs import Sign
from monitors.kernel.verdicts import Truth

Line = tuple[str, str | None]
"""A line and its colour."""


def lines(proofs: Sequence[Proof]) -> Iterator[Line]:
    """All of it, in the order of the proofs; why something is not checked is said once."""
    numbers, reasons = _numbers(proofs), dict[tuple[str, ...], str]()
    widths = [
        max(len(proof.requirement) for proof in proofs),
        max(len(proof.layer) for proof in proofs),
    ]
    for proof in proofs:
        sign = SIGNS[proof.result]
        head = f"{sign.glyph} {proof.requirement:<{widths[0]}}  {proof.layer:<{widths[1]}}"
        outcome = _outcome(proof, numbers)
        if proof.result is Result.NOT_CHECKED:
            first = reasons.setdefault((proof.layer, outcome), proof.requirement)
            outcome = outcome if first == proof.requirement else f"not checked: as {first}"
        yield f"{head}  {outcome}", sign.colour
        if proof.run is not None:
            for row in table(proof.run):
                yield f"    {row}", None
    if numbers:
        yield "assumptions", None
    for text, number in numbers.items():
        yield f"  {number:>2}  {text}", None


def _numbers(proofs: Sequence[Proof]) -> Mapping[str, int]:
    """Each assumption with its number, in the order in which they come."""
    texts = dict.fromkeys(text for proof in proofs for text in proof.assumptions)
    return {text: number for number, text in enumerate(texts, 1)}


SIGNS: Mapping[Result, Sign] = {
    Result.COUNTEREXAMPLE: signs.BAD,
    Result.NOT_CHECKED: signs.UNKNOWN,
    Result.VACUOUS: signs.EMPTY,
    Result.PROVED: signs.GOOD,
}
"""The worst first, as for verdicts."""


def _outcome(proof: Proof, numbers: Mapping[str, int]) -> str:
    """`proved under (1-4): the claim; the detail`."""
    under = ""
    if proof.assumptions:
        under = f" under ({_listed([numbers[text] for text in proof.assumptions])})"
    match proof.result:
        case Result.PROVED:
            return f"proved{under}: {proof.claim}; {proof.detail}"
        case Result.COUNTEREXAMPLE:
            return f"counterexample{under}: not true that {proof.claim}; {proof.detail}"
        case Result.VACUOUS:
            return f"vacuous{under}: {proof.claim}, but {proof.detail}"
        case Result.NOT_CHECKED:
            return f"not checked: {proof.claim}; {proof.detail}"
        case _:
            assert_never(proof.result)


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
        trace: of an endless run the rows that it has.
        propositions: those of the monitor, all of them columns of the run.
    """
    places = [trace.names.index(name) for name in propositions]
    written = io.StringIO()
    writer = csv.writer(written, lineterminator="\n")
    writer.writerow(propositions)
    for row in trace.rows:
        writer.writerow("" if row[i] is None else int(row[i] or 0) for i in places)
    return written.getvalue()
