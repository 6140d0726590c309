from pathlib import Path

import pytest

from tests.each import each

seen: list[tuple[str, int]] = []


@each("word", ["a", "b"])
@each("number", [1, 2])
def test_every_case_is_tried(word: str, number: int, tmp_path: Path) -> None:
    assert tmp_path.is_dir()
    seen.append((word, number))
    assert seen == [("a", 1), ("a", 2), ("b", 1), ("b", 2)][: len(seen)]


def test_a_failure_names_its_case() -> None:
    @each("number", [3, 4, 1])
    def small(number: int) -> None:
        assert number < 4

    with pytest.raises(AssertionError) as caught:
        small()
    assert caught.value.__notes__ == ["where number is 4"]


def test_every_failure_is_reported() -> None:
    @each("number", [3, 4, 1, 5])
    def small(number: int) -> None:
        assert number < 4

    with pytest.raises(ExceptionGroup, match="2 of 4 cases") as caught:
        small()
    notes = [error.__notes__ for error in caught.value.exceptions]
    assert notes == [["where number is 4"], ["where number is 5"]]


def test_a_table_without_a_case_tests_nothing_and_is_a_mistake() -> None:
    with pytest.raises(AssertionError, match="no case"):
        each("number", [])
