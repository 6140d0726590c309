"""What is shown about a place: a code, a name, a sentence."""

from __future__ import annotations

import re
from collections.abc import Iterator

from lsprotocol import types as lsp

from compiler.explanation import markdown
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from compiler.project.project import Project
from fretc.lsp.names import NameKind, Occurrence
from fretc.lsp.view import View
from fretish.bindings.declarations import ComputedSignal
from fretish.diagnostics import explanations
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Span
from fretish.meaning import meaning
from fretish.printer import expression

_CODES = {code.number: code for code in Code}
_MOST_USERS = 20
"""Requirements that are listed as users of a name."""
_LONGEST_FORMULA = 2000
"""Characters of a formula that are shown."""


def hover(view: View, offset: int) -> lsp.Hover | None:
    """The description of a place in Markdown: of a name, or else of the sentence around it."""
    parts = [*_of_diagnostics(view, offset)]
    occurrence, entry = view.occurrence_at(offset), view.entry_at(offset)
    place: Span | None = None
    if occurrence is not None:
        place = occurrence.span
        parts.insert(0, "\n".join(_of_name(view, occurrence)))
    elif entry is not None and entry.wording.start <= offset <= entry.wording.end:
        requirement = view.formalized(entry)
        if requirement is not None:
            place = entry.wording
            parts.insert(0, "\n".join(_of_sentence(view, requirement)))
    text = "\n\n---\n\n".join(part for part in parts if part)
    if not text:
        return None
    content = lsp.MarkupContent(lsp.MarkupKind.Markdown, text)
    return lsp.Hover(content, view.range_of(place) if place is not None else None)


def _of_diagnostics(view: View, offset: int) -> Iterator[str]:
    """Cause and fix of each diagnostic at the place."""
    codes = [
        each.code.number
        for each in view.open_project.diagnostics(view.session.texts)
        if each.span is not None
        and each.span.start <= offset <= each.span.end
        and view.is_here(each.span)
    ]
    yield from filter(None, map(code_text, dict.fromkeys(codes)))


def code_text(number: str) -> str | None:
    """Cause and fix of a code in Markdown; None if there is no such code."""
    code = _CODES.get(number)
    if code is None:
        return None
    known = explanations.explanation(code)
    return f"**{number}** {code.summary}\n\n{known.cause}\n\nTo fix it: {known.fix}"


def _of_sentence(view: View, requirement: FormalizedRequirement) -> Iterator[str]:
    yield f"**{_plain(requirement.entry.name)}**"
    yield ""
    yield _plain(meaning(requirement.written, requirement.ticks, requirement.clock))
    yield ""
    yield "```"
    yield f"FT  {_formula(printing.readable(requirement.ft_infinite))}"
    yield f"PT  {_formula(printing.readable(requirement.pt))}"
    yield "```"
    yield ""
    yield from markdown.lines(requirement, as_image=view.session.shows_images)


def _formula(text: str) -> str:
    return text if len(text) <= _LONGEST_FORMULA else f"{text[:_LONGEST_FORMULA]}..."


def _of_name(view: View, occurrence: Occurrence) -> Iterator[str]:
    project = view.project
    if occurrence.kind is NameKind.CODE:
        text = code_text(occurrence.name)
        yield from () if text is None else (text,)
        return
    if project is None:
        return
    yield f"**{_code(occurrence.name)}**"
    yield ""
    yield from _declared(project, occurrence)
    yield from _in_last_audit(view, occurrence)
    users = _users(view, occurrence)
    if users:
        names = ", ".join(_plain(id) for id in users[:_MOST_USERS])
        more = f" and {len(users) - _MOST_USERS} more" if len(users) > _MOST_USERS else ""
        yield f"\nused by {names}{more}"


def _declared(project: Project, occurrence: Occurrence) -> Iterator[str]:
    """What the project says of a name; a paragraph for each thing that it stands for."""
    name = occurrence.name
    match occurrence.kind:
        case NameKind.REQUIREMENT:
            for entry in project.requirements:
                if entry.id == name:
                    yield f"requirement: {_plain(entry.title or entry.text)}"
        case NameKind.HAZARD:
            above = project.hazards.get(name) or project.parents.get(name)
            yield f"hazard: {_plain(above.title)}" if above else "not declared"
        case NameKind.COMPONENT:
            yield "component"
        case _:
            yield from _of_variable(project, name)


def _of_variable(project: Project, name: str) -> Iterator[str]:
    declared = project.declarations
    if declared is None:
        yield "not declared: the project has no bindings"
        return
    proposition, signal = declared.propositions.get(name), declared.measured.get(name)
    variable = declared.variables.get(name)
    if proposition is not None:
        role = f", {proposition.role}" if proposition.role else ""
        yield f"proposition{role}: {_code(expression(proposition.expression))}"
        yield from ["", _plain(proposition.text)] if proposition.text else ()
    if signal is not None:
        unit = f" in {_code(signal.unit_name)}" if signal.unit_name else ""
        source = signal.text if isinstance(signal, ComputedSignal) else signal.origin
        yield f"signal{unit}: {_code(source)}"
        if signal.values:
            yield f"\nvalues: {', '.join(map(_code, signal.values))}"
    if variable is not None:
        value = f": {_code(expression(variable.value))}" if variable.value is not None else ""
        role = f", {variable.role}" if variable.role else ""
        yield f"variable{role}{value}"
        yield from ["", _plain(variable.text)] if variable.text else ()
    of_signals = [each.name for each in declared.signals.values() if name in each.values]
    if of_signals:
        yield f"value of {', '.join(map(_code, of_signals))}"
    if not (proposition or signal or variable or of_signals):
        broken = any(part == name for _, part in declared.mistakes)
        yield "its table has an error" if broken else "not declared in the bindings"


def _in_last_audit(view: View, occurrence: Occurrence) -> Iterator[str]:
    """The range of each comparison of a name in the last audit; a paragraph for each."""
    ranges: dict[str, None] = {}
    for status in view.open_project.statuses.values():
        for each in status.ranges:
            signals = re.findall(r"[A-Za-z_][A-Za-z0-9_]*", each.comparison)
            if each.values and occurrence.name in (each.proposition, *signals):
                stale = ", which is stale" if status.reasons else ""
                margin = f", margin {each.margin}" if each.margin else ""
                text = f"{_code(each.comparison)}: {each.values}{margin} in the last audit{stale}"
                ranges[text] = None
    for text in ranges:
        yield f"\n{text}"


def _users(view: View, occurrence: Occurrence) -> list[str]:
    """The ids of the requirements in which the name occurs, but for its own."""
    owners = (each.owner for each in view.occurrences if each.key == occurrence.key)
    own = occurrence.name if occurrence.kind is NameKind.REQUIREMENT else ""
    return [owner for owner in dict.fromkeys(owners) if owner not in ("", own)]


def _code(text: str) -> str:
    """A text as code of Markdown, whatever is in it."""
    fence = "``" if "`" in text else "`"
    return f"{fence}{' '.join(text.split())}{fence}"


_MARKUP = re.compile(r"([\\`*_{}\[\]<>#|~!&])")


def _plain(text: str) -> str:
    """A text without markup, on one line; what is between backquotes stays code."""
    parts = " ".join(text.split()).split("`")
    if len(parts) % 2 == 0:
        return _MARKUP.sub(r"\\\1", "`".join(parts))
    return "`".join(part if at % 2 else _MARKUP.sub(r"\\\1", part) for at, part in enumerate(parts))
