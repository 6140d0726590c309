"""Delay lines are compared by what enters and leaves them."""

from dataclasses import replace
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.verification.compiled import memory
from fretc.verification.compiled.delays import FreeLetter, FreeWindow
from fretc.verification.compiled.verifying import explored
from monitors.kernel.stepping import Window
from tests.compiled_monitors import TONGUES, Checker, Tongue
from tests.effort import FULL, some
from tests.monitoring import requirement
from tests.programs import installed

RINGED = (
    "only in m mode the sw shall after 3 ticks satisfy q",
    "only after m mode upon p the sw shall after 2 ticks satisfy q",  # takes five times as long
    "only before m mode whenever p the sw shall after 2 ticks satisfy q",
)
ticks = st.lists(st.tuples(st.booleans(), st.booleans()), max_size=40)


@given(st.integers(1, 6), st.integers(0, 4), ticks)
def test_a_free_window_with_the_bits_of_a_delay_line_is_a_window(
    lo: int, more: int, drawn: list[tuple[bool, bool]]
) -> None:
    window, free = Window(lo, lo + more), FreeWindow(lo, lo + more, guarded=True)
    written: list[bool] = []
    for tick, (guard, witness) in enumerate(drawn):
        free.oldest = written[tick - lo] if tick >= lo else False
        assert free.step(guard, witness) == window.step(guard, witness)
        written.append(free.written)


@given(st.integers(1, 6), st.integers(0, 4), st.lists(st.booleans(), max_size=40))
def test_so_is_one_without_a_guard(lo: int, more: int, drawn: list[bool]) -> None:
    window, free = Window(lo, lo + more), FreeWindow(lo, lo + more, guarded=False)
    for tick, witness in enumerate(drawn):
        free.oldest = drawn[tick - lo] if tick >= lo else False
        assert free.step(True, witness) == window.step(True, witness)


@pytest.fixture(scope="module")
def tongue(request: pytest.FixtureRequest) -> Tongue:
    found = TONGUES[request.param]
    installed(found.program)
    return found


@pytest.fixture(scope="module")
def checker(tongue: Tongue, tmp_path_factory: pytest.TempPathFactory) -> Checker:
    return Checker(tongue.language, tmp_path_factory.mktemp(tongue.name))


CASES = [*product(("c", "rust"), RINGED)] if FULL else [("c", RINGED[0]), ("rust", RINGED[2])]


@pytest.mark.slow
@pytest.mark.parametrize(("tongue", "sentence"), CASES, indirect=["tongue"])
def test_both_ways_prove_what_fretc_writes(tongue: Tongue, checker: Checker, sentence: str) -> None:
    one = requirement(sentence, "R1")
    checked, executable = checker.prepared(tongue.given(one), one)
    plan = checked.plan(one)
    assert plan.is_original
    details = [
        explored(one, executable, replace(plan, is_original=original), 10**6).detail
        for original in (True, False)
    ]
    assert ["for all contents of its delay lines" in detail for detail in details] == [True, False]
    assert all("those of the monitor in Python" in detail for detail in details)


@pytest.mark.slow
@pytest.mark.parametrize("tongue", some(["c", "rust"], 2), indirect=True)
def test_a_line_of_another_kind_proves_nothing(tongue: Tongue, checker: Checker) -> None:
    """A library whose lines are no such lines is compared with all of their bits."""
    one = requirement(RINGED[0], "R1")
    checked, executable = checker.prepared(tongue.given(one), one)
    approximation = memory.CompiledDelayed
    honest = approximation.step

    def length(self: memory.CompiledDelayed, ring: memory.RingOffsets) -> int:
        return 4

    def step(self: memory.CompiledDelayed, state: bytes, letter: FreeLetter) -> tuple[object, ...]:
        told = honest(self, state, letter)
        return (*told[:-1], None) if fault == "written" else (7, *told[1:])

    for fault in ("length", "written", "reading"):
        with pytest.MonkeyPatch.context() as patch:
            if fault == "length":
                patch.setattr(approximation, "_length", length)
            else:
                patch.setattr(approximation, "step", step)
            outcome = explored(one, executable, checked.plan(one), 10**6)
        assert "whatever its delay lines hold" not in outcome.detail, fault
        assert "also with unknown values" in outcome.detail, fault
        assert "delay" not in outcome.detail, fault


def test_every_bit_is_tried() -> None:
    """A window that only fires with a bit of the line is seen to fire."""
    fired = set()
    for oldest, guard, witness in product((False, True), repeat=3):
        free = FreeWindow(1, 1, guarded=True)
        free.oldest = oldest
        fired.add((oldest and guard, free.step(guard, witness)))
    assert fired == {(False, False), (True, True)}
