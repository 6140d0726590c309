"""Whether real numbers exist that give the comparisons of a sentence the values of a valuation.

The decision is exact, over integers for signals that have only integers. Monitors compute in
floats, where rounding makes `x + 1 > x` false for a large x. So impossibility here only selects the
traces that are displayed, and no proof rests on it; `compiler.logic.orders` is sound for floats.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Protocol, TypeVar

import z3

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import comparisons, exclusion_in_words
from compiler.formalization.numbers.terms import NoTermError, RequirementTerms, Term
from compiler.logic.orders import Exclusion
from fretish import expressions as e
from fretish.classes.frozen import dataclass

MOST_STEPS = 300_000
"""Resource limit of z3 for one query, in z3's own unit, so that every machine gives the same
answer."""
MOST_QUESTIONS = 400
"""Maximum number of queries for one sentence."""
_UNANSWERED = 20
"""Number of queries that one query counts as if it used its whole limit."""
MOST_ROUNDS = 10
"""Maximum number of rounds of the search for a trace with numbers."""
MOST_SEARCHED = 10_000
"""Maximum number of states in each round; the limit must not turn a refutation into an undecided
result."""


@dataclass(frozen=True, slots=True)
class Possible:
    """Numbers that give the comparisons these values, in the signals' units."""

    numbers: Mapping[str, Fraction]
    """Values by variable; irrational numbers are left out."""


@dataclass(frozen=True, slots=True)
class Impossible:
    """No real numbers give the comparisons these values."""

    exclusion: Exclusion
    """A minimal part of the valuation that is impossible."""


@dataclass(frozen=True, slots=True)
class Undecided:
    """It was not decided whether such numbers exist."""


Answer = Possible | Impossible | Undecided


class Reals:
    """Queries about the comparisons of a requirement."""

    def __init__(self, requirement: FormalizedRequirement) -> None:
        """Prepare the queries; z3 is not called yet."""
        compared = comparisons(requirement)
        terms = RequirementTerms([requirement], is_linear=False)
        self._solver = z3.Solver()
        self._solver.set("rlimit", MOST_STEPS)
        self._flags: dict[str, Term] = {}
        read, beyond = {}, set()
        for name, part in compared.items():
            try:
                read[name] = terms.holds(part, True, lambda _: z3.BoolVal(True))
            except NoTermError:
                beyond.add(name)
        for index, (name, formula) in enumerate(read.items()):
            self._flags[name] = z3.Bool(f"comparison {index}")
            self._solver.add(self._flags[name] == formula)
        self._solver.add([terms.domain(name) for name in terms.variables])
        self._variables = dict(terms.variables)
        self._unread = frozenset(name for name in beyond if _meets_others(name, compared))
        self._excluded: list[Exclusion] = []
        self._left = MOST_QUESTIONS

    def answer(self, valuation: Mapping[str, bool | None]) -> Answer:
        """Whether numbers exist for the valuation; atoms that are not comparisons are free."""
        for impossible in self._excluded:
            if all(valuation.get(name) is value for name, value in impossible):
                return Impossible(impossible)
        literals = tuple(
            (name, value) for name in self._flags if (value := valuation.get(name)) is not None
        )
        result = self._ask(literals)
        if result == z3.unsat:
            return self._impossible(literals)
        if result == z3.unknown or any(valuation.get(name) is not None for name in self._unread):
            return Undecided()
        return Possible(dict(self._numbers()))

    def _impossible(self, literals: Exclusion) -> Impossible:
        """The impossible literals, reduced to a minimal set."""
        core = {str(assumption) for assumption in self._solver.unsat_core()}
        needed = tuple(literal for literal in literals if str(self._literal(literal)) in core)
        for literal in needed:
            less = tuple(other for other in needed if other != literal)
            if self._ask(less) == z3.unsat:
                needed = less
        self._excluded.append(needed)
        return Impossible(needed)

    def _ask(self, literals: Exclusion) -> Term:
        if self._left <= 0:
            return z3.unknown
        status = self._solver.check([self._literal(literal) for literal in literals])
        self._left -= _UNANSWERED if status == z3.unknown else 1
        return status

    def _literal(self, literal: tuple[str, bool]) -> Term:
        name, value = literal
        return self._flags[name] if value else z3.Not(self._flags[name])

    def _numbers(self) -> Iterator[tuple[str, Fraction]]:
        model = self._solver.model()
        for name, variable in self._variables.items():
            value = model.eval(variable, model_completion=True)
            if z3.is_int_value(value) or z3.is_rational_value(value):
                yield name, Fraction(str(value))


def _meets_others(name: str, compared: Mapping[str, e.Comparison]) -> bool:
    """Whether another comparison reads the same variables; if not, the comparison is free."""
    own = {name_node.id for name_node in e.names(compared[name])}
    return any(
        not own.isdisjoint(name_node.id for name_node in e.names(part))
        for other, part in compared.items()
        if other != name
    )


# Counterexamples --------------------------------------------------------------------------------


class Counterexample(Protocol):
    """A trace that refutes a claim."""

    @property
    def word(self) -> Sequence[Sequence[bool | None]]:
        """The values of atoms at each tick."""


Found = TypeVar("Found", bound=Counterexample)
Other = TypeVar("Other")

NOT_DECIDED = (
    "it was not decided whether numbers can make these comparisons true and false in this way"
)


def rounding_note(exclusion: Exclusion) -> str:
    """The note for a trace that no exact numbers make."""
    literals = exclusion_in_words(exclusion)
    return f"in exact arithmetic no numbers make {literals}; rounded floats may"


def with_numeric_counterexample(
    requirement: FormalizedRequirement,
    atoms: Sequence[str],
    kind: type[Found],
    compare: Callable[[Sequence[Exclusion]], Found | Other],
) -> tuple[Found | Other, str]:
    """The result of a comparison; a counterexample has numbers where possible.

    Args:
        requirement: the requirement with the compared atoms.
        atoms: the order of the values of a tick.
        kind: the class of counterexamples.
        compare: the search for a counterexample without the given combinations, among at most
            `MOST_SEARCHED` states if there are any combinations.

    Returns:
        The result without excluded combinations, or another counterexample; and a note about its
        numbers. Excluding combinations never turns a counterexample into a proof.
    """
    first = compare(())
    if not isinstance(first, kind) or not comparisons(requirement):
        return first, ""
    reals, excluded, shown = Reals(requirement), list[Exclusion](), first
    for _ in range(MOST_ROUNDS):
        word: Sequence[Sequence[bool | None]] = shown.word
        answers = [reals.answer(dict(zip(atoms, row, strict=False))) for row in word]
        new = [answer.exclusion for answer in answers if isinstance(answer, Impossible)]
        if not new:
            return shown, NOT_DECIDED if Undecided() in answers else ""
        excluded += dict.fromkeys(new)
        other = compare(excluded)
        if not isinstance(other, kind):
            break
        shown = other
    return first, f"no other trace was found that shows it, and {rounding_note(excluded[0])}"
