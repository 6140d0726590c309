from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.editor import Editor


@pytest.fixture
def editor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Editor]]:
    """Start an editor whose workspace is the folder of the test."""
    monkeypatch.chdir(tmp_path)
    editors: list[Editor] = []

    def start(encoding: str = "utf-16", **options: Any) -> Editor:
        editors.append(Editor(tmp_path, encoding, **options))
        return editors[-1]

    yield start
    for each in editors:
        each.close()
