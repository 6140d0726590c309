"""The environment of ROS 2 is made once, whole or not at all."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests import programs
from tests.ros2.real import environment


@pytest.fixture
def cache_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "fretc-tests"


def test_of_several_that_ask_at_once_one_makes_it(
    cache_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[Path] = []

    def fill(place: Path, packages: tuple[str, ...]) -> None:
        made.append(place)
        place.mkdir()
        (place / "packages").write_text(" ".join(packages))

    monkeypatch.setattr(environment, "_fill", fill)
    with ThreadPoolExecutor() as pool:
        found = {*pool.map(environment.install, ["jazzy"] * 4)}
    assert len(made) == len(found) == 1
    (kept,) = [each for each in cache_folder.iterdir() if each.is_dir()]
    assert found == {kept / "bin" / "python"}
    assert (kept / "packages").read_text().startswith("ros-jazzy-rclpy[fastrtps]==7.1.6 ")
    assert environment.folder("kilted") != kept


@pytest.mark.slow
def test_where_no_registry_answers_nothing_stays_behind(
    cache_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(cache_folder))
    with pytest.raises(environment.NotInstalledError, match="No matching distribution"):
        environment.install("jazzy")
    assert [each.suffix for each in cache_folder.iterdir()] == [".lock"]


def test_a_skip_says_what_installs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(programs, "_hidden", True)
    with pytest.raises(pytest.skip.Exception, match=r"pip install ros-jazzy-rclpy\[fastrtps\]"):
        environment.python("jazzy")
