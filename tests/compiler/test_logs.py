"""Which logs are meant by files and folders."""

from pathlib import Path

import pytest

from compiler.logs import logs
from fretish.diagnostic import Diagnostic
from tests.command import write


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def made(*names: str) -> None:
    for name in names:
        write(name, "")


def code(*paths: str) -> str:
    found = logs(paths)
    assert isinstance(found, Diagnostic)
    return found.code.number


def test_a_folder_stands_for_the_logs_below_it_in_the_order_of_their_names() -> None:
    made("runs/b.mcap", "runs/a/2.mcap", "runs/a/1.mcap", "runs/notes.txt", "runs/c.mcap")
    assert logs(["runs"]) == ["runs/a/1.mcap", "runs/a/2.mcap", "runs/b.mcap", "runs/c.mcap"]


def test_a_log_comes_once_however_it_is_named() -> None:
    made("runs/a.mcap", "runs/b.mcap")
    assert logs(["runs/b.mcap", "./runs/b.mcap", "runs"]) == ["runs/b.mcap", "runs/a.mcap"]


def test_a_file_is_taken_as_it_is_there_or_not() -> None:
    assert logs(["no.mcap", ""]) == ["no.mcap", ""]


def test_a_bag_of_one_file_is_a_log_and_one_of_several_is_refused() -> None:
    made("one/metadata.yaml", "one/x_0.mcap")
    assert logs(["one"]) == ["one/x_0.mcap"]
    made("all/two/metadata.yaml", "all/two/x_0.mcap", "all/two/x_1.mcap")
    assert code("all") == "F413"


def test_a_folder_without_logs_is_told() -> None:
    made("empty/notes.txt")
    assert code("empty") == "F901"


def test_links_that_lead_in_circles_are_not_followed() -> None:
    made("runs/a.mcap")
    Path("runs/again").symlink_to(Path("runs").resolve())
    assert logs(["runs"]) == ["runs/a.mcap"]
