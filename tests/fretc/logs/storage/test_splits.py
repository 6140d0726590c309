"""Bags of ROS 1 that belong together: split runs, and bags that were reindexed."""

import hashlib
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from fretc.audit.log_paths import files_of, logs
from fretc.logs.reader import look, read
from fretc.logs.signals.samples import Recording
from fretc.logs.storage.splits import split
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.fretc.logs.logs import MS, S, Sent, X, codes, number, recorded, values
from tests.fretc.logs.storage.test_bags import bag
from tests.programs import DEBIANS_PATH, debians_python, installed, needs

SIX = [number(float(i), 1000 * S + i * 100 * MS, encoding="ros1") for i in range(6)]


def run(folder: Path, *parts: Sequence[Sent], first: int = 0) -> Path:
    folder.mkdir(exist_ok=True)
    for i, part in enumerate(parts, first):
        bag(folder / f"run_{i}.bag", list(part))
    return folder


def unclosed(path: Path) -> bytes:
    """A bag as it is when its recorder was killed: it has no index."""
    data = bytearray(path.read_bytes())
    at = data.index(b"index_pos=") + len(b"index_pos=")
    end = int.from_bytes(data[at : at + 8], "little")
    data[at : at + 8] = bytes(8)
    return bytes(data[:end])


def late(sent: Sequence[Sent], by: int) -> list[Sent]:
    return [Sent(s.topic, s.type, s.payload, s.time + by, encoding=s.encoding) for s in sent]


def test_the_files_of_a_split_bag_are_one_log(tmp_path: Path) -> None:
    folder = run(tmp_path / "runs", SIX[:2], SIX[2:4], SIX[4:])
    whole = str(folder / "run_*.bag")
    assert logs([str(folder)]) == [whole]
    assert logs([str(folder / f"run_{i}.bag") for i in range(3)]) == [whole]
    assert sorted(files_of([whole])) == [str(folder / f"run_{i}.bag") for i in range(3)]
    recording = recorded(Path(whole), X)
    assert values(recording, "x") == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert (recording.start_ns, recording.end_ns) == (SIX[0].time, SIX[5].time)
    assert (codes(recording), recording.intact) == (["F415"], True)
    names = [folder / f"run_{i}.bag" for i in range(3)]
    lines = "".join(f"{hashlib.sha256(p.read_bytes()).hexdigest()}  {p.name}\n" for p in names)
    assert recording.sha256 == hashlib.sha256(lines.encode()).hexdigest()


def test_files_come_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    """The recorder may delete the first ones (`--max-splits`); ten comes behind nine."""
    parts = [SIX[i : i + 1] for i in range(6)]
    folder = run(tmp_path / "runs", *parts, first=7)
    assert values(recorded(folder / "run_*.bag", X), "x") == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]


@pytest.mark.parametrize("by", [2 * S, -200 * MS - S])
def test_numbered_runs_that_do_not_follow_each_other_are_runs_of_their_own(
    tmp_path: Path, by: int
) -> None:
    folder = run(tmp_path / "runs", SIX[:3], late(SIX[3:], by))
    names = [str(folder / f"run_{i}.bag") for i in range(2)]
    assert logs([str(folder)]) == names
    assert split(names[0]) is None
    assert codes(recorded(Path(names[0]), X)) == ["F415"]


def test_a_missing_number_keeps_the_files_apart(tmp_path: Path) -> None:
    folder = run(tmp_path / "runs", SIX[:2], SIX[2:4], SIX[4:])
    (folder / "run_1.bag").unlink()
    assert logs([str(folder)]) == [str(folder / "run_0.bag"), str(folder / "run_2.bag")]


def test_one_file_of_a_run_that_is_named_alone_is_told(tmp_path: Path) -> None:
    folder = run(tmp_path / "runs", SIX[:2], SIX[2:])
    recording = recorded(folder / "run_1.bag", X)
    assert codes(recording) == ["F415", "F413"]
    finding = recording.findings[1]
    assert finding.message == "it is file 2 of 2 of one run, but judged alone"
    assert finding.help == f"name '{folder}/run_*.bag': its files are one log"


def test_the_file_that_was_not_closed_is_a_loss_of_its_run(tmp_path: Path) -> None:
    folder = run(tmp_path / "runs", SIX[:2], SIX[2:4], SIX[4:])
    (folder / "run_2.bag.active").write_bytes(unclosed(folder / "run_2.bag"))
    (folder / "run_2.bag").unlink()
    assert logs([str(folder)]) == [str(folder / "run_*.bag")]
    recording = recorded(folder / "run_*.bag", X)
    assert values(recording, "x") == [0.0, 1.0, 2.0, 3.0]
    assert (codes(recording), recording.intact) == (["F414", "F415"], False)
    assert recording.gaps == ((SIX[3].time, SIX[3].time),)


