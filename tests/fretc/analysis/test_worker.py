"""Questions in a process of their own: one that dies or hangs costs no other its answer."""

import mmap
import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence

import pytest

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.oxidd_engine import OxiddEngine
from fretc.analysis import analysis
from fretc.analysis.analysis import Finding, Job
from fretc.analysis.arena.budget import Budget
from fretc.analysis.findings import OpenQuestion
from fretc.analysis.worker import Interrupted, findings
from tests.effort import FULL
from tests.requirement_sets import ROLES, requirements


def job(name: str, do: Callable[[], None] = lambda: None) -> Job:
    """It finds its name; then it does something, and finds its name again."""

    def ask(known: Sequence[Finding]) -> Iterator[Finding]:
        yield OpenQuestion(name, f"{len(known)} before")
        do()
        yield OpenQuestion(name, "end")

    return Job(name, ask, lambda why: OpenQuestion(name, f"lost: {why}"))


def told(jobs: Sequence[Job]) -> list[tuple[str, str]]:
    return [(each.question, each.why) for each in findings(jobs, lambda words: None)]  # type: ignore[union-attr]


def hang() -> None:
    Budget(0.01)
    end = time.process_time() + 60
    while time.process_time() < end:
        pass


def test_a_process_that_dies_is_replaced() -> None:
    jobs = [job("a"), job("b", lambda: os._exit(6)), job("c")]
    assert told(jobs) == [
        ("a", "0 before"), ("a", "end"), ("b", "2 before"),
        ("b", "lost: it took more memory than 4 GiB, or failed (exit status 6)"),
        ("c", "4 before"), ("c", "end"),
    ]  # fmt: skip


def test_a_full_table_of_diagrams_loses_one_answer() -> None:
    def fill() -> None:
        there = OxiddEngine(nodes=2**10)
        function = there.true
        for bit in range(20):
            function = function & (there.variable(bit) ^ there.variable(100 + bit))

    assert told([job("a", fill), job("b")]) == [
        ("a", "0 before"),
        (
            "a",
            "lost: it took more memory than 4 GiB, or more decision diagrams than their table "
            "holds",
        ),
        ("b", "2 before"),
        ("b", "end"),
    ]


def test_a_large_parent_leaves_memory_to_the_question() -> None:
    """The table of an engine alone is 1.7 GiB of address space."""

    def start() -> None:
        OxiddEngine()

    private = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS
    with mmap.mmap(-1, 5 * 2**30, flags=private, prot=mmap.PROT_READ):
        assert told([job("a", start)])[-1] == ("a", "end")


def test_a_process_goes_on_with_the_diagrams_of_its_parent() -> None:
    one, other = bdd.variable(0), bdd.variable(1)
    function = one ^ other

    def go_on() -> None:
        assert bdd.exists(function & bdd.variable(2), bdd.cube([0])) == bdd.variable(2)
        assert bdd.ite(one, -other, other) == function

    assert told([job("a", go_on)])[-1] == ("a", "end")


@pytest.mark.slow
def test_a_question_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """A second after its time is over; by default a part of one."""
    if not FULL:
        timer = signal.setitimer
        monkeypatch.setattr(signal, "setitimer", lambda which, after: timer(which, after / 5))
    jobs = [job("a", hang), job("b")]
    assert told(jobs) == [
        ("a", "0 before"), ("a", "lost: it exceeded its time limit"),
        ("b", "2 before"), ("b", "end"),
    ]  # fmt: skip


def test_a_mistake_of_ours_is_one() -> None:
    def fail() -> None:
        raise AssertionError("ours")

    with pytest.raises(AssertionError, match="ours"):
        told([job("a", fail)])


def test_ctrl_c_keeps_what_is_known() -> None:
    parent, received = os.getpid(), multiprocessing.get_context("fork").Event()

    def interrupt() -> None:
        assert received.wait(60)
        os.kill(parent, signal.SIGINT)
        time.sleep(60)

    known: list[str] = []

    def ask() -> None:
        for finding in findings([job("a"), job("b", interrupt), job("c")], known.append):
            assert isinstance(finding, OpenQuestion)
            known.append(finding.why)
            if finding.why == "2 before":
                received.set()

    with pytest.raises(Interrupted):
        ask()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    stopped = "lost: stopped by Ctrl-C"
    assert known == ["a", "0 before", "end", "b", "2 before", stopped, stopped]


def test_a_question_without_enough_memory_stays_open(monkeypatch: pytest.MonkeyPatch) -> None:
    def ask(known: Sequence[Finding]) -> Iterator[Finding]:
        yield OpenQuestion("first", f"{len(known)} before")
        raise MemoryError

    lost = Job("a", ask, lambda why: OpenQuestion("a", why))
    monkeypatch.setattr(analysis, "jobs", lambda *_: [lost])
    found = analysis.analyze(requirements("the sw shall always satisfy x"), ROLES)
    assert found.open == (
        OpenQuestion("first", "0 before"),
        OpenQuestion(
            "a",
            "it took more memory than there is, or more decision diagrams than their table holds",
        ),
    )
