"""What a reading takes from the one before it, and what is forgotten."""

import pytest

from fretish.reading.memory import Memory, remembered, remembered_by_value, same

calls: list[object] = []


@remembered
def doubled(value: list[int]) -> list[int]:
    calls.append(value)
    return [*value, *value]


@pytest.fixture(autouse=True)
def _no_calls() -> None:
    calls.clear()


def test_without_a_memory_every_call_computes() -> None:
    value = [1]
    assert doubled(value) == doubled(value) == [1, 1]
    assert len(calls) == 2


def test_a_reading_takes_the_result_of_the_one_before() -> None:
    memory, value = Memory(), [1]
    results = []
    for _ in range(3):
        with memory.active():
            results.append(doubled(value))
    assert len(calls) == 1
    assert results[0] is results[1] is results[2]


def test_equal_arguments_that_are_not_the_same_object_are_computed() -> None:
    memory = Memory()
    with memory.active():
        assert doubled([1]) == doubled([1])
    assert len(calls) == 2


def test_what_a_reading_does_not_use_is_forgotten() -> None:
    memory, value = Memory(), [1]
    for used in (True, False, True):
        with memory.active():
            if used:
                doubled(value)
    assert len(calls) == 2


def test_a_reading_that_was_stopped_forgets_nothing() -> None:
    memory, value = Memory(), [1]
    with memory.active():
        doubled(value)
    with pytest.raises(KeyboardInterrupt), memory.active():
        raise KeyboardInterrupt
    with memory.active():
        doubled(value)
    assert len(calls) == 1


def test_an_equal_value_is_the_object_of_the_reading_before() -> None:
    memory, first, second = Memory(), [1], [1]
    with memory.active():
        assert same(first, "a", 1) is first
    with memory.active():
        assert same(second, "a", 1) is first
        assert same(second, "a", 2) is second
    assert same(second, "a", 1) is second


@remembered_by_value
def length(value: str) -> int:
    calls.append(value)
    return len(value)


def test_equal_arguments_have_one_result_by_value() -> None:
    memory = Memory()
    with memory.active():
        length("ab")
    with memory.active():
        assert (length("".join(("a", "b"))), length("abc")) == (2, 3)
    assert calls == ["ab", "abc"]
    assert (length("ab"), len(calls)) == (2, 3)
