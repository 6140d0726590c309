"""The explanations of all codes: cause, fix and example, from `fretish/diagnostics/codes/*.toml`.

An example has a text that gives the code (`wrong`) and the same text fixed. Each is a requirement
file (`kind = "fret"`, the default; `declared` holds its bindings) or a bindings file.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.messages import code_table


@dataclass(frozen=True, slots=True)
class CodeExplanation:
    """The cause of a code, its fix, and an example."""

    cause: str
    fix: str
    kind: str = "fret"
    """The kind of file of the example: `fret` or `bindings`."""
    wrong: str = ""
    """The text that gives the code; empty if there is no example."""
    fixed: str = ""
    declared: str = ""
    """The bindings of the example."""
    accept: str = ""
    """The subject of a warning, a key of `ACCEPTANCES`, which determines where it is accepted.

    Empty if it cannot be accepted: errors, warnings that a verdict may be wrong, unknown or about
    something else, and changes since a review.
    """


ACCEPTANCES = {
    "requirement": ("the header of the requirement", 'accept = {{ {0} = "the reason" }}'),
    "topic": ("fretc.toml", '[accept]\n{0} = {{ "/topic" = "the reason" }}'),
    "hazard": ("fretc.toml", '[accept]\n{0} = {{ "HAZ-1" = "the reason" }}'),
    "project": ("fretc.toml", '[accept]\n{0} = "the reason"'),
}
"""Subject of a warning → the file in which it is accepted, and the text to write there."""


@cache
def explanations() -> dict[str, CodeExplanation]:
    """Number of a code → its explanation."""
    return {code.number: explanation(code) for code in Code}


@cache
def explanation(code: Code) -> CodeExplanation:
    """The explanation of one code; only its table is parsed."""
    table = code_table(code)
    return CodeExplanation(**{name: text for name, text in table.items() if name != "messages"})


def text(code: Code) -> str:
    """The explanation of a code as text for the terminal."""
    known = explanation(code)
    blocks = [f"{code.number}  {code.summary}\n"]
    blocks.append(_block(_wrapped(known.cause)))
    blocks.append(_block(_wrapped(f"To fix it: {known.fix}")))
    if known.accept:
        where, example = ACCEPTANCES[known.accept]
        blocks.append(_example(f"to accept it, in {where}", example.format(code.number)))
    if known.declared:
        blocks.append(_example("bindings.toml", known.declared))
    if known.wrong:
        blocks.append(_example("wrong", known.wrong))
        blocks.append(_example("fixed", known.fixed))
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
    """The explanation as JSON: `{code, summary, cause, fix, example}`; absent parts are null."""
    known = explanation(code)
    example = None
    if known.wrong:
        example = {
            "file": known.kind,
            "bindings": known.declared or None,
            "wrong": known.wrong.strip("\n"),
            "fixed": known.fixed.strip("\n"),
        }
    return {
        "schema": "fretc-code-2",
        "code": code.number,
        "summary": code.summary,
        "cause": known.cause,
        "fix": known.fix,
        "accept": known.accept or None,
        "example": example,
    }
