"""Runs in several files: one log, and nothing of it is lost in silence."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import yaml

from fretc.logs.reader import read
from fretc.logs.storage.folders import Folder, folder
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.fretc.logs.logs import (
    LZ4,
    MS,
    NONE,
    TWELVE,
    S,
    Sent,
    X,
    chunk_starts,
    damaged,
    number,
    recorded,
    refused,
    scan,
    times,
    values,
    write,
)

START = 1000 * S
PARTS = (TWELVE[:4], TWELVE[4:8], TWELVE[8:])
FIRST, LAST = START, START + 1100 * MS


def span(sent: Sequence[Sent]) -> dict[str, Any]:
    start = min((message.time for message in sent), default=0)
    end = max((message.time for message in sent), default=0)
    return {
        "starting_time": {"nanoseconds_since_epoch": start},
        "duration": {"nanoseconds": end - start},
        "message_count": len(sent),
    }


def describe(
    path: Path, parts: Sequence[Sequence[Sent]], *, files: bool = True, **more: Any
) -> None:
    """As rosbag2 does it."""
    names = [f"run_{i}.mcap" for i in range(len(parts))]
    about: dict[str, Any] = {
        "version": 5,
        "storage_identifier": "mcap",
        "relative_file_paths": names,
        "compression_format": "",
        "compression_mode": "",
        **span([message for part in parts for message in part]),
    }
    if files:
        about["files"] = [{"path": n, **span(p)} for n, p in zip(names, parts, strict=True)]
    text = yaml.safe_dump({"rosbag2_bagfile_information": {**about, **more}})
    (path / "metadata.yaml").write_text(text)


def run(tmp_path: Path, parts: Sequence[Sequence[Sent]] = PARTS, **how: Any) -> Path:
    path = tmp_path / "run"
    path.mkdir()
    for i, part in enumerate(parts):
        write(path / f"run_{i}.mcap", part, **how)
    describe(path, parts)
    return path


def test_the_files_of_a_run_are_one_log(tmp_path: Path) -> None:
    path = run(tmp_path)
    recording = recorded(path, X)
    whole = recorded(write(tmp_path / "whole.mcap", TWELVE), X)
    assert values(recording, "x") == values(whole, "x") == [i / 100 for i in range(12)]
    assert times(recording, "x") == times(whole, "x")
    assert (recording.start_ns, recording.end_ns) == (FIRST, LAST)
    assert recording.topics == whole.topics
    assert (recording.name, recording.findings, recording.intact) == (str(path), (), True)


def test_its_hash_is_that_of_what_sha256sum_prints_and_its_size_is_the_sum(tmp_path: Path) -> None:
    path = run(tmp_path)
    files = [path / f"run_{i}.mcap" for i in range(3)]
    lines = "".join(
        f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n" for file in files
    )
    recording = recorded(path, X)
    assert recording.sha256 == hashlib.sha256(lines.encode()).hexdigest()
    assert recording.size == sum(file.stat().st_size for file in files)


def test_files_come_in_the_order_of_the_description(tmp_path: Path) -> None:
    path = run(tmp_path)
    describe(path, PARTS, relative_file_paths=["run/run_1.mcap", "run/run_0.mcap", "run_2.mcap"])
    recording = recorded(path, X)
    assert values(recording, "x") == [i / 100 for i in range(12)]
    assert [finding.code for finding in recording.findings] == [Code.OUT_OF_ORDER]


def test_the_same_number_may_be_another_topic_in_another_file(tmp_path: Path) -> None:
    other = [scan([2.0], START + 500 * MS), number(0.5, START + 600 * MS)]
    recording = recorded(run(tmp_path, (TWELVE[:4], other)), X)
    assert values(recording, "x") == [0.0, 0.01, 0.02, 0.03, 0.5]
    assert recording.topics["/scan"].count == 1


@pytest.mark.parametrize(
    ("lost", "gap"),
    [
        (0, (FIRST, START + 400 * MS)),
        (1, (START + 300 * MS, START + 800 * MS)),
        (2, (START + 700 * MS, LAST)),
    ],
)
@pytest.mark.parametrize("how", ["absent", "empty", "text"])
def test_a_lost_file_is_a_gap_with_its_name(
    tmp_path: Path, lost: int, gap: tuple[int, int], how: str
) -> None:
    path = run(tmp_path)
    file = path / f"run_{lost}.mcap"
    file.unlink()
    if how != "absent":
        file.write_text("" if how == "empty" else "this is no log at all")
    recording = recorded(path, X)
    assert recording.gaps == (gap,)
    assert not recording.intact
    (finding,) = recording.findings
    assert finding.code is Code.LOST_PART
    assert finding.span is not None
    assert finding.span.source.name == str(file)
    assert "counts as unknown" in finding.message
    assert not finding.is_error
    assert (recording.start_ns, recording.end_ns) == (FIRST, LAST)


def test_a_lost_file_at_an_end_is_a_loss_even_where_no_time_is_stated(tmp_path: Path) -> None:
    path = run(tmp_path)
    (path / "run_2.mcap").unlink()
    describe(path, PARTS, files=False, starting_time=None)
    recording = recorded(path, X)
    assert recording.gaps == ((START + 700 * MS, START + 700 * MS),)
    assert not recording.intact


def test_a_file_that_breaks_off_has_lost_what_came_until_the_next_begins(tmp_path: Path) -> None:
    path = run(tmp_path, per_chunk=2)
    file = path / "run_1.mcap"
    data = file.read_bytes()
    file.write_bytes(data[: chunk_starts(file)[1] + 30])
    recording = recorded(path, X)
    assert values(recording, "x") == [i / 100 for i in range(12) if i not in (6, 7)]
    assert recording.gaps == ((START + 500 * MS, START + 800 * MS),)
    (finding,) = recording.findings
    assert finding.code is Code.TRUNCATED_LOG
    assert finding.span is not None
    assert finding.span.source.name == str(file)


def test_a_damaged_chunk_is_a_gap_in_its_own_file(tmp_path: Path) -> None:
    path = run(tmp_path, per_chunk=1, compression=NONE)
    damaged(path / "run_1.mcap", chunk_starts(path / "run_1.mcap")[1] + 90)
    recording = recorded(path, X)
    assert recording.gaps == ((START + 500 * MS, START + 500 * MS),)
    assert values(recording, "x") == [i / 100 for i in range(12) if i != 5]


def test_a_file_without_messages_is_no_loss(tmp_path: Path) -> None:
    recording = recorded(run(tmp_path, (TWELVE, [])), X)
    assert (recording.intact, recording.findings) == (True, ())


def test_fewer_messages_than_stated_are_a_loss_of_any_time(tmp_path: Path) -> None:
    path = run(tmp_path, compression=LZ4)
    write(path / "run_1.mcap", TWELVE[4:7])
    recording = recorded(path, X)
    assert recording.gaps == ((FIRST, LAST),)
    (finding,) = recording.findings
    assert finding.code is Code.COUNT_MISMATCH
    assert finding.message.startswith(
        "its metadata.yaml states 12 messages, but its files hold 11; what was recorded from"
    )


def test_more_messages_than_stated_are_told(tmp_path: Path) -> None:
    path = run(tmp_path)
    describe(path, PARTS, message_count=11)
    recording = recorded(path, X)
    assert (recording.gaps, recording.intact) == ((), False)


def test_a_run_of_which_nothing_is_left_is_refused(tmp_path: Path) -> None:
    path = run(tmp_path)
    for file in path.glob("*.mcap"):
        file.unlink()
    assert refused(path).code is Code.NO_SUCH_FILE


@pytest.mark.parametrize("mode", ["FILE", "message"])
def test_a_run_that_rosbag2_compressed_is_refused_with_the_fix(tmp_path: Path, mode: str) -> None:
    path = run(tmp_path)
    describe(path, PARTS, compression_mode=mode)
    diagnostic = refused(path)
    assert diagnostic.message == f"rosbag2 has compressed each {mode.lower()} of the run"
    assert "ros2 bag convert" in str(diagnostic.help)


@pytest.mark.parametrize(
    "text",
    [
        "", "{", "- 1", "rosbag2_bagfile_information: 3", "rosbag2_bagfile_information: {}", "\0",
        "rosbag2_bagfile_information: {relative_file_paths: [1]}",
        "rosbag2_bagfile_information: {relative_file_paths: [a.mcap, b/a.mcap]}",
        "rosbag2_bagfile_information: {relative_file_paths: ['..']}",
        'rosbag2_bagfile_information: {relative_file_paths: ["a\\0b"]}',
        "[" * 5000, "!!python/object/apply:os.system [exit]",
    ],
    ids=range(12),
)  # fmt: skip
def test_a_description_that_is_none_is_an_error(tmp_path: Path, text: str) -> None:
    (tmp_path / "metadata.yaml").write_text(text)
    found = folder(str(tmp_path))
    assert isinstance(found, Diagnostic)
    assert found.code is Code.SPLIT_LOG
    assert isinstance(read(str(tmp_path), X, ["x"]), Diagnostic)


def test_a_file_of_a_run_that_is_named_alone_is_told(tmp_path: Path) -> None:
    path = run(tmp_path)
    recording = recorded(path / "run_1.mcap", X)
    assert values(recording, "x") == [0.04, 0.05, 0.06, 0.07]
    (finding,) = recording.findings
    assert finding.message == "it is file 2 of 3 of one run, but judged alone"
    assert finding.help == f"name the folder `{path}`: its files are one log"
    assert recording.intact


def test_no_file_outside_of_the_folder_is_read(tmp_path: Path) -> None:
    describe(tmp_path, PARTS, relative_file_paths=["../../etc/a.mcap", "/b.mcap"])
    found = folder(str(tmp_path))
    assert isinstance(found, Folder)
    assert found.files == ("a.mcap", "b.mcap")
