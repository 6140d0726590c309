"""The analysis gives the same answers by the engine of Spot."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.effort import FULL

ROOT = Path(__file__).parents[4]


@pytest.mark.slow
def test_the_tests_of_the_analysis_pass_with_buddy() -> None:
    """Those that are not slow; all with the full profile."""
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-n0", "tests/fretc/analysis"]
        + ([] if FULL else ["-m", "not slow"]),
        env={**os.environ, "FRETC_DIAGRAMS": "buddy"},
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout
