"""Check that a monitor in Rust has the layout that fretc writes, before rustc reads it.

All tokens except the first values of cells and the body of `advance` must equal those of fretc,
including `forbid(unsafe_code)`. In `advance` a statement assigns an expression to one cell or local
truth value; the last one builds the readings from such expressions. There is no call, no macro and
no loop, so neither the compiler nor the step runs anything else, and a step depends on nothing
else.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from fretc.verification.compiled.flow import BlockFlow, CheckedLayout
from fretc.verification.compiled.text import (
    Lexis,
    Tokens,
    bodies,
    end_of,
    records,
    same_but_constants,
    strange,
)

LEXIS = Lexis(
    re.compile(
        r"(?P<gap>[ \t\r\n]+|//[^\n]*)"
        r"|[A-Za-z_]\w*|\d\w*|->|=>|::|&&|\|\||<<=?|>>=?|\.\.=?|[-+*/%^&|<>=!]=|"
        r"[-+*/%^&|<>=!?:;,.#$@(){}\[\]]",
        re.ASCII,
    ),
    re.compile(r"\r(?!\n)"),
)
"""`/*` is not skipped, because such comments can be nested."""
_SIGNS = frozenset("! & | && || < <= > >= == != + - ( ) { } if else true false".split())
_KEPT = frozenset("self Self now true false if else let mut ref Reading None".split())
_FREE: tuple[Tokens, ...] = (("const", "fn", "new"), ("fn", "advance"))
_READ = re.compile(r"(\w+) : inputs \. (\w+) == Some")
_DEADLINE = (("u32 :: try_from (", "("), (") . ok ( )", ")"), ("None", "0"))
"""Tokens and expressions that occur only for the ticks to a deadline."""


def check_layout(
    text: str,
    written: str,
    cells: Sequence[str],
    inputs: Sequence[str],
    outcomes: Sequence[str],
) -> CheckedLayout:
    """The parsed layout of a library.

    Args:
        text: text of the library.
        written: text that fretc writes for the same requirements.
        cells: fields of an approximation.
        inputs: fields of the inputs.
        outcomes: fields of the outcomes.

    Raises:
        UnexpectedLayoutError: the layout differs.
    """
    given, own = LEXIS.tokens(text), LEXIS.tokens(written)
    (first, own_first), (stepped, own_stepped) = bodies(given, own, _FREE)
    same_but_constants(first, own_first, -1)
    literals = {name: inputs.index(field) for name, field in _READ.findall(" ".join(own))}
    *own_statements, readings = _statements(own_stepped)
    step = _RustStep(frozenset(own_statements), cells, literals)
    *statements, last = _statements(stepped) or [()]
    for statement in statements:
        step.read(statement)
    head = ("Reading", "{")
    step.tell(outcomes, records(last, head), records(readings, head), _of_deadline)
    return CheckedLayout(step.sources, literals)


def _statements(body: Tokens) -> list[Tokens]:
    """Heads of branches up to their brace, other statements to the semicolon; then the rest."""
    statements, start = list[Tokens](), 0
    while start < len(body):
        end = _end(body, start)
        statements.append(body[start : end + 1])
        start = end + 1
    return statements


def _end(body: Tokens, start: int) -> int:
    """Last token of the statement, or the end of the body."""
    if body[start] != "if" and body[start] != "}":
        return end_of(body, start, ";")
    if body[start] == "}" and body[start + 1 : start + 2] != ("else",):
        return start
    return next((i for i in range(start, len(body)) if body[i] == "{"), len(body))


class _RustStep(BlockFlow):
    """The body of `advance`, read statement by statement."""

    cell, literal = ("self", "."), ("now", ".")
    brackets = ()
    signs, kept = _SIGNS, _KEPT

    def read(self, statement: Tokens) -> None:
        """Read one more statement.

        Raises:
            UnexpectedLayoutError: it has no known harmless form.
        """
        if not (self.branch(statement) or self._fixed(statement) or self._assignment(statement)):
            raise strange(statement)

    def _assignment(self, statement: Tokens) -> bool:
        match statement:
            case ("self", ".", _, "=", *value, ";"):
                return self.give(statement[:3], value, statement)
            case ("let", name, "=", *value, ";"):
                return self.declare(name, value, statement)
            case _:
                return False

    def _fixed(self, statement: Tokens) -> bool:
        """Fixed statements of a ring: its bits, and its index."""
        names = self.grammar.free_names(statement)
        rings = {name for name in names if name.removesuffix("_at") in self.rings}
        if statement not in self.written or not rings:
            return False
        local = statement[1:2] if statement[0] == "let" else ()
        self.known(names, {*rings, *local}, local)
        return True


def _of_deadline(name: str, value: Tokens) -> Tokens:
    """The value, without the parts that only the ticks to a deadline have."""
    words = " ".join(value)
    for special, plain in _DEADLINE if name == "left" else ():
        words = words.replace(special, plain)
    return tuple(words.split())
