"""Print trees as text: canonical sentences, and expressions with minimal parentheses."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import assert_never

from fretish import expressions as e
from fretish import syntax as s
from fretish.checking import is_formula
from fretish.clock import duration_text
from fretish.keywords import RESERVED
from fretish.reading.recursion import with_recursion_limit

_IFF, _IMPLIES, _XOR, _OR, _AND, _NOT, _COMPARE, _SUM, _PRODUCT, _SIGN, _POWER, _OPERAND = range(12)
_PLAIN = re.compile(r"[A-Za-z](?:[A-Za-z0-9_.%]*[A-Za-z0-9_%])?")
_RANK = {"+": _SUM, "-": _SUM, "*": _PRODUCT, "/": _PRODUCT, "mod": _PRODUCT, "^": _POWER}

_MODES = {
    s.ScopeKind.IN: "in {} mode",
    s.ScopeKind.NOT_IN: "except in {} mode",
    s.ScopeKind.BEFORE: "before {} mode",
    s.ScopeKind.AFTER: "after {} mode",
    s.ScopeKind.ONLY_IN: "only in {} mode",
    s.ScopeKind.ONLY_BEFORE: "only before {} mode",
    s.ScopeKind.ONLY_AFTER: "only after {} mode",
}
_SCOPES = {
    s.ScopeKind.IN: "while {}",
    s.ScopeKind.NOT_IN: "except while {}",
    s.ScopeKind.BEFORE: "before {}",
    s.ScopeKind.AFTER: "after {}",
    s.ScopeKind.ONLY_IN: "only while {}",
    s.ScopeKind.ONLY_BEFORE: "only before {}",
    s.ScopeKind.ONLY_AFTER: "only after {}",
}


@with_recursion_limit
def canonical(tree: s.Sentence) -> str:
    """The canonical text of a sentence: equal for equal trees; the input of fingerprints."""
    condition = replace(tree.condition, word="") if tree.condition else None
    return sentence(replace(tree, article=False, condition=condition))


@with_recursion_limit
def sentence(tree: s.Sentence) -> str:
    """The text that `fretc fmt` writes; parsing it gives an equal tree.

    It keeps the author's choice of `the`, and of `when`, `if`, `where` or `upon`.
    """
    if is_formula(tree):
        article = "the " if tree.article else ""
        text = expression(tree.response)
        return f"{article}{identifier(tree.component)} shall satisfy formula: {text}"
    parts = [
        f"{scope(tree.scope)}," if tree.scope else "",
        condition(tree.condition) if tree.condition else "",
        f"{'the ' if tree.article else ''}{identifier(tree.component)} shall",
        f"with probability {tree.probability.op} {tree.probability.digits}"
        if tree.probability
        else "",
        timing(tree.timing),
        f"satisfy {expression(tree.response)}",
    ]
    return " ".join(part for part in parts if part)


def scope(tree: s.Scope) -> str:
    """A scope as text: `in m mode` for a single variable, else `while ...`."""
    wordings = _MODES if isinstance(tree.mode, e.Name) else _SCOPES
    return wordings[tree.kind].format(expression(tree.mode))


def condition(tree: s.Condition) -> str:
    """A condition as text: `whenever p`, or `upon p` with the author's key word."""
    if tree.kind is s.ConditionKind.HOLDING:
        return f"whenever {expression(tree.expression)}"
    word = tree.word if tree.word in ("when", "if", "where") else "upon"
    return f"{word} {expression(tree.expression)}"


def timing(tree: s.Timing) -> str:
    """A timing as text: `within 3 seconds`; empty if the sentence has no timing."""
    match tree:
        case s.Immediately():
            return "immediately"
        case s.Next():
            return "at the next timepoint"
        case s.Finally():
            return "finally"
        case s.Eventually(explicit):
            return "eventually" if explicit else ""
        case s.Always():
            return "always"
        case s.Never():
            return "never"
        case s.Within(duration):
            return f"within {duration_text(duration)}"
        case s.For(duration):
            return f"for {duration_text(duration)}"
        case s.After(duration):
            return f"after {duration_text(duration)}"
        case s.Until(stop):
            return f"until {expression(stop)}"
        case s.Before(stop):
            return f"before {expression(stop)}"
        case _:
            assert_never(tree)


def identifier(id: str) -> str:
    """The name, in quotes if necessary."""
    plain = _PLAIN.fullmatch(id) and id.lower() not in RESERVED
    return id if plain else f'"{id}"'


@with_recursion_limit
def expression(tree: e.Expression) -> str:
    """An expression as FRETish text; operators that only bindings have keep their spelling."""
    return _at(tree, _IFF)


def _at(tree: e.Expression, loosest: int) -> str:
    """The text, in parentheses if its precedence is lower than `loosest`."""
    rank, text = _ranked(tree)
    return text if rank >= loosest else f"({text})"


def _ranked(tree: e.Expression) -> tuple[int, str]:
    match tree:
        case e.Truth(value):
            return _OPERAND, str(value).lower()
        case e.Name(id) | e.Calculation(id):
            return _OPERAND, identifier(id)
        case e.Number(digits):
            return _OPERAND, digits
        case e.Quantity(digits, unit):
            return _OPERAND, f"{digits} {unit}"
        case e.Word(text):
            return _OPERAND, identifier(text)
        case e.Call(name, args):
            return _OPERAND, f"{identifier(name)}({', '.join(expression(arg) for arg in args)})"
        case e.Negation(arg):
            return _SIGN, f"-{_at(arg, _SIGN)}"
        case e.Not(arg):
            return _NOT, f"!{_at(arg, _OPERAND)}"
        case e.Persistence(arg, duration):
            return _IFF, f"{_at(arg, _OR)} for {duration} ns"
        case e.Temporal():
            return _temporal(tree)
        case e.And(args):
            return _AND, " & ".join(_at(arg, _NOT) for arg in args)
        case e.Or(args):
            return _OR, " | ".join(_at(arg, _AND) for arg in args)
        case _:
            return _binary(tree)


def _temporal(tree: e.Temporal) -> tuple[int, str]:
    """`G (a -> F b)`, `a U b`: as `!` and as `&` with operands that are not themselves joined."""
    if len(tree.args) == 1:
        bounds = "" if tree.bounds is None else f"[{tree.bounds[0]},{tree.bounds[1]}]"
        return _NOT, f"{tree.operator}{bounds} {_at(tree.args[0], _NOT)}"
    left, right = (_at(arg, _NOT) for arg in tree.args)
    return _AND, f"{left} {tree.operator} {right}"


def _binary(
    tree: e.Xor | e.Implies | e.Iff | e.Comparison | e.Arithmetic,
) -> tuple[int, str]:
    match tree:
        case e.Xor(left, right):
            return _XOR, f"{_at(left, _XOR)} xor {_at(right, _OR)}"
        case e.Implies(left, right):
            return _IMPLIES, f"{_at(left, _XOR)} -> {_at(right, _IMPLIES)}"
        case e.Iff(left, right):
            return _IFF, f"{_at(left, _IFF)} <-> {_at(right, _IMPLIES)}"
        case e.Comparison(op, left, right):
            return _COMPARE, f"{_at(left, _SUM)} {op} {_at(right, _SUM)}"
        case e.Arithmetic("^", left, right):
            return _POWER, f"{_at(left, _OPERAND)} ^ {_at(right, _SIGN)}"
        case e.Arithmetic(op, left, right):
            rank = _RANK[op]
            return rank, f"{_at(left, rank)} {op} {_at(right, rank + 1)}"
        case _:
            assert_never(tree)
