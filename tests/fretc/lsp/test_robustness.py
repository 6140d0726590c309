"""Whatever is edited: the server goes on, and reports what a fresh one would."""

import json
import os
import random
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

from fretc.lsp.server import uri_of
from fretc.lsp.session import OpenProject
from tests.command import write
from tests.editor import Editor, RefusedError
from tests.effort import FULL
from tests.fretc.report import cases

Start = Callable[..., Editor]
PIECES = (
    "+++\n", "+++", "\n", "\r\n", "\r", "\t", "\U0001f600", "é", "\u2028", "\x0c", "\0", '"', "'",
    "[", "]", "{", "}", "=", ".", ",", "(", ")", "&", "|", "!", "#", " ", "near", "stopped",
    "2e9999", "the robot shall ", "within 2 s ", "satisfy ", "whenever ", "when ",
    "in near mode ", "shal ",
    "[proposition.near]\n", 'id = "R1"\n', 'parents = ["HAZ-1"]\n', 'accept = { F204 = "x" }\n',
    "[HAZ-2]\n", 'expr = "vx < 1"\n', "\ufeff", "\ufffd",
)  # fmt: skip
FILES = {
    "requirements/r1.fret": cases.R1,
    "requirements/r2.fret": cases.requirement("R2", "the robot shall never satisfy near"),
    "requirements/bindings.toml": cases.BINDINGS,
    "requirements/hazards.toml": cases.HAZARDS,
    "requirements/waivers.toml": "",
    "fretc.toml": "",
    "elsewhere/other.fret": "the robot shall always satisfy near\n",
}
PLACED = (
    "hover", "completion", "definition", "documentHighlight", "prepareRename",
)  # fmt: skip
OF_FILES = ("documentSymbol", "foldingRange", "semanticTokens/full")


class Random:
    """A person at random, and what the editor shows of each file."""

    def __init__(self, seed: int, client: Editor) -> None:
        self.draw = random.Random(seed)
        self.client = client
        self.texts: dict[str, str] = {}
        self.steps: list[str] = []

    def step(self) -> None:
        name = self.draw.choice([*FILES, "requirements/new.fret"])
        path = self.client.root / name
        action = self.draw.choices(
            ("edit", "close", "save", "delete", "disk", "ask", "pause"), (12, 1, 2, 1, 1, 6, 1)
        )[0]
        self.steps.append(f"{action} {name}")
        if action == "edit":
            self.edit(name, path)
        elif action == "close" and name in self.texts:
            del self.texts[name]
            self.client.shut(path)
        elif action == "save" and name in self.texts:
            self.write(path, self.texts[name])
            self.client.tell("textDocument/didSave", textDocument={"uri": uri_of(str(path))})
        elif action == "delete":
            path.unlink(missing_ok=True)
            self.changed(path, 3)
        elif action == "disk":
            self.write(path, FILES.get(name, "") + self.draw.choice(PIECES))
            self.changed(path, 2)
        elif action == "ask" and name in self.texts:
            self.ask(path, self.texts[name])
        elif action == "pause":
            self.client.settle()

    def write(self, path: Path, text: str) -> None:
        path.write_bytes(text.encode("utf-8", "surrogatepass"))

    def changed(self, path: Path, kind: int) -> None:
        changes = [{"uri": uri_of(str(path)), "type": kind}]
        self.client.tell("workspace/didChangeWatchedFiles", changes=changes)

    def edit(self, name: str, path: Path) -> None:
        if name not in self.texts:
            shown = path.read_bytes().decode("utf-8", "replace") if path.exists() else ""
            self.texts[name] = shown
            self.client.open(path, shown)
            return
        text = self.texts[name]
        start = self.draw.randrange(len(text) + 1)
        end = min(len(text), start + self.draw.choice((0, 0, 0, 1, 5, 50, 1000)))
        piece = "".join(self.draw.choices(PIECES, k=self.draw.choice((0, 1, 1, 3))))
        if self.draw.random() < 0.1:
            start, end, piece = 0, len(text), FILES.get(name, "")
        self.texts[name] = text[:start] + piece + text[end:]
        self.client.change(path, self.texts[name])

    def ask(self, path: Path, text: str) -> None:
        lines = text.count("\n")
        line, character = (
            self.draw.randrange(lines + 3),
            self.draw.choice((0, 3, 9, 200, 2**31 - 1)),
        )
        where = self.client.at(path, line, character)
        for method in PLACED:
            self.client.ask(f"textDocument/{method}", **where)
        document = where["textDocument"]
        for method in OF_FILES:
            self.client.ask(f"textDocument/{method}", textDocument=document)
        everything = {"start": {"line": 0, "character": 0}, "end": where["position"]}
        self.client.ask("textDocument/inlayHint", textDocument=document, range=everything)
        self.client.ask("textDocument/references", **where, context={"includeDeclaration": False})
        self.client.ask(
            "textDocument/codeAction",
            textDocument=document,
            range=everything,
            context={"diagnostics": []},
        )
        self.client.ask(
            "textDocument/formatting",
            textDocument=document,
            options={"tabSize": 4, "insertSpaces": True},
        )
        self.client.ask("workspace/symbol", query="R")
        with suppress(RefusedError):
            self.client.ask("textDocument/rename", **where, newName=self.draw.choice(PIECES))


