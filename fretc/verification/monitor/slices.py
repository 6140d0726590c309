"""Slice of one requirement in a monitor of several: what its signals depend on.

The order of statements is ignored: a name depends on everything that any statement assigns to it,
and on the enclosing conditions. So code outside the slice has no influence.
"""

from __future__ import annotations

import ast
from collections.abc import Hashable, Iterable, Iterator, Mapping
from functools import lru_cache

from compiler.formalization.letters import Valuation
from compiler.program.program import MARKS
from fretc.verification.monitor.equivalence import Judgement
from fretc.verification.monitor.machine import Stepped
from fretc.verification.monitor.text_check import own
from fretish.classes.frozen import dataclass

_Given = Mapping[str, frozenset[str]]
"""Name → names on which it depends."""


@dataclass(frozen=True, slots=True)
class Slice:
    """A part of a monitor that is stepped by itself."""

    propositions: frozenset[str]
    cells: frozenset[str]


@dataclass(frozen=True, slots=True)
class SlicedMonitor:
    """A monitor of several requirements, stepped by the propositions of one."""

    machine: Stepped
    others: int
    """Propositions at the end of a valuation on which the requirement does not depend."""

    def save(self) -> Hashable:
        """The cells of the machine."""
        return self.machine.save()

    def load(self, state: Hashable) -> None:
        """Go back to them."""
        self.machine.load(state)

    def step(self, letter: Valuation) -> Judgement:
        """Step with all other propositions false."""
        return self.machine.step((*letter, *(False,) * self.others))


def slice_of(text: str, prefix: str, propositions: Mapping[str, str]) -> Slice:
    """The part on which the signals and the marks of a requirement depend.

    Args:
        text: text of a monitor, in the layout that fretc writes.
        prefix: prefix of the names of the requirement's signals and marks.
        propositions: proposition → parameter.
    """
    given = _sources(text)
    reached = _closure(given, (f"{prefix}_{name}" for name in (*MARKS, "signals")))
    return Slice(
        frozenset(name for name, parameter in propositions.items() if parameter in reached),
        reached,
    )


@lru_cache(maxsize=1)
def _sources(text: str) -> _Given:
    approximation = next(
        node
        for node in own(text).body
        if isinstance(node, ast.ClassDef) and node.name.endswith("Approximation")
    )
    advance = next(
        part
        for part in approximation.body
        if isinstance(part, ast.FunctionDef) and part.name == "advance"
    )
    given: dict[str, frozenset[str]] = {}
    for name, sources in _given(advance.body, frozenset()):
        given[name] = given.get(name, frozenset()) | sources
    return given


def _closure(given: _Given, names: Iterable[str]) -> frozenset[str]:
    closure = {*names}
    waiting = [*closure]
    while waiting:
        for name in given.get(waiting.pop(), frozenset()) - closure:
            closure.add(name)
            waiting.append(name)
    return frozenset(closure)


def _given(
    statements: Iterable[ast.stmt], tests: frozenset[str]
) -> Iterator[tuple[str, frozenset[str]]]:
    """Each changed name, with all names on which the change depends."""
    for statement in statements:
        match statement:
            case ast.Assign(targets, value):
                sources = tests | _names(value)
                for name in (*_names(*targets), *_stepped(value)):
                    yield name, sources
            case ast.If(test, body, orelse):
                inside = tests | _names(test)
                for name in _stepped(test):
                    yield name, inside
                yield from _given((*body, *orelse), inside)
            case ast.For(_, _, body):
                yield from _given(body, tests)


def _names(*nodes: ast.expr) -> set[str]:
    """Local names and the attributes of `self`, which have the same names."""
    return {
        part.id if isinstance(part, ast.Name) else part.attr
        for node in nodes
        for part in ast.walk(node)
        if isinstance(part, ast.Name | ast.Attribute)
    } - {"self"}


def _stepped(node: ast.expr) -> Iterator[str]:
    """The windows that are stepped in it."""
    for part in ast.walk(node):
        match part:
            case ast.Attribute(ast.Name(name), "step"):
                yield name
