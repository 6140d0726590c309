"""Faults in copies of a tree, each with the tests near it until the first that fails."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Generator, Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from queue import SimpleQueue

from tests.fault_injection.drawing import Fault
from tests.fault_injection.first_failure import CUT_SHORT
from tests.fault_injection.selection import Neighbourhood

RUNNER = Path(__file__).with_name("first_failure.py")
OPTIONS = ("-x", "-q", "-n0", "--tb=no", "-p", "no:cacheprovider")
PASSED = (0, 5)
"""Exit status of pytest; 5: there were no tests."""
STOPPED = (-signal.SIGXCPU, -signal.SIGKILL)
"""By a limit; a crash is a failure like others."""


class Finding(Enum):
    """What became of a fault."""

    FOUND = "found"
    SURVIVED = "survived"
    CUT_SHORT = "cut short"
    """The time was over before all tests had run, and none had failed."""
    OUT_OF_TIME = "out of time"
    """One test had no end."""
    EQUIVALENT = "equivalent"


@dataclass(frozen=True, slots=True)
class Trial:
    """How the tests did with a fault.

    Args:
        fault: the change.
        line: of its file, from 1.
        finding: what became of it.
        why: the first test that failed or had no end; of an equivalent change the reason.
    """

    fault: Fault
    line: int
    finding: Finding
    why: str = ""


@dataclass
class Bench:
    """Copies of a tree, in which faults are tried; the tree itself is left as it is.

    Args:
        root: the tree; a checkout of git.
        jobs: faults that are tried at a time, each in a copy of its own.
        seconds: of a processor for a fault: half for its module's own tests, half for the others.
    """

    root: Path
    jobs: int
    seconds: int
    fails_anyway: set[str] = field(default_factory=set)
    """Tests that fail without any fault: they find none."""
    _passes: set[str] = field(default_factory=set)
    _running: set[subprocess.Popen[bytes]] = field(default_factory=set)
    _stops: bool = False

    def trials(self, faults: Sequence[Fault]) -> Generator[Trial]:
        """Try each fault, and yield how it went, in their order."""
        near = Neighbourhood(self.root)
        with tempfile.TemporaryDirectory(prefix="faults-") as place:
            copies: SimpleQueue[Path] = SimpleQueue()
            for job in range(self.jobs):
                copies.put(copied(self.root, Path(place, str(job))))

            def one(fault: Fault) -> Trial:
                copy = copies.get()
                try:
                    return self._tried(fault, copy, near.files(fault.path))
                finally:
                    copies.put(copy)

            pool = ThreadPoolExecutor(self.jobs)
            try:
                yield from pool.map(one, faults)
            finally:  # also where the command is stopped
                self._stops = True
                pool.shutdown(wait=False, cancel_futures=True)
                for process in [*self._running]:
                    _end(process)
                pool.shutdown()

    def _tried(self, fault: Fault, copy: Path, tests: tuple[list[str], list[str]]) -> Trial:
        line = fault.line(copy.joinpath(fault.path).read_bytes())
        stages = [*filter(None, tests)]
        for stage in stages:
            finding, test = self._outcome(fault, copy, stage, self.seconds // len(stages))
            if finding is not Finding.SURVIVED:
                return Trial(fault, line, finding, test)
        return Trial(fault, line, Finding.SURVIVED)

    def _outcome(
        self, fault: Fault, copy: Path, tests: list[str], seconds: int
    ) -> tuple[Finding, str]:
        """Run tests on the fault, once more where one failed that fails anyway."""
        path = copy / fault.path
        whole = path.read_bytes()
        left_out: set[str] = set()
        while True:
            _write(path, fault.applied(whole))
            try:
                finding, test = self._pytest(copy, tests, seconds)
            finally:
                _write(path, whole)
            if finding is not Finding.FOUND or self._passes_without(test or tests[0], copy):
                return finding, test
            if test in left_out or not test:
                raise RuntimeError(f"no test can begin in {self.root}")
            left_out.add(test)

    def _passes_without(self, test: str, copy: Path) -> bool:
        if test not in self._passes | self.fails_anyway:
            finding, _ = self._pytest(copy, [test], self.seconds)
            (self.fails_anyway if finding is Finding.FOUND else self._passes).add(test)
        return test in self._passes

    def _pytest(self, copy: Path, tests: list[str], seconds: int) -> tuple[Finding, str]:
        """Return how the tests ended, and the last that ran."""
        if self._stops:
            raise CancelledError
        tests = [test for test in tests if test not in self.fails_anyway]
        if not tests:  # without a name pytest would run all there are
            return Finding.SURVIVED, ""
        place = copy.with_suffix(".tmp")
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        note = place / "note"
        note.touch()
        left_out = [f"--deselect={test}" for test in sorted(self.fails_anyway)]
        command = [sys.executable, "-P", str(RUNNER), str(seconds), str(note), *OPTIONS]
        process = subprocess.Popen(
            [*command, *left_out, *tests],
            cwd=copy,
            env=os.environ | {"PYTHONPATH": str(copy), "TMPDIR": str(place)},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self._running.add(process)
        with suppress(subprocess.TimeoutExpired):
            process.wait(6 * seconds)
        _end(process)
        self._running.discard(process)
        return _finding(process.returncode), note.read_text("utf-8")


def _finding(status: int) -> Finding:
    if status in PASSED:
        return Finding.SURVIVED
    if status == CUT_SHORT:
        return Finding.CUT_SHORT
    return Finding.OUT_OF_TIME if status in STOPPED else Finding.FOUND


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the process, and what it has started."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _write(path: Path, text: bytes) -> None:
    """Write a module, and forget how its former text was compiled: both may be of one second."""
    path.write_bytes(text)
    for compiled in path.parent.glob(f"__pycache__/{path.stem}.*"):
        compiled.unlink()


def copied(root: Path, folder: Path) -> Path:
    """Copy what git tracks, and what it does not ignore, into an empty folder."""
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=root, capture_output=True, check=True).stdout.decode()
    for name in filter(None, names.split("\0")):
        if root.joinpath(name).is_file():
            folder.joinpath(name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, folder / name)
    return folder
