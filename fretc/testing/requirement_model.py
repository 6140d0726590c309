"""A requirement under test among others: its counters, and shortest words of them.

All variables are chosen freely: a test is a run, not a play. The others are kept at every tick, and
so that they can be kept for ever after it; the requirement itself may be broken.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import assert_never

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import Obligation, obligation
from compiler.formalization.predicates import Past as PastWords
from compiler.logic import decision_diagrams as bdd
from compiler.logic.decision_diagrams import Function
from compiler.logic.formula import Formula, atoms
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.counters import counter
from fretc.analysis.arena.memory import Bit, Counter, Memory, Past, side_by_side
from fretc.analysis.arena.product import Fixed, near_each_other
from fretc.analysis.arena.transition import Transition
from fretc.analysis.arena.variables import Numbers, UnsupportedError, numbers
from fretc.analysis.games.runs import Runs
from fretc.analysis.realizability_problem import alphabet_of
from fretc.testing.search import Endings, Letter, Words
from fretc.testing.suite import Polarity
from fretish.bindings.declarations import Role

Ids = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Judgement:
    """What a sentence says of the run up to a tick, over a state and a letter."""

    breaks: Function
    """A demand is broken here, and none before."""
    broken: Function
    """A demand is broken, here or before."""
    accepts: Function
    """FRET's verdict, were the run to end here."""
    owes: Function
    """A demand is open, if none is broken."""


