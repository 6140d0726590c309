"""A pipe to which nobody writes, or a device, lies in the place of a file: no reader waits."""

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from compiler.files import text_files as files
from compiler.files.text_files import content, open_regular
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.readers import command, put, readers


@contextmanager
def patience() -> Iterator[None]:
    """A minute, after which a reader that waits is interrupted."""
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.alarm(60)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.slow
def test_no_reader_waits_for_a_pipe(tmp_path: Path) -> None:
    for number, (kind, reader) in enumerate(readers(tmp_path / "sound").items()):
        folder = tmp_path / str(number)
        put(folder, {**reader.beside, reader.file: ""})
        (folder / reader.file).unlink()
        os.mkfifo(folder / reader.file)
        with patience():
            status, text, _ = command(folder, *reader.args)
        refused = status == 2 and any(line.startswith("F") for line in text.splitlines())
        left_alone = (
            kind in ("settings", "fretc.toml", "metadata.yaml") and status == 0
        )  # as if there were none
        assert refused or left_alone, f"{kind}: {status} {text}"


@pytest.mark.parametrize("target", ["/dev/zero", "/dev/tty", "/dev/stdin", "/proc/self/fd/0"])
def test_a_link_to_a_device_is_no_file(tmp_path: Path, target: str) -> None:
    (tmp_path / "r.fret").symlink_to(target)
    found = files.read(str(tmp_path / "r.fret"))
    assert isinstance(found, Diagnostic)
    assert found.code is Code.UNREADABLE


def test_a_pipe_that_a_shell_hands_over_is_read() -> None:
    reading, writing = os.pipe()
    os.write(writing, b"the sw shall satisfy q")
    os.close(writing)
    found = files.read(f"/dev/fd/{reading}")
    os.close(reading)
    assert not isinstance(found, Diagnostic)
    assert found.text == "the sw shall satisfy q"


def test_no_more_is_read_than_a_text_may_have(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "MOST", 2**20)
    (tmp_path / "r.fret").write_bytes(bytes(2**20 + 1))
    with pytest.raises(OSError, match="it is larger than 1 MiB"):
        content(tmp_path / "r.fret")


def test_a_folder_is_called_a_folder(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError):
        open_regular(tmp_path)