def test_a_bag_that_was_not_closed_is_a_log_that_cannot_be_read(tmp_path: Path) -> None:
    bag(tmp_path / "a.bag", SIX)
    active = tmp_path / "b.bag.active"
    active.write_bytes(unclosed(tmp_path / "a.bag"))
    assert logs([str(tmp_path)]) == [str(tmp_path / "a.bag"), str(active)]
    found = read(str(active), X, ["x"])
    assert isinstance(found, Diagnostic)
    assert found.code is Code.UNREADABLE_LOG
    assert found.help is not None
    assert "`rosbag reindex`, which loses the chunk that was being written" in found.help


@pytest.mark.parametrize(
    ("name", "backup"),
    [
        ("a.bag", "a.orig.bag"),
        ("a.bag", "a.bag.orig.active"),
        ("a.bag.active", "a.bag.orig.active"),
    ],
)
def test_a_bag_that_was_reindexed_has_lost_its_end(tmp_path: Path, name: str, backup: str) -> None:
    made = bag(tmp_path / name, SIX)
    assert recorded(made, X).intact
    (tmp_path / backup).write_bytes(unclosed(made))
    assert logs([str(tmp_path)]) == [str(made)]
    recording = recorded(made, X)
    assert (codes(recording), recording.intact) == (["F422", "F415"], False)
    assert recording.gaps == ((SIX[5].time, SIX[5].time),)
    assert recording.findings[0].message == (
        "the bag was reindexed: the chunk that was being written when the recording stopped is "
        f"missing (`{backup}` is beside it): complete messages end after 0.5 s; what follows is "
        "unknown"
    )


def test_a_bag_that_was_whole_before_it_was_reindexed_has_lost_nothing(tmp_path: Path) -> None:
    made = bag(tmp_path / "a.bag", SIX)
    (tmp_path / "a.orig.bag").write_bytes(made.read_bytes())
    assert (codes(recorded(made, X)), logs([str(tmp_path)])) == (["F415"], [str(made)])


@pytest.mark.parametrize("name", ["a.orig.bag", "a.bag.orig.active"])
def test_a_backup_without_the_bag_that_was_made_of_it_is_no_backup(
    tmp_path: Path, name: str
) -> None:
    alone = bag(tmp_path / name, SIX)
    assert logs([str(tmp_path)]) == [str(alone)]


_ROS = """
import os, rosbag, rospy
from std_msgs.msg import Float64
bag = rosbag.Bag("x.bag.active", "w", chunk_threshold=2000)
for i in range(300):
    bag.write("/x", Float64(i / 10), rospy.Time(1000 + i * 0.1))
bag._file.flush()
os._exit(9)
"""


@pytest.mark.slow
@needs("rosbag")
def test_what_ros_itself_reindexes_is_known_as_that(tmp_path: Path) -> None:
    python = debians_python("rosbag", "std_msgs.msg")
    environment = {"PATH": DEBIANS_PATH, "HOME": str(tmp_path)}
    subprocess.run([python, "-c", _ROS], cwd=tmp_path, env=environment, check=False)
    assert isinstance(look(str(tmp_path / "x.bag.active")), Diagnostic)
    subprocess.run([installed("rosbag"), "reindex", "-q", "x.bag.active"], cwd=tmp_path, check=True)
    found = read(str(tmp_path / "x.bag.active"), X, ["x"])
    assert isinstance(found, Recording)
    assert 0 < len(found.samples["x"].values) < 300
    assert np.array_equal(found.samples["x"].values, np.arange(len(found.samples["x"].values)) / 10)
    assert (codes(found), found.intact) == (["F422", "F415"], False)


@pytest.mark.parametrize("name", ["run_01.bag", "run_1.bag.active", "run_00.bag"])
def test_of_two_files_with_one_number_none_is_passed_by(tmp_path: Path, name: str) -> None:
    folder = run(tmp_path / "runs", SIX[:2], SIX[2:4], SIX[4:])
    shutil.copy(bag(tmp_path / "other.bag", SIX[2:4]), folder / name)
    names = {*(f"run_{i}.bag" for i in range(3)), name}
    found = logs([str(folder)])
    assert not isinstance(found, Diagnostic)
    assert sorted(Path(log).name for log in found) == sorted(names)