class RequirementModel:
    """One requirement, and those whose variables hang together with its own."""

    def __init__(
        self,
        requirement: FormalizedRequirement,
        others: Sequence[FormalizedRequirement],
        more: Iterable[FormalizedRequirement],
        budget: Budget,
        fresh: Numbers | None = None,
    ) -> None:
        """The bench.

        Args:
            requirement: the requirement under test.
            others: requirements and assumptions that its tests keep.
            more: sentences whose atoms belong to the letters, too.
            budget: for all searches.
            fresh: variables, where their order matters.

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
        """Why another requirement has no counter, by its id."""
        self._counters: dict[str, Counter] = {}
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
        self.others: Ids = tuple(each.id for each in others if each.id in self._counters)
        self._memory = Memory(self._fresh, self._shared)
        self._past = Past(self.alphabet.atom, self._memory)
        self._own = self._judged(
            self._counters[requirement.id], requirement, self._past, self._memory
        )
        self._setting = cache(self._built)
        self._kept = cache(self._keeping)
        self._ends = cache(self._endings)

    def _asked(self, requirement: FormalizedRequirement) -> Iterator[int]:
        """The variables of condition, response and stop condition."""
        whole = demands(requirement)
        for part in (whole.trigger, whole.demand.response, whole.demand.stop):
            for name in atoms(part):
                yield from bdd.support(self.alphabet.atom(name))

    def order(self) -> Numbers:
        """Variables for another bench like this one, once all goals are known.

        What goals count and what the requirement counts stand side by side: they are compared, and
        two long counts one after the other need as many nodes for that as they have values.
        """
        words = [*self._counters[self.requirement.id].words, *self._memory.words]
        return side_by_side(words, next(self._fresh))

    # Situations

    def goal(self, formula: Formula) -> Function:
        """A formula of the past, over a state and a letter; all goals come before all searches.

        Raises:
            UnsupportedError: it looks ahead, or too far back.
        """
        return self._past.value(formula)

    def shortest(
        self, goal: Function, polarity: Polarity, kept: Ids, *, at_end: bool
    ) -> tuple[Letter, ...] | None:
        """A shortest word by the goal that keeps or breaks the requirement; None: there is none.

        Args:
            goal: of `goal`.
            at_end: whether only the last tick of the word counts for the goal.
            polarity: a word that keeps it ends with nothing open, or, where that cannot be, where
                it may end; one that breaks it ends as it breaks it, or, where that cannot be, after
                that, or where it may not end.
            kept: ids of the others that it keeps.

        Raises:
            OutOfTimeError: it takes too long.
        """
        words, _ = self._setting(kept, polarity is Polarity.KEPT)
        for endings in self._ends(kept, polarity):
            if at_end:
                endings, way = words.endings(endings.end & goal), bdd.true()
            else:
                way = goal
            found = words.shortest(way, endings)
            if found is not None:
                return found
        return None

    def _endings(self, kept: Ids, polarity: Polarity) -> tuple[Endings, ...]:
        own = self._own
        words, lasts = self._setting(kept, polarity is Polarity.KEPT)
        ends: tuple[Function, ...]
        match polarity:
            case Polarity.KEPT:
                ends = (own.accepts - own.owes, own.accepts)
            case Polarity.BROKEN:
                ends = (own.breaks, own.broken, -own.accepts)
            case Polarity.UNKNOWN:
                raise AssertionError("`doubt_of` looks for those")
            case _:
                assert_never(polarity)
        return tuple(words.endings(end & lasts) for end in ends)

    # Two sentences side by side

    def difference(self, mutant: FormalizedRequirement, kept: Ids) -> tuple[Letter, ...] | None:
        """A shortest word that the requirement accepts and the mutant does not, or the reverse.

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

    def doubt_of(
        self, goal: Function, atom: str, kept: Ids
    ) -> tuple[tuple[Letter, ...], int] | None:
        """A shortest word whose verdict depends on an atom at one tick of the goal, and that tick.

        The sentence is judged twice, the second time with the opposite value of the atom there.
        None: there is none.

        Args:
            goal: of `goal`.
            atom: of the sentence.
            kept: ids of others that the word keeps, with the first value.

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
        found = words.shortest(bdd.true(), words.endings(ends))
        if found is None:
            return None
        return found, next(tick for tick, letter in enumerate(found) if letter[number])

    def _beside(
        self, requirement: FormalizedRequirement, alphabet: Alphabet, memory: Memory
    ) -> tuple[Judgement, Counter]:
        """What another sentence says of a run, and its bits."""
        theirs = counter(requirement, alphabet, self._fresh, memory.shared)
        judged = self._judged(theirs, requirement, Past(alphabet.atom, memory), memory)
        bits = _of_memory(memory)
        return judged, replace(bits, bits=bits.bits + theirs.bits, steps=bits.steps + theirs.steps)

    # Both

    def _judged(
        self, counter: Counter, requirement: FormalizedRequirement, past: Past, memory: Memory
    ) -> Judgement:
        bit = memory.bit()
        was = bdd.variable(bit.now)
        broken = was | -counter.safe
        memory.steps[bit] = broken
        accepts = -(broken | past.value(requirement.watch.fails))
        return Judgement(broken - was, broken, accepts, past.value(requirement.watch.owed))

    def _built(
        self,
        kept: Ids,
        with_rule: bool,
        *more: Counter,
        letters: tuple[int, ...] = (),
        safe: Function | None = None,
    ) -> tuple[Words, Function]:
        """The words that keep some counters, and the ticks after which these can last."""
        runs, lasting = self._kept(kept, with_rule)
        counters = [self._counters[id] for id in (self.requirement.id, *kept)]
        memory = _of_memory(self._memory)
        transition = Transition([*counters, *self._always, memory, *more])
        safe = runs.safe if safe is None else runs.safe & safe
        every, quiet = (*self._letters, *letters), {*self._quiet, *letters}
        words = Words(transition, every, quiet, safe, self.budget)
        return words, transition.moved(lasting)

    def _keeping(self, kept: Ids, with_rule: bool) -> tuple[Runs, Function]:
        """The runs that keep some counters, and the states from which they last for ever."""
        ids = (*kept, self.requirement.id) if with_rule else kept
        counters = [*(self._counters[id] for id in ids), *self._always]
        runs = Runs(self.alphabet, counters, self.budget)
        return runs, runs.lasting()

    @property
    def doubt(self) -> str:
        """Why letters may be more than there can be; empty: they are not."""
        return self.alphabet.doubts.get(Role.OUTPUT, "")


def demands(requirement: FormalizedRequirement) -> Obligation:
    """What a requirement demands, as formulas of the past over what letters tell."""
    return obligation(requirement.sentence, requirement.ticks or 0, PastWords())


def _of_memory(memory: Memory) -> Counter:
    """The bits of a memory, as a counter that forbids nothing."""
    bits = tuple(dict.fromkeys(memory.bits))
    steps = tuple(memory.steps[bit] for bit in bits)
    yes = bdd.true()
    return Counter("", bits, steps, yes, None, (), yes, yes)
