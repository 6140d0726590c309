"""What a code means, why it matters, and how to fix it: data in `fretish/codes/*.toml`.

An example is a text that gives the code (`wrong`) and the same one fixed. It is a requirement file
(`kind = "fret"`, the default; `declared` are the bindings beside it) or a bindings file.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from fretish.diagnostics.diagnostic import Code


@dataclass(frozen=True, slots=True)
class Explanation:
    """The cause of a code, its remedy, and an example."""

    cause: str
    fix: str
    kind: str = "fret"
    """`fret` or `bindings`: which file the example is."""
    wrong: str = ""
    """Empty where there is no example."""
    fixed: str = ""
    declared: str = ""
    """The bindings that the example stands beside."""
    accept: str = ""
    """What a warning of the code is about, and so how it is accepted: a key of `ACCEPTANCES`.

    Empty where it cannot be: an error, and a warning that a verdict may be wrong, unknown, or about
    something else, have to be fixed; a change since a review has to be reviewed.
    """


ACCEPTANCES = {
    "requirement": ("the header of the requirement", 'accept = {{ {0} = "the reason" }}'),
    "topic": ("fretc.toml", '[accept]\n{0} = {{ "/topic" = "the reason" }}'),
    "hazard": ("fretc.toml", '[accept]\n{0} = {{ "HAZ-1" = "the reason" }}'),
    "project": ("fretc.toml", '[accept]\n{0} = "the reason"'),
}
"""Where a warning is accepted, and what is written there, by what it is about."""


@cache
def explanations() -> dict[str, Explanation]:
    """All of them, by the number of the code."""
    kinds = dict.fromkeys(code.number[1] for code in Code)
    return {number: each for kind in kinds for number, each in _of_kind(kind).items()}


def explanation(code: Code) -> Explanation:
    """That of one code: those of other kinds are not read."""
    return _of_kind(code.number[1])[code.number]


@cache
def _of_kind(kind: str) -> dict[str, Explanation]:
    """Those of the codes whose number begins with a digit, from the file of that digit."""
    (file,) = (Path(__file__).parent / "codes").glob(f"{kind}_*.toml")
    tables = tomllib.loads(file.read_text(encoding="utf-8"))
    return {number: Explanation(**fields) for number, fields in tables.items()}


def text(code: Code) -> str:
    """What the terminal shows."""
    explanation = explanations().get(code.number)
    blocks = [f"{code.number}  {code.summary}\n"]
    if explanation is None:
        return blocks[0]
    blocks.append(_block(_wrapped(explanation.cause)))
    blocks.append(_block(_wrapped(f"To fix it: {explanation.fix}")))
    if explanation.accept:
        place, example = ACCEPTANCES[explanation.accept]
        blocks.append(_example(f"to accept it, in {place}", example.format(code.number)))
    if explanation.declared:
        blocks.append(_example("bindings.toml", explanation.declared))
    if explanation.wrong:
        blocks.append(_example("wrong", explanation.wrong))
        blocks.append(_example("fixed", explanation.fixed))
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
    """`{code, summary, cause, fix, example}`; null where there is none."""
    explanation = explanations().get(code.number)
    example = None
    if explanation is not None and explanation.wrong:
        example = {
            "file": explanation.kind,
            "bindings": explanation.declared or None,
            "wrong": explanation.wrong.strip("\n"),
            "fixed": explanation.fixed.strip("\n"),
        }
    return {
        "schema": "fretc-code-2",
        "code": code.number,
        "summary": code.summary,
        "cause": explanation.cause if explanation else None,
        "fix": explanation.fix if explanation else None,
        "accept": (explanation.accept or None) if explanation else None,
        "example": example,
    }
