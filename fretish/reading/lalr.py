"""LALR(1) parser that runs stored parse tables.

Lark computes the tables (`grammars.py`); to import Lark and load its own form of them takes longer
than all else that a short command does. The parser here accepts the same texts, builds the same
trees, and stops at the same errors; tests compare it with Lark.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

END = "$END"
"""Type of the token behind the text."""


class Token(str):
    """A word of the text; its value is the text of the word."""

    __slots__ = ("end_pos", "start_pos", "type")

    type: str
    """The name of its terminal in the grammar, or `END`."""
    start_pos: int
    end_pos: int
    """Positions in the text, in characters."""

    @classmethod
    def at(cls, kind: str, word: str, start: int) -> Token:
        """The token of this type whose word begins at a position."""
        token = cls(word)
        token.type, token.start_pos, token.end_pos = kind, start, start + len(word)
        return token


class SyntaxTreeNode(NamedTuple):
    """A node of a parse tree, whose children come before it in the list of nodes."""

    kind: str
    """The alias of the alternative, or the name of the rule."""
    children: Sequence[Token | int]
    """Tokens, and indices of nodes."""
    start_pos: int
    end_pos: int
    """Positions in the text, in characters. Both are 0 if the node contains no words."""


class UnexpectedTokenError(Exception):
    """The text contains a word that the grammar does not allow there."""

    def __init__(self, token: Token, previous: Token | None, accepts: frozenset[str]) -> None:
        super().__init__(token)
        self.token = token
        self.previous = previous
        """The token before it, or None at the start."""
        self.accepts = accepts
        """The types of token with which the text could continue."""


class UnexpectedCharacterError(Exception):
    """No terminal of the grammar begins at this position."""

    def __init__(self, position: int) -> None:
        super().__init__(position)
        self.position = position


class Tables(NamedTuple):
    """The parse tables of a grammar. Rows and rules are texts, which are read when needed."""

    terminals: str
    """A regular expression with a named group for each terminal."""
    skip: Sequence[str]
    """Terminals that are left out."""
    states: Sequence[str]
    """For each state, pairs of a symbol and a number. A number n >= 0 is the next state, -1 - r
    means that rule r is reduced."""
    rules: Sequence[str]
    """For each rule: its symbol, the number of symbols that it replaces, the kind of its node,
    whether a single child replaces the node (0 or 1), and the indices of the symbols that become
    children. The index -1 - i means that the children of symbol i become children."""
    starts: Mapping[str, Sequence[int]]
    """Start symbol → first and last state."""


class Parser:
    """A parser for the grammar of some tables."""

    def __init__(self, tables: Tables) -> None:
        self._tables = tables
        self._terminals = re.compile(tables.terminals)
        self._skip = frozenset(tables.skip)
        self._rows: dict[int, Mapping[str, int]] = {}
        self._rules: dict[int, _Rule] = {}

    def tokens(self, text: str, position: int = 0) -> Iterator[Token]:
        """The words of a text from a position on.

        Raises:
            UnexpectedCharacterError: no word begins at a position.
        """
        while position < len(text):
            match = self._terminals.match(text, position)
            if match is None:
                raise UnexpectedCharacterError(position)
            kind = str(match.lastgroup)
            if kind not in self._skip:
                yield Token.at(kind, match[0], position)
            position = match.end()

    def known_tokens(self, text: str) -> Iterator[Token]:
        """The words of a text, without the characters at which no word begins."""
        position = 0
        while position < len(text):
            try:
                for token in self.tokens(text, position):
                    position = token.end_pos
                    yield token
                return
            except UnexpectedCharacterError as error:
                position = error.position + 1

    def continuations(self, text: str, start: str = "start") -> frozenset[str]:
        """The types of token with which a text can continue; none if it has a mistake."""
        first, _ = self._tables.starts[start]
        tree, states = _Tree(), [first]
        try:
            for token in self.tokens(text):
                while (step := self._step(states, token, None)) < 0:
                    self._reduce(-1 - step, states, tree)
                states.append(step)
                tree.push(token)
        except (UnexpectedCharacterError, UnexpectedTokenError):
            return frozenset()
        return self._accepted(states)

    def parse(self, text: str, start: str = "start") -> list[SyntaxTreeNode]:
        """The nodes of the parse tree of a text; children come first, the root is the last.

        Raises:
            UnexpectedTokenError: a word that the grammar does not allow at its place.
            UnexpectedCharacterError: no word begins at a position.
        """
        first, last = self._tables.starts[start]
        tree, states, previous = _Tree(), [first], None
        for token in self.tokens(text):
            while (step := self._step(states, token, previous)) < 0:
                self._reduce(-1 - step, states, tree)
            states.append(step)
            tree.push(token)
            previous = token
        end = Token.at(END, "", len(text))
        while states[-1] != last:
            self._reduce(-1 - self._step(states, end, previous), states, tree)
        return tree.nodes

    def _step(self, states: Sequence[int], token: Token, previous: Token | None) -> int:
        """What the tables demand for the next token."""
        step = self._row(states[-1]).get(token.type)
        if step is None:
            raise UnexpectedTokenError(token, previous, self._accepted(states))
        return step

    def _reduce(self, index: int, states: list[int], tree: _Tree) -> None:
        rule = self._rule(index)
        if rule.size:
            del states[-rule.size :]
        states.append(self._row(states[-1])[rule.symbol])
        tree.reduce(rule)

    def _accepted(self, states: Sequence[int]) -> frozenset[str]:
        """The terminals that can follow, or those of the row if none is certain to."""
        row = [symbol for symbol in self._row(states[-1]) if symbol.isupper()]
        return frozenset(symbol for symbol in row if self._accepts(states, symbol)) or frozenset(
            row
        )

    def _accepts(self, states: Sequence[int], symbol: str) -> bool:
        """Whether the terminal is shifted, or ends the text, after all reductions."""
        stack = [*states]
        while (step := self._row(stack[-1]).get(symbol)) is not None:
            if step >= 0:
                return True
            rule = self._rule(-1 - step)
            if rule.size:
                del stack[-rule.size :]
            stack.append(self._row(stack[-1])[rule.symbol])
            if symbol == END and any(stack[-1] == last for _, last in self._tables.starts.values()):
                return True
        return False

    def _row(self, state: int) -> Mapping[str, int]:
        if state not in self._rows:
            words = self._tables.states[state].split()
            self._rows[state] = dict(zip(words[::2], map(int, words[1::2]), strict=True))
        return self._rows[state]

    def _rule(self, index: int) -> _Rule:
        if index not in self._rules:
            symbol, size, kind, expands, *children = self._tables.rules[index].split()
            self._rules[index] = _Rule(
                symbol, int(size), kind, expands == "1", tuple(map(int, children))
            )
        return self._rules[index]


class _Rule(NamedTuple):
    symbol: str
    size: int
    kind: str
    expands: bool
    children: tuple[int, ...]


_Extent = tuple[int, int] | None
"""Start and end in the text, or None without words."""


class _Tree:
    """The nodes so far, and a stack of the values of the symbols that are not reduced yet."""

    def __init__(self) -> None:
        self.nodes: list[SyntaxTreeNode] = []
        self._stack: list[tuple[Token | int | Sequence[Token | int], _Extent]] = []

    def push(self, token: Token) -> None:
        self._stack.append((token, (token.start_pos, token.end_pos)))

    def reduce(self, rule: _Rule) -> None:
        """Replace the symbols of the rule by its node.

        Words that leave no child, such as parentheses, belong to the extent of the node around.
        """
        base = len(self._stack) - rule.size
        parts = self._stack[base:]
        del self._stack[base:]
        extents = [extent for _, extent in parts if extent is not None]
        extent = (extents[0][0], extents[-1][1]) if extents else None
        children: list[Any] = []
        for index in rule.children:
            if index >= 0:
                children.append(parts[index][0])
            else:
                children.extend(parts[-1 - index][0])  # type: ignore[arg-type]
        self._stack.append(self._node(rule, children, extent))

    def _node(
        self, rule: _Rule, children: Sequence[Token | int], extent: _Extent
    ) -> tuple[Token | int | Sequence[Token | int], _Extent]:
        if rule.symbol.startswith("_"):
            return children, extent
        if rule.expands and len(children) == 1:
            (child,) = children
            return child, (child.start_pos, child.end_pos) if isinstance(child, Token) else extent
        self.nodes.append(SyntaxTreeNode(rule.kind, children, *(extent or (0, 0))))
        return len(self.nodes) - 1, extent


def build(nodes: Sequence[SyntaxTreeNode], builder: object) -> Any:
    """The value of the root: each node is built by the builder's method of its kind.

    A method takes the node, and its children with the values of their nodes.
    """
    values: list[Any] = []
    for node in nodes:
        children = [values[child] if isinstance(child, int) else child for child in node.children]
        values.append(getattr(builder, node.kind)(node, children))
    return values[-1]
