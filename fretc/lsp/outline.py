"""The parts of a file: symbols, folding, colours of words, and hints between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from lsprotocol import types as lsp

from compiler.formalization.formalized import FormalizedRequirement
from fretc.lsp.names import NameKind, of_sentence
from fretc.lsp.view import View, start_of
from fretish.diagnostics.source import Span
from fretish.documents import RequirementEntry
from fretish.parser import words
from fretish.reading.lalr import Token

_SYMBOLS = {
    NameKind.VARIABLE: lsp.SymbolKind.Variable,
    NameKind.HAZARD: lsp.SymbolKind.Event,
    NameKind.REQUIREMENT: lsp.SymbolKind.Class,
    NameKind.COMPONENT: lsp.SymbolKind.Module,
    NameKind.CODE: lsp.SymbolKind.Constant,
}


# Symbols ------------------------------------------------------------------------------------------


def document_symbols(view: View) -> list[lsp.DocumentSymbol]:
    """The requirements of a `.fret` file; the names that a TOML file declares."""
    if view.is_requirements:
        return [_requirement(view, entry) for entry in view.entries()]
    return [
        lsp.DocumentSymbol(
            name=each.name,
            kind=_SYMBOLS[each.kind],
            range=view.range_of(each.span),
            selection_range=view.range_of(each.span),
        )
        for each in view.occurrences
        if each.is_declaration and not each.owner and view.is_here(each.span)
    ]


def _requirement(view: View, entry: RequirementEntry) -> lsp.DocumentSymbol:
    start = start_of(entry)
    return lsp.DocumentSymbol(
        name=entry.id or "requirement",
        detail=entry.title,
        kind=lsp.SymbolKind.Class,
        tags=[lsp.SymbolTag.Deprecated] if entry.status == "retired" else None,
        range=view.positions.range(start, max(start, entry.wording.end)),
        selection_range=view.positions.of(entry.wording),
    )


def workspace_symbols(views: Sequence[View], query: str) -> list[lsp.WorkspaceSymbol]:
    """The requirements and declared names of projects whose name or title has the query."""
    symbols = []
    for view in views:
        entries = view.project.requirements if view.project else ()
        titles = {entry.id: entry.title for entry in entries}
        for each in view.occurrences:
            title = titles.get(each.name, "") if each.kind is NameKind.REQUIREMENT else ""
            if not each.is_declaration or each.kind is NameKind.COMPONENT:
                continue
            if query.casefold() in f"{each.name} {title}".casefold():
                kind, place = _SYMBOLS[each.kind], view.location(each.span)
                symbols.append(lsp.WorkspaceSymbol(place, each.name, kind, container_name=title))
    return symbols


def folding(view: View) -> list[lsp.FoldingRange]:
    """A range for each requirement of several lines."""
    ranges = []
    for entry in view.entries():
        first = view.positions.position(start_of(entry)).line
        last = view.positions.position(entry.wording.end).line
        if last > first:
            ranges.append(lsp.FoldingRange(max(0, first - 1) if entry.header else first, last))
    return ranges


# Colours ------------------------------------------------------------------------------------------

TOKEN_TYPES = ("keyword", "variable", "class", "number", "operator", "function", "enumMember")
_NUMBERS = {"NUMBER", "QUANTITY"}
_OPERATORS = frozenset(
    "_AMPERSAND _BAR _BANG _IMPLIES _IFF LESS AT_MOST GREATER AT_LEAST EQUAL UNEQUAL PLUS MINUS "
    "STAR SLASH HAT".split()
)


def semantic_tokens(view: View) -> lsp.SemanticTokens:
    """The kind of each word of the sentences: numbers as the protocol encodes them."""
    data: list[int] = []
    line = character = 0
    for start, end, kind in _coloured(view):
        first, last = view.positions.position(start), view.positions.position(end)
        if first.line != last.line:
            continue  # a number whose unit is on the next line
        same = first.line == line
        data += [
            first.line - line,
            first.character - character if same else first.character,
            last.character - first.character,
            TOKEN_TYPES.index(kind),
            0,
        ]
        line, character = first.line, first.character
    return lsp.SemanticTokens(data)


def _coloured(view: View) -> Iterator[tuple[int, int, str]]:
    """Start, end and kind of each word."""
    for entry in view.entries():
        if entry.is_free_text:
            continue
        components = {
            each.span.start
            for each in of_sentence(entry.wording)
            if each.kind is NameKind.COMPONENT
        }
        tokens = words(entry.wording.text)
        for at, token in enumerate(tokens):
            start = entry.wording.start + token.start_pos
            kind = _kind(tokens, at)
            if token.type in ("ID", "QUOTED") and components & {start, start + 1}:
                kind = "class"
            if kind:
                yield start, entry.wording.start + token.end_pos, kind


def _kind(tokens: Sequence[Token], at: int) -> str:
    token = tokens[at]
    if token.type in ("ID", "QUOTED"):
        return "function" if at + 1 < len(tokens) and tokens[at + 1] == "(" else "variable"
    if token.type in _NUMBERS:
        return "number"
    if token.type in _OPERATORS:
        return "operator"
    return "keyword" if token.isalpha() else ""


# Hints --------------------------------------------------------------------------------------------


def inlay_hints(view: View, wanted: lsp.Range) -> list[lsp.InlayHint]:
    """The number of ticks behind each duration in seconds."""
    first, last = view.positions.offset(wanted.start), view.positions.offset(wanted.end)
    hints = []
    for entry in view.entries():
        requirement = view.formalized(entry)
        place = _of_duration(requirement) if requirement is not None else None
        if requirement is None or place is None or not first <= place.end <= last:
            continue
        ticks = requirement.ticks
        text = f"= {ticks} tick{'' if ticks == 1 else 's'}"
        hints.append(lsp.InlayHint(view.positions.position(place.end), text, padding_left=True))
    return hints


def _of_duration(requirement: FormalizedRequirement) -> Span | None:
    """The span of the timing if it has a duration that is not in ticks."""
    place = requirement.sentence.timing_span
    if requirement.ticks is None or place is None or requirement.clock is None:
        return None
    return None if place.text.split()[-1].lower().startswith("tick") else place
