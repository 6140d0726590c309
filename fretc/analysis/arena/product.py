"""The arena of a requirement set: one counter for each requirement, over one alphabet.

Variables that are read together are adjacent in the variable order: the atoms of a requirement,
then its counter, then the next requirement that shares the most variables with the earlier ones.
With this order, eight deadlines for one resource take forty milliseconds; with all counters first,
the construction does not end.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.counters import counter
from fretc.analysis.arena.memory import Bit, RequirementCounter
from fretc.analysis.arena.variables import Numbers, UnsupportedError
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Arena:
    """Requirements and assumptions as counters over one alphabet."""

    alphabet: Alphabet
    counters: tuple[RequirementCounter, ...]
    """Counters of the requirements, in the order of the files, except those in `beyond`."""
    assumptions: tuple[RequirementCounter, ...]
    beyond: dict[str, str]
    """Id of a requirement without a counter → the reason."""

    @property
    def size(self) -> int:
        """Number of bits of a valuation."""
        return len(self.alphabet.inputs) + len(self.alphabet.outputs)


class Fixed:
    """An alphabet whose atoms have all been asked for; it does not change any more."""

    def __init__(self, alphabet: Alphabet) -> None:
        memory = alphabet.memory()
        self.atom, self.values, self.course = alphabet.atom, alphabet.values, alphabet.course
        self.inputs, self.outputs = tuple(alphabet.inputs), tuple(alphabet.outputs)
        self.legal, self.reachable = alphabet.legal, alphabet.reachable
        self.possible, self.certain = alphabet.possible, alphabet.certain
        self.uncertainties, self.labels = alphabet.uncertainties, alphabet.labels
        self.uncertain_atoms, self.open = alphabet.uncertain_atoms, alphabet.open
        self.is_refinable = alphabet.is_refinable
        self.memory = lambda: memory


def arena(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    alphabet: Alphabet,
    fresh: Numbers,
    *,
    as_fret: bool = False,
    beyond: Mapping[str, str] | None = None,
) -> Arena:
    """The arena of some requirements.

    Args:
        requirements: the requirements that are counted.
        assumptions: the assumptions about the environment.
        alphabet: the alphabet of both.
        fresh: variables for bits.
        as_fret: whether FRET's question is asked.
        beyond: id of a further requirement, which is not counted → the reason.

    Raises:
        UnsupportedError: an assumption has no counter.
    """
    counters: dict[str, RequirementCounter] = {}
    left_out = dict(beyond or {})
    shared: dict[Function, Bit] = {}
    known = {id(requirement) for requirement in assumptions}
    for requirement in near_each_other([*requirements, *assumptions]):
        try:
            made = counter(
                requirement,
                alphabet,
                fresh,
                shared,
                as_fret=as_fret and id(requirement) not in known,
            )
        except UnsupportedError as error:
            if id(requirement) in known:
                raise UnsupportedError(f"of the assumption {requirement.id}: {error}") from None
            left_out[requirement.id] = str(error)
        else:
            counters[requirement.id] = made
    of_rules = tuple(
        counters[requirement.id] for requirement in requirements if requirement.id in counters
    )
    of_assumptions = tuple(counters[assumption.id] for assumption in assumptions)
    return Arena(Fixed(alphabet), of_rules, of_assumptions, left_out)


def near_each_other(requirements: Sequence[FormalizedRequirement]) -> list[FormalizedRequirement]:
    """Requirements in variable order: those with counts first, by the number of shared variables.

    The others add few bits, or none, and would separate atoms from the counters that read them.
    """
    rest = list(requirements)
    ordered: list[FormalizedRequirement] = []
    placed: set[str] = set()
    while rest:
        last = set(ordered[-1].variables) if ordered else set()
        best = max(
            rest,
            key=lambda requirement: (
                bool(requirement.ticks),
                len(last.intersection(requirement.variables)),
                len(placed.intersection(requirement.variables)),
            ),
        )
        rest.remove(best)
        ordered.append(best)
        placed.update(best.variables)
    return ordered
