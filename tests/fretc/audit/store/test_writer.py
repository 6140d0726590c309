"""A writer that is killed at any moment leaves whole runs, and nothing that passes for complete."""

import shutil
from pathlib import Path

import pytest

from fretc.audit.store import container
from fretc.audit.store.container import packed, recovered, rows, unfinished
from fretc.audit.store.reader import Store, opened
from fretc.audit.store.writer import StoreFile, complete, publish
from fretish.diagnostics.diagnostic import Diagnostic
from tests.effort import some
from tests.fretc.audit.results import result
from tests.fretc.audit.store.test_law import document

RUNS = [[result(run=f"{name}.mcap", reason=name * 9_000)] for name in "abc"]


def places(path: Path) -> list[int]:
    with container.opened(path) as connection:
        return [row.place for row in rows(connection)]


@pytest.mark.slow
def test_whatever_part_of_the_last_bytes_was_written_the_runs_before_are_whole(
    tmp_path: Path,
) -> None:
    file = StoreFile(tmp_path / "unfinished-1.sqlite", "plan")
    sizes = []
    for place, run in enumerate(RUNS):
        file.put(packed(place, run))
        sizes.append((tmp_path / "unfinished-1.sqlite-wal").stat().st_size)
    base = (tmp_path / "unfinished-1.sqlite").read_bytes()
    changes = (tmp_path / "unfinished-1.sqlite-wal").read_bytes()
    file.discard()
    cuts = [*some(range(0, len(changes), 211), 5), *sizes, *(size - 1 for size in sizes)]
    for size in cuts:
        folder = tmp_path / f"{size}"
        folder.mkdir()
        path = folder / "unfinished-1.sqlite"
        path.write_bytes(base)
        (folder / f"{path.name}-wal").write_bytes(changes[:size])
        assert recovered(path)
        assert places(path) == [*range(sum(end <= size for end in sizes))], size
        found = opened(str(folder))
        assert isinstance(found, Diagnostic)
        assert found.message.endswith("its audit was not finished")
        assert [each.name for each in folder.iterdir()] == [path.name]


def test_a_file_gets_its_name_when_it_is_complete(tmp_path: Path) -> None:
    before = StoreFile(tmp_path / "unfinished-1.sqlite")
    before.put(packed(0, RUNS[0]))
    complete(before.path, document(), before.close())
    publish(before.path)
    file = StoreFile(tmp_path / "unfinished-1.sqlite")
    file.put(packed(0, RUNS[1]))
    first = opened(str(tmp_path))
    assert isinstance(first, Store)
    sha256 = complete(file.path, document(), file.close())
    assert opened(str(tmp_path)) == first
    publish(file.path)
    second = opened(str(tmp_path))
    assert isinstance(second, Store)
    assert second.sha256 == sha256 != first.sha256
    assert unfinished(tmp_path) == []


def test_the_files_of_stopped_audits_are_told_by_their_numbers(tmp_path: Path) -> None:
    for name in ("unfinished-10", "unfinished-9", "unfinished-0", "unfinished-1x", "unfinished-"):
        (tmp_path / f"{name}.sqlite").touch()
    assert [path.stem for path in unfinished(tmp_path)] == ["unfinished-9", "unfinished-10"]
    assert container.next_unfinished(tmp_path).stem == "unfinished-11"
    assert not recovered(tmp_path / "unfinished-9.sqlite")
    shutil.rmtree(tmp_path)
    assert unfinished(tmp_path) == []
