"""What a code means, why it matters, and how to mend it: data in `fretish/codes/*.toml`.

An example is a text that gives the code (`wrong`) and the same one mended. It is a requirement file
(`kind = "fret"`, the default; `declared` are the bindings beside it) or a bindings file.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from fretish.diagnostics.diagnostic import Code


@dataclass(frozen=True, slots=True)
class Explained:
    """What there is to say of a code beyond its one line."""

    cause: str
    mend: str
    kind: str = "fret"
    """`fret` or `bindings`: which file the example is."""
    wrong: str = ""
    """Empty where there is no example."""
    mended: str = ""
    declared: str = ""
    """The bindings that the example stands beside."""


@cache
def explanations() -> dict[str, Explained]:
    """All of them, by the number of the code."""
    found: dict[str, Explained] = {}
    for file in files("fretish.diagnostics").joinpath("codes").iterdir():
        if file.name.endswith(".toml"):
            tables = tomllib.loads(file.read_text(encoding="utf-8"))
            found |= {number: Explained(**fields) for number, fields in tables.items()}
    return found


def text(code: Code) -> str:
    """What the terminal shows."""
    explained = explanations().get(code.number)
    blocks = [f"{code.number}  {code.summary}\n"]
    if explained is None:
        return blocks[0]
    blocks.append(_block(_wrapped(explained.cause)))
    blocks.append(_block(_wrapped(f"To mend it: {explained.mend}")))
    if explained.declared:
        blocks.append(_example("bindings.toml", explained.declared))
    if explained.wrong:
        blocks.append(_example("wrong", explained.wrong))
        blocks.append(_example("mended", explained.mended))
    return "\n".join(blocks)


_WIDTH = 92


def _wrapped(paragraph: str) -> list[str]:
    lines: list[str] = []
    for word in paragraph.split():
        if lines and len(lines[-1]) + len(word) < _WIDTH:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines


def _block(lines: list[str]) -> str:
    return "".join(f"  {line}\n" for line in lines)


def _example(name: str, example: str) -> str:
    lines = example.strip("\n").splitlines()
    return f"  {name}:\n" + "".join(f"    {line}".rstrip() + "\n" for line in lines)


def as_record(code: Code) -> dict[str, Any]:
    """`{code, summary, cause, mend, example}`; null where there is none."""
    explained = explanations().get(code.number)
    example = None
    if explained is not None and explained.wrong:
        example = {
            "file": explained.kind,
            "bindings": explained.declared or None,
            "wrong": explained.wrong.strip("\n"),
            "mended": explained.mended.strip("\n"),
        }
    return {
        "schema": "fretc-code-1",
        "code": code.number,
        "summary": code.summary,
        "cause": explained.cause if explained else None,
        "mend": explained.mend if explained else None,
        "example": example,
    }
