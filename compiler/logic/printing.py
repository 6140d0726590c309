"""Formulas as text, in the notation of each tool."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Mapping
from dataclasses import field
from types import MappingProxyType

from compiler.logic import formula as f
from compiler.logic.spelling.reserved_words import FRET as FRET_WORDS
from compiler.logic.spelling.reserved_words import NOTATION
from compiler.logic.spelling.reserved_words import SPOT as SPOT_WORDS
from fretish.classes.frozen import dataclass
from fretish.reading.recursion import with_recursion_limit

_ATOMIC, _UNARY, _BINARY, _AND, _OR, _XOR, _IMPLIES, _IFF = range(8)
"""Precedence ranks of operators: a higher rank binds looser."""

_MANGLED = {".": "_DOT_", "%": "_PRC_", " ": "_SPC_", '"': "_DQT_", "[": "_LSQ_", "]": "_RSQ_"}


_COMPOUND = re.compile(r"(?:[A-Za-z][A-Za-z0-9_.%]*)?\(.*\)", re.DOTALL)


def identifier(name: str) -> str:
    """A variable's name as FRET writes it in formulas: `a.b` becomes `a_DOT_b`."""
    return name if name.isascii() and name.isidentifier() else "".join(map(_mangled, name))


def _mangled(c: str) -> str:
    if (c.isalnum() and c.isascii()) or c == "_":
        return c
    return _MANGLED.get(c, f"_x{ord(c):X}_")


def is_compound(name: str) -> bool:
    """Whether an atom's name is the text of a comparison or a call, not a variable."""
    return _COMPOUND.fullmatch(name) is not None


def _plain_atom(name: str) -> str:
    """The atom, in quotes if it would read as an operator, such as `G`."""
    text = name if is_compound(name) else identifier(name)
    return f'"{text}"' if text in NOTATION else text


def _escaped(words: Container[str]) -> Callable[[str], str]:
    """A speller that writes reserved words as FRET writes quoted names, with `_DQT_`."""

    def atom(name: str) -> str:
        text = name if is_compound(name) else identifier(name)
        return _WORD.sub(lambda word: _DQT.format(word[0]) if word[0] in words else word[0], text)

    return atom


_DQT = "_DQT_{}_DQT_"
_WORD = re.compile(r'"[^"\n]*"|[A-Za-z_][A-Za-z0-9_.%]*')
"""A string or a name within the text of an atom."""
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def _quoted_atom(name: str) -> str:
    """The atom for Spot: a comparison is one proposition, in double quotes.

    A name that begins like one of Spot's operators is quoted, too: `Fault` would be `F ault`.
    """
    text = name if is_compound(name) else identifier(name)
    if text not in SPOT_WORDS and _IDENTIFIER.fullmatch(text):
        return text
    if text == "LAST":
        text = _DQT.format(text)  # Spot takes `"LAST"` for the same proposition as `LAST`
    escaped = re.sub(r'(["\\])', r"\\\1", text)
    return f'"{escaped}"'


def _bounds(opening: str, separator: str, closing: str) -> Callable[[f.Interval], str]:
    def text(interval: f.Interval) -> str:
        hi = "inf" if interval.hi is None else interval.hi
        return "" if interval == f.EVER else f"{opening}{interval.lo}{separator}{hi}{closing}"

    return text


_SQUARE = _bounds("[", ",", "]")


@dataclass(frozen=True, slots=True)
class Dialect:
    """The notation of formulas of one tool."""

    name: str
    constants: tuple[str, str] = ("FALSE", "TRUE")
    last: str = "LAST"
    not_: str = "!"
    and_: str = " & "
    or_: str = " | "
    xor: str = " xor "
    implies: str = " -> "
    iff: str = " <-> "
    operators: Mapping[str, str] = field(default_factory=dict)
    """Temporal operators that are not written by their letter."""
    bounds: Callable[[f.Interval], str] = _SQUARE
    atom: Callable[[str], str] = _plain_atom
    gap: str = " "
    """The text between a temporal operator and an operand without a parenthesis."""
    full: bool = False
    """Whether every operator is in parentheses."""
    has_past: bool = True
    has_bounded_since: bool = True


