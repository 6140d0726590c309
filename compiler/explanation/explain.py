"""A requirement explained: meaning, formulas, picture, and traces with their reasons."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import Any

from compiler.explanation import drawing
from compiler.explanation.diagram import Diagram, DiagramLane, diagram, words
from compiler.explanation.examples import Example, Examples, examples
from compiler.explanation.reasons import why
from compiler.formalization import record
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import Valuation, letters_by_valuation
from compiler.logic.definition import holds, holds_on_lasso
from compiler.targets import ltl
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.rendering import visible
from fretish.reading.recursion import with_recursion_limit

SCHEMA = "fretc-explanation-1"


@dataclass(frozen=True, slots=True)
class TickRow:
    """Ticks with the same values, one after the other."""

    first: int
    last: int
    values: Valuation
    repeats: bool
    """Whether the row is part of the loop."""
    decides: bool


@dataclass(frozen=True, slots=True)
class ExplainedTrace:
    """A trace with its verdict and reason, in rows."""

    satisfied: bool
    rows: tuple[TickRow, ...]
    decided: int | None
    """The tick at which the verdict is certain; None: only the end of the run makes it so."""
    reason: str


@dataclass(frozen=True, slots=True)
class Explanation:
    """Everything about a requirement that `fretc explain` shows."""

    requirement: FormalizedRequirement
    picture: Diagram
    propositions: tuple[str, ...]
    """The propositions, in the order of the values of a row."""
    traces: tuple[ExplainedTrace, ...]
    notes: tuple[str, ...]


@with_recursion_limit
def explanation(requirement: FormalizedRequirement) -> Explanation:
    """Explain a formalized requirement; every trace in it has been checked."""
    traces = examples(requirement)
    every = (*traces.satisfied, *traces.violated)
    letters = letters_by_valuation(requirement.sentence, traces.atoms) if every else {}
    for example in every:
        _check(requirement, traces.atoms, example)
    shown = tuple(_shown(requirement, letters, example) for example in every)
    notes = tuple(_notes(requirement, traces))
    return Explanation(requirement, diagram(requirement), traces.atoms, shown, notes)


def _notes(requirement: FormalizedRequirement, traces: Examples) -> Iterator[str]:
    if traces.note:
        yield f"no traces are shown: {traces.note}"
        return
    satisfied, violated = len(traces.satisfied), len(traces.violated)
    if traces.rounded or traces.is_undecided:
        from compiler.formalization.numbers.reals import NOT_DECIDED, rounding_note

        if traces.rounded:
            yield rounding_note(traces.rounded)
        if traces.is_undecided:
            yield NOT_DECIDED
    exactly = ", computed exactly" if traces.rounded else ""
    if not satisfied:
        yield f"no run that goes on satisfies the sentence{exactly}"
    if not violated:
        yield f"no run violates the sentence{exactly}"
    if satisfied == 1:
        yield "no other way to satisfy the sentence was found"
    if violated == 1:
        yield "no other way to violate the sentence was found"
    if requirement.sentence.probability is not None:
        yield "a run counts as one that satisfies or violates; the probability is over many runs"
    scope = requirement.sentence.scope
    needs_end = s.SHAPES[type(requirement.sentence.timing)].extent.needs_end
    if needs_end and s.ends_with_run(scope.kind if scope else None):
        yield "on a run without end nothing is required"


# Traces -----------------------------------------------------------------------------------------

_CHECKED = 30
"""Traces up to this number of ticks are also checked by the slow definitions of the operators."""


def _check(requirement: FormalizedRequirement, atoms: Sequence[str], example: Example) -> None:
    """Check that the formulas agree with the automaton on the trace, and on what it goes on to."""
    prefix = [dict(zip(atoms, values, strict=True)) for values in example.prefix]
    loop = [dict(zip(atoms, values, strict=True)) for values in example.loop]
    trace = [*prefix, *loop]
    if len(trace) > _CHECKED:
        return
    assert holds(requirement.ft_finite, trace) is example.satisfied
    assert holds(requirement.pt, trace, len(trace) - 1) is example.satisfied
    if loop or example.decided is not None:
        on_all_of_it = holds_on_lasso(requirement.ft_infinite, prefix, loop or prefix[-1:])
        assert on_all_of_it is example.satisfied


def _shown(
    requirement: FormalizedRequirement, letters: Mapping[Valuation, Any], example: Example
) -> ExplainedTrace:
    prefix = [letters[values] for values in example.prefix]
    loop = [letters[values] for values in example.loop]
    ends = not loop and example.decided is None
    return ExplainedTrace(
        example.satisfied,
        tuple(_rows(example)),
        example.decided,
        why(requirement, prefix, loop, ends=ends, satisfied=example.satisfied),
    )


_FOLDED = 4
"""Number of equal ticks from which they are shown as one row."""


def _rows(example: Example) -> Iterator[TickRow]:
    """The ticks as rows; equal ticks share a row, but the deciding tick has its own."""
    start = len(example.prefix)
    ticks = [
        (values, tick >= start, tick == example.decided)
        for tick, values in enumerate((*example.prefix, *example.loop))
    ]
    first = 0
    for (values, repeats, decides), group in groupby(ticks):
        count = len(list(group))
        if count < _FOLDED:
            for tick in range(first, first + count):
                yield TickRow(tick, tick, values, repeats, decides)
        else:
            yield TickRow(first, first + count - 1, values, repeats, decides)
        first += count


# Text and JSON ----------------------------------------------------------------------------------

_NAME = 28
_UNDECIDED = "decided at the end only"


def text(explained: Explanation) -> str:
    """The explanation as text for a terminal."""
    requirement = explained.requirement
    # Control characters are made visible: no user's text can hide another.
    lines = "".join(f"{visible(line)}\n" for line in ltl.text(requirement).splitlines())
    blocks = [lines, drawing.text(explained.picture, "    ")]
    blocks[1] = f"  one run, drawn\n{blocks[1]}\n"
    blocks.extend(table(explained, shown) for shown in explained.traces)
    if explained.notes:
        blocks.append("".join(f"  note: {visible(note)}\n" for note in explained.notes))
    return "\n".join(blocks)


def table(explained: Explanation, shown: ExplainedTrace) -> str:
    """A trace as text for a terminal: its reason, and a line for each row."""
    wordings = explained.requirement.wordings
    names = [
        drawing.shortened(visible(wordings.get(name, name)), _NAME)
        for name in explained.propositions
    ]
    labels = [_label(row) for row in shown.rows]
    width = max(map(len, [*labels, "tick"])) + 2
    head = "".join(f"{name}  " for name in names).rstrip()
    lines = [f"    {'tick':<{width}}{head}"]
    for label, row in zip(labels, shown.rows, strict=True):
        cells = "".join(
            f"{int(value)}".ljust(len(name) + 2)
            for name, value in zip(names, row.values, strict=True)
        )
        mark = "  …repeats" if row.repeats else "  ← decided" if row.decides else ""
        lines.append(f"    {label:<{width}}{cells}{mark}".rstrip())
    end = _UNDECIDED if shown.decided is None else f"decided at tick {shown.decided}"
    sign = signs.GOOD if shown.satisfied else signs.BAD
    verdict = f"{sign.glyph} {'satisfied' if shown.satisfied else 'violated'}"
    return "\n".join([f"  {verdict}: {visible(shown.reason)}", *lines, f"    {end}", ""])


def _label(row: TickRow) -> str:
    return str(row.first) if row.first == row.last else f"{row.first}..{row.last}"


def as_record(explained: Explanation) -> dict[str, Any]:
    """The explanation as plain values for JSON, in a fixed order of keys."""
    requirement, picture = explained.requirement, explained.picture
    everything = record.record(requirement)
    kept = ("id", "title", "sentence", "meaning", "ft_infinite", "ft_finite", "pt", "tick_ns")
    return {
        "schema": SCHEMA,
        **{key: everything[key] for key in kept},
        "diagram": {
            "ticks": picture.ticks,
            "run_ends": picture.ends,
            "words": words(picture),
            "lanes": [_lane(lane) for lane in picture.lanes],
        },
        "propositions": list(explained.propositions),
        "traces": [_trace(explained.propositions, shown) for shown in explained.traces],
        "notes": list(explained.notes),
    }


def _lane(lane: DiagramLane) -> dict[str, Any]:
    stretches = [
        {"first": stretch.first, "last": stretch.last, "goes_on": stretch.goes_on}
        for stretch in lane.stretches
    ]
    return {"kind": lane.kind.value, "name": lane.name, "note": lane.remark, "ticks": stretches}


def _trace(propositions: Sequence[str], shown: ExplainedTrace) -> dict[str, Any]:
    rows = [
        {
            "first": row.first,
            "last": row.last,
            "values": dict(zip(propositions, row.values, strict=True)),
            "repeats": row.repeats,
        }
        for row in shown.rows
    ]
    verdict = "satisfied" if shown.satisfied else "violated"
    return {"verdict": verdict, "rows": rows, "decided": shown.decided, "reason": shown.reason}
