"""The same audit on Dask: a real cluster of two processes, one of which is killed."""

import contextlib
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.request
import warnings
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from fretc.audit import dask_executor
from fretc.audit.many_logs import AuditOutcome, Engine, LogResult, audit_logs
from fretc.audit.plan import packed, unpacked
from fretish.diagnostics import extras
from fretish.diagnostics.diagnostic import Diagnostic
from tests.command import Fretc, untimed
from tests.effort import FULL
from tests.fretc.audit import deadly
from tests.fretc.audit.plans import plan
from tests.fretc.audit.test_into_store import content, written
from tests.traces import MISSION, part

ROOT = Path(__file__).parents[3]
LOGS = [f"{number:02}.mcap" for number in range(12 if FULL else 6)]
LONG = 300
"""Seconds, of the clock: anyone who waits so long for what is on its way waits in vain."""

pytestmark = pytest.mark.filterwarnings("ignore")  # Dask's own


def local_cluster(**options: Any) -> Any:
    """Dask takes half a second to import; no worker that collects this waits for it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from distributed import LocalCluster
    return LocalCluster(**options)


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine a worker takes long to begin, and so does the one after a killed one."""
    monkeypatch.setattr(dask_executor, "PATIENCE", LONG)


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    with local_cluster(
        n_workers=2, threads_per_worker=2, dashboard_address="127.0.0.1:0", silence_logs=60
    ) as workers:
        yield workers