def _frozen(**operators: str) -> Mapping[str, str]:
    return MappingProxyType(operators)


def _latex_atom(name: str) -> str:
    escaped = re.sub(r"([_%&#$])", r"\\\1", _plain_atom(name))
    for symbol, command in (("<=", r"\le "), (">=", r"\ge "), ("!=", r"\ne ")):
        escaped = escaped.replace(symbol, command)
    return rf"\mathit{{{escaped}}}"


PLAIN = Dialect("plain")
FRET = Dialect("fret", operators=_frozen(R="V"), atom=_escaped(FRET_WORDS), has_bounded_since=False)
NUSMV = Dialect(
    "nusmv",
    operators=_frozen(R="V"),
    bounds=_bounds(" [", ",", "]"),
    has_bounded_since=False,
)
SPOT = Dialect(
    "spot",
    constants=("0", "1"),
    bounds=_bounds("[", ":", "]"),
    atom=_quoted_atom,
    has_past=False,
)
LATEX = Dialect(
    "latex",
    constants=(r"\bot", r"\top"),
    last=r"\mathsf{LAST}",
    not_=r"\lnot ",
    and_=r" \land ",
    or_=r" \lor ",
    xor=r" \oplus ",
    implies=r" \rightarrow ",
    iff=r" \leftrightarrow ",
    operators=MappingProxyType(
        {letter: rf"\mathbf{{{letter}}}" for letter in "XFGYZOH"}
        | {letter: rf"\mathbin{{\mathbf{{{letter}}}}}" for letter in "URS"}
    ),
    bounds=_bounds("_{[", ",", "]}"),
    atom=_latex_atom,
    gap=r"\,",
)
DIALECTS: Mapping[str, Dialect] = MappingProxyType(
    {dialect.name: dialect for dialect in (PLAIN, FRET, SPOT, NUSMV, LATEX)}
)

_FULL_FUTURE = Dialect(
    "full future",
    constants=("0", "1"),
    not_="! ",
    bounds=_bounds("[", ":", "]"),
    atom=_quoted_atom,
    full=True,
)
PCTL = Dialect("pctl", constants=("false", "true"), full=True)
_FULL_PAST = Dialect(
    "full past", not_="! ", atom=_escaped(NOTATION), full=True, has_bounded_since=False
)


def readable(formula: f.Formula) -> str:
    """The formula with as few parentheses as possible: `G(too_close -> F stopped)`."""
    return text(formula, PLAIN)


def future(formula: f.Formula) -> str:
    """Fully parenthesized future-time text that Spot reads, in FRET's notation.

    Constants are `1` and `0`, bounds `F[a:b]`, and a comparison or call is one proposition in
    double quotes. `LAST` is a proposition of its own.
    """
    return text(formula, _FULL_FUTURE)


def past(formula: f.Formula) -> str:
    """Fully parenthesized past-time text in FRET's notation: `TRUE`, `O[a,b]`, plain `S`."""
    return text(formula, _FULL_PAST)


@with_recursion_limit
def pctl(formula: f.Formula) -> str:
    """Fully parenthesized PCTL*, in operators that PRISM and Storm allow in path formulas.

    Implication and release are not among them: `a -> b` is `!a | b`, and `a R b` is `!(!a U !b)`.
    """
    return text(for_prism(formula), PCTL)


def for_prism(formula: f.Formula) -> f.Formula:
    """The formula in operators that PRISM and Storm allow in path formulas."""
    rebuilt = f.rebuild(formula, for_prism)
    match rebuilt:
        case f.Implies(left, right):
            return f.or_(f.not_(left), right)
        case f.Iff(left, right):
            return f.or_(f.and_(left, right), f.and_(f.not_(left), f.not_(right)))
        case f.Xor(left, right):
            return f.or_(f.and_(left, f.not_(right)), f.and_(f.not_(left), right))
        case f.Release(left, right):
            return f.not_(f.until(f.not_(left), f.not_(right)))
        case _:
            return rebuilt


