"""Bags as rosbags writes them, compared with MCAP files of the same messages."""

import sqlite3
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.convert import convert
from rosbags.interfaces import MessageDefinition, MessageDefinitionFormat
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2

from fretc.logs.reader import Overview, look, read
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code
from tests.effort import LOGS, needs_logs, some
from tests.fretc.logs.logs import (
    MS,
    SCAN,
    X_TEXT,
    S,
    Sent,
    X,
    declare,
    definition,
    number,
    recorded,
    refused,
    scan,
    store,
    times,
    values,
    write,
)
from tests.fretc.logs.messages.test_decoding import bindings

NOTE = (
    "a bag has no check sums, and one time for each message: a changed byte within a message "
    "is not detected, and publish_time is log_time"
)


def bag(path: Path, sent: list[Sent], *, lines: int = 2**20) -> Path:
    """A ROS 1 bag; a chunk is closed after so many bytes."""
    with Writer1(path) as writer:
        writer.chunk_threshold = lines
        known: dict[str, object] = {}
        for message in sent:
            if message.topic not in known:
                name = message.type.replace("/", "/msg/")
                text = definition(message.type, "ros1").decode()
                known[message.topic] = writer.add_connection(
                    message.topic, name, msgdef=text, md5sum="*"
                )
            writer.write(known[message.topic], message.time, message.payload)  # type: ignore[arg-type]
    return path


