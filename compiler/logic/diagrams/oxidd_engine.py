"""Decision diagrams by OxiDD, which has wheels for every platform.

Source: Husung et al., OxiDD: A safe, concurrent, modular, and performant decision
diagram framework in Rust, TACAS 2024.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from oxidd.bdd import BDDFunction, BDDManager, BDDSubstitution
from oxidd.util import BooleanOperator

_STEP = 256
_NODES = 2**25
"""Limit of the table: 16 bytes a node, of which the system gives those that are used."""
_CACHE = 2**20


def _negation(function: Any) -> Any:
    return ~function


def _difference(left: Any, right: Any) -> Any:
    return right.imp_strict(left)


def _implication(left: Any, right: Any) -> Any:
    return left.imp(right)


def _add_operators() -> None:
    """Give OxiDD's functions the operators that BuDDy's have, without an object around each."""
    for name, operator in (
        ("__neg__", _negation),
        ("__sub__", _difference),
        ("__rshift__", _implication),
    ):
        setattr(BDDFunction, name, operator)


class OxiddEngine:
    """OxiDD's functions, in one table and one thread: a process that is forked may go on.

    A full table raises `oxidd.util.DDMemoryError`, which is a MemoryError.
    """

    name = "OxiDD"

    def __init__(self) -> None:
        _add_operators()
        self._manager = BDDManager(_NODES, _CACHE, 1)
        self._variables: list[Any] = []
        self.true: Any = self._manager.true()
        self.false: Any = self._manager.false()
        self.ite = BDDFunction.ite
        self.exists = BDDFunction.exists
        self._variables_of_cube = lru_cache(maxsize=1024)(self._cube_variables)
        self._substitution = lru_cache(maxsize=256)(_substitution)

    def variable(self, number: int) -> Any:
        """The function that is true where the variable is."""
        while number >= len(self._variables):
            added = self._manager.add_vars(_STEP)
            self._variables += [self._manager.var(index) for index in added]
        return self._variables[number]

    def and_exists(self, left: Any, right: Any, variables: Any) -> Any:
        """`exists(left & right, variables)`."""
        return left.apply_exists(BooleanOperator.AND, right, variables)

    def forall_implies(self, left: Any, right: Any, variables: Any) -> Any:
        """`forall(left >> right, variables)`."""
        return left.apply_forall(BooleanOperator.IMP, right, variables)

    def substitute(self, function: Any, values: Mapping[int, Any], spare: Mapping[int, int]) -> Any:
        """The function with variables replaced by functions, all at once."""
        return function.substitute(self._substitution(frozenset(values.items())))

    def at(self, function: Any, literals: Any) -> Any:
        """The function restricted by the literals of a cube."""
        return function.apply_exists(
            BooleanOperator.AND, literals, self._variables_of_cube(literals)
        )

    def _cube_variables(self, literals: Any) -> Any:
        """The positive cube of the variables of a cube of literals."""
        numbers, false = [], self.false
        while (pair := literals.cofactors()) is not None:
            numbers.append(literals.node_var())
            literals = pair[1] if pair[0] == false else pair[0]
        cube = self.true
        for number in reversed(numbers):
            cube = self._variables[number] & cube
        return cube

    def support(self, function: Any) -> tuple[int, ...]:
        """The variables on which the function depends, in their order."""
        numbers, seen, waiting = set(), {function}, [function]
        while waiting:
            node = waiting.pop()
            pair = node.cofactors()
            if pair is None:
                continue
            numbers.add(node.node_var())
            for branch in pair:
                if branch not in seen:
                    seen.add(branch)
                    waiting.append(branch)
        return tuple(sorted(numbers))

    def size(self, function: Any) -> int:
        """The number of nodes, without the constants."""
        return max(0, int(function.node_count()) - 2)

    def branches(self, function: Any) -> tuple[int, Any, Any]:
        """The topmost variable, and the cofactors for true and for false."""
        high, low = function.cofactors()
        return function.node_var(), high, low


def _substitution(values: frozenset[tuple[int, Any]]) -> BDDSubstitution:
    return BDDFunction.make_substitution(values)
