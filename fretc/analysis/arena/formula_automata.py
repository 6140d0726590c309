"""A formula as a counter: the states of its automaton as bits."""

from __future__ import annotations

from functools import cache

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import formula as f
from compiler.logic import spot
from compiler.logic.diagrams import decision_diagrams as bdd
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.memory import Memory, PastMemory, RequirementCounter, constant, equals
from fretc.analysis.arena.variables import UnsupportedError

LONGEST_BOUND = 500
"""Longest bound of a formula in ticks; the automaton has a state for each of them."""
_automaton = cache(spot.deterministic_buchi)


def formula_counter(
    requirement: FormalizedRequirement, alphabet: Alphabet, memory: Memory
) -> RequirementCounter:
    """The counter of a formula.

    Raises:
        UnsupportedError: Spot is not installed, or no deterministic automaton has the meaning.
    """
    formula = requirement.ft_infinite
    value = PastMemory(alphabet.atom, memory).value
    for name in f.atoms(formula):
        alphabet.atom(name)  # so that the alphabet has it, even without a counter
    if not spot.is_installed():
        raise UnsupportedError("its formula needs Spot, which is not installed")
    if f.longest_bound(formula) > LONGEST_BOUND:
        raise UnsupportedError(f"its formula has a bound of more than {LONGEST_BOUND} ticks")
    automaton = _automaton(formula)
    if automaton is None:
        raise UnsupportedError("its formula has no deterministic Büchi automaton")
    bits, state = memory.word(max(1, len(automaton.moves) - 1))
    memory.words.pop()  # its value is no number of ticks
    safe, steps = bdd.false(), [bdd.false() for _ in bits]
    for number, moves in enumerate(automaton.moves):
        here = equals(state, number)
        for condition, target in moves:
            taken = here & value(condition)
            safe = safe | taken
            for index, bit in enumerate(constant(target, state)):
                steps[index] = steps[index] | (taken & bit)
    memory.set(bits, steps)
    fair = None
    if automaton.accepting is not None:
        fair = bdd.false()
        for number in automaton.accepting:
            fair = fair | equals(state, number)
    first = -memory.keep(bdd.true())
    kept = memory.needed([safe, first, *([] if fair is None else [fair])])
    return RequirementCounter(
        requirement.id,
        kept,
        tuple(memory.steps[bit] for bit in kept),
        safe,
        fair,
        (),
        bdd.true(),
        first,
    )
