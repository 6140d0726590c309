"""Boolean functions as binary decision diagrams, computed by OxiDD or by BuDDy.

A variable is a number, and numbers give the order of variables: variables that are read together
should be adjacent, or diagrams grow. Functions have the operators `&`, `|`, `^`, `-f`, `f - g` and
`f >> g`; equal functions are equal objects. All users in a process share one engine, one table of
nodes, and one numbering. If the table is full, an operation raises MemoryError or ends the process.

Source: Bryant, Graph-based algorithms for Boolean function manipulation, IEEE Trans. Computers 35
(1986).
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from compiler.logic.diagrams.buddy_engine import BuddyEngine
    from compiler.logic.diagrams.oxidd_engine import OxiddEngine

    Engine: TypeAlias = BuddyEngine | OxiddEngine

Function = Any
"""A diagram; the libraries have no type in common."""


@lru_cache(maxsize=1)
def engine() -> Engine:
    """OxiDD, or the engine of Spot if `FRETC_DIAGRAMS` is `buddy`, which tests compare with it."""
    if os.environ.get("FRETC_DIAGRAMS") == "buddy":
        from compiler.logic.diagrams.buddy_engine import BuddyEngine

        return BuddyEngine()
    from compiler.logic.diagrams.oxidd_engine import OxiddEngine

    return OxiddEngine()


def true() -> Function:
    """The function that is true."""
    return engine().true


def false() -> Function:
    """The function that is false."""
    return engine().false


def variable(number: int) -> Function:
    """The function that is true where the variable is."""
    return engine().variable(number)


def literal(number: int, value: bool) -> Function:
    """The function that is true where the variable has the value."""
    return variable(number) if value else -variable(number)


def cube(variables: Iterable[int]) -> Function:
    """The conjunction of variables, as quantifiers take it."""
    return _cube(tuple(variables))


@lru_cache(maxsize=64)
def _cube(variables: tuple[int, ...]) -> Function:
    return point(dict.fromkeys(variables, True))


def point(values: Mapping[int, bool]) -> Function:
    """The conjunction of the literals."""
    conjunction = true()
    for number in sorted(values, reverse=True):  # from the bottom up each step is one node
        conjunction = literal(number, values[number]) & conjunction
    return conjunction


def ite(condition: Function, then: Function, otherwise: Function) -> Function:
    """`condition ? then : otherwise`."""
    return engine().ite(condition, then, otherwise)


def exists(function: Function, variables: Function) -> Function:
    """Existential quantification over the variables of a cube."""
    return engine().exists(function, variables)


def and_exists(left: Function, right: Function, variables: Function) -> Function:
    """`exists(left & right, variables)`, without the conjunction ever being built."""
    return engine().and_exists(left, right, variables)


def forall_implies(left: Function, right: Function, variables: Function) -> Function:
    """`forall(left >> right, variables)`, without the implication ever being built."""
    return engine().forall_implies(left, right, variables)


def substitute(
    function: Function, values: Mapping[int, Function], spare: Mapping[int, int] | None = None
) -> Function:
    """The function with variables replaced by functions, all at once.

    Args:
        function: the function.
        values: a function for each replaced variable.
        spare: for each replaced variable one that no function reads, best the next in the order;
            left out only if the values read none of the replaced variables.
    """
    return engine().substitute(function, values, spare or {}) if values else function


def at(function: Function, literals: Function) -> Function:
    """The function restricted by the literals of a cube."""
    return engine().at(function, literals)


def support(function: Function) -> tuple[int, ...]:
    """The variables on which the function depends, in their order."""
    return engine().support(function)


def witness(function: Function, prefer: bool = False) -> dict[int, bool]:
    """Values of some variables that make the function true, each `prefer` where possible.

    Args:
        function: not false.
        prefer: the value that is tried first, variable by variable in their order.
    """
    assert function != false()
    values = {}
    while function != true():
        number, high, low = branches(function)
        value = prefer if (high if prefer else low) != false() else not prefer
        values[number] = value
        function = high if value else low
    return values


def size(function: Function) -> int:
    """The number of nodes, without the constants."""
    return engine().size(function)


def branches(function: Function) -> tuple[int, Function, Function]:
    """The topmost variable of a non-constant function, and the cofactors for true and for false."""
    return engine().branches(function)


def nodes(functions: Iterable[Function]) -> tuple[Function, ...]:
    """The non-constant nodes of the diagrams, each after its successors."""
    constants = (true(), false())
    nodes: dict[Function, None] = {}
    waiting = [*functions]
    while waiting:
        function = waiting[-1]
        needed = []
        if function not in nodes and function not in constants:
            _, high, low = branches(function)
            needed = [n for n in (high, low) if n not in nodes and n not in constants]
            if not needed:
                nodes[function] = None
        waiting.extend(needed)
        if not needed:
            waiting.pop()
    return tuple(nodes)
