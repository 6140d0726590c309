"""Copilot's C for many requirements: its C for each, in one file in its order."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from benchmarks.compiled_monitors.requirement_files import BOUNDS, Demand

_FOLDER = Path(__file__).parents[1] / "peers" / "copilot"
_INCLUDES = "".join(
    f"#include <{name}.h>\n" for name in "stdint stdbool string stdlib math".split()
)
_PLACES = (
    r"  \w+ \w+;",
    r"  \(\w+_cpy\)",
    r"  if ",
    r"  \(\w+_tmp\)",
    r"  \(\(\w+\)\[",
    r"  \(\w+_idx\)",
)
"""How the lines of its step begin, in the order in which they come."""


def text(demands: Sequence[Demand], style: str) -> str | None:
    """The file; None: it is not written in this style.

    Args:
        demands: of any propositions.
        style: "library" or "counter", which has the library's operators where those count nothing.
    """
    files = [_file(each, style) for each in demands]
    parts = [
        _renamed(place, each, file)
        for place, (each, file) in enumerate(zip(demands, files, strict=True))
        if file is not None
    ]
    if len(parts) < len(files):
        return None
    names = dict.fromkeys(name for each in demands for name in each.names.values())
    outside, steps = zip(*(part.split("void step(void) {\n") for part in parts), strict=True)
    lines = [line for body in steps for line in _statements(body)]
    ordered = [line for place in _PLACES for line in dict.fromkeys(lines) if re.match(place, line)]
    declared = "".join(f"extern bool {name};\nstatic bool {name}_cpy;\n" for name in names)
    triggers = "".join(f"void r{place}_verdict(bool);\n" for place in range(len(parts)))
    step = "\n".join(ordered)
    return f"{_INCLUDES}{declared}{triggers}{''.join(outside)}void step(void) {{\n{step}\n}}\n"


def _file(demand: Demand, style: str) -> str | None:
    """What the generator wrote for such a requirement, with this bound in its counters."""
    usual = BOUNDS.get(demand.kind, 0)
    counter, library = (
        _FOLDER / f"{demand.kind.lower()}_{each}.c" for each in ("counter", "library")
    )
    if style == "library" or not counter.is_file():
        return library.read_text(encoding="utf-8") if demand.bound == usual else None

    def shifted(number: re.Match[str]) -> str:
        return f"(int32_t)({int(number[1]) + demand.bound - usual})"

    numbers = rf"\(int32_t\)\(({usual - 1}|{usual}|{usual + 1})\)"
    return re.sub(numbers, shifted, counter.read_text(encoding="utf-8"))


def _renamed(place: int, demand: Demand, found: str) -> str:
    """Without what comes once in a file; with names of its own."""
    lines = found.splitlines(keepends=True)
    kept = "".join(line for line in lines if not re.match(r"#|static bool [abc]_cpy;", line))
    own = re.sub(r"\b(s\d+(?:_\w+)?|verdict\w*)\b", rf"r{place}_\1", kept)
    return re.sub(r"\b([abc])(?=_cpy\b|\b)", lambda match: demand.names[match[1]], own)


def _statements(body: str) -> list[str]:
    """Lines of the step; a trigger is one."""
    return re.findall(r"  if .*?^  \};|  [^\n]+;", body, re.S | re.M)
