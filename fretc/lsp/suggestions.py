"""Quick fixes that take more than a diagnostic: FRETish for plain English, bindings from a log."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

from lsprotocol import types as lsp

from compiler.project.paths import BINDINGS
from compiler.project.project import Project
from fretc.lsp.view import View
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.fixes import apply_fixes
from fretish.diagnostics.source import Source, Span
from fretish.documents import RequirementEntry
from fretish.parser import find_errors, parse
from fretish.reading.limits import with_budget
from fretish.reading.toml_text import as_key
from fretish.syntax import Sentence

_MOST_READINGS = 6
_MOST_ROUNDS = 5
"""The largest number of times that fixes are applied to a text."""
_SYNTAX = "F1"
"""The beginning of the codes of sentences that are no FRETish."""


# Plain English ------------------------------------------------------------------------------------


def readings(view: View, diagnostic: Diagnostic) -> Iterator[lsp.CodeAction]:
    """The FRETish sentences that the sentence of a diagnostic may mean, as `fretc write` has them.

    A title names the words that its sentence does not contain.
    """
    entry = view.entry_at(diagnostic.span.start) if diagnostic.span is not None else None
    if entry is None or view.project is None or not diagnostic.code.number.startswith(_SYNTAX):
        return
    if not diagnostic.is_error or entry.is_free_text or view.formalized(entry) is not None:
        return
    for text, left_out in _readings(view.project, entry)[:_MOST_READINGS]:
        without = f", without {', '.join(f'`{word}`' for word in left_out)}" if left_out else ""
        edit = lsp.TextEdit(view.positions.of(entry.wording), text)
        yield lsp.CodeAction(
            title=f"write `{text}`{without}",
            kind=lsp.CodeActionKind.QuickFix,
            edit=lsp.WorkspaceEdit(changes={view.uri(view.path): [edit]}),
        )


def _becomes_fretish(wording: Span) -> bool:
    """Whether the fixes of its mistakes make a text FRETish."""
    for _ in range(_MOST_ROUNDS):
        if isinstance(parse(wording), Sentence):
            return True
        fixes = [each.fix for each in find_errors(wording) if each.fix is not None]
        text = apply_fixes(wording, fixes)
        if text == wording.text:
            return False
        wording = Source(wording.source.name, text).span()
    return False


def _readings(project: Project, entry: RequirementEntry) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Sentence and left out words of each reading; none if it takes too long to read."""
    components = tuple(dict.fromkeys(each.sentence.component for each in project.formalized))
    wording = entry.wording
    reading = partial(_of_text, wording.text, project.declarations, components)
    result = with_budget(wording.end - wording.start, wording, reading)
    return () if isinstance(result, Diagnostic) else result


def _of_text(
    text: str, declarations: Declarations | None, components: tuple[str, ...]
) -> tuple[tuple[str, tuple[str, ...]], ...]:
    from fretish.english.readings import demands
    from fretish.english.readings import readings as english
    from fretish.english.vocabulary import vocabulary

    sentence = " ".join(text.split())
    if _becomes_fretish(Source("<text>", sentence).span()):
        return ()  # its fixes are offered
    if len(demands(sentence)) != 1:
        return ()  # several requirements, which `fretc write` separates
    return tuple(
        (each.text, each.left_out)
        for each in english(sentence, vocabulary(declarations, components))
    )


# Bindings from a log ------------------------------------------------------------------------------


def drafts(view: View, diagnostic: Diagnostic) -> Iterator[lsp.CodeAction]:
    """An action that drafts the bindings of the names at a diagnostic from the latest audited log.

    Its edit is computed by `resolve`, when the user has chosen it, because it reads the log.
    """
    log = view.open_project.latest_log
    if diagnostic.span is None or not log or not view.session.resolves_actions:
        return
    names = _missing(view, diagnostic.span)
    if names:
        what = ", ".join(f"`{name}`" for name in names)
        yield lsp.CodeAction(
            title=f"add {what} to {BINDINGS}, drafted from {log} ({diagnostic.code.number})",
            kind=lsp.CodeActionKind.QuickFix,
            data={"uri": view.uri(view.path), "log": log, "names": names},
        )


def _missing(view: View, span: Span) -> list[str]:
    """The names within a span that the bindings lack."""
    from fretc.audit.bindings.needs import missing_propositions, missing_signals

    if view.project is None:
        return []
    lacking = {each.name for each in missing_propositions(view.project)}
    lacking |= {each.name for each in missing_signals(view.project)}
    names = [
        each.name
        for each in view.occurrences
        if view.is_here(each.span) and span.start <= each.span.start <= each.span.end <= span.end
    ]
    return [name for name in dict.fromkeys(names) if name in lacking]


def drafted(view: View, data: Mapping[str, Any]) -> lsp.WorkspaceEdit | Diagnostic | None:
    """The edit of an action of `drafts`; a diagnostic if the log cannot be read.

    Args:
        view: the file of the action.
        data: the data of the action. Only the latest audited log is read, whatever it names.
    """
    from fretc.audit.bindings.draft import addition
    from fretc.audit.bindings.needs import missing_propositions, missing_signals
    from fretc.logs.reader import look
    from fretc.logs.storage.log_names import path_of

    log, names = data.get("log"), data.get("names")
    path = os.path.join(view.open_project.folder, BINDINGS)
    if view.project is None or log != view.open_project.latest_log or not isinstance(names, list):
        return None
    with view.open_project.around(view.session.texts):
        overview = look(path_of(log), words=True)
    if isinstance(overview, Diagnostic):
        return overview
    propositions = [each for each in missing_propositions(view.project) if each.name in names]
    signals = [each for each in missing_signals(view.project) if each.name in names]
    return appended(view, path, addition(overview, propositions, signals).strip("\n") + "\n")


# Files --------------------------------------------------------------------------------------------


def appended(view: View, path: str, table: str) -> lsp.WorkspaceEdit | None:
    """The edit that puts a table at the end of a file; None if the file cannot be read."""
    text = view.session.text(path)
    if text is None:
        return None
    gap = "" if not text or text.endswith("\n\n") else "\n" if text.endswith("\n") else "\n\n"
    end = View(path, view.open_project, view.session, view.encoding, view.uri).positions
    edit = lsp.TextEdit(end.range(len(text), len(text)), f"{gap}{table}")
    return lsp.WorkspaceEdit(changes={view.uri(path): [edit]})


def empty_table(name: str) -> str:
    """The table of a proposition whose expression is left to the author."""
    return f'[proposition.{as_key(name)}]\nexpr = "TODO"\nrole = "input"\n'
