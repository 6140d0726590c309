from pathlib import Path

from fretc.logs import log_diagnostics
from fretc.logs.mcap.damage import Damage
from fretish.diagnostics.diagnostic import Severity
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from tests.fretc.logs.logs import (
    NONE,
    SCAN,
    TWELVE,
    S,
    X,
    chunk_starts,
    damaged,
    declare,
    number,
    recorded,
    scan,
    values,
    write,
)


def test_clocks_that_are_mixed_and_far_apart_are_a_warning(tmp_path: Path) -> None:
    text = SCAN.replace("log_time", "header.stamp") + '[signal.x]\npath = "/x.data"\n'
    sent = [scan([1.0], 9 * S, stamp=3 * S), number(1.0, 9 * S)]
    (finding,) = recorded(write(tmp_path / "log.mcap", sent), declare(text)).findings
    assert finding.severity is Severity.WARNING
    assert finding.message == (
        "the messages of `/x` have no header.stamp: their log_time is used, which is 6 s "
        "away from the stamps of the other topics"
    )


def test_a_missing_topic_points_at_the_path_and_names_the_nearest(tmp_path: Path) -> None:
    recording = recorded(write(tmp_path / "log.mcap", [number(0.0, 5, topic="/xx")]), X)
    (finding,) = recording.findings
    assert render(finding) == (
        "F405 the topic `/x` is not in the log\n"
        "  --> bindings.toml:7:8\n"
        '   | path = "/x.data"\n'
        "   |        ^^^^^^^^^\n"
        "help: did you mean `/xx`?"
    )
    assert values(recording, "x") == []
    assert recording.intact


def test_a_missing_topic_with_no_near_one_lists_the_topics(tmp_path: Path) -> None:
    sent = [number(0.0, 5, topic="/wheel"), number(0.0, 5, topic="/battery")]
    (finding,) = recorded(write(tmp_path / "log.mcap", sent), X).findings
    assert finding.help == "it holds /battery, /wheel"


def test_a_truncated_log_says_how_far_whole_messages_go(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4)
    data = path.read_bytes()
    third = chunk_starts(path)[2]
    path.write_bytes(data[: third + 20])
    (finding,) = recorded(path, X).findings
    assert render(finding) == (
        f"F403 warning: the log breaks off after byte {third}: complete messages end after 0.7 "
        "s; what follows is unknown\n"
        f"  --> {path}\n"
        "help: violations up to there count, but no requirement counts as satisfied"
    )


def test_damage_is_told_with_its_place_and_time(tmp_path: Path) -> None:
    path = write(tmp_path / "log.mcap", TWELVE, per_chunk=4, compression=NONE)
    second = chunk_starts(path)[1]
    damaged(path, second + 9 + 28 + 4 + 8 + 40)
    assert render(recorded(path, X).findings[0]) == (
        f"F404 warning: the log is damaged near byte {second}: the CRC of a chunk does not match "
        "its data; what was recorded from 0.4 s to 0.7 s counts as unknown\n"
        f"  --> {path}\n"
        "help: copy the log again from where it was recorded; a damaged log does not count as shown"
    )


PLACE = Source("log.mcap", "").span()


def test_of_many_damaged_places_twenty_are_told() -> None:
    one = log_diagnostics.damaged(Damage(7, "it is broken"), None, 0, PLACE)
    assert one.message == (
        "the log is damaged near byte 7: it is broken; no message is known to be lost"
    )
    assert log_diagnostics.few([one] * 20, PLACE) == [one] * 20
    diagnostics = log_diagnostics.few([one] * 25, PLACE)
    assert diagnostics[:20] == [one] * 20
    assert diagnostics[20].message == "the log is damaged in 5 more places"
    assert len(diagnostics) == 21


def test_a_topic_without_messages_is_told_from_one_that_is_not_there() -> None:
    assert render(log_diagnostics.no_message("/x", PLACE)) == (
        "F405 the log holds no message of `/x`\n"
        "  --> log.mcap\n"
        "help: the topic was recorded, but nothing was published on it"
    )


def test_a_log_cut_before_its_first_whole_message_says_so() -> None:
    assert log_diagnostics.truncated(8, PLACE).message == (
        "the log breaks off after byte 8: no message in it is whole"
    )


def test_another_kind_of_recording_is_named() -> None:
    found = log_diagnostics.not_a_log(b"\x28\xb5\x2f\xfd\0", PLACE)
    assert found.message == "the whole file is compressed with zstd"
    assert found.help == "unpack it first: `zstd -d FILE`; MCAP has a compression of its own"
