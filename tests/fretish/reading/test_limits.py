"""Reading is ended where it takes more than anything of its size needs."""

import threading
import time

import pytest

from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.reading import limits
from fretish.reading.limits import ExceededError, StoppedError, budget, stoppable, with_budget

PLACE = Source("r.fret", "the sw").span(0, 0)


def endless() -> int:
    while True:
        pass


def growing() -> list[bytes]:
    kept: list[bytes] = []
    while True:
        kept.append(bytes([1]) * 2**20)


def test_what_is_read_within_its_limits_is_given() -> None:
    assert with_budget(10, PLACE, lambda: 7) == 7


@pytest.mark.slow
def test_reading_without_end_is_f930(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "SECONDS", 0.2)
    start = time.process_time()
    diagnostic = with_budget(10, PLACE, endless)
    assert time.process_time() - start < 2
    assert isinstance(diagnostic, Diagnostic)
    assert (diagnostic.code, diagnostic.span) == (Code.TOO_COSTLY, PLACE)
    assert diagnostic.message.startswith("reading it takes more than 0.2 CPU seconds")


def test_reading_that_takes_more_and_more_memory_is_f930(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "MEMORY", 40 * 2**20)
    diagnostic = with_budget(10, PLACE, growing)
    assert isinstance(diagnostic, Diagnostic)
    assert diagnostic.message.startswith("reading it takes more than 40 MiB of memory")


@pytest.mark.slow
def test_a_library_that_takes_every_exception_for_its_own_is_ended_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(limits, "SECONDS", 0.2)

    def careless() -> int:
        while True:
            try:
                endless()
            except Exception:
                continue

    assert isinstance(with_budget(10, PLACE, careless), Diagnostic)


@pytest.mark.slow
def test_what_is_larger_may_take_longer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "SECONDS", 0.1)

    def busy() -> str:
        start = time.process_time()
        while time.process_time() - start < 0.5:
            pass
        return "read"

    assert isinstance(with_budget(1_000, PLACE, busy), Diagnostic)
    assert with_budget(200_000, PLACE, busy) == "read"


@pytest.mark.slow
def test_a_budget_within_another_is_a_part_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "SECONDS", 0.2)

    def outer() -> object:
        return [with_budget(0, PLACE, endless) for _ in range(1000)]

    start = time.process_time()
    assert isinstance(with_budget(0, PLACE, outer), Diagnostic)
    assert time.process_time() - start < 2


@pytest.mark.slow
def test_nothing_is_ended_behind_a_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "SECONDS", 0.1)
    with budget(0):
        pass
    start = time.process_time()
    while time.process_time() - start < 0.4:
        pass


def test_a_thread_reads_without_a_budget() -> None:
    found: list[object] = []
    thread = threading.Thread(target=lambda: found.append(with_budget(10, PLACE, lambda: 7)))
    thread.start()
    thread.join()
    assert found == [7]


def test_the_error_is_no_exception_that_a_reader_might_catch() -> None:
    assert not issubclass(ExceededError, Exception)


@pytest.mark.slow
def test_a_block_is_stopped_when_its_result_is_not_wanted() -> None:
    asked: list[None] = []

    def stop() -> bool:
        asked.append(None)
        return len(asked) > 2

    with pytest.raises(StoppedError), stoppable(stop, 60):
        endless()
    assert len(asked) == 3
    assert with_budget(10, PLACE, lambda: 7) == 7, "and what comes later has its own limits"


@pytest.mark.slow
def test_a_block_that_may_be_stopped_has_a_limit() -> None:
    with pytest.raises(ExceededError), stoppable(lambda: False, 0.2):
        endless()
