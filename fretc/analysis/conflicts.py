"""All minimal conflicts of a component."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import field
from dataclasses import replace as altered
from functools import cache, partial
from typing import TYPE_CHECKING

from compiler.files.records import replace
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.findings import Conflict, OpenQuestion
from fretc.analysis.games.cores import Members, cores, minimal
from fretc.analysis.games.game_traces import Counterstrategy, NoPlayError
from fretc.analysis.games.replay import broken
from fretc.analysis.games.switches import switched
from fretc.analysis.games.unrolled_runs import LONGEST, NoShortRun
from fretc.analysis.realizability_problem import RealizabilityProblem, stage
from fretc.analysis.reasons import because, listed
from fretc.analysis.verdicts import (
    WHATEVER,
    check_assumptions,
    has_room,
    is_lost,
    lassos,
    lost_parts,
)
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass

if TYPE_CHECKING:
    from fretc.analysis.games.lassos import Lassos


@dataclass(frozen=True, slots=True)
class Completeness:
    """All minimal conflicts among these requirements were found."""

    requirements: tuple[str, ...]


def conflicts(
    setting: RealizabilityProblem, budget: Budget
) -> Iterator[Conflict | Completeness | OpenQuestion]:
    """Every minimal conflict; at the end an open question if there may be more.

    With unknown values, a conflict is certain if the environment wins for all of them; it is
    certainly minimal if the environment does not win with fewer requirements even when favoured. If
    neither is certain, more about numbers is stored. Requirements without inputs are unrolled.
    """
    question = (
        "which others of "
        f"{', '.join(requirement.id for requirement in setting.requirements)} conflict"
    )
    earlier: set[tuple[str, ...]] = set()
    fights, whole = _Fights(setting, lambda: setting), budget
    try:
        check_assumptions(setting, budget)
        exact = lassos(setting)
        if exact is not None and setting.left_out:
            budget = Budget(budget.left / 2)  # The rest is for parts with those left out.
        there: RealizabilityProblem | None = setting
        while there is not None:
            fights = _Fights(there, cache(partial(there.generous, budget)), exact)
            for core in fights.minimal(budget):
                if core not in earlier:
                    earlier.add(core)
                    yield fights.conflict(core, budget)
            there = there.finer(budget) if fights.is_open and has_room(budget) else None
        for core in fights.larger:
            yield _perhaps_larger(fights.conflict(core, budget))
    except OutOfTimeError:
        for core in fights.larger:
            yield _perhaps_larger(Conflict(core, (), "the environment wins"))
        if budget is not whole:
            yield from _of_parts(setting, earlier, fights.unrolled, whole)
        yield OpenQuestion(question, f"{whole.over}{_hint(setting, whole.again())}")
        return
    except UnsupportedError as error:
        yield OpenQuestion(question, str(error))
        return
    if (uncertainty := fights.uncertainty) is None:
        yield Completeness(tuple(requirement.id for requirement in setting.requirements))
    else:
        yield from _of_parts(setting, earlier, fights.unrolled, whole)
        yield OpenQuestion(question, uncertainty)


def _of_parts(
    setting: RealizabilityProblem,
    earlier: Collection[tuple[str, ...]],
    unrolled: Collection[str],
    budget: Budget,
) -> Iterator[Conflict]:
    """Minimal conflicts of some of the requirements, except those that are known.

    A minimal conflict of a part is one of the component, because all its subsets are in the part.
    """
    known = [frozenset(each) for each in earlier]
    parts = (part for part in setting.parts if not {each.id for each in part} <= {*unrolled})
    try:
        for part in lost_parts(setting, parts, budget):
            fights = _Fights(part, cache(partial(part.generous, budget)))
            for core in fights.minimal(budget):
                if not any(each <= frozenset(core) for each in known):
                    known.append(frozenset(core))
                    yield fights.conflict(core, budget)
    except (UnsupportedError, OutOfTimeError):
        return


def _perhaps_larger(conflict: Conflict) -> Conflict:
    return replace(conflict, because=f"{conflict.because}; perhaps fewer of them conflict already")


@dataclass(slots=True)
class _Fights:
    """Minimal conflicts of a problem, as far as unknown values permit."""

    strict: RealizabilityProblem
    """Problem with the environment favoured."""
    generous: Callable[[], RealizabilityProblem]
    """Problem with the system favoured, which is built when it is first needed."""
    exact: Lassos | None = None
    """Answers about requirements without inputs."""
    larger: list[tuple[str, ...]] = field(default_factory=list)
    """Conflicts that may not be minimal."""
    smaller: list[tuple[str, ...]] = field(default_factory=list)
    """Sets that may be conflicts."""

    @property
    def is_open(self) -> bool:
        """Whether more could be decided about them."""
        return bool(self.larger or self.smaller)

    def minimal(self, budget: Budget) -> Iterator[tuple[str, ...]]:
        """Conflicts that are certainly minimal; then all others are known, too."""
        ids = self._decidable(self.generous, Role.INPUT)
        for core in self._cores(self.generous, ids, self._is_conflict, budget):
            if self._is_minimal(core, budget):
                yield core
            else:
                self.larger.append(core)
        if self.exact is not None or self.generous() is not self.strict:
            both = {*ids}.intersection(self._decidable(lambda: self.strict, Role.OUTPUT))
            kept = [id for id in ids if id in both]
            for core in self._cores(lambda: self.strict, kept, self._may_conflict, budget):
                if not self._is_conflict(core, budget):
                    self.smaller.append(core)

    def _is_minimal(self, core: Sequence[str], budget: Budget) -> bool:
        """Whether fewer of the requirements of a conflict certainly do not conflict."""
        if self.exact is not None and self.exact.are_complete and self._is_about(core):
            return True  # Each smaller set has an exact answer.
        sure = (self.strict.certain(role) for role in (Role.INPUT, Role.OUTPUT))
        if self.exact is None and all({each.id for each in some}.issuperset(core) for some in sure):
            return True
        fewer = [[id for id in core if id != other] for other in core]
        return not any(self._may_conflict(each, budget) for each in fewer if each)

    def _decidable(self, there: Callable[[], RealizabilityProblem], role: Role) -> list[str]:
        """Ids of requirements that a game decides, or that are unrolled."""
        counted = {each.id for each in self.strict.arena.counters}
        known = set(self.unrolled)
        if not known.issuperset(counted):
            known |= {each.id for each in there().certain(role)}
        return [each.id for each in self.strict.requirements if each.id in known]

    @property
    def unrolled(self) -> frozenset[str]:
        """Ids of requirements with exact answers."""
        return frozenset() if self.exact is None else self.exact.unrolled.known

    def _is_conflict(self, ids: Sequence[str], budget: Budget) -> bool:
        """Whether the environment certainly wins against some requirements."""
        answer = self._at_once(ids, budget)
        if answer is None:
            answer = is_lost(self.generous(), ids, budget) or self._answer(ids, budget)
        return bool(answer)

    def _may_conflict(self, ids: Sequence[str], budget: Budget) -> bool:
        """Whether the environment perhaps wins against some requirements."""
        answer = self._at_once(ids, budget)
        if answer is None:
            is_exact = {each.id for each in self.strict.certain(Role.OUTPUT)}.issuperset(ids)
            if is_exact and not is_lost(self.strict, ids, budget):
                return False
            answer = self._answer(ids, budget)
        return answer is not False

    def _is_about(self, ids: Sequence[str]) -> bool:
        """Whether all of these requirements are unrolled."""
        return self.unrolled.issuperset(ids)

    def _at_once(self, ids: Sequence[str], budget: Budget) -> bool | None:
        """`_answer` by short runs if an obligation may stay open, so that no run shows it."""
        waits = self.exact is not None and not self.exact.unrolled.waiting.isdisjoint(ids)
        return self._answer(ids, budget, _SHORT_RUN if waits else LONGEST)

    def _answer(self, ids: Sequence[str], budget: Budget, longest: int = LONGEST) -> bool | None:
        """Whether requirements without inputs conflict; None: unknown, or they have inputs."""
        if self.exact is None or not self._is_about(ids):
            return None
        answer = self.exact.answer(ids, budget, longest)
        return None if answer is None else isinstance(answer, NoShortRun)

    def _core(self, ids: Sequence[str], budget: Budget) -> Collection[str]:
        """Some of the ids of a conflict that conflict by themselves."""
        answer = None if self.exact is None else self.exact.answer(ids, budget)
        return answer.of if isinstance(answer, NoShortRun) else ids

    def _cores(
        self,
        game: Callable[[], RealizabilityProblem],
        ids: Sequence[str],
        holds: Callable[[Sequence[str], Budget], bool],
        budget: Budget,
    ) -> Iterator[tuple[str, ...]]:
        """Minimal sets of some requirements for which a monotone property holds."""
        read = {each.id: frozenset(each.variables) for each in self.strict.requirements}

        def chosen(members: Members) -> tuple[str, ...]:
            return tuple(ids[i] for i in sorted(members))

        def near(i: int, j: int) -> bool:
            return self.exact is None and bool(read[ids[i]] & read[ids[j]])

        def smaller(members: Members) -> Members:
            core = self._core(chosen(members), budget)
            return frozenset(i for i in members if ids[i] in core)

        if self.exact is None and game().arena.alphabet.memory() is None:
            there = game()
            at_once = switched(there.game(there.counters(ids), budget), there.fresh)
            if at_once is not None:
                return map(chosen, at_once.cores(budget))
        sets = cores(len(ids), lambda some: holds(chosen(some), budget), near, smaller)
        return map(chosen, sets)

    def conflict(self, ids: Sequence[str], budget: Budget) -> Conflict:
        """A conflict with its play."""
        if self.exact is not None and self._answer(ids, budget):
            return _unrolled_conflict(self.exact, self.strict, ids, budget)
        known = {each.id for each in self.strict.certain(Role.INPUT)}
        there = self.strict if known.issuperset(ids) else self.generous()
        return _conflict(there, ids, budget)

    @property
    def uncertainty(self) -> str | None:
        """Why there may be more conflicts; None: there are no others."""
        every = [requirement.id for requirement in self.strict.requirements]
        if self.exact is not None and self._is_about(every):
            uncertainty = None
        else:
            strict, generous = self.strict, self.generous()
            uncertainty = strict.left_out or generous.left_out
            uncertainty = uncertainty or generous.of_inputs or strict.of_outputs
        if uncertainty is None and self.smaller:
            which = "; ".join(map(listed, self.smaller))
            why = self.strict.left_out or self.strict.of_inputs or self.strict.of_outputs
            return f"{why}; that decides whether these can be satisfied: {which}"
        return uncertainty


def _unrolled_conflict(
    exact: Lassos, setting: RealizabilityProblem, members: Sequence[str], budget: Budget
) -> Conflict:
    """A minimal conflict of requirements without inputs, with a run that satisfies them longest."""
    ids = sorted(members)
    outcome = exact.play(ids, budget)
    if outcome is None:
        return Conflict(tuple(ids), (), "no run satisfies all of them")
    game, play, ticks = outcome
    requirements = [each for each in setting.requirements if each.id in ids]
    lost = broken(requirements, game.alphabet, play, as_fret=setting.as_fret)
    assert lost, f"the play of {', '.join(ids)} breaks none of them"
    why = because(requirements, game.counters, game, play)
    names = {name for each in requirements for name in (*each.variables, *each.propositions)}
    values = tuple({name: tick[name] for name in sorted(names & tick.keys())} for tick in ticks)
    return Conflict(tuple(ids), values, why)


_SHORT_RUN = 8
"""Number of ticks of runs that are searched before the games are solved."""
_SHORT = 200
"""Ticks of the longest duration after scaling."""


def _hint(setting: RealizabilityProblem, budget: Budget) -> str:
    """Conflict with all durations scaled down: a hint, not a finding."""
    longest = max((requirement.ticks or 0 for requirement in setting.requirements), default=0)
    factor = -(-longest // _SHORT)
    if factor < 2:
        return ""
    requirements, assumptions = (
        [
            altered(
                requirement,
                ticks=-(-requirement.ticks // factor) if requirement.ticks else requirement.ticks,
            )
            for requirement in some
        ]
        for some in (setting.requirements, setting.assumptions)
    )
    scaled = stage(requirements, assumptions, setting.roles, as_fret=setting.as_fret)
    every = [counter.id for counter in scaled.arena.counters]

    def fights(ids: Sequence[str]) -> bool:
        return is_lost(scaled, ids, budget)

    try:
        if not fights(every):
            return ""
        return (
            f"; with all durations divided by {factor}, {listed(minimal(every, fights))} conflict"
        )
    except OutOfTimeError:
        return ""


_LONGEST = 200_000
"""Maximum number of ticks of a trace in the output."""


def _conflict(whole: RealizabilityProblem, members: Sequence[str], budget: Budget) -> Conflict:
    """A minimal conflict, with a trace that the formulas of its monitors confirm."""
    ids, setting = sorted(members), whole.close(members, budget)
    counters = setting.counters(ids)
    game = setting.game(counters, budget)
    try:
        play = Counterstrategy(game, game.solution(traps=True), budget).play()
    except (NoPlayError, OutOfTimeError) as error:
        return Conflict(tuple(ids), (), f"the environment wins, by a run that is {error}")
    requirements = [requirement for requirement in setting.requirements if requirement.id in ids]
    alphabet = setting.arena.alphabet
    lost = broken(requirements, alphabet, play, as_fret=setting.as_fret)
    assert lost, f"the play of {', '.join(ids)} breaks none of them"
    assert not broken(setting.assumptions, alphabet, play), "the environment keeps its word"
    why = because(requirements, counters, game, play)
    if not setting.computes(ids):
        return Conflict(tuple(ids), (), f"{why}, {WHATEVER}")
    if play.ticks > _LONGEST:
        return Conflict(tuple(ids), (), why)
    return Conflict(tuple(ids), setting.ticks(ids, play.runs, play.numbers), why, play.loop)
