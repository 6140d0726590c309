"""Protobuf by its own encoder: a definition is built, messages of it are written and read back."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from google.protobuf.timestamp_pb2 import DESCRIPTOR as TIMESTAMP

from fretc.logs.messages import protobuf
from fretc.logs.reader import Overview, look
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.extras import install_help
from tests.fretc.logs.logs import MS, S, Sent, declare, recorded, times, values, write

F = FieldDescriptorProto
TEXT = """
[clock]
time = "log_time"
tick = "100 ms"

[signal.s]
path = "/p.{path}"
{more}
[proposition.q]
expr = "s < 5"
"""


def _field(
    message: DescriptorProto, number: int, name: str, kind: Any, type_: str = "", **more: Any
) -> None:
    label = F.LABEL_REPEATED if more.pop("many", False) else F.LABEL_OPTIONAL
    message.field.add(
        name=name,
        number=number,
        type=kind,
        type_name=type_ or None,
        label=label,
        json_name=name,
        **more,
    )


def _file() -> FileDescriptorProto:
    file = FileDescriptorProto(
        name="robot.proto",
        package="robot",
        syntax="proto3",
        dependency=["google/protobuf/timestamp.proto"],
    )
    mode = file.enum_type.add(name="Mode")
    for number, name in enumerate(("IDLE", "DRIVING", "STOPPED")):
        mode.value.add(name=name, number=number)
    vector = file.message_type.add(name="Vector")
    _field(vector, 1, "x", F.TYPE_DOUBLE)
    head = file.message_type.add(name="Header")
    _field(head, 1, "stamp", F.TYPE_MESSAGE, ".google.protobuf.Timestamp")
    state = file.message_type.add(name="State")
    _field(state, 1, "plain", F.TYPE_DOUBLE)
    _field(state, 2, "maybe", F.TYPE_DOUBLE, proto3_optional=True, oneof_index=1)
    _field(state, 3, "velocity", F.TYPE_MESSAGE, ".robot.Vector")
    _field(state, 4, "ranges", F.TYPE_FLOAT, many=True)
    _field(state, 5, "mode", F.TYPE_ENUM, ".robot.Mode")
    _field(state, 6, "left", F.TYPE_INT64, oneof_index=0)
    _field(state, 7, "right", F.TYPE_INT64, oneof_index=0)
    _field(state, 8, "header", F.TYPE_MESSAGE, ".robot.Header")
    _field(state, 9, "name", F.TYPE_STRING)
    _field(state, 10, "raw", F.TYPE_BYTES)
    _field(state, 11, "points", F.TYPE_MESSAGE, ".robot.Vector", many=True)
    _field(state, 12, "timestamp", F.TYPE_MESSAGE, ".google.protobuf.Timestamp")
    _field(state, 13, "inner", F.TYPE_MESSAGE, ".robot.State")
    state.oneof_decl.add(name="side")
    state.oneof_decl.add(name="_maybe")
    return file


def _stamp() -> FileDescriptorProto:
    file = FileDescriptorProto()
    TIMESTAMP.CopyToProto(file)
    return file


DEFINITION = FileDescriptorSet(file=[_file(), _stamp()]).SerializeToString()


def _class() -> Any:
    pool = DescriptorPool()
    pool.Add(_stamp())
    pool.Add(_file())
    return GetMessageClass(pool.FindMessageTypeByName("robot.State"))


STATE = _class()


def log(tmp_path: Path, payloads: list[bytes], definition: bytes = DEFINITION) -> Path:
    sent = [
        Sent("/p", "robot.State", payload, S + i * 100 * MS, encoding="protobuf")
        for i, payload in enumerate(payloads)
    ]
    return write(tmp_path / "log.mcap", sent, definitions={"robot.State": definition})


def reading(
    tmp_path: Path, path: str, messages: list[Any], more: str = "", time: str = "log_time"
) -> Recording:
    text = TEXT.format(path=path, more=more).replace("log_time", time)
    return recorded(log(tmp_path, [m.SerializeToString() for m in messages]), declare(text))


def found(tmp_path: Path, path: str, messages: list[Any], more: str = "") -> list[float | None]:
    recording = reading(tmp_path, path, messages, more)
    assert recording.findings == ()
    return [None if value != value else value for value in values(recording, "s")]


def test_numbers_are_read_through_messages_arrays_and_enums(tmp_path: Path) -> None:
    one = STATE(plain=1.5, velocity={"x": -2.0}, ranges=[3.0, 0.5], mode="STOPPED", raw=b"\x07\x09")
    two = STATE(plain=2.5, velocity={"x": 4.0}, ranges=[], mode="DRIVING")
    assert found(tmp_path, "plain", [one, two]) == [1.5, 2.5]
    assert found(tmp_path, "velocity.x", [one, two]) == [-2.0, 4.0]
    assert found(tmp_path, "ranges[:]", [one, two], 'reduce = "min"') == [0.5, None]
    assert found(tmp_path, "ranges[1]", [one, two]) == [0.5, None]
    assert found(tmp_path, "mode", [one, two]) == [2.0, 1.0]
    assert found(tmp_path, "raw[:]", [one], 'reduce = "max"') == [9.0]


def test_floats_are_compared_as_32_bit_floats_and_doubles_as_64_bit_floats(tmp_path: Path) -> None:
    one = STATE(plain=float(np.float32(0.9)), ranges=[0.9], left=2**53 + 1)
    recording = reading(tmp_path, "ranges[0]", [one])
    assert recording.samples["s"].values.tolist() == [np.float32(0.9)]
    assert recording.samples["s"].values.dtype == np.float32
    assert reading(tmp_path, "plain", [one]).samples["s"].values.dtype == np.float64
    mean = reading(tmp_path, "ranges[:]", [one], 'reduce = "mean"')
    assert mean.samples["s"].values.dtype == np.float64
    assert int(reading(tmp_path, "left", [one]).samples["s"].values[0]) == 2**53 + 1


def test_what_is_left_out_is_unknown_and_not_zero(tmp_path: Path) -> None:
    full = STATE(maybe=0.0, velocity={}, left=0)
    assert found(tmp_path, "velocity.x", [full, STATE()]) == [0.0, None]
    assert found(tmp_path, "maybe", [full, STATE()]) == [0.0, None]
    assert found(tmp_path, "left", [full, STATE(right=1)]) == [0.0, None]
    assert found(tmp_path, "inner.inner.plain", [STATE(), STATE(inner={"inner": {}})]) == [None, 0]


def test_a_plain_field_of_proto3_is_zero_where_it_is_not_there(tmp_path: Path) -> None:
    assert found(tmp_path, "plain", [STATE(), STATE(plain=3)]) == [0.0, 3.0]


@pytest.mark.parametrize("where", ["header", "timestamp"])
def test_a_stamp_is_that_of_the_header_or_of_foxglove(tmp_path: Path, where: str) -> None:
    time = {"seconds": 7, "nanos": 5}
    message = STATE(**({"header": {"stamp": time}} if where == "header" else {"timestamp": time}))
    recording = reading(tmp_path, "plain", [message], time="header.stamp")
    assert times(recording, "s") == [7 * S + 5]


def test_a_message_without_stamp_takes_its_log_time_and_that_is_told(tmp_path: Path) -> None:
    recording = reading(tmp_path, "plain", [STATE()], time="header.stamp")
    assert times(recording, "s") == [S]
    assert [finding.code for finding in recording.findings] == [Code.NO_FIELD]


@pytest.mark.parametrize(
    ("path", "more", "message"),
    [
        ("plane", "", "in `/p` the message has no field `plane`"),
        ("velocity.y", "", "in `/p` `velocity` has no field `y`"),
        ("velocity", "", "in `/p` `velocity` is no number"),
        ("name", "", "in `/p` `name` is no number"),
        ("ranges", "", "in `/p` `ranges` is an array"),
        ("points[:]", 'reduce = "min"', "in `/p` `points` is no array of numbers"),
    ],
)
def test_what_is_no_number_is_an_error(tmp_path: Path, path: str, more: str, message: str) -> None:
    full = STATE(velocity={"x": 1}, points=[{"x": 1}], ranges=[1])
    (finding,) = reading(tmp_path, path, [full], more).findings
    assert (finding.code, finding.message) == (Code.NO_FIELD, message)


def test_a_payload_that_is_none_is_unknown_and_told(tmp_path: Path) -> None:
    path = log(tmp_path, [STATE(plain=1).SerializeToString(), b"\x09\x01"])
    recording = recorded(path, declare(TEXT.format(path="plain", more="")))
    assert [str(value) for value in values(recording, "s")] == ["1.0", "nan"]
    assert [finding.code for finding in recording.findings] == [Code.BAD_MESSAGE]


@pytest.mark.parametrize(
    "definition",
    [
        b"", b"garbage", b"\0" * 100, DEFINITION[:-20],
        FileDescriptorSet(file=[_stamp()]).SerializeToString(),
        FileDescriptorSet(file=[_file()]).SerializeToString(),
        FileDescriptorSet(file=[_file(), _file(), _stamp()]).SerializeToString(),
    ],
    ids=range(7),
)  # fmt: skip
def test_a_definition_that_is_none_is_an_error(tmp_path: Path, definition: bytes) -> None:
    path = log(tmp_path, [STATE(plain=1).SerializeToString()], definition)
    (finding,) = recorded(path, declare(TEXT.format(path="plain", more=""))).findings
    assert finding.code is Code.UNKNOWN_ENCODING
    assert "the definition of its messages cannot be read" in finding.message


def test_info_lists_every_number_and_a_type_within_itself_ends(tmp_path: Path) -> None:
    overview = look(str(log(tmp_path, [STATE().SerializeToString()])))
    assert isinstance(overview, Overview)
    assert overview.numbers["/p"] == (
        "plain", "maybe", "ranges[:]", "mode", "left", "right", "raw[:]", "velocity.x",
        "timestamp.seconds", "timestamp.nanos", "header.stamp.seconds", "header.stamp.nanos",
    )  # fmt: skip


def test_a_definition_whose_types_multiply_ends(tmp_path: Path) -> None:
    file = FileDescriptorProto(name="wide.proto", package="robot", syntax="proto3")
    for n in range(16):
        message = file.message_type.add(name=f"State{n}" if n else "State")
        for i in range(8 if n < 15 else 0):
            _field(message, i + 1, f"f{i}", F.TYPE_MESSAGE, f".robot.State{n + 1}")
    definition = FileDescriptorSet(file=[file]).SerializeToString()
    overview = look(str(log(tmp_path, [b""], definition)))
    assert isinstance(overview, Overview)
    assert overview.numbers == {"/p": ()}


def test_without_its_package_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(_: object) -> Any:
        raise ModuleNotFoundError("mcap_protobuf")

    path = log(tmp_path, [STATE(plain=1).SerializeToString()])
    monkeypatch.setattr(protobuf, "_official", missing)
    (finding,) = recorded(path, declare(TEXT.format(path="plain", more=""))).findings
    assert finding.code is Code.MISSING_EXTRA
    assert finding.message == "`/p` cannot be read: that needs `mcap-protobuf-support`"
    assert finding.help == install_help("protobuf")
