"""Short traces that satisfy a sentence, and short ones that violate it, each in a way of its own.

They are shortest words of the reference automaton (`compiler.counters`), by breadth first search
through waypoints: answered at once, at the deadline, cut off by the end of the scope; never
answered, broken late. Two traces are different where their runs are, repetitions left out.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import NamedTuple, TypeVar

from compiler import counters
from compiler.counters import BROKEN, Automaton, Letter, State, TooManyStatesError, accepts, explore
from compiler.letters import MOST_ATOMS, Valuation, atoms_of, meanings, temporal_predicate
from compiler.rule import Rule
from compiler.windows import kept
from fretish import syntax as s

MOST_STATES = 120_000
"""Seconds of search; a longer bound gets no examples."""
WANTED = 2
"""Of either kind."""


@dataclass(frozen=True, slots=True)
class Example:
    """A trace with its verdict."""

    satisfied: bool
    prefix: tuple[Valuation, ...]
    """At least one tick: the values of `Examples.atoms`."""
    loop: tuple[Valuation, ...]
    """What comes again and again after the prefix, on a run without end; the verdict is the same
    where the run ends after any of the rounds. Empty: what comes does not matter, or the run ends.
    """
    decided: int | None
    """The first tick after which no continuation can change the verdict. None: there is none."""


@dataclass(frozen=True, slots=True)
class Examples:
    """What could be found for a sentence."""

    atoms: tuple[str, ...]
    satisfied: tuple[Example, ...]
    violated: tuple[Example, ...]
    note: str = ""
    """Why there are none, where there are none."""


def examples(rule: Rule, wanted: int = WANTED) -> Examples:
    """The traces of a rule: at most so many of either kind, the shortest ones first."""
    predicate = temporal_predicate(rule.sentence)
    if predicate is not None:
        return Examples((), (), (), f"`{predicate}` speaks of other ticks, the automaton of one")
    atoms = atoms_of(rule.sentence)
    if len(atoms) > MOST_ATOMS:
        return Examples(atoms, (), (), f"{len(atoms)} propositions are more than {MOST_ATOMS}")
    letters = _quiet_first(meanings(rule.sentence, atoms))
    counted = counters.template(rule.sentence, rule.ticks or 0)
    try:
        automaton = explore(counted, letters, MOST_STATES)
    except TooManyStatesError:
        return Examples(atoms, (), (), f"its automaton has more than {MOST_STATES} states")
    search = _Search(automaton, letters)
    return Examples(
        atoms,
        tuple(_different(search, search.satisfying(), wanted)),
        tuple(_different(search, search.violating(), wanted)),
    )


def _quiet_first(found: Mapping[Valuation, Letter]) -> dict[Letter, Valuation]:
    """For each letter the valuation with the fewest true atoms; the quietest letters first."""
    chosen: dict[Letter, Valuation] = {}
    for valuation, letter in sorted(found.items(), key=lambda pair: (sum(pair[0]), pair[0][::-1])):
        chosen.setdefault(letter, valuation)
    return chosen


# The search -------------------------------------------------------------------------------------


class _Move(NamedTuple):
    """One tick of a run."""

    before: State
    letter: Letter
    after: State | None
    target: int
    enforced: bool
    triggered: bool

    @property
    def waits(self) -> bool:
        """A demand is open after it."""
        return self.after is not None and self.after.counted != 0


_Waypoint = Callable[[_Move], bool]


def _triggered(move: _Move) -> bool:
    return move.triggered


def _waiting(move: _Move) -> bool:
    return move.waits and not move.triggered


def _answered(move: _Move) -> bool:
    """No demand is open after it; one was, or began; and not because the interval ends."""
    begun = move.triggered or move.before.counted != 0
    return begun and move.enforced and move.after is not None and not move.waits


def _cut(move: _Move) -> bool:
    """The interval ends while a demand is open, and nothing is broken by that."""
    return move.before.counted != 0 and move.after is not None and not move.enforced


def _last(move: _Move) -> bool:
    return move.after is not None and move.after.counted == 1 and not move.triggered


def _broken(move: _Move) -> bool:
    return move.after is None


@dataclass(frozen=True, slots=True)
class _Run:
    """A word with what it does."""

    moves: tuple[_Move, ...]
    loop: tuple[_Move, ...] = ()

    @property
    def behaviour(self) -> tuple[object, ...]:
        """What happens, equal ticks once: two runs that differ in nothing else are alike."""
        moves = (*self.moves, *self.loop)
        steps = [(m.enforced, m.triggered, m.waits, m.letter[2], m.letter[3]) for m in moves]
        return tuple(step for step, _ in groupby(steps))

    @property
    def is_open(self) -> bool:
        """Whether it stops in the middle of a demand."""
        goes_on = self.loop and all(move.waits for move in self.loop)
        return self.moves[-1].waits and not goes_on


class _Search:
    """Shortest words of an automaton."""

    def __init__(self, automaton: Automaton, letters: Mapping[Letter, Valuation]) -> None:
        self.automaton = automaton
        self.letters = letters
        self.most = max(abs(state.counted) for state in automaton.states)
        self.template = automaton.template
        self.final = [accepts(automaton.template, state) for state in automaton.states]

    def satisfying(self) -> Iterator[_Run]:
        """Candidates, the instructive ones first."""
        closed = self._closed
        ways: tuple[tuple[_Waypoint, ...], ...] = (
            (_triggered, _answered),
            (self._deadline, _answered),
            (_waiting, _answered),
            (_triggered, _cut),
            (_waiting, _cut),
            (_triggered, _answered, _triggered, _answered),
            (_triggered,),
            (_waiting,),
            (_triggered, _triggered),
        )
        for way in ways:
            found = self.shortest(way, closed)
            if found is not None:
                yield self._followed(found, accepted=True)
        silent = self.shortest((), closed, among=lambda move: not move.triggered)
        if silent is not None:
            yield self._followed(silent, accepted=True)
        several = self.shortest((_triggered, lambda move: True), closed)
        if several is not None:
            yield self._followed(several, accepted=True)

    def violating(self) -> Iterator[_Run]:
        """Candidates: broken demands, then those that nobody ever answers, then ends."""
        ways: tuple[tuple[_Waypoint, ...], ...] = (
            (_broken,),
            (self._deadline, _broken),
            (_last, _broken),
            (_waiting, _broken),
            (_answered, _broken),
            (lambda move: not move.triggered, _broken),
        )
        first = True
        for way in ways:
            found = self.shortest(way, lambda move: True)
            if found is None:
                continue
            yield found
            late = self._too_late(found) if first else None
            first = False
            if late is not None:
                yield late
        yield from self._never()

    def _never(self) -> Iterator[_Run]:
        """Runs on which a demand is open for ever, or at the end."""

        def unanswered(move: _Move) -> bool:
            return move.target != BROKEN and not self.final[move.target]

        ways: tuple[tuple[_Waypoint, ...], ...] = (
            (unanswered,),
            (_answered, unanswered),
            (_waiting, unanswered),
            (lambda move: not move.triggered, unanswered),
        )
        for way in ways:
            found = self.shortest(way, lambda move: True)
            if found is not None:
                yield self._followed(found, accepted=False)

    def _deadline(self, move: _Move) -> bool:
        return move.after is not None and 0 < self.most == abs(move.after.counted)

    def _closed(self, move: _Move) -> bool:
        """FRET's verdict would be `satisfied`, were it the last tick."""
        return move.target != BROKEN and self.final[move.target]

    def shortest(
        self,
        way: Sequence[_Waypoint],
        ending: _Waypoint,
        among: _Waypoint = lambda move: True,
    ) -> _Run | None:
        """The first shortest run that comes by all waypoints in their order, one tick for each.

        A waypoint may be the tick of the one before it. The run ends with the last waypoint, at a
        tick that `ending` holds of; without waypoints, with the first such tick.
        """
        start = (0, 0)
        origins: dict[tuple[int, int], tuple[tuple[int, int], _Move] | None] = {start: None}
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
                    return _Run((*_path(origins, here), move))
                after = (move.target, min(stage, len(way)))
                if move.target != BROKEN and after not in origins:
                    origins[after] = (here, move)
                    waiting.append(after)
        return None

    def _moves(self, number: int) -> Iterator[_Move]:
        automaton = self.automaton
        state = automaton.states[number]
        for letter, target in zip(automaton.letters, automaton.moves[number], strict=True):
            happens = counters.happening(self.template, state, letter[0], letter[1])
            after = None if target == BROKEN else automaton.states[target]
            yield _Move(state, letter, after, target, happens.enforced, happens.triggered)

    def _too_late(self, broken: _Run) -> _Run | None:
        """The same with the response one tick after the deadline, where there is one."""
        negated = self.template.scope is not None and self.template.scope.negates
        timing = s.For if negated else s.Within
        if self.template.timing is not timing:
            return None
        last = broken.moves[-1]
        for m, p, q, stop in self.automaton.letters:
            if m == last.letter[0] and p == last.letter[1] and q is not negated:
                late = _Move(last.before, (m, p, q, stop), None, BROKEN, last.enforced, False)
                return _Run((*broken.moves, late))
        return None

    def _followed(self, found: _Run, *, accepted: bool) -> _Run:
        """With a round that can come again and again, all of whose states have the same verdict."""
        start = found.moves[-1].target
        if not self.endless or self._decided(found, accepted) is not None:
            return found
        for first in self._moves(start):
            second = self._after(first)
            if second is not None and self._judged(first, second, accepted):
                return _Run(found.moves, (first,))
        return _Run(found.moves, self._round(start, accepted=accepted))

    def _after(self, move: _Move) -> _Move | None:
        """The same letter once more."""
        if move.target == BROKEN:
            return None
        return next(again for again in self._moves(move.target) if again.letter == move.letter)

    def _judged(self, first: _Move, second: _Move, accepted: bool) -> bool:
        """Whether the letter leads into a loop of its own with that verdict."""
        stays = first.target == second.target
        return stays and self.final[first.target] is accepted

    def _round(self, start: int, *, accepted: bool) -> tuple[_Move, ...]:
        """A shortest way back to a state; empty where there is none."""
        origins: dict[int, tuple[int, _Move] | None] = {start: None}
        waiting = deque([start])
        while waiting:
            here = waiting.popleft()
            for move in self._moves(here):
                if move.target == BROKEN or self.final[move.target] is not accepted:
                    continue
                if move.target == start:
                    return (*_path(origins, here), move)
                if move.target not in origins:
                    origins[move.target] = (here, move)
                    waiting.append(move.target)
        return ()

    def example(self, run: _Run) -> Example:
        """The run as a trace of atoms."""
        end = run.moves[-1]
        satisfied = end.target != BROKEN and self.final[end.target]
        decided = self._decided(run, satisfied)
        loop = run.loop if decided is None and self.endless else ()
        return Example(
            satisfied,
            tuple(self.letters[move.letter] for move in run.moves),
            tuple(self.letters[move.letter] for move in loop),
            decided,
        )

    @property
    def endless(self) -> bool:
        """Whether the end of a run counts like its going on; `finally` needs an end."""
        return self.template.timing is not s.Finally or self.template.scope not in _OPEN

    def _decided(self, run: _Run, satisfied: bool) -> int | None:
        if not self.endless:
            return None
        verdict = "satisfied" if satisfied else "violated"
        for tick, move in enumerate(run.moves):
            if move.target == BROKEN or self.automaton.verdicts[move.target] == verdict:
                return tick
        return None