@with_recursion_limit
def text(formula: f.Formula, dialect: Dialect) -> str:
    """The formula in a dialect, with as few parentheses as it allows."""
    plain = formula if dialect.has_bounded_since else without_bounded_since(formula)
    return _Printer(dialect).at(plain, _IFF)


def without_bounded_since(formula: f.Formula) -> f.Formula:
    """`p S[lo,hi] q` by plain `S`, `O` and `H`: the nearest q decides, and p since lo ticks ago."""
    rebuilt = f.rebuild(formula, without_bounded_since)
    match rebuilt:
        case f.Since(left, right, f.Interval(lo, hi)) if rebuilt.ago != f.EVER:
            near = f.since(left, right)
            if hi is not None:
                near = f.and_(near, f.once(right, f.Interval(0, hi - lo)))
            if lo == 0:
                return near
            guard = f.historically(left, f.Interval(0, lo - 1))
            return f.and_(guard, f.once(near, f.Interval(lo, lo)))
        case _:
            return rebuilt


class _Printer:
    """Prints formulas in one dialect, with the rank of the root operator."""

    def __init__(self, dialect: Dialect) -> None:
        self.dialect = dialect

    def at(self, formula: f.Formula, loosest: int) -> str:
        """The text, in parentheses if its operator binds looser than `loosest`."""
        rank, text = self.ranked(formula)
        if self.dialect.full and rank != _ATOMIC:
            return f"({text})"
        return text if rank <= loosest else f"({text})"

    def ranked(self, formula: f.Formula) -> tuple[int, str]:
        d = self.dialect
        match formula:
            case f.Const(value):
                return _ATOMIC, d.constants[value]
            case f.Atom(name):
                return _ATOMIC, d.atom(name)
            case f.Last():
                return _ATOMIC, d.last
            case f.ProbabilityBound(op, bound, arg):
                return _ATOMIC, f"P{op}{bound} [ {self.at(arg, _IFF)} ]"
            case f.Not(arg):
                return _UNARY, f"{d.not_}{self.at(arg, _UNARY)}"
            case f.And(args):
                return _AND, d.and_.join(self.at(arg, _BINARY) for arg in args)
            case f.Or(args):
                return _OR, d.or_.join(self.at(arg, _BINARY) for arg in args)
            case f.Xor(left, right):
                return _XOR, f"{self.at(left, _UNARY)}{d.xor}{self.at(right, _UNARY)}"
            case f.Implies(left, right):
                return _IMPLIES, f"{self.at(left, _OR)}{d.implies}{self.at(right, _IMPLIES)}"
            case f.Iff(left, right):
                return _IFF, f"{self.at(left, _OR)}{d.iff}{self.at(right, _OR)}"
            case _:
                return self.temporal(formula)

    def temporal(self, formula: f.Formula) -> tuple[int, str]:
        d = self.dialect
        letter, interval = _operator(formula)
        operator = d.operators.get(letter, letter) + d.bounds(interval)
        operands = f.children(formula)
        if len(operands) == 1:
            arg = self.at(operands[0], _UNARY)
            near = arg.startswith("(") and not d.full
            text = f"{operator}{'' if near else d.gap}{arg}"
            # The first tick reads as one thing: (Z FALSE).
            return (_ATOMIC, f"({text})") if formula == f.FIRST else (_UNARY, text)
        left, right = (self.at(operand, _UNARY) for operand in operands)
        return _BINARY, f"{left} {operator} {right}"


def _operator(formula: f.Formula) -> tuple[str, f.Interval]:
    """The letter of a temporal operator, and its bounds."""
    match formula:
        case f.Previous():
            return "Y", f.EVER
        case f.WeakPrevious():
            return "Z", f.EVER
        case f.Next():
            return "X", f.EVER
        case f.Once(_, ago):
            return "O", ago
        case f.Historically(_, ago):
            return "H", ago
        case f.Eventually(_, ahead):
            return "F", ahead
        case f.Globally(_, ahead):
            return "G", ahead
        case f.Since(_, _, ago):
            return "S", ago
        case f.Until():
            return "U", f.EVER
        case f.Release():
            return "R", f.EVER
        case _:
            raise AssertionError(f"not a temporal operator: {formula}")
