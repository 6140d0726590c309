"""Programs as tokens, and the first difference between two of them.

Fixed parts are compared token for token, so comments and layout are free.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from fretish.classes.frozen import dataclass


class Token(str):
    """A token with its line."""

    __slots__ = ("line",)
    line: int

    @classmethod
    def at(cls, text: str, line: int) -> Token:
        """A token of this line."""
        token = cls(text)
        token.line = line
        return token


Tokens = tuple[str, ...]

NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
NUMBER = re.compile(r"(0|[1-9]\d*)u?", re.ASCII)
_OPENING, _CLOSING = frozenset("([{"), frozenset(")]}")


class UnexpectedLayoutError(Exception):
    """The text is not laid out as fretc writes it; the message gives the position."""


@dataclass(frozen=True, slots=True)
class Lexis:
    """Tokens of a language, as far as fretc uses them."""

    token: re.Pattern[str]
    """Pattern of a token, or of layout and comments as the group `gap`."""
    moving: re.Pattern[str]
    """Pattern of characters that move the end of a line or of a comment; no text may have them."""
    line_bound: frozenset[str] = frozenset()
    """Tokens after which the end of a line ends the statement, so that it is a token."""

    def tokens(self, text: str) -> Tokens:
        """The tokens of a text without comments and layout.

        Raises:
            UnexpectedLayoutError: the text contains a token that fretc never writes.
        """
        moving = self.moving.search(text)
        if moving:
            raise UnexpectedLayoutError(
                f"line {_line(text, moving.start())} contains a hidden line break"
            )
        tokens, start, line = list[str](), 0, 1
        while start < len(text):
            match = self.token.match(text, start)
            if match is None:
                raise UnexpectedLayoutError(f"line {line} has `{text[start : start + 1]!a}`")
            if match["gap"] is None:
                tokens.append(Token.at(match[0], line))
            elif "\n" in match[0] and tokens and tokens[-1] in self.line_bound:
                tokens.append(Token.at("\n", line))
            start = match.end()
            line += match[0].count("\n")
        return tuple(tokens)


def _line(text: str, index: int) -> int:
    return text.count("\n", 0, index) + 1


def strange(statement: Sequence[str]) -> UnexpectedLayoutError:
    """The error about a statement that fretc would not write."""
    words = " ".join(statement).replace("\n", "\\n")
    line = next((f"line {token.line}" for token in statement if isinstance(token, Token)), "it")
    return UnexpectedLayoutError(f"{line} is not laid out as fretc writes it: `{words[:80]}`")


def same(given: Tokens, written: Tokens) -> None:
    """Raise UnexpectedLayoutError, with the position, if two texts differ."""
    if given == written:
        return
    pairs = zip(given, written, strict=False)
    index = next((i for i, (a, b) in enumerate(pairs) if a != b), min(len(given), len(written)))
    raise strange(given[max(0, index - 3) : index + 3])


def split(text: Tokens, functions: Sequence[Tokens]) -> tuple[Tokens, list[Tokens]]:
    """The text without the bodies of some functions; and the bodies.

    Args:
        text: the whole text.
        functions: first tokens of each function, in the order of the text.

    Raises:
        UnexpectedLayoutError: a function is missing.
    """
    outside, bodies, index = list[str](), list[Tokens](), 0
    for head in functions:
        start = text.index("{", _place(text, head, index)) + 1
        end = _end(text, start)
        outside += text[index:start]
        bodies.append(text[start : end - 1])
        index = end - 1
    return (*outside, *text[index:]), bodies


def bodies(
    given: Tokens, own: Tokens, functions: Sequence[Tokens]
) -> Iterator[tuple[Tokens, Tokens]]:
    """The bodies of some functions in the text and in that of fretc, as `split` finds them.

    Raises:
        UnexpectedLayoutError: a function is missing, or the texts differ outside the bodies.
    """
    (outside, found), (own_outside, own_found) = split(given, functions), split(own, functions)
    same(outside, own_outside)
    return zip(found, own_found, strict=True)


def _place(text: Tokens, head: Tokens, start: int) -> int:
    for index in range(start, len(text)):
        if text[index : index + len(head)] == head and "{" in text[index:]:
            return index
    raise UnexpectedLayoutError(f"there is no `{' '.join(head)}`")


def _end(text: Tokens, start: int) -> int:
    """Index after the brace that closes the one before the start."""
    end, depth = start, 1
    while depth and end < len(text):
        depth += {"{": 1, "}": -1}.get(text[end], 0)
        end += 1
    return end


def end_of(text: Tokens, start: int, end: str) -> int:
    """Index of the next such token outside brackets; else the end of the text."""
    depth = 0
    for index in range(start, len(text)):
        token = text[index]
        depth += (token in _OPENING) - (token in _CLOSING)
        if token == end and depth == 0:
            return index
    return len(text)


def parts(text: Tokens, end: str) -> Iterator[Tokens]:
    """The parts before each of these tokens outside brackets, and the rest."""
    start = 0
    while start < len(text):
        place = end_of(text, start, end)
        yield text[start:place]
        start = place + 1


def statements(body: Tokens) -> Iterator[Tokens]:
    """Statements up to each semicolon or brace; an `else` belongs to the preceding brace.

    Raises:
        UnexpectedLayoutError: the last statement has no end.
    """
    start, depth = 0, 0
    for index, token in enumerate(body):
        depth += {"(": 1, ")": -1}.get(token, 0)
        after = body[index + 1] if index + 1 < len(body) else ""
        if (token in (";", "{") and depth == 0) or (token == "}" and after != "else"):
            yield body[start : index + 1]
            start = index + 1
    if start < len(body):
        raise strange(body[start:])


def is_constant(value: Sequence[str]) -> bool:
    """Whether the token is a truth value or an integer."""
    *sign, last = value or ("",)
    return sign in ([], ["-"]) and bool(last in ("true", "false") or NUMBER.fullmatch(last))


def same_but_constants(first: Tokens, own_first: Tokens, end: int) -> None:
    """Raise UnexpectedLayoutError if two records differ in more than their constants.

    Args:
        first: a record of fields with their values, `name : value`, after two other tokens.
        own_first: the record that fretc writes.
        end: index of the first token after the fields.
    """
    same(first[:2] + first[end:], own_first[:2] + own_first[end:])
    given, own = ([*parts(each[2:end], ",")] for each in (first, own_first))
    if len(given) != len(own):
        raise strange(given[-1] if given else ())
    for actual, expected in zip(given, own, strict=True):
        constants = is_constant(actual[2:]) and is_constant(expected[2:])
        if actual != expected and not (constants and actual[:2] == expected[:2]):
            raise strange(actual)


Fields = list[tuple[str, Tokens]]
"""Field → value of a record."""


def records(text: Tokens, head: Tokens) -> list[Fields]:
    """The records of an array.

    Args:
        text: the array with its brackets.
        head: first tokens of each record, up to its brace.

    Raises:
        UnexpectedLayoutError: it is not an array of records.
    """
    if text[:1] != ("[",) or text[-1:] != ("]",):
        raise strange(text)
    return [_fields(record, head) for record in parts(text[1:-1], ",")]


def _fields(record: Tokens, head: Tokens) -> Fields:
    fields = [*parts(record[len(head) : -1], ",")]
    if (record[: len(head)], record[-1:]) != (head, ("}",)):
        raise strange(record)
    if any(field[1:2] != (":",) for field in fields):
        raise strange(record)
    return [(field[0], field[2:]) for field in fields]
