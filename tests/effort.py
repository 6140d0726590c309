"""How hard tests try: every case with the full profile of hypothesis, else one here and there.

Logs that others have recorded are read where `FRETC_LOGS` names their folder.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TypeVar

import pytest
from hypothesis import settings

Case = TypeVar("Case")
FULL = settings().max_examples > 1000
LOGS = Path(os.environ.get("FRETC_LOGS", ""))
needs_logs = pytest.mark.skipif(
    "FRETC_LOGS" not in os.environ, reason="set FRETC_LOGS to the folder of the public logs"
)


def full_only(why: str) -> pytest.MarkDecorator:
    """Skip a test but with the full profile."""
    return pytest.mark.skipif(not FULL, reason=f"{why}: HYPOTHESIS_PROFILE=full")


def some(cases: Iterable[Case], step: int, first: int = 0) -> list[Case]:
    """Return every `step`-th of the cases from the place `first` on; all with the full profile."""
    return [*cases] if FULL else [*cases][first::step]
