"""Boolean functions as binary decision diagrams, computed by BuDDy, which is part of Spot.

A variable is a number, and numbers give the order of variables: variables that are read together
should be adjacent, or diagrams grow. Functions have the operators `&`, `|`, `^`, `-f` and `f - g`;
equal functions are equal objects. All users in a process share one table of nodes, and one
numbering.

Source: Bryant, Graph-based algorithms for Boolean function manipulation, IEEE Trans. Computers 35
(1986); Duret-Lutz et al., From Spot 2.0 to Spot 2.10, CAV 2022.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

Function = Any
"""A diagram; the library has no type stubs."""


@lru_cache(maxsize=1)
def _buddy() -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of SWIG, not ours
        import spot

        spot.make_bdd_dict()  # it starts BuDDy
        import buddy
    return buddy


_STEP = 256
_allocated = 0


def true() -> Function:
    """The function that is true."""
    return _buddy().bddtrue


def false() -> Function:
    """The function that is false."""
    return _buddy().bddfalse


def variable(number: int) -> Function:
    """The function that is true where the variable is."""
    global _allocated
    buddy = _buddy()
    while number >= _allocated:
        buddy.bdd_extvarnum(_STEP)
        _allocated += _STEP
    return buddy.bdd_ithvar(number)


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
    return _buddy().bdd_ite(condition, then, otherwise)


def exists(function: Function, variables: Function) -> Function:
    """Existential quantification over the variables of a cube."""
    return _buddy().bdd_exist(function, variables)


def and_exists(left: Function, right: Function, variables: Function) -> Function:
    """`exists(left & right, variables)`, without the conjunction ever being built."""
    buddy = _buddy()
    return buddy.bdd_appex(left, right, buddy.bddop_and, variables)


def forall_implies(left: Function, right: Function, variables: Function) -> Function:
    """`forall(left >> right, variables)`, without the implication ever being built."""
    buddy = _buddy()
    return buddy.bdd_appall(left, right, buddy.bddop_imp, variables)


def compose(function: Function, number: int, value: Function) -> Function:
    """The function with a variable replaced by another function."""
    return _buddy().bdd_compose(function, value, number)


def at(function: Function, literals: Function) -> Function:
    """The function restricted by the literals of a cube."""
    return _buddy().bdd_restrict(function, literals)


def support(function: Function) -> tuple[int, ...]:
    """The variables on which the function depends, in their order."""
    buddy = _buddy()
    variables, rest = [], buddy.bdd_support(function)
    while rest != buddy.bddtrue:
        variables.append(buddy.bdd_var(rest))
        rest = buddy.bdd_high(rest)
    return tuple(variables)


def witness(function: Function, prefer: bool = False) -> dict[int, bool]:
    """Values of some variables that make the function true, each `prefer` where possible.

    Args:
        function: not false.
        prefer: the value that is tried first, variable by variable in their order.
    """
    buddy = _buddy()
    assert function != buddy.bddfalse
    values = {}
    while function != buddy.bddtrue:
        branches = {False: buddy.bdd_low(function), True: buddy.bdd_high(function)}
        value = prefer if branches[prefer] != buddy.bddfalse else not prefer
        values[buddy.bdd_var(function)] = value
        function = branches[value]
    return values


def size(function: Function) -> int:
    """The number of nodes."""
    return int(_buddy().bdd_nodecount(function))


def branches(function: Function) -> tuple[int, Function, Function]:
    """The topmost variable of a non-constant function, and the cofactors for true and for false."""
    buddy = _buddy()
    return buddy.bdd_var(function), buddy.bdd_high(function), buddy.bdd_low(function)


def nodes(functions: Iterable[Function]) -> tuple[Function, ...]:
    """The non-constant nodes of the diagrams, each after its successors."""
    nodes: dict[Function, None] = {}
    waiting = [*functions]
    while waiting:
        function = waiting[-1]
        needed = []
        if function not in nodes and function not in (true(), false()):
            _, high, low = branches(function)
            needed = [n for n in (high, low) if n not in nodes and n not in (true(), false())]
            if not needed:
                nodes[function] = None
        waiting.extend(needed)
        if not needed:
            waiting.pop()
    return tuple(nodes)
