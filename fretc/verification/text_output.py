"""Text output of `fretc verify`: an overview, claims with their runs, and the assumptions."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import assert_never

from compiler.logic.claims import ClaimResult, ClaimTrace, Layer, Proof
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.status_symbols import StatusSymbol
from monitors.kernel.verdicts import Truth

Line = tuple[str, str | None]
"""A line and its colour."""


def lines(proofs: Sequence[Proof], *, every_claim: bool = False) -> Iterator[Line]:
    """A table of requirements and layers, then each claim that is not proved, worst first.

    A table with a single cell is left out, and all claims are listed.

    Args:
        proofs: all proofs.
        every_claim: whether claims that are proved or do not apply are listed, too.
    """
    cells = _cells(proofs)
    if len(cells) > 1:
        yield from _overview(cells)
        yield from _counts(proofs, every_claim=every_claim)
    is_whole = every_claim or len(cells) == 1
    worst_first = sorted(proofs, key=lambda proof: _ORDER.index(proof.result))
    yield from _details([one for one in worst_first if is_whole or one.result in _OPEN])


# The table ------------------------------------------------------------------------------------

_Cells = Mapping[tuple[str, Layer], ClaimResult]
"""Worst result of each requirement at each layer, or of a shared part."""


def _cells(proofs: Sequence[Proof]) -> _Cells:
    cells: dict[tuple[str, Layer], ClaimResult] = {}
    for proof in proofs:
        place = proof.requirement, proof.layer
        cells[place] = min(cells.get(place, proof.result), proof.result, key=_ORDER.index)
    return cells


def _overview(cells: _Cells) -> Iterator[Line]:
    """A row for each requirement, a column for each layer, and a symbol for the worst result."""
    rows = dict.fromkeys(requirement for requirement, _ in cells)
    columns = [layer for layer in Layer if any(layer is each for _, each in cells)]
    width = max(map(len, rows))
    yield f"{'':<{width}}  {'  '.join(columns)}", None
    for row in rows:
        results = [cells.get((row, column)) for column in columns]
        symbols = (SIGNS[result].glyph if result else "" for result in results)
        padded = (f"{symbol:<{len(head)}}" for symbol, head in zip(symbols, columns, strict=True))
        worst = min((result for result in results if result), key=_ORDER.index)
        yield f"{row:<{width}}  {'  '.join(padded)}".rstrip(), SIGNS[worst].colour


def _counts(proofs: Sequence[Proof], *, every_claim: bool) -> Iterator[Line]:
    """Number of proved claims, and of requirements to which each layer does not apply."""
    proved = [proof for proof in proofs if proof.result is ClaimResult.PROVED]
    if proved:
        noun = "claim is" if len(proved) == 1 else "claims are"
        under = sum(bool(proof.assumptions) for proof in proved)
        assuming = f", {under} of them under assumptions" if under else ""
        hint = "" if every_claim else ": `--all` lists them"
        sign = SIGNS[ClaimResult.PROVED]
        yield f"{sign.glyph} {len(proved)} {noun} proved{assuming}{hint}", sign.colour
    absent = [each for each in proofs if each.result is ClaimResult.NOT_APPLICABLE]
    if absent:
        places = dict.fromkeys((each.layer, each.requirement) for each in absent)
        counts = Counter(layer for layer, requirement in places if requirement != layer)
        shared = [layer for layer, requirement in places if requirement == layer]
        parts = [f"{layer} to {_requirements(count)}" for layer, count in counts.items()]
        hint = "" if every_claim else ": `--all` lists why"
        sign = SIGNS[ClaimResult.NOT_APPLICABLE]
        yield f"{sign.glyph} does not apply: {', '.join([*parts, *shared])}{hint}", sign.colour


def _requirements(count: int) -> str:
    return f"{count} requirement{'' if count == 1 else 's'}"


# Claims ---------------------------------------------------------------------------------------


def _details(proofs: Sequence[Proof]) -> Iterator[Line]:
    """A line for each claim, with its run below it; each reason is explained once."""
    if not proofs:
        return
    numbers, reasons = _numbers(proofs), dict[tuple[str, ...], str]()
    widths = [
        max(len(proof.requirement) for proof in proofs),
        max(len(proof.layer) for proof in proofs),
    ]
    for proof in proofs:
        sign = SIGNS[proof.result]
        head = f"{sign.glyph} {proof.requirement:<{widths[0]}}  {proof.layer:<{widths[1]}}"
        outcome = _outcome(proof, numbers)
        if proof.result in _UNEXAMINED:
            first = reasons.setdefault((proof.layer, outcome), proof.requirement)
            words = _UNEXAMINED[proof.result]
            outcome = outcome if first == proof.requirement else f"{words}: as {first}"
        yield f"{head}  {outcome}", sign.colour
        if proof.run is not None:
            for row in table(proof.run):
                yield f"    {row}", None
    if numbers:
        yield "assumptions", None
    for text, number in numbers.items():
        yield f"  {number:>2}  {text}", None


def _numbers(proofs: Sequence[Proof]) -> Mapping[str, int]:
    """Assumption → its number, in the order of appearance."""
    texts = dict.fromkeys(text for proof in proofs for text in proof.assumptions)
    return {text: number for number, text in enumerate(texts, 1)}


SIGNS: Mapping[ClaimResult, StatusSymbol] = {
    ClaimResult.COUNTEREXAMPLE: signs.BAD,
    ClaimResult.NOT_CHECKED: signs.UNKNOWN,
    ClaimResult.VACUOUS: signs.EMPTY,
    ClaimResult.PROVED: signs.GOOD,
    ClaimResult.NOT_APPLICABLE: signs.RETIRED,
}
"""Symbols of results, the worst first."""
_ORDER = tuple(SIGNS)
_OPEN = (ClaimResult.COUNTEREXAMPLE, ClaimResult.NOT_CHECKED, ClaimResult.VACUOUS)
_UNEXAMINED = {ClaimResult.NOT_CHECKED: "not checked", ClaimResult.NOT_APPLICABLE: "does not apply"}


def _outcome(proof: Proof, numbers: Mapping[str, int]) -> str:
    """`proved under (1-4): the claim; the detail`."""
    under = ""
    if proof.assumptions:
        under = f" under ({_listed([numbers[text] for text in proof.assumptions])})"
    match proof.result:
        case ClaimResult.PROVED:
            return f"proved{under}: {proof.claim}; {proof.detail}"
        case ClaimResult.COUNTEREXAMPLE:
            return f"counterexample{under}: not true that {proof.claim}; {proof.detail}"
        case ClaimResult.VACUOUS:
            return f"vacuous{under}: {proof.claim}, but {proof.detail}"
        case ClaimResult.NOT_CHECKED:
            return f"not checked: {proof.claim}; {proof.detail}"
        case ClaimResult.NOT_APPLICABLE:
            return f"does not apply: {proof.claim}; {proof.detail}"
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


def table(trace: ClaimTrace) -> Iterator[str]:
    """The run as a table with headings; equal ticks share a row, and a repeated part is marked."""
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
        yield f"the ticks from {trace.cycle} on repeat for ever"


def _stretches(trace: ClaimTrace) -> Iterator[tuple[str, int, str]]:
    """`3` or `3..7`, its first tick, and the events of each of its ticks."""
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


def as_csv(trace: ClaimTrace, propositions: Sequence[str]) -> str:
    """The propositions of the run as CSV for the monitor's command line.

    Args:
        trace: the run; of an endless run its stored rows.
        propositions: all propositions of the monitor, which are columns of the run.
    """
    places = [trace.names.index(name) for name in propositions]
    written = io.StringIO()
    writer = csv.writer(written, lineterminator="\n")
    writer.writerow(propositions)
    for row in trace.rows:
        writer.writerow("" if row[i] is None else int(row[i] or 0) for i in places)
    return written.getvalue()
