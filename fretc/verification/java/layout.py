"""Check that a monitor in Java has the layout that fretc writes, before javac reads it.

All tokens except a package, the first values of cells and the bodies of the methods `advance` and
`tell` must equal those of fretc. In `advance` a statement assigns an expression to one cell or
truth value of the tick; in `tell` each member of a reading gets one expression. There is no call,
no loop and no other object, so a step depends on nothing else.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

from fretc.verification.compiled.flow import BlockFlow, CheckedLayout
from fretc.verification.compiled.text import (
    NAME,
    Lexis,
    Tokens,
    bodies,
    is_constant,
    parts,
    same,
    split,
    statements,
    strange,
)

LEXIS = Lexis(
    re.compile(
        r"(?P<gap>[ \t\r\n]+|//[^\n]*|/\*.*?\*/)"
        r"|[A-Za-z_]\w*|\d\w*|->|::|\+\+|--|&&|\|\||<<=?|>>>?=?|[-+*/%&|^<>=!]=|"
        r"[-+*/%<>=!&|^~?:;,.(){}\[\]]",
        re.DOTALL | re.ASCII,
    ),
    re.compile(r"\r(?!\n)|\\u"),
)
"""Java replaces Unicode escapes before it reads comments, so a comment could end within its line.
There are no texts and no characters in quotes."""
_SIGNS = frozenset("! & | && || < <= > >= == != + - ? : ( ) true false".split())
_KEPT = frozenset("this now true false if else new".split())
_CLASS: tuple[Tokens, ...] = (("class", "Approximation"),)
_METHOD = re.compile(r"private void ((?:advance|tell)\d+) \(")
_READ = re.compile(r"(\w+) = inputs \. (\w+) == Truth")


def check_layout(
    text: str,
    written: str,
    cells: Sequence[str],
    variables: Collection[str],
    inputs: Sequence[str],
) -> CheckedLayout:
    """The parsed layout of a class.

    Args:
        text: text of the class.
        written: text that fretc writes for the same requirements.
        cells: fields of an approximation that live from tick to tick.
        variables: its fields that each step assigns before they are read.
        inputs: fields of the inputs.

    Raises:
        UnexpectedLayoutError: the layout differs.
    """
    given, own = without_package(LEXIS.tokens(text)), LEXIS.tokens(written)
    ((approximation, own_approximation),) = bodies(given, own, _CLASS)
    methods = _METHOD.findall(" ".join(own_approximation))
    heads = [("void", method) for method in methods]
    (fields, found), (own_fields, own_found) = (
        split(approximation, heads),
        split(own_approximation, heads),
    )
    _same_fields(fields, own_fields)
    known = frozenset(each for body in own_found for each in statements(body))
    literals = {name: inputs.index(field) for name, field in _READ.findall(" ".join(own))}
    step = _JavaStep(known, cells, literals, variables)
    for method, body, own_body in zip(methods, found, own_found, strict=True):
        if method.startswith("advance"):
            step.advance(body)
        else:
            step.report(body, own_body)
    return CheckedLayout(step.sources, literals)


def without_package(text: Tokens) -> Tokens:
    """The text without a declaration of its package, which the user adds.

    Raises:
        UnexpectedLayoutError: the name of the package is none.
    """
    if text[:1] != ("package",) or ";" not in text:
        return text
    end = text.index(";")
    name = text[1:end]
    if not all(map(NAME.fullmatch, name[::2])) or {*name[1::2]} - {"."} or len(name) % 2 == 0:
        raise strange(text[: end + 1])
    return text[end + 1 :]


def package(text: Tokens) -> str:
    """The package of a checked text, with a dot at its end; empty without one."""
    return f"{''.join(text[1 : text.index(';')])}." if text[:1] == ("package",) else ""


def _same_fields(fields: Tokens, own: Tokens) -> None:
    """Raise UnexpectedLayoutError if fields differ in more than constants, or methods differ."""
    given, written = [*parts(fields, ";")], [*parts(own, ";")]
    for actual, expected in zip(given, written, strict=False):
        constants = is_constant(actual[4:]) and is_constant(expected[4:])
        if actual != expected and not (constants and actual[:4] == expected[:4]):
            raise strange(actual)
    same(given[-1] if given else (), written[-1] if written else ())
    if len(given) != len(written):
        raise strange(fields)


class _JavaStep(BlockFlow):
    """The methods of a step, read one after the other."""

    cell, literal = ("this", "."), ("now", ".")
    brackets = ("(", ")")
    signs, kept = _SIGNS, _KEPT

    def __init__(
        self,
        known: frozenset[Tokens],
        cells: Sequence[str],
        literals: Mapping[str, int],
        variables: Collection[str],
    ) -> None:
        """A step without statements.

        Args:
            known: statements that fretc writes.
            cells: cells of an approximation.
            literals: all literals.
            variables: fields that must be assigned before they are read.
        """
        super().__init__(known, cells, literals)
        self._variables = {*variables}
        self._readable = {*self.grammar.members[self.cell]}
        members = {**self.grammar.members, self.cell: self._readable}
        self.grammar = type(self.grammar)(members, self.signs, self.kept)

    def advance(self, body: Tokens) -> None:
        """Read a method that computes cells and truth values.

        Raises:
            UnexpectedLayoutError: it has a statement without a known harmless form.
        """
        for statement in statements(body):
            if not (
                self.branch(statement) or self._fixed(statement) or self._assignment(statement)
            ):
                raise strange(statement)
        if self.conditions:
            raise strange(body)

    def report(self, body: Tokens, own: Tokens) -> None:
        """Read a method that reports readings: they differ from those of fretc in values only.

        Raises:
            UnexpectedLayoutError: another statement differs.
        """
        given, written = [*statements(body)], [*statements(own)]
        if len(given) != len(written):
            raise strange(body)
        outcome = ""
        for actual, expected in zip(given, written, strict=True):
            match expected:
                case ("reading", ".", _, "=", *_):
                    if actual[:4] != expected[:4] or actual[-1:] != (";",):
                        raise strange(actual)
                    self.change([f"&{outcome}"], self.names(actual[4:-1], actual))
                case ("reading", "=", "isPossible", "?", "outcomes", ".", name, *_):
                    same(actual, expected)
                    outcome = name
                case _:
                    same(actual, expected)

    def _assignment(self, statement: Tokens) -> bool:
        match statement:
            case ("this", ".", name, "=", *value, ";") if name in self._variables:
                return self._assign(name, value, statement)
            case ("this", ".", _, "=", *value, ";"):
                return self.give(statement[:3], value, statement)
            case _:
                return False

    def _assign(self, name: str, value: Sequence[str], statement: Tokens) -> bool:
        """Record a truth value of the tick; False: only some ticks assign it."""
        if self.conditions and name not in self._readable:
            return False
        self.change([name], self.names(value, statement))
        self._readable.add(name)
        return True

    def _fixed(self, statement: Tokens) -> bool:
        """Fixed statements of a ring: its bits, and its index."""
        names = self.grammar.free_names(statement)
        rings = {name for name in names if name.removesuffix("_at") in self.rings}
        if statement not in self.written or not rings:
            return False
        read = {*statement[2:3]} & self._variables
        if read and self.conditions:
            return False
        self.known(names, {*rings, *read}, ())
        self._readable |= read
        return True
