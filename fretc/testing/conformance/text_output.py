"""Text output of `fretc test --against`: a row for each requirement, and each failing run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from shlex import join

from fretc.analysis.reasons import listed
from fretc.analysis.text_output import Line, drawn
from fretc.testing.conformance.findings import Conformance, Failure, GoalOutcome, Situated
from fretish.bindings.declarations import Role
from fretish.diagnostics import status_symbols as signs


def lines(conformance: Conformance, roles: Mapping[str, Role]) -> Iterator[Line]:
    """All lines of the output.

    Args:
        conformance: results of a program.
        roles: roles of its columns.
    """
    shown = signs.GOOD if conformance.is_complete else signs.UNKNOWN
    sign = signs.BAD if conformance.failures else shown
    yield f"{sign.glyph} {_headline(conformance)}", sign.colour
    yield "", None
    yield from _table(conformance)
    for failure in conformance.failures:
        yield "", None
        yield from _failure(failure, roles)
    rest = [*_rest(conformance)]
    if rest:
        yield "", None
        yield from rest


def _headline(conformance: Conformance) -> str:
    size = f"{_some(conformance.runs, 'run')} of {_some(conformance.ticks, 'tick')} together"
    name = f"`{join(conformance.command)}`"
    if conformance.failures:
        broken = listed([each.requirement for each in conformance.failures])
        return f"{name} violates {broken}: {size}"
    if not conformance.is_complete:
        return f"{name} violates nothing in {size}, but the test is not complete"
    return f"{name} conforms in {size}"


def _some(count: int, what: str) -> str:
    return f"{count:,} {what}{'' if count == 1 else 's'}".replace(",", " ")


def _table(conformance: Conformance) -> Iterator[Line]:
    broken = {each.requirement for each in conformance.failures}
    width = max(map(len, conformance.requirements), default=0)
    for id in conformance.requirements:
        own = [situation for situation in conformance.situations if situation.requirement == id]
        counts = {kind: sum(each.outcome is kind for each in own) for kind in GoalOutcome}
        shown = ", ".join(f"{count} {kind}" for kind, count in counts.items() if count)
        sign = signs.BAD if id in broken else signs.GOOD if conformance.whole else signs.UNKNOWN
        if id in conformance.not_judged:
            sign, shown = signs.UNKNOWN, f"not judged: {conformance.not_judged[id]}"
        elif id in broken:
            shown = f"violated; {shown}" if shown else "violated"
        elif id in conformance.untried:
            sign, shown = signs.UNKNOWN, f"never triggered; {shown}" if shown else "never triggered"
        yield f"  {sign.glyph} {id:<{width}}  {shown}".rstrip(), sign.colour


def _failure(failure: Failure, roles: Mapping[str, Role]) -> Iterator[Line]:
    ticks = sum(row.count for row in failure.rows)
    text = f"{failure.requirement} is violated at tick {ticks - 1}: {failure.because}"
    yield f"{signs.BAD.glyph} {text}", signs.BAD.colour
    yield f"  {failure.sentence}", None
    play = [row.values for row in failure.rows for _ in range(row.count)]
    shown = [{name: "" if value is None else value for name, value in row.items()} for row in play]
    for row in drawn(shown, roles):
        yield f"    {row}", None
    if not failure.again:
        yield "  repeated with the same inputs, the program gave other outputs", None
    elif ticks < failure.ticks:
        yield (
            f"  found on {_some(failure.ticks, 'tick')}, shortened by {failure.tries} runs",
            None,
        )


def _rest(conformance: Conformance) -> Iterator[Line]:
    """Situations that were not reached."""
    for id in conformance.requirements:
        own = [situation for situation in conformance.situations if situation.requirement == id]
        free = [each.situation for each in own if each.outcome is GoalOutcome.UP_TO_PROGRAM]
        if free:
            text = f"{id}: depends on the program, and did not occur: {', '.join(free)}"
            yield f"{signs.UNUSED.glyph} {text}", signs.UNUSED.colour
        yield from _missing(own)


def _missing(own: Sequence[Situated]) -> Iterator[Line]:
    for each in own:
        if each.outcome in (GoalOutcome.NOT_REACHED, GoalOutcome.NOT_SEARCHED):
            why = f": {each.why}" if each.why else ""
            text = f"{each.requirement}: {each.outcome}: {each.words}{why}"
            yield f"{signs.UNKNOWN.glyph} {text}", signs.UNKNOWN.colour
