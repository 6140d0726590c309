"""Several processes share things; what is lost with one of them is one thing."""

import os
import signal
import threading
import time
from contextlib import closing
from multiprocessing import active_children
from pathlib import Path

import pytest

from fretc.audit.pool import Limits, TimedOut, WorkerDied, map_processes

pytestmark = pytest.mark.confined


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2, 5])
def test_each_thing_has_its_result_once(jobs: int) -> None:
    results = list(map_processes(lambda thing: thing * thing, range(40), jobs))
    assert sorted(results, key=lambda done: done[0]) == [(i, i * i) for i in range(40)]
    assert not active_children()


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 3])
def test_a_mistake_in_the_work_is_raised(jobs: int) -> None:
    with pytest.raises(ZeroDivisionError):
        list(map_processes(lambda thing: 1 // thing, [2, 1, 0, 3], jobs))
    assert not active_children()


def test_a_mistake_that_cannot_be_sent_is_raised_in_words() -> None:
    class LocalError(Exception):
        pass

    def work(thing: int) -> None:
        raise LocalError(f"of {thing}")

    with pytest.raises(RuntimeError, match=r"LocalError: of \d"):
        list(map_processes(work, [0, 1], 2))


def test_a_result_comes_when_it_is_done() -> None:
    def wait(seconds: float) -> float:
        time.sleep(seconds)
        return seconds

    assert [place for place, _ in map_processes(wait, [0.5, 0.0], 2)] == [1, 0]


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2, 3])
def test_a_thing_that_kills_its_process_twice_is_told_and_the_others_are_done(jobs: int) -> None:
    def work(thing: int) -> int:
        if thing == 3:
            os.kill(os.getpid(), signal.SIGKILL)
        return -thing

    results = dict(map_processes(work, range(8), jobs))
    assert results.pop(3) == WorkerDied(-signal.SIGKILL)
    assert results == {i: -i for i in range(8) if i != 3}
    assert not active_children()


def test_a_thing_whose_process_is_killed_once_is_done_the_second_time(tmp_path: Path) -> None:
    def work(thing: int) -> str:
        mark = tmp_path / "mark"
        if thing == 1 and not mark.exists():
            mark.touch()
            os._exit(7)
        return f"done {thing}"

    assert dict(map_processes(work, range(3), 2)) == {i: f"done {i}" for i in range(3)}


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 3])
def test_a_thing_that_takes_too_long_is_late_and_the_others_are_done(jobs: int) -> None:
    work = lambda thing: time.sleep(60 if thing % 3 == 1 else 0)  # noqa: E731
    results = dict(map_processes(work, range(6), jobs, Limits(each=0.3)))
    assert results == {0: None, 1: TimedOut.OWN, 2: None, 3: None, 4: TimedOut.OWN, 5: None}
    assert not active_children()


def test_when_the_time_of_all_is_over_each_that_is_not_done_is_late() -> None:
    work = lambda thing: time.sleep(60 if thing else 0)  # noqa: E731
    assert dict(map_processes(work, range(5), 1, Limits(all=0.5))) == {
        0: None,
        **dict.fromkeys(range(1, 5), TimedOut.ALL),
    }
    assert dict(map_processes(work, [0], 1, Limits(all=0.0))) == {0: TimedOut.ALL}
    assert not active_children()


@pytest.mark.slow
def test_a_thing_is_late_however_the_process_is_busy() -> None:
    def work(thing: int) -> None:
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM, signal.SIGALRM])
        while thing:
            pass

    assert dict(map_processes(work, [1], 1, Limits(each=0.3))) == {0: TimedOut.OWN}


def test_how_a_process_ended_is_told_in_words() -> None:
    assert (str(WorkerDied(-9)), str(WorkerDied(7))) == ("signal 9", "exit status 7")


@pytest.mark.slow
def test_a_result_that_is_larger_than_a_pipe_comes_whole() -> None:
    assert dict(map_processes(lambda thing: bytes(10**7 + thing), [0, 1], 2)) == {
        0: bytes(10**7),
        1: bytes(10**7 + 1),
    }


def test_closing_ends_the_work_at_once() -> None:
    with closing(map_processes(lambda thing: time.sleep(thing), [0, 60, 60], 2)) as results:
        assert next(results) == (0, None)
        start = time.monotonic()
    assert time.monotonic() - start < 10
    assert not active_children()


def test_a_process_that_dies_while_it_sends_a_result_costs_no_other_thing_its_result(
    tmp_path: Path,
) -> None:
    mark = tmp_path / "mark"

    def work(thing: int) -> bytes:
        if thing == 1 and not mark.exists():
            mark.touch()
            time.sleep(0.1)
            threading.Timer(0.2, os._exit, (7,)).start()
            return bytes(10**7)  # the pipe holds less than that: it is still being sent
        return bytes(thing)

    with closing(map_processes(work, range(4), 2)) as results:
        first = next(results)
        time.sleep(0.5)
        assert dict([first, *results]) == {i: bytes(i) for i in range(4)}
