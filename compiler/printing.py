"""Formula → text, in the spelling of each tool that reads it."""

from __future__ import annotations

import re

from compiler import formula as f

_ATOMIC, _UNARY, _BINARY, _AND, _OR, _XOR, _IMPLIES, _IFF = range(8)
"""How loose an operator binds."""

_MANGLED = {".": "_DOT_", "%": "_PRC_", " ": "_SPC_", '"': "_DQT_", "[": "_LSQ_", "]": "_RSQ_"}
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def identifier(name: str) -> str:
    """A variable's name as FRET writes it in formulas: `a.b` becomes `a_DOT_b`.

    Raises:
        AssertionError: the name is no variable but the text of a comparison or call.
    """
    assert not is_compound(name)
    return "".join(c if c.isalnum() and c.isascii() else _MANGLED.get(c, "_") for c in name)


def is_compound(name: str) -> bool:
    """Whether an atom's name is the text of a comparison or a call, not a variable."""
    return name.endswith(")") and not name.startswith('"')


# For people ----------------------------------------------------------------------------------


def readable(formula: f.Formula) -> str:
    """With as few parentheses as may be: `G(too_close -> F stopped)`."""
    return _loose(formula, _IFF)


def _loose(formula: f.Formula, loosest: int) -> str:
    rank, text = _ranked(formula)
    return text if rank <= loosest else f"({text})"


def _ranked(formula: f.Formula) -> tuple[int, str]:
    match formula:
        case f.Const(value):
            return _ATOMIC, str(value).upper()
        case f.Atom(name):
            return _ATOMIC, name if is_compound(name) else identifier(name)
        case f.Last():
            return _ATOMIC, "LAST"
        case f.WeakPrevious(f.Const(False)):
            return _ATOMIC, "(Z FALSE)"
        case f.Not(arg):
            return _UNARY, f"!{_loose(arg, _UNARY)}"
        case f.And(args):
            return _AND, " & ".join(_loose(arg, _BINARY) for arg in args)
        case f.Or(args):
            return _OR, " | ".join(_loose(arg, _BINARY) for arg in args)
        case f.Xor(left, right):
            return _XOR, f"{_loose(left, _UNARY)} xor {_loose(right, _UNARY)}"
        case f.Implies(left, right):
            return _IMPLIES, f"{_loose(left, _OR)} -> {_loose(right, _IMPLIES)}"
        case f.Iff(left, right):
            return _IFF, f"{_loose(left, _OR)} <-> {_loose(right, _OR)}"
        case _:
            return _temporal(formula)


def _temporal(formula: f.Formula) -> tuple[int, str]:
    operator, args = _operator(formula, ",")
    if len(args) == 1:
        arg = _loose(args[0], _UNARY)
        return _UNARY, f"{operator}{arg}" if arg.startswith("(") else f"{operator} {arg}"
    left, right = args
    return _BINARY, f"{_loose(left, _UNARY)} {operator} {_loose(right, _UNARY)}"


def _operator(formula: f.Formula, colon: str) -> tuple[str, tuple[f.Formula, ...]]:
    """The temporal operator with its bounds, and its arguments."""
    match formula:
        case f.Previous(arg):
            return "Y", (arg,)
        case f.WeakPrevious(arg):
            return "Z", (arg,)
        case f.Next(arg):
            return "X", (arg,)
        case f.Once(arg, ago):
            return f"O{_bounds(ago, colon)}", (arg,)
        case f.Historically(arg, ago):
            return f"H{_bounds(ago, colon)}", (arg,)
        case f.Eventually(arg, ahead):
            return f"F{_bounds(ahead, colon)}", (arg,)
        case f.Globally(arg, ahead):
            return f"G{_bounds(ahead, colon)}", (arg,)
        case f.Since(left, right, ago):
            return f"S{_bounds(ago, colon)}", (left, right)
        case f.Until(left, right):
            return "U", (left, right)
        case f.Release(left, right):
            return "R", (left, right)
        case _:
            raise AssertionError(f"not a temporal operator: {formula}")


def _bounds(interval: f.Interval, colon: str) -> str:
    if interval == f.EVER:
        return ""
    return f"[{interval.lo}{colon}{'inf' if interval.hi is None else interval.hi}]"


# For machines --------------------------------------------------------------------------------


def future(formula: f.Formula) -> str:
    """Fully parenthesized future-time text that Spot reads, in FRET's notation.

    Constants are `1` and `0`, bounds `F[a:b]`, and a comparison or call is one proposition in
    double quotes. `LAST` is a proposition of its own.
    """
    return _full(formula, ":", ("0", "1"), '"{}"')


def past(formula: f.Formula) -> str:
    """Fully parenthesized past-time text in FRET's notation: `TRUE`, `O[a,b]`, `S`."""
    return _full(formula, ",", ("FALSE", "TRUE"), "{}")


def _full(formula: f.Formula, colon: str, constants: tuple[str, str], compound: str) -> str:
    def text(part: f.Formula) -> str:
        return _full(part, colon, constants, compound)

    match formula:
        case f.Const(value):
            return constants[value]
        case f.Atom(name):
            return compound.format(name) if is_compound(name) else identifier(name)
        case f.Last():
            return "LAST"
        case f.Not(arg):
            return f"(! {text(arg)})"
        case f.And(args):
            return f"({' & '.join(map(text, args))})"
        case f.Or(args):
            return f"({' | '.join(map(text, args))})"
        case f.Xor(left, right):
            return f"({text(left)} xor {text(right)})"
        case f.Implies(left, right):
            return f"({text(left)} -> {text(right)})"
        case f.Iff(left, right):
            return f"({text(left)} <-> {text(right)})"
        case _:
            return _full_temporal(formula, colon, constants, compound)


def _full_temporal(
    formula: f.Formula, colon: str, constants: tuple[str, str], compound: str
) -> str:
    operator, args = _operator(formula, colon)
    texts = [_full(arg, colon, constants, compound) for arg in args]
    if len(texts) == 1:
        return f"({operator} {texts[0]})"
    return f"({texts[0]} {operator} {texts[1]})"
