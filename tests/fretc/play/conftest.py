"""A page of `fretc play`, opened where nothing can be asked of a network."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from fretc.play.page import html
from fretc.play.starts import Start
from tests.monitoring import rule
from tests.play_pages import HOSTILE, Open

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


@pytest.fixture
def opened(browser: Browser, tmp_path: Path) -> Iterator[Open]:
    """Opens a page; at the end nothing was asked of the network and nothing complained."""
    messages: list[str] = []
    asked: list[str] = []
    contexts: list[Any] = []

    def open_it(
        *sentences: str,
        starts: Sequence[Start] = (),
        before: Mapping[str, str] | None = None,
        address: str = "",
        **options: Any,
    ) -> Page:
        path = tmp_path / f"{len(contexts)}.html"
        rules = [rule(sentence, f"R{i}") for i, sentence in enumerate(sentences, 1)]
        path.write_text(
            html(rules, [(HOSTILE, HOSTILE)], starts, before, [HOSTILE]), encoding="utf-8"
        )
        contexts.append(browser.new_context(offline=True, **options))
        page: Page = contexts[-1].new_page()
        page.on("console", lambda message: messages.append(message.text))
        page.on("pageerror", lambda error: messages.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(f"{path.as_uri()}{address}")
        return page

    yield open_it
    for context in contexts:
        context.close()
    assert messages == []
    assert not [url for url in asked if not url.startswith(("file:", "blob:"))]
