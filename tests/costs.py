"""What a command costs: processor time and memory of a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

SECONDS, MEMORY = 5, 500 * 2**20
"""What no input of less than 100 kB may take."""
_RUNNER = """
import json, resource, subprocess, sys

def limit():
    resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
    resource.setrlimit(resource.RLIMIT_AS, (8 * 2**30,) * 2)

done = subprocess.run(
    sys.argv[1:], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    preexec_fn=limit,
)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
text = done.stdout[:20000].decode(errors="replace")
seconds = used.ru_utime + used.ru_stime
print(json.dumps([done.returncode, text, seconds, used.ru_maxrss * 1024]))
"""
"""A small process between: what a child begins with counts as its own memory."""


@dataclass(frozen=True)
class Cost:
    """What came of a command, and what it took."""

    status: int
    text: str
    seconds: float
    """Of a processor."""
    memory: int
    """Bytes, at most."""


def cost(folder: Path, files: Mapping[str, str | bytes], *args: str) -> Cost:
    """Run `fretc` in a folder with these files, none of which is of 100 kB."""
    for name, content in files.items():
        data = content if isinstance(content, bytes) else content.encode()
        assert len(data) < 100_000
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
    fretc = str(Path(sys.executable).parent / "fretc")
    done = subprocess.run(
        [sys.executable, "-S", "-c", _RUNNER, fretc, *args],
        cwd=folder,
        capture_output=True,
        check=True,
    )
    return Cost(*json.loads(done.stdout))
