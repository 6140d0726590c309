"""Numbers, names, paths and lists in words."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import PurePosixPath, PureWindowsPath

from fretc.logs.storage.log_names import path_of
from fretc.traceability.chain import ChainItem
from fretish.bindings import amounts
from fretish.bindings.amounts import duration as duration
from fretish.bindings.amounts import exact_duration as exact_duration
from fretish.bindings.amounts import instant as instant
from fretish.bindings.amounts import value as value
from fretish.documents import named as named

_NARROW = "\N{NARROW NO-BREAK SPACE}"


def times(count: int, one: str, many: str = "") -> str:
    """`1 run`, `2 runs`, `3 latencies`."""
    return f"{whole(count)} {one if count == 1 else many or one + 's'}"


def every(count: int, one: str, many: str = "") -> str:
    """`the only run`, `all 2 runs`; of none `no run`."""
    if count <= 1:
        return f"the only {one}" if count else f"no {one}"
    return f"all {times(count, one, many)}"


def whole(number: int) -> str:
    """`1 852 914`: digits in groups of three, with narrow spaces that do not break."""
    return f"{number:,}".replace(",", _NARROW)


def joined(words: Sequence[str]) -> str:
    """`a`, `a and b`, `a, b and c`."""
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))


def some(words: Sequence[str], most: int = 6) -> str:
    """`a, b and 12 more`: the first ones, where there are many."""
    left = len(words) - most
    return joined(words) if left <= 1 else joined([*words[:most], f"{whole(left)} more"])


def decimal(number: float) -> str:
    """At most three decimals, and digits in groups of three: `39.8`, `0.001`, `1 852`."""
    return amounts.decimal(number, _NARROW)


def seconds(number: float) -> str:
    """A time from the first tick of a run: `39.8 s`."""
    return f"{decimal(number)} s"


def size(count: int | None) -> str:
    """Bytes in decimal units: `1.85 MB (1 852 914 bytes)`."""
    if count is None:
        return "not known"
    exact = times(count, "byte")
    for factor, name in ((10**9, "GB"), (10**6, "MB"), (10**3, "kB")):
        if count >= factor:
            return f"{count / factor:.3g} {name} ({exact})"
    return exact


@lru_cache(2**14)
def place(path: str) -> str:
    """A path independent of the machine: only the last part of an absolute path."""
    if PurePosixPath(path).is_absolute():
        return PurePosixPath(path).name or path
    if path_of(path) == path and (PureWindowsPath(path).drive or path.startswith("\\")):
        return PureWindowsPath(path).name or path
    return path


def thing(node: ChainItem) -> str:
    """The name of a node for a reader: `artefact r1_monitor.py`, `the clock`."""
    return "the clock" if node.kind == "clock" else f"{node.kind} {place(node.name)}"


def visible(text: str) -> str:
    """The text with escapes for control and direction characters, which hide or turn text."""
    if text.isprintable():
        return text
    return "".join(c if _is_plain(c) else _escape(c) for c in text)


def _is_plain(character: str) -> bool:
    return character.isprintable() or character == "\n" or character in _SPACES


_SPACES = "\N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}\N{IDEOGRAPHIC SPACE}"


def _escape(character: str) -> str:
    if character == "\t":
        return " "
    return character.encode("unicode_escape").decode("ascii")
