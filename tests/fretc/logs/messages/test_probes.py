import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from mcap.records import Channel, Schema

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages import probes
from fretc.logs.messages.decoding import decoder, shape
from fretc.logs.messages.definitions import types
from fretc.logs.messages.layouts import TopicType
from fretc.logs.messages.probes import probe, trusted
from tests.effort import FULL
from tests.fretc.logs.logs import definition
from tests.fretc.logs.messages.test_definitions import stream

BOTH = pytest.mark.parametrize("ros1", [False, True])

LINES = st.sampled_from(
    [
        "float64 x", "int8 a # b = c", "string s", "string<=5 t 'a=b'", "uint8[] u", "time t0",
        "Header header", "Header[] headers", "A a1", "two/A a2", "A[2] a3", "B b1", "one/msg/B b2",
        "int32 K=1", "int32 k=1", "char c", "byte d", "byte[3] e", "bool f true", "wstring w",
        "====", "===== ", " ===", "MSG: one/A", "MSG: two/A", "MSG: one/msg/B", "MSG:one/B",
        "MSG: std_msgs/Header", "MSG: one/T", "MSG: one/Header", "MSG: builtin_interfaces/Time",
        "MSG: builtin_interfaces/Duration", "# c", " # c", "", " ", "\t", "int32 from", "int16\ti",
        "builtin_interfaces/Time t1", "builtin_interfaces/Duration t2", "int32 sec", "duration t3",
        "uint32 nanosec", "float64[0] none", "float32  g", " float32 h", "int16[<=2] j",
        "int64 l\x0buint16 m", "time stamp", "float64 x y = 3",
    ]
)  # fmt: skip
SEPARATED = st.builds("{}\n{}".format, st.just("=" * 80), st.sampled_from(
    ["MSG: one/A", "MSG: two/A", "MSG: one/B", "MSG: std_msgs/Header", "MSG: one/Header"]
))  # fmt: skip
TEXTS = st.lists(st.one_of(LINES, LINES, SEPARATED), max_size=9).map("\n".join)


@pytest.mark.slow
@BOTH
@given(text=TEXTS)
@example(text="float64 x\nA a\n" + "=" * 80 + "\nMSG: one/A")
@example(text="A[2] a\n" + "=" * 80 + "\nMSG: one/A")
@example(
    text="Header[] h\nint8 x\n===\nMSG: one/Header\nint8 a\n===\nMSG: std_msgs/Header\nint16 b"
)
def test_what_both_can_read_has_the_same_fields_in_both(text: str, *, ros1: bool) -> None:
    sent = stream(text, ros1=ros1)
    decode, known = decoder(sent), shape(sent)
    if known is None or isinstance(decode, str) or renamed(text, ros1=ros1):
        return
    assert trusted(known, decode)


def renamed(text: str, *, ros1: bool) -> bool:
    """ROS 1 gives a field another name where Python has a word of it."""
    return ros1 and "int32 from" in text


@pytest.mark.parametrize(
    ("stated_fields", "true_fields"),
    [
        ("int32 a\nint32 b", "int32 b\nint32 a"),
        ("int32 a", "uint32 a"),
        ("int8 a\nfloat64 b", "int16 a\nfloat64 b"),
        ("string s\nfloat64 b", "uint8[] s\nint8 a\nfloat64 b"),
        ("float64[2] b", "float64[] b"),
        ("float32 a", "int32 a"),
        ("one/E e\nint8 a\n===\nMSG: one/E\n", "int8 a"),
    ],
)
def test_a_shape_of_other_fields_than_the_decoder_has_is_not_trusted(
    stated_fields: str, true_fields: str
) -> None:
    known, decode = (
        shape(stream(stated_fields, ros1=False)),
        decoder(stream(true_fields, ros1=False)),
    )
    assert known is not None
    assert callable(decode)
    assert not trusted(known, decode)


@pytest.mark.parametrize(
    ("many", "most"), [(23, 23**2), *([(1000, probes._LARGEST)] if FULL else [])]
)
def test_a_message_too_large_to_be_made_up_is_not_trusted(
    monkeypatch: pytest.MonkeyPatch, many: int, most: int
) -> None:
    sent = stream(f"one/A[{many}] a\n===\nMSG: one/A\nfloat64[{many}] b", ros1=False)
    known, decode = shape(sent), decoder(sent)
    assert known is not None
    assert callable(decode)
    assert trusted(known, decode) is (many < 1000)
    monkeypatch.setattr(probes, "_LARGEST", most)
    trusted.cache_clear()
    assert not trusted(known, decode)


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_common_types_are_trusted(encoding: str) -> None:
    """What the decoder of ROS 1 carries over, and with it whole times, is not looked at."""
    for name in (
        "sensor_msgs/LaserScan",
        "sensor_msgs/Imu",
        "sensor_msgs/JointState",
        "sensor_msgs/PointCloud2",
        "sensor_msgs/BatteryState",
        "nav_msgs/Odometry",
        "geometry_msgs/TwistStamped",
        "diagnostic_msgs/DiagnosticArray",
        "trajectory_msgs/JointTrajectory",
        "std_msgs/Header",
        "std_msgs/Float64MultiArray",
    ):
        text = definition(name, encoding)
        kind = "ros1msg" if encoding == "ros1" else "ros2msg"
        full = name if encoding == "ros1" else name.replace("/", "/msg/")
        sent = ChannelDefinition(Channel(1, "/x", encoding, {}, 1), Schema(1, text, kind, full))
        known, decode = shape(sent), decoder(sent)
        assert known is not None, name
        assert callable(decode)
        assert trusted(known, decode), name


def test_made_up_texts_end_at_each_place_between_two_numbers_of_8_bytes() -> None:
    known = TopicType("one/T", types("one/T", "string s", ros1=False), cdr=True)
    payloads = [probe(known, seed) for seed in range(8)]
    assert sorted(len(payload) % 8 for payload in payloads if payload) == list(range(8))
