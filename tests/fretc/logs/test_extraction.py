import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

import fretc.logs.extraction
import fretc.logs.topic_columns
from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages.decoding import Decode, decoder, shape
from fretc.logs.messages.layouts import TopicType
from fretc.logs.messages.probes import trusted
from fretc.logs.messages.vectorized import samples
from fretc.logs.signals.samples import Recording
from fretish.bindings.declarations import Declarations, Signal
from tests.effort import LOGS, needs_logs
from tests.fretc.logs.logs import (
    MS,
    SCAN,
    S,
    Sent,
    X,
    codes,
    declare,
    number,
    recorded,
    scan,
    times,
    values,
    write,
)

PLAIN = b"\0\1\0\0"


class Ways:
    """Reads logs in both ways, and counts what the official decoder is given."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._patch = monkeypatch
        self.decoded = 0
        """Messages in the fast way; those made up are not counted."""
        self._counting = False
        monkeypatch.setattr(fretc.logs.extraction, "_FEW", 0)
        monkeypatch.setattr(fretc.logs.extraction, "decoder", self._decoder)
        monkeypatch.setattr(fretc.logs.extraction, "trusted", self._trusted)

    def _decoder(self, stream: ChannelDefinition) -> Decode | str:
        found = decoder(stream)
        if isinstance(found, str):
            return found

        def decode(payload: bytes) -> object:
            self.decoded += self._counting
            return found(payload)

        return decode

    def _trusted(self, shape: TopicType, decode: Decode) -> bool:
        before, answer = self.decoded, trusted(shape, decode)
        self.decoded = before
        return answer

    def same(self, path: Path, declarations: Declarations) -> Recording:
        """The log, which both ways read the same."""
        self.decoded, self._counting = 0, True
        fast = recorded(path, declarations)
        self._counting = False
        with self._patch.context() as patch:
            patch.setattr(fretc.logs.extraction, "shape", lambda stream: None)
            slow = recorded(path, declarations)
        for name in declarations.signals:
            one, other = fast.samples[name], slow.samples[name]
            assert one.times.tolist() == other.times.tolist()
            assert one.values.tobytes() == other.values.tobytes(), name
        assert fast.ticks.tolist() == slow.ticks.tolist()
        assert fast.nearest == slow.nearest
        assert fast.topics == slow.topics
        assert fast.findings == slow.findings
        return fast


@pytest.fixture
def ways(monkeypatch: pytest.MonkeyPatch) -> Ways:
    return Ways(monkeypatch)


def signals(paths: dict[str, str], clock: str = "log_time") -> Declarations:
    text = f'[clock]\ntick = "1000000 s"\ntime = "{clock}"\n'
    for name, path in paths.items():
        text += f'[signal.{name}]\npath = "{path}"\n'
        text += 'reduce = "min"\n' if path.endswith("[:]") else ""
    return declare(text)


CUSTOM = "one/msg/T"


def custom(data: bytes, time: int = S, encoding: str = "cdr") -> Sent:
    type_ = CUSTOM if encoding == "cdr" else "one/T"
    return Sent("/x", type_, data, time, encoding=encoding)


@pytest.fixture
def log(tmp_path: Path) -> Callable[..., Path]:
    def log(sent: list[Sent], definition: str = "", per_chunk: int | None = None) -> Path:
        known = {CUSTOM: definition.encode(), "one/T": definition.encode()}
        path = tmp_path / "log.mcap"
        return write(path, sent, definitions=known if definition else None, per_chunk=per_chunk)

    return log


Log = Callable[..., Path]


def text(value: bytes, x: float) -> bytes:
    """`string s`, `float64 x`."""
    data = struct.pack("<I", len(value) + 1) + value + b"\0"
    return PLAIN + data + bytes(-len(data) % 8) + struct.pack("<d", x)


# Whole logs, both ways


@pytest.mark.slow
def test_many_messages_of_one_layout_are_read_without_being_decoded(ways: Ways, log: Log) -> None:
    sent = [number(i / 7, i * MS) for i in range(9000)]  # more than are read at once, twice
    recording = ways.same(log(sent), X)
    assert values(recording, "x") == [i / 7 for i in range(9000)]
    assert ways.decoded <= 24


def test_a_few_bytes_are_left_to_the_decoder(ways: Ways, log: Log) -> None:
    sent = [number(float(i), i * S) for i in range(70)]
    ways.same(log(sent[:30]), X)
    assert ways.decoded == 3
    fretc.logs.extraction._FEW = 512  # put back with the patches
    ways.same(log(sent[:30]), X)
    assert ways.decoded == 30
    ways.same(log(sent), X)
    assert ways.decoded == 3


def test_a_batch_ends_wherever_it_may(
    ways: Ways, log: Log, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent = [scan([1.0 + i] * (i % 3), i * S, stamp=i * MS) for i in range(20)]
    sent[9] = Sent("/scan", sent[9].type, PLAIN, 9 * S)
    text = SCAN.replace("log_time", "header.stamp")
    whole = ways.same(log(sent), declare(text))
    for most in (1, 2, 7, 9, 10):
        monkeypatch.setattr(fretc.logs.topic_columns, "_MOST", most)
        part = ways.same(log(sent, per_chunk=most), declare(text))
        assert times(part, "nearest") == times(whole, "nearest")
        np.testing.assert_equal(values(part, "nearest"), values(whole, "nearest"))
        assert part.findings == whole.findings


def test_two_channels_of_one_topic_have_each_its_own_layout(ways: Ways, log: Log) -> None:
    sent = []
    for i in range(40):
        if i % 3 and i < 30:
            sent.append(custom(text(b"abc"[: i % 4], float(i)), i * S))
        else:
            sent.append(number(float(i), i * S))
    recording = ways.same(log(sent, "string s\nfloat64 data"), X)
    assert values(recording, "x") == [float(i) for i in range(40)]


def test_a_signal_that_one_of_two_channels_lacks_has_no_samples(ways: Ways, log: Log) -> None:
    sent = [number(1.0, S), custom(text(b"a", 2.0), 2 * S), number(3.0, 3 * S)]
    for order in (sent, sent[::-1], sent[1:]):
        recording = ways.same(log(order, "string s\nfloat64 other"), X)
        assert values(recording, "x") == []
        assert "F406" in codes(recording)


@pytest.mark.parametrize(
    "broken",
    [b"", PLAIN, PLAIN + b"\xff\xff\xff\xff" + bytes(8), b"\0\0\0\0" + bytes(16),
     b"\0\7\0\0" + bytes(16), text(b"a\xffc", 9.0), text(b"abc", 9.0)[:-1]],
)  # fmt: skip
def test_a_message_that_cannot_be_decoded_is_unknown_among_others(
    ways: Ways, log: Log, broken: bytes
) -> None:
    for at in (0, 5, 11):
        payloads = [text(b"abc", float(i)) for i in range(12)]
        payloads[at] = broken
        sent = [custom(payload, i * S) for i, payload in enumerate(payloads)]
        recording = ways.same(log(sent, "string s\nfloat64 x"), signals({"x": "/x.x"}))
        found = values(recording, "x")
        big_endian = broken[:2] == b"\0\0"
        assert np.isnan(found[at]) != big_endian  # that can be decoded: all is zero
        assert np.isnan(found).sum() == (not big_endian)


def test_one_damaged_text_does_not_make_the_other_messages_slow(ways: Ways, log: Log) -> None:
    sent = [custom(text(b"a\xffc" if i == 0 else b"abc", 1.0), i * S) for i in range(500)]
    recording = ways.same(log(sent, "string s\nfloat64 x"), signals({"x": "/x.x"}))
    assert np.isnan(values(recording, "x")).sum() == 1
    assert ways.decoded <= 10


def test_a_layout_may_change_in_the_middle(ways: Ways, log: Log) -> None:
    texts = [b"abc"] * 20 + [b"abcdefgh"] * 20 + [b"abd"] * 3 + [b"a" * i for i in range(40)]
    sent = [custom(text(value, i / 3), i * S) for i, value in enumerate(texts)]
    recording = ways.same(log(sent, "string s\nfloat64 x"), signals({"x": "/x.x"}))
    assert values(recording, "x") == [i / 3 for i in range(len(texts))]


def test_arrays_may_change_their_length_and_be_empty(ways: Ways, log: Log) -> None:
    lengths = [5] * 9 + [0] * 3 + [6, 5, 1, 0, 6] * 4
    sent = [scan([2.0 + j + i / 9 for j in range(n)], i * S) for i, n in enumerate(lengths)]
    paths = {"low": "/scan.ranges[:]", "third": "/scan.ranges[2]", "far": "/scan.range_max"}
    recording = ways.same(log(sent), signals(paths))
    assert np.isnan(values(recording, "low")).tolist() == [n == 0 for n in lengths]
    assert np.isnan(values(recording, "third")).tolist() == [n < 3 for n in lengths]


def test_a_signal_with_a_missing_field_leaves_the_others_as_they_are(
    ways: Ways, log: Log, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fretc.logs.topic_columns, "_MOST", 50)
    sent = [scan([1.0, float(i)], i * S) for i in range(200)]
    paths = {"bad": "/scan.rangs[:]", "low": "/scan.ranges[:]", "name": "/scan.header.frame_id"}
    recording = ways.same(log(sent, per_chunk=50), signals(paths))
    assert values(recording, "low") == [min(1.0, float(i)) for i in range(200)]
    assert values(recording, "bad") == values(recording, "name") == []
    assert sorted(finding.message for finding in recording.findings) == [
        "in `/scan` `header.frame_id` is no number",
        "in `/scan` the message has no field `rangs`",
    ]
    assert ways.decoded < 100  # once they are known, only some


@pytest.mark.parametrize("path", ["/x.a", "/x.b[0]", "/x.b[:]", "/x.s", "/x.m", "/x.many.x"])
def test_a_number_for_an_array_and_an_array_for_a_number_are_errors(
    ways: Ways, log: Log, path: str
) -> None:
    definition = "float64[] a\nfloat64 b\nstring s\none/M m\none/M[] many\n===\nMSG: one/M\nint8 x"
    data = PLAIN + bytes(8) + bytes(8) + b"\1\0\0\0\0\1" + bytes(2) + bytes(4)
    recording = ways.same(log([custom(data, i * S) for i in range(5)], definition),
                          signals({"x": path}))  # fmt: skip
    assert values(recording, "x") == []
    assert len(recording.findings) == 1


def test_a_limit_that_is_an_array_is_an_error(ways: Ways, log: Log) -> None:
    declared = declare(
        '[clock]\ntick = "100 ms"\n[signal.x]\npath = "/x.x[:]"\nreduce = "min"\n'
        'valid = "x < most"\n'
    )
    for count in (0, 1):
        payload = PLAIN + struct.pack("<I", count) + b"\0\0\x80\x3f" * count
        payload += struct.pack("<If", 1, 0.5)
        recording = ways.same(log([custom(payload)] * 3, "float32[] most\nfloat32[] x"), declared)
        assert values(recording, "x") == []
        assert recording.findings


def test_an_angle_that_is_an_array_is_no_clearance(ways: Ways, log: Log) -> None:
    declared = declare(
        '[clock]\ntick = "100 ms"\n[signal.x]\npath = "/x.ranges[:]"\nreduce = "outline"\n'
        'unit = "m"\nfootprint = [[1, 1], [-1, 1], [-1, -1], [1, -1]]\n'
        'invalid = { nan = "drop" }\n'
    )
    definition = "float32[] ranges\nfloat32[] angle_min\nfloat32 angle_increment"
    sent = []
    for i in range(40):  # all NaN in the first messages: their angles are not looked at
        ranges = [float("nan")] * (1 + i) if i < 30 else [5.0] * 99
        data = struct.pack(f"<I{len(ranges)}f", len(ranges), *ranges)
        sent.append(custom(PLAIN + data + struct.pack("<Iff", 1, 0.5, 0.1), i * S))
    recording = ways.same(log(sent, definition), declared)
    assert values(recording, "x") == []


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
@pytest.mark.parametrize("clock", ["log_time", "publish_time", "header.stamp"])
def test_the_time_of_a_message_is_that_of_the_declared_clock(
    ways: Ways, log: Log, clock: str, encoding: str
) -> None:
    stamps = [2, 1, 5 * S + 7, 999_999_999, (2**31 - 1) * S + 999_999_999, 3 * S]
    sent = [scan([1.0], (9 + i) * S, stamp=t, encoding=encoding) for i, t in enumerate(stamps)]
    sent = [Sent(m.topic, m.type, m.payload, m.time, m.time - 3, m.encoding) for m in sent]
    text = SCAN.replace("log_time", clock).replace("100 ms", "1000000 s")
    recording = ways.same(log(sent), declare(text))
    expected = {
        "log_time": [(9 + i) * S for i in range(6)],
        "publish_time": [(9 + i) * S - 3 for i in range(6)],
        "header.stamp": sorted(stamps),
    }
    assert times(recording, "nearest") == expected[clock]


def test_a_stamp_of_ros_1_is_not_carried_over_into_seconds(ways: Ways, log: Log) -> None:
    data = struct.pack("<III", 7, 3, 1_500_000_000) + struct.pack("<I", 0) + struct.pack("<d", 1.5)
    definition = "Header header\nfloat64 x\n===\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\n"
    definition += "string frame_id"
    paths = {"x": "/x.x", "n": "/x.header.stamp.nsecs"}
    recording = ways.same(
        log([custom(data, encoding="ros1")] * 4, definition), signals(paths, "header.stamp")
    )
    assert times(recording, "x") == [4 * S + 500_000_000] * 4
    assert values(recording, "n") == [1.5e9] * 4


def test_a_time_of_ros_1_is_carried_over_into_seconds(ways: Ways, log: Log) -> None:
    sent = [
        custom(struct.pack("<IIiid", 3, 1_500_000_000 if i > 20 else 5, -3, -5, 1.5), i * S, "ros1")
        for i in range(40)
    ]
    paths = {"s": "/x.t.secs", "n": "/x.t.nsecs", "ds": "/x.d.secs", "dn": "/x.d.nsecs"}
    recording = ways.same(log(sent, "time t\nduration d\nfloat64 x"), signals(paths))
    assert (values(recording, "s")[-1], values(recording, "n")[-1]) == (4.0, 5e8)
    assert (values(recording, "ds")[-1], values(recording, "dn")[-1]) == (-4.0, 999_999_995.0)


@pytest.mark.parametrize(
    ("parts", "code", "stamp", "read"),
    [
        (("float64 sec", "float64 nanosec"), "dd", (1.0, 2.0), None),
        (("float64 sec", "float64 nanosec"), "dd", (float("nan"), 2.0), None),
        (("int64 sec", "int64 nanosec"), "qq", (3, 4), 3 * S + 4),
        (("int64 sec", "int64 nanosec"), "qq", (-(2**62), 4), -(2**62)),
        (("int32 sec", "uint32 nanosec"), "iI", (-3, 4), -3 * S + 4),
        (("uint32[1] sec", "uint32 nanosec"), "II", (3, 4), None),
        (("uint32 secs", "uint32 nsecs"), "II", (3, 4), 3 * S + 4),
    ],
)
def test_a_stamp_of_another_form_is_read_as_far_as_it_is_one(
    ways: Ways, log: Log, parts: tuple[str, str], code: str, stamp: Any, read: int | None
) -> None:
    lines = "\n".join(parts)
    definition = f"one/H header\nfloat64 x\n===\nMSG: one/H\none/I stamp\n===\nMSG: one/I\n{lines}"
    data = PLAIN + struct.pack(f"<{code}d", *stamp, 1.5)
    recording = ways.same(
        log([custom(data, 9 * S)] * 3, definition), signals({"x": "/x.x"}, "header.stamp")
    )
    assert times(recording, "x") == [9 * S if read is None else read] * 3


def test_a_stamp_later_than_any_loses_its_message(ways: Ways, log: Log) -> None:
    lines = "int64 sec\nint64 nanosec"
    definition = f"one/H header\nfloat64 x\n===\nMSG: one/H\none/I stamp\n===\nMSG: one/I\n{lines}"
    stamps = [(3, 4), (2**62, 0), (2**63 - 1, 2**63 - 1), (5, 0)]
    sent = [custom(PLAIN + struct.pack("<qqd", *stamp, 1.5), 9 * S) for stamp in stamps]
    recording = ways.same(log(sent, definition), signals({"x": "/x.x"}, "header.stamp"))
    assert times(recording, "x") == [3 * S + 4, 5 * S]
    assert codes(recording) == ["F412", "F417"]


def test_values_that_are_no_numbers_stay_what_they_are(ways: Ways, log: Log) -> None:
    odd = [float("nan"), float("inf"), -float("inf"), -0.0, 0.0, 5e-324, 1.7e308]
    sent = [number(odd[i % 7], i * S) for i in range(70)]
    sent += [Sent("/x", sent[0].type, PLAIN + b"\1\0\0\0\0\0\xf0\x7f", 99 * S)]  # one that signals
    recording = ways.same(log(sent), X)
    assert np.isnan(values(recording, "x")).sum() == 31
    text = '[clock]\ntick = "100 ms"\n[signal.x]\npath = "/x.data"\nunit = "km"\n'
    text += 'invalid = { "+inf" = "far", "-inf" = "near" }\n'
    assert np.isnan(values(ways.same(log(sent), declare(text)), "x")).sum() == 11


def test_a_definition_that_only_the_decoder_understands_is_read_by_it(ways: Ways, log: Log) -> None:
    """A type in it is defined twice."""
    sent = [custom(PLAIN + struct.pack("<dd", 0.5, float(i)), i * S) for i in range(6)]
    twice = "\n===\nMSG: one/B\nfloat64 y\n===\nMSG: one/B\nfloat64 z"
    path = log(sent, f"one/B b\nfloat64 x{twice}")
    recording = ways.same(path, signals({"x": "/x.x"}))
    assert values(recording, "x") == [float(i) for i in range(6)]
    assert ways.decoded == 6


def test_times_that_the_definition_leaves_out_are_what_the_decoder_takes_them_for(
    ways: Ways, log: Log
) -> None:
    data = PLAIN + struct.pack("<iIiI", -1, 5, -2, 6)
    definition = "builtin_interfaces/Time t\nbuiltin_interfaces/Duration d"
    recording = ways.same(log([custom(data)] * 3, definition),
                          signals({"t": "/x.t.sec", "d": "/x.d.sec"}))  # fmt: skip
    assert values(recording, "t") == [2.0**32 - 1] * 3
    assert values(recording, "d") == [2.0**32 - 2] * 3


def test_topics_that_nothing_binds_are_counted_and_not_decoded(ways: Ways, log: Log) -> None:
    sent = [Sent("/other", "std_msgs/msg/Float64", b"?", i * S) for i in range(9)]
    recording = ways.same(log([*sent, number(1.0, S)]), X)
    assert recording.topics["/other"].count == 9
    assert recording.findings == ()
    assert ways.decoded == 1


def test_a_field_with_a_word_of_python_as_its_name_is_read_as_the_decoder_names_it(
    ways: Ways, log: Log
) -> None:
    sent = [custom(struct.pack("<d", 1.5), i * S, "ros1") for i in range(5)]
    found = ways.same(log(sent, "float64 from"), signals({"x": "/x.from_"}))
    assert values(found, "x") == [1.5] * 5
    assert codes(ways.same(log(sent, "float64 from"), signals({"x": "/x.from"}))) == ["F406"]


def test_a_layout_that_reads_otherwise_than_the_decoder_is_given_up(
    ways: Ways, log: Log, monkeypatch: pytest.MonkeyPatch
) -> None:
    def swapped(stream: ChannelDefinition) -> TopicType | None:
        known = shape(stream)
        assert known is not None
        return TopicType(known.name, {known.name: known.types[known.name][::-1]}, cdr=True)

    monkeypatch.setattr(fretc.logs.extraction, "shape", swapped)
    numbers = [0.0 if i in (0, 4, 8) else float(i) for i in range(9)]
    sent = [custom(PLAIN + struct.pack("<dd", x, -x), i * S) for i, x in enumerate(numbers)]
    path = log(sent, "float64 a\nfloat64 b")  # those that are decoded are zero
    assert values(ways.same(path, signals({"a": "/x.a"})), "a") == numbers
    monkeypatch.setattr(fretc.logs.extraction, "trusted", lambda shape, decode: True)
    path = log(sent[1:], "float64 a\nfloat64 b")
    assert values(ways.same(path, signals({"a": "/x.a"})), "a") == numbers[1:]


@pytest.mark.parametrize(("count", "wrong"), [(9, 0), (9, 4), (9, 8), (200, 0), (200, 99)])
def test_the_decoder_is_held_against_what_is_read_of_many_messages_at_once(
    ways: Ways, log: Log, monkeypatch: pytest.MonkeyPatch, count: int, wrong: int
) -> None:
    def mistaken(signal: Signal, numbers: Any, beside: Any) -> Any:
        found = samples(signal, numbers, beside).copy()
        found[wrong] += len(found) == count  # right of a single message
        return found

    monkeypatch.setattr(fretc.logs.extraction, "samples", mistaken)
    sent = [number(i / 7, i * MS) for i in range(count)]
    assert values(ways.same(log(sent), X), "x") == [i / 7 for i in range(count)]


def test_of_few_large_messages_one_is_decoded_and_of_small_ones_three(ways: Ways, log: Log) -> None:
    for beams, decoded in ((100, 3), (1000, 1)):
        sent = [scan([1.0 + i / 4] * beams, i * S) for i in range(20)]
        assert values(ways.same(log(sent), declare(SCAN)), "nearest") == [
            1.0 + i / 4 for i in range(20)
        ]
        assert ways.decoded == decoded


# Logs that others recorded


def streams(path: Path) -> Iterator[ChannelDefinition]:
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    for channel in summary.channels.values():
        yield ChannelDefinition(channel, summary.schemas.get(channel.schema_id))


@needs_logs
@pytest.mark.parametrize(
    ("name", "columns"),
    [
        ("cougars_auv_ros2", 295),
        ("ros_amr_interop_turtlebot3_ros1", 45),
        ("scan_tools_hokuyo_ros1", 14),
        ("turtlesim_ros1", 33),
    ],
)
def test_every_number_of_a_real_log_is_what_the_official_decoder_reads(
    ways: Ways, name: str, columns: int
) -> None:
    path, text = LOGS / f"{name}.mcap", '[clock]\ntick = "1000000 s"\ntime = "header.stamp"\n'
    places: dict[str, str] = {}
    for stream in streams(path):
        known = shape(stream)
        assert known is not None
        for where in known.numbers():
            place = f"{stream.channel.topic}.{'.'.join(where)}"
            if known.has(where):
                places[place] = ""
            else:
                drop = 'invalid = { nan = "drop", "+inf" = "far", "-inf" = "near" }\n'
                places[f"{place}[:]"] = f'reduce = "mean"\n{drop}'
                places[f"{place}[1]"] = ""
    for i, (place, fields) in enumerate(places.items()):
        text += f'[signal.s{i}]\npath = "{place}"\n{fields}'
    recording = ways.same(path, declare(text))
    assert sum(samples.values.size > 0 for samples in recording.samples.values()) == columns
    assert ways.decoded < sum(topic.count for topic in recording.topics.values()) / 2
