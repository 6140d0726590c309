"""Code lenses: a line above each requirement with its last results, and commands about it."""

from __future__ import annotations

from collections.abc import Iterator

from lsprotocol import types as lsp

from fretc.checking.statuses import RequirementStatus
from fretc.lsp.commands import AUDIT, EXPLAIN, PLAY, TEST, VERIFY
from fretc.lsp.view import View, start_of
from fretish.documents import RequirementEntry

UNKNOWN = "results are being compared"
"""The title of the first lens until the results are compared with the present project."""


def lenses(view: View) -> list[lsp.CodeLens]:
    """The lenses of each requirement of a file."""
    return [lens for entry in view.entries() for lens in _of_requirement(view, entry)]


def _of_requirement(view: View, entry: RequirementEntry) -> Iterator[lsp.CodeLens]:
    line = view.positions.position(start_of(entry)).line
    place = lsp.Position(max(0, line - 1) if entry.header else line, 0)
    for title, command in _titles(view.open_project.statuses.get(entry)):
        action = lsp.Command(title, command, arguments=[entry.id, view.uri(view.path)])
        yield lsp.CodeLens(lsp.Range(place, place), action)


def _titles(status: RequirementStatus | None) -> Iterator[tuple[str, str]]:
    """Title and command of each lens."""
    yield UNKNOWN if status is None else status.verdict, AUDIT
    if status is not None and status.proof:
        yield status.proof, VERIFY
    if status is not None and status.conflict:
        yield status.conflict, EXPLAIN
    yield from (("explain", EXPLAIN), ("play", PLAY), ("test", TEST))
    if status is None or not status.proof:
        yield "verify", VERIFY