def published(client: Editor) -> dict[str, Any]:
    return {path: some for path, some in client.diagnostics.items() if some}


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100 if FULL else 4))
def test_random_edits_leave_what_a_fresh_start_reports(seed: int, editor: Start) -> None:
    for name, text in FILES.items():
        write(name, text)
    encoding = ("utf-8", "utf-16", "utf-32")[seed % 3]
    person = Random(seed, editor(encoding))
    for _ in range(120):
        person.step()
    person.client.settle()
    assert person.client.log == [], person.steps
    fresh = editor(encoding)
    for name, text in person.texts.items():
        fresh.open(fresh.root / name, text)
    fresh.settle()
    assert published(person.client) == published(fresh), person.steps


@pytest.mark.slow
def test_edits_of_a_huge_file_end(editor: Start) -> None:
    write("requirements/r1.fret", cases.R1)
    client, path = editor(), Path.cwd() / "requirements/r1.fret"
    client.open(path)
    texts = (
        "(" * 200_000,
        "the robot shall satisfy " + "!" * 50_000 + "near",
        cases.R1 * 300,
        "+++\n" * 20_001,
        "\n" * 200_000,
        '+++\nx = "' + "\\" * 100_001,
    )
    for text in texts if FULL else texts[:2]:
        client.change(path, text)
        for method in ("completion", "hover"):
            client.ask(f"textDocument/{method}", **client.at(path, 0, len(text)))
    client.change(path, cases.R1)
    client.settle()
    assert client.log == []
    assert "F304" in client.codes(path)


def test_slow_diagnostics_are_given_up_for_a_message_and_computed_later(
    editor: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    write("requirements/r1.fret", cases.R1)
    client, path = editor(), Path.cwd() / "requirements/r1.fret"
    client.open(path)
    across, waiting = OpenProject._across, [True, False]

    def slow(self: OpenProject, project: Any) -> Any:
        while waiting[0]:  # until a message comes
            pass
        return across(self, project)

    monkeypatch.setattr(OpenProject, "_across", slow)
    client.answer_while_waiting(lambda: waiting[0])
    client.settle()
    (project,) = client.projects()
    assert not project.is_complete
    waiting[0] = False
    client.settle()
    assert project.is_complete


# The server as a process --------------------------------------------------------------------------

COMMAND = (sys.executable, "-P", "-c", "from fretc.cli import main; main()", "lsp", "--stdio")


class Process:
    """The server in a process of its own."""

    def __init__(self, process: "subprocess.Popen[bytes]") -> None:
        self.process = process

    @classmethod
    @contextmanager
    def of(cls, folder: Path) -> Iterator["Process"]:
        environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
        pipes: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
        with subprocess.Popen(COMMAND, cwd=folder, env=environment, **pipes) as process:
            yield cls(process)

    def send(self, method: str, id: int | None = None, **params: Any) -> None:
        message = {"jsonrpc": "2.0", "method": method, "params": params}
        data = json.dumps(message if id is None else {**message, "id": id}).encode()
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(data) + data)
        self.process.stdin.flush()

    def received(self) -> Iterator[Any]:
        """The messages of the server, until it ends."""
        assert self.process.stdout is not None
        while header := self.process.stdout.readline():
            length = int(header.partition(b":")[2])
            while self.process.stdout.readline() != b"\r\n":
                pass
            yield json.loads(self.process.stdout.read(length))


@pytest.mark.slow
def test_a_hostile_workspace_runs_nothing(tmp_path: Path) -> None:
    """Neither modules in it that are named as ours, nor what its files say."""
    mark = tmp_path / "executed"
    for name in (
        "pygls",
        "lsprotocol",
        "json",
        "fretc",
        "attrs",
        "cattrs",
        "sitecustomize",
        "tomllib",
    ):
        (tmp_path / f"{name}.py").write_text(f"open({str(mark)!r}, 'w')\n")
    (tmp_path / "requirements").mkdir()
    path = tmp_path / "requirements/r1.fret"
    path.write_text(cases.R1)
    os.mkfifo(tmp_path / "requirements/r2.fret")
    (tmp_path / "requirements/r3.fret").symlink_to("/dev/zero")
    (tmp_path / "requirements/bindings.toml").symlink_to("/dev/zero")
    (tmp_path / "fretc.toml").write_text('parents = ["/etc/passwd", "../../secret.json"]\n')
    place = {"line": 9, "character": 1}
    with Process.of(tmp_path) as server:
        server.send("initialize", 1, processId=None, rootUri=uri_of(str(tmp_path)), capabilities={})
        server.send("initialized")
        document = {"uri": uri_of(str(path)), "languageId": "x", "version": 1, "text": cases.R1}
        server.send("textDocument/didOpen", textDocument=document)
        server.send("textDocument/hover", 2, textDocument=document, position=place)
        server.send("shutdown", 3)
        server.send("exit")
        messages = [*server.received()]
        assert server.process.wait(60) == 0
    answers = {each["id"] for each in messages if "id" in each and "method" not in each}
    assert answers == {1, 2, 3}
    reported = {
        diagnostic["code"]
        for each in messages
        if each.get("method") == "textDocument/publishDiagnostics"
        for diagnostic in each["params"]["diagnostics"]
    }
    assert "F903" in reported
    assert not mark.exists()


@pytest.mark.slow
def test_a_client_that_is_gone_ends_the_server(tmp_path: Path) -> None:
    with Process.of(tmp_path) as server:
        server.send("initialize", 1, processId=None, rootUri=None, capabilities={})
        assert next(server.received())["id"] == 1
        assert server.process.stdin is not None
        server.process.stdin.close()
        assert server.process.wait(60) == 0
        assert server.process.stderr is not None
        assert server.process.stderr.read() == b""
