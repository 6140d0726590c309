"""Check that a monitor in JavaScript has the layout that fretc writes, before anything runs.

All tokens except the first values of cells and the body of `advance` must equal those of fretc. In
`advance` a statement assigns an expression to one cell or local truth value, and the signals are
such expressions; literals, windows and marks are as fretc writes them. There is no call, no loop
and no member except a cell, so a step depends on nothing else.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from fretc.verification.compiled.flow import CheckedLayout, ExpressionForms, Flow
from fretc.verification.compiled.text import (
    Lexis,
    Tokens,
    bodies,
    end_of,
    parts,
    records,
    same,
    same_but_constants,
    strange,
)

LEXIS = Lexis(
    re.compile(
        r"(?P<gap>[ \t\r\n]+|//[^\n]*|/\*.*?\*/)"
        r"|[A-Za-z_$][\w$]*|\d[\w.]*(?:(?<=e)[-+]\d+)?|\"(?:[^\"\\\n]|\\.)*\"|`(?:[^`\\]|\\.)*`"
        r"|\.\.\.|=>|[=!]==|\?\.|\?\?=?|>>>?=?|<<=?|\*\*=?|&&=?|\|\|=?|\+\+|--|[-+*/%&|^<>=!]=|"
        r"[-+*/%&|^~<>=!?:;,.(){}\[\]]",
        re.DOTALL | re.ASCII,
    ),
    re.compile(r"\r(?!\n)|[\u2028\u2029]"),
    frozenset("return throw break continue yield async".split()),
)
"""After a `return` the end of a line ends the statement."""
_SIGNS = frozenset("! && || < <= > >= == != === !== + - ? : ( ) true false".split())
_KEPT = frozenset(
    "approximation tick truths mark slide true false null undefined const let var".split()
)
_FREE: tuple[Tokens, ...] = (("function", "approximation"), ("function", "advance"))
_READ = re.compile(r"const (\w+) = truths \[ (\d+) \] === null")


def check_layout(
    text: str,
    written: str,
    cells: Sequence[str],
    windows: Collection[str],
    outcomes: Sequence[str],
) -> CheckedLayout:
    """The parsed layout of a module.

    Args:
        text: text of the module.
        written: text that fretc writes for the same requirements.
        cells: all cells of an approximation.
        windows: the cells that are windows.
        outcomes: names of the outcomes.

    Raises:
        UnexpectedLayoutError: the layout differs.
    """
    given, own = LEXIS.tokens(text), LEXIS.tokens(written)
    (first, own_first), (stepped, own_stepped) = bodies(given, own, _FREE)
    same_but_constants(first, own_first, -2)
    literals = {name: int(index) for name, index in _READ.findall(" ".join(own_stepped))}
    step = _JavaScriptStep(frozenset(parts(own_stepped, ";")), {*cells} - {*windows})
    statements, own_statements = [*parts(stepped, ";")], [*parts(own_stepped, ";")]
    index, own_place = _signals_at(statements), _signals_at(own_statements)
    for statement in statements[:index]:
        step.read(statement)
    step.conditions = []
    told, own_told = statements[index][4:], own_statements[own_place][4:]
    step.tell(outcomes, records(told, ("{",)), records(own_told, ("{",)))
    same(_joined(statements[index + 1 :]), _joined(own_statements[own_place + 1 :]))
    return CheckedLayout(step.sources, literals)


def _signals_at(statements: Sequence[Tokens]) -> int:
    """Index of the statement that returns the signals."""
    head = ("approximation", ".", "signals", "=")
    places = [i for i, each in enumerate(statements) if each[:4] == head]
    if len(places) != 1:
        raise strange(statements[places[1]] if places else head)
    return places[0]


def _joined(statements: Sequence[Tokens]) -> Tokens:
    return tuple(token for each in statements for token in (*each, ";"))


class _JavaScriptStep(Flow):
    """The body of `advance`, read statement by statement."""

    def __init__(self, known: frozenset[Tokens], cells: Collection[str]) -> None:
        """A step without statements.

        Args:
            known: statements that fretc writes, without semicolons.
            cells: cells of an approximation that are not windows.
        """
        self._known = known
        super().__init__(ExpressionForms({("approximation", "."): cells}, _SIGNS, _KEPT))

    def read(self, statement: Tokens) -> None:
        """Read one more statement; an `if` or `else` contains a single one.

        Raises:
            UnexpectedLayoutError: it has no known harmless form.
        """
        if statement in self._known and self._fixed(statement):
            self.conditions = []
        elif not self._assignment(self._branch(statement), statement):
            raise strange(statement)

    def _branch(self, statement: Tokens) -> Tokens:
        """The statement after its conditions, which become those of the current statement."""
        rest = statement
        if rest[:1] != ("else",):
            self.conditions = []
        elif not self.conditions:
            raise strange(statement)
        else:
            rest = rest[1:]
        if rest[:2] == ("if", "("):
            end = end_of(rest, 1, ")")
            self.conditions.append(self.names(rest[2:end], statement))
            rest = rest[end + 1 :]
        return rest

    def _assignment(self, rest: Tokens, statement: Tokens) -> bool:
        match rest:
            case ("approximation", ".", _, "=", *value):
                return self.give(rest[:3], value, statement)
            case ("const", name, "=", *value) if rest == statement:
                return self.declare(name, value, statement)
            case _:
                return False

    def _fixed(self, statement: Tokens) -> bool:
        """Literals and windows, as fretc writes them."""
        local = statement[1:2] if statement[0] == "const" else ()
        if statement[2:4] == ("=", "truths"):
            self.known(frozenset(), local, local)
            return True
        if "slide" not in statement:
            return False
        names = self.grammar.free_names(statement)
        window = statement[statement.index("slide") + 4]
        self.known(names, [window, statement[1] if local else statement[2]], local)
        return True
