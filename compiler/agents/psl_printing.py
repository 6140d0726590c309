"""Formulas as text of an AJPF property file, which AJPF reads with the intended meaning.

AJPF's parser silently repairs invalid text and has its own precedences. So every operator is in
parentheses, and formulas that AJPF cannot express are refused before.
"""

from __future__ import annotations

from collections.abc import Callable

from compiler.logic import formula as f
from fretish.reading.recursion import with_recursion_limit


@with_recursion_limit
def property_text(formula: f.Formula, spell: Callable[[str], str]) -> str:
    """The formula in AJPF's language.

    Args:
        formula: `is_next_free`, and without constants.
        spell: the name of a proposition → its modality: `B(agent,too_close)`.

    Raises:
        AssertionError: the formula is not of AJPF's language.
    """

    def text(part: f.Formula) -> str:
        return property_text(part, spell)

    match formula:
        case f.Atom(name):
            return spell(name)
        case f.Not(f.Atom() as arg):
            return f"~{text(arg)}"
        case f.Not(arg):
            return f"~({text(arg)})"
        case f.And(args):
            return _joined(" & ", [text(arg) for arg in args])
        case f.Or(args):
            return _joined(" || ", [text(arg) for arg in args])
        case f.Implies(left, right):
            return f"({text(left)}) -> ({text(right)})"
        case f.Iff(left, right):
            return f"(({text(left)}) -> ({text(right)})) & (({text(right)}) -> ({text(left)}))"
        case f.Xor(left, right):
            return f"~({text(f.Iff(left, right))})"
        case f.Globally(arg, f.EVER):
            return f"[] ({text(arg)})"
        case f.Eventually(arg, f.EVER):
            return f"<> ({text(arg)})"
        case f.Until(left, right):
            return f"({text(left)}) U ({text(right)})"
        case f.Release(left, right):
            return f"({text(left)}) R ({text(right)})"
        case _:
            raise AssertionError(f"not of AJPF's language: {formula}")


def _joined(operator: str, texts: list[str]) -> str:
    """`((a) & (b)) & (c)`: AJPF's own grouping of a chain is never asked for."""
    result = f"({texts[0]})"
    for i, text in enumerate(texts[1:], 1):
        result = f"{result}{operator}({text})"
        result = f"({result})" if i < len(texts) - 1 else result
    return result
