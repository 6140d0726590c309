"""Audits work in this process alone, but in tests that are `confined` and with the full profile."""

import pytest

from tests.command import without_processes
from tests.effort import FULL


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    if "confined" not in request.keywords and not FULL:
        without_processes(monkeypatch)
