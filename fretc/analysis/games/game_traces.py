"""Traces of a game, tick by tick: how the environment wins."""

from __future__ import annotations

from collections.abc import Callable

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.transition import State
from fretc.analysis.games.game import Game, Letter, Solution, Trap, whole
from fretc.analysis.games.squaring import RelationTooLargeError, TransitionRelation
from fretish.classes.frozen import dataclass

Run = tuple[Letter, int]
"""A valuation, and its number of ticks."""


@dataclass(frozen=True, slots=True)
class GameTrace:
    """Valuations, tick by tick."""

    runs: tuple[Run, ...]
    loop: int | None
    """Tick at which the repeated part begins; None: the last tick is a violation."""
    state: State
    """State before the last tick."""
    numbers: tuple[Tick, ...] = ()
    """Numbers of each tick, if they depend on earlier numbers."""

    @property
    def ticks(self) -> int:
        """Number of ticks, up to the violation or the end of the loop."""
        return sum(count for _, count in self.runs)

    @property
    def letters(self) -> tuple[Letter, ...]:
        """The valuation of each tick."""
        return tuple(letter for letter, count in self.runs for _ in range(count))

    def repeated(self, rounds: int) -> tuple[Run, ...]:
        """The runs, with the loop repeated."""
        if self.loop is None:
            return self.runs
        again: list[Run] = []
        end = 0
        for letter, count in self.runs:
            end += count
            if end > self.loop:
                again.append((letter, min(count, end - self.loop)))
        return (*self.runs, *again * (rounds - 1))


class NoPlayError(Exception):
    """The environment wins, but no trace shows it; the message gives the reason."""


_MOST_NUMBERS = 500
"""Maximum number of ticks in which the numbers of a loop must recur."""


