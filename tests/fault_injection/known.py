"""Faults that somebody has written down: wrong answers once there, changes without effect."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.fault_injection.drawing import Fault, Place

HERE = Path(__file__).parent


@dataclass(frozen=True, slots=True)
class Misfit:
    """A known fault whose text the tree does not have, or has more than once."""

    path: str
    old: str
    times: int


def known(root: Path) -> Iterator[Fault | Misfit]:
    """Read `known.toml`: wrong answers that were once there, as changes of today's text."""
    for entry in tomllib.loads(HERE.joinpath("known.toml").read_text("utf-8"))["fault"]:
        path = root / entry["path"]
        text = path.read_bytes() if path.is_file() else b""
        old = entry["old"].encode()
        if text.count(old) == 1:
            place = Place(entry["path"])
            yield Fault(place, text.index(old), entry["old"], entry["new"], entry["what"])
        else:
            yield Misfit(entry["path"], entry["old"], text.count(old))


def equivalent() -> dict[str, str]:
    """Read `equivalent.toml`: ids of drawn faults that no test could find, and why."""
    return dict(tomllib.loads(HERE.joinpath("equivalent.toml").read_text("utf-8")))
