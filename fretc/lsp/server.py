"""The server: the messages of the Language Server Protocol, through pygls.

Every message is answered in the main thread, one after the other; a thread of pygls waits for
input. Diagnostics that take long are computed while no message has come for a moment, and stopped
when one comes.
"""

from __future__ import annotations

import asyncio
import gc
import logging
import os
import sys
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from typing import Any, BinaryIO, cast
from weakref import WeakKeyDictionary

from lsprotocol import types as lsp
from pygls import uris
from pygls.exceptions import FeatureNotificationError, JsonRpcException
from pygls.lsp.server import LanguageServer

from compiler.files.build_id import __version__
from compiler.project.paths import BINDINGS
from fretc.lsp import commands, outline
from fretc.lsp.answers import ANSWERS, Answer, RefusalError
from fretc.lsp.reports import Reports
from fretc.lsp.session import OpenProject, Session, requirement_folders
from fretc.lsp.view import View
from fretish.diagnostics.diagnostic import Code
from fretish.reading.limits import StoppedError

_SILENCE = 0.3
"""Seconds without a message after which the slow diagnostics are computed."""
_MANY = 100
"""From so many requirements on the client shows that slow diagnostics are being computed."""
_REFUSED = lsp.LSPErrorCodes.RequestFailed.value
_WITH_IMAGES = "marked"
"""The Markdown parser of VS Code and of editors for the web; terminals show no images."""
_WATCHED = ("**/*.fret", "**/{bindings,hazards,waivers,fretc,pyproject}.toml", "**/fretc.lock")


