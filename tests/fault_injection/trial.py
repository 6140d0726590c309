"""One fault in a copy of the tree, and the tests near it until the first that fails."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from tests.fault_injection.drawing import Fault


class Finding(Enum):
    """What became of a fault."""

    FOUND = "found"
    SURVIVED = "survived"
    OUT_OF_TIME = "out of time"
    EQUIVALENT = "equivalent"


@dataclass(frozen=True)
class Trial:
    """How the tests did with a fault; `test` is the first that failed, `seconds` are of CPU."""

    fault: Fault
    line: int
    finding: Finding
    test: str
    seconds: float


def copied(root: Path, folder: Path) -> Path:
    """Copy what git tracks, and what it does not ignore, into an empty folder."""
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=root, capture_output=True, check=True).stdout.decode()
    for name in filter(None, names.split("\0")):
        if root.joinpath(name).is_file():
            folder.joinpath(name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, folder / name)
    return folder


def tried(fault: Fault, tree: Path, tests: list[str], limit: int) -> Trial:
    """Run the tests in `tree` with the fault in it, and leave the tree as it was.

    Args:
        fault: the change; `tree` has the file that it was drawn from.
        tree: a copy of the project that nobody else uses meanwhile.
        tests: test files, the likeliest to fail first.
        limit: CPU seconds, of all tests together; on the wall three times as many.
    """
    path = tree / fault.path
    whole = path.read_bytes()
    path.write_bytes(fault.applied(whole))
    before = _cpu()
    try:
        status, text = _pytest(tree, tests, limit)
    finally:
        path.write_bytes(whole)
    findings = {0: Finding.SURVIVED, 1: Finding.FOUND, 2: Finding.FOUND, None: Finding.OUT_OF_TIME}
    failed = [line for line in text.splitlines() if line.startswith(("FAILED ", "ERROR "))]
    test = failed[0].split(" - ")[0] if failed else ""
    finding = findings.get(status, Finding.FOUND)  # 3, 4: pytest itself could not go on
    return Trial(fault, fault.line(whole), finding, test, round(_cpu() - before, 1))


def _cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _pytest(tree: Path, tests: list[str], limit: int) -> tuple[int | None, str]:
    """Return pytest's exit status, None where the time ran out, and what it printed."""
    options = ["-x", "-q", "-n0", "--no-header", "--tb=no", "-rfE", "-p", "no:cacheprovider"]
    command = [sys.executable, "-m", "pytest", *options, "--hypothesis-seed=0", *tests]
    environment = os.environ | {"PYTHONPATH": str(tree)}

    def bounded() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))

    process = subprocess.Popen(
        command,
        cwd=tree,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
        preexec_fn=bounded,
    )
    try:
        text, _ = process.communicate(timeout=3 * limit)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        process.communicate()
        return None, ""
    return (None if process.returncode < 0 else process.returncode), text
