"""All files of the MCAP conformance suite: each message is read, and no damage is reported."""

import hashlib
import struct
from collections import Counter
from io import BytesIO
from pathlib import Path

import pytest
from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader

from fretc.logs.reader import look, read
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.each import each
from tests.effort import some
from tests.fretc.logs.conformance import Records, Variant, build, variants
from tests.fretc.logs.logs import X, codes, times, values

ALL = list(variants())
WITH_MESSAGES = [variant for variant in ALL if variant.input.endswith(("Message", "Messages"))]

_FLOAT = Schema(1, b"float64 data\n", "ros2msg", "std_msgs/msg/Float64")
_X = Channel(1, "/x", "cdr", {}, 1)


def official(data: bytes) -> list[Message]:
    """The messages, by the streaming reader of the format's authors."""
    records = StreamReader(BytesIO(data), validate_crcs=True).records
    return [record for record in records if isinstance(record, Message)]


def stated(records: Records) -> list[Message]:
    return [record for record in records if isinstance(record, Message)]


def test_these_are_the_files_of_the_suite() -> None:
    assert Counter(variant.input for variant in ALL) == {
        "NoData": 6,
        "OneAttachment": 14,
        "OneMetadata": 14,
        "OneSchemalessMessage": 74,
        "OneMessage": 154,
        "TenMessages": 154,
    }
    assert len({variant.name for variant in ALL}) == 416


@pytest.mark.parametrize(
    ("name", "sha256"),
    [
        (
            "NoData-pad-st-sum",
            "b5a32905482d1e5c120712614a4923e489303ef55399a2bfe98821613220ab72",
        ),
        (
            "OneMetadata-mdx-st-sum",
            "6d7681e1536e3c61a0d9755b1b10b9a7ad4c2042855a839ce96c8c024bc64316",
        ),
        (
            "OneSchemalessMessage-ch-chx-mx-pad-rch-st-sum",
            "d5f340ef4c1e80be16711f70d118266375a549c854cd96a9581e60fdd8ef819a",
        ),
        (
            "TenMessages-ch-chx-mx-rch-rsh-st-sum",
            "813c4eb55e1195e5af9482f60d9b214cd083a8805720ec1663812637d716e4d5",
        ),
    ],
)
def test_they_are_byte_for_byte_those_of_the_suite(name: str, sha256: str) -> None:
    """The hashes are those that the public repository states of them."""
    (variant,) = (variant for variant in ALL if variant.name == name)
    assert hashlib.sha256(variant.data).hexdigest() == sha256


@pytest.mark.slow
@each("variant", some(ALL, 5))
def test_each_file_holds_what_it_states_and_is_whole(variant: Variant, tmp_path: Path) -> None:
    path = tmp_path / "log.mcap"
    path.write_bytes(variant.data)
    messages = stated(variant.records)
    assert official(variant.data) == messages
    overview = look(str(path))
    if not messages:
        assert isinstance(overview, Diagnostic)
        assert overview.code is Code.EMPTY_LOG
        return
    assert not isinstance(overview, Diagnostic), overview
    found = overview.recording
    assert (found.findings, found.gaps, found.intact) == ((), (), True)
    assert list(found.topics) == ["example"]
    topic = found.topics["example"]
    log_times = [message.log_time for message in messages]
    assert (topic.count, topic.first_ns, topic.last_ns) == (
        len(messages),
        min(log_times),
        max(log_times),
    )
    ten = len(messages) == 10
    assert (topic.out_of_order, topic.equal_stamps) == ((2, 1) if ten else (0, 0))
    assert (found.start_ns, found.end_ns) == (topic.first_ns, topic.last_ns)


def with_numbers(records: Records) -> Records:
    """The same, with payloads that a signal can read: message i holds i + 0.5."""
    payloads = (b"\x00\x01\x00\x00" + struct.pack("<d", i + 0.5) for i in range(len(records)))
    return (
        _FLOAT,
        _X,
        *(
            Message(1, m.log_time, payload, m.publish_time, m.sequence)
            for m, payload in zip(stated(records), payloads, strict=False)
        ),
    )


@pytest.mark.slow
@each("variant", some(WITH_MESSAGES, 5, 2))
def test_each_payload_arrives_with_its_time(variant: Variant, tmp_path: Path) -> None:
    records = with_numbers(variant.records)
    data = build(records, variant.features)
    assert official(data) == stated(records)
    path = tmp_path / "log.mcap"
    path.write_bytes(data)
    found = read(str(path), X, ["x"])
    assert isinstance(found, Recording), found
    assert (found.gaps, found.intact) == ((), True)
    if len(records) == 3:
        assert codes(found) == []
        assert (times(found, "x"), values(found, "x")) == ([2], [0.5])
    else:
        assert codes(found) == ["F411"]
        # In the order of time, and of two of the same time in the order of the file.
        assert times(found, "x") == [0, 1, 2, 3, 3, 4, 5, 7, 8, 9]
        assert values(found, "x") == [0.5, 2.5, 1.5, 3.5, 4.5, 6.5, 5.5, 7.5, 8.5, 9.5]
