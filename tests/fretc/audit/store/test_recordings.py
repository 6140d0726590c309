"""Kept samples: they give the verdicts of the log, and nobody else's samples are used."""

import shutil
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from compiler.files import text_files
from fretc.audit import many_logs as auditing
from fretc.audit.many_logs import audit_log
from fretc.audit.plan import Plan
from fretc.audit.store import recordings
from fretc.audit.store.recordings import SampleCache
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import EXACT, Recording
from tests.command import Fretc
from tests.effort import some
from tests.fretc.audit.test_results_taken_over import (
    BINDINGS,
    CHANGES,
    PROJECT,
    changed,
    plan,
    sent,
)
from tests.fretc.logs.logs import MS, S, Sent, declare, payload, write

KEY = b"k" * 32
READ_AGAIN = {
    "the age of samples",
    "the clock",
    "a path",
    "a topic less",
    "the trace of agents",
}
"""Changes of what is read of a log; all others are of the requirements."""


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr(text_files, "_COARSEST", -1)  # it was not written just now
    (tmp_path / "logs").mkdir()
    return str(write(tmp_path / "logs" / "log.mcap", [*sent()]))


@pytest.fixture
def kept(tmp_path: Path) -> SampleCache:
    return SampleCache(tmp_path / "columns", KEY)


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The logs that were read, or hashed."""
    logs: list[str] = []

    def noted(function: Callable[..., Any]) -> Callable[..., Any]:
        def call(log: str, *arguments: Any) -> Any:
            logs.append(log)
            return function(log, *arguments)

        return call

    monkeypatch.setattr(auditing, "read", noted(read))
    monkeypatch.setattr(recordings, "file_sha256", noted(text_files.file_sha256))
    return logs


@pytest.mark.slow
@pytest.mark.parametrize("name", [n for n in CHANGES if n in {*some(CHANGES, 3), *READ_AGAIN}])
def test_a_log_is_read_again_only_where_something_else_of_it_is_read(
    tmp_path: Path, log: str, kept: SampleCache, opened: list[str], name: str
) -> None:
    before, now = plan(PROJECT), plan(CHANGES[name][0])
    audit_log(before, log, kept=kept)
    from_nothing = audit_log(now, log)
    opened.clear()
    assert audit_log(now, log, kept=kept) == from_nothing
    assert opened == ([log] if name in READ_AGAIN else [])


def _kept(folder: Path, log: str, kept: SampleCache) -> tuple[Plan, Path]:
    made = plan(PROJECT)
    audit_log(made, log, kept=kept)
    (path,) = kept.folder.iterdir()
    return made, path


def test_a_log_that_is_another_one_is_read_again(
    tmp_path: Path, log: str, kept: SampleCache, opened: list[str]
) -> None:
    made, _ = _kept(tmp_path, log, kept)
    write(Path(log), [*sent(late=True)])
    opened.clear()
    found = audit_log(made, log, kept=kept)
    assert opened == [log]
    assert found == audit_log(made, log)
    opened.clear()
    assert audit_log(made, log, kept=kept) == found
    assert opened == []


def test_where_times_do_not_tell_the_log_is_hashed(
    tmp_path: Path, log: str, kept: SampleCache, opened: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(text_files, "_COARSEST", 10**18)
    made, _ = _kept(tmp_path, log, kept)
    found = audit_log(made, log)
    monkeypatch.setattr(auditing, "read", lambda *_: pytest.fail("it was read"))
    opened.clear()
    assert audit_log(made, log, kept=kept) == found
    assert opened == [log]


def test_a_log_can_be_known_by_its_hash_alone(
    tmp_path: Path, log: str, kept: SampleCache, opened: list[str]
) -> None:
    made, _ = _kept(tmp_path, log, kept)
    for rehash, by in ((False, "stamp"), (True, "sha256")):
        opened.clear()
        assert audit_log(made, log, kept=SampleCache(kept.folder, KEY, rehash)).known_by == by
        assert opened == [log] * rehash


def test_a_log_that_is_gone_is_an_error_as_before(
    tmp_path: Path, log: str, kept: SampleCache
) -> None:
    made, _ = _kept(tmp_path, log, kept)
    Path(log).unlink()
    found = audit_log(made, log, kept=kept)
    assert not found.read
    assert [each.code.number for each in found.diagnostics] == ["F901"]
    assert found == audit_log(made, log)


def test_what_is_not_of_this_user_and_this_place_is_not_believed(
    tmp_path: Path, log: str, kept: SampleCache, opened: list[str]
) -> None:
    made, path = _kept(tmp_path, log, kept)
    data = path.read_bytes()

    def believed(some: SampleCache = kept) -> bool:
        opened.clear()
        recordings_of = made.declarations, ("x", "y", "z"), Integrity.HASH
        return some.recording(log, *recordings_of) is not None

    assert believed()
    assert not believed(SampleCache(kept.folder, b"K" * 32))
    for at in range(0, len(data), max(1, len(data) // 50)):
        path.write_bytes(data[:at] + bytes([data[at] ^ 1]) + data[at + 1 :])
        assert not believed()
    for part in (b"", data[:31], data[:-1], data + b"x"):
        path.write_bytes(part)
        assert not believed()
    path.write_bytes(data)
    assert believed()
    moved = tmp_path / "moved"
    shutil.copytree(kept.folder, moved)
    assert not believed(SampleCache(moved, KEY))
    path.rename(tmp_path / "elsewhere")
    path.symlink_to(tmp_path / "elsewhere")
    assert not believed()


def test_of_a_file_that_does_not_stand_alone_nothing_is_kept(
    tmp_path: Path, log: str, kept: SampleCache
) -> None:
    made = plan(PROJECT)
    other = Path(log).with_name("run.bin")
    shutil.copy(log, other)
    audit_log(made, str(other), kept=kept)
    (other.parent / "metadata.yaml").write_text("rosbag2_bagfile_information: {version: 5}\n")
    audit_log(made, log, kept=kept)
    assert not kept.folder.exists()


STRING, NUMBER = "std_msgs/msg/String", "std_msgs/msg/Int64"
WORDS = """
[clock]
tick = "100 ms"
[signal.mode]
path = "/mode.data"
values = ["stop", "go"]
[signal.count]
path = "/count.data"
[signal.small]
path = "/small.data"
unit = "mm"
"""


def test_words_whole_numbers_and_small_floats_come_back_as_they_were(
    tmp_path: Path, kept: SampleCache, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(text_files, "_COARSEST", -1)
    declarations = declare(WORDS)
    messages = []
    for i, word in enumerate(["stop", "go", "gone"] * 4):
        time = 1000 * S + i * 100 * MS
        messages.append(Sent("/mode", STRING, payload(STRING, data=word), time))
        messages.append(Sent("/count", NUMBER, payload(NUMBER, data=2**53 + 1 + i), time))
        small = b"\0\1\0\0" + struct.pack("<f", 0.1 * i)
        messages.append(Sent("/small", "std_msgs/msg/Float32", small, time))
    log = str(write(tmp_path / "log.mcap", messages))
    asked = declarations, ("mode", "count", "small"), Integrity.HASH
    recording = read(log, *asked)
    assert isinstance(recording, Recording)
    kept.keep(log, text_files.stamp(log), recording, *asked)
    found = kept.recording(log, *asked)
    assert found is not None
    again, by = found
    assert by == "stamp"
    for name, samples in recording.samples.items():
        same = again.samples[name]
        assert same.values.dtype == samples.values.dtype
        assert np.array_equal(same.values, samples.values, equal_nan=True)
        assert np.array_equal(same.times, samples.times)
        assert (same.scale, same.words) == (samples.scale, samples.words)
    assert again.samples["count"].values.dtype == EXACT
    assert again.samples["small"].values.dtype == np.float32
    assert [each.code.number for each in again.findings] == ["F423"]
    for field in Recording.__slots__:
        if field not in ("samples", "ticks", "derived"):
            assert getattr(again, field) == getattr(recording, field), field


# The command


def project(folder: Path, texts: dict[str, str]) -> None:
    folder.mkdir(exist_ok=True)
    for name, text in texts.items():
        file = "bindings.toml" if name == "bindings" else f"{name}.fret"
        head = "" if name == "bindings" else f'+++\nid = "{name}"\n+++\n'
        (folder / file).write_text(f"{head}{text}")


@pytest.mark.slow
def test_a_changed_threshold_needs_no_log(
    fretc: Fretc, tmp_path: Path, log: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    project(tmp_path / "requirements", dict(PROJECT))
    fretc("audit", log, "-o", "one.json", "--keep-columns")
    assert len([*Path("one.json.columns").iterdir()]) == 1
    project(tmp_path / "requirements", dict(changed("bindings", "50 cm", "20 cm")))
    fretc("audit", log, "-o", "nothing.json")
    monkeypatch.setattr(auditing, "read", lambda *_: pytest.fail("it was read"))
    fretc("audit", log, "-o", "one.json", "--keep-columns")
    assert Path("one.json").read_bytes() == Path("nothing.json").read_bytes()


def test_samples_are_kept_beside_evidence_of_this_machine(
    fretc: Fretc, tmp_path: Path, log: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    project(tmp_path / "requirements", {"bindings": BINDINGS, **PROJECT})
    for options, why in (
        (["-o", "-"], "evidence is printed\nhelp: name a file with `-o`"),
        (
            ["--engine", "dask"],
            "`--engine dask` reads the logs elsewhere\nhelp: remove one of the two options",
        ),
    ):
        run = fretc("audit", log, "--keep-columns", *options)
        assert run.status == 2
        assert run.err.endswith(
            f"F907 `--keep-columns` stores samples beside the evidence on this machine, but {why}\n"
        )