_OPEN = (None, s.ScopeKind.AFTER, s.ScopeKind.ONLY_BEFORE)
"""Scopes whose interval ends with the run."""


_Node = TypeVar("_Node")


def _path(origins: Mapping[_Node, tuple[_Node, _Move] | None], place: _Node) -> list[_Move]:
    """The moves that led to a place."""
    moves: list[_Move] = []
    origin = origins[place]
    while origin is not None:
        place, move = origin
        moves.append(move)
        origin = origins[place]
    return moves[::-1]


def _different(search: _Search, runs: Iterator[_Run], wanted: int) -> Iterator[Example]:
    """The first ones that behave differently, each checked by the definition."""
    seen: set[tuple[object, ...]] = set()
    for run in runs:
        if len(seen) == wanted:
            return
        found = search.example(run)
        left_open = run.is_open and search.endless and found.decided is None
        if run.behaviour not in seen and not left_open:
            seen.add(run.behaviour)
            _check(search, run, found)
            yield found


def _check(search: _Search, run: _Run, found: Example) -> None:
    """The automaton and the definition agree on the trace, and on each round after it."""
    word = [move.letter for move in run.moves]
    for _ in range(3 if found.loop else 1):
        m, p, q, stop = zip(*word, strict=True)
        assert kept(search.template, m, p, q, stop) is found.satisfied, (search.template, word)
        word += [move.letter for move in run.loop]
