"""IDL as rosbag2 records it: the same messages as with `ros2msg`, on both ways of reading."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.records import Channel, Schema

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.messages.decoding import decoder, leaves, shape
from fretc.logs.messages.definitions import DefinitionError
from fretc.logs.messages.idl import types
from fretc.logs.messages.probes import trusted
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.extras import install_help
from tests.fretc.logs.logs import (
    MS,
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

LINE = "=" * 80 + "\n"
TIME = """// generated from rosidl_adapter/resource/msg.idl.em
module builtin_interfaces {
  module msg {
    @verbatim (language="comment", text=
      "This message communicates ROS Time." "\\n"
      "1 << 2 is in a comment.")
    struct Time {
      int32 sec;
      uint32 nanosec;
    };
  };
};
"""
HEADER = """#include "builtin_interfaces/msg/Time.idl"
module std_msgs {
  module msg {
    struct Header {
      builtin_interfaces::msg::Time stamp;
      string frame_id;
    };
  };
};
"""
LASER = """#include "std_msgs/msg/Header.idl"
module sensor_msgs {
  module msg {
    struct LaserScan {
      @verbatim (language="comment", text="timestamp in the header")
      std_msgs::msg::Header header;
      @unit (value="rad")
      float angle_min;
      float angle_max;
      float angle_increment;
      float time_increment;
      float scan_time;
      float range_min;
      float range_max;
      sequence<float> ranges;
      sequence<float> intensities;
    };
  };
};
"""
DEFINITION = "".join(
    f"{LINE}IDL: {name}\n{text}"
    for name, text in (
        ("sensor_msgs/msg/LaserScan", LASER),
        ("std_msgs/msg/Header", HEADER),
        ("builtin_interfaces/msg/Time", TIME),
    )
)
MIXED = """
module robot { module msg {
  module Mixed_Constants { const uint8 MODE = 3; const string NAME = "x"; };
  typedef double double__9[9];
  typedef sequence<octet, 4> few;
  struct Empty { uint8 structure_needs_at_least_one_member; };
  struct Point { double x; float y; };
  struct Mixed {
    boolean flag; char letter; octet raw; string name; double wide;
    int8 i8; uint8 u8; short i16; unsigned short u16; long i32; unsigned long u32;
    long long i64; unsigned long long u64; double__9 covariance; few bounded;
    Empty nothing; Point one; sequence<Point> many; Point three[3]; sequence<string, 5> words;
    sequence<boolean> flags; float last;
  };
}; };
"""


def stream(name: str, definition: str, encoding: str = "ros2idl") -> ChannelDefinition:
    return ChannelDefinition(
        Channel(1, "/x", "cdr", {}, 1), Schema(1, definition.encode(), encoding, name)
    )


def read(tmp_path: Path, definition: str = DEFINITION, count: int = 40) -> Recording:
    sent = [scan([5.0, 1 + i / 8], S + i * 100 * MS, stamp=7 * S + i) for i in range(count)]
    encoded = [Sent(s.topic, s.type, s.payload, s.time, encoding="idl") for s in sent]
    path = write(tmp_path / "log.mcap", encoded, definitions={sent[0].type: definition.encode()})
    return recorded(path, declare(SCAN.replace("log_time", "header.stamp")))


def test_messages_with_idl_are_those_with_msg(tmp_path: Path) -> None:
    recording = read(tmp_path)
    assert values(recording, "nearest") == [min(5.0, 1 + i / 8) for i in range(40)]
    assert times(recording, "nearest") == [7 * S + i for i in range(40)]
    assert recording.nearest["nearest"] == pytest.approx(0.1)
    assert recording.findings == ()


@pytest.mark.slow
def test_the_layouts_of_idl_are_trusted_by_its_decoder() -> None:
    for name, text in (("sensor_msgs/msg/LaserScan", DEFINITION), ("robot/msg/Mixed", MIXED)):
        one = stream(name, text)
        decode, known = decoder(one), shape(one)
        assert not isinstance(decode, str)
        assert known is not None
        assert trusted(known, decode)


def test_types_have_the_kinds_that_the_definition_gives_them() -> None:
    known = types("robot/msg/Mixed", MIXED)
    kinds = {f.name: (f.type, f.many, f.count) for f in known["robot/Mixed"]}
    assert kinds == {
        "flag": ("bool", False, None), "letter": ("uint8", False, None),
        "raw": ("uint8", False, None), "name": ("string", False, None),
        "wide": ("float64", False, None), "i8": ("int8", False, None),
        "u8": ("uint8", False, None), "i16": ("int16", False, None),
        "u16": ("uint16", False, None), "i32": ("int32", False, None),
        "u32": ("uint32", False, None), "i64": ("int64", False, None),
        "u64": ("uint64", False, None), "covariance": ("float64", True, 9),
        "bounded": ("uint8", True, None), "nothing": ("robot/Empty", False, None),
        "one": ("robot/Point", False, None), "many": ("robot/Point", True, None),
        "three": ("robot/Point", True, 3), "words": ("string", True, None),
        "flags": ("bool", True, None), "last": ("float32", False, None),
    }  # fmt: skip


def test_info_lists_the_numbers() -> None:
    listed = leaves(stream("sensor_msgs/msg/LaserScan", DEFINITION))
    assert listed is not None
    assert tuple(listed) == (
        "angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min",
        "range_max", "ranges[:]", "intensities[:]", "header.stamp.sec", "header.stamp.nanosec",
        "header.frame_id",
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    "definition",
    [
        "", "garbage", "module a {", "struct X {};", LASER, "module " * 3000,
        "module sensor_msgs { module msg { struct LaserScan { long x[1 << 9999999999]; }; }; };",
        "module sensor_msgs { module msg { struct LaserScan { LaserScan x; }; }; };",
        "module sensor_msgs { module msg { struct LaserScan { wstring x; no::Such y; }; }; };",
        "module sensor_msgs { module msg { struct LaserScan { string x[999999999]; }; }; };",
        "module sensor_msgs { module msg { struct LaserScan { float x[((((((((3))))))))]; }; }; };",
        "module sensor_msgs { module msg { struct LaserScan { sequence<float> ranges[3]; }; }; };",
        "module sensor_msgs { module msg { struct LaserScan { sequence<sequence<long>> r; }; }; };",
        f"module sensor_msgs {{ struct LaserScan {{ {'sequence<' * 40} float {'>' * 40} r; }}; }};",
        "module sensor_msgs { module msg { struct LaserScan { wstring x; float range_min; }; }; };",
        "module sensor_msgs { module msg { struct __import__ { long x; }; }; };",
        "module sensor_msgs { module msg { union LaserScan switch(long) { case 1: long x; }; }; };",
    ],
    ids=range(17),
)  # fmt: skip
def test_a_definition_that_is_none_is_an_error_and_never_a_fault(
    tmp_path: Path, definition: str
) -> None:
    findings = read(tmp_path, definition, count=12).findings
    assert findings
    assert {f.code for f in findings} <= {Code.UNKNOWN_ENCODING, Code.BAD_MESSAGE}


@pytest.mark.parametrize(
    "opened", ['"' + '\\"' * 9, "/* /*", '@a("x', "const char q = '\\\"'; \" "]
)
def test_what_has_no_end_is_looked_for_once(opened: str) -> None:
    """From each quote anew, a definition of 100 kB takes many seconds."""
    with pytest.raises(DefinitionError, match="is not closed"):
        types("a/msg/B", opened)
    with pytest.raises(DefinitionError, match="is not closed"):
        types("a/msg/B", f"{MIXED} {opened}")


def test_a_constant_is_never_run_as_a_program(tmp_path: Path) -> None:
    mark = tmp_path / "ran"
    evil = f'"); open({str(mark)!r}, "w"); ("'
    text = f"""module std_msgs {{ module msg {{
      module Float64_Constants {{ const string X = "{evil.replace('"', "")}"; }};
      struct Float64 {{ @default (value=1) double data; }}; }}; }};"""
    sent = [Sent("/x", "std_msgs/msg/Float64", number(1.5, S).payload, S, encoding="idl")]
    path = write(tmp_path / "log.mcap", sent, definitions={"std_msgs/msg/Float64": text.encode()})
    assert values(recorded(path, X), "x") == [1.5]
    assert not mark.exists()


def test_a_type_that_is_defined_twice_is_refused() -> None:
    twice = f"{MIXED}{LINE}IDL: robot/msg/Point\n" + (
        "module robot { module msg { struct Point { float x; }; }; };"
    )
    with pytest.raises(DefinitionError, match="defined twice"):
        types("robot/msg/Mixed", twice)


def test_without_rosbags_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == "rosbags"]:
        monkeypatch.delitem(sys.modules, name)
    sent = [Sent("/x", "std_msgs/msg/Float64", number(1.5, S).payload, S, encoding="idl")]
    path = write(tmp_path / "log.mcap", sent, definitions={"std_msgs/msg/Float64": b"any"})
    monkeypatch.setitem(sys.modules, "rosbags", None)
    (finding,) = recorded(path, X).findings
    assert finding.code is Code.MISSING_EXTRA
    assert finding.help == install_help("bags")


def test_mixed_messages_are_decoded_field_by_field() -> None:
    decode = decoder(stream("robot/msg/Mixed", MIXED))
    assert not isinstance(decode, str)
    body = bytes([1, 65, 200]) + b"\0" + b"\3\0\0\0ab\0" + b"\0" * 5 + np.float64(2.5).tobytes()
    body += b"\xff\x02" + b"\xfe\xff\x03\0" + b"\0\0" + b"\xfd\xff\xff\xff\x04\0\0\0"
    body += b"\0" * (-len(body) % 8) + b"\xfc" + b"\xff" * 7 + b"\5" + b"\0" * 7
    body += np.arange(9.0).tobytes() + b"\2\0\0\0\7\x08" + b"\0"
    body += b"\0" * (-len(body) % 8) + np.float64(1.5).tobytes() + np.float32(0.5).tobytes()
    body += b"\0\0\0\0" + b"\0" * (-(len(body) + 4) % 8)
    for i in range(3):
        body += b"\0" * (-len(body) % 8) + np.float64(i).tobytes() + np.float32(i).tobytes()
    body += b"\0\0\0\0" + b"\2\0\0\0\1\0" + b"\0\0" + np.float32(-1.0).tobytes()
    message: Any = decode(b"\0\1\0\0" + body)
    assert (message.flag, message.raw, message.name, message.wide) == (True, 200, "ab", 2.5)
    assert (message.i8, message.u8, message.i16, message.u16) == (-1, 2, -2, 3)
    assert (message.i32, message.u32, message.i64, message.u64) == (-3, 4, -4, 5)
    assert message.covariance.tolist() == list(range(9))
    assert list(message.bounded) == [7, 8]
    assert (message.one.x, message.one.y, message.three[2].x) == (1.5, 0.5, 2.0)
    assert (list(message.flags), message.last) == ([True, False], -1.0)
