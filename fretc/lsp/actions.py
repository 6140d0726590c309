"""Formatting and quick fixes: what `fretc fmt` and `fretc check --fix` would change."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence

from lsprotocol import types as lsp

from compiler.files.text_files import unsaved_texts
from compiler.project.fixes import fixed_files
from compiler.project.formatting import formatted_files
from compiler.project.paths import BINDINGS
from fretc.lsp import suggestions
from fretc.lsp.session import with_real_paths
from fretc.lsp.view import View, start_of
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.explanations import explanation
from fretish.diagnostics.fixes import Fix
from fretish.documents import RequirementEntry
from fretish.reading.toml_text import as_key

FIX_ALL = "source.fixAll.fretc"


def formatting(view: View) -> list[lsp.TextEdit]:
    """The edits by which every sentence gets its canonical wording; one with a mistake stays."""
    if not view.is_requirements:
        return []
    with unsaved_texts(with_real_paths(view.session.texts)):
        files, _ = formatted_files([view.path])
    return [*_whole(view, files[0].after)] if files else []


def _whole(view: View, after: str) -> Iterator[lsp.TextEdit]:
    """The edit from the present text to another one; none if they are equal."""
    before = view.text
    if before == after:
        return
    most = min(len(before), len(after))
    start = next((i for i in range(most) if before[i] != after[i]), most)
    same = next((i for i in range(most - start) if before[-1 - i] != after[-1 - i]), most - start)
    # An edit never begins or ends between the two characters of a line end.
    start -= before[start - 1 : start] == "\r"
    same -= before[len(before) - same - 1 : len(before) - same] == "\r" and same > 0
    yield lsp.TextEdit(
        view.positions.range(start, len(before) - same), after[start : len(after) - same]
    )


def code_actions(view: View, wanted: lsp.Range, only: Sequence[str] | None) -> list[lsp.CodeAction]:
    """The fixes of the diagnostics in a range, and the one that applies all safe fixes."""
    kinds = [*only] if only is not None else ["quickfix", FIX_ALL]
    actions: list[lsp.CodeAction] = []
    if any(_is_kind("quickfix", kind) for kind in kinds):
        actions.extend(_quick_fixes(view, wanted))
    if any(_is_kind(FIX_ALL, kind) for kind in kinds):
        actions.extend(_fix_all(view))
    return actions


def _is_kind(kind: str, wanted: str) -> bool:
    return kind == wanted or kind.startswith(f"{wanted}.")


def _quick_fixes(view: View, wanted: lsp.Range) -> Iterator[lsp.CodeAction]:
    start, end = view.positions.offset(wanted.start), view.positions.offset(wanted.end)
    written: set[RequirementEntry | None] = set()
    for diagnostic in view.open_project.diagnostics(view.session.texts):
        span = diagnostic.span
        if span is None or not view.is_here(span) or span.start > end or span.end < start:
            continue
        if diagnostic.fix is not None:
            yield _fix(view, diagnostic, diagnostic.fix)
        if diagnostic.code is Code.UNBOUND:
            yield from suggestions.drafts(view, diagnostic)
            yield from _binding(view, diagnostic)
        entry = view.entry_at(span.start)
        if entry not in written and (actions := [*suggestions.readings(view, diagnostic)]):
            written.add(entry)
            yield from actions
        if diagnostic.is_open and explanation(diagnostic.code).accept == "requirement":
            yield from _acceptance(view, diagnostic)


def _fix(view: View, diagnostic: Diagnostic, fix: Fix) -> lsp.CodeAction:
    text = " ".join(fix.text.split())
    title = f"write `{text}`" if text else f"remove `{' '.join(fix.span.text.split())}`"
    edits = {view.uri(view.path): [lsp.TextEdit(view.positions.of(fix.span), fix.text)]}
    return _action(title, diagnostic, edits, is_preferred=fix.is_safe)


def _binding(view: View, diagnostic: Diagnostic) -> Iterator[lsp.CodeAction]:
    """Add the table of an unbound proposition, whose expression is left to the author."""
    assert diagnostic.span is not None
    occurrence = view.occurrence_at(diagnostic.span.start)
    if occurrence is None or occurrence.span.text != diagnostic.span.text.strip('"'):
        return  # a comparison: which of its signals are missing is in the help
    path = os.path.join(view.open_project.folder, BINDINGS)
    edit = suggestions.appended(view, path, suggestions.empty_table(occurrence.name))
    if edit is not None and edit.changes is not None:
        title = f"add `[proposition.{as_key(occurrence.name)}]` to {BINDINGS}"
        yield _action(title, diagnostic, edit.changes)


def _acceptance(view: View, diagnostic: Diagnostic) -> Iterator[lsp.CodeAction]:
    """Accept a warning in the header of its requirement; the author writes the reason."""
    assert diagnostic.span is not None
    entry = view.entry_at(diagnostic.span.start)
    if entry is None or entry.header is None or "accept" in entry.header.data:
        return
    at = _end_of_fields(entry)
    line = f'accept = {{ {diagnostic.code.number} = "TODO" }}\n'
    title = f"accept {diagnostic.code.number} with a reason"
    place = view.positions.range(at, at)
    yield _action(title, diagnostic, {view.uri(view.path): [lsp.TextEdit(place, line)]})


def _end_of_fields(entry: RequirementEntry) -> int:
    """The offset before the first table of a header, or before its end."""
    assert entry.header is not None
    text, start = entry.header.text.text, start_of(entry)
    at = 0
    for line in text.splitlines(keepends=True):
        if line.lstrip().startswith("["):
            break
        at += len(line)
    return start + at


def _fix_all(view: View) -> Iterator[lsp.CodeAction]:
    if not view.is_requirements:
        return
    with unsaved_texts(with_real_paths(view.session.texts)):
        files = fixed_files([view.path])
    for file in files:
        edits = [*_whole(view, file.text)]
        yield lsp.CodeAction(
            title="apply all safe fixes",
            kind=FIX_ALL,
            edit=lsp.WorkspaceEdit(changes={view.uri(view.path): edits}),
        )


def _action(
    title: str,
    diagnostic: Diagnostic,
    edits: Mapping[str, Sequence[lsp.TextEdit]],
    *,
    is_preferred: bool = False,
) -> lsp.CodeAction:
    return lsp.CodeAction(
        title=f"{title} ({diagnostic.code.number})",
        kind=lsp.CodeActionKind.QuickFix,
        is_preferred=is_preferred,
        edit=lsp.WorkspaceEdit(changes=dict(edits)),
    )
