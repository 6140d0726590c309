"""Audit on many machines with Dask: each log is a task, and its result counts exactly once.

The only module that imports dask. The workers need the fretc that asks them, exactly, and
must find the logs under the same names.
"""

from __future__ import annotations

import contextlib
import logging
import os
import secrets
import signal
import threading
from collections.abc import Generator, Iterator, Sequence
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from compiler.files.build_id import build_id
from compiler.files.processes import isolate_imports
from fretc.audit.many_logs import (
    Engine,
    LogAudits,
    LogResult,
    audit_log,
    results_of_killed_process,
)
from fretc.audit.plan import Plan, packed, unpacked
from fretish.diagnostics.diagnostic import Diagnostic, DiagnosticError
from fretish.diagnostics.extras import unless_installed
from fretish.diagnostics.messages import diagnostic

if TYPE_CHECKING:
    from distributed import Client, Future, WorkerPlugin

SCHEME = "dask"
PATIENCE = 10
"""Seconds to wait for a scheduler or a worker."""


def engine(name: str, jobs: int) -> Engine | Diagnostic:
    """The executor with a given name.

    Args:
        name: `dask`: a cluster of processes on this machine; `dask://HOST:PORT`: an existing
            scheduler.
        jobs: the number of processes on this machine.
    """
    url = urlsplit(name)
    if name != SCHEME and not (url.scheme == SCHEME and _is_address(url.netloc)):
        return diagnostic(
            "unknown_engine",
            name=name,
            help="write `local`, `dask` or `dask://HOST:PORT`",
        )
    encrypts = ["cryptography"] if name == SCHEME else []
    missing = unless_installed("the engine `dask` needs", ["distributed", *encrypts], "fleet")
    if missing is not None:
        return missing
    if name == SCHEME:
        return partial(_audit, lambda: _own_cluster(jobs))
    return partial(_audit, lambda: _cluster_at(f"tcp://{url.netloc}"))


def _is_address(netloc: str) -> bool:
    host, colon, port = netloc.rpartition(":")
    return bool(host and colon) and "@" not in host and port.isdecimal() and int(port) < 2**16


def _audit(connected: Any, plan: Plan, logs: Sequence[str]) -> LogAudits:
    """Audit the tasks with a client of the given context."""
    if not logs:
        return
    try:
        with connected() as client:
            yield from _tasks(client, plan, logs)
    except _FleetError as error:
        yield error.diagnostic


class _FleetError(DiagnosticError):
    """The Dask cluster cannot audit."""


# Clusters -------------------------------------------------------------------------------------


@contextlib.contextmanager
def _own_cluster(jobs: int) -> Iterator[Client]:
    """A cluster of processes of this machine, as long as the context lasts.

    Anyone who can send tasks to a worker executes code as its user, and sockets are open to all
    users of a machine: each end has to show the key of a certificate that is made for this audit
    and is never written. Of HTTP pages there are none.
    """
    from dask import config
    from distributed import Client, LocalCluster, Security

    isolate_imports()
    _be_quiet()
    with contextlib.ExitStack() as stack:
        # One death may be random; a log whose worker died twice is tried once more, alone.
        stack.enter_context(config.set({"distributed.scheduler.allowed-failures": 1, **_NO_PAGES}))
        with _deaf():
            cluster = LocalCluster(
                n_workers=jobs,
                threads_per_worker=1,
                memory_limit=0,  # the machine sets the limit, as without Dask
                dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL,
                security=Security.temporary(),
            )
        stack.enter_context(cluster)
        client = stack.enter_context(Client(cluster))
        client.register_plugin(_deaf_worker())
        yield client


_NO_PAGES: dict[str, list[str]] = {
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
}


