from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

from hypothesis import given
from hypothesis import strategies as st

from fretc.report.front.groups import run_groups
from fretc.report.sections.runs import AuditedFile, run_names


@dataclass
class Facts:
    run: str
    labels: dict[str, str]


def named(paths: Sequence[str], labels: Sequence[dict[str, str]]) -> list[AuditedFile]:
    return [
        AuditedFile(n, cast(Any, Facts(path, label)), False, name=name)
        for n, (path, label, name) in enumerate(
            zip(paths, labels, run_names(paths), strict=True), 1
        )
    ]


def grouped(*paths: str, scenarios: list[str] | None = None) -> dict[str, list[str]]:
    """The short names of the runs of each group."""
    labels = [{"scenario": s} for s in scenarios] if scenarios else [{}] * len(paths)
    runs = named(paths, labels)
    return {group.name: [run.short for run in group.runs] for group in run_groups(runs)}


def test_runs_are_grouped_by_scenario_where_each_has_one() -> None:
    names = ("a/1.mcap", "b/2.mcap", "b/3.mcap")
    assert grouped(*names, scenarios=["walk", "stop", "walk"]) == {
        "walk": ["1", "3"],
        "stop": ["2"],
    }
    assert grouped(*names, scenarios=["walk", "", "walk"]) == {"a": ["1"], "b": ["2", "3"]}


def test_runs_of_several_folders_are_grouped_by_folder_without_the_place_of_the_machine() -> None:
    assert grouped("/home/x/logs/a/1.mcap", "/home/x/logs/b/1.mcap") == {"a": ["1"], "b": ["1"]}
    assert grouped("s3://store/n/a/1.mcap", "s3://store/n/2.mcap") == {"a": ["1"], ".": ["2"]}


def test_runs_with_a_number_at_the_end_of_their_names_are_grouped_by_the_rest() -> None:
    names = ("logs/safety-off-1.mcap", "logs/walker-1.mcap", "logs/safety-off-2.mcap")
    assert grouped(*names) == {"safety-off": ["1", "2"], "walker": ["1"]}


def test_other_names_are_no_groups_and_lose_what_all_of_them_begin_with() -> None:
    assert grouped("2026-11-21-10-03.bag", "2026-11-21-10-47.bag") == {"": ["03", "47"]}
    assert grouped("a1.mcap", "b1.mcap") == {"": ["a1", "b1"]}
    assert grouped("0001.mcap", "0002.mcap") == {"": ["0001", "0002"]}
    assert grouped("only.mcap") == {"": ["only"]}
    assert grouped() == {}


def test_runs_of_one_name_are_told_apart() -> None:
    assert grouped("a.mcap", "a.mcap") == {"": ["a (run 1)", "a (run 2)"]}


@given(st.lists(st.text(alphabet="ab1/-. \\", max_size=8), max_size=8))
def test_each_run_has_one_column_and_a_name_of_its_own(paths: list[str]) -> None:
    runs = named(paths, [{}] * len(paths))
    columns = [run for group in run_groups(runs) for run in group.runs]
    assert sorted(run.anchor for run in columns) == sorted(run.anchor for run in runs)
    assert len({run.name for run in columns}) == len(runs)
    assert all(run.short for run in columns)
