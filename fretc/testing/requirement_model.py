"""A requirement under test with related requirements: its counters, and shortest runs.

All variables are chosen freely: a test is a run, not a game. The other requirements are satisfied
at every tick, and can be satisfied for ever afterwards; the requirement under test may be violated.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import assert_never

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import Obligation, obligation
from compiler.formalization.predicates import Past as PastWords
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from compiler.logic.formula import Formula, atoms
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.counters import counter
from fretc.analysis.arena.memory import Bit, Memory, PastMemory, RequirementCounter, side_by_side
from fretc.analysis.arena.product import Fixed, near_each_other
from fretc.analysis.arena.transition import Transition
from fretc.analysis.arena.variables import Numbers, UnsupportedError, numbers
from fretc.analysis.games.runs import SatisfyingRuns
from fretc.analysis.realizability_problem import alphabet_of
from fretc.testing.search import Endings, Letter, RunSearch
from fretc.testing.suite import Polarity
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass

Ids = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class StepResult:
    """Signals of a sentence for the run up to a tick, over a state and a valuation."""

    breaks: Function
    """The requirement is violated at this tick, and not before."""
    broken: Function
    """The requirement is violated at this tick or before."""
    accepts: Function
    """FRET's verdict if the run ended here."""
    obligation_pending: Function
    """An obligation is open, without a violation."""


