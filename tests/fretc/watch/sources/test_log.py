"""A log as a source: what comes of it while it grows, is cut, replaced or damaged."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from fretc.watch.sources.log import Log
from fretc.watch.sources.source import Arrival, Idle, Missed, Opened, Problem
from fretish.diagnostics.diagnostic import Code
from tests.fretc.logs.logs import S, chunk_starts, damaged, number, write

SENT = [number(float(i), 1000 * S + i, "/x" if i % 3 else "/y") for i in range(30)]


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return write(tmp_path / "run.mcap", SENT, per_chunk=7)


def test_every_message_of_the_topics_comes_as_it_was_recorded(log: Path) -> None:
    opened, *found = Log(str(log), follow=False).arrivals(["/x"])
    assert opened == Opened(str(log))
    expected = [(each.time, each.payload) for each in SENT if each.topic == "/x"]
    arrivals = [each for each in found if isinstance(each, Arrival)]
    assert [(each.log_time, each.payload) for each in arrivals] == expected
    assert {each.channel.schema_name for each in arrivals} == {"std_msgs/msg/Float64"}


def test_a_file_that_grows_byte_by_byte_gives_what_the_whole_file_gives(log: Path) -> None:
    data = log.read_bytes()
    whole = list(Log(str(log), follow=False).arrivals(["/x", "/y"]))
    log.write_bytes(b"")
    found, written = [], 0
    source = Log(str(log), follow=True)
    for item in source.arrivals(["/x", "/y"]):
        if isinstance(item, Idle):
            assert item.now is None
            written += 211
            with log.open("ab") as stream:
                stream.write(data[written - 211 : written])
        else:
            found.append(item)
    assert found == whole


def _gone(log: Path) -> None:
    log.unlink()


def _another(log: Path) -> None:
    other = log.with_name("other")
    other.write_bytes(log.read_bytes())
    other.replace(log)


def _shorter(log: Path) -> None:
    os.truncate(log, 20)


def _over(log: Path) -> None:
    """The same file, with the messages of another run: it is longer at once."""
    other = log.with_name("other")
    write(other, [number(i / 7, 2000 * S + i, "/x") for i in range(100)], per_chunk=5)
    log.write_bytes(other.read_bytes())


CHANGES: list[tuple[Callable[[Path], None], str]] = [
    (_gone, "it is gone"),
    (_another, "another file has taken its place"),
    (_shorter, "it has become shorter than what was read of it"),
    (_over, "another log was written over it"),
]


@pytest.mark.parametrize(("change", "why"), CHANGES)
def test_a_file_that_is_no_more_what_it_was_ends_the_source(
    log: Path, change: Callable[[Path], None], why: str
) -> None:
    log.write_bytes(log.read_bytes()[:700])
    last = None
    for item in Log(str(log), follow=True).arrivals(["/x"]):
        if isinstance(item, Idle):
            change(log)
        last = item
    assert isinstance(last, Problem)
    assert last.diagnostic.code is Code.UNREADABLE_LOG
    assert last.diagnostic.message.endswith(why)


def test_what_is_damaged_is_missed_and_the_rest_comes(log: Path) -> None:
    damaged(log, chunk_starts(log)[1] + 60)
    found = list(Log(str(log), follow=False).arrivals(["/x", "/y"]))
    (missed,) = [each for each in found if isinstance(each, Missed)]
    assert (missed.since, missed.until) == (1000 * S + 7, 1000 * S + 13)
    assert [each for each in found if isinstance(each, Problem)]
    times = [each.log_time - 1000 * S for each in found if isinstance(each, Arrival)]
    assert times == [*range(7), *range(14, 30)]


def test_a_source_that_is_closed_ends(log: Path) -> None:
    log.write_bytes(log.read_bytes()[:700])
    source = Log(str(log), follow=True)
    for item in source.arrivals(["/x"]):
        if isinstance(item, Idle):
            source.close()
    assert isinstance(item, Idle)
