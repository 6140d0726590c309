"""Plays of a game, tick by tick: how the environment wins, and how the system does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from compiler.logic import decision_diagrams as bdd
from compiler.logic.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.transition import State
from fretc.analysis.games.game import Game, Goal, Letter, Solution, Trap, whole
from fretc.analysis.games.squaring import Relation, TooLargeError

Run = tuple[Letter, int]
"""A letter, and for how many ticks it stays."""


@dataclass(frozen=True, slots=True)
class GameTrace:
    """Letters, tick by tick."""

    runs: tuple[Run, ...]
    loop: int | None
    """The tick to which the last one leads back for ever; None: the last tick breaks something."""
    state: State
    """Before the last tick."""
    numbers: tuple[Tick, ...] = ()
    """Of each tick, where they depend on those of the tick before."""

    @property
    def ticks(self) -> int:
        """How many it has, up to the breach, or the end of the loop."""
        return sum(count for _, count in self.runs)

    @property
    def letters(self) -> tuple[Letter, ...]:
        """One for each tick."""
        return tuple(letter for letter, count in self.runs for _ in range(count))

    def repeated(self, rounds: int) -> tuple[Run, ...]:
        """The runs, with the loop so many times."""
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
    """The environment wins, but no play shows it; the message says why."""


_MOST_NUMBERS = 500
"""Ticks of a play whose numbers may come back to what they were."""


class Counterstrategy:
    """How the environment wins a game that the system cannot win.

    The system resists as long as it can; so the play shows why there is no way out.
    """

    def __init__(self, game: Game, solution: Solution, budget: Budget) -> None:
        assert not solution.is_realizable
        self._game, self._traps, self._budget = game, solution.traps, budget
        self._course = game.alphabet.course(budget)

    def play(self) -> GameTrace:
        """From the initial state to a breach, or round and round without what must come.

        Raises:
            OutOfTimeError: it has too many ticks.
            NoPlayError: its numbers come back to nothing that was.
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
                runs.add(self._followed(inputs | self._breach(state, inputs)))
                return GameTrace(runs.all, None, state, self._numbers)
            letter = self._followed(inputs | self._resistance(options, state, inputs, trap))
            before, state = state, self._game.transition.next(bdd.point({**state, **letter}))
            stays = runs.add(letter) > _LONG and self._traps[trap].inputs is not None
            if stays and self._course is None:  # numbers differ from tick to tick
                ticks, state = self._while_repeated(letter, state, trap)
                runs.add(letter, ticks)
            promise = self._following(state, promise)

    def _followed(self, letter: Letter) -> Letter:
        """The letter, for which numbers are chosen."""
        if self._course is not None:
            self._course.follow(letter)
        return letter

    @property
    def _numbers(self) -> tuple[Tick, ...]:
        return () if self._course is None else tuple(self._course.ticks)

    def _possible(self, inputs: Letter) -> Function:
        """The outputs that the numbers of the tick before leave."""
        return bdd.true() if self._course is None else self._course.possible(inputs)

    def _while_repeated(self, letter: Letter, state: State, trap: int) -> tuple[int, State]:
        """How many ticks more the letter can be repeated before the state leaves the trap."""
        game, known = self._game, bdd.point(letter)
        left = self._traps[trap - 1].left  # of the trap itself, none of it is left
        stays = game.safe & left & game.transition.moved(left)
        moves = game.transition.relation(stays, bdd.true(), known)
        try:
            return Relation(game.transition.bits, moves, self._budget).longest(state)
        except TooLargeError:
            return 0, state

    def _following(self, state: State, promise: int) -> int:
        """The promise that the environment keeps next, once it is in a state."""
        promises = self._game.promises
        if not promises or bdd.at(promises[promise], bdd.point(state)) == bdd.false():
            return promise
        return (promise + 1) % len(promises)

    def _inputs(self, state: State, promise: int, trap: Trap) -> dict[int, bool]:
        """What the environment does in a state that a trap holds, to keep a promise next."""
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
        """The first trap that holds the state; often one that is near, or the one before it."""

        def is_held(number: int) -> bool:
            return bool(bdd.at(self._traps[number].left, known) == bdd.false())

        for number in (near, near - 1):
            if number >= 0 and is_held(number) and not (number and is_held(number - 1)):
                return number
        return _first(is_held, len(self._traps))

    def _options(self, state: State, inputs: Letter) -> Function:
        """The outputs that break nothing."""
        safe = bdd.at(self._game.safe, bdd.point({**state, **inputs}))
        return safe & self._possible(inputs)

    def _resistance(
        self, options: Function, state: State, inputs: Letter, trap: int
    ) -> dict[int, bool]:
        """Outputs that lead into the trap that was found last; often the one before this."""
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

    def _breach(self, state: State, inputs: Letter) -> dict[int, bool]:
        """Outputs that break as few requirements as can be."""
        known = bdd.point({**state, **inputs})
        options = bdd.at(self._game.reachable, known) & self._possible(inputs)
        for counter in self._game.counters:
            kept = options & bdd.at(counter.safe, known)
            options = kept if kept != bdd.false() else options
        return whole(options, self._game.alphabet.outputs)


