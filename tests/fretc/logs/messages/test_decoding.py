from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.records import Channel, Schema
from mcap_ros1.decoder import DecoderFactory as Ros1Decoders
from mcap_ros2.decoder import DecoderFactory as Ros2Decoders

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages.decoding import decoder, stamp
from fretc.logs.reader import look
from fretish.bindings.declarations import short_type
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.effort import LOGS, needs_logs
from tests.fretc.logs.logs import (
    SCAN,
    S,
    Sent,
    X,
    declare,
    number,
    recorded,
    scan,
    times,
    values,
    write,
)


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_a_scan_of_either_ros_gives_its_least_valid_range_and_the_least_it_can_report(
    tmp_path: Path, encoding: str
) -> None:
    sent = [scan([5.0, 0.5, 0.01, float("nan")], S, encoding=encoding, range_min=0.25)]
    recording = recorded(write(tmp_path / "log.mcap", sent), declare(SCAN))
    assert values(recording, "nearest") == [0.5]
    assert recording.nearest == {"nearest": 0.25}


def test_an_encoding_that_cannot_be_read_is_an_error(tmp_path: Path) -> None:
    sent = [Sent("/x", "X", b"\xa1", 5, encoding="cbor")]
    recording = recorded(write(tmp_path / "log.mcap", sent), X)
    (finding,) = recording.findings
    assert finding.code is Code.UNKNOWN_ENCODING
    assert finding.message == (
        "`/x` cannot be read: its messages are encoded as `cbor`, defined in `jsonschema`"
    )


def test_a_message_definition_is_never_run_as_a_program(tmp_path: Path) -> None:
    mark = tmp_path / "ran"
    evil = f"float64 data\nint32 A;open({str(mark)!r},'w');B=5\n".encode()
    sent = [number(1.5, 5, encoding="ros1")]
    path = write(tmp_path / "log.mcap", sent, definitions={"std_msgs/Float64": evil})
    recording = recorded(path, X)
    assert not mark.exists()
    assert values(recording, "x") == [1.5]  # the constant is left out


def test_a_definition_that_is_no_definition_is_an_error_and_prints_nothing(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    for encoding in ("cdr", "ros1"):
        message = number(1.5, 5, encoding=encoding)
        path = write(tmp_path / "log.mcap", [message], definitions={message.type: b"?! data"})
        (finding,) = recorded(path, X).findings
        assert finding.code is Code.UNKNOWN_ENCODING
    assert capfd.readouterr() == ("", "")


# Logs that others recorded


def decoded(path: Path, topic: str) -> list[tuple[int, Any]]:
    """Log times and messages, by the official reader and decoders."""
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[Ros1Decoders(), Ros2Decoders()])
        return [(m.log_time, d) for _, _, m, d in reader.iter_decoded_messages(topics=[topic])]


def bindings(signals: dict[str, str]) -> str:
    return '[clock]\ntick = "100 ms"\n' + "".join(
        f'[signal.{name}]\npath = "{path}"\ninvalid = {{ nan = "drop" }}\n'
        + ('reduce = "min"\n' if path.endswith("[:]") else "")
        for name, path in signals.items()
    )


@needs_logs
def test_a_real_turtlebot_log_agrees_with_the_official_decoder() -> None:
    path = LOGS / "ros_amr_interop_turtlebot3_ros1.mcap"
    text = bindings({"v": "/velocity.twist.linear.x", "w": "/velocity.twist.angular.z"})
    recording = recorded(path, declare(text))
    official = decoded(path, "/velocity")
    assert len(official) == 5270
    assert values(recording, "v") == [m.twist.linear.x for _, m in official]
    assert values(recording, "w") == [m.twist.angular.z for _, m in official]
    assert times(recording, "v") == [time for time, _ in official]
    assert recording.intact
    overview = look(str(path))
    assert not isinstance(overview, Diagnostic)
    gap = overview.recording.topics["/local_plan"].longest_gap_ns
    assert gap is not None
    assert gap // 10**8 == 55


