"""Time and memory are measured and limited, also without what only Linux has."""

import signal
import sys
import threading
import time
from pathlib import Path

import pytest

from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.reading import limits
from fretish.reading.limits import with_budget
from fretish.system import resources
from fretish.system.resources import exceeded_time, periodically, resident_memory


def test_memory_is_what_the_process_has(monkeypatch: pytest.MonkeyPatch) -> None:
    before = resident_memory()
    held = bytes([1]) * (64 * 2**20)
    grown = resident_memory() - before
    assert 60 * 2**20 <= grown <= 70 * 2**20
    now = resident_memory()
    monkeypatch.setattr(resources, "_STATM", Path("there/is/none"))
    assert now * 0.99 <= resident_memory()  # the most that it ever had
    assert len(held) == 64 * 2**20


def test_memory_is_unknown_where_nothing_tells_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resources, "_STATM", Path("there/is/none"))
    monkeypatch.setitem(sys.modules, "resource", None)
    assert resident_memory() == 0


@pytest.mark.slow
def test_a_thread_interrupts_reading_where_there_is_no_timer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delattr(signal, "setitimer")
    monkeypatch.setattr(limits, "SECONDS", 0.2)
    before = signal.getsignal(signal.SIGABRT)
    threads = threading.active_count()

    def endless() -> int:
        while True:
            pass

    start = time.process_time()
    found = with_budget(10, Source("r.fret", "the sw").span(0, 0), endless)
    assert time.process_time() - start < 2
    assert isinstance(found, Diagnostic)
    assert found.code is Code.TOO_COSTLY
    assert with_budget(10, Source("r.fret", "").span(), lambda: 7) == 7
    assert (signal.getsignal(signal.SIGABRT), threading.active_count()) == (before, threads)


def test_the_exception_of_a_look_interrupts_the_block(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(signal, "setitimer")

    def look() -> None:
        raise KeyError

    def endless() -> None:
        with periodically(0.001, look):
            while True:
                time.sleep(0.001)

    with pytest.raises(KeyError):
        endless()


def failing_look() -> None:
    raise KeyError


def raised(number: int) -> None:
    """A block that a signal interrupts."""
    with periodically(60, failing_look):
        signal.raise_signal(number)


def test_a_late_signal_of_the_timer_calls_nothing() -> None:
    with periodically(60, failing_look):
        pass
    signal.raise_signal(signal.SIGPROF)
    with pytest.raises(KeyError):
        raised(signal.SIGPROF)
    signal.raise_signal(signal.SIGPROF)


def test_a_signal_while_the_thread_ends_interrupts_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def join(thread: threading.Thread) -> None:
        signal.raise_signal(signal.SIGABRT)
        whole_join(thread)

    whole_join = threading.Thread.join
    monkeypatch.delattr(signal, "setitimer")
    monkeypatch.setattr(threading.Thread, "join", join)
    threads, before = threading.active_count(), signal.getsignal(signal.SIGABRT)
    with pytest.raises(KeyError):
        raised(signal.SIGABRT)
    assert (signal.getsignal(signal.SIGABRT), threading.active_count()) == (before, threads)


def test_exit_statuses_tell_of_time() -> None:
    ends = {-signal.SIGXCPU, -signal.SIGPROF, resources.OUT_OF_TIME}
    assert {s for s in range(-64, 256) if exceeded_time(s)} == ends
