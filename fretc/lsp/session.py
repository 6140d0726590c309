"""The texts that an editor shows, and the projects that they belong to.

A project is a folder with `.fret` files. It is read when something asks for it after a change; what
has not changed is taken from the reading before. Paths are absolute.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import chdir, contextmanager
from pathlib import Path

from compiler.files.settings import NAME as SETTINGS
from compiler.files.settings import SHARED, repository
from compiler.files.text_files import read, unsaved_texts
from compiler.project.folder import load_folder
from compiler.project.paths import BINDINGS, HAZARDS
from compiler.project.project import Project
from fretc.audit.evidence.result_summaries import ResultSummaries
from fretc.checking.diagnostics import (
    ProjectCheck,
    SideFiles,
    check_project,
    quick_diagnostics,
)
from fretc.checking.statuses import RequirementStatus, statuses
from fretc.logs.storage.log_names import path_of
from fretc.lsp.names import Occurrence, occurrences
from fretc.terminal.options import default_evidence
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.reading.limits import ExceededError, exceeded, stoppable
from fretish.reading.memory import Memory

LOCK, WAIVERS = "fretc.lock", "waivers.toml"
SIDE_FILES = (BINDINGS, HAZARDS, WAIVERS, LOCK)
"""Files in the folder of the requirements."""
_SLOWEST = 60.0
"""CPU seconds for the diagnostics that are computed while nobody types."""


@dataclass(frozen=True, slots=True)
class Reading:
    """One reading of a project: the project, and its diagnostics."""

    project: Project | None
    """None if the folder cannot be read, or has no requirement."""
    diagnostics: tuple[Diagnostic, ...]
    """The diagnostics that need neither reviews, evidence nor generated files."""


class OpenProject:
    """A folder of requirements, as the editor shows it."""

    def __init__(self, folder: str, root: str) -> None:
        self.folder, self.root = folder, root
        self._quick, self._slow, self._names = Memory(), Memory(), Memory()
        self._occurrences: list[Occurrence] | None = None
        self._reading: Reading | None = None
        self._check: ProjectCheck | None = None
        self._slow_ones: tuple[Diagnostic, ...] = ()
        """The diagnostics that only `complete` gives, of its last run."""
        self._statuses: Mapping[RequirementEntry, RequirementStatus] = {}
        self._latest_log = ""
        self._changed: set[str] = set()
        """The files that have changed since then."""

    @property
    def name(self) -> str:
        """The folder as a command in the root would name it."""
        return self.relative(self.folder)

    def path(self, source: Source) -> str:
        """The absolute path of a source."""
        return os.path.normpath(os.path.join(self.root, source.name))

    @property
    def latest_log(self) -> str:
        """The name of the latest audited log that lies in the root; "" if there is none."""
        return self._latest_log if self.is_complete else ""

    def relative(self, path: str) -> str:
        """A path as a command in the root would name it."""
        return os.path.relpath(path, self.root)

    def forget(self, path: str | None = None) -> None:
        """Read the project again when something asks for it.

        Args:
            path: the file that has changed; None: it is not known.
        """
        self._reading = self._check = self._occurrences = None
        if path is not None:
            self._changed.add(path)

    def reading(self, texts: Mapping[str, str]) -> Reading:
        """The present reading.

        Args:
            texts: path → text that the editor shows.
        """
        if self._reading is None:
            with self.around(texts), self._quick.active():
                project = load_folder(self.name)
                if isinstance(project, Diagnostic):
                    self._reading = Reading(None, (project,))
                else:
                    self._reading = Reading(project, quick_diagnostics(project))
        return self._reading

    @property
    def is_complete(self) -> bool:
        """Whether `diagnostics` has all that `fretc check` reports."""
        return self._check is not None

    @property
    def statuses(self) -> Mapping[RequirementEntry, RequirementStatus]:
        """The status of each requirement; empty until `complete` has run after the last change."""
        return self._statuses if self.is_complete else {}

    def diagnostics(self, texts: Mapping[str, str]) -> tuple[Diagnostic, ...]:
        """All diagnostics if `complete` has run since the last change.

        Otherwise the quick ones, with the slow ones of its last run for files that are unchanged.
        """
        if self._check is not None:
            return self._check.diagnostics
        kept = (each for each in self._slow_ones if self._is_unchanged(each))
        return tuple(dict.fromkeys((*self.reading(texts).diagnostics, *kept)))

    def _is_unchanged(self, diagnostic: Diagnostic) -> bool:
        span = diagnostic.span
        return span is None or self.path(span.source) not in self._changed

    def complete(self, texts: Mapping[str, str], stop: Callable[[], bool]) -> None:
        """Compute the diagnostics that `fretc check` would report.

        Args:
            texts: path → text that the editor shows.
            stop: whether the result is no longer wanted.

        Raises:
            StoppedError: it is not.
        """
        reading = self.reading(texts)
        check, statuses = self._computed(reading, texts, stop)
        quick = {*reading.diagnostics}
        self._slow_ones = tuple(each for each in check.diagnostics if each not in quick)
        self._changed.clear()
        self._check, self._statuses = check, statuses
        self._latest_log = self._log_of(check.summaries)
        self.occurrences(texts)  # so that the first question about a name need not wait for them

    def _computed(
        self, reading: Reading, texts: Mapping[str, str], stop: Callable[[], bool]
    ) -> tuple[ProjectCheck, Mapping[RequirementEntry, RequirementStatus]]:
        if reading.project is None:
            return ProjectCheck(reading.diagnostics), {}
        try:
            with self.around(texts), self._slow.active(), stoppable(stop, _SLOWEST):
                check = self._across(reading.project)
                return check, {each.entry: each for each in statuses(check)}
        except ExceededError as error:
            return ProjectCheck((*reading.diagnostics, exceeded(error))), {}

    def _log_of(self, summaries: ResultSummaries | None) -> str:
        if summaries is None:
            return ""
        runs = sorted(summaries.source.runs(), key=lambda run: run.start_ns or 0, reverse=True)
        for run in runs:
            path = os.path.realpath(os.path.join(self.root, path_of(run.run)))
            if _is_below(path, os.path.realpath(self.root)) and os.path.isfile(path):
                return run.run
        return ""

    def _across(self, project: Project) -> ProjectCheck:
        evidence = default_evidence()
        if isinstance(evidence, Diagnostic):
            return ProjectCheck((*quick_diagnostics(project), evidence))
        return check_project(project, SideFiles(self.name, evidence))

    def occurrences(self, texts: Mapping[str, str]) -> list[Occurrence]:
        """All names of the project and where they are; none if it cannot be read."""
        project = self.reading(texts).project
        if self._occurrences is None:
            with self.around(texts), self._names.active():
                self._occurrences = [] if project is None else occurrences(project, self.name)
        return self._occurrences

    @contextmanager
    def around(self, texts: Mapping[str, str]) -> Iterator[None]:
        """Context in which files have the texts of the editor, and paths begin at the root."""
        with chdir(self.root), unsaved_texts(with_real_paths(texts)):
            yield


class Session:
    """The open texts of an editor and their projects."""

    def __init__(self) -> None:
        self.roots: list[str] = []
        """The workspace folders."""
        self.resolves_actions = False
        """Whether the client asks for the edit of an action when the user chooses it."""
        self.shows_images = False
        """Whether the client shows images of Markdown."""
        self.texts: dict[str, str] = {}
        """Path → text, without a byte order mark, of each open file."""
        self.projects: dict[str, OpenProject] = {}
        """Folder → project, of each project with an open file."""

    def show(self, path: str, text: str) -> None:
        """A file is open, and has this text."""
        self.texts[path] = text.removeprefix("\ufeff")
        self.changed(path)

    def close(self, path: str) -> None:
        """A file is no longer open; it has the text of the disk."""
        self.texts.pop(path, None)
        self.changed(path)

    def changed(self, path: str) -> None:
        """A file has changed, in the editor or on the disk."""
        name, folder = os.path.split(path)[1], os.path.dirname(path)
        for project in self.projects.values():
            below = project.folder == folder or _is_below(project.folder, folder)
            if project.folder == folder or (name in (SETTINGS, SHARED) and below):
                project.forget(path)

    def everything_changed(self) -> None:
        """Anything may have changed on the disk."""
        for project in self.projects.values():
            project.forget()

    def project(self, path: str) -> OpenProject | None:
        """The project that a file belongs to; None if it is no file of a project."""
        if not is_of_project(path):
            return None
        return self.in_folder(os.path.dirname(path))

    def open_projects(self) -> list[OpenProject]:
        """The projects that an open file belongs to; all others are dropped."""
        folders = {os.path.dirname(path) for path in self.texts if is_of_project(path)}
        for path in self.texts:
            if os.path.basename(path) == SETTINGS:
                folders.update(requirement_folders(os.path.dirname(path)))
        for folder in self.projects.keys() - folders:
            del self.projects[folder]
        projects = (self.in_folder(folder) for folder in sorted(folders))
        return [project for project in projects if project is not None]

    def in_folder(self, folder: str) -> OpenProject | None:
        """The project of a folder; None if there is no such folder."""
        if folder not in self.projects:
            if not os.path.isdir(folder):
                return None
            self.projects[folder] = OpenProject(folder, self._root(folder))
        return self.projects[folder]

    def text(self, path: str) -> str | None:
        """The text of a file, of the editor or else of the disk; None if it cannot be read."""
        with unsaved_texts(with_real_paths(self.texts)):
            source = read(path)
        return None if isinstance(source, Diagnostic) else source.text

    def _root(self, folder: str) -> str:
        """Where `fretc check` would be run: workspace folder, repository, or the folder itself."""
        around = [root for root in self.roots if root == folder or _is_below(folder, root)]
        if around:
            return max(around, key=len)
        return str(repository(Path(folder)) or folder)


def is_of_project(path: str) -> bool:
    """Whether a file lies beside the requirements of a project, or is one of them."""
    return path.endswith(".fret") or os.path.basename(path) in SIDE_FILES


def with_real_paths(texts: Mapping[str, str]) -> Mapping[str, str]:
    """The texts by their paths, and by what these are where links are resolved."""
    return {**texts, **{os.path.realpath(path): text for path, text in texts.items()}}


_MOST_FOLDERS = 2000
"""Folders below the settings that are searched for requirements."""


def requirement_folders(folder: str) -> list[str]:
    """The folders with `.fret` files at and below a folder; links are not followed."""
    folders = []
    for count, (here, below, files) in enumerate(os.walk(folder)):
        below[:] = sorted(name for name in below if not name.startswith("."))
        if any(name.endswith(".fret") for name in files):
            folders.append(here)
        if count >= _MOST_FOLDERS:
            break
    return folders


def _is_below(path: str, folder: str) -> bool:
    return os.path.join(path, "").startswith(os.path.join(folder, ""))
