"""Files are locked, replaced and read at a place, also without what only POSIX has."""

import os
import sys
from pathlib import Path

import pytest

from fretish.system import files
from fretish.system.files import FolderLock, for_second_thread, read_at, replace, set_permissions


def test_a_folder_is_locked_until_the_lock_is_released(tmp_path: Path) -> None:
    first = FolderLock(tmp_path)
    with pytest.raises(BlockingIOError):
        FolderLock(tmp_path)
    first.release()
    FolderLock(tmp_path).release()
    assert [*tmp_path.iterdir()] == []


def test_a_folder_that_is_missing_or_a_file_is_not_locked(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(FileNotFoundError):
        FolderLock(tmp_path / "none")
    with pytest.raises(NotADirectoryError):
        FolderLock(tmp_path / "file")


def test_bytes_are_read_at_a_place_with_and_without_pread(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "log"
    path.write_bytes(b"0123456789")
    with path.open("rb") as stream:
        assert (read_at(stream.fileno(), 3, 4), stream.tell()) == (b"456", 0)
        monkeypatch.delattr(os, "pread")
        assert read_at(stream.fileno(), 3, 4) == b"456"
        assert read_at(stream.fileno(), 5, 8) == b"89"
        assert read_at(stream.fileno(), 5, 20) == b""


def test_a_second_thread_leaves_the_position_of_the_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, moved = tmp_path / "log", tmp_path / "moved"
    path.write_bytes(b"0123456789")
    with path.open("rb", buffering=0) as stream:
        monkeypatch.delattr(os, "pread")
        own = for_second_thread(stream.fileno(), str(path))
        assert (stream.read(2), read_at(own, 3, 4), stream.read(2)) == (b"01", b"456", b"23")
        os.close(own)
        path.rename(moved)
        path.write_bytes(b"0123456789")
        with pytest.raises(OSError, match="its name now belongs to another file"):
            for_second_thread(stream.fileno(), str(path))


def test_windows_replaces_a_file_as_soon_as_nobody_reads_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source, target, pauses = tmp_path / "new", tmp_path / "old", list[float]()
    monkeypatch.setattr(sys, "platform", "win32")
    original = Path.replace

    def refused_twice(self: Path, to: Path) -> Path:
        if len(pauses) < 2:
            raise PermissionError(13, "in use")
        return original(self, to)

    monkeypatch.setattr(Path, "replace", refused_twice)
    monkeypatch.setattr(files.time, "sleep", pauses.append)  # type: ignore[attr-defined]
    source.write_bytes(b"new")
    target.write_bytes(b"old")
    replace(source, target)
    assert (target.read_bytes(), source.exists(), pauses) == (b"new", False, [0.05, 0.05])


def test_windows_reports_a_file_that_somebody_keeps_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pauses: list[float] = []

    def refused(self: Path, to: Path) -> Path:
        raise PermissionError(13, "in use")

    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setattr(Path, "replace", refused)
    monkeypatch.setattr(files.time, "sleep", pauses.append)  # type: ignore[attr-defined]
    with pytest.raises(PermissionError):
        replace(tmp_path / "new", tmp_path / "old")
    assert sum(pauses) == pytest.approx(1.0)


def test_permissions_are_set_with_and_without_fchmod(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file"
    with path.open("wb") as stream:
        set_permissions(path, stream.fileno(), 0o640)
        assert path.stat().st_mode & 0o777 == 0o640
        monkeypatch.delattr(os, "fchmod")
        set_permissions(path, stream.fileno(), 0o600)
        assert path.stat().st_mode & 0o777 == 0o600
