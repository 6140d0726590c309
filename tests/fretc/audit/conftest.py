"""Audits work in this process alone, but in tests that are `confined`."""

import pytest

from tests.command import without_processes


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    if "confined" not in request.keywords:
        without_processes(monkeypatch)
