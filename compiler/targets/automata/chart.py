"""The reference automaton of a sentence with its expressions on the edges.

Deciding states are merged: into `violated`, from which nothing satisfies the sentence, and
`satisfied`, from which nothing violates it. A run enters them at the first tick that decides.
Source of the verdicts: Bauer, Leucker, Schallhart, Runtime verification for LTL and TLTL, TOSEM 20
(2011).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import assert_never

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import parts, possible_letters
from compiler.formalization.obligation import ObligationKind, obligation
from compiler.formalization.reference import (
    BROKEN,
    Automaton,
    Letter,
    Phase,
    ReferenceState,
    Template,
    accepting,
    explore,
    template,
)
from compiler.logic import formula as f
from compiler.logic.implicants import Term, cover
from fretish.classes.frozen import dataclass
from fretish.reading.recursion import with_recursion_limit
from fretish.syntax import ScopeKind

MOST_STATES = 100_000
"""Maximum number of states of a file; tools cannot read larger automata."""
PLACES = ("mode", "condition", "response", "stop")
"""The names of the positions of a letter."""


@dataclass(frozen=True, slots=True)
class Chart:
    """A deterministic automaton, complete over the possible letters, initial state first."""

    template: Template
    inputs: Mapping[int, f.Formula]
    """The expressions of the sentence, by their position in a letter."""
    letters: tuple[Letter, ...]
    """All possible letters, and perhaps some that no valuation of the propositions has."""
    states: tuple[ReferenceState, ...]
    """The states that have not decided."""
    moves: tuple[tuple[int, ...], ...]
    """For each of these states and each letter: the index of the next state, which may be
    `violated` or `satisfied`."""
    start: int

    @property
    def violated(self) -> int:
        """The index of the state from which nothing satisfies the sentence."""
        return len(self.states)

    @property
    def satisfied(self) -> int:
        """The index of the state from which nothing violates the sentence."""
        return len(self.states) + 1

    def accepts(self, index: int) -> bool:
        """Whether the state accepts: an infinite run that visits such states for ever satisfies."""
        if index >= len(self.states):
            return index == self.satisfied
        return accepting(self.template, self.states[index])

    def has(self, index: int) -> bool:
        """Whether the state can be reached."""
        return index in {self.start, *(after for row in self.moves for after in row)}

    def guard(self, letters: Iterable[Letter]) -> list[Term]:
        """The letters as conjunctions over the positions of `inputs`; the empty one is true."""
        chosen = set(letters)
        places = tuple(self.inputs)

        def vectors(chosen_letters: Iterable[Letter]) -> list[tuple[bool, ...]]:
            return sorted(tuple(letter[index] for index in places) for letter in chosen_letters)

        terms = cover(vectors(chosen), vectors(set(self.letters) - chosen))
        return [{places[i]: value for i, value in term.items()} for term in terms]


@with_recursion_limit
def chart(requirement: FormalizedRequirement) -> Chart:
    """The automaton of a requirement.

    Raises:
        TooManyStatesError: it has more than `MOST_STATES` states.
    """
    automaton = explored(requirement)
    pending = [i for i, verdict in enumerate(automaton.verdicts) if verdict == "pending"]
    numbers = {old: new for new, old in enumerate(pending)}
    numbers[BROKEN] = len(pending)
    for index, verdict in enumerate(automaton.verdicts):
        if verdict != "pending":
            numbers[index] = len(pending) + (verdict == "satisfied")
    return Chart(
        automaton.template,
        {i: part for i, part in enumerate(parts(requirement.sentence)) if part is not None},
        automaton.letters,
        tuple(automaton.states[i] for i in pending),
        tuple(tuple(numbers[after] for after in automaton.moves[i]) for i in pending),
        numbers[0],
    )


@with_recursion_limit
def explored(requirement: FormalizedRequirement) -> Automaton:
    """The automaton of a requirement over the letters that can occur.

    Raises:
        TooManyStatesError: it has more than `MOST_STATES`.
    """
    kind = template(requirement.sentence, requirement.ticks or 0)
    return _cached(kind, possible_letters(requirement.sentence))


@lru_cache(maxsize=4)  # a requirement is asked whether it is refused before it is emitted
def _cached(kind: Template, letters: tuple[Letter, ...]) -> Automaton:
    return explore(kind, letters, MOST_STATES)


@with_recursion_limit
def kind(requirement: FormalizedRequirement) -> ObligationKind:
    """The kind of the demand; `only` scopes demand the dual of their timing."""
    return obligation(requirement.sentence, requirement.ticks or 0).demand.kind


def words(demanded: ObligationKind, template: Template, state: ReferenceState) -> tuple[str, ...]:
    """The description of a state; its counter comes last, before `condition was true`.

    Args:
        demanded: the `kind` of the requirement.
        template: the template of its sentence.
        state: a state that has not decided.
    """
    enforced = state.phase in (Phase.INSIDE, Phase.LAST_RUN)
    phrases = []
    if state.phase is Phase.OUTSIDE and template.scope in _FROM_THE_START:
        phrases.append(START)
    elif template.scope is not None:
        phrases.append(_PHASES[state.phase])
    if enforced:
        idle = "waiting" if template.condition else "no obligation is pending"
        phrases.append(_counter_words(demanded, state.counted) if state.counted else idle)
    if state.held:
        phrases.append("condition was true")
    return tuple(phrases)


START = "start"
"""The name of the state before the first tick, if no tick leads to it."""
_FROM_THE_START = (None, ScopeKind.BEFORE, ScopeKind.ONLY_AFTER)
"""The scopes in which no tick lies before an interval."""
_PHASES: Mapping[Phase, str] = {
    Phase.OUTSIDE: "not enforced",
    Phase.FIRST_RUN: "not enforced, in the first run of the mode",
    Phase.INSIDE: "enforced",
    Phase.LAST_RUN: "enforced, in the first run of the mode",
    Phase.OVER: "not enforced any more",
}


def _counter_words(demanded: ObligationKind, count: int) -> str:
    match demanded:
        case ObligationKind.IMMEDIATELY:
            raise AssertionError("it counts nothing")
        case ObligationKind.NEXT:
            return "due at the next tick"
        case ObligationKind.FINALLY:
            return f"due at the end, {'held' if count < 0 else 'missing'} at this tick"
        case ObligationKind.ALWAYS:
            return "pending for ever"
        case ObligationKind.UNTIL:
            return "pending until the stop condition"
        case ObligationKind.FOR:
            return f"pending for {_ticks(count)} more"
        case ObligationKind.EVENTUALLY | ObligationKind.BEFORE:
            return "open"
        case ObligationKind.WITHIN:
            return f"open for {_ticks(count)}"
        case ObligationKind.AFTER:
            return f"open {'twice ' if count < 0 else ''}for {_ticks(abs(count))}"
        case ObligationKind.NOT_AFTER:
            ago = [str(k + 1) for k in range(count.bit_length()) if count >> k & 1]
            return f"open since {', '.join(ago)} ticks ago"
        case _:
            assert_never(demanded)


def _ticks(count: int) -> str:
    return "1 tick" if count == 1 else f"{count} ticks"
