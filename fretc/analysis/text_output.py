"""Text output of `fretc analyze`: the verdict, each conflict with a trace, then other findings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby

from fretc.analysis.findings import (
    Analysis,
    Component,
    Conflict,
    Inconsistency,
    RealizabilityVerdict,
    Repair,
)
from fretc.analysis.reasons import listed
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.status_symbols import StatusSymbol

Line = tuple[str, str | None]
"""A line and its colour."""
SIGNS: Mapping[RealizabilityVerdict, StatusSymbol] = {
    RealizabilityVerdict.UNREALIZABLE: signs.BAD,
    RealizabilityVerdict.NOT_CHECKED: signs.UNKNOWN,
    RealizabilityVerdict.REALIZABLE: signs.GOOD,
}
"""Symbols of verdicts, the worst first."""
_UNKNOWN = signs.UNKNOWN.colour
_WIDEST = 14
"""Maximum number of adjacent columns of a trace; further ones follow below."""


def lines(
    analysis: Analysis, sentences: Mapping[str, str], left_out: Sequence[str] = ()
) -> Iterator[Line]:
    """All lines of the text output.

    Args:
        analysis: the analysis.
        sentences: each requirement in FRETish, by its id.
        left_out: ids of requirements that were not analyzed because of errors.
    """
    sign = SIGNS[analysis.verdict]
    yield f"{sign.glyph} {_headline(analysis, 'other ' if left_out else '')}", sign.colour
    if left_out:
        yield f"{signs.UNKNOWN.glyph} without {listed(left_out)}: see the errors", _UNKNOWN
    for component in analysis.components:
        yield from _component(component)
    for number, conflict in enumerate(analysis.conflicts, 1):
        yield "", None
        yield from _conflict(number, conflict, analysis, sentences)
    if analysis.conflicts and not analysis.complete:
        yield "", None
        yield f"{signs.UNKNOWN.glyph} there may be more conflicts", signs.UNKNOWN.colour
    said = [*remarks(analysis)]
    if said:
        yield "", None
        yield from said
    for clash in analysis.inconsistent:
        yield "", None
        yield from _inconsistency(clash, analysis)
    yield "", None
    yield from _rest(analysis)


def _headline(analysis: Analysis, which: str) -> str:
    count = len(analysis.components)
    bad = sum(
        component.verdict is RealizabilityVerdict.UNREALIZABLE for component in analysis.components
    )
    match analysis.verdict:
        case RealizabilityVerdict.REALIZABLE:
            how = (
                "while the assumptions hold" if analysis.assumptions else "whatever the inputs are"
            )
            return f"realizable: a system can satisfy all {which}requirements, {how}"
        case RealizabilityVerdict.UNREALIZABLE if count == 1:
            return f"unrealizable: no system can satisfy all {which}requirements"
        case RealizabilityVerdict.UNREALIZABLE:
            return f"unrealizable: {bad} of {count} components cannot be satisfied"
        case RealizabilityVerdict.NOT_CHECKED:
            return f"not checked: {analysis.why}"


def _component(component: Component) -> Iterator[Line]:
    sign = SIGNS[component.verdict]
    about = f" (about {', '.join(component.outputs)})" if component.outputs else ""
    yield f"  {sign.glyph} {', '.join(component.requirements)}{about}: {component.why}", sign.colour


def _conflict(
    number: int, conflict: Conflict, analysis: Analysis, sentences: Mapping[str, str]
) -> Iterator[Line]:
    ids = conflict.requirements
    what = "cannot be satisfied by any system" if len(ids) == 1 else "cannot be satisfied together"
    yield f"{signs.BAD.glyph} conflict {number}: {listed(ids)} {what}", signs.BAD.colour
    yield f"  {conflict.because}", None
    width = max(map(len, ids))
    for id in ids:
        yield f"  {id:<{width}}  {sentences.get(id, '')}".rstrip(), None
    for row in drawn(conflict.play, analysis.roles_in(ids)):
        yield f"    {row}", None
    if conflict.loop is not None:
        yield f"    the ticks from {conflict.loop} on repeat for ever", None
    fixing = [each for each in analysis.repairs if each.conflict == ids]
    if fixing:
        yield "  each of these changes resolves the conflict (proved):", None
    for repair in fixing:
        yield from _repair(repair)


def _repair(repair: Repair) -> Iterator[Line]:
    what = repair.requirement or "assume"
    last = len(repair.sentences) - 1
    for number, sentence in enumerate(repair.sentences):
        rest = "" if repair.settles or number < last else "  (other conflicts stay)"
        yield f"    {what if number == 0 else 'and'}: {sentence}{rest}", None


def _inconsistency(clash: Inconsistency, analysis: Analysis) -> Iterator[Line]:
    sign = signs.OPEN
    where = "from the start" if not clash.play else "after this run, which violates none of them"
    ids = listed(clash.requirements)
    yield f"{sign.glyph} {ids} can no longer be satisfied together {where}", sign.colour
    for row in drawn(clash.play, analysis.roles_in(clash.requirements)):
        yield f"    {row}", None


def drawn(play: Sequence[Mapping[str, object]], roles: Mapping[str, Role]) -> Iterator[str]:
    """A row for each variable, inputs first; equal ticks share a column."""
    names = lanes(play, roles)
    if not names:  # There is no tick, or no variable because only outputs are compared.
        return
    lines = columns(play, names)
    width = max(len("tick"), *(len(_lane(name, roles)) for name in names))
    for start in range(0, len(lines), _WIDEST):
        shown = lines[start : start + _WIDEST]
        widths = [max(len(each.head), *map(len, each.values)) for each in shown]
        yield _row("tick", [each.head for each in shown], width, widths)
        for index, name in enumerate(names):
            yield _row(_lane(name, roles), [each.values[index] for each in shown], width, widths)


@dataclass(frozen=True, slots=True)
class TickColumn:
    """Equal adjacent ticks, and the value of each row."""

    first: int
    last: int
    values: tuple[str, ...]

    @property
    def head(self) -> str:
        """`3`, or `3..7`."""
        return str(self.first) if self.first == self.last else f"{self.first}..{self.last}"


def lanes(play: Sequence[Mapping[str, object]], roles: Mapping[str, Role]) -> list[str]:
    """Names of the variables of a trace, inputs first."""
    names = play[0] if play else ()
    return sorted(names, key=lambda name: (roles.get(name) is Role.OUTPUT, name))


def columns(play: Sequence[Mapping[str, object]], names: Sequence[str]) -> list[TickColumn]:
    """A trace with equal adjacent ticks in one column."""
    found: list[TickColumn] = []
    for _, group in groupby(enumerate(play), lambda pair: pair[1]):
        run = list(group)
        values = tuple(_value(run[0][1][name]) for name in names)
        found.append(TickColumn(run[0][0], run[-1][0], values))
    return found


def _lane(name: str, roles: Mapping[str, Role]) -> str:
    role = roles.get(name)
    return name if role is None else f"{name} ({role})"


def _row(head: str, cells: Iterable[str], width: int, widths: Sequence[int]) -> str:
    padded = (cell.rjust(size) for cell, size in zip(cells, widths, strict=True))
    return f"{head:<{width}}  {'  '.join(padded)}".rstrip()


def _value(value: object) -> str:
    if value is None:
        return "?"
    return str(int(value)) if isinstance(value, bool) else str(value)


def remarks(analysis: Analysis) -> Iterator[Line]:
    """Findings about single requirements."""
    empty = signs.EMPTY
    if analysis.consistent is False:
        yield f"{signs.BAD.glyph} no run satisfies all requirements", signs.BAD.colour
    for id in analysis.never:
        yield f"{signs.BAD.glyph} no run satisfies {id}", signs.BAD.colour
    for id in analysis.always:
        yield f"{empty.glyph} every run satisfies {id}: it has no effect", empty.colour
    for vacuity in analysis.vacuous:
        never = (
            "is never triggered" if vacuity.what == "trigger" else "has a scope that never begins"
        )
        by = f" as long as {listed(vacuity.by)} is satisfied" if len(vacuity.by) == 1 else ""
        by = f" as long as {listed(vacuity.by)} are satisfied" if len(vacuity.by) > 1 else by
        yield f"{empty.glyph} {vacuity.requirement} {never}{by}", empty.colour
    for each in analysis.redundant:
        if each.by:
            verb = "implies" if len(each.by) == 1 else "imply"
            text = f"{each.requirement} is redundant: {listed(each.by)} {verb} it"
            yield f"{empty.glyph} {text}", empty.colour
    gone = [id for id in analysis.removable if id not in analysis.always]
    if len([redundancy for redundancy in analysis.redundant if redundancy.by]) > 1 and gone:
        yield f"  {listed(gone)} can be removed together: the others imply them", None


def _rest(analysis: Analysis) -> Iterator[Line]:
    """Open questions and assumptions of the analysis."""
    for each in analysis.open:
        text = f"{signs.UNKNOWN.glyph} open: {each.question}: {each.why}"
        yield text, signs.UNKNOWN.colour
    for assumption in analysis.assumptions:
        yield f"assumed {assumption.in_words}", None
    for role in (Role.INPUT, Role.OUTPUT):
        names = [name for name, own in analysis.roles.items() if own is role]
        yield f"{role}s: {', '.join(names) or 'none'}", None
    for term in analysis.terms:
        yield f"assumption: {term}", None
