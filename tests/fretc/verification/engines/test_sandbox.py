"""A call with limits gives its result, or says why it does not."""

import multiprocessing
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from fretc.verification.engines.sandbox import (
    DEFAULT,
    CallLimits,
    NoResult,
    SandboxSession,
    confined,
)
from tests.effort import full_only


def twice(number: int) -> int:
    return 2 * number


def spin() -> None:
    while True:
        pass


def sleep() -> None:
    time.sleep(600)


def fill() -> int:
    return len(bytearray(8 * 2**30))


def fail() -> None:
    raise ValueError("no")


def fail_with_what_cannot_be_sent() -> None:
    class LocalError(Exception):
        pass

    raise LocalError("no")


def die() -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


@pytest.mark.slow
def test_time_on_the_wall_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(CallLimits, "wall", 0.7)
    assert confined(DEFAULT, sleep) == NoResult("out of time: no answer within 0.7 s")
    assert multiprocessing.active_children() == []


def pretend(seconds: float) -> None:
    """Have the process believe that it has taken so many CPU seconds."""
    resource.getrusage = lambda who: SimpleNamespace(ru_utime=seconds, ru_stime=0.0)  # type: ignore[assignment,return-value]


def limit() -> tuple[int, int]:
    """The process, and after how many CPU seconds it is stopped."""
    return os.getpid(), resource.getrlimit(resource.RLIMIT_CPU)[0]


def work(seconds: float) -> tuple[int, float]:
    """Until the process has taken so many of a processor; the process, and how many are left."""
    while time.process_time() < seconds:
        pass
    left = resource.getrlimit(resource.RLIMIT_CPU)[0] - time.process_time()
    return os.getpid(), left


@pytest.mark.slow
def test_calls_of_a_session_share_a_process_and_each_has_its_limits() -> None:
    with SandboxSession(CallLimits(seconds=1, memory=2**30)) as session:
        session.call(pretend, 0.0)
        assert session.call(spin) == NoResult("out of time: more than 1 CPU seconds")
        assert session.call(twice, 21) == 42
        session.call(pretend, 41.5)
        first, second = session.call(limit), session.call(limit)
        assert first == second
        assert not isinstance(first, NoResult)
        assert first[1] == 43, "counted from what was taken before the call"
        with pytest.raises(ValueError, match="no"):
            session.call(fail)
        with pytest.raises(RuntimeError, match="LocalError: no"):
            session.call(fail_with_what_cannot_be_sent)
        assert session.call(fill) == NoResult("out of memory: more than 1 GiB")
        crashed = "the process crashed (signal 11); it may have had too little memory"
        assert session.call(die) == NoResult(crashed)
        assert session.call(twice, 4) == 8
    assert multiprocessing.active_children() == []


@full_only("CPU seconds")
def test_the_limit_is_counted_from_what_was_taken_before_the_call() -> None:
    with SandboxSession(CallLimits(seconds=1)) as session:
        assert session.call(spin) == NoResult("out of time: more than 1 CPU seconds")
        answers = [session.call(work, seconds) for seconds in (0, 1.2, 0)]
    found = [each for each in answers if not isinstance(each, NoResult)]
    assert len(found) == 3, answers
    assert len({process for process, _ in found}) == 1
    assert all(0.9 < left < 2.1 for _, left in found[::2]), "before the work, and after it"


@pytest.mark.slow
def test_the_program_itself_is_not_executed_once_more(tmp_path: Path) -> None:
    script = tmp_path / "program.py"
    script.write_text(
        "from operator import neg\n"
        "from fretc.verification.engines.sandbox import DEFAULT, confined\n"
        "print(confined(DEFAULT, neg, 21))\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[4])}
    command = [sys.executable, str(script)]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
    assert (run.stdout, run.stderr) == ("-21\n", "")


@pytest.mark.slow
def test_a_child_that_is_interrupted_while_it_imports_answers_without_a_word(
    tmp_path: Path,
) -> None:
    (tmp_path / "sitecustomize.py").write_text(
        "import os, signal, sys\n"
        "class Finder:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name == os.environ.get('INTERRUPTED'):\n"
        "            os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Finder())\n"
    )
    script = (
        "import os\n"
        "from fretc.verification.engines.sandbox import DEFAULT, confined\n"
        "os.environ['INTERRUPTED'] = confined.__module__\n"
        "print(confined(DEFAULT, abs, -3))\n"
    )
    folders = os.pathsep.join((str(tmp_path), str(Path(__file__).parents[4])))
    run = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": folders},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "3\n", "")


@pytest.mark.slow
def test_an_interruption_ends_the_process(tmp_path: Path) -> None:
    (tmp_path / "waits.py").write_text(
        "import os, time\n"
        "def wait(path):\n"
        "    open(path, 'w').write(str(os.getpid()))\n"
        "    time.sleep(600)\n"
    )
    script = tmp_path / "program.py"
    script.write_text(
        "from fretc.verification.engines.sandbox import DEFAULT, confined\n"
        "from waits import wait\n"
        f"confined(DEFAULT, wait, {str(tmp_path / 'pid')!r})\n"
    )
    environment = {**os.environ, "PYTHONPATH": f"{Path(__file__).parents[4]}{os.pathsep}{tmp_path}"}
    command = [sys.executable, str(script)]
    running = subprocess.Popen(command, env=environment, stderr=subprocess.PIPE)
    pid = tmp_path / "pid"
    deadline = time.monotonic() + 30
    while not (pid.exists() and pid.read_text()) and time.monotonic() < deadline:
        time.sleep(0.02)
    running.send_signal(signal.SIGINT)
    running.communicate(timeout=30)
    with pytest.raises(ProcessLookupError):
        os.kill(int(pid.read_text()), 0)
