"""Atoms as bits, and which of them order alone cannot separate."""

from itertools import count

from fretc.analysis.arena.propositions import Propositions
from fretish.bindings.declarations import Role
from tests.requirement_sets import requirements, roles


def test_the_reason_of_an_uncertainty_is_about_the_first_variable_by_name() -> None:
    names = [f"n{number}" for number in range(8)]
    squares = [f"{name} * {name} < {bound}" for name in names for bound in (3, 5)]
    total = "((((((n0 + n1) + n2) + n3) + n4) + n5) + n6) + n7"
    chosen = requirements(
        *(f"the sw shall always satisfy {text}" for text in (f"{total} < 9", *squares))
    )
    assert Propositions(chosen, roles([], names), count()).uncertainties == {
        Role.OUTPUT: f"`(({total}) < 9)` and `((n0 * n0) < 3)` read the same numbers, and "
        "are treated as independent"
    }
