"""The files of a project, in an order in which people count."""

from pathlib import Path

import pytest

from compiler.project.paths import expanded_paths, requirement_files
from fretish.diagnostics.diagnostic import Diagnostic

NAMES = ["agv-1.fret", "agv-2.fret", "agv-10.fret"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in NAMES:
        (tmp_path / name).touch()
    return tmp_path


def test_a_folder_and_a_pattern_of_a_shell_give_one_order(folder: Path) -> None:
    assert requirement_files(".") == expanded_paths(["."]) == NAMES
    assert expanded_paths(sorted(NAMES)) == NAMES


def test_an_order_of_the_user_s_own_is_kept(folder: Path) -> None:
    assert expanded_paths(NAMES[::-1]) == NAMES[::-1]
    assert expanded_paths([NAMES[1], NAMES[0]]) == [NAMES[1], NAMES[0]]


def test_a_folder_that_is_missing_is_told_with_the_option(folder: Path) -> None:
    missing = requirement_files("requirements")
    assert isinstance(missing, Diagnostic)
    assert missing.help == (
        "name the folder of your requirements with `--requirements`, or create one: `fretc init`"
    )
