"""Diagnostics of a project as those of the Language Server Protocol, by file."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence

from lsprotocol import types as lsp

from compiler.files.text_files import read, unsaved_texts
from compiler.project.paths import HAZARDS
from fretc.lsp.positions import Positions
from fretc.lsp.session import OpenProject, Session, with_real_paths
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Span
from fretish.reading.toml_text import header_places

SOURCE = "fretc"
_SEVERITIES = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}
Uri = Callable[[str], str]
"""Function from an absolute path to its URI."""
_Placed = tuple[Span | None, Diagnostic]
"""A diagnostic and its place in the file that reports it; None: the start of the file."""


class Reports:
    """The diagnostics of one project, by the path of their file."""

    def __init__(self, project: OpenProject, session: Session, encoding: str, uri: Uri) -> None:
        self._project, self._session = project, session
        self._encoding, self._uri = encoding, uri
        self._earlier: dict[str, tuple[Sequence[_Placed], tuple[lsp.Diagnostic, ...]]] = {}

    def by_path(self) -> dict[str, tuple[lsp.Diagnostic, ...]]:
        """The present diagnostics of each file that has any, in the order of the text.

        A file whose diagnostics are equal to those of the last call has the same reports.
        """
        reports: dict[str, tuple[Sequence[_Placed], tuple[lsp.Diagnostic, ...]]] = {}
        for path, some in self._placed().items():
            earlier = self._earlier.get(path)
            if earlier is not None and earlier[0] == some:
                reports[path] = earlier
            else:
                reports[path] = some, self._reports(some)
        self._earlier = reports
        return {path: made for path, (_, made) in reports.items()}

    def _placed(self) -> dict[str, list[_Placed]]:
        """The diagnostics of each file with their places, in the order of the text."""
        files: dict[str, list[_Placed]] = {}
        paths: dict[str, str | None] = {}
        for diagnostic in self._project.diagnostics(self._session.texts):
            path, span = self._place(diagnostic, paths)
            files.setdefault(path, []).append((span, diagnostic))
        for some in files.values():
            some.sort(key=lambda placed: placed[0].start if placed[0] is not None else -1)
        return files

    def _place(
        self, diagnostic: Diagnostic, paths: dict[str, str | None]
    ) -> tuple[str, Span | None]:
        """The file to report it in, and the place in that; None: its start.

        Args:
            diagnostic: the diagnostic.
            paths: name of a source → path of its file, or None; it is extended.
        """
        span = diagnostic.span
        if span is not None:
            name = span.source.name
            path = paths[name] if name in paths else paths.setdefault(name, self._file(span))
            if path is not None:
                return path, span if span.source.text else None
        hazards = os.path.join(self._project.folder, HAZARDS)
        if diagnostic.subject and span is None and self._session.text(hazards) is not None:
            return hazards, self._hazard(hazards, diagnostic.subject)
        return self._first_file(), None

    def _file(self, span: Span) -> str | None:
        """The path of a file; None for a folder, or for the text of a value with escapes."""
        path = self._project.path(span.source)
        return path if path in self._session.texts or os.path.isfile(path) else None

    def _reports(self, placed: Sequence[_Placed]) -> tuple[lsp.Diagnostic, ...]:
        positions: dict[str, Positions] = {}
        return tuple(self._report(span, diagnostic, positions) for span, diagnostic in placed)

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

    def _report(
        self, span: Span | None, diagnostic: Diagnostic, positions: dict[str, Positions]
    ) -> lsp.Diagnostic:
        help_ = [f"help: {diagnostic.help}"] if diagnostic.help else []
        reason = [f"accepted: {diagnostic.accepted}"] if diagnostic.accepted else []
        related = [
            lsp.DiagnosticRelatedInformation(
                lsp.Location(
                    self._uri(self._project.path(other.source)), self._range(other, positions)
                ),
                f"`{other.text.strip()}`",
            )
            for other in diagnostic.related
        ]
        return lsp.Diagnostic(
            range=self._range(span, positions),
            severity=_severity(diagnostic),
            code=diagnostic.code.number,
            source=SOURCE,
            message="\n".join([diagnostic.message, *(reason or help_)]),
            tags=[lsp.DiagnosticTag.Unnecessary] if _is_unnecessary(diagnostic) else None,
            related_information=related or None,
        )

    def _range(self, span: Span | None, positions: dict[str, Positions]) -> lsp.Range:
        if span is None:
            return lsp.Range(lsp.Position(0, 0), lsp.Position(0, 0))
        if span.source.name not in positions:
            positions[span.source.name] = Positions(span.source.text, self._encoding)
        return positions[span.source.name].of(span)


def _is_unnecessary(diagnostic: Diagnostic) -> bool:
    """Whether its text can be removed, or its warning is accepted; editors show both dimmed."""
    return bool(diagnostic.accepted) or diagnostic.code in _IDLE


_IDLE = (Code.IDLE_WAIVER, Code.IDLE_ACCEPTANCE)


def _severity(diagnostic: Diagnostic) -> lsp.DiagnosticSeverity:
    """The severity; an accepted warning is a hint."""
    if diagnostic.accepted:
        return lsp.DiagnosticSeverity.Hint
    return _SEVERITIES[diagnostic.severity]
