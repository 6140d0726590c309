"""Shortest words of the reference automaton that pass given events, and loops after them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import groupby
from typing import NamedTuple

from compiler.formalization import reference as counters
from compiler.formalization.reference import (
    BROKEN,
    Automaton,
    Letter,
    ReferenceState,
    accepts,
    reachable,
    reversed_edges,
)
from fretish import syntax as s
from fretish.classes.frozen import dataclass


class Move(NamedTuple):
    """One tick of a run."""

    before: ReferenceState
    letter: Letter
    after: ReferenceState | None
    target: int
    enforced: bool
    triggered: bool

    @property
    def waits(self) -> bool:
        """Whether a demand is open after the tick."""
        return self.after is not None and self.after.counted != 0


_Place = tuple[int, int]
"""A state, and the number of waypoints that were passed."""
Waypoint = Callable[[Move], bool]
"""A predicate for an event that a run must pass."""


@dataclass(frozen=True, slots=True)
class AutomatonRun:
    """A word with its moves in the automaton."""

    moves: tuple[Move, ...]
    loop: tuple[Move, ...] = ()

    @property
    def behaviour(self) -> tuple[object, ...]:
        """The events of the run with equal ticks merged; runs with equal events are alike."""
        moves = (*self.moves, *self.loop)
        steps = [(m.enforced, m.triggered, m.waits, m.letter[2], m.letter[3]) for m in moves]
        return tuple(step for step, _ in groupby(steps))

    @property
    def is_open(self) -> bool:
        """Whether the run ends with an open demand."""
        goes_on = self.loop and all(move.waits for move in self.loop)
        return self.moves[-1].waits and not goes_on


class ShortestWords:
    """The words of an automaton; earlier letters are preferred."""

    def __init__(self, automaton: Automaton) -> None:
        self.automaton = automaton
        self.template = automaton.template
        self.most = max(abs(state.counted) for state in automaton.states)
        """The largest count, which is the deadline if there is one."""
        self.final = [accepts(automaton.template, state) for state in automaton.states]
        """For each state FRET's verdict on a run that ends there."""

    def shortest(
        self,
        way: Sequence[Waypoint],
        ending: Waypoint,
        among: Waypoint = lambda move: True,
    ) -> AutomatonRun | None:
        """The first shortest run that passes all waypoints in order, each at a tick.

        Two waypoints may be passed at the same tick. The run ends with the first tick from the last
        waypoint on for which `ending` is true.
        """
        start = (0, 0)
        origins: dict[_Place, tuple[_Place, Move] | None] = {start: None}
        waiting = deque([start])
        while waiting:
            here = waiting.popleft()
            for move in self._moves(here[0]):
                if not among(move):
                    continue
                stage = here[1]
                while (
                    stage < len(way)
                    and way[stage](move)
                    and way[stage] not in way[here[1] : stage]  # the same again is another tick
                ):
                    stage += 1
                if stage == len(way) and ending(move):
                    return AutomatonRun((*_path(origins, here), move))
                after = (move.target, stage)
                if move.target != BROKEN and after not in origins:
                    origins[after] = (here, move)
                    waiting.append(after)
        return None

    def _moves(self, number: int) -> Iterator[Move]:
        automaton = self.automaton
        state = automaton.states[number]
        for letter, target in zip(automaton.letters, automaton.moves[number], strict=True):
            happens = counters.tick_role(self.template, state, letter[0], letter[1])
            after = None if target == BROKEN else automaton.states[target]
            yield Move(state, letter, after, target, happens.enforced, happens.triggered)

    def followed(self, run: AutomatonRun, *, accepted: bool) -> AutomatonRun:
        """The run with a tick appended that can repeat for ever without changing the verdict."""
        start = run.moves[-1].target
        if self.decided(run, satisfied=accepted) is not None:
            return run
        if self.needs_end and not accepted:
            return run  # an interval that never ends has no last tick
        for first in self._moves(start):
            second = self._after(first)
            stays = second is not None and first.target == second.target
            if stays and self.final[first.target] is accepted:
                return AutomatonRun(run.moves, (first,))
        return run

    def _after(self, move: Move) -> Move | None:
        """The move with the same letter once more."""
        if move.target == BROKEN:
            return None
        return next(again for again in self._moves(move.target) if again.letter == move.letter)

    @property
    def needs_end(self) -> bool:
        """Whether only the end of an interval can violate the sentence."""
        return s.SHAPES[self.template.timing].extent.needs_end

    def decided(self, run: AutomatonRun, *, satisfied: bool) -> int | None:
        """The first tick after which no continuation changes the verdict; None: there is none.

        For a satisfied run, no end of the run may change the verdict either: `finally` demands
        nothing of endless runs.
        """
        for tick, move in enumerate(run.moves):
            if move.target == BROKEN:
                return tick
            verdict = self.automaton.verdicts[move.target]
            if satisfied and verdict == "satisfied" and move.target not in self._may_fail:
                return tick
            if not satisfied and verdict == "violated":
                return tick
        return None

    @cached_property
    def _may_fail(self) -> set[int]:
        """The states from which a run can reach an end that FRET judges as violated."""
        moves = self.automaton.moves
        failing = [
            state for state, row in enumerate(moves) if BROKEN in row or not self.final[state]
        ]
        return reachable(reversed_edges(moves), failing)


def _path(origins: Mapping[_Place, tuple[_Place, Move] | None], place: _Place) -> list[Move]:
    """The moves that led to a search node."""
    moves: list[Move] = []
    origin = origins[place]
    while origin is not None:
        place, move = origin
        moves.append(move)
        origin = origins[place]
    return moves[::-1]
