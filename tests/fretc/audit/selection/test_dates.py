"""Which logs are since a time: by the start of the recording, else by the time of change."""

import os
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.selection.dates import is_older, since
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.command import write
from tests.fretc.logs import logs

DAY = 86_400
NOON = datetime(2026, 11, 22, 12, tzinfo=UTC)
NOON_S = int(NOON.timestamp())


@pytest.fixture(autouse=True)
def noon(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", str(NOON_S))
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("text", "moment"),
    [
        ("2026-11-20", "2026-11-20T00:00:00+00:00"),
        ("2026-11-20T18:30", "2026-11-20T18:30:00+00:00"),
        ("2026-11-20T18:30:15.25+02:00", "2026-11-20T16:30:15.250000+00:00"),
        ("24h", "2026-11-21T12:00:00+00:00"),
        ("90 min", "2026-11-22T10:30:00+00:00"),
        ("7d", "2026-11-15T12:00:00+00:00"),
    ],
)
def test_a_time_is_a_date_or_so_long_ago(text: str, moment: str) -> None:
    found = since(text)
    assert isinstance(found, datetime)
    assert found.isoformat() == moment


@given(st.text() | st.sampled_from(["", "yesterday", "2026-13-01", "99999d", "-1h", "1e9d"]))
def test_what_is_no_time_is_told(text: str) -> None:
    found = since(text)
    assert isinstance(found, datetime) or found.code is Code.BAD_USAGE


def recorded(name: str, start_s: int, changed_s: int) -> str:
    logs.write(
        Path(name), [logs.number(1, start_s * logs.S), logs.number(2, (start_s + 5) * logs.S)]
    )
    os.utime(name, (changed_s, changed_s))
    return name


def test_the_start_of_the_recording_counts_whenever_the_file_changed() -> None:
    log = recorded("a.mcap", NOON_S - DAY, NOON_S + DAY)
    assert is_older(log, NOON)
    assert not is_older(log, datetime.fromtimestamp(NOON_S - DAY, UTC))
    assert is_older(log, datetime.fromtimestamp(NOON_S - DAY + 1, UTC))
    assert not is_older(recorded("b.mcap", NOON_S + 1, NOON_S - DAY), NOON)


def test_of_a_clock_from_zero_and_of_a_log_without_a_summary_the_change_counts() -> None:
    simulated = recorded("a.mcap", 3, NOON_S - 1)
    assert is_older(simulated, NOON)
    os.utime(simulated, (NOON_S, NOON_S))
    assert not is_older(simulated, NOON)
    cut = recorded("b.mcap", NOON_S + DAY, NOON_S)
    data = Path(cut).read_bytes()
    Path(cut).write_bytes(data[: len(data) // 2])
    os.utime(cut, (NOON_S - 1, NOON_S - 1))
    assert is_older(cut, NOON)


def test_a_run_in_several_files_is_as_old_as_its_description_says() -> None:
    about = "rosbag2_bagfile_information:\n  relative_file_paths: [x_0.mcap, x_1.mcap]\n"
    start = f"  starting_time: {{nanoseconds_since_epoch: {NOON_S * logs.S}}}\n"
    write(
        "run/metadata.yaml", f"{about}{start}  duration: {{nanoseconds: 5}}\n  message_count: 2\n"
    )
    for name in ("x_0.mcap", "x_1.mcap"):
        write(f"run/{name}", "")
    assert not is_older("run", NOON)
    assert is_older("run", datetime.fromtimestamp(NOON_S + 1, UTC))


@pytest.mark.parametrize(
    "log", ["-", "none.mcap", "https://host.invalid/a.mcap", "memory://no/a.mcap"]
)
def test_what_has_no_date_is_not_older(log: str) -> None:
    if not log.startswith("https"):
        assert not is_older(log, NOON)


def test_a_bad_time_is_one_message() -> None:
    found = since("last week")
    assert isinstance(found, Diagnostic)
    assert found.message == "`--since last week` is neither a date nor a length of time"