class _Runs:
    """The letters of a play that goes on."""

    def __init__(self) -> None:
        self._runs: list[Run] = []
        self.ticks = 0

    @property
    def all(self) -> tuple[Run, ...]:
        return tuple(self._runs)

    def add(self, letter: Letter, ticks: int = 1) -> int:
        """One more letter; for how many ticks it stays now."""
        before = self._runs.pop()[1] if self._runs and self._runs[-1][0] == letter else 0
        self._runs.append((letter, before + ticks))
        self.ticks += ticks
        return before + ticks


_LONG = 16
"""Ticks of one letter, after which it is looked at how long it stays."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where a strategy is: the state of the game, and the goal that it goes for."""

    state: tuple[bool, ...]
    goal: int = 0


class Strategy:
    """How the system wins: a Mealy machine, reply by reply."""

    def __init__(self, game: Game, solution: Solution) -> None:
        assert solution.is_realizable
        self._game, self._solution = game, solution
        self._bits = tuple(game.transition.start)
        self.start = Place(tuple(game.transition.start.values()))

    def reply(self, place: Place, inputs: Letter) -> tuple[dict[int, bool], Place]:
        """The outputs at a tick, and the place after it.

        Args:
            place: before the tick; reached by replies.
            inputs: all of them, legal.
        """
        game = self._game
        state = dict(zip(self._bits, place.state, strict=True))
        known = bdd.point({**state, **inputs})
        options, goal = self._options(place, known)
        outputs = whole(options, game.alphabet.outputs)
        after = game.transition.next(bdd.point({**state, **inputs, **outputs}))
        return outputs, Place(tuple(after[bit] for bit in self._bits), goal)

    def legal(self, place: Place) -> Function:
        """The inputs that may come, over their bits."""
        state = dict(zip(self._bits, place.state, strict=True))
        return bdd.at(self._game.legal, bdd.point(state))

    def _options(self, place: Place, known: Function) -> tuple[Function, int]:
        """Winning outputs, and the goal after them."""
        game, goals = self._game, self._solution.goals
        free = bdd.at(game.reachable - game.kept, known)
        if free != bdd.false():
            return free, place.goal
        safe = bdd.at(game.safe, known)
        if not goals:
            return safe & game.transition.moved_from(self._solution.winning, known), 0
        goal = goals[place.goal]
        reached = safe & game.transition.moved_from(goal.target, known)
        if reached != bdd.false():
            return reached, (place.goal + 1) % len(goals)
        return self._nearer(goal, place, safe, known), place.goal

    def _nearer(self, goal: Goal, place: Place, safe: Function, known: Function) -> Function:
        """Outputs that lead to the nearest layer, or stay where a promise is unkept."""
        moved_from = self._game.transition.moved_from
        here = bdd.point(dict(zip(self._bits, place.state, strict=True)))
        number = _first(
            lambda n: bdd.at(goal.layers[n].states, here) == bdd.true(), len(goal.layers)
        )
        for layer in goal.layers[:number]:
            options = safe & moved_from(layer.states, known)
            if options != bdd.false():
                return options
        for stays, promise in zip(goal.layers[number].stays, self._game.promises, strict=True):
            if bdd.at(stays, here) == bdd.true():
                return safe & moved_from(stays - promise, known)
        raise AssertionError("a winning state has a winning reply")


def _first(holds: Callable[[int], bool], size: int) -> int:
    """The first number from which on something monotone holds; `size` where it never does."""
    low, high = 0, size
    while low < high:
        middle = (low + high) // 2
        if holds(middle):
            high = middle
        else:
            low = middle + 1
    return low
