"""Whatever a table is, a generated monitor judges it as it stands, or refuses it in one line."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.tables import HOSTILE, fuzzed, hold, monitor


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Callable[[list[str]], int]:
    return monitor(tmp_path_factory.mktemp("monitor"))


@pytest.mark.slow
@pytest.mark.parametrize("data", HOSTILE.values(), ids=HOSTILE)
def test_a_hostile_table_is_judged_as_it_stands_or_refused_in_one_line(
    run: Callable[[list[str]], int], tmp_path: Path, data: bytes
) -> None:
    hold(run, tmp_path / "t.csv", data)


@pytest.mark.slow
def test_mutated_tables_are_judged_as_they_stand_or_refused_in_one_line(tmp_path: Path) -> None:
    found = fuzzed(tmp_path, 300, 1)
    assert set(found) == {"satisfied", "violated", "no data", "refused"}
