"""Formulas of linear temporal logic: text to expression.

From loose to tight: `<->`, `->` (to the right), `xor`, `|`, `&`, then `U`, `R`, `W` between two
operands, then `!`, `X`, `F`, `G`, `F[2,5]`, `G[2,5]`. Propositions are those of sentences: names,
and comparisons such as `speed > 0.3`.

Source of the operators: Pnueli, The temporal logic of programs, FOCS 1977; `p W q` is
`q R (p | q)`.
"""

from __future__ import annotations

import re
from typing import cast

from fretish import expressions as e
from fretish.checking import LOOK_AHEAD, LOOK_BACK, NUMBERS_BACK, calls
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic, DiagnosticError
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.keywords import RESERVED
from fretish.parser import parse_value
from fretish.reading.recursion import with_recursion_limit

MOST_NESTED = 400
"""Maximum nesting depth of parentheses and unary operators."""
MOST_TOKENS = 50_000
"""Maximum number of tokens of a formula."""
_LONGEST_BOUND = 10**9
_TOKEN = re.compile(
    r"(?P<space>\s+)|(?P<name>[A-Za-z](?:[\w.%]*[\w%])?)|(?P<quoted>\"[^\"\n]*\")|"
    r"(?P<number>[0-9]+(?:\.[0-9]+)?)|"
    r"(?P<sign><->|<=>|->|=>|&&|\|\||<=|>=|!=|[!&|()\[\],<>=+\-*/^])",
    re.ASCII,
)
_SYNONYMS = {"&&": "&", "||": "|", "=>": "->", "<=>": "<->"}
_UNARY = frozenset("XFG")
_BINARY = frozenset("URW")
_JOINING = ("<->", "->", "xor", "|", "&")
"""Boolean operators, the loosest first."""
_OF_PROPOSITIONS = frozenset(["<", "<=", ">", ">=", "=", "!=", "+", "-", "*", "/", "^", ",", "mod"])


@dataclass(frozen=True, slots=True)
class _Token:
    kind: str
    text: str
    start: int
    end: int


class _MistakeError(DiagnosticError):
    pass


@with_recursion_limit
def read(text: Span) -> e.Expression | Diagnostic:
    """The expression of a formula, or F626 (not a formula) or F627 (too large)."""
    try:
        return _Reader(text).formula()
    except _MistakeError as error:
        return error.diagnostic


