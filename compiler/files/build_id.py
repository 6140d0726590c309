"""The identity of a build of fretc: equal builds make equal evidence from equal bytes."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from pathlib import Path

__version__ = "0.1.0"
PACKAGE = f"pkg:pypi/fretc@{__version__}"
"""The address of this version of the tool, as a package URL."""
_SITE = Path(__file__).parents[2]
_ROOMS = ("fretish", "monitors", "compiler", "fretc")
_LIBRARIES = ("lz4", "mcap", "mcap-ros1-support", "mcap-ros2-support", "numpy", "zstandard")
"""The libraries that affect verdicts, since they read logs."""


@cache
def build_id() -> str:
    """SHA-256 of fretc's source text, its version, and the versions of the log-reading libraries.

    The source text is included because a checkout changes without a new version.
    """
    digest = hashlib.sha256(f"{__version__} {platform.python_version()}".encode())
    for library in _LIBRARIES:
        digest.update(f" {library} {_version(library)}".encode())
    for room in _ROOMS:
        root = _SITE / room
        for path in sorted(root.rglob("*")):
            if path.suffix in (".py", ".lark", ".toml", ".gz"):
                text = path.read_bytes()
                digest.update(f"\n{room}/{path.relative_to(root)} {len(text)}\n".encode())
                digest.update(text)
    return digest.hexdigest()


def _version(library: str) -> str:
    from importlib.metadata import PackageNotFoundError, version  # 20 ms of each start

    try:
        return version(library)
    except PackageNotFoundError:
        return ""
