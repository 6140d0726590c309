"""Diagnostics of a project as those of the Language Server Protocol, by file."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator

from lsprotocol import types as lsp

from compiler.files.text_files import read, unsaved_texts
from compiler.project.paths import HAZARDS
from fretc.lsp.positions import Positions
from fretc.lsp.session import OpenProject, Session, with_real_paths
from fretish.diagnostics.diagnostic import Diagnostic, Severity
from fretish.diagnostics.source import Span
from fretish.reading.natural_order import by_place
from fretish.reading.toml_text import header_places

SOURCE = "fretc"
_SEVERITIES = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}
Uri = Callable[[str], str]
"""Function from an absolute path to its URI."""


class Reports:
    """The diagnostics of one project at one time, by the path of their file."""

    def __init__(self, project: OpenProject, session: Session, encoding: str, uri: Uri) -> None:
        self._project, self._session = project, session
        self._encoding, self._uri = encoding, uri
        self._positions: dict[str, Positions] = {}

    def by_path(self) -> dict[str, tuple[lsp.Diagnostic, ...]]:
        """The diagnostics of each file that has any, in the order of the text."""
        files: dict[str, list[lsp.Diagnostic]] = {}
        for diagnostic in by_place(self._project.diagnostics(self._session.texts)):
            path, span = self._place(diagnostic)
            files.setdefault(path, []).append(self._report(path, span, diagnostic))
        return {path: tuple(reports) for path, reports in files.items()}

    def _place(self, diagnostic: Diagnostic) -> tuple[str, Span | None]:
        """The file to report it in, and the place in that; None: its start."""
        span = diagnostic.span
        if span is not None:
            path = self._project.path(span.source)
            # A folder, or the text of a value with escapes, cannot be shown by an editor.
            if path in self._session.texts or os.path.isfile(path):
                return path, span if span.source.text else None
        hazards = os.path.join(self._project.folder, HAZARDS)
        if diagnostic.subject and span is None and self._session.text(hazards) is not None:
            return hazards, self._hazard(hazards, diagnostic.subject)
        return self._first_file(), None

    def _hazard(self, path: str, id: str) -> Span | None:
        with unsaved_texts(with_real_paths(self._session.texts)):
            source = read(path)
        if isinstance(source, Diagnostic):
            return None
        place = header_places(source.text).get((id,))
        return None if place is None else source.span(*place)

    def _first_file(self) -> str:
        """The file for what has no place: the first one that is open, or of the requirements."""
        project = self._project.reading(self._session.texts).project
        of_folder = [p for p in self._session.texts if os.path.dirname(p) == self._project.folder]
        if project is None:
            return min(of_folder, default=os.path.join(self._project.folder, "bindings.toml"))
        return self._project.path(project.requirements[0].wording.source)

    def _report(self, path: str, span: Span | None, diagnostic: Diagnostic) -> lsp.Diagnostic:
        help_ = [f"help: {diagnostic.help}"] if diagnostic.help else []
        reason = [f"accepted: {diagnostic.accepted}"] if diagnostic.accepted else []
        return lsp.Diagnostic(
            range=self._range(path, span),
            severity=_severity(diagnostic),
            code=diagnostic.code.number,
            source=SOURCE,
            message="\n".join([diagnostic.message, *(reason or help_)]),
            tags=[lsp.DiagnosticTag.Unnecessary] if diagnostic.accepted else None,
            related_information=[*self._related(diagnostic)] or None,
        )

    def _range(self, path: str, span: Span | None) -> lsp.Range:
        start = lsp.Position(0, 0)
        if span is None:
            return lsp.Range(start, start)
        if path not in self._positions:
            self._positions[path] = Positions(span.source.text, self._encoding)
        return self._positions[path].of(span)

    def _related(self, diagnostic: Diagnostic) -> Iterator[lsp.DiagnosticRelatedInformation]:
        for span in diagnostic.related:
            path = self._project.path(span.source)
            place = lsp.Location(self._uri(path), self._range(path, span))
            yield lsp.DiagnosticRelatedInformation(place, f"`{span.text.strip()}`")


def _severity(diagnostic: Diagnostic) -> lsp.DiagnosticSeverity:
    """The severity; an accepted warning is a hint."""
    if diagnostic.accepted:
        return lsp.DiagnosticSeverity.Hint
    return _SEVERITIES[diagnostic.severity]