@pytest.fixture
def fretc(fretc: Fretc) -> Fretc:
    """Run the command in a folder with requirements and some logs, one of them damaged."""
    shutil.copytree(ROOT / "requirements", "requirements")
    whole = MISSION.read_bytes() if FULL else part()
    Path(LOGS[0]).write_bytes(whole)
    for log in LOGS[1:]:
        os.link(LOGS[0], log)
    Path(LOGS[5]).unlink()
    Path(LOGS[5]).write_bytes(whole[: len(whole) // 2])
    return fretc


def engine(cluster: Any) -> Engine:
    result = dask_executor.engine(cluster.scheduler_address.replace("tcp", "dask"), 2)
    assert not isinstance(result, Diagnostic)
    return result


def kill(cluster: Any) -> None:
    """Kill one worker; its nanny starts another."""
    os.kill(next(iter(cluster.workers.values())).pid, signal.SIGKILL)


def test_a_plan_is_the_same_after_a_journey(fretc: Fretc) -> None:
    there = unpacked(packed(plan()))
    assert there == plan()
    assert there.declarations == plan().declarations


@pytest.mark.slow
@pytest.mark.parametrize("status", ["lost", "pending"])
def test_a_result_that_dies_with_its_worker_is_made_again(status: str) -> None:
    assert dask_executor._result(SimpleNamespace(status=status)) is None


def test_a_worker_whose_own_folder_is_gone_finds_the_logs(tmp_path: Path) -> None:
    gone, folder = tmp_path / "gone", tmp_path / "folder"
    gone.mkdir()
    folder.mkdir()
    with contextlib.chdir(tmp_path):
        os.chdir(gone)
        gone.rmdir()
        with dask_executor._in(str(folder)):
            assert Path.cwd() == folder


@pytest.mark.slow
def test_the_command_gives_the_same_on_a_fleet(fretc: Fretc, cluster: Any) -> None:
    here = fretc("audit", *LOGS)
    evidence = content()
    shutil.rmtree("build")
    address = cluster.scheduler_address.replace("tcp", "dask")
    there = fretc("audit", *LOGS, "--engine", address)
    assert (there.status, there.err) == (here.status, here.err)
    assert untimed(there.out) == untimed(here.out)
    assert content() == evidence


@pytest.mark.slow
def test_a_worker_with_another_fretc_is_refused(
    fretc: Fretc, cluster: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dask_executor, "build_id", lambda: "another")
    diagnostic = audit_logs(plan(), LOGS[:2], engine(cluster))
    assert isinstance(diagnostic, Diagnostic)
    assert diagnostic.code.number == "F911"
    assert diagnostic.message.startswith("the worker tcp://127.0.0.1:")


@pytest.mark.slow
def test_a_worker_without_fretc_is_refused(
    fretc: Fretc, cluster: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def work(*_: object) -> None:
        raise ModuleNotFoundError("No module named 'compiler'")

    monkeypatch.setattr(dask_executor, "_work", work)
    diagnostic = audit_logs(plan(), LOGS[:2], engine(cluster))
    assert isinstance(diagnostic, Diagnostic)
    assert (diagnostic.code.number, diagnostic.message) == (
        "F911",
        "a worker has no fretc, or another version: No module named 'compiler'",
    )


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_nothing_and_counts_nothing_twice(
    fretc: Fretc, cluster: Any
) -> None:
    here = audit_logs(plan(), LOGS)
    names: list[str] = []

    def tell(log: str, audited: LogResult) -> None:
        if not names:
            kill(cluster)
        names.append(log)

    there = audit_logs(plan(), LOGS, engine(cluster), tell=tell)
    assert there == here
    assert sorted(names) == LOGS


@pytest.mark.slow
def test_a_log_that_kills_its_workers_is_told_and_the_others_are_audited(
    fretc: Fretc, cluster: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last one of the cluster: who dies while it begins is not always begun again."""
    here = audit_logs(plan(), LOGS[:5])
    monkeypatch.setattr(dask_executor, "_work", deadly.work)
    monkeypatch.setattr(cluster.scheduler, "allowed_failures", int(FULL))
    there = audit_logs(plan(), LOGS[:5], engine(cluster))
    assert isinstance(here, AuditOutcome)
    assert isinstance(there, AuditOutcome)
    assert [r for r in there.results if r.run != deadly.LOG] == [
        r for r in here.results if r.run != deadly.LOG
    ]
    (result,) = [r for r in there.results if r.run == deadly.LOG]
    assert result.verdict == "no data"
    assert result.hashes == here.results[3].hashes
    (finding,) = result.health.findings
    assert (finding.code, finding.message) == (
        "F419",
        f"the process that audited `{deadly.LOG}` was killed, and again when it ran alone: "
        "all Dask workers that tried it died",
    )


def test_a_scheduler_that_is_not_there_is_told(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dask_executor, "PATIENCE", 1)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"dask://127.0.0.1:{free.getsockname()[1]}"
    run = fretc("audit", *LOGS, "--engine", address)
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith(
        f"F910 the Dask cluster at `{address}` cannot be reached: no Dask scheduler answers\n"
    )
    assert not Path("build").exists()


@pytest.mark.slow
def test_a_scheduler_without_workers_is_told(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_executor, "PATIENCE", 1)
    with local_cluster(n_workers=0, dashboard_address="127.0.0.1:0", silence_logs=60) as empty:
        run = fretc(
            "audit", *LOGS, "--engine", empty.scheduler_address.replace("tcp", "dask")
        )  # fmt: skip
    assert run.status == 2
    assert run.err.splitlines()[0].endswith("cannot be reached: the scheduler has no worker")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["", "ray", "dask:", "dask://", "dask://host", "dask://h:x", "D"])
def test_an_engine_that_is_none_is_told(fretc: Fretc, name: str) -> None:
    run = fretc("audit", *LOGS, "--engine", name)
    assert (run.status, run.out) == (2, "")
    assert run.err == (
        f"F907 `{name}` is no engine\nhelp: write `local`, `dask` or `dask://HOST:PORT`\n"
    )


@pytest.mark.slow
def test_without_the_extra_the_line_that_installs_it_is_told(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda name: None)
    run = fretc("audit", *LOGS, "--engine", "dask")
    assert run.status == 2
    assert run.err.startswith(
        "F908 the engine `dask` needs `distributed` and `cryptography`\nhelp: install "
    )


@pytest.mark.slow
def test_a_cluster_of_its_own_is_stopped_and_goes_on(fretc: Fretc) -> None:
    logs = [f"long{number:02}.mcap" for number in range(12)]
    shutil.copy(MISSION, logs[0])
    for log in logs[1:]:
        os.link(logs[0], log)
    fretc("audit", *logs)
    evidence = content()
    shutil.rmtree("build")
    command = [sys.executable, "-c", "from fretc.cli import main; main()", "audit", *logs]
    run = subprocess.Popen(
        [*command, "--engine", "dask", "--jobs", "2" if FULL else "1"],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    deadline = time.monotonic() + LONG
    while written() < 16_000:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    os.killpg(run.pid, signal.SIGINT)  # as Ctrl-C does: all processes of the terminal
    _, errors = run.communicate(timeout=LONG)
    (count,) = re.findall(r"^stopped: (\d+) of 12 logs are saved; run the same command", errors)
    assert run.returncode == 130
    assert fretc("audit", *logs).err.startswith(f"{count} of 12 logs are unchanged")
    assert content() == evidence


@pytest.fixture(scope="module")
def own() -> Iterator[Any]:
    """A client of a cluster of its own."""
    with dask_executor._own_cluster(1) as client:
        yield client


@pytest.mark.slow
def test_nobody_else_on_the_machine_is_let_into_a_cluster_of_its_own(own: Any) -> None:
    """Who can connect can execute code as the one who audits."""
    from distributed import Client, Security

    address = own.scheduler.address
    assert address.startswith("tls://127.0.0.1:")
    plain = address.replace("tls", "tcp")
    for place, security in (
        (plain, None),
        (address, None),
        (address, Security.temporary()),
        (address, Security(require_encryption=True)),
    ):
        with pytest.raises((OSError, TypeError, ValueError, RuntimeError)):
            Client(place, security=security, timeout=3, set_as_default=False)
    assert own.submit(int, "7").result() == 7
    (worker,) = own.scheduler_info()["workers"]
    assert worker.startswith("tls://127.0.0.1:")


@pytest.mark.slow
def test_a_cluster_of_its_own_has_no_pages(own: Any) -> None:
    port = own.scheduler_info()["services"].get("dashboard")
    for path in ("/info/main/workers.html", "/json/counts.json", "/metrics", "/health"):
        with pytest.raises(OSError, match="404"):
            urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", timeout=LONG)