@contextlib.contextmanager
def _cluster_at(address: str) -> Iterator[Client]:
    """The cluster of an existing scheduler with at least one worker."""
    from distributed import Client

    _be_quiet()
    try:
        client = Client(address, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise _FleetError(_unreachable(address, "no Dask scheduler answers")) from error
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            raise _FleetError(_unreachable(address, "the scheduler has no worker")) from error
        yield client


def _be_quiet() -> None:
    """Silence the log messages of Dask about dead workers and closed connections."""
    for name in ("distributed", "tornado", *logging.root.manager.loggerDict):
        if name.partition(".")[0] in ("distributed", "tornado"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)


@contextlib.contextmanager
def _deaf() -> Iterator[None]:
    """Ignore Ctrl-C in processes started within the context: the main process handles it."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _deaf_worker() -> WorkerPlugin:
    """Ignore Ctrl-C in workers that start later, to replace one that died."""
    from distributed import WorkerPlugin

    class Deaf(WorkerPlugin):  # type: ignore[misc]
        def setup(self, worker: object) -> None:
            signal.signal(signal.SIGINT, signal.SIG_IGN)

    return Deaf()


# Tasks ----------------------------------------------------------------------------------------


def _tasks(client: Client, plan: Plan, logs: Sequence[str]) -> LogAudits:
    """Run each log as a task; if its workers died, run it once more, alone."""
    # A task, not scattered data: Dask computes it again when all workers that have it are dead.
    remote_plan = client.submit(bytes, packed(plan), key=f"fretc-plan-{secrets.token_hex(8)}")
    again: list[str] = []
    with contextlib.closing(_results(client, remote_plan, logs)) as done:
        for log, result in done:
            if result is None:
                again.append(log)
            else:
                yield log, result
    for log in again:
        with contextlib.closing(_results(client, remote_plan, [log])) as done:
            for _, result in done:
                yield (
                    log,
                    result
                    or results_of_killed_process(plan, log, "all Dask workers that tried it died"),
                )


def _results(
    client: Client, plan: Future, logs: Sequence[str]
) -> Generator[tuple[str, LogResult | None], None, None]:
    """Logs as they are finished; None: the workers of the log died.

    Raises:
        _FleetError: the fleet is not able to.
    """
    from distributed import as_completed

    batch = f"fretc-audit-{secrets.token_hex(8)}"  # not shared with another audit
    waiting = {
        client.submit(_work, plan, log, os.getcwd(), build_id(), key=f"{batch}-{number}"): log
        for number, log in enumerate(logs)
    }
    try:
        for future in as_completed(list(waiting)):
            yield waiting.pop(future), _result(future)
    finally:
        with contextlib.suppress(Exception):
            client.cancel(list(waiting), force=True)


def _result(future: Future) -> LogResult | None:
    from distributed import KilledWorker

    if future.status == "finished":
        result = future.result()
        if isinstance(result, LogResult):
            return result
        raise _FleetError(_other_edition(f"the worker {result} has another version of fretc"))
    if future.status in ("lost", "pending"):  # its worker died before the result was fetched
        return None
    if future.status != "error":
        raise _FleetError(
            _unreachable(future.client.scheduler_info()["address"], "the connection was lost")
        )
    error = future.exception()
    if isinstance(error, KilledWorker):
        return None
    if isinstance(error, ImportError | AttributeError):
        raise _FleetError(_other_edition(f"a worker has no fretc, or another version: {error}"))
    assert error is not None
    raise error


_ALONE = threading.Lock()
"""A worker may have several threads, but a monitor has state and the current folder is shared."""


def _work(plan: bytes, log: str, folder: str, client_edition: str) -> LogResult | str:
    """Audit a log in a worker; the address of the worker if its version of fretc differs."""
    from distributed import get_worker

    if build_id() != client_edition:
        return str(get_worker().address)
    with _ALONE, _in(folder):
        return audit_log(_plan(plan), log)


@lru_cache(maxsize=4)
def _plan(data: bytes) -> Plan:
    return unpacked(data)


@contextlib.contextmanager
def _in(folder: str) -> Iterator[None]:
    """Change to the caller's folder, if it exists on this machine, so that log names stay valid."""
    try:
        before = os.getcwd()
    except OSError:  # the worker's folder was deleted
        before = "/"
    with contextlib.suppress(OSError):
        os.chdir(folder)
    try:
        yield
    finally:
        try:
            os.chdir(before)
        except OSError:
            os.chdir("/")


# Diagnostics ----------------------------------------------------------------------------------


def _unreachable(address: str, why: str) -> Diagnostic:
    return diagnostic("cluster_unreachable", address=address.replace("tcp", SCHEME, 1), why=why)


def _other_edition(what: str) -> Diagnostic:
    return diagnostic("other_edition", what=what)
