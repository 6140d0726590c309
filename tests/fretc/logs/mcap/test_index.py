"""When the index of a log is believed, and that nothing is lost where it is not."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from mcap.records import Channel, McapRecord, Schema

from fretc.logs.signals.integrity import Integrity
from tests.fretc.logs.logs import S
from tests.fretc.logs.mcap.test_projection import facts, float_of, image, whole
from tests.fretc.logs.pieces import Piece, built, channel

ONE = Piece([float_of(1, 1000 * S, 0.5), float_of(3, 1001 * S, 1.5)])
TWO = Piece([float_of(1, 1002 * S, 2.5), image(1003 * S, 9000)])


def both(path: Path, pieces: Sequence[Piece], **options: Any) -> bool:
    """Whether the log is read by its index; what is read is the same as record by record."""
    path.write_bytes(bytes(built(pieces, **options).data))
    found = whole(path, Integrity.HASH)
    assert facts(found) == facts(whole(path, Integrity.FULL))
    return found.checked.by_index


def test_a_log_whose_index_explains_every_byte_is_read_by_it(tmp_path: Path) -> None:
    assert both(tmp_path / "log.mcap", [ONE, TWO])
    assert both(tmp_path / "log.mcap", [ONE, TWO], outside=True)
    assert both(tmp_path / "log.mcap", [TWO, ONE])  # out of order


@pytest.mark.parametrize(
    "pieces",
    [
        [ONE, Piece(TWO.messages, chunked=False)],
        [Piece(ONE.messages, chunked=False), TWO],
        [Piece(ONE.messages, chunked=False)],
        [ONE, Piece([]), TWO],
    ],
)
def test_messages_beside_the_chunks_are_read(tmp_path: Path, pieces: list[Piece]) -> None:
    assert not both(tmp_path / "log.mcap", pieces)


@pytest.mark.parametrize(
    "stated",
    [
        {"chunk_count": 1},
        {"chunk_count": 3},
        {"message_count": 3},
        {"message_count": 5},
        {"channel_message_counts": {1: 2, 3: 1, 5: 2}, "message_count": 5},
        {"channel_message_counts": {1: 1, 3: 1, 5: 2}},
        {"channel_message_counts": {1: 2, 3: 1, 9: 1}},
        {"channel_message_counts": {}},
        {"message_start_time": 0},
        {"message_start_time": 1001 * S},
        {"message_end_time": 2**63},
        {"message_end_time": 1002 * S},
    ],
)
def test_statistics_that_are_wrong_are_not_believed(tmp_path: Path, stated: dict[str, Any]) -> None:
    path = tmp_path / "log.mcap"
    path.write_bytes(bytes(built([ONE, TWO], **stated).data))
    found, full = whole(path, Integrity.HASH), whole(path, Integrity.FULL)
    if stated == {"channel_message_counts": {1: 2, 3: 1, 5: 2}, "message_count": 5}:
        # Nobody asks for `/image`: how many there are of it is taken as it is stated.
        assert found.checked.by_index
        assert found.samples["x"].values.tolist() == full.samples["x"].values.tolist()
        return
    assert not found.checked.by_index
    assert facts(found) == facts(full)


def test_the_time_of_a_log_without_a_bound_topic_is_that_of_its_messages(tmp_path: Path) -> None:
    # It is what a lost file of the same run is placed by.
    for stated in ({"message_start_time": 0}, {"message_end_time": 2**64 - 1}):
        assert not both(tmp_path / "log.mcap", [Piece([image(1000 * S, 9)])], **stated)


@pytest.mark.parametrize(
    "record",
    [
        channel(1, "/other", 1),
        channel(1, "/x", 2),
        Channel(1, "/x", "ros1", {}, 1),
        channel(17, "/new", 1),
        Schema(1, b"int64 data\n", "ros2msg", "std_msgs/msg/Int64"),
        Schema(9, b"int64 data\n", "ros2msg", "std_msgs/msg/Int64"),
    ],
)
@pytest.mark.parametrize("which", [0, 1])
def test_a_chunk_that_declares_what_the_summary_does_not_is_read_record_by_record(
    tmp_path: Path, record: McapRecord, which: int
) -> None:
    # As in a log that was merged from two, whose topics had the same numbers.
    pieces = [ONE, TWO]
    pieces[which] = Piece(pieces[which].messages, also=[record], declares=False)
    assert not both(tmp_path / "log.mcap", pieces)


def test_a_definition_between_the_messages_of_a_chunk_is_looked_at(tmp_path: Path) -> None:
    other = Schema(1, b"int64 data\n", "ros2msg", "std_msgs/msg/Int64")
    pieces = [ONE, Piece([image(1002 * S, 9), other, float_of(2, 1002 * S, 1.0)])]
    assert not both(tmp_path / "log.mcap", pieces)
