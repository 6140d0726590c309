"""FRET's notation of formulas, read and evaluated by its published definitions.

A reader and an evaluator of their own: nothing here is shared with the product. A column holds
one whole number for each tick, whose bits are as many traces as one likes: `0b10` says that the
proposition is false on the first trace and true on the second.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

Word = Mapping[str, Sequence[int]]
Bounds = tuple[int, int | None]
EVER: Bounds = (0, None)


@dataclass(frozen=True)
class Node:
    """An operator with its arguments; an atom or a constant has a name and no argument."""

    operator: str
    args: tuple[Node, ...] = ()
    name: str = ""
    bounds: Bounds = EVER


_TOKEN = re.compile(
    r"""\s*(?:
      (?P<quoted>"[^"]*")
    | (?P<word>[A-Za-z_][A-Za-z0-9_]*)
    | (?P<number>-?\d+)
    | (?P<symbol><->|->|[!&|()\[\]:,])
    )""",
    re.VERBOSE,
)
_UNARY = ("!", "F", "G", "X", "O", "H", "Y", "Z")
_LEVELS: tuple[tuple[str, ...], ...] = (
    ("<->",),
    ("->",),
    ("xor",),
    ("|",),
    ("&",),
    ("U", "R", "S"),
)
_BOUNDED = ("F", "G", "O", "H", "S")


def parse(text: str) -> Node:
    """Read all of a text; comparisons and calls stand in double quotes, or bare (as in pt)."""
    tokens = _tokens(_quoted(text))
    node, rest = _binary(tokens, 0)
    assert not rest, f"not read: {rest[:5]} in {text}"
    return node


_BARE = re.compile(r"\((?:[^()&|]|\([^()&|]*\))*?(?:[<>]=?|!=|(?<![<>!])=)(?![->])[^()&|]*\)")


def _quoted(text: str) -> str:
    """Comparisons in quotes: `(x > 3)` becomes `"(x > 3)"`."""
    parts = re.split(r'("[^"]*")', text)
    return "".join(p if p.startswith('"') else _quote_bare(p) for p in parts)


def _quote_bare(text: str) -> str:
    def quote(match: re.Match[str]) -> str:
        inner = match[0]
        logic = re.search(r"->|(?<![A-Za-z0-9_])(?:xor|S|H|O|Y|Z)(?![A-Za-z0-9_])|!(?!=)", inner)
        return inner if logic else f'"{inner}"'

    return _BARE.sub(quote, text)


def _tokens(text: str) -> list[str]:
    found: list[str] = []
    at = 0
    while text[at:].strip():
        match = _TOKEN.match(text, at)
        assert match, f"no token: {text[at : at + 20]!r} in {text}"
        found.append(match[0].strip())
        at = match.end()
    return found


def _binary(tokens: list[str], level: int) -> tuple[Node, list[str]]:
    if level == len(_LEVELS):
        return _unary(tokens)
    left, rest = _binary(tokens, level + 1)
    while rest and rest[0] in _LEVELS[level]:
        operator = rest[0]
        bounds, rest = _bounds(rest[1:]) if operator == "S" else (EVER, rest[1:])
        right, rest = _binary(rest, level if operator == "->" else level + 1)
        left = Node(operator, (left, right), bounds=bounds)
    return left, rest


def _bounds(tokens: list[str]) -> tuple[Bounds, list[str]]:
    if tokens[0] != "[":
        return EVER, tokens
    _, low, comma, high, bracket, *rest = tokens
    assert comma in ":,"
    assert bracket == "]"
    return (int(low), None if high == "inf" else int(high)), rest


def _unary(tokens: list[str]) -> tuple[Node, list[str]]:
    first, rest = tokens[0], tokens[1:]
    if first in _UNARY:
        bounds, rest = _bounds(rest) if first in _BOUNDED else (EVER, rest)
        arg, rest = _unary(rest)
        return Node(first, (arg,), bounds=bounds), rest
    if first == "(":
        node, rest = _binary(rest, 0)
        assert rest, "a parenthesis is open"
        assert rest[0] == ")", f"no `)` before {rest[:5]}"
        return node, rest[1:]
    if first in ("1", "TRUE"):
        return Node("true"), rest
    if first in ("0", "FALSE"):
        return Node("false"), rest
    assert first[0].isalpha() or first[0] in '_"', f"no atom: {first}"
    return Node("atom", name=first.strip('"')), rest


def atoms(node: Node) -> set[str]:
    """The names of all atoms; `LAST` among them."""
    if node.operator == "atom":
        return {node.name}
    return set().union(*map(atoms, node.args))


# Evaluation ----------------------------------------------------------------------------------


def values(
    node: Node, word: Word, length: int, full: int = 1, loop: int | None = None
) -> list[int]:
    """The truth of a formula at every tick.

    Args:
        node: any formula; with `loop`, one without past operators.
        word: a column for each atom. `LAST` marks the last tick of a finite trace by itself.
        length: how many ticks the columns have.
        full: all bits that the columns use.
        loop: None for a finite trace; else the trace is infinite, and this tick follows the last.
    """
    return _Trace(word, length, full, loop).values(node)


class _Trace:
    def __init__(self, word: Word, length: int, full: int, loop: int | None) -> None:
        self.word, self.length, self.full, self.loop = word, length, full, loop

    def values(self, node: Node) -> list[int]:
        args = [self.values(arg) for arg in node.args]
        ticks = range(self.length)
        match node.operator:
            case "true":
                return [self.full] * self.length
            case "false":
                return [0] * self.length
            case "atom":
                return self._column(node.name)
            case "!":
                return [self.full ^ value for value in args[0]]
            case "&" | "|" | "xor" | "->" | "<->":
                return [self._logic(node.operator, args[0][i], args[1][i]) for i in ticks]
            case "X" | "F" | "G" | "U" | "R":
                return [self._future(node, args, i) for i in ticks]
            case _:
                assert self.loop is None, "the past of an infinite trace is not needed"
                return [self._past(node, args, i) for i in ticks]

    def _column(self, name: str) -> list[int]:
        if name == "LAST" and name not in self.word:
            return [0] * (self.length - 1) + [self.full if self.loop is None else 0]
        return list(self.word[name])

    def _logic(self, operator: str, left: int, right: int) -> int:
        match operator:
            case "&":
                return left & right
            case "|":
                return left | right
            case "xor":
                return left ^ right
            case "->":
                return (self.full ^ left) | right
            case _:
                return self.full ^ left ^ right

    def _path(self, at: int, steps: int | None) -> list[int]:
        """The ticks from `at` on; on an infinite trace each one that ever comes, or `steps`."""
        if self.loop is None:
            path = list(range(at, self.length))
            return path if steps is None else path[: steps + 1]
        path = list(range(at, self.length))
        wanted = len(path) + self.length - self.loop if steps is None else steps + 1
        while len(path) < wanted:
            path.extend(range(self.loop, self.length))
        return path[:wanted]

    def _future(self, node: Node, args: list[list[int]], at: int) -> int:
        if node.operator == "X":
            path = self._path(at, 1)
            return args[0][path[1]] if len(path) > 1 else 0
        if node.operator in "FG":
            return self._over(args[0], self._ahead(at, *node.bounds), every=node.operator == "G")
        path = self._path(at, None)
        along = self._until if node.operator == "U" else self._release
        return along(args[0], args[1], path)

    def _ahead(self, at: int, low: int, high: int | None) -> list[int]:
        """The ticks `low..high` ahead that there are."""
        if high is not None:
            return self._path(at, high)[low:]
        start = self._path(at, low)[low:]
        return self._path(start[0], None) if start else []

    def _over(self, column: list[int], ticks: Sequence[int], *, every: bool) -> int:
        result = self.full if every else 0
        for i in ticks:
            result = result & column[i] if every else result | column[i]
        return result

    def _until(self, left: list[int], right: list[int], path: list[int]) -> int:
        found, unbroken = 0, self.full
        for i in path:
            found |= unbroken & right[i]
            unbroken &= left[i]
        return found

    def _release(self, left: list[int], right: list[int], path: list[int]) -> int:
        kept, released = self.full, 0
        for i in path:
            kept &= right[i] | released
            released |= left[i]
        return kept

    def _past(self, node: Node, args: list[list[int]], at: int) -> int:
        low, high = node.bounds
        match node.operator:
            case "Y":
                return args[0][at - 1] if at else 0
            case "Z":
                return args[0][at - 1] if at else self.full
            case "O" | "H":
                ticks = [
                    j for j in range(at + 1) if low <= at - j and (high is None or at - j <= high)
                ]
                return self._over(args[0], ticks, every=node.operator == "H")
            case _:
                found, unbroken = 0, self.full
                for j in range(at, -1, -1):
                    if low <= at - j and (high is None or at - j <= high):
                        found |= unbroken & args[1][j]
                    unbroken &= args[0][j]
                return found


# Traces, many at a time ----------------------------------------------------------------------


Trace = dict[str, list[bool]]


def all_traces(names: Sequence[str], length: int) -> list[Trace]:
    """Every trace of that length."""
    rows = product((False, True), repeat=len(names) * length)
    return [
        {name: list(row[i * length : (i + 1) * length]) for i, name in enumerate(names)}
        for row in rows
    ]


def packed(traces: Sequence[Trace]) -> tuple[dict[str, list[int]], int, int]:
    """Columns of bits, one bit a trace; the length; and all bits. All traces have one length."""
    names = list(traces[0])
    length = len(traces[0][names[0]])
    word = {
        name: [_packed(trace[name][i] for trace in traces) for i in range(length)] for name in names
    }
    return word, length, (1 << len(traces)) - 1


def _packed(values: Iterable[bool]) -> int:
    """The first value is the lowest bit."""
    return int("".join("1" if value else "0" for value in values)[::-1], 2)


def bits(traces: Sequence[Trace], judge: Callable[[Trace], bool]) -> int:
    """A judgement of each trace, as bits."""
    return _packed(judge(trace) for trace in traces)


def differing(traces: Sequence[Trace], left: int, right: int) -> Trace | None:
    """The first trace on which two judgements differ."""
    different = left ^ right
    return traces[(different & -different).bit_length() - 1] if different else None
