"""Exact answers about requirements without inputs, by runs that return to an earlier state.

Each run that is found is checked: comparisons are recomputed from its numbers, and the formulas of
the monitors judge it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.diagrams import decision_diagrams as bdd
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.product import Fixed
from fretc.analysis.arena.roles import Roles
from fretc.analysis.games.game import Game, Letter
from fretc.analysis.games.game_traces import GameTrace
from fretc.analysis.games.replay import ROUNDS, kept
from fretc.analysis.games.unrolled_runs import LONGEST, NoShortRun, SatisfyingRun
from fretc.analysis.games.unrolling import UnrolledRequirements


class Lassos:
    """Answers about any of some requirements; what is known from earlier answers is kept."""

    def __init__(
        self,
        requirements: Sequence[FormalizedRequirement],
        roles: Roles,
        *,
        as_fret: bool = False,
    ) -> None:
        """No answer yet.

        Args:
            requirements: the requirements.
            roles: roles of their variables, none of them an input.
            as_fret: whether no obligation may be open at the end of any tick.
        """
        self._requirements, self._as_fret = requirements, as_fret
        self.unrolled = UnrolledRequirements(requirements, roles, as_fret=as_fret)
        self._runs: dict[frozenset[str], SatisfyingRun] = {}
        self._conflicts: list[NoShortRun] = []
        self._open: set[frozenset[str]] = set()

    @property
    def are_complete(self) -> bool:
        """Whether each question so far has an answer."""
        return not self._open

    def answer(
        self, ids: Sequence[str], budget: Budget, longest: int = LONGEST
    ) -> SatisfyingRun | NoShortRun | None:
        """An endless run that satisfies some requirements, or proof that there is none.

        Args:
            ids: their ids.
            budget: time limit.
            longest: number of ticks up to which runs are searched, or more if they are known.

        Returns:
            None: unknown; also if one of the requirements has no exact answer.

        Raises:
            OutOfTimeError: the budget is exceeded.
        """
        wanted = frozenset(ids)
        if not wanted <= self.unrolled.known or wanted in self._open:
            return None
        for conflict in self._conflicts:
            if conflict.of <= wanted:
                return conflict
        for satisfied, run in self._runs.items():
            if wanted <= satisfied:
                return run
        result = self._searched(wanted, budget, longest)
        if isinstance(result, NoShortRun):
            self._conflicts.append(result)
        elif result is not None:
            self._runs[wanted] = result
        elif longest == LONGEST:
            self._open.add(wanted)
        return result

    def _searched(
        self, ids: frozenset[str], budget: Budget, longest: int
    ) -> SatisfyingRun | NoShortRun | None:
        wanted = sorted(ids)
        if not self.unrolled.length:
            self.unrolled.grow()
        while True:
            budget.check()
            result = self.unrolled.shortest(wanted, budget)
            if result is not None:
                return result
            run = self.unrolled.lasso(wanted, budget)
            if run is not None:
                return run if self._is_kept(run, ids) else None
            if self.unrolled.length >= longest:
                return None
            self.unrolled.grow()

    def _is_kept(self, run: SatisfyingRun, ids: frozenset[str]) -> bool:
        """Whether the monitors confirm the run, with its loop repeated."""
        assert run.loop is not None
        some = [each for each in self._requirements if each.id in ids]
        tail = len(run.numbers) - run.loop
        alphabet = self.unrolled.alphabet
        letters, waiting = self.letters(run), self.unrolled.waiting
        return kept(some, alphabet, letters, tail, waiting, as_fret=self._as_fret)

    def play(
        self, ids: Sequence[str], budget: Budget
    ) -> tuple[Game, GameTrace, tuple[Tick, ...]] | None:
        """A run in which some requirements conflict as late as possible, and its values.

        Args:
            ids: ids of a conflict.
            budget: time limit.
        """
        conflict = self.answer(ids, budget)
        assert isinstance(conflict, NoShortRun)
        run = self.unrolled.longest(ids, conflict.ticks, budget)
        if run is None:
            return None
        alphabet = self.unrolled.alphabet
        game = Game(Fixed(alphabet), self.unrolled.counters(ids), (), budget)
        state, letters = game.transition.start, self.letters(run)
        for letter in letters[:-1]:
            state = game.transition.next(bdd.point({**state, **letter}))
        play = GameTrace(tuple((letter, 1) for letter in letters), None, state)
        return game, play, tuple(map(self.unrolled.values, run.numbers, letters))

    def letters(self, run: SatisfyingRun) -> tuple[Letter, ...]:
        """Valuations of a run, with its loop repeated."""
        length = len(run.numbers)
        again = [] if run.loop is None else [*range(run.loop, length)] * (ROUNDS - 1)
        ticks = [*range(length), *again]
        unrolled = self.unrolled
        first = unrolled.letter(run, 0, None)
        return (first, *(unrolled.letter(run, now, last) for last, now in pairwise(ticks)))


def lasso(
    requirements: Sequence[FormalizedRequirement],
    roles: Roles,
    budget: Budget,
    *,
    as_fret: bool = False,
) -> SatisfyingRun | NoShortRun | None:
    """An endless run that satisfies all requirements, or proof that there is none; None: unknown.

    Args:
        requirements: the requirements; without a counter or certain valuations, the answer is None.
        roles: roles of their variables, none of them an input.
        budget: time limit for the search.
        as_fret: whether no obligation may be open at the end of any tick.
    """
    ids = [requirement.id for requirement in requirements]
    try:
        return Lassos(requirements, roles, as_fret=as_fret).answer(ids, Budget(budget.left / 2))
    except OutOfTimeError:
        return None
