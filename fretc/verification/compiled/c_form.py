"""Whether a monitor in C has the form that fretc writes, read off its text before anything runs.

The header, the types and the functions that lead to the step are token for token those of fretc.
What the step and the first state do may be changed, within statements that give one cell, signal
or local truth value to an expression of such. They have no call, no loop, no pointer and no address
of their own, so they reach no memory but that of the one rail, and a step depends on nothing else.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

_TOKEN = re.compile(
    r"(?P<gap>[ \t\r\n]+|/\*.*?\*/)"
    r"|#[^\n]*|[A-Za-z_]\w*|\d\w*|\"C\"|->|\+\+|&&|\|\||<<|[<>=!]=|[-+*/%<>=!&|~?:;,.(){}\[\]]",
    re.DOTALL | re.ASCII,
)
"""A directive ends with its line, so it is one."""
_SPLICED = re.compile(r"\\\s*\n|\?\?/|\r(?!\n)")
"""What moves the end of a line or of a comment."""
_DIGRAPHS = ("<:", ":>", "<%", "%>", "%:")
"""Other spellings of brackets, braces and `#`."""
_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_NUMBER = re.compile(r"(0|[1-9]\d*)u?")
_SIGNS = frozenset("! && || < <= > >= == != + - ? : ( ) true false".split())
_KEPT = frozenset(
    """
    rail now outcomes possible reading
    const bool uint32_t UINT32_C true false fretc_reading
    """.split()
)
"""Parameters, which stand before `->` only; and words of C."""

_POINTED = frozenset("* [ <<".split())
"""Only what fretc writes for rings, and where it declares `reading`, has these."""

Tokens = tuple[str, ...]


class StrangeTextError(Exception):
    """The text is not laid out as fretc writes it; the message says where."""


@dataclass(frozen=True, slots=True)
class Part:
    """What the readings of one requirement depend on."""

    cells: frozenset[str]
    """Members of the struct of a rail."""
    inputs: frozenset[str]
    """Members of the struct of inputs."""


@dataclass(frozen=True, slots=True)
class Form:
    """A text in the form that fretc writes."""

    sources: Mapping[str, frozenset[str]]
    """Each name that a step changes, with all that it is made of. What is read of a requirement
    has the name of its outcome, after `&`."""
    literals: Mapping[str, str]
    """Each literal, with the input that it is read off."""

    def part(self, outcome: str) -> Part:
        """The part of the requirement with this member of the struct of outcomes."""
        reached = {f"&{outcome}"}
        waiting = [*reached]
        while waiting:
            for name in self.sources.get(waiting.pop(), frozenset()) - reached:
                reached.add(name)
                waiting.append(name)
        inputs = (name for literal, name in self.literals.items() if literal in reached)
        return Part(frozenset(reached), frozenset(inputs))


def formed(text: str, written: str, base: str) -> Form:
    """The form of a text of a C file.

    Args:
        text: it.
        written: what fretc writes for the same requirements.
        base: what the names of its functions begin with.

    Raises:
        StrangeTextError: it has another form.
    """
    given, own = tokens(text), tokens(written)
    free = (f"{base}_clear", f"{base}_advance")
    outside, bodies = _split(given, free)
    own_outside, own_bodies = _split(own, free)
    same(outside, own_outside)
    known = frozenset(each for body in own_bodies for each in _statements(body))
    cleared, stepped = bodies
    for statement in _statements(cleared):
        if statement not in known and not _is_first_value(statement):
            raise _strange(statement)
    literals = dict(re.findall(r"now \. (\w+) = inputs -> (\w+) ==", " ".join(own)))
    step = _Step(known)
    for statement in _statements(stepped):
        step.read(statement)
    return Form(step.sources, literals)


def tokens(text: str) -> Tokens:
    """The text without comments and layout.

    Raises:
        StrangeTextError: there is something in it that fretc never writes.
    """
    spliced = _SPLICED.search(text)
    if spliced:
        raise StrangeTextError(f"line {_line(text, spliced.start())} goes on below")
    found, place = list[str](), 0
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None or text.startswith(_DIGRAPHS, place):
            line = _line(text, place)
            raise StrangeTextError(f"line {line} has `{text[place : place + 1]!a}`")
        if match["gap"] is None:
            found.append(match[0])
        place = match.end()
    return tuple(found)


def without_comments(text: str) -> str:
    """A text in this form, with blanks for comments: each statement keeps its line."""
    return re.sub(r"/\*.*?\*/", lambda comment: re.sub(r".", " ", comment[0]), text, flags=re.S)


def same(given: Tokens, written: Tokens) -> None:
    """Raises StrangeTextError, with the place, where two texts differ."""
    if given == written:
        return
    pairs = zip(given, written, strict=False)
    place = next((i for i, (a, b) in enumerate(pairs) if a != b), min(len(given), len(written)))
    raise _strange(given[max(0, place - 3) : place + 3])


def _line(text: str, place: int) -> int:
    return text.count("\n", 0, place) + 1


def _strange(statement: Sequence[str]) -> StrangeTextError:
    return StrangeTextError(f"it is not laid out as fretc writes it: `{' '.join(statement)[:80]}`")


def _split(text: Tokens, functions: Sequence[str]) -> tuple[Tokens, list[Tokens]]:
    """The text without the bodies of these functions, which come in this order; and the bodies."""
    outside, bodies, place = list[str](), list[Tokens](), 0
    for name in functions:
        try:
            start = text.index("{", text.index(name, place)) + 1
        except ValueError:
            raise StrangeTextError(f"there is no function `{name}`") from None
        end, depth = start, 1
        while depth and end < len(text):
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        outside += text[place:start]
        bodies.append(text[start : end - 1])
        place = end - 1
    return (*outside, *text[place:]), bodies


def _statements(body: Tokens) -> Iterator[Tokens]:
    """Up to each semicolon and brace; an `else` stands with the brace that it comes after."""
    start, depth = 0, 0
    for place, token in enumerate(body):
        depth += {"(": 1, ")": -1}.get(token, 0)
        after = body[place + 1] if place + 1 < len(body) else ""
        if (token in (";", "{") and depth == 0) or (token == "}" and after != "else"):
            yield body[start : place + 1]
            start = place + 1
    if start < len(body):
        raise _strange(body[start:])


def _is_first_value(statement: Tokens) -> bool:
    """Whether it gives a constant to a cell."""
    match statement:
        case ("rail", "->", name, "=", *value, ";"):
            *sign, number = value or [""]
            constant = number in ("true", "false") or _NUMBER.fullmatch(number)
            return bool(_NAME.fullmatch(name) and sign in ([], ["-"]) and constant)
        case _:
            return False


# Steps ------------------------------------------------------------------------------------------


class _Step:
    """The body of a step, read statement by statement."""

    def __init__(self, known: frozenset[Tokens]) -> None:
        """Nothing is read yet.

        Args:
            known: the statements that fretc writes.
        """
        self.sources: dict[str, frozenset[str]] = {}
        """Each name that is changed, with the names in its values and in the conditions around."""
        self._known = known
        self._rings = {a for each in known for a, b in pairwise(each) if b == "["}
        self._conditions: list[frozenset[str]] = []
        self._local: set[str] = set()
        self._outcome = ""

    def read(self, statement: Tokens) -> None:
        """One more statement.

        Raises:
            StrangeTextError: it is of no form that is known to be harmless.
        """
        if not (self._branch(statement) or self._assignment(statement) or self._fixed(statement)):
            raise _strange(statement)

    def _branch(self, statement: Tokens) -> bool:
        match statement:
            case ("if", "(", *test, ")", "{"):
                self._conditions.append(self._names(test, statement))
            case ("}", "else", "if", "(", *test, ")", "{") if self._conditions:
                self._conditions[-1] |= self._names(test, statement)
            case ("}", "else", "{") if self._conditions:
                pass
            case ("}",) if self._conditions:
                self._conditions.pop()
            case _:
                return False
        return True

    def _assignment(self, statement: Tokens) -> bool:
        if statement in self._known and not _POINTED.isdisjoint(statement):
            return False
        match statement:
            case ("reading", "->", name, "=", *value, ";") if self._outcome and _is_free(name):
                target = self._outcome
            case ("rail", "->", name, "=", *value, ";") if _is_free(name):
                target = name
            case ("const", "bool", name, "=", *value, ";") if _is_free(name):
                target = name
            case _:
                return False
        self._change((target,), self._names(value, statement))
        self._local.update(statement[2:3] if statement[0] == "const" else ())
        return True

    def _fixed(self, statement: Tokens) -> bool:
        """What is as fretc writes it: the outcome that is told next, and rings."""
        if statement not in self._known:
            return False
        match statement:
            case ("reading", "=", "possible", "?", "&", "outcomes", "->", member, *_):
                self._outcome = f"&{member}"
                return not self._conditions
            case ("(", "void", ")", _, ";"):
                return True
            case _:
                names = frozenset(filter(_is_free, statement))
                left = statement[: statement.index("=")] if "=" in statement else ()
                # What points to a ring changes it, and is changed with it.
                self._change(names & {*left, *self._rings}, names)
                self._local.update(statement[2:3] if statement[:2] == ("const", "bool") else ())
                return True

    def _change(self, targets: Iterable[str], names: frozenset[str]) -> None:
        for name in targets:
            before = self.sources.get(name, frozenset())
            self.sources[name] = before.union(names, *self._conditions)

    def _names(self, value: Sequence[str], statement: Tokens) -> frozenset[str]:
        """The names in an expression of cells, literals, local truth values and numbers.

        Raises:
            StrangeTextError: there is anything else in it.
        """
        names, place = set[str](), 0
        while place < len(value):
            match value[place : place + 3]:
                case ["rail" | "now", "->", name] if _is_free(name) and name not in self._rings:
                    names.add(name)
                    place += 3
                case [name, *after] if name in self._local and after[:1] != ["("]:
                    names.add(name)
                    place += 1
                case [sign, *_] if sign in _SIGNS or _NUMBER.fullmatch(sign):
                    place += 1
                case _:
                    raise _strange(statement)
        return frozenset(names)


def _is_free(name: str) -> bool:
    return bool(_NAME.fullmatch(name)) and name not in _KEPT
