"""Data flow of a step: what each changed name depends on.

A statement assigns an expression of names and numbers to one cell, signal or local truth value. It
has no call, loop, pointer or address, so a step depends on nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import pairwise
from typing import ClassVar

from fretc.verification.compiled.text import NAME, NUMBER, Fields, Tokens, strange
from fretish.classes.frozen import dataclass

_JOINS = ("&", "|")
"""Operators that need a left operand; without one they take an address or begin a function."""


@dataclass(frozen=True, slots=True)
class Dependencies:
    """Dependencies of the readings of one requirement."""

    cells: frozenset[str]
    """Cells of an approximation, among other names."""
    inputs: frozenset[int]
    """Indices of propositions."""


@dataclass(frozen=True, slots=True)
class CheckedLayout:
    """A checked text in the layout of fretc."""

    sources: Mapping[str, frozenset[str]]
    """Each changed name with the names that it depends on. The readings of a requirement have the
    name of its outcome after `&`."""
    literals: Mapping[str, int]
    """Each literal with the index of its proposition."""

    def part(self, outcome: str) -> Dependencies:
        """Dependencies of the requirement with this outcome name."""
        reached = {f"&{outcome}"}
        waiting = [*reached]
        while waiting:
            for name in self.sources.get(waiting.pop(), frozenset()) - reached:
                reached.add(name)
                waiting.append(name)
        inputs = (index for literal, index in self.literals.items() if literal in reached)
        return Dependencies(frozenset(reached), frozenset(inputs))


@dataclass(frozen=True, slots=True)
class ExpressionForms:
    """Allowed elements of an expression, besides local truth values and numbers."""

    members: Mapping[tuple[str, str], Collection[str]]
    """Prefixes of members, such as `approximation` and `->`; and the members."""
    signs: Collection[str]
    kept: Collection[str] = ()
    """Words that are not names of local truth values."""

    def is_member(self, tokens: Sequence[str]) -> bool:
        """Whether the three tokens are a member."""
        return len(tokens) == 3 and tokens[2] in self.members.get((tokens[0], tokens[1]), ())

    def is_free(self, name: str) -> bool:
        """Whether the token is a name, and not a reserved word."""
        return bool(NAME.fullmatch(name)) and name not in self.kept

    def free_names(self, tokens: Iterable[str]) -> frozenset[str]:
        """All tokens that are names, and not reserved words."""
        return frozenset(filter(self.is_free, tokens))


_CALLS = ("(", "!")
"""Tokens that make a name a call, or a macro of Rust."""


class Flow:
    """Data flow of the statements of a step that were read so far."""

    def __init__(self, grammar: ExpressionForms) -> None:
        """The data flow of an empty step."""
        self.sources: dict[str, frozenset[str]] = {}
        """Each changed name with the names in its values and in the enclosing conditions."""
        self.conditions: list[frozenset[str]] = []
        """Names in each condition around the current statement."""
        self.grammar = grammar
        self._local: set[str] = set()

    def names(self, value: Sequence[str], statement: Sequence[str]) -> frozenset[str]:
        """The names in an expression.

        Raises:
            UnexpectedLayoutError: the expression contains anything else.
        """
        names, index, grammar = set[str](), 0, self.grammar
        while index < len(value):
            name, after = (*value[index : index + 2], "")[:2]
            if grammar.is_member(value[index : index + 3]):
                names.add(value[index + 2])
                index += 3
            elif name in self._local and after not in _CALLS:
                names.add(name)
                index += 1
            elif name in _JOINS and not _is_value(value[index - 1 : index]):
                raise strange(statement)
            elif name in grammar.signs or NUMBER.fullmatch(name):
                index += 1
            else:
                raise strange(statement)
        return frozenset(names)

    def change(self, targets: Iterable[str], names: frozenset[str]) -> None:
        """Record that the targets depend on these names."""
        for name in targets:
            before = self.sources.get(name, frozenset())
            self.sources[name] = before.union(names, *self.conditions)

    def give(self, member: Sequence[str], value: Sequence[str], statement: Sequence[str]) -> bool:
        """Record an assignment to a member; False: it is not an allowed member."""
        if not self.grammar.is_member(member):
            return False
        self.change(member[2:], self.names(value, statement))
        return True

    def declare(self, name: str, value: Sequence[str], statement: Sequence[str]) -> bool:
        """Record the declaration of a local truth value; False: the name is not allowed.

        In C, a second declaration of the same name could read itself before it has a value.
        """
        if not self.grammar.is_free(name) or name in self._local:
            return False
        self.change([name], self.names(value, statement))
        self._local.add(name)
        return True

    def known(self, names: frozenset[str], targets: Iterable[str], local: Iterable[str]) -> None:
        """Record a statement that fretc writes: each target depends on all of its names."""
        self.change(targets, names)
        self._local.update(local)

    def tell(
        self,
        outcomes: Sequence[str],
        given: Sequence[Fields],
        own: Sequence[Fields],
        expression: Callable[[str, Tokens], Tokens] = lambda _, value: value,
    ) -> None:
        """Record the readings of each requirement, at the end.

        Args:
            outcomes: names of the requirements' outcomes.
            given: fields of each outcome.
            own: fields that fretc writes; the names must be the same.
            expression: pattern of a field's value.

        Raises:
            UnexpectedLayoutError: a field is not an expression.
        """
        if self.conditions or [*map(_names, given)] != [*map(_names, own)]:
            raise strange([token for fields in given for _, value in fields for token in value])
        for outcome, fields in zip(outcomes, given, strict=True):
            for name, value in fields:
                self.change([f"&{outcome}"], self.names(expression(name, value), value))


class BlockFlow(Flow):
    """Data flow of a step in a language with blocks and rings, read statement by statement."""

    cell: ClassVar[tuple[str, str]]
    """Prefix of a cell."""
    literal: ClassVar[tuple[str, str]]
    """Prefix of a literal."""
    brackets: ClassVar[tuple[str, ...]]
    """Tokens around the condition of an `if`: two, or none."""
    signs: ClassVar[Collection[str]]
    kept: ClassVar[Collection[str]]
    """Elements of an expression, as in `ExpressionForms`."""

    def __init__(
        self, known: frozenset[Tokens], cells: Sequence[str], literals: Mapping[str, int]
    ) -> None:
        """A step without statements.

        Args:
            known: statements that fretc writes.
            cells: all cells of an approximation.
            literals: all literals.
        """
        self.written = known
        self.rings = {a for each in known for a, b in pairwise(each) if b == "["}
        fixed = {*self.rings, *(f"{ring}_at" for ring in self.rings)}
        members = {self.cell: {*cells} - fixed, self.literal: literals}
        super().__init__(ExpressionForms(members, self.signs, self.kept))

    def branch(self, statement: Tokens) -> bool:
        """Read the begin or the end of a block; False: it is another statement."""
        match statement:
            case ("if", *test, "{"):
                self.conditions.append(self._test(test, statement))
            case ("}", "else", "if", *test, "{") if self.conditions:
                self.conditions[-1] |= self._test(test, statement)
            case ("}", "else", "{") if self.conditions:
                pass
            case ("}",) if self.conditions:
                self.conditions.pop()
            case _:
                return False
        return True

    def _test(self, test: Sequence[str], statement: Tokens) -> frozenset[str]:
        if self.brackets:
            if (*test[:1], *test[1:][-1:]) != self.brackets:
                raise strange(statement)
            test = test[1:-1]
        return self.names(test, statement)


def _is_value(before: Sequence[str]) -> bool:
    """Whether an expression can end with this token, if there is one."""
    return any(
        each == ")"
        or NUMBER.fullmatch(each)
        or (NAME.fullmatch(each) and each not in ("if", "else"))
        for each in before
    )


def _names(fields: Fields) -> list[str]:
    return [name for name, _ in fields]
