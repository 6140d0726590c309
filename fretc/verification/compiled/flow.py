"""What a step makes of what, read off its statements.

A statement gives one cell, signal or local truth value to an expression of such and of numbers. It
has no call, no loop, no pointer and no address, so a step depends on nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from fretc.verification.compiled.text import NAME, NUMBER, Fields, Tokens, strange

_JOINS = ("&", "|")
"""With no value before them they take an address or begin a function."""


@dataclass(frozen=True, slots=True)
class Part:
    """What the readings of one requirement depend on."""

    cells: frozenset[str]
    """Cells of a rail, among other names."""
    inputs: frozenset[int]
    """Places of propositions."""


@dataclass(frozen=True, slots=True)
class Form:
    """A text in the form that fretc writes."""

    sources: Mapping[str, frozenset[str]]
    """Each name that a step changes, with all that it is made of. What is read of a requirement
    has the name of its outcome, after `&`."""
    literals: Mapping[str, int]
    """Each literal, with the place of the proposition that it is read off."""

    def part(self, outcome: str) -> Part:
        """The part of the requirement whose outcome has this name."""
        reached = {f"&{outcome}"}
        waiting = [*reached]
        while waiting:
            for name in self.sources.get(waiting.pop(), frozenset()) - reached:
                reached.add(name)
                waiting.append(name)
        inputs = (place for literal, place in self.literals.items() if literal in reached)
        return Part(frozenset(reached), frozenset(inputs))


@dataclass(frozen=True, slots=True)
class Grammar:
    """What an expression may be made of, beside local truth values and numbers."""

    members: Mapping[tuple[str, str], Collection[str]]
    """What stands before a member, as `rail` and `->`; and the members."""
    signs: Collection[str]
    kept: Collection[str] = ()
    """Words that are no names of local truth values."""

    def is_member(self, tokens: Sequence[str]) -> bool:
        """Whether these three tokens are a member."""
        return len(tokens) == 3 and tokens[2] in self.members.get((tokens[0], tokens[1]), ())


_CALLS = ("(", "!")
"""What makes a name a call, or a macro of Rust."""


class Flow:
    """The step as far as it is read."""

    def __init__(self, grammar: Grammar) -> None:
        """Nothing is read yet."""
        self.sources: dict[str, frozenset[str]] = {}
        """Each name that is changed, with the names in its values and in the conditions around."""
        self.conditions: list[frozenset[str]] = []
        """The names in each condition around the present statement."""
        self._grammar = grammar
        self._local: set[str] = set()

    def names(self, value: Sequence[str], statement: Sequence[str]) -> frozenset[str]:
        """The names in an expression.

        Raises:
            UnexpectedLayoutError: there is anything else in it.
        """
        names, place, grammar = set[str](), 0, self._grammar
        while place < len(value):
            name, after = (*value[place : place + 2], "")[:2]
            if grammar.is_member(value[place : place + 3]):
                names.add(value[place + 2])
                place += 3
            elif name in self._local and after not in _CALLS:
                names.add(name)
                place += 1
            elif name in _JOINS and not _is_value(value[place - 1 : place]):
                raise strange(statement)
            elif name in grammar.signs or NUMBER.fullmatch(name):
                place += 1
            else:
                raise strange(statement)
        return frozenset(names)

    def change(self, targets: Iterable[str], names: frozenset[str]) -> None:
        """The targets get a value that is made of these names."""
        for name in targets:
            before = self.sources.get(name, frozenset())
            self.sources[name] = before.union(names, *self.conditions)

    def give(self, member: Sequence[str], value: Sequence[str], statement: Sequence[str]) -> bool:
        """A member gets a value; False: it is none that may."""
        if not self._grammar.is_member(member):
            return False
        self.change(member[2:], self.names(value, statement))
        return True

    def declare(self, name: str, value: Sequence[str], statement: Sequence[str]) -> bool:
        """A local truth value begins; False: this is no name for one.

        In C a second one of the same name may read itself, before it has a value.
        """
        if not NAME.fullmatch(name) or name in self._grammar.kept or name in self._local:
            return False
        self.change([name], self.names(value, statement))
        self._local.add(name)
        return True

    def known(self, names: frozenset[str], targets: Iterable[str], local: Iterable[str]) -> None:
        """A statement that is as fretc writes it: all of its names make each of its targets."""
        self.change(targets, names)
        self._local.update(local)

    def tell(
        self,
        outcomes: Sequence[str],
        given: Sequence[Fields],
        own: Sequence[Fields],
        expression: Callable[[str, Tokens], Tokens] = lambda _, value: value,
    ) -> None:
        """What is read of each requirement, at the end.

        Args:
            outcomes: their names.
            given: the fields of each outcome.
            own: those that fretc writes: their names must be the same.
            expression: what a field's value is made of.

        Raises:
            UnexpectedLayoutError: they are not made of expressions.
        """
        if self.conditions or [*map(_names, given)] != [*map(_names, own)]:
            raise strange([token for fields in given for _, value in fields for token in value])
        for outcome, fields in zip(outcomes, given, strict=True):
            for name, value in fields:
                self.change([f"&{outcome}"], self.names(expression(name, value), value))


def _is_value(before: Sequence[str]) -> bool:
    """Whether an expression can end with this token, of which there is one or none."""
    return any(
        each == ")"
        or NUMBER.fullmatch(each)
        or (NAME.fullmatch(each) and each not in ("if", "else"))
        for each in before
    )


def _names(fields: Fields) -> list[str]:
    return [name for name, _ in fields]
