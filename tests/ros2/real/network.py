"""Real ROS 2 for tests: a domain of its own on the loopback, and the processes in it.

Anyone who waits, waits for what a process tells, never for a time to pass.
"""

from __future__ import annotations

import json
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests import dds
from tests.programs import DEBIANS_PATH
from tests.ros2.real.environment import python

WATCH = Path(__file__).parents[3] / "docs/watch.md"
_PROFILE = re.compile(r"```xml\n(.*?)```", re.DOTALL)
"""The settings with which `fretc watch dds` reads what Fast DDS 3 sends."""
PATIENCE = 60.0
"""Seconds for what takes one, on a machine that may be busy."""
NODE = "r1_monitor"
_SHARED = re.compile(r"/dev/shm/(?:fastrtps|fastdds)_(?!port70)\w+")
"""Shared memory of Fast DDS 2 and 3, without the ports that all domains share."""


@dataclass(frozen=True)
class Program:
    """A node of an emitted package, and the file of what it prints as errors."""

    network: Network
    process: subprocess.Popen[str]
    errors: Path

    @property
    def said(self) -> str:
        """What it has printed until now."""
        return self.errors.read_text()

    @property
    def hears_signals(self) -> bool:
        """Whether it has a handler of its own for SIGTERM, as Python has for SIGINT."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        (caught,) = re.findall(r"^SigCgt:\s*(\w+)$", status, re.MULTILINE)
        return bool(int(caught, 16) >> signal.SIGTERM - 1 & 1)

    def end(self, number: int) -> int:
        """Send a signal, and wait for the end; its status."""
        return self.network.end(self.process, number)


class Robot:
    """The process of `robot.py`, which answers each line by what it knows."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def ask(self, what: str = "how") -> dict[str, Any]:
        """Its state, after what was asked."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(what, file=self._process.stdin, flush=True)
        found: dict[str, Any] = json.loads(self._process.stdout.readline())
        return found

    def until(self, what: str, holds: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
        """Wait until that holds of its state; this state.

        Raises:
            AssertionError: it has not come.
        """
        end = time.monotonic() + PATIENCE
        while not holds(state := self.ask()):
            assert time.monotonic() < end, f"not within {PATIENCE} s: {what}: {state}"
            time.sleep(0.05)
        return state

    def change(self, *transitions: str) -> list[bool]:
        """Ask the monitor for transitions of a managed node; whether it has made each."""
        return [self.ask(f"change {NODE} {each}")["done"] for each in transitions]

    def goes_on(self) -> None:
        """It is put far away, again and again, until it drives."""

        def holds(state: dict[str, Any]) -> bool:
            if state["clearance"] < 0.1:
                self.ask("away")
            return bool(state["wheels"]) and state["wheels"][-1] > 0 and state["speed"] > 0

        self.until("it drives", holds)

    def drives(self) -> None:
        self.until("it drives", lambda state: state["speed"] > 0)

    def stands(self) -> None:
        self.until("it stands", lambda state: state["speed"] == 0)


class Network:
    """A domain, and processes that end with it."""

    def __init__(self, folder: Path, number: int, release: str, stack: ExitStack) -> None:
        self.release = release
        self._folder, self._stack, self._count = folder, stack, 0
        self._shared: set[Path] = set()
        """Files of shared memory, which a killed process leaves behind."""
        stack.callback(self._clean)
        self._python = str(python(release))
        self.environment = {
            "PATH": DEBIANS_PATH,
            "HOME": str(folder),
            "ROS_DOMAIN_ID": str(number),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_LOG_DIR": str(folder / "log"),
        }
        if release != "jazzy":  # Fast DDS 3: what the documentation asks for
            (profile,) = _PROFILE.findall(WATCH.read_text(encoding="utf-8"))
            (folder / "profile.xml").write_text(profile)
            self.environment |= {"FASTDDS_DEFAULT_PROFILES_FILE": str(folder / "profile.xml")}
        self.of_fretc = dds.environment(number)
        """Where `fretc watch dds` sees the same domain."""

    def start(self, *words: str, package: Path | None = None, **how: Any) -> subprocess.Popen[str]:
        """A process of ROS 2; it is killed when the test ends."""
        environment = {**self.environment, "PYTHONPATH": str(package or "")}
        process = subprocess.Popen(
            [self._python, *words], env=environment, cwd=self._folder, text=True, **how
        )
        self._stack.callback(self.end, process, signal.SIGKILL)
        return process

    def end(self, process: subprocess.Popen[str], number: int) -> int:
        """Send a signal to a process, and wait for its end; its status."""
        if process.poll() is None:
            self._shared |= shared(process)
            process.send_signal(number)
        status = process.wait(PATIENCE)
        for pipe in filter(None, (process.stdin, process.stdout)):
            pipe.close()
        return status

    def _clean(self) -> None:
        for path in self._shared:
            path.unlink(missing_ok=True)
            path.with_name(f"{path.name}_el").unlink(missing_ok=True)
            path.with_name(f"sem.{path.name}_mutex").unlink(missing_ok=True)

    def robot(self, *words: str) -> Robot:
        """A robot that does not move yet, with arguments of ROS."""
        script = str(Path(__file__).with_name("robot.py"))
        return Robot(self.start(script, *words, stdin=subprocess.PIPE, stdout=subprocess.PIPE))

    def monitor(self, package: Path, *words: str) -> Program:
        """The node of an emitted package, not configured yet."""
        return self._program(package, "-m", package.name, *words)

    def interceptor(self, package: Path, *words: str) -> Program:
        """The interceptor of an emitted package."""
        return self._program(package, str(package / package.name / "interceptor.py"), *words)

    def _program(self, package: Path, *words: str) -> Program:
        self._count += 1
        errors = self._folder / f"errors-{self._count}.txt"
        with errors.open("w") as stream:
            return Program(self, self.start(*words, package=package, stderr=stream), errors)


def shared(process: subprocess.Popen[str]) -> set[Path]:
    """The files of shared memory that a process has mapped, its own and those of others."""
    maps = Path(f"/proc/{process.pid}/maps").read_text()
    return {Path(each) for each in _SHARED.findall(maps)}


@contextmanager
def network(folder: Path, release: str = "jazzy") -> Iterator[Network]:
    """A domain that nobody uses; the test is skipped where there is no ROS 2."""
    python(release)
    with dds.domain() as number, ExitStack() as stack:
        yield Network(folder, number, release, stack)
