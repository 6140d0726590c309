"""A page of `fretc play`, opened where nothing can be asked of a network."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from fretc.play.page import html
from fretc.play.starts import Start
from tests.browsing import Visits
from tests.monitoring import requirement
from tests.play_pages import HOSTILE, Open

if TYPE_CHECKING:
    from playwright.sync_api import Page


@pytest.fixture
def opened(visits: Visits, tmp_path: Path) -> Open:
    """Opens a page."""
    numbers = count()

    def open_it(
        *sentences: str,
        starts: Sequence[Start] = (),
        before: Mapping[str, str] | None = None,
        **options: Any,
    ) -> Page:
        path = tmp_path / f"{next(numbers)}.html"
        requirements = [requirement(sentence, f"R{i}") for i, sentence in enumerate(sentences, 1)]
        path.write_text(
            html(requirements, [(HOSTILE, HOSTILE)], starts, before, [HOSTILE]), encoding="utf-8"
        )
        return visits.open(path, **options)

    return open_it