def db3(path: Path, sent: list[Sent], *, definitions: bool = True) -> Path:
    """The one file of a folder of rosbag2."""
    with Writer2(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        known: dict[str, object] = {}
        for message in sent:
            if message.topic not in known:
                known[message.topic] = writer.add_connection(
                    message.topic, message.type, typestore=store("cdr")
                )
            writer.write(known[message.topic], message.time, message.payload)  # type: ignore[arg-type]
    file = path / f"{path.name}.db3"
    if not definitions:
        with sqlite3.connect(file) as database:
            database.execute("DELETE FROM message_definitions")
        database.close()
    return file


def ros1(count: int = 12) -> list[Sent]:
    return [number(i / 100, 1000 * S + i * 100 * MS, encoding="ros1") for i in range(count)]


def ros2(count: int = 12) -> list[Sent]:
    return [number(i / 100, 1000 * S + i * 100 * MS) for i in range(count)]


def same(one: Recording, other: Recording) -> None:
    """Both hold the same columns, but for the hashes of the files."""
    assert (one.start_ns, one.end_ns, one.nearest) == (other.start_ns, other.end_ns, other.nearest)
    assert one.samples.keys() == other.samples.keys()
    for name, samples in one.samples.items():
        assert len(samples.times)
        np.testing.assert_array_equal(samples.times, other.samples[name].times)
        np.testing.assert_array_equal(samples.values, other.samples[name].values)


@pytest.mark.parametrize("write_bag", [bag, db3])
def test_a_bag_gives_what_the_same_messages_give_in_mcap(
    tmp_path: Path, write_bag: Callable[[Path, list[Sent]], Path]
) -> None:
    encoding = "ros1" if write_bag is bag else "cdr"
    sent = [
        scan([5.0, 1 + i / 8, 0.01], S + i * 100 * MS, encoding=encoding) for i in range(50)
    ] + [number(3.0, 2 * S, encoding=encoding)]
    sent.sort(key=lambda message: message.time)
    file = write_bag(tmp_path / ("log.bag" if write_bag is bag else "log"), sent)
    whole = recorded(write(tmp_path / "log.mcap", sent), declare(SCAN))
    recording = recorded(file, declare(SCAN))
    same(recording, whole)
    assert values(recording, "nearest") == [min(5.0, 1 + i / 8) for i in range(50)]
    assert recording.topics["/x"].count == 1
    assert recording.intact
    assert [(f.code, f.message) for f in recording.findings] == [(Code.BAG_FORMAT, NOTE)]


@pytest.mark.parametrize("write_bag", [bag, db3])
def test_a_stamp_of_the_header_is_read(
    tmp_path: Path, write_bag: Callable[[Path, list[Sent]], Path]
) -> None:
    encoding = "ros1" if write_bag is bag else "cdr"
    sent = [scan([1.0], S, stamp=7 * S + 5, encoding=encoding)]
    file = write_bag(tmp_path / ("log.bag" if write_bag is bag else "log"), sent)
    declarations = declare(SCAN.replace("log_time", "header.stamp"))
    assert times(recorded(file, declarations), "nearest") == [7 * S + 5]


def test_info_lists_topics_and_fields(tmp_path: Path) -> None:
    for file in (bag(tmp_path / "log.bag", ros1()), db3(tmp_path / "log", ros2())):
        overview = look(str(file))
        assert isinstance(overview, Overview)
        assert overview.numbers == {"/x": ("data",)}
        assert overview.recording.topics["/x"].count == 12


def test_a_bag_that_is_cut_is_refused(tmp_path: Path) -> None:
    file = bag(tmp_path / "log.bag", ros1(200), lines=500)
    data = file.read_bytes()
    for cut in (len(data) // 2, len(data) - 10, 5000, 20, 13):
        file.write_bytes(data[:cut])
        assert refused(file).code is Code.UNREADABLE_LOG, cut


@pytest.mark.slow
def test_every_cut_of_a_small_bag_gives_a_code_and_never_a_fault(tmp_path: Path) -> None:
    file = bag(tmp_path / "log.bag", ros1(3), lines=100)
    data = file.read_bytes()
    for cut in some(range(13, len(data), 7), 4):
        file.write_bytes(data[:cut])
        assert refused(file).code is Code.UNREADABLE_LOG


def test_a_bag_that_is_damaged_within_is_read_up_to_there(tmp_path: Path) -> None:
    file = bag(tmp_path / "log.bag", ros1(200), lines=500)
    data = bytearray(file.read_bytes())
    at = data.index(b"op=\x02", len(data) // 2)
    data[at + 3] = 9
    file.write_bytes(data)
    recording = recorded(file, X)
    assert 0 < len(values(recording, "x")) < 200
    assert not recording.intact
    ((start, end),) = recording.gaps
    assert (start, end) == (int(recording.samples["x"].times[-1]), 1000 * S + 199 * 100 * MS)
    assert recording.findings[0].code is Code.DAMAGED_CHUNK


@pytest.mark.slow
@pytest.mark.parametrize("seed", some(range(60), 6))
def test_a_changed_byte_anywhere_never_passes_for_a_fault(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    for path in (bag(tmp_path / "log.bag", ros1(20), lines=300), db3(tmp_path / "log", ros2(20))):
        data = bytearray(path.read_bytes())
        for at in random.integers(0, len(data), 3):
            data[at] ^= int(random.integers(1, 256))
        path.write_bytes(data)
        look(str(path))


def test_a_database_that_is_cut_is_never_intact(tmp_path: Path) -> None:
    file = db3(tmp_path / "log", ros2(2000))
    data = file.read_bytes()
    for cut in (len(data) // 2, len(data) - 4096, 4096, 100, 20):
        file.write_bytes(data[:cut])
        found = look(str(file))
        assert not isinstance(found, Overview) or not found.recording.intact, cut


def test_messages_that_the_index_of_a_database_hides_are_a_loss(tmp_path: Path) -> None:
    file = db3(tmp_path / "log", ros2())
    database = sqlite3.connect(file)
    database.execute("DELETE FROM topics")
    database.commit()
    database.close()
    assert refused(file).code is Code.UNREADABLE_LOG


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        "UPDATE messages SET timestamp = 'then'", "UPDATE messages SET timestamp = 1.5",
        "UPDATE messages SET timestamp = -5", "UPDATE messages SET timestamp = 9223372036854775807",
        "UPDATE messages SET data = 'text' WHERE id = 3", "UPDATE messages SET topic_id = 9",
        "UPDATE topics SET name = x'00ff'", "UPDATE topics SET type = 7",
        "UPDATE topics SET serialization_format = x'00'",
        "UPDATE message_definitions SET encoding = 1", "DELETE FROM messages",
        "UPDATE message_definitions SET encoded_message_definition = x'ff'", "DROP TABLE topics",
    ],
    ids=range(13),
)  # fmt: skip
def test_a_database_of_other_contents_never_passes_for_a_bag(tmp_path: Path, change: str) -> None:
    file = db3(tmp_path / "log", ros2())
    database = sqlite3.connect(file)
    database.execute(change)
    database.commit()
    database.close()
    found = read(str(file), X, ["x"])
    if isinstance(found, Recording):
        assert not found.intact or any(finding.is_error for finding in found.findings)


def test_messages_that_are_still_beside_a_database_are_a_loss(tmp_path: Path) -> None:
    file = db3(tmp_path / "log", ros2())
    Path(f"{file}-wal").write_bytes(b"any")
    recording = recorded(file, X)
    assert not recording.intact
    assert recording.gaps == ((recording.start_ns, recording.end_ns),)
    assert recording.findings[0].message.startswith(
        "`log.db3-wal` beside it holds messages that are not in it yet"
    )


def test_types_that_a_bag_does_not_define_are_those_of_every_release(tmp_path: Path) -> None:
    recording = recorded(db3(tmp_path / "log", ros2(), definitions=False), X)
    assert values(recording, "x") == [i / 100 for i in range(12)]
    (finding,) = recording.findings
    assert finding.code is Code.BAG_FORMAT
    assert "are used for std_msgs/Float64" in finding.message


def test_a_type_that_has_changed_between_releases_is_not_guessed(tmp_path: Path) -> None:
    sent = [Sent("/x", "sensor_msgs/msg/Range", b"\0\1\0\0" + b"\0" * 40, S)]
    text = X_TEXT.replace("/x.data", "/x.range")
    recording = recorded(db3(tmp_path / "log", sent, definitions=False), declare(text))
    assert recording.findings[0].code is Code.UNKNOWN_ENCODING
    assert "its messages have no definition" in recording.findings[0].message


def test_the_path_of_a_database_may_hold_any_character(tmp_path: Path) -> None:
    file = db3(tmp_path / "log", ros2())
    odd = tmp_path / "a ?b#c%20.db3"
    odd.write_bytes(file.read_bytes())
    assert len(values(recorded(odd, X), "x")) == 12


def test_a_bag_without_messages_holds_none(tmp_path: Path) -> None:
    assert refused(bag(tmp_path / "log.bag", [])).code is Code.EMPTY_LOG


def test_without_rosbags_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    file = bag(tmp_path / "log.bag", ros1())
    monkeypatch.setitem(sys.modules, "rosbags", None)
    diagnostic = refused(file)
    assert diagnostic.code is Code.MISSING_EXTRA
    assert "fretc[bags]" in str(diagnostic.help)


@needs_logs
@pytest.mark.parametrize(
    ("name", "signals"),
    [
        ("scan_tools_hokuyo_ros1", {"r": "/scan.ranges[:]", "a": "/scan.angle_min"}),
        (
            "ros_amr_interop_turtlebot3_ros1",
            {"v": "/velocity.twist.linear.x", "w": "/velocity.twist.angular.z"},
        ),
        ("turtlesim_ros1", {"v": "/turtle1/cmd_vel.linear.x", "x": "/turtle1/pose.x"}),
    ],
)
def test_a_real_ros_1_log_as_a_bag_gives_the_same_columns(
    tmp_path: Path, name: str, signals: dict[str, str]
) -> None:
    source, target = LOGS / f"{name}.mcap", tmp_path / "log.bag"
    with Writer1(target) as writer, source.open("rb") as stream:
        known: dict[int, object] = {}
        for schema, channel, message in make_reader(stream).iter_messages(log_time_order=False):
            assert schema is not None
            if channel.id not in known:
                known[channel.id] = writer.add_connection(
                    channel.topic,
                    schema.name.replace("/", "/msg/"),
                    msgdef=schema.data.decode(),
                    md5sum="*",
                    callerid=str(channel.id),
                )
            writer.write(known[channel.id], message.log_time, message.data)  # type: ignore[arg-type]
    declarations = declare(bindings(signals))
    same(recorded(target, declarations), recorded(source, declarations))


@needs_logs
def test_a_real_ros_2_log_converted_by_rosbags_gives_the_same_columns(tmp_path: Path) -> None:
    source = LOGS / "cougars_auv_ros2.mcap"
    convert([source], tmp_path / "log", "sqlite3", 9, None, "file", None, None, (), (), (), ())
    signals = {
        "depth": "/coug2/depth_data.pose.pose.position.z",
        "volts": "/coug2/battery/data.voltage",
        "fin": "/coug2/controls/command.fin[:]",
    }
    declarations = declare(bindings(signals))
    same(recorded(tmp_path / "log/log.db3", declarations), recorded(source, declarations))


def test_a_run_of_several_databases_is_one_log(tmp_path: Path) -> None:
    path = tmp_path / "run"
    path.mkdir()
    for i, sent in enumerate((ros2()[:6], ros2()[6:])):
        db3(tmp_path / str(i), sent).rename(path / f"run_{i}.db3")
    (path / "metadata.yaml").write_text(
        "rosbag2_bagfile_information: {relative_file_paths: [run_0.db3, run_1.db3], "
        "message_count: 12}"
    )
    recording = recorded(path, X)
    assert values(recording, "x") == [i / 100 for i in range(12)]
    assert [finding.code for finding in recording.findings] == [Code.BAG_FORMAT]
    assert recording.intact


def test_a_definition_may_be_in_idl(tmp_path: Path) -> None:
    text = "module std_msgs { module msg { struct Float64 { double data; }; }; };"
    path = tmp_path / "log"
    with Writer2(path, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection(
            "/x",
            "std_msgs/msg/Float64",
            msgdef=MessageDefinition(MessageDefinitionFormat.IDL, text).data,
            rihs01="x",
        )
        writer.write(connection, S, number(1.5, S).payload)
    database = sqlite3.connect(path / "log.db3")
    database.execute("UPDATE message_definitions SET encoding = 'ros2idl'")
    database.commit()
    database.close()
    assert values(recorded(path / "log.db3", X), "x") == [1.5]
