"""`fretc info`: what is in a log, for a person and for programs."""

import json
from pathlib import Path

import pytest

from tests.command import Fretc
from tests.fretc.logs.logs import MS, TWELVE, S, Sent, number, scan, write

SENT = [
    *TWELVE,
    scan([1.0, 2.0], 1000 * S + 50 * MS),
    Sent("/raw", "Raw", b"{}", 1000 * S + 60 * MS, encoding="cbor"),
]


@pytest.fixture(autouse=True)
def log(fretc: Fretc) -> Path:
    return write(Path("log.mcap"), SENT)


def test_a_person_sees_each_topic_with_what_a_signal_can_read(fretc: Fretc) -> None:
    run = fretc("info", "log.mcap")
    lines = run.out.splitlines()
    assert (run.status, run.err) == (0, "")
    assert lines[0].startswith("log.mcap  ")
    assert lines[0].endswith(" bytes, 1.1 s, no damage found")
    after = {line.split()[0]: lines[i + 1].strip() for i, line in enumerate(lines[:-1])}
    assert "  /x     std_msgs/msg/Float64, 12 messages, 10 Hz, longest gap 100 ms" in lines
    assert after["/x"] == ".data"
    assert ".range_max, .ranges[:], and " in after["/scan"]
    assert after["/raw"] == (
        "cannot be read: its messages are encoded as `cbor`, defined in `jsonschema`"
    )
    assert ".intensities[:]" in fretc("info", "log.mcap", "--all").out


def test_a_program_reads_the_same(fretc: Fretc) -> None:
    (found,) = json.loads(fretc("info", "log.mcap", "--format", "json").out)
    assert (found["run"], found["intact"], found["findings"]) == ("log.mcap", True, [])
    assert found["end_ns"] - found["start_ns"] == 1100 * MS
    assert found["topics"]["/x"]["count"] == 12
    assert found["topics"]["/x"]["rate_hz"] == 10.0
    assert found["topics"]["/x"]["signals"] == ["/x.data"]
    assert found["topics"]["/raw"]["signals"] is None


def test_every_signal_that_is_named_can_be_bound(fretc: Fretc) -> None:
    (found,) = json.loads(fretc("info", "log.mcap", "--format", "json").out)
    paths = [p for topic in found["topics"].values() for p in topic["signals"] or ()]
    kinds = {p: kind for topic in found["topics"].values() for p, kind in topic["kinds"].items()}
    assert kinds["/scan.header.frame_id"] == "text"
    assert len(paths) > 10
    lines = ['[clock]\ntick = "100 ms"']
    for i, path in enumerate(paths):
        reduce = 'reduce = "min"\n' if path.endswith("[:]") else ""
        is_text = kinds[path] == "text"
        expr = f"s{i} = lidar" if is_text else f"s{i} < 9"
        values = 'values = ["lidar"]\n' if is_text else ""
        lines.append(
            f'[signal.s{i}]\npath = "{path}"\n{reduce}{values}[proposition.p{i}]\nexpr = "{expr}"'
        )
    Path("requirements").mkdir()
    Path("requirements/bindings.toml").write_text("\n".join(lines), "utf-8")
    sentence = f"the sw shall always satisfy {' | '.join(f'p{i}' for i in range(len(paths)))}"
    Path("requirements/r.fret").write_text(sentence, "utf-8")
    run = fretc("audit", "log.mcap")
    assert "F406" not in run.err
    assert run.status in (0, 3)


def test_damage_is_told_and_a_folder_stands_for_its_logs(fretc: Fretc) -> None:
    data = Path("log.mcap").read_bytes()
    Path("runs").mkdir()
    Path("runs/cut.mcap").write_bytes(data[: len(data) - 40])
    Path("runs/good.mcap").write_bytes(data)
    run = fretc("info", "runs")
    assert run.status == 3
    assert run.err.startswith("F403 warning: the log breaks off after byte ")
    assert [line.split()[0] for line in run.out.splitlines() if " bytes, " in line] == [
        "runs/cut.mcap",
        "runs/good.mcap",
    ]


def test_what_is_no_log_is_told_beside_the_others(fretc: Fretc) -> None:
    Path("bad.mcap").write_bytes(b"no log")
    run = fretc("info", "bad.mcap", "log.mcap", "no.mcap")
    assert run.status == 2
    assert "F402" in run.err
    assert "F401" in run.err or "F901" in run.err
    assert "log.mcap  " in run.out


def test_names_from_a_log_cannot_move_the_terminal(fretc: Fretc) -> None:
    write(Path("evil.mcap"), [number(1.0, S, topic="/x\x1b[2J\n/y")])
    out = fretc("info", "evil.mcap").out
    assert "\x1b" not in out
    assert "/x\\x1b[2J\\n/y" in out