class _Reader:
    """Recursive descent over the tokens; `_at` is the index of the next one."""

    def __init__(self, text: Span) -> None:
        self._text, self._at, self._depth = text, 0, 0
        self._tokens = self._lexemes()

    def _lexemes(self) -> list[_Token]:
        tokens: list[_Token] = []
        index, text = 0, self._text.text
        while index < len(text):
            match = _TOKEN.match(text, index)
            if match is None:
                raise self._wrong(f"`{text[index]}` begins no word", index, index + 1)
            if match.lastgroup != "space":
                own = _SYNONYMS.get(match[0], match[0])
                tokens.append(_Token(match.lastgroup or "", own, index, match.end()))
            index = match.end()
            if len(tokens) > MOST_TOKENS:
                raise _MistakeError(
                    diagnostic("formula_too_large", self._text, most=f"{MOST_TOKENS} words")
                )
        return [*tokens, _Token("end", "", len(text.rstrip()), len(text.rstrip()))]

    @property
    def _next(self) -> _Token:
        return self._tokens[self._at]

    def _wrong(self, why: str, start: int, end: int) -> _MistakeError:
        return _MistakeError(diagnostic("not_a_formula", self._text.part(start, end), why=why))

    def _unexpected(self, wanted: str) -> _MistakeError:
        token = self._next
        place = f"`{token.text}` stands" if token.kind != "end" else "the formula ends"
        return self._wrong(f"{place} where {wanted} is expected", token.start, token.end)

    def _take(self, text: str) -> _Token:
        token = self._next
        if token.text != text or token.kind == "quoted":
            raise self._unexpected(f"`{text}`")
        self._at += 1
        return token

    # Operators

    def formula(self) -> e.Expression:
        """The whole text."""
        result = self._joined(0)
        if self._next.kind != "end":
            raise self._unexpected("an operator")
        return result

    def _joined(self, level: int) -> e.Expression:
        if level == len(_JOINING):
            return self._temporal()
        operator = _JOINING[level]
        operands = [self._joined(level + 1)]
        while self._next.text == operator:
            self._at += 1
            operands.append(self._joined(level + 1))
        if len(operands) == 1:
            return operands[0]
        match operator:
            case "&":
                return e.And(tuple(part for each in operands for part in _parts(e.And, each)))
            case "|":
                return e.Or(tuple(part for each in operands for part in _parts(e.Or, each)))
            case "->":
                result = operands.pop()
                while operands:
                    result = e.Implies(operands.pop(), result)
                return result
            case _:
                result, *rest = operands
                for each in rest:
                    result = (e.Xor if operator == "xor" else e.Iff)(result, each)
                return result

    def _temporal(self) -> e.Expression:
        first = self._next
        left = self._unary()
        token = self._next
        if not _is_operator(token, _BINARY):
            return left
        self._at += 1
        right = self._unary()
        if _is_operator(self._next, _BINARY):
            raise self._unexpected("a parenthesis around the formula before it, or an operator")
        span = self._text.part(first.start, self._tokens[self._at - 1].end)
        return e.Temporal(cast(e.TemporalOperator, token.text), (left, right), span=span)

    def _unary(self) -> e.Expression:
        token = self._next
        self._depth += 1
        if self._depth > MOST_NESTED:
            span = self._text.part(token.start, token.end)
            most = f"{MOST_NESTED} levels of nesting"
            raise _MistakeError(diagnostic("formula_too_large", span, most=most))
        result = self._operand(token)
        self._depth -= 1
        return result

    def _operand(self, token: _Token) -> e.Expression:
        if token.text == "!":
            self._at += 1
            return e.Not(self._unary())
        if token.text == "(":
            self._at += 1
            inner = self._joined(0)
            self._take(")")
            if self._next.text in _OF_PROPOSITIONS - {","}:
                raise self._unexpected("an operator between truth values")
            return inner
        if _is_operator(token, _UNARY):
            self._at += 1
            bounds = self._bounds() if token.text != "X" and self._next.text == "[" else None
            arg = self._unary()
            span = self._text.part(token.start, self._tokens[self._at - 1].end)
            return e.Temporal(cast(e.TemporalOperator, token.text), (arg,), bounds, span)
        return self._proposition()

    def _bounds(self) -> tuple[int, int]:
        opening = self._take("[")
        low = self._number()
        self._take(",")
        high = self._number()
        closing = self._take("]")
        if not low <= high <= _LONGEST_BOUND:
            why = f"`{low},{high}` is no interval of ticks"
            raise self._wrong(why, opening.start, closing.end)
        return low, high

    def _number(self) -> int:
        token = self._next
        if token.kind != "number" or not token.text.isdigit() or len(token.text) > 12:
            raise self._unexpected("a whole number")
        self._at += 1
        return int(token.text)

    # Propositions

    def _proposition(self) -> e.Expression:
        first = self._next
        while self._belongs(first):
            self._at += 1
            if self._next.text == "(" and self._tokens[self._at - 1].kind in ("name", "quoted"):
                self._skip_arguments()
        if self._next is first:
            raise self._unexpected("a proposition")
        tokens = self._tokens
        span = self._text.part(first.start, tokens[self._at - 1].end)
        if tokens[self._at - 1] is first and (simple := _simple(first, span)) is not None:
            return simple
        value = parse_value(span)
        if isinstance(value, Diagnostic):
            raise _MistakeError(value)
        of_ticks = LOOK_BACK | LOOK_AHEAD | NUMBERS_BACK
        called = next((name for name in calls(value) if name in of_ticks), None)
        if called is not None or any(name.id == "FTP" for name in e.names(value)):
            why = f"`{called or 'FTP'}` of FRETish refers to other ticks"
            raise self._wrong(why, first.start, tokens[self._at - 1].end)
        for name in e.names(value):
            self._check(name)
        return value

    def _check(self, name: e.Name) -> None:
        if name.id in _UNARY | _BINARY and name.span is not None:
            raise _MistakeError(
                diagnostic("not_a_formula", name.span, why=f"`{name.id}` is an operator")
            )

    def _belongs(self, first: _Token) -> bool:
        token = self._next
        if _is_operator(token, _UNARY | _BINARY) or token.text == "xor":
            return False
        if token.kind in ("name", "quoted", "number"):
            return True
        return token is not first and token.text in _OF_PROPOSITIONS

    def _skip_arguments(self) -> None:
        level = 0
        while True:
            token = self._next
            if token.kind == "end":
                raise self._unexpected("`)`")
            level += {"(": 1, ")": -1}.get(token.text, 0)
            self._at += 1
            if level == 0:
                return


def _is_operator(token: _Token, operators: frozenset[str]) -> bool:
    return token.kind == "name" and token.text in operators


def _simple(token: _Token, span: Span) -> e.Expression | None:
    """A proposition of one word; None: FRETish decides."""
    lower = token.text.lower()
    if token.kind == "name" and lower in ("true", "false"):
        return e.Truth(lower == "true")
    if token.kind == "name" and lower not in RESERVED and token.text != "FTP":
        return e.Name(token.text, span)
    return None


def _parts(kind: type[e.And] | type[e.Or], part: e.Expression) -> tuple[e.Expression, ...]:
    return part.args if isinstance(part, kind) else (part,)