class Counterstrategy:
    """Strategy of the environment in a game that the system cannot win.

    The system resists as long as possible, so that the trace shows why it must lose.
    """

    def __init__(self, game: Game, solution: Solution, budget: Budget) -> None:
        assert not solution.is_realizable
        self._game, self._traps, self._budget = game, solution.traps, budget
        self._course = game.alphabet.course(budget)

    def play(self) -> GameTrace:
        """A trace from the initial state to a violation, or to a loop without a required event.

        Raises:
            OutOfTimeError: it has too many ticks.
            NoPlayError: its numbers do not recur.
        """
        state: State = self._game.transition.start
        promise, trap = 0, len(self._traps) - 1
        runs = _Runs()
        seen: dict[tuple[object, ...], int] = {}
        before = state
        while True:
            self._budget.check()
            key = (promise, *state.values(), *(self._course.last if self._course else ()))
            if key in seen:
                return GameTrace(runs.all, seen[key], before, self._numbers)
            seen[key] = runs.ticks
            if self._course is not None and runs.ticks > _MOST_NUMBERS:
                raise NoPlayError(
                    f"not shown: its numbers do not come back in {_MOST_NUMBERS} ticks"
                )
            trap = self._number(bdd.point(state), trap)
            inputs = self._inputs(state, promise, self._traps[trap])
            options = self._options(state, inputs)
            if options == bdd.false():
                runs.add(self._followed(inputs | self._violation(state, inputs)))
                return GameTrace(runs.all, None, state, self._numbers)
            letter = self._followed(inputs | self._resistance(options, state, inputs, trap))
            before, state = state, self._game.transition.next(bdd.point({**state, **letter}))
            stays = runs.add(letter) > _LONG and self._traps[trap].inputs is not None
            if stays and self._course is None:  # numbers differ from tick to tick
                ticks, state = self._while_repeated(letter, state, trap)
                runs.add(letter, ticks)
            promise = self._following(state, promise)

    def _followed(self, letter: Letter) -> Letter:
        """The valuation, after numbers have been chosen for it."""
        if self._course is not None:
            self._course.follow(letter)
        return letter

    @property
    def _numbers(self) -> tuple[Tick, ...]:
        return () if self._course is None else tuple(self._course.ticks)

    def _possible(self, inputs: Letter) -> Function:
        """Outputs that are possible with the numbers of the previous tick."""
        return bdd.true() if self._course is None else self._course.possible(inputs)

    def _while_repeated(self, letter: Letter, state: State, trap: int) -> tuple[int, State]:
        """How many more ticks the valuation can repeat before the state leaves the trap."""
        game, known = self._game, bdd.point(letter)
        left = self._traps[trap - 1].left  # of the trap itself, none of it is left
        stays = game.safe & left & game.transition.moved(left)
        moves = game.transition.relation(stays, bdd.true(), known)
        try:
            return TransitionRelation(game.transition.bits, moves, self._budget).longest(state)
        except RelationTooLargeError:
            return 0, state

    def _following(self, state: State, promise: int) -> int:
        """The promise that the environment keeps next in a state."""
        promises = self._game.promises
        if not promises or bdd.at(promises[promise], bdd.point(state)) == bdd.false():
            return promise
        return (promise + 1) % len(promises)

    def _inputs(self, state: State, promise: int, trap: Trap) -> dict[int, bool]:
        """Inputs of the environment in a state of a trap, to keep a promise next."""
        if trap.inputs is not None:
            return {**trap.inputs}
        game, known = self._game, bdd.point(state)
        chain = trap.chains[promise] if len(trap.chains) > 1 else trap.chains[0]
        escape = next(e for left, e in chain if bdd.at(left, known) == bdd.false())
        moved = game.transition.moved_from(escape, known)
        free = (bdd.at(game.safe, known) & moved) | bdd.at(game.reachable - game.kept, known)
        answer = bdd.exists(free, bdd.cube(game.alphabet.outputs))
        return whole(bdd.at(game.legal, known) - answer, game.alphabet.inputs)

    def _number(self, known: Function, near: int) -> int:
        """Index of the first trap with the state; the search starts at the given one."""

        def is_held(number: int) -> bool:
            return bool(bdd.at(self._traps[number].left, known) == bdd.false())

        for number in (near, near - 1):
            if number >= 0 and is_held(number) and not (number and is_held(number - 1)):
                return number
        return _first(is_held, len(self._traps))

    def _options(self, state: State, inputs: Letter) -> Function:
        """Outputs without a violation."""
        safe = bdd.at(self._game.safe, bdd.point({**state, **inputs}))
        return safe & self._possible(inputs)

    def _resistance(
        self, options: Function, state: State, inputs: Letter, trap: int
    ) -> dict[int, bool]:
        """Outputs that lead into the trap with the highest possible number."""
        known = bdd.point({**state, **inputs})
        variables = self._game.alphabet.outputs

        def ways(number: int) -> Function:
            left = self._traps[number].left
            return options & self._game.transition.moved_from(left, known)

        if trap >= 2 and self._game.duties == []:
            for number in (trap - 1, trap - 2):  # within this one, where inputs are repeated
                best = ways(number)
                if best != bdd.false():
                    return whole(best, variables)
        none_left = _first(lambda number: ways(number) == bdd.false(), len(self._traps))
        return whole(ways(none_left - 1) if none_left else options, variables)

    def _violation(self, state: State, inputs: Letter) -> dict[int, bool]:
        """Outputs that violate as few requirements as possible."""
        known = bdd.point({**state, **inputs})
        options = bdd.at(self._game.reachable, known) & self._possible(inputs)
        for counter in self._game.counters:
            kept = options & bdd.at(counter.safe, known)
            options = kept if kept != bdd.false() else options
        return whole(options, self._game.alphabet.outputs)


class _Runs:
    """The valuations of a trace under construction."""

    def __init__(self) -> None:
        self._runs: list[Run] = []
        self.ticks = 0

    @property
    def all(self) -> tuple[Run, ...]:
        return tuple(self._runs)

    def add(self, letter: Letter, ticks: int = 1) -> int:
        """Append a valuation; returns how many ticks it has lasted."""
        before = self._runs.pop()[1] if self._runs and self._runs[-1][0] == letter else 0
        self._runs.append((letter, before + ticks))
        self.ticks += ticks
        return before + ticks


_LONG = 16
"""Ticks of an equal valuation after which its total length is computed."""


def _first(holds: Callable[[int], bool], size: int) -> int:
    """First number from which a monotone property holds; `size` if there is none."""
    low, high = 0, size
    while low < high:
        middle = (low + high) // 2
        if holds(middle):
            high = middle
        else:
            low = middle + 1
    return low
