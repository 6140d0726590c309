"""Where a name is declared and used, and its renaming in all files of a project."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence

from lsprotocol import types as lsp

from compiler.files.text_files import unsaved_texts
from compiler.project.folder import load_folder
from compiler.project.project import Project
from fretc.checking.diagnostics import quick_diagnostics
from fretc.lsp.names import NameKind, Notation, Occurrence
from fretc.lsp.session import with_real_paths
from fretc.lsp.view import View
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.fixes import Fix, apply_fixes
from fretish.diagnostics.messages import diagnostic
from fretish.documents import IDENTIFIER
from fretish.printer import identifier
from fretish.reading.toml_text import as_key

_EXPRESSION_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_WORDS = frozenset({"and", "or", "not", "for", "mod", "true", "false"})
"""The reserved words of expressions in bindings."""


def declarations(view: View, offset: int) -> list[lsp.Location]:
    """Where the name at an offset is declared; for a component: nowhere but in sentences."""
    return [view.location(each.span) for each in _same(view, offset) if each.is_declaration]


def references(view: View, offset: int, *, with_declaration: bool = True) -> list[lsp.Location]:
    """Where the name at an offset occurs."""
    every = _same(view, offset)
    return [view.location(e.span) for e in every if with_declaration or not e.is_declaration]


def highlights(view: View, offset: int) -> list[lsp.DocumentHighlight]:
    """The places in the same file at which the name at an offset occurs."""
    return [
        lsp.DocumentHighlight(view.range_of(each.span))
        for each in _same(view, offset)
        if view.is_here(each.span)
    ]


def renamed_range(view: View, offset: int) -> lsp.Range | None:
    """The range of the name that `rename` would change; None if there is none."""
    occurrence = view.occurrence_at(offset)
    if occurrence is None or occurrence.kind is NameKind.CODE:
        return None
    return view.range_of(occurrence.span)


def _same(view: View, offset: int) -> list[Occurrence]:
    """All occurrences of the name at an offset."""
    occurrence = view.occurrence_at(offset)
    if occurrence is None:
        return []
    return [each for each in view.occurrences if each.key == occurrence.key]


def rename(view: View, offset: int, new: str) -> dict[str, list[Fix]] | Diagnostic:
    """The changes by which a name becomes another one, by path.

    Returns:
        The changes of each file, in order; or F966: the name would clash, or a file with a mistake
        may hide a place at which it is used.
    """
    occurrence = view.occurrence_at(offset)
    if occurrence is None or view.project is None:
        return diagnostic("nothing_to_rename")
    reason = _refusal(view, view.project, occurrence, new)
    if reason:
        return diagnostic("not_renamed", name=occurrence.name, new=new, reason=reason)
    if new == occurrence.name:
        return {}
    files: dict[str, list[Fix]] = {}
    for each in sorted(_same(view, offset), key=lambda each: each.span.start):
        path = view.open_project.path(each.span.source)
        files.setdefault(path, []).append(_replacement(each, new))
    hidden = [path for path in files if view.session.text(path) is None]
    reason = "it is used in a text with escapes" if hidden else _consequence(view, files)
    if reason:
        return diagnostic("not_renamed", name=occurrence.name, new=new, reason=reason)
    return files


def _refusal(view: View, project: Project, occurrence: Occurrence, new: str) -> str:
    """Why a name cannot be renamed; "": it can."""
    broken = [each for each in project.diagnostics if each.code in _HIDING]
    if occurrence.kind is NameKind.CODE:
        return "the code of a warning is permanent"
    if broken:
        span = broken[0].span
        where = f" at {span.source.name}:{span.line}" if span else ""
        return f"first fix {broken[0].code.number}{where}, which may hide other uses"
    if new != occurrence.name and any(
        each.name == new and _is_in_one_space(each.kind, occurrence.kind)
        for each in view.occurrences
    ):
        return f"`{new}` is already in use"
    if _has_words(project, occurrence.name) or _has_words(project, new):
        return "the values of a signal have no place of their own that could be renamed"
    if occurrence.kind is NameKind.COMPONENT and _has_own_variables(project, occurrence.name):
        return "variables are declared for the component: rename it in the bindings, too"
    return _misspelling(view, occurrence, new)


_HIDING = frozenset(
    {
        Code.BAD_HEADER,
        Code.UNCLOSED_HEADER,
        Code.BAD_BINDINGS,
        Code.BAD_HAZARDS,
        Code.BAD_WAIVER,
        Code.BAD_SETTINGS,
        Code.NO_SUCH_FILE,
        Code.UNREADABLE,
        Code.NOT_TEXT,
    }
)
"""Mistakes because of which a file is not read to its end."""


def _is_in_one_space(one: NameKind, other: NameKind) -> bool:
    """Whether two kinds of name may not be equal."""
    above = (NameKind.REQUIREMENT, NameKind.HAZARD)
    return one is other or (one in above and other in above)


def _has_words(project: Project, name: str) -> bool:
    declared = project.declarations
    return declared is not None and any(name in each.values for each in declared.signals.values())


def _has_own_variables(project: Project, component: str) -> bool:
    declared = project.declarations
    return declared is not None and any(component in v.of for v in declared.variables.values())


def _misspelling(view: View, occurrence: Occurrence, new: str) -> str:
    """Why a text cannot be a name of this kind; "": it can."""
    if occurrence.kind is NameKind.REQUIREMENT:
        return "" if IDENTIFIER.fullmatch(new) else "an id has letters, digits, `_`, `-` and `.`"
    if new == "FTP":
        return "it is the name of the first tick"
    if not new or not new.isprintable() or set(new) & set("\"'\\"):
        return "a name is printable, and without quotes and backslashes"
    used = {each.notation for each in view.occurrences if each.key == occurrence.key}
    plain = _EXPRESSION_NAME.fullmatch(new) is not None and new not in _WORDS
    if Notation.EXPRESSION in used and not plain:
        return "the expressions of the bindings take letters, digits and `_`"
    return ""


def _replacement(occurrence: Occurrence, new: str) -> Fix:
    """The change of one occurrence; quotes around it are kept, added or removed as needed."""
    span, source = occurrence.span, occurrence.span.source
    if occurrence.notation in (Notation.TEXT, Notation.EXPRESSION):
        return Fix(span, new)
    is_key = occurrence.notation is Notation.KEY
    quotes = source.text[max(0, span.start - 1) : span.start], source.text[span.end : span.end + 1]
    if occurrence.notation is Notation.QUOTED or (is_key and quotes in _QUOTES):
        span = source.span(span.start - 1, span.end + 1)
    return Fix(span, as_key(new) if is_key else identifier(new))


_QUOTES = (('"', '"'), ("'", "'"))


def _consequence(view: View, files: Mapping[str, Sequence[Fix]]) -> str:
    """Which mistake the changed project would have that it has not now; "": none."""
    texts = dict(view.session.texts)
    for path, fixes in files.items():
        source = fixes[0].span.source
        texts[path] = apply_fixes(source.span(), fixes)
    before = view.open_project.reading(view.session.texts).diagnostics
    with view.open_project.around({}), unsaved_texts(with_real_paths(texts)):
        project = load_folder(view.open_project.name)
        after = (project,) if isinstance(project, Diagnostic) else quick_diagnostics(project)
    more = Counter(each.code for each in after) - Counter(each.code for each in before)
    return f"it would cause {', '.join(sorted(code.number for code in more))}" if more else ""