class Server(LanguageServer):
    """The language server of fretc."""

    def __init__(self) -> None:
        super().__init__(
            "fretc", __version__, text_document_sync_kind=lsp.TextDocumentSyncKind.Full
        )
        self.session = Session()
        self.published: dict[str, tuple[lsp.Diagnostic, ...]] = {}
        """Path → the diagnostics that the client shows."""
        self.input_waits: Callable[[], bool] = lambda: False
        """Whether a message has come that is not handled yet."""
        self._reports: WeakKeyDictionary[OpenProject, Reports] = WeakKeyDictionary()
        self._timer: asyncio.TimerHandle | None = None
        self._tokens = 0

    @property
    def encoding(self) -> str:
        """The encoding that the client counts characters in."""
        return lsp.PositionEncodingKind(self.workspace.position_encoding or "utf-16").value

    def view(self, uri: str) -> View | None:
        """The file of a URI; None if it is of no project."""
        path = path_of(uri)
        project = None if path is None else self.session.project(path)
        if path is None or project is None:
            return None
        return View(path, project, self.session, self.encoding, uri_of)

    def report_server_error(self, error: Exception, source: object) -> None:
        """Write F999 in the client's log, unless a request was refused with a reason."""
        if isinstance(error, JsonRpcException) and error.code == _REFUSED:
            return
        text = f"{Code.INTERNAL.number} {Code.INTERNAL.summary}: {type(error).__name__}: {error}"
        self.window_log_message(lsp.LogMessageParams(lsp.MessageType.Error, text))

    def refresh(self) -> None:
        """Publish the quick diagnostics of what has changed; the others follow after a silence."""
        self._publish()
        self._after_silence()

    def complete(self) -> None:
        """Compute and publish all diagnostics; if a message comes, after the next silence."""
        try:
            for project in self.session.open_projects():
                if not project.is_complete:
                    self._with_progress(project)
        except StoppedError:
            self._after_silence()
        except Exception as error:
            self.report_server_error(error, FeatureNotificationError)
        else:
            self._publish()
            self._refresh_lenses()

    def _refresh_lenses(self) -> None:
        """Let the client ask again for code lenses, if it can."""
        workspace = self.client_capabilities.workspace
        lens = workspace.code_lens if workspace is not None else None
        if lens is not None and lens.refresh_support:
            self.workspace_code_lens_refresh(None)

    def _after_silence(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self._timer = asyncio.get_running_loop().call_later(_SILENCE, self._in_silence)

    def _in_silence(self) -> None:
        """Compute all diagnostics, and collect garbage now, so that no answer waits for that.

        What is left stays for long: later collections, between messages, need not look at it.
        """
        self.complete()
        if all(project.is_complete for project in self.session.open_projects()):
            gc.unfreeze()
            gc.collect()
            gc.freeze()

    def _with_progress(self, project: OpenProject) -> None:
        texts = self.session.texts
        known = project.reading(texts).project
        window = self.client_capabilities.window
        can_show = window is not None and window.work_done_progress
        if known is None or len(known.requirements) < _MANY or not can_show:
            project.complete(texts, self.input_waits)
            return
        self._tokens += 1
        token = f"fretc-check-{self._tokens}"
        progress = self.work_done_progress
        progress.create(token)
        progress.begin(token, lsp.WorkDoneProgressBegin(f"check {project.name}", cancellable=False))
        try:
            project.complete(texts, self.input_waits)
        finally:
            progress.end(token, lsp.WorkDoneProgressEnd())

    def _publish(self) -> None:
        """Send the diagnostics of each file whose diagnostics have changed."""
        files: dict[str, tuple[lsp.Diagnostic, ...]] = {}
        for project in self.session.open_projects():
            if project not in self._reports:
                self._reports[project] = Reports(project, self.session, self.encoding, uri_of)
            reports = self._reports[project].by_path()
            files |= {path: (*files.get(path, ()), *some) for path, some in reports.items()}
        for path in {**self.published, **files}:
            present = files.get(path, ())
            if present != self.published.get(path, ()):
                self.text_document_publish_diagnostics(
                    lsp.PublishDiagnosticsParams(uri_of(path), list(present))
                )
        self.published = {path: some for path, some in files.items() if some}


def uri_of(path: str) -> str:
    """The URI of an absolute path."""
    return cast(str, uris.from_fs_path(path))


def path_of(uri: str) -> str | None:
    """The absolute path of a URI; None if it is not that of a file."""
    path = uris.to_fs_path(uri)
    if path is None or "\0" in path or not os.path.isabs(path):
        return None
    return os.path.normpath(path)


class _WatchedInput:
    """Standard input that knows whether somebody waits for it."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._is_awaited = False

    def readline(self) -> bytes:
        self._is_awaited = True
        line = self._stream.readline()
        self._is_awaited = False
        return line

    def read(self, size: int) -> bytes:
        return self._stream.read(size)

    def waits(self) -> bool:
        """Whether input has come, and nobody has asked for more since."""
        return not self._is_awaited


def serve() -> None:
    """Answer the client at standard input and output until it closes them."""
    if "FRETC_TRACEBACK" not in os.environ:
        logging.getLogger("pygls").setLevel(logging.CRITICAL)  # it would print tracebacks
    server, stream = make_server(), _WatchedInput(sys.stdin.buffer)
    server.input_waits = stream.waits
    output = sys.stdout.buffer
    with redirect_stdout(sys.stderr):  # nothing else may write to the output
        server.start_io(cast(BinaryIO, stream), output)


def make_server() -> Server:
    """A server with all of its handlers."""
    server = Server()
    for method, handler in _NOTIFICATIONS.items():
        server.feature(method)(handler)
    for method, (answer, options) in ANSWERS.items():
        server.feature(method, options)(_handler(answer))
    server.feature(lsp.WORKSPACE_SYMBOL)(_workspace_symbols)
    return server


def _handler(answer: Answer) -> Callable[[Server, Any], Any]:
    """The handler that gives an answer; what is refused is an error for the user."""

    def handle(ls: Server, params: Any) -> Any:
        try:
            return answer(ls.view, params)
        except RefusalError as error:
            raise JsonRpcException(str(error), _REFUSED) from None

    return handle


def _workspace_symbols(ls: Server, params: lsp.WorkspaceSymbolParams) -> list[lsp.WorkspaceSymbol]:
    folders = {folder for root in ls.session.roots for folder in requirement_folders(root)}
    folders |= {project.folder for project in ls.session.open_projects()}
    views = [ls.view(uri_of(os.path.join(folder, BINDINGS))) for folder in sorted(folders)]
    return outline.workspace_symbols([view for view in views if view is not None], params.query)


def _initialize(ls: Server, params: lsp.InitializeParams) -> None:
    """Note what the client can do, and offer the commands of code lenses if it asks for them.

    Other clients have commands of the same names themselves, and could not register them twice.
    """
    document = params.capabilities.text_document
    support = document.code_action.resolve_support if document and document.code_action else None
    ls.session.resolves_actions = support is not None and "edit" in support.properties
    general = params.capabilities.general
    markdown = general.markdown if general is not None else None
    ls.session.shows_images = markdown is not None and markdown.parser == _WITH_IMAGES
    options = params.initialization_options
    if isinstance(options, Mapping) and options.get("commands") is True:
        for name in commands.COMMANDS:
            ls.command(name)(_runner(name))


def _runner(name: str) -> Callable[..., str | None]:
    """The handler of a command: the answer in text, which the client also shows as a message."""

    def run(ls: Server, *arguments: Any) -> str | None:
        id, uri = arguments if len(arguments) == 2 else ("", "")
        view = ls.view(uri) if isinstance(uri, str) else None
        text = commands.answer(view, name, str(id)) if view is not None else None
        if text is not None:
            ls.window_show_message(lsp.ShowMessageParams(lsp.MessageType.Info, text))
        return text

    return run


def _opened(ls: Server, params: lsp.DidOpenTextDocumentParams) -> None:
    path = path_of(params.text_document.uri)
    if path is not None:
        ls.session.show(path, params.text_document.text)
        ls.refresh()


def _changed(ls: Server, params: lsp.DidChangeTextDocumentParams) -> None:
    uri = params.text_document.uri
    path = path_of(uri)
    if path is not None:
        ls.session.show(path, ls.workspace.get_text_document(uri).source)
        ls.refresh()


def _closed(ls: Server, params: lsp.DidCloseTextDocumentParams) -> None:
    path = path_of(params.text_document.uri)
    if path is not None:
        ls.session.close(path)
        ls.refresh()


def _saved(ls: Server, params: lsp.DidSaveTextDocumentParams) -> None:
    ls.session.everything_changed()
    ls.refresh()


def _changed_on_disk(ls: Server, params: lsp.DidChangeWatchedFilesParams) -> None:
    for path in filter(None, (path_of(change.uri) for change in params.changes)):
        ls.session.changed(path)
    ls.refresh()


def _initialized(ls: Server, params: lsp.InitializedParams) -> None:
    ls.session.roots = _roots(ls)
    workspace = ls.client_capabilities.workspace
    watched = workspace and workspace.did_change_watched_files
    if watched and watched.dynamic_registration:
        watchers = [lsp.FileSystemWatcher(glob) for glob in _WATCHED]
        options = lsp.DidChangeWatchedFilesRegistrationOptions(watchers)
        method = lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES
        ls.client_register_capability(
            lsp.RegistrationParams([lsp.Registration("fretc-files", method, options)])
        )


def _folders_changed(ls: Server, params: lsp.DidChangeWorkspaceFoldersParams) -> None:
    ls.session.roots = _roots(ls)
    ls.session.projects.clear()
    ls.refresh()


def _roots(ls: Server) -> list[str]:
    """The workspace folders, or the root of a client that has only one."""
    uris_ = [folder.uri for folder in ls.workspace.folders.values()]
    if not uris_ and ls.workspace.root_uri is not None:
        uris_ = [ls.workspace.root_uri]
    return [path for path in map(path_of, uris_) if path is not None and os.path.isdir(path)]


_NOTIFICATIONS: Mapping[str, Callable[..., None]] = {
    lsp.INITIALIZE: _initialize,
    lsp.INITIALIZED: _initialized,
    lsp.TEXT_DOCUMENT_DID_OPEN: _opened,
    lsp.TEXT_DOCUMENT_DID_CHANGE: _changed,
    lsp.TEXT_DOCUMENT_DID_CLOSE: _closed,
    lsp.TEXT_DOCUMENT_DID_SAVE: _saved,
    lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES: _changed_on_disk,
    lsp.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS: _folders_changed,
}
"""Method → what it changes."""
