"""One file of a project, as an answer about a position in it needs it."""

from __future__ import annotations

import os
from bisect import bisect_right
from collections.abc import Callable

from lsprotocol import types as lsp

from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.project import Project
from fretc.lsp.names import Occurrence
from fretc.lsp.positions import Positions
from fretc.lsp.session import OpenProject, Session
from fretish.diagnostics.source import Span
from fretish.documents import RequirementEntry


class View:
    """A file with its project at the time of one request."""

    def __init__(
        self,
        path: str,
        project: OpenProject,
        session: Session,
        encoding: str,
        uri: Callable[[str], str],
    ) -> None:
        self.path, self.open_project, self.session = path, project, session
        self.encoding, self.uri = encoding, uri
        self.text = session.text(path) or ""
        self.positions = Positions(self.text, encoding)
        self._others: dict[str, Positions] = {}

    @property
    def project(self) -> Project | None:
        """The project; None if it cannot be read."""
        return self.open_project.reading(self.session.texts).project

    @property
    def occurrences(self) -> list[Occurrence]:
        """All names of the project."""
        return self.open_project.occurrences(self.session.texts)

    @property
    def is_requirements(self) -> bool:
        """Whether the file is a `.fret` file."""
        return self.path.endswith(".fret")

    @property
    def name(self) -> str:
        """The name of the file."""
        return os.path.basename(self.path)

    def is_here(self, span: Span) -> bool:
        """Whether a span is in the file."""
        return self.open_project.path(span.source) == self.path

    def entries(self) -> list[RequirementEntry]:
        """The requirements of the file, in order."""
        every = self.project.requirements if self.project else ()
        return [entry for entry in every if self.is_here(entry.wording)]

    def entry_at(self, offset: int) -> RequirementEntry | None:
        """The requirement at an offset: the one whose header or sentence is around it."""
        entries = self.entries()
        starts = [start_of(entry) for entry in entries]
        at = bisect_right(starts, offset) - 1
        return entries[at] if at >= 0 else None

    def formalized(self, entry: RequirementEntry) -> FormalizedRequirement | None:
        """The requirement with its formulas; None if it has an error."""
        every = self.project.formalized if self.project else ()
        return next((each for each in every if each.entry is entry), None)

    def occurrence_at(self, offset: int) -> Occurrence | None:
        """The name at an offset, or directly before it."""
        touching = [
            each
            for each in self.occurrences
            if each.span.start <= offset <= each.span.end and self.is_here(each.span)
        ]
        return max(touching, key=lambda each: each.span.start, default=None)

    def location(self, span: Span) -> lsp.Location:
        """The location of a span of any file of the project."""
        return lsp.Location(self.uri(self.open_project.path(span.source)), self.range_of(span))

    def range_of(self, span: Span) -> lsp.Range:
        """The range of a span of any file of the project."""
        path = self.open_project.path(span.source)
        if path not in self._others:
            self._others[path] = Positions(span.source.text, self.encoding)
        return self._others[path].of(span)


def start_of(entry: RequirementEntry) -> int:
    """The offset at which a requirement begins: its header, or else its sentence."""
    return entry.header.text.start if entry.header else entry.wording.start
