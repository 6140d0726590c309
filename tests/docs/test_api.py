"""The examples of docs/api.md are true."""

import doctest
import shutil
from pathlib import Path

import pytest

import fretc

ROOT = Path(__file__).parent.parent.parent
DOCS = ROOT / "docs/api.md"


@pytest.mark.slow
def test_the_examples_give_what_they_show(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for folder in ("requirements", "traces"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.chdir(tmp_path)
    found = doctest.testfile(str(DOCS), module_relative=False, optionflags=doctest.REPORT_NDIFF)
    assert found.attempted > 20
    assert found.failed == 0


def test_every_name_is_documented() -> None:
    text = DOCS.read_text(encoding="utf-8")
    assert [name for name in fretc.__all__ if f"`{name}`" not in text] == []
