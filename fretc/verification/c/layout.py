"""Check that a monitor in C has the layout that fretc writes, before anything runs.

The header, the types and the functions that lead to the step must equal those of fretc token for
token. The body of the step and the initial state may differ, within statements that assign an
expression to one cell, signal or local truth value. Such statements have no call, loop, pointer or
address, so they access only the memory of the approximation, and a step depends on nothing else.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import zip_longest

from fretc.verification.compiled.flow import BlockFlow, CheckedLayout
from fretc.verification.compiled.text import (
    NAME,
    Lexis,
    Tokens,
    UnexpectedLayoutError,
    bodies,
    is_constant,
    statements,
    strange,
)

LEXIS = Lexis(
    re.compile(
        r"(?!<:|:>|<%|%>|%:|\?\?)"  # Alternative spellings of brackets, braces, operators and `#`.
        r"(?:(?P<gap>[ \t\r\n]+|/\*.*?\*/)"
        r"|#[^\n]*|[A-Za-z_]\w*|\d\w*|\"C\"|->|\+\+|--|&&|\|\||<<=?|>>=?|"
        r"[-+*/%&|^<>=!]=|[-+*/%<>=!&|~?:;,.(){}\[\]])",
        re.DOTALL | re.ASCII,
    ),
    re.compile(r"\\\s*\n|\?\?/|\r(?!\n)"),
)
"""A directive ends with its line, so it is one token. Operators that change a value within an
expression (`--`, `>>=`) are one token, too, so that they are not read as two harmless ones."""
_SIGNS = frozenset("! & | && || < <= > >= == != + - ? : ( ) true false".split())
_KEPT = frozenset(
    """
    approximation now outcomes possible reading
    const bool uint32_t UINT32_C true false fretc_reading
    """.split()
)
"""Parameters, which occur only before `->`; and keywords of C."""
_POINTED = frozenset("* [ <<".split())
"""Pointers are allowed only in the ring code of fretc, and in its declaration of `reading`."""


_POINTER = re.compile(r"\w+ -> ")
_SUM = re.compile(r"(?:^|(?<=[?:] ))(?P<open>\( )?(?!\d+ . \d)\w+ [+-] \w+(?(open) \))(?= :|$)")
_NEGATIVE = re.compile(r"(?:^|(?<=[?:=(] ))- \d+\b")


def check_layout(
    text: str, written: str, base: str, cells: Sequence[str], inputs: Sequence[str]
) -> CheckedLayout:
    """The parsed layout of a C file.

    Args:
        text: text of the file.
        written: text that fretc writes for the same requirements.
        base: prefix of the function names.
        cells: members of the approximation's struct.
        inputs: members of the inputs' struct.

    Raises:
        UnexpectedLayoutError: the layout differs.
    """
    given, own = LEXIS.tokens(text), LEXIS.tokens(written)
    free = ((f"{base}_clear",), (f"{base}_advance",))
    (cleared, own_cleared), (stepped, own_stepped) = bodies(given, own, free)
    known = frozenset([*statements(own_cleared), *statements(own_stepped)])
    _same_cells(cleared, own_cleared)
    read = re.findall(r"now \. (\w+) = inputs -> (\w+) ==", " ".join(own))
    literals = {literal: inputs.index(name) for literal, name in read}
    step = _CStep(known, cells, literals)
    for statement in statements(stepped):
        step.read(statement)
    return CheckedLayout(step.sources, literals)


def without_comments(text: str) -> str:
    """The text with blanks in place of comments, so that each statement keeps its line."""
    return re.sub(r"/\*.*?\*/", lambda comment: re.sub(r".", " ", comment[0]), text, flags=re.S)


def _same_cells(cleared: Tokens, own: Tokens) -> None:
    """Raise UnexpectedLayoutError unless each cell gets a first value, in the order of fretc.

    A cell without a first value depends on earlier memory, which no exploration covers.
    """
    given, written = [*statements(cleared)], [*statements(own)]
    for actual, expected in zip_longest(given, written, fillvalue=()):
        both = _is_first_value(actual) and _is_first_value(expected)
        if not actual:
            raise UnexpectedLayoutError(f"there is no `{' '.join(expected)}`")
        if actual != expected and not (both and actual[:3] == expected[:3]):
            raise strange(actual)


def _is_first_value(statement: Tokens) -> bool:
    """Whether the statement assigns a constant to a cell."""
    match statement:
        case ("approximation", "->", name, "=", *value, ";"):
            return bool(NAME.fullmatch(name)) and is_constant(value)
        case _:
            return False


class _CStep(BlockFlow):
    """The body of a step, read statement by statement."""

    cell, literal = ("approximation", "->"), ("now", "->")
    brackets = ("(", ")")
    signs, kept = _SIGNS, _KEPT
    _outcome = ""

    def read(self, statement: Tokens) -> None:
        """Read one more statement.

        Raises:
            UnexpectedLayoutError: it has no known harmless form.
        """
        if not (self.branch(statement) or self._assignment(statement) or self._fixed(statement)):
            raise strange(statement)

    def names(self, value: Sequence[str], statement: Sequence[str]) -> frozenset[str]:
        """The names in an expression.

        A sum must be the whole value, or an alternative of a condition. Within a larger expression
        a compiler may drop an overflowing operand before it checks for overflows, as in `x + 1 - 1`
        or `x + 1 > x`.

        Raises:
            UnexpectedLayoutError: the expression contains anything else.
        """
        text = _NEGATIVE.sub("", _POINTER.sub("", " ".join(value)))
        for each in _SUM.finditer(text):
            before = text[: each.start()]
            if before.count("(") != before.count(")"):
                raise strange(statement)
        if not {"+", "-"}.isdisjoint(_SUM.sub("", text)):
            raise strange(statement)
        return super().names(value, statement)

    def _assignment(self, statement: Tokens) -> bool:
        if statement in self.written and not _POINTED.isdisjoint(statement):
            return False
        match statement:
            case ("reading", "->", name, "=", *value, ";") if (
                self._outcome and self.grammar.is_free(name)
            ):
                self.change([self._outcome], self.names(value, statement))
                return True
            case ("approximation", _, _, "=", *value, ";"):
                return self.give(statement[:3], value, statement)
            case ("const", "bool", name, "=", *value, ";"):
                return self.declare(name, value, statement)
            case _:
                return False

    def _fixed(self, statement: Tokens) -> bool:
        """The fixed statements: the reported outcome, and rings."""
        if statement not in self.written:
            return False
        match statement:
            case ("reading", "=", "possible", "?", "&", "outcomes", "->", member, *_):
                self._outcome = f"&{member}"
                return not self.conditions
            case ("(", "void", ")", _, ";"):
                return True
            case _:
                names = self.grammar.free_names(statement)
                left = statement[: statement.index("=")] if "=" in statement else ()
                # A pointer to a ring counts as a change of the ring.
                local = statement[2:3] if statement[:2] == ("const", "bool") else ()
                self.known(names, names & {*left, *self.rings}, local)
                return True
