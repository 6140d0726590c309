"""One edition for one text of the program, and another for any other."""

import importlib.metadata
import shutil
from pathlib import Path

import pytest

from compiler.files import build_id as module
from compiler.files.build_id import build_id

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the program; each test undoes what it changes."""
    folder = tmp_path_factory.mktemp("copied")
    for room in ("fretish", "monitors", "compiler", "fretc"):
        shutil.copytree(ROOT / room, folder / room, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


@pytest.fixture
def copy(copied: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the program, of which the edition is reported."""
    monkeypatch.setattr(module, "_SITE", copied)
    return copied


def edition_now() -> str:
    return build_id.__wrapped__()


@pytest.mark.slow
def test_a_copy_is_the_same_edition(copy: Path) -> None:
    assert edition_now() == build_id()


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "fretish/grammar.lark",
        "fretish/diagnostics/codes/4_logs.toml",
        "monitors/kernel/columns.py",
        "fretc/audit/many_logs.py",
    ],
)
def test_a_changed_text_is_another_edition(copy: Path, name: str) -> None:
    text = (copy / name).read_bytes()
    (copy / name).write_bytes(text + b"\n")
    assert edition_now() != build_id()
    (copy / name).write_bytes(text)
    assert edition_now() == build_id()


@pytest.mark.slow
def test_a_file_more_is_another_edition(copy: Path) -> None:
    (copy / "monitors/more.py").touch()
    assert edition_now() != build_id()
    (copy / "monitors/more.py").unlink()


def test_another_library_is_another_edition(monkeypatch: pytest.MonkeyPatch) -> None:
    before = edition_now()
    monkeypatch.setattr(importlib.metadata, "version", lambda library: "0")
    assert edition_now() != before