@needs_logs
def test_a_real_laser_log_agrees_with_the_official_decoder() -> None:
    path = LOGS / "scan_tools_hokuyo_ros1.mcap"
    recording = recorded(path, declare(SCAN))
    expected = []
    for _, message in decoded(path, "/scan"):
        low, high = message.range_min, message.range_max
        expected.append(min(r for r in message.ranges if low <= r <= high))
    assert len(expected) == 360
    assert values(recording, "nearest") == expected


@needs_logs
def test_a_real_rosbag2_log_agrees_with_the_official_decoder() -> None:
    path = LOGS / "cougars_auv_ros2.mcap"
    text = bindings(
        {
            "voltage": "/coug2/battery/data.voltage",
            "depth": "/coug2/depth_data.pose.pose.position.z",
            "x": "/coug2/odom.pose.pose.position.x",
            "covariance": "/coug2/depth_data.pose.covariance[14]",
        }
    )
    recording = recorded(path, declare(text))
    battery = decoded(path, "/coug2/battery/data")
    depth = decoded(path, "/coug2/depth_data")
    assert len(battery) == 334
    assert values(recording, "voltage") == [m.voltage for _, m in battery]
    assert values(recording, "depth") == [m.pose.pose.position.z for _, m in depth]
    assert values(recording, "covariance") == [m.pose.covariance[14] for _, m in depth]
    assert len(values(recording, "x")) == 3
    assert recording.intact


# A stream by itself


def stream(encoding: str, schema: Schema | None) -> ChannelDefinition:
    return ChannelDefinition(Channel(1, "/x", encoding, {}, 1), schema)


def test_a_stream_without_definition_has_no_decoder() -> None:
    assert decoder(stream("cdr", None)) == "its messages have no definition"


@pytest.mark.parametrize("end", ["", "\n", "\n\n"])
def test_an_empty_type_of_ros_1_may_stand_anywhere(end: str) -> None:
    line = "\n" + "=" * 80 + "\n"
    text = f"A a\nB b\nfloat64 x{line}MSG: one/A{line}MSG: one/B{end}"
    decode = decoder(stream("ros1", Schema(1, text.encode(), "ros1msg", "one/T")))
    assert callable(decode)
    message: Any = decode(b"\0\0\0\0\0\0\xf8\x3f")
    assert message.x == 1.5


@pytest.mark.parametrize("name", ["A", "a/b/C", "a/B\nimport os"])
def test_a_ros_1_type_of_another_form_is_refused(name: str) -> None:
    schema = Schema(1, b"float64 data", "ros1msg", name)
    assert decoder(stream("ros1", schema)) == "the definition of its messages cannot be read"


def test_a_stamp_is_read_as_either_ros_writes_it() -> None:
    assert stamp(header_of(sec=3, nanosec=5)) == 3 * S + 5
    assert stamp(header_of(secs=3, nsecs=5)) == 3 * S + 5
    assert stamp(header_of(secs=3)) is None
    assert stamp(header_of(sec=3.0, nanosec=5)) is None
    assert stamp(header_of(sec=[3], nanosec=5)) is None
    assert stamp(header_of(sec=float("nan"), nanosec=5, secs=3, nsecs=5)) == 3 * S + 5
    assert stamp(SimpleNamespace(data=1.0)) is None
    assert stamp(None) is None


def header_of(**time: Any) -> SimpleNamespace:
    return SimpleNamespace(header=SimpleNamespace(stamp=SimpleNamespace(**time)))


def test_the_type_of_ros_2_is_written_as_in_ros_1() -> None:
    assert short_type("sensor_msgs/msg/LaserScan") == "sensor_msgs/LaserScan"
    assert short_type("sensor_msgs/LaserScan") == "sensor_msgs/LaserScan"
