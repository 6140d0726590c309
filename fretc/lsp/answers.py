"""The answers to requests: each finds its file, and asks the module that knows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from lsprotocol import types as lsp

from fretc.lsp import actions, completion, hover, lenses, outline, renaming, suggestions
from fretc.lsp.view import View
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.fixes import Fix

FindView = Callable[[str], View | None]
"""Function from a URI to the view of its file; None if it is of no project."""
Answer = Callable[[FindView, Any], Any]


class RefusalError(Exception):
    """A request that is refused, with the reason for the user."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(f"{diagnostic.code.number} {diagnostic.message}")


def _at(answer: Callable[[View, int], Any]) -> Answer:
    """The answer to a request about a position."""

    def answered(find: FindView, params: Any) -> Any:
        view = find(params.text_document.uri)
        return None if view is None else answer(view, view.positions.offset(params.position))

    return answered


def _of_file(answer: Callable[[View], Any]) -> Answer:
    """The answer to a request about a whole file."""

    def answered(find: FindView, params: Any) -> Any:
        view = find(params.text_document.uri)
        return None if view is None else answer(view)

    return answered


def _references(find: FindView, params: lsp.ReferenceParams) -> Any:
    with_declaration = params.context.include_declaration
    return _at(lambda view, at: renaming.references(view, at, with_declaration=with_declaration))(
        find, params
    )


def _rename(find: FindView, params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
    view = find(params.text_document.uri)
    if view is None:
        return None
    files = renaming.rename(view, view.positions.offset(params.position), params.new_name)
    if isinstance(files, Diagnostic):
        raise RefusalError(files)
    return lsp.WorkspaceEdit(
        changes={view.uri(path): _edits(view, fixes) for path, fixes in files.items()}
    )


def _edits(view: View, fixes: Sequence[Fix]) -> list[lsp.TextEdit]:
    return [lsp.TextEdit(view.range_of(fix.span), fix.text) for fix in fixes]


def _code_actions(find: FindView, params: lsp.CodeActionParams) -> Any:
    return _of_file(lambda view: actions.code_actions(view, params.range, params.context.only))(
        find, params
    )


def _resolved(find: FindView, action: lsp.CodeAction) -> lsp.CodeAction:
    """The action with its edit."""
    data = action.data if isinstance(action.data, Mapping) else {}
    uri = data.get("uri")
    view = find(uri) if isinstance(uri, str) else None
    if view is None or action.edit is not None:
        return action
    edit = suggestions.drafted(view, data)
    if isinstance(edit, Diagnostic):
        raise RefusalError(edit)
    action.edit = edit
    return action


def _hints(find: FindView, params: lsp.InlayHintParams) -> Any:
    return _of_file(lambda view: outline.inlay_hints(view, params.range))(find, params)


ANSWERS: Mapping[str, tuple[Answer, Any]] = {
    lsp.TEXT_DOCUMENT_HOVER: (_at(hover.hover), None),
    lsp.TEXT_DOCUMENT_COMPLETION: (
        _at(completion.completion),
        lsp.CompletionOptions(trigger_characters=[" ", '"', "[", "&", "|", "("]),
    ),
    lsp.TEXT_DOCUMENT_DEFINITION: (_at(renaming.declarations), None),
    lsp.TEXT_DOCUMENT_REFERENCES: (_references, None),
    lsp.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT: (_at(renaming.highlights), None),
    lsp.TEXT_DOCUMENT_PREPARE_RENAME: (_at(renaming.renamed_range), None),
    lsp.TEXT_DOCUMENT_RENAME: (_rename, lsp.RenameOptions(prepare_provider=True)),
    lsp.TEXT_DOCUMENT_FORMATTING: (_of_file(actions.formatting), None),
    lsp.TEXT_DOCUMENT_CODE_ACTION: (
        _code_actions,
        lsp.CodeActionOptions(
            [lsp.CodeActionKind.QuickFix, actions.FIX_ALL], resolve_provider=True
        ),
    ),
    lsp.CODE_ACTION_RESOLVE: (_resolved, None),
    lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL: (_of_file(outline.document_symbols), None),
    lsp.TEXT_DOCUMENT_FOLDING_RANGE: (_of_file(outline.folding), None),
    lsp.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL: (
        _of_file(outline.semantic_tokens),
        lsp.SemanticTokensLegend(list(outline.TOKEN_TYPES), []),
    ),
    lsp.TEXT_DOCUMENT_INLAY_HINT: (_hints, None),
    lsp.TEXT_DOCUMENT_CODE_LENS: (_of_file(lenses.lenses), lsp.CodeLensOptions()),
}
"""Method → its answer, and the options of the server."""
