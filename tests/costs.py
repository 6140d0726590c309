"""What a command costs: processor time and memory of a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

SECONDS, MEMORY = 5, 500 * 2**20
"""What no input of less than 100 kB may take."""
_SERVER = """
import gc, json, os, resource, sys, tempfile, traceback
import compiler.project.folder, mcap_ros2, rosbags.typesys
import fretc.audit.log_paths, fretc.audit.many_logs, fretc.traceability.analyses
import fretc.commands.audit, fretc.commands.audit_run
import fretc.commands.check, fretc.commands.formalize, fretc.commands.info
from fretc import cli

def run(folder, words, out):
    resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
    resource.setrlimit(resource.RLIMIT_AS, (8 * 2**30,) * 2)
    os.chdir(folder)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(out.fileno(), 1)
    os.dup2(out.fileno(), 2)
    sys.argv = ["fretc", *words]
    status = 1
    try:
        cli.main()
    except SystemExit as end:
        status = int(end.code or 0)
    except BaseException:
        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)

gc.freeze()
for line in sys.stdin:
    folder, words = json.loads(line)
    with tempfile.TemporaryFile() as out:
        child = os.fork()
        if not child:
            run(folder, words, out)
        _, ended, used = os.wait4(child, 0)
        out.seek(0)
        text = out.read(20000).decode(errors="replace")
    seconds = used.ru_utime + used.ru_stime
    answer = os.waitstatus_to_exitcode(ended), text, seconds, used.ru_maxrss * 1024
    print(json.dumps(answer), flush=True)
"""
"""It has imported what the commands need, and forks: what it has counts as the child's memory."""


@dataclass(frozen=True)
class Cost:
    """What came of a command, and what it took."""

    status: int
    text: str
    seconds: float
    """Of a processor, without what every command imports."""
    memory: int
    """Bytes, at most."""


class Measuring:
    """Commands whose costs are measured, one after the other."""

    def __init__(self, server: subprocess.Popen[str]) -> None:
        self._server = server

    def cost(self, folder: Path, files: Mapping[str, str | bytes], *args: str) -> Cost:
        """Run `fretc` in a folder with these files, none of which is of 100 kB."""
        for name, content in files.items():
            data = content if isinstance(content, bytes) else content.encode()
            assert len(data) < 100_000
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(data)
        assert self._server.stdin
        assert self._server.stdout
        self._server.stdin.write(json.dumps([str(folder), args]) + "\n")
        self._server.stdin.flush()
        return Cost(*json.loads(self._server.stdout.readline()))


@contextmanager
def measuring() -> Iterator[Measuring]:
    """A process that starts the commands, until this ends."""
    with subprocess.Popen(
        [sys.executable, "-c", _SERVER],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parent.parent,
    ) as server:
        yield Measuring(server)
