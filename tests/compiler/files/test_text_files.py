"""Where outputs go: no link that lies in the current folder leads one elsewhere."""

import errno
import os
import stat
from pathlib import Path

import pytest

from compiler.files import text_files
from compiler.files.text_files import is_file, read, unsaved_names, unsaved_texts, write
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from tests.command import Fretc


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A current folder within another one, with a file outside that must stay as it is."""
    (tmp_path / "here").mkdir()
    (tmp_path / "precious").write_text("precious")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


def link(path: str, target: str) -> None:
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).symlink_to(target)


@pytest.mark.parametrize(
    ("path", "target", "output"),
    [
        ("build/a.json", "../../precious", "build/a.json"),
        ("build/a.json", "../inside", "build/a.json"),
        ("a.json", "../precious", "a.json"),
        ("build", "../elsewhere", "build/a.json"),
        ("build/deep", "../../elsewhere", "build/deep/a.json"),
        ("build", "/tmp", "build/fretc/a.json"),
        ("build/a.json", "../../dangling", "build/a.json"),
    ],
)
def test_a_link_that_leads_out_is_not_followed(
    here: Path, path: str, target: str, output: str
) -> None:
    link(path, target)
    wrong = write({Path("first.txt"): "first", Path(output): "text"})
    assert wrong is not None
    assert wrong.code is Code.NOT_WRITTEN
    assert "is a link to" in wrong.message
    assert (here.parent / "precious").read_text() == "precious"
    assert not Path("first.txt").exists()
    assert not (here.parent / "dangling").exists()
    assert list((here.parent / "elsewhere").iterdir()) == []


def test_a_link_within_its_folder_is_followed(here: Path) -> None:
    link("build/latest.json", "run-7.json")
    assert write({Path("build/latest.json"): "text"}) is None
    assert Path("build/latest.json").is_symlink()
    assert Path("build/run-7.json").read_text() == "text"


@pytest.mark.parametrize("place", ["../elsewhere/a.json", "/linked/a.json"])
def test_a_place_that_the_user_names_may_be_anywhere(
    here: Path, tmp_path: Path, place: str
) -> None:
    (tmp_path / "linked").symlink_to(tmp_path / "elsewhere")
    path = Path(place.replace("/linked", str(tmp_path / "linked")))
    assert write({path: "text"}) is None
    assert (tmp_path / "elsewhere/a.json").read_text() == "text"


def test_a_file_is_private_until_it_is_whole(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []
    fchmod = os.fchmod

    def look(file: int, mode: int) -> None:
        seen.append(stat.S_IMODE(os.fstat(file).st_mode))
        fchmod(file, mode)

    monkeypatch.setattr(os, "fchmod", look)
    before = os.umask(0)
    try:
        assert write({Path("a.txt"): "text"}) is None
    finally:
        os.umask(before)
    assert seen == [0o600]
    assert stat.S_IMODE(Path("a.txt").stat().st_mode) == 0o666


def test_a_link_in_the_place_of_a_temporary_file_is_not_followed(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "urandom", bytes)
    link(".a.txt.00000000.tmp", "../precious")
    wrong = write({Path("a.txt"): "text"})
    assert wrong is not None
    assert (here.parent / "precious").read_text() == "precious"


def test_the_command_says_it(fretc: Fretc, tmp_path_factory: pytest.TempPathFactory) -> None:
    target = tmp_path_factory.mktemp("target") / "precious"
    target.write_text("precious")
    link("build/r.ltl", str(target))
    Path("r.fret").write_text("the rover shall always satisfy q")
    run = fretc("r.fret", "--emit", "ltl")
    assert run.status == 2
    assert run.err.startswith(
        f"F905 `build/r.ltl` cannot be written: it is a link to `{target}`: name `{target}` if you "
        "mean it\n"
    )
    assert target.read_text() == "precious"


def test_a_link_that_leads_nowhere_is_named_as_one(tmp_path: Path) -> None:
    link = tmp_path / "r1.fret"
    link.symlink_to("../gone.fret")
    wrong = read(str(link))
    assert isinstance(wrong, Diagnostic)
    assert wrong.help is not None
    assert "`../gone.fret`" in wrong.help


def test_a_read_only_disk_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def read_only(*_: object, **__: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(text_files, "_fill", read_only)
    monkeypatch.setattr(Path, "unlink", read_only)
    found = write({tmp_path / "x": "y"})
    assert found is not None
    assert f"`{tmp_path / 'x'}` cannot be written: Read-only" in found.message


def test_the_text_of_an_editor_hides_that_of_the_disk(tmp_path: Path) -> None:
    file, new = tmp_path / "r.fret", tmp_path / "new.fret"
    file.write_text("on the disk")
    with unsaved_texts({str(file): "unsaved", str(new): "nowhere else"}):
        assert read(str(file)) == Source(str(file), "unsaved")
        assert is_file(new)
        assert sorted(unsaved_names(str(tmp_path))) == ["new.fret", "r.fret"]
    assert read(str(file)) == Source(str(file), "on the disk")
    assert not is_file(new)
    assert unsaved_names(str(tmp_path)) == []
