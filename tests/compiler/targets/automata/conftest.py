"""How far automata are explored before they are refused."""

from __future__ import annotations

import pytest

from compiler.targets.automata import chart, expressibility
from tests.effort import FULL


@pytest.fixture
def most_states(monkeypatch: pytest.MonkeyPatch) -> int:
    """The limit: the product's own with the full profile, else one that is reached sooner."""
    most = chart.MOST_STATES if FULL else 3000
    for module in (chart, expressibility):
        monkeypatch.setattr(module, "MOST_STATES", most)
    return most
