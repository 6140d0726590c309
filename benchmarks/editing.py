"""How long an editor waits for `fretc lsp` while a person types among 1 000 requirements.

The requirements are in 100 files with bindings. A person types sentences into one of the files, a
character at a time; after each, the time until the server has handled the edit is measured: it has
published the diagnostics, and answers the next question. CPU time of the server's main thread, in
which all of that happens; the wall time is printed beside it.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.figures import Figure

FRETC = [str(Path(sys.executable).parent / "fretc"), "lsp"]
EMPTY = [
    sys.executable,
    "-c",
    "from pygls.lsp.server import LanguageServer; LanguageServer('empty', '1').start_io()",
]
FILES, IN_EACH, SIGNALS = 100, 10, 100
SENTENCE = "in mode3 mode whenever p7 & !q12 the Rover shall within 5 seconds satisfy q9 | s7 > 2 m"
LIMITS = {"edit": 0.050, "hover": 0.030, "completion": 0.030}
"""Seconds that 95 of 100 edits, hovers or completions may take."""


@dataclass(frozen=True)
class Cost:
    """What one message costs, in seconds."""

    cpu: float
    wall: float


def project(folder: Path) -> Path:
    """Write 1 000 requirements and their bindings; the file that is edited."""
    requirements = folder / "requirements"
    requirements.mkdir()
    tables = ['[clock]\ntick = "100 ms"\n']
    for i in range(SIGNALS):
        tables.append(f'[signal.s{i}]\npath = "/t{i}.data"\nunit = "m"\n')
        tables.append(f'[proposition.p{i}]\nexpr = "s{i} > 3 m"\nrole = "input"\n')
        tables.append(f'[proposition.q{i}]\nexpr = "s{i} < 1 m"\nrole = "output"\n')
    tables.extend(f'[proposition.mode{i}]\nexpr = "s{i} > 9 m"\nrole = "mode"\n' for i in range(7))
    (requirements / "bindings.toml").write_text("\n".join(tables))
    (requirements / "hazards.toml").write_text('[H1]\ntitle = "Hazard"\n')
    for file in range(FILES):
        texts = [entry(file * IN_EACH + i) for i in range(IN_EACH)]
        (requirements / f"r{file}.fret").write_text("\n".join(texts))
    return requirements / "r3.fret"


def entry(i: int) -> str:
    """A requirement, whose names and numbers depend on its number."""
    return (
        f'+++\nid = "R{i}"\ntitle = "Requirement {i}"\nparents = ["H1"]\n+++\n'
        f"in mode{i % 7} mode whenever p{i % 100} & !q{(i + 3) % 100} the Rover shall within "
        f"{i % 9 + 1} seconds satisfy q{(i + 1) % 100} | s{i % 100} > 2 m\n"
    )


class Server:
    """The server as a process, and an editor that waits for it."""

    def __init__(self, command: Sequence[str], folder: Path) -> None:
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
        self._process = subprocess.Popen(
            command, cwd=folder, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self._id = 0
        self.ask("initialize", processId=None, rootUri=folder.as_uri(), capabilities={})
        self.tell("initialized")

    def tell(self, method: str, id: int | None = None, **params: Any) -> None:
        message = {"jsonrpc": "2.0", "method": method, "params": params}
        data = json.dumps(message if id is None else {**message, "id": id}).encode()
        assert self._process.stdin is not None
        self._process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(data) + data)
        self._process.stdin.flush()

    def ask(self, method: str, **params: Any) -> Any:
        """The answer, after all that the server sends before it."""
        self._id += 1
        self.tell(method, self._id, **params)
        while (message := self._message()).get("id") != self._id or "method" in message:
            pass
        return message["result"]

    def _message(self) -> Any:
        output = self._process.stdout
        assert output is not None
        length = 0
        while (line := output.readline()) != b"\r\n":
            name, _, value = line.partition(b":")
            length = int(value) if name.lower() == b"content-length" else length
        return json.loads(output.read(length))

    @property
    def cpu(self) -> float:
        """CPU seconds of the main thread."""
        text = Path(f"/proc/{self._process.pid}/schedstat").read_text(encoding="utf-8")
        return int(text.split()[0]) / 1e9

    @property
    def memory(self) -> float:
        """The most memory that it has had, in MB."""
        text = Path(f"/proc/{self._process.pid}/status").read_text(encoding="utf-8")
        return int(text.partition("VmHWM:")[2].split()[0]) / 1024

    def close(self) -> None:
        self.ask("shutdown")
        self.tell("exit")
        self._process.communicate()


class Typist:
    """A person who types sentences into one file."""

    def __init__(self, server: Server, file: Path) -> None:
        self._server, self._uri = server, file.as_uri()
        self._text, self._version = file.read_text(encoding="utf-8"), 1
        document = {"uri": self._uri, "languageId": "fretish", "version": 1, "text": self._text}
        server.tell("textDocument/didOpen", textDocument=document)
        self._handled()

    def edits(self, count: int) -> Iterator[Cost]:
        """Type the sentence again and again behind the last requirement, then delete it."""
        header = '\n+++\nid = "R-new"\nparents = ["H1"]\n+++\n'
        for at in range(count):
            typed = SENTENCE[: at % (len(SENTENCE) + 1)]
            yield self._cost(partial(self._change, self._text + header + typed))

    def questions(self, method: str, count: int) -> Iterator[Cost]:
        """Ask after an edit, whose own cost is not counted."""
        lines = self._text.splitlines()
        for at in range(count):
            self._change(self._text + " " * (at % 2))
            line = 5 + 7 * (at % IN_EACH)
            where = {"line": line, "character": at % len(lines[line])}
            yield self._cost(partial(self._ask, method, where))

    def _ask(self, method: str, where: Any) -> None:
        document = {"uri": self._uri}
        self._server.ask(f"textDocument/{method}", textDocument=document, position=where)

    def _cost(self, action: Callable[[], None]) -> Cost:
        cpu, wall = self._server.cpu, time.perf_counter()
        action()
        return Cost(self._server.cpu - cpu, time.perf_counter() - wall)

    def _change(self, text: str) -> None:
        self._version += 1
        document = {"uri": self._uri, "version": self._version}
        changes = [{"text": text}]
        self._server.tell("textDocument/didChange", textDocument=document, contentChanges=changes)
        self._handled()

    def _handled(self) -> None:
        """Wait until everything that was sent is handled."""
        self._server.ask("textDocument/foldingRange", textDocument={"uri": self._uri})


def high(costs: Sequence[float]) -> float:
    """The 95th percentile."""
    return statistics.quantiles(costs, n=20)[-1]


def measured(edits: int, settled: float) -> tuple[dict[str, list[Cost]], float]:
    """The costs of edits and questions, and the most memory in MB.

    Args:
        edits: the number of edits.
        settled: seconds until the server has computed all diagnostics.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = project(Path(folder))
        server = Server(FRETC, Path(folder))
        typist = Typist(server, file)
        time.sleep(settled)  # the slow diagnostics are computed, and not while edits are measured
        costs = {"edit": [*typist.edits(edits)]}
        for method in ("hover", "completion"):
            costs[method] = [*typist.questions(method, edits // 3)]
        time.sleep(5)
        memory = server.memory
        server.close()
    return costs, memory


def start(command: Sequence[str]) -> float:
    """CPU seconds of a server until it has answered `initialize`."""
    with tempfile.TemporaryDirectory() as folder:
        server = Server(command, Path(folder))
        seconds = server.cpu
        server.close()
    return seconds


def figures() -> Iterator[Figure]:
    costs, memory = measured(300, 20)
    for name, limit in LIMITS.items():
        yield Figure(f"lsp, {name}, p95", high([each.cpu for each in costs[name]]), "s", limit)
    yield Figure("lsp, memory", memory, "MB", 200)
    starts = [(start(FRETC), start(EMPTY)) for _ in range(5)]
    yield Figure("lsp, start", statistics.median(ours for ours, _ in starts), "s", 1)
    ratio = statistics.median(ours / empty for ours, empty in starts)
    yield Figure("lsp, start", ratio, "x empty pygls server", 2)


def main() -> None:
    """Print median and 95th percentile of each kind of message."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edits", type=int, default=300)
    parser.add_argument("--settled", type=float, default=20)
    options = parser.parse_args()
    costs, memory = measured(options.edits, options.settled)
    print(f"{'':12} {'median':>9} {'p95':>9} {'wall p95':>9} {'goal':>7}")
    for name, some in costs.items():
        cpu, wall = [each.cpu for each in some], [each.wall for each in some]
        middle, limit = statistics.median(cpu), LIMITS[name]
        row = f"{1e3 * middle:6.1f} ms {1e3 * high(cpu):6.1f} ms {1e3 * high(wall):6.1f} ms"
        print(f"{name:12} {row} {1e3 * limit:4.0f} ms")
    print(f"memory: {memory:.0f} MB")
    ours, empty = (statistics.median(start(c) for _ in range(5)) for c in (FRETC, EMPTY))
    print(f"start: {ours:.2f} s, an empty pygls server {empty:.2f} s: {ours / empty:.2f} x")


if __name__ == "__main__":
    main()
