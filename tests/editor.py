"""An editor in this process: it sends messages of the protocol to the handlers of the server."""

import asyncio
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fretc.lsp.server import make_server, uri_of
from fretc.lsp.session import OpenProject

CAPABILITIES = {
    "workspace": {
        "workspaceEdit": {"documentChanges": True},
        "codeLens": {"refreshSupport": True},
    },
    "textDocument": {
        "publishDiagnostics": {"relatedInformation": True},
        "codeAction": {"resolveSupport": {"properties": ["edit"]}},
    },
}
GENERAL: dict[str, Any] = {}
"""More of what the client can do in general."""


class Editor:
    """A client that has opened one workspace folder. Texts are sent, and nothing is awaited."""

    def __init__(self, root: Path, encoding: str = "utf-16", **options: Any) -> None:
        self.root = root
        self.diagnostics: dict[str, list[Any]] = {}
        """Path → what the server has published last."""
        self.log: list[str] = []
        self.messages: list[str] = []
        self.refreshes = 0
        self._loop = asyncio.new_event_loop()
        self._server = make_server()
        self._server.protocol.set_writer(self)
        self._answers: dict[int, Any] = {}
        self._id = 0
        self._versions: dict[str, int] = {}
        general = {"positionEncodings": [encoding], **GENERAL}
        folders = [{"uri": uri_of(str(root)), "name": "root"}]
        self.server = self.ask(
            "initialize",
            processId=None,
            rootUri=uri_of(str(root)),
            workspaceFolders=folders,
            capabilities={**CAPABILITIES, "general": general},
            initializationOptions=options,
        )
        self.tell("initialized")

    def write(self, data: bytes) -> None:
        message = json.loads(data.partition(b"\r\n\r\n")[2])
        if message.get("method") == "textDocument/publishDiagnostics":
            path = message["params"]["uri"].removeprefix("file://")
            self.diagnostics[path] = message["params"]["diagnostics"]
        elif message.get("method") == "window/showMessage":
            self.messages.append(message["params"]["message"])
        elif message.get("method") == "workspace/codeLens/refresh":
            self.refreshes += 1
        elif message.get("method") == "window/logMessage":
            self.log.append(message["params"]["message"])
        elif "method" not in message:
            self._answers[message["id"]] = message

    def close(self) -> None:
        self._loop.close()

    def ask(self, method: str, **params: Any) -> Any:
        """The result of a request; a message of an error is raised."""
        self._id += 1
        self._send({"id": self._id, "method": method, "params": params})
        answer = self._answers.pop(self._id)
        if "error" in answer:
            raise RefusedError(answer["error"]["message"])
        return answer["result"]

    def tell(self, method: str, **params: Any) -> None:
        self._send({"method": method, "params": params})

    def open(self, path: Path, text: str | None = None) -> str:
        """Show a file, with another text than that of the disk if one is given; its URI."""
        uri, self._versions[str(path)] = uri_of(str(path)), 1
        shown = path.read_text("utf-8") if text is None else text
        document = {"uri": uri, "languageId": "fretish", "version": 1, "text": shown}
        self.tell("textDocument/didOpen", textDocument=document)
        return uri

    def change(self, path: Path, text: str) -> None:
        self._versions[str(path)] += 1
        document = {"uri": uri_of(str(path)), "version": self._versions[str(path)]}
        self.tell("textDocument/didChange", textDocument=document, contentChanges=[{"text": text}])

    def shut(self, path: Path) -> None:
        self.tell("textDocument/didClose", textDocument={"uri": uri_of(str(path))})

    def settle(self) -> None:
        """Wait until the server has nothing more to say."""

        async def complete() -> None:
            self._server.complete()

        self._loop.run_until_complete(complete())

    def answer_while_waiting(self, waits: Callable[[], bool]) -> None:
        """Let the server ask this function whether a message has come."""
        self._server.input_waits = waits

    def projects(self) -> list[OpenProject]:
        return self._server.session.open_projects()

    def at(self, path: Path, line: int, character: int) -> dict[str, Any]:
        """The parameters of a request about a position."""
        return {
            "textDocument": {"uri": uri_of(str(path))},
            "position": {"line": line, "character": character},
        }

    def codes(self, path: Path) -> list[str]:
        return [each["code"] for each in self.diagnostics.get(str(path), [])]

    def _send(self, message: dict[str, Any]) -> None:
        protocol = self._server.protocol

        async def handle() -> None:
            protocol.handle_message(protocol.structure_message({"jsonrpc": "2.0", **message}))

        self._loop.run_until_complete(handle())


class RefusedError(Exception):
    """The server has answered a request by an error."""
