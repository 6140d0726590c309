"""What can be written at a place: words by the grammar of FRETish, names, keys and values."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from lsprotocol import types as lsp

from compiler.project.paths import BINDINGS
from compiler.project.project import Project
from fretc.lsp.names import NameKind
from fretc.lsp.session import WAIVERS
from fretc.lsp.toml_keys import FIELDS_OF_FILES, VALUES, header_fields
from fretc.lsp.view import View
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.explanations import explanation
from fretish.documents import part_at
from fretish.parser import continuations, words
from fretish.printer import identifier
from fretish.reading.toml_text import as_key

_WORD = re.compile(r'"[^"\n]*\Z|[A-Za-z][A-Za-z0-9_.%]*\Z')
"""The word that is being written at the end of a text."""
_SPELLINGS = {
    "IS_TRUE": "true",
    "IS_FALSE": "false",
    "TICK": "ticks",
    "MICROSECOND": "microseconds",
    "MILLISECOND": "milliseconds",
    "SECOND": "seconds",
    "MINUTE": "minutes",
    "HOUR": "hours",
}
"""Terminal of the grammar → a word of it; the others are spelt as they are named."""
_NO_WORDS = frozenset(
    "ID QUOTED QUANTITY NUMBER WHAT LESS AT_MOST GREATER AT_LEAST EQUAL UNEQUAL PLUS MINUS STAR "
    "SLASH HAT LPAR RPAR".split()
)
"""Terminals that are no words."""
_PATTERNS = {
    "whenever ... shall within ...": (
        "whenever ${1:condition} the ${2:component} shall within ${3:2} ${4:seconds} satisfy "
        "${5:response}"
    ),
    "the ... shall always ...": "the ${1:component} shall always satisfy ${2:response}",
    "the ... shall never ...": "the ${1:component} shall never satisfy ${2:response}",
    "upon ... shall immediately ...": (
        "upon ${1:condition} the ${2:component} shall immediately satisfy ${3:response}"
    ),
    "in ... mode ... shall always ...": (
        "in ${1:mode} mode the ${2:component} shall always satisfy ${3:response}"
    ),
    "... shall for ...": (
        "upon ${1:condition} the ${2:component} shall for ${3:2} ${4:seconds} satisfy ${5:response}"
    ),
    "... shall until ...": (
        "upon ${1:condition} the ${2:component} shall until ${3:end} satisfy ${4:response}"
    ),
}
"""Common patterns of sentences."""


def completion(view: View, offset: int) -> lsp.CompletionList:
    """The items for the place; those of FRETish in the order of their text."""
    start, is_header = part_at(view.text, offset) if view.is_requirements else (0, False)
    before = view.text[start:offset]
    if view.is_requirements and not is_header:
        items = [*_of_sentence(view, before, offset)]
    else:
        items = [*_of_toml(view, before, offset, is_header=is_header)]
    return lsp.CompletionList(is_incomplete=False, items=items)


# Sentences ----------------------------------------------------------------------------------------


def _of_sentence(view: View, before: str, offset: int) -> Iterator[lsp.CompletionItem]:
    match = _WORD.search(before)
    beginning = before[: match.start()] if match else before
    place = view.positions.range(offset - len(before) + len(beginning), offset)
    values = _values_of_comparison(view.project, beginning)
    if values:
        yield from (_item(identifier(v), lsp.CompletionItemKind.EnumMember, place) for v in values)
        return
    accepted = continuations(beginning)
    for terminal in sorted(accepted - _NO_WORDS):
        if not terminal.startswith("_") and terminal != "$END":
            word = _SPELLINGS.get(terminal, terminal.lower())
            yield _item(word, lsp.CompletionItemKind.Keyword, place)
    if "ID" in accepted:
        yield from _names(view, beginning, place)
    if not beginning.strip():
        for name, text in _PATTERNS.items():
            yield lsp.CompletionItem(
                label=name,
                kind=lsp.CompletionItemKind.Snippet,
                insert_text_format=lsp.InsertTextFormat.Snippet,
                text_edit=lsp.TextEdit(place, text),
                sort_text=f"~{name}",
            )


def _names(view: View, beginning: str, place: lsp.Range) -> Iterator[lsp.CompletionItem]:
    """The names that can stand behind the beginning of a sentence."""
    project = view.project
    if project is None:
        return
    after = continuations(f"{beginning} name")
    if "SHALL" in after:
        yield from _of_kind(view, NameKind.COMPONENT, lsp.CompletionItemKind.Class, place)
        if after == {"SHALL"}:
            return
    described = _descriptions(project)
    used = (each.name for each in view.occurrences if each.kind is NameKind.VARIABLE)
    for name in dict.fromkeys((*described, *sorted(set(used)))):
        detail = described.get(name, "not declared")
        yield _item(identifier(name), lsp.CompletionItemKind.Variable, place, detail)


def _of_kind(
    view: View, kind: NameKind, icon: lsp.CompletionItemKind, place: lsp.Range
) -> Iterator[lsp.CompletionItem]:
    for name in sorted({each.name for each in view.occurrences if each.kind is kind}):
        yield _item(identifier(name), icon, place)


def _values_of_comparison(project: Project | None, beginning: str) -> Sequence[str]:
    """The values of the signal that the sentence compares at its end; empty: it does not."""
    tokens = words(beginning)
    declared = project.declarations if project is not None else None
    if declared is None or len(tokens) < 2 or tokens[-1] not in ("=", "!="):
        return ()
    signal = declared.signals.get(tokens[-2].strip('"'))
    return signal.values if signal is not None else ()


def _descriptions(project: Project) -> Mapping[str, str]:
    """Declared name → what it is, in a few words."""
    declared = project.declarations
    if declared is None:
        return {}
    signals = {
        name: f"signal [{'words' if signal.values else signal.unit_name or '1'}]"
        for name, signal in declared.measured.items()
    }
    propositions = {
        name: f"{proposition.role or 'proposition'}: {proposition.text}".rstrip(": ")
        for name, proposition in declared.propositions.items()
        if not _is_comparison(name)
    }
    variables = {
        name: f"{variable.role or 'variable'}: {variable.text}".rstrip(": ")
        for name, variable in declared.variables.items()
    }
    return {**signals, **variables, **propositions}


def _is_comparison(name: str) -> bool:
    """Whether the name is that of a comparison in a sentence, which nobody writes as a name."""
    return any(character in name for character in "<>=!&|()")


# TOML ---------------------------------------------------------------------------------------------

_TABLE = re.compile(r"^[ \t]*\[\[?[ \t]*([^\]\n]*?)[ \t]*\]", re.MULTILINE)
_NAMED_TABLE = re.compile(r"^[ \t]*\[\[?[ \t]*([A-Za-z._]*)\Z")
_KEY = re.compile(r"^[ \t]*([A-Za-z_]*)\Z")
_VALUE = re.compile(r'^[ \t]*([A-Za-z_]+)[ \t]*=[ \t]*(?:\[[^\]]*)?"([^"\n]*)\Z')
_IN_TABLE = re.compile(r"^[ \t]*([A-Za-z_]+)[ \t]*=[ \t]*\{(?:[^}]*,)?[ \t]*([A-Za-z0-9_]*)\Z")


_PLACES = {"table": _NAMED_TABLE, "key": _KEY, "value": _VALUE, "inner": _IN_TABLE}
"""What is being written → a line up to there, whose last group is the part that is written yet."""


def _of_toml(
    view: View, before: str, offset: int, *, is_header: bool
) -> Iterator[lsp.CompletionItem]:
    """Keys and values of TOML.

    Args:
        view: the file.
        before: the TOML before the place.
        offset: the place.
        is_header: whether it is the header of a requirement, or else a whole file.
    """
    line = before[before.rfind("\n") + 1 :]
    tables = _TABLE.findall(before[: len(before) - len(line)])
    table = tables[-1] if tables else ""
    fields = header_fields() if is_header else FIELDS_OF_FILES.get(view.name, {})
    for kind, pattern in _PLACES.items():
        match = pattern.search(line)
        if match is None:
            continue
        word = match[match.lastindex or 0]
        place = view.positions.range(offset - len(word), offset)
        names = _candidates(view, fields, table, kind, match, is_header=is_header)
        icon = lsp.CompletionItemKind.Value if kind == "value" else lsp.CompletionItemKind.Property
        yield from (_item(name, icon, place) for name in names)
        return


def _candidates(
    view: View,
    fields: Mapping[str, Sequence[str]],
    table: str,
    kind: str,
    match: re.Match[str],
    *,
    is_header: bool,
) -> Iterable[str]:
    root = table.split(".")[0]
    if kind == "table":
        return [name for name in fields if name] if view.name == BINDINGS else ()
    if kind == "key":
        of_any = fields.get("*" if table else "", ())
        return fields.get(table, fields.get(f"{root}.", of_any))
    if kind == "value":
        return _values(view, "header" if is_header else root, match[1])
    return _inner_keys(view, match[1]) if is_header else ()


def _values(view: View, table: str, key: str) -> Iterable[str]:
    if table == "header" and key == "parents":
        kinds = (NameKind.HAZARD, NameKind.REQUIREMENT)
        return sorted({e.name for e in view.occurrences if e.kind in kinds and e.is_declaration})
    return VALUES.get((WAIVERS if view.name == WAIVERS else table, key), ())


def _inner_keys(view: View, key: str) -> Iterable[str]:
    """The keys of an inline table of a header."""
    if key == "accept":
        return [c.number for c in Code if explanation(c).accept == "requirement"]
    if key == "params" and view.project is not None and view.project.declarations is not None:
        return [as_key(name) for name in view.project.declarations.propositions]
    return ()


def _item(
    text: str, kind: lsp.CompletionItemKind, place: lsp.Range, detail: str | None = None
) -> lsp.CompletionItem:
    return lsp.CompletionItem(
        label=text, kind=kind, detail=detail, text_edit=lsp.TextEdit(place, text)
    )
