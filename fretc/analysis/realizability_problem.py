"""The realizability problem of some requirements: their arena, and the limits of its answers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field, replace
from itertools import chain, repeat

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import all_comparisons
from compiler.formalization.resolution import candidates
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Alphabet, Tick
from fretc.analysis.arena.budget import ENDLESS, Budget
from fretc.analysis.arena.counters import counter
from fretc.analysis.arena.memory import RequirementCounter, side_by_side
from fretc.analysis.arena.product import Arena, arena
from fretc.analysis.arena.propositions import Propositions
from fretc.analysis.arena.roles import Roles, missing_role
from fretc.analysis.arena.variables import Numbers, UnsupportedError, numbers
from fretc.analysis.components import about, parts, tokens
from fretc.analysis.games.game import Game, upheld
from fretc.analysis.games.game_traces import Run
from fretc.analysis.games.replay import remembering
from fretc.analysis.games.runs import SatisfyingRuns
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass

_FEW = 5
"""Number of requirements and assumptions up to which they are examined by themselves."""
_LONG = 10
"""Number of bits of a count that is worth interleaving."""


@dataclass(frozen=True, slots=True)
class RealizabilityProblem:
    """Some requirements, the assumptions that concern them, and the arena of both."""

    requirements: tuple[FormalizedRequirement, ...]
    assumptions: tuple[FormalizedRequirement, ...]
    arena: Arena
    roles: Roles
    as_fret: bool
    favoured: Role = Role.INPUT
    """Player who chooses unknown values: a number of the previous tick, whether a signal is
    unknown, values before the first tick. A favoured player who loses certainly loses."""
    steps: int = 0
    """Number of ticks before a bound for which its reachability is stored."""
    fresh: Numbers = field(default_factory=numbers, compare=False, repr=False)
    """Variables that the problem does not use."""
    _close: dict[frozenset[str], RealizabilityProblem] = field(
        default_factory=dict, compare=False, repr=False
    )
    _upheld: list[Function] = field(default_factory=list, compare=False, repr=False)
    """Computed facts about the assumptions that each game of the problem needs."""

    def counters(self, ids: Iterable[str]) -> tuple[RequirementCounter, ...]:
        """Counters of some requirements, in the order of the files."""
        wanted = set(ids)
        return tuple(each for each in self.arena.counters if each.id in wanted)

    def close(self, ids: Iterable[str], budget: Budget) -> RealizabilityProblem:
        """The problem in which some of the requirements are best examined.

        That is a problem of their own if their counts are long; but the stored facts about numbers
        depend on all requirements, and then it is this problem.

        Raises:
            OutOfTimeError: solving their comparisons takes longer than the budget.
        """
        wanted = frozenset(ids)
        members = (*self.counters(wanted), *self.arena.assumptions)
        long = [member for member in members if member.longest >= _LONG]
        remembers = bool(self._memory) or self.arena.alphabet.is_refinable
        if len(members) > _FEW or len(long) < 2 or remembers:
            return self
        if wanted not in self._close:
            self._close[wanted] = self._apart(wanted, budget)
        return self._close[wanted]

    def _apart(self, ids: frozenset[str], budget: Budget) -> RealizabilityProblem:
        """A problem of some of the requirements; this problem, if the other one is less exact."""
        try:
            problem = interleaved(self, ids, budget)
        except UnsupportedError:
            return self
        counted = [{each.id for each in there.counters(ids)} for there in (self, problem)]
        mine, its = self.arena.alphabet, problem.arena.alphabet
        is_known = all(
            its.uncertain_atoms(role) <= mine.uncertain_atoms(role)
            for role in (Role.INPUT, Role.OUTPUT)
        )
        return problem if is_known and counted[0] == counted[1] else self

    def game(self, counters: Sequence[RequirementCounter], budget: Budget) -> Game:
        """The game of some counters, under all assumptions."""
        kept, assumptions = [*counters], [*self.arena.assumptions]
        (kept if self.favoured is Role.OUTPUT else assumptions).extend(self._memory)
        if not self._upheld:
            self._upheld.append(upheld(self.arena.alphabet, assumptions, budget))
        return Game(self.arena.alphabet, kept, assumptions, budget, self._upheld[0])

    @property
    def _memory(self) -> tuple[RequirementCounter, ...]:
        memory = self.arena.alphabet.memory()
        return () if memory is None else (memory,)

    def generous(self, budget: Budget) -> RealizabilityProblem:
        """The problem with the system favoured: unrealizable there is certainly unrealizable."""
        if self.arena.alphabet.open is None:
            return self
        return _built(
            self.requirements,
            self.assumptions,
            self.roles,
            numbers(),
            budget,
            as_fret=self.as_fret,
            favoured=Role.OUTPUT,
            steps=self.steps,
        )

    def assuming(self, more: Sequence[FormalizedRequirement]) -> RealizabilityProblem:
        """The problem under further assumptions, whose bits come last in the variable order.

        Raises:
            UnsupportedError: the problem has no atoms for them.
        """
        alphabet, found = self.arena.alphabet, list(self.arena.assumptions)
        for requirement in more:
            made = counter(requirement, alphabet, self.fresh, {})
            known = {*alphabet.inputs, *alphabet.outputs, *(bit.now for bit in made.bits)}
            read = (bdd.support(each) for each in (made.safe, made.triggered, *made.steps))
            if not known.issuperset(chain.from_iterable(read)):
                raise UnsupportedError(f"{requirement.id} is about other atoms")
            found.append(made)
        arena = replace(self.arena, assumptions=tuple(found))
        return replace(
            self, assumptions=(*self.assumptions, *more), arena=arena, _close={}, _upheld=[]
        )

    def finer(self, budget: Budget) -> RealizabilityProblem | None:
        """The problem with twice as many stored ticks of numbers; None: no more precise."""
        if not self.arena.alphabet.is_refinable or self.steps >= _MOST_STEPS:
            return None
        steps, near = 2 * self.steps or 1, self.assumptions
        problem = _built(
            self.requirements,
            near,
            self.roles,
            numbers(),
            budget,
            as_fret=self.as_fret,
            steps=steps,
        )
        if (problem.left_out, problem.of_outputs) != (self.left_out, self.of_outputs):
            return None  # Solving more than that takes too long.
        return None if problem.arena.size == self.arena.size else problem

    def runs(
        self,
        kept: Sequence[RequirementCounter],
        budget: Budget,
        watched: Sequence[RequirementCounter] = (),
        *,
        certain: bool = False,
    ) -> SatisfyingRuns:
        """Runs that satisfy some counters, and all assumptions."""
        counters = [*kept, *self.arena.assumptions, *self._memory]
        return SatisfyingRuns(self.arena.alphabet, counters, budget, watched, certain=certain)

    def ticks(
        self, ids: Iterable[str], runs: Iterable[Run], numbers: Sequence[Tick] = ()
    ) -> tuple[Tick, ...]:
        """Valuations as values of the variables of some requirements and of the assumptions.

        Args:
            ids: ids of the requirements.
            runs: valuations from the first tick on.
            numbers: numbers of each tick, if they depend on earlier numbers.
        """
        wanted = set(ids)
        requirements = [
            *(requirement for requirement in self.requirements if requirement.id in wanted),
            *self.assumptions,
        ]
        names = {
            name
            for requirement in requirements
            for name in (*requirement.variables, *requirement.propositions)
        }

        def shown(tick: Tick) -> Tick:
            return {name: tick[name] for name in sorted(tick) if name in names}

        alphabet = self.arena.alphabet
        ticks = chain.from_iterable(
            repeat(shown(alphabet.values(letter)), count)
            for letter, count in remembering(alphabet, runs)
        )
        if not numbers:
            return tuple(ticks)
        return tuple(shown(tick | more) for tick, more in zip(ticks, numbers, strict=True))

    def certain(self, role: Role) -> tuple[RequirementCounter, ...]:
        """Counters of requirements for which a player has only possible valuations."""
        uncertain = self.arena.alphabet.uncertain_atoms(role)
        if any(not uncertain.isdisjoint(_atoms(requirement)) for requirement in self.assumptions):
            return ()
        return self.counters(
            requirement.id
            for requirement in self.requirements
            if uncertain.isdisjoint(_atoms(requirement))
        )

    def computes(self, ids: Iterable[str]) -> bool:
        """Whether numbers satisfy the atoms of some requirements and of the assumptions."""
        wanted, unknown = set(ids), self.arena.alphabet.not_computed
        near = [each for each in self.requirements if each.id in wanted]
        return all(unknown.isdisjoint(_atoms(each)) for each in (*near, *self.assumptions))

    @property
    def parts(self) -> Iterator[tuple[FormalizedRequirement, ...]]:
        """Some of the requirements that may be decided where the whole problem is not."""
        alphabet = self.arena.alphabet
        atoms = alphabet.uncertain_atoms(Role.INPUT) | alphabet.uncertain_atoms(Role.OUTPUT)
        uncertain = [each.id for each in self.requirements if not atoms.isdisjoint(_atoms(each))]
        return parts(self.requirements, self.arena.beyond, uncertain, self.roles)

    def part(
        self, requirements: Sequence[FormalizedRequirement], budget: Budget
    ) -> RealizabilityProblem:
        """The problem of some of the requirements, with an alphabet of their own.

        It keeps the assumptions that concern them, and those that the system can affect: it may
        win by outputs after which the environment cannot keep them.

        Raises:
            UnsupportedError: an assumption has no counter.
            OutOfTimeError: solving their comparisons takes longer than the budget.
        """
        near = about(requirements, self.assumptions, self.roles)
        kept = [
            each
            for each in self.assumptions
            if each in near or tokens(each, self.roles, Role.OUTPUT)
        ]
        return _built(requirements, kept, self.roles, numbers(), budget, as_fret=self.as_fret)

    @property
    def of_inputs(self) -> str | None:
        """Why the environment has valuations that may be impossible; None: it has none."""
        return self.arena.alphabet.uncertainties.get(Role.INPUT)

    @property
    def of_outputs(self) -> str | None:
        """Why the system has valuations that may be impossible; None: it has none."""
        return self.arena.alphabet.uncertainties.get(Role.OUTPUT)

    @property
    def left_out(self) -> str | None:
        """Which requirements have no counter, and why; None: each has one."""
        return "; ".join(f"{id}: {why}" for id, why in self.arena.beyond.items()) or None


def _atoms(requirement: FormalizedRequirement) -> frozenset[str]:
    return frozenset(name for name, _ in candidates(requirement.sentence))


def stage(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    roles: Roles,
    *,
    as_fret: bool = False,
    budget: Budget = ENDLESS,
) -> RealizabilityProblem:
    """The realizability problem of some requirements.

    Raises:
        UnsupportedError: an assumption has no counter.
        OutOfTimeError: solving their comparisons takes longer than the budget.
    """
    near = about(requirements, assumptions, roles)
    return _built(requirements, near, roles, numbers(), budget, as_fret=as_fret)


def interleaved(
    setting: RealizabilityProblem, ids: Iterable[str], budget: Budget
) -> RealizabilityProblem:
    """The problem of a few requirements, with bits of equal weight adjacent.

    So counts are easy to compare; with counters one after the other, the diagrams need a node for
    each value of a count. For many requirements this order is worse.
    """
    wanted = set(ids)
    requirements = [requirement for requirement in setting.requirements if requirement.id in wanted]
    near = about(requirements, setting.assumptions, setting.roles)

    def built(fresh: Numbers) -> RealizabilityProblem:
        return _built(
            requirements,
            near,
            setting.roles,
            fresh,
            budget,
            as_fret=setting.as_fret,
            favoured=setting.favoured,
            steps=setting.steps,
        )

    used = numbers()
    first = built(used)
    counters = (*first.arena.counters, *first.arena.assumptions)
    fresh = side_by_side([word for each in counters for word in each.words], next(used))
    return built(fresh)


def _built(
    requirements: Sequence[FormalizedRequirement],
    near: Sequence[FormalizedRequirement],
    roles: Roles,
    fresh: Numbers,
    budget: Budget,
    *,
    as_fret: bool,
    favoured: Role = Role.INPUT,
    steps: int = 0,
) -> RealizabilityProblem:
    beyond = {
        requirement.id: f"`{missing}` has no single role"
        for requirement in requirements
        if (missing := missing_role(requirement, roles)) is not None
    }
    for assumption in near:
        if (missing := missing_role(assumption, roles)) is not None:
            raise UnsupportedError(f"of the assumption {assumption.id}: `{missing}` has no role")
    counted = [requirement for requirement in requirements if requirement.id not in beyond]
    every = [*counted, *near]
    alphabet = alphabet_of(every, roles, fresh, favoured, budget, steps, functions=True)
    built = arena(counted, near, alphabet, fresh, as_fret=as_fret, beyond=beyond)
    return RealizabilityProblem(
        tuple(requirements), tuple(near), built, roles, as_fret, favoured, steps, fresh
    )


def _has_numbers(requirement: FormalizedRequirement) -> bool:
    """Whether an atom of the requirement compares numbers."""
    declared = requirement.declarations
    if declared is None:
        return bool(all_comparisons(requirement))
    return bool(requirement.stated) or not declared.propositions.keys().isdisjoint(
        requirement.variables
    )


_MOST_STEPS = 8
"""Maximum of `steps`; beyond it, solving a group takes longer than a question may."""


def alphabet_of(
    requirements: Sequence[FormalizedRequirement],
    roles: Roles,
    fresh: Numbers,
    favoured: Role,
    budget: Budget = ENDLESS,
    steps: int = 0,
    *,
    of_moments: bool = False,
    functions: bool = False,
) -> Alphabet:
    """The alphabet of some requirements; with numbers, z3 is imported.

    Args:
        requirements: requirements with the atoms.
        roles: roles of their variables.
        fresh: variables for bits.
        favoured: player who chooses unknown values.
        budget: time limit for solving comparisons.
        steps: number of ticks before a bound for which its reachability is stored.
        of_moments: whether propositions over several samples are treated as free.
        functions: whether a term over inputs that is not linear may have any value.
    """
    if not any(map(_has_numbers, requirements)):
        return Propositions(requirements, roles, fresh)
    from fretc.analysis.arithmetic.alphabet import Cells

    return Cells(
        requirements,
        roles,
        fresh,
        favoured,
        budget,
        steps,
        of_moments=of_moments,
        functions=functions,
    )
