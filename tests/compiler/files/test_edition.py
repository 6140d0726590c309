"""One edition for one text of the program, and another for any other."""

import importlib.metadata
import shutil
from pathlib import Path

import pytest

from compiler.files import edition as module
from compiler.files.edition import edition

ROOT = Path(__file__).parents[3]


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the program, of which the edition is told."""
    for room in ("fretish", "monitors", "compiler", "fretc"):
        shutil.copytree(ROOT / room, tmp_path / room)
    monkeypatch.setattr(module, "_SITE", tmp_path)
    return tmp_path


def edition_now() -> str:
    return edition.__wrapped__()


def test_a_copy_is_the_same_edition(copy: Path) -> None:
    assert edition_now() == edition()


@pytest.mark.parametrize(
    "name", ["fretish/grammar.lark", "monitors/kernel/columns.py", "fretc/audit/many_logs.py"]
)
def test_a_changed_text_is_another_edition(copy: Path, name: str) -> None:
    (copy / name).write_text((copy / name).read_text("utf-8") + "\n", "utf-8")
    assert edition_now() != edition()


def test_a_file_more_is_another_edition(copy: Path) -> None:
    (copy / "monitors/more.py").touch()
    assert edition_now() != edition()


def test_another_library_is_another_edition(monkeypatch: pytest.MonkeyPatch) -> None:
    before = edition_now()
    monkeypatch.setattr(importlib.metadata, "version", lambda library: "0")
    assert edition_now() != before
