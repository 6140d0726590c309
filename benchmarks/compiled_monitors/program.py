"""What is made of a monitor to measure it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Program:
    """What was built."""

    path: Path
    code: int
    """Bytes of the monitor's own machine code and constants; in Java, of its class files."""
    data: int
    """Bytes of its static variables."""