class RequirementModel:
    """A requirement under test, and those that share variables with it, directly or indirectly."""

    def __init__(
        self,
        requirement: FormalizedRequirement,
        others: Sequence[FormalizedRequirement],
        more: Iterable[FormalizedRequirement],
        budget: Budget,
        fresh: Numbers | None = None,
    ) -> None:
        """The model.

        Args:
            requirement: the requirement under test.
            others: requirements and assumptions that its tests satisfy.
            more: further sentences whose atoms belong to the valuations.
            budget: time limit for all searches.
            fresh: variables, if their order matters.

        Raises:
            UnsupportedError: the requirement has no counter.
        """
        every = [requirement, *others, *more]
        roles = dict.fromkeys((name for each in every for name in each.variables), Role.OUTPUT)
        self.requirement, self.budget = requirement, budget
        self._fresh = fresh or numbers()
        self._shared: dict[Function, Bit] = {}
        alphabet = alphabet_of(every, roles, self._fresh, Role.OUTPUT, of_moments=True)
        self.beyond: dict[str, str] = {}
        """Id of another requirement without a counter → the reason."""
        self._counters: dict[str, RequirementCounter] = {}
        for each in near_each_other([requirement, *others]):
            try:
                self._counters[each.id] = counter(each, alphabet, self._fresh, self._shared)
            except UnsupportedError as error:
                if each is requirement:
                    raise
                self.beyond[each.id] = str(error)
        for each in every:
            try:
                for name in demands(each).atoms:
                    alphabet.atom(name)
            except UnsupportedError as error:
                if each not in others:
                    raise
                raise UnsupportedError(f"its tests must satisfy {each.id}, but {error}") from None
        numbers_before = alphabet.memory()
        self._always = () if numbers_before is None else (numbers_before,)
        self.alphabet = Fixed(alphabet)
        self._letters = (*self.alphabet.inputs, *self.alphabet.outputs)
        self._quiet = frozenset(self._asked(requirement))
        self.others: Ids = tuple(other.id for other in others if other.id in self._counters)
        self._memory = Memory(self._fresh, self._shared)
        self._past = PastMemory(self.alphabet.atom, self._memory)
        self._own = self._judged(
            self._counters[requirement.id], requirement, self._past, self._memory
        )
        self._setting = cache(self._built)
        self._kept = cache(self._keeping)
        self._ends = cache(self._endings)

    def _asked(self, requirement: FormalizedRequirement) -> Iterator[int]:
        """Variables of condition, response and stop condition."""
        whole = demands(requirement)
        for part in (whole.trigger, whole.demand.response, whole.demand.stop):
            for name in atoms(part):
                yield from bdd.support(self.alphabet.atom(name))

    def order(self) -> Numbers:
        """Variables for another model like this one, once all goals are known.

        The counts of goals are adjacent to those of the requirement, because they are compared:
        with two long counts one after the other, the diagrams need a node for each value.
        """
        words = [*self._counters[self.requirement.id].words, *self._memory.words]
        return side_by_side(words, next(self._fresh))

    # Situations

    def goal(self, formula: Formula) -> Function:
        """A formula of the past, over a state and a valuation; all goals come before all searches.

        Raises:
            UnsupportedError: it looks ahead, or too far back.
        """
        return self._past.value(formula)

    def shortest(
        self, goal: Function, polarity: Polarity, kept: Ids, *, at_end: bool
    ) -> tuple[Letter, ...] | None:
        """A shortest run through the goal with the given polarity; None: there is none.

        Args:
            goal: a result of `goal`.
            at_end: whether only the last tick of the run counts for the goal.
            polarity: a satisfying run ends without an open obligation or, if impossible, where it
                may end; a violating run ends with the violation or, if impossible, after it, or
                where it may not end.
            kept: ids of the other requirements that it satisfies.

        Raises:
            OutOfTimeError: it takes too long.
        """
        words, _ = self._setting(kept, polarity is Polarity.KEPT)
        for endings in self._ends(kept, polarity):
            if at_end:
                endings, way = words.endings(endings.end & goal), bdd.true()
            else:
                way = goal
            letters = words.shortest(way, endings)
            if letters is not None:
                return letters
        return None

    def _endings(self, kept: Ids, polarity: Polarity) -> tuple[Endings, ...]:
        own = self._own
        words, lasts = self._setting(kept, polarity is Polarity.KEPT)
        ends: tuple[Function, ...]
        match polarity:
            case Polarity.KEPT:
                ends = (own.accepts - own.obligation_pending, own.accepts)
            case Polarity.BROKEN:
                ends = (own.breaks, own.broken, -own.accepts)
            case Polarity.UNKNOWN:
                raise AssertionError("`dependence` looks for those")
            case _:
                assert_never(polarity)
        return tuple(words.endings(end & lasts) for end in ends)

    # Two sentences side by side

    def difference(self, mutant: FormalizedRequirement, kept: Ids) -> tuple[Letter, ...] | None:
        """A shortest run that the requirement accepts and the mutant does not, or the reverse.

        None: there is none.

        Raises:
            UnsupportedError: the mutant has no counter.
            OutOfTimeError: it takes too long.
        """
        memory = Memory(self._fresh, dict(self._shared))
        judged, more = self._beside(mutant, self.alphabet, memory)
        words, lasts = self._built(kept, False, more)
        return words.shortest(
            bdd.true(), words.endings((self._own.accepts ^ judged.accepts) & lasts)
        )

    def dependence(
        self, goal: Function, atom: str, kept: Ids
    ) -> tuple[tuple[Letter, ...], int] | None:
        """A shortest run whose verdict depends on an atom at one tick of the goal, and that tick.

        The sentence is evaluated twice, the second time with the opposite value of the atom there.
        None: there is none.

        Args:
            goal: a result of `goal`.
            atom: an atom of the sentence.
            kept: ids of other requirements that the run satisfies, with the first value.

        Raises:
            OutOfTimeError: it takes too long.
        """
        here = bdd.variable(number := next(self._fresh))
        mirror = Fixed(self.alphabet)
        mirror.atom = lambda name: (
            self.alphabet.atom(name) ^ (here if name == atom else bdd.false())
        )
        memory = Memory(self._fresh, {})
        bit = memory.bit()
        was = bdd.variable(bit.now)
        memory.steps[bit] = was | here
        judged, more = self._beside(self.requirement, mirror, memory)
        once = -here | (goal - was)
        words, lasts = self._built(kept, False, more, letters=(number,), safe=once)
        ends = (self._own.accepts ^ judged.accepts) & (was | here) & lasts
        letters = words.shortest(bdd.true(), words.endings(ends))
        if letters is None:
            return None
        return letters, next(tick for tick, letter in enumerate(letters) if letter[number])

    def _beside(
        self, requirement: FormalizedRequirement, alphabet: Alphabet, memory: Memory
    ) -> tuple[StepResult, RequirementCounter]:
        """Signals of another sentence for a run, and its bits."""
        theirs = counter(requirement, alphabet, self._fresh, memory.shared)
        judged = self._judged(theirs, requirement, PastMemory(alphabet.atom, memory), memory)
        bits = _of_memory(memory)
        return judged, replace(bits, bits=bits.bits + theirs.bits, steps=bits.steps + theirs.steps)

    # Both

    def _judged(
        self,
        counter: RequirementCounter,
        requirement: FormalizedRequirement,
        past: PastMemory,
        memory: Memory,
    ) -> StepResult:
        bit = memory.bit()
        was = bdd.variable(bit.now)
        broken = was | -counter.safe
        memory.steps[bit] = broken
        accepts = -(broken | past.value(requirement.watch.violated_if_ended))
        return StepResult(
            broken - was, broken, accepts, past.value(requirement.watch.obligation_pending)
        )

    def _built(
        self,
        kept: Ids,
        with_rule: bool,
        *more: RequirementCounter,
        letters: tuple[int, ...] = (),
        safe: Function | None = None,
    ) -> tuple[RunSearch, Function]:
        """Runs that satisfy some counters, and the ticks after which this can last for ever."""
        runs, lasting = self._kept(kept, with_rule)
        counters = [self._counters[id] for id in (self.requirement.id, *kept)]
        memory = _of_memory(self._memory)
        transition = Transition([*counters, *self._always, memory, *more])
        safe = runs.safe if safe is None else runs.safe & safe
        every, quiet = (*self._letters, *letters), {*self._quiet, *letters}
        words = RunSearch(transition, every, quiet, safe, self.budget)
        return words, transition.moved(lasting)

    def _keeping(self, kept: Ids, with_rule: bool) -> tuple[SatisfyingRuns, Function]:
        """Runs that satisfy some counters, and the states from which this can last for ever."""
        ids = (*kept, self.requirement.id) if with_rule else kept
        counters = [*(self._counters[id] for id in ids), *self._always]
        runs = SatisfyingRuns(self.alphabet, counters, self.budget)
        return runs, runs.lasting()

    @property
    def uncertainty(self) -> str:
        """Why some valuations may be impossible; empty: all are possible."""
        return self.alphabet.uncertainties.get(Role.OUTPUT, "")


def demands(requirement: FormalizedRequirement) -> Obligation:
    """Demands of a requirement, as formulas of the past over valuations."""
    return obligation(requirement.sentence, requirement.ticks or 0, PastWords())


def _of_memory(memory: Memory) -> RequirementCounter:
    """The bits of a memory, as a counter that forbids nothing."""
    bits = tuple(dict.fromkeys(memory.bits))
    steps = tuple(memory.steps[bit] for bit in bits)
    yes = bdd.true()
    return RequirementCounter("", bits, steps, yes, None, (), yes, yes)
