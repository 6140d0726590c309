"""Which logs are meant by files and folders."""

import os
from pathlib import Path

import pytest

from fretc.audit.log_paths import files_of, logs
from fretish.diagnostics.diagnostic import Diagnostic
from tests.command import write


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def make_files(*names: str) -> None:
    for name in names:
        write(name, "")


def code(*paths: str) -> str:
    diagnostic = logs(paths)
    assert isinstance(diagnostic, Diagnostic)
    return diagnostic.code.number


def test_a_folder_stands_for_the_logs_below_it_in_the_order_of_their_names() -> None:
    make_files("runs/b.mcap", "runs/a/2.mcap", "runs/a/1.mcap", "runs/notes.txt", "runs/c.mcap")
    assert logs(["runs"]) == ["runs/a/1.mcap", "runs/a/2.mcap", "runs/b.mcap", "runs/c.mcap"]


def test_a_log_comes_once_however_it_is_named() -> None:
    make_files("runs/a.mcap", "runs/b.mcap")
    assert logs(["runs/b.mcap", "./runs/b.mcap", "runs"]) == ["runs/b.mcap", "runs/a.mcap"]


def test_a_file_is_taken_as_it_is_there_or_not() -> None:
    assert logs(["no.mcap", ""]) == ["no.mcap", ""]


def test_a_bag_of_one_file_is_a_log_and_one_of_several_is_refused() -> None:
    make_files("one/metadata.yaml", "one/x_0.mcap")
    assert logs(["one"]) == ["one/x_0.mcap"]
    make_files("all/two/metadata.yaml", "all/two/x_0.mcap", "all/two/x_1.mcap")
    assert code("all") == "F413"


def test_a_folder_without_logs_is_told() -> None:
    make_files("empty/notes.txt")
    assert code("empty") == "F901"


def described(path: str, *names: str, mode: str = "") -> None:
    listed = "".join(f"  - {name}\n" for name in names)
    text = f"rosbag2_bagfile_information:\n  compression_mode: '{mode}'\n"
    write(f"{path}/metadata.yaml", f"{text}  relative_file_paths:\n{listed}")
    for name in names:
        write(f"{path}/{name}", "")


def test_a_run_in_several_files_is_one_log_and_what_it_does_not_list_another() -> None:
    described("all/run", "x_0.mcap", "x_1.mcap")
    make_files("all/run/x_2.mcap", "all/a.bag", "all/z.db3")
    assert logs(["all"]) == ["all/a.bag", "all/run", "all/run/x_2.mcap", "all/z.db3"]
    Path("all/run/x_1.mcap").unlink()
    assert logs(["all/run"]) == ["all/run", "all/run/x_2.mcap"]


def test_the_files_of_a_run_are_one_log_when_all_are_named() -> None:
    described("run", "x_0.mcap", "x_1.mcap")
    make_files("a.mcap", "b.mcap")
    assert logs(["a.mcap", "run/x_1.mcap", "b.mcap", "run/x_0.mcap"]) == [
        "a.mcap",
        "b.mcap",
        "run",
    ]
    assert logs(["run/x_1.mcap"]) == ["run/x_1.mcap"]
    assert logs(["run/*.mcap", "run"]) == ["run"]


def test_a_run_that_is_compressed_is_named_so_that_it_can_be_refused() -> None:
    described("run", "x_0.mcap.zstd", mode="FILE")
    assert logs(["run"]) == ["run"]


def test_a_pattern_stands_for_what_it_matches() -> None:
    make_files("runs/b.mcap", "runs/a/2.mcap", "runs/a/deep/1.mcap", "runs/a/n.txt")
    assert logs(["runs/**/*.mcap"]) == ["runs/a/2.mcap", "runs/a/deep/1.mcap", "runs/b.mcap"]
    assert logs(["runs/*"]) == ["runs/a/2.mcap", "runs/a/deep/1.mcap", "runs/b.mcap"]
    assert logs(["runs/?.mcap"]) == ["runs/b.mcap"]


def test_a_pattern_that_matches_nothing_is_told() -> None:
    assert code("runs/**/*.mcap") == "F901"


def test_a_name_that_looks_like_a_pattern_is_a_name() -> None:
    make_files("run[1].mcap")
    assert logs(["run[1].mcap"]) == ["run[1].mcap"]


def test_standard_input_and_urls_are_taken_as_they_are() -> None:
    named = ["-", "s3://bucket/run.mcap", "https://host/a.mcap?x=*"]
    assert logs([*named, "-"]) == named


def test_all_files_of_a_run_are_protected() -> None:
    described("run", "x_0.mcap", "x_1.mcap")
    assert sorted(files_of(["run", "-", "a.mcap"])) == [
        "-",
        "a.mcap",
        "run/metadata.yaml",
        "run/x_0.mcap",
        "run/x_1.mcap",
    ]


def test_links_that_lead_in_circles_are_not_followed() -> None:
    make_files("runs/a.mcap")
    Path("runs/again").symlink_to(Path("runs").resolve())
    assert logs(["runs"]) == ["runs/a.mcap"]


def test_a_folder_of_links_is_the_logs_that_they_lead_to() -> None:
    make_files("disk/one/a.mcap", "disk/b.mcap", "disk/z.txt")
    Path("runs").mkdir()
    Path("runs/day").symlink_to(Path("disk/one").resolve())
    Path("runs/b.mcap").symlink_to(Path("disk/b.mcap").resolve())
    Path("runs/same.mcap").symlink_to(Path("disk/b.mcap").resolve())
    Path("disk/one/up").symlink_to(Path("runs").resolve())
    assert logs(["runs"]) == ["runs/b.mcap", "runs/day/a.mcap"]


def test_a_link_to_a_folder_above_is_not_followed() -> None:
    make_files("a.mcap", "runs/day/b.mcap")
    Path("runs/all").symlink_to(Path.cwd())
    Path("runs/day/disk").symlink_to("/")
    assert logs(["runs"]) == ["runs/day/b.mcap"]


def test_a_link_to_a_log_that_is_not_there_is_not_passed_by() -> None:
    # As of data that was not fetched: the other logs alone would show too much.
    make_files("runs/a.mcap")
    Path("runs/b.mcap").symlink_to("nowhere")
    os.mkfifo("runs/c.mcap")
    assert logs(["runs"]) == ["runs/a.mcap", "runs/b.mcap", "runs/c.mcap"]
