"""Decision diagrams by BuDDy, which is part of Spot.

Source: Duret-Lutz et al., From Spot 2.0 to Spot 2.10, CAV 2022.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

_STEP = 256


class BuddyEngine:
    """BuDDy's functions; its own operators are `&`, `|`, `^`, `-f`, `f - g` and `f >> g`."""

    name = "BuDDy"

    def __init__(self) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of SWIG, not ours
            import spot

            spot.make_bdd_dict()  # it starts BuDDy
            import buddy
        self._buddy: Any = buddy
        self._allocated = 0
        self.true = buddy.bddtrue
        self.false = buddy.bddfalse
        self.ite = buddy.bdd_ite
        self.exists = buddy.bdd_exist
        self.at = buddy.bdd_restrict

    def variable(self, number: int) -> Any:
        """The function that is true where the variable is."""
        while number >= self._allocated:
            self._buddy.bdd_extvarnum(_STEP)
            self._allocated += _STEP
        return self._buddy.bdd_ithvar(number)

    def and_exists(self, left: Any, right: Any, variables: Any) -> Any:
        """`exists(left & right, variables)`."""
        return self._buddy.bdd_appex(left, right, self._buddy.bddop_and, variables)

    def forall_implies(self, left: Any, right: Any, variables: Any) -> Any:
        """`forall(left >> right, variables)`."""
        return self._buddy.bdd_appall(left, right, self._buddy.bddop_imp, variables)

    def substitute(self, function: Any, values: Mapping[int, Any], spare: Mapping[int, int]) -> Any:
        """The function with variables replaced: first by spare variables, then one by one."""
        for number in values if spare else ():
            function = self._buddy.bdd_compose(function, self.variable(spare[number]), number)
        for number, value in values.items():
            function = self._buddy.bdd_compose(function, value, spare.get(number, number))
        return function

    def support(self, function: Any) -> tuple[int, ...]:
        """The variables on which the function depends, in their order."""
        variables, rest = [], self._buddy.bdd_support(function)
        while rest != self.true:
            variables.append(self._buddy.bdd_var(rest))
            rest = self._buddy.bdd_high(rest)
        return tuple(variables)

    def size(self, function: Any) -> int:
        """The number of nodes."""
        return int(self._buddy.bdd_nodecount(function))

    def branches(self, function: Any) -> tuple[int, Any, Any]:
        """The topmost variable, and the cofactors for true and for false."""
        buddy = self._buddy
        return buddy.bdd_var(function), buddy.bdd_high(function), buddy.bdd_low(function)
