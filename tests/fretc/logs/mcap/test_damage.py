import struct
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from mcap.records import Statistics
from mcap.writer import IndexType

from fretc.logs.mcap.container import no_summary
from fretc.logs.mcap.damage import Damages
from fretish.diagnostics.diagnostic import Severity
from tests.fretc.logs.logs import (
    LZ4,
    MS,
    NONE,
    TWELVE,
    ZSTD,
    S,
    X,
    chunk_starts,
    codes,
    damaged,
    number,
    recorded,
    values,
    write,
)


@pytest.mark.parametrize("compression", [ZSTD, LZ4, NONE])
@pytest.mark.parametrize("chunk", [0, 1, 2])
def test_a_damaged_chunk_is_a_gap_and_the_others_are_read(
    tmp_path: Path, compression: Any, chunk: int
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=compression)
    damaged(path, chunk_starts(path)[chunk] + 9 + 28 + 4 + 4 + 8 + 30)
    recording = recorded(path, X)
    start = 1000 * S + chunk * 400 * MS
    assert recording.gaps == ((start, start + 300 * MS),)
    assert len(values(recording, "x")) == 8
    assert not recording.intact
    assert codes(recording) == ["F404"]
    assert recording.findings[0].severity is Severity.WARNING
    assert (recording.start_ns, recording.end_ns) == (1000 * S, 1001 * S + 100 * MS)


@pytest.mark.parametrize("byte", [7, 15])  # the highest of the first and of the last time
def test_a_chunk_with_an_absurd_time_is_a_gap_between_its_neighbours(
    tmp_path: Path, byte: int
) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=NONE, index=IndexType.NONE)
    at = path.read_bytes().index(struct.pack("<QQ", 1000 * S + 400 * MS, 1000 * S + 700 * MS))
    damaged(path, at + byte, 0x3F)
    damaged(path, at + 80)
    recording = recorded(path, X)
    assert recording.gaps == ((1000 * S + 300 * MS, 1000 * S + 800 * MS),)
    assert recording.end_ns == 1001 * S + 100 * MS


def test_without_a_summary_a_damaged_chunk_tells_its_own_time(tmp_path: Path) -> None:
    options: dict[str, Any] = {"statistics": False, "index": IndexType.NONE}
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=NONE, **options)
    at = path.read_bytes().index(struct.pack("<QQ", 1000 * S, 1000 * S + 300 * MS))
    damaged(path, at + 80)
    recording = recorded(path, X)
    assert recording.gaps == ((1000 * S, 1000 * S + 300 * MS),)
    assert recording.start_ns == 1000 * S


def test_other_counts_than_the_statistics_state_make_the_whole_log_a_gap(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, chunked=False, crcs=False)
    data = path.read_bytes()
    message = data.index(b"\x05" + struct.pack("<QHIQ", 34, 1, 0, TWELVE[5].time))
    damaged(path, message, 0x85)
    recording = recorded(path, X)
    # A record of an unknown kind tells where: the gap is between its neighbours.
    assert recording.gaps == ((TWELVE[4].time, TWELVE[6].time),)
    statistics = struct.pack("<QHI", 12, 1, 1)
    data = data.replace(statistics, struct.pack("<QHI", 13, 1, 1))
    path.write_bytes(data)
    recording = recorded(path, X)
    assert codes(recording) == ["F410", "F415"]
    assert "it states 13 messages, but holds 12" in recording.findings[0].message
    assert recording.gaps == ((1000 * S, 1001 * S + 100 * MS),)
    assert not recording.intact


def test_a_message_that_changed_its_topic_is_missed(tmp_path: Path) -> None:
    sent = [*TWELVE, number(1.0, 1001 * S, topic="/y")]
    path = write(tmp_path / "log.mcap", sent, chunked=False, crcs=False)
    data = path.read_bytes()
    damaged(path, data.index(struct.pack("<HIQ", 1, 0, TWELVE[5].time)), 2)
    recording = recorded(path, X)
    assert codes(recording)[-2:] == ["F410", "F415"]
    assert "the numbers of messages of its topics differ" in recording.findings[-2].message
    assert not recording.intact


NOTHING = no_summary(100)


def settled(damages: Damages) -> list[tuple[str, tuple[int, int] | None]]:
    found = damages.settled(NOTHING, (), Counter(), 100)
    return [(damage.description, gap) for damage, gap in found]


def test_a_damage_costs_the_time_between_the_messages_around_it() -> None:
    damages = Damages()
    for time in (10, 20):
        damages.passed(time)
    damages.add(1, "a")
    damages.add(2, "b, before another message has come: it belongs to a")
    damages.passed(40)
    damages.add(3, "c")
    assert settled(damages) == [("a", (20, 40)), ("c", (40, 40))]


def test_a_damage_costs_the_time_that_the_file_states_for_it_if_that_can_be() -> None:
    damages = Damages()
    damages.passed(10)
    damages.add(1, "a", (12, 15))
    damages.passed(20)
    damages.add(2, "b", (2**61, 2**61 + 1))
    damages.passed(30)
    assert settled(damages) == [("a", (12, 15)), ("b", (20, 30))]


def test_what_loses_nothing_and_what_may_lose_anything_stand_by_themselves() -> None:
    damages = Damages()
    damages.passed(10)
    damages.add(1, "here")
    damages.add(2, "nothing", lossless=True)
    damages.add(3, "anything", anywhere=True)
    damages.passed(30)
    damages.passed(20)
    assert settled(damages) == [("here", (10, 30)), ("nothing", None), ("anything", (10, 30))]


@pytest.mark.parametrize(("count", "descriptions"), [(1, []), (2, ["a"])])
def test_a_possible_damage_counts_where_a_message_is_missing(
    count: int, descriptions: list[str]
) -> None:
    damages = Damages()
    damages.add_possible(1, "a")
    damages.passed(10)
    summary = no_summary(100)
    summary.statistics = Statistics(0, 1, {7: count}, 0, count, 10, 0, 10, 1)
    found = damages.settled(summary, (), Counter({7: 1}), 100)
    assert [damage.description for damage, _ in found][:1] == descriptions
