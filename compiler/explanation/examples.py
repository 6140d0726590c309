"""Short traces that satisfy or violate a sentence, each in a different way.

They are shortest words of the reference automaton (`compiler.formalization.reference`), by breadth
first search through waypoints: answered at once, at the deadline, cut off by the end of the scope;
never answered, broken late. Two traces are different where their runs are, repetitions left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from compiler.explanation.shortest_words import AutomatonRun, Move, ShortestWords, Waypoint
from compiler.explanation.windows import has_deadline, is_satisfied
from compiler.formalization import reference as counters
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import (
    MOST_ATOMS,
    Valuation,
    atoms_of,
    comparisons,
    impossible_combinations,
    letters_by_valuation,
    temporal_predicate,
)
from compiler.formalization.reference import (
    BROKEN,
    Automaton,
    Letter,
    TooManyStatesError,
    explore,
)
from compiler.logic.orders import Exclusion, only_possible
from fretish.classes.frozen import dataclass

MOST_STATES = 120_000
"""Automata with more states get no examples: the search would take seconds."""
WANTED = 2
"""Default number of examples of either kind."""


@dataclass(frozen=True, slots=True)
class Example:
    """A trace with its verdict."""

    satisfied: bool
    prefix: tuple[Valuation, ...]
    """At least one tick: the values of `Examples.atoms`."""
    loop: tuple[Valuation, ...]
    """The ticks that repeat for ever after the prefix, on an endless run; the verdict is the same
    if the run ends after any round. Empty: the run ends, or what follows does not matter.
    """
    decided: int | None
    """The first tick after which no continuation can change the verdict. None: there is none."""


@dataclass(frozen=True, slots=True)
class Examples:
    """The examples of a sentence, with the reasons for those that are missing."""

    atoms: tuple[str, ...]
    satisfied: tuple[Example, ...]
    violated: tuple[Example, ...]
    note: str = ""
    """The reason if there are no examples."""
    rounded: Exclusion = ()
    """A combination that was left out because no real numbers make it; rounded floats may."""
    is_undecided: bool = False
    """Whether it was not decided that numbers exist for the traces."""


def examples(requirement: FormalizedRequirement, wanted: int = WANTED) -> Examples:
    """The examples of a requirement: at most `wanted` of either kind, the shortest first."""
    predicate = temporal_predicate(requirement.sentence)
    if predicate is not None:
        return Examples(
            (),
            (),
            (),
            f"`{predicate}` refers to other ticks, but the automaton reads one tick at a time",
        )
    atoms = atoms_of(requirement.sentence)
    if len(atoms) > MOST_ATOMS:
        return Examples(atoms, (), (), f"{len(atoms)} propositions are more than {MOST_ATOMS}")
    every = letters_by_valuation(requirement.sentence, atoms)
    possible = only_possible(tuple(every), atoms, impossible_combinations(requirement))
    chosen = _chosen(requirement, atoms, {valuation: every[valuation] for valuation in possible})
    letters = chosen.letters
    counted = counters.template(requirement.sentence, requirement.ticks or 0)
    try:
        automaton = explore(counted, letters, MOST_STATES)
    except TooManyStatesError:
        return Examples(atoms, (), (), f"its automaton has more than {MOST_STATES} states")
    search = _ExampleSearch(automaton, letters)
    satisfied = tuple(_different_examples(search, search.satisfying(), wanted))
    violated = tuple(_different_examples(search, search.violating(), wanted))
    shown = {
        valuation
        for example in (*satisfied, *violated)
        for valuation in (*example.prefix, *example.loop)
    }
    is_undecided = not chosen.undecided.isdisjoint(shown)
    return Examples(atoms, satisfied, violated, "", chosen.rounded, is_undecided)


# Letters ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _LetterValuations:
    """A valuation of the atoms for each letter."""

    letters: Mapping[Letter, Valuation]
    undecided: frozenset[Valuation] = frozenset()
    rounded: Exclusion = ()
    """The combination of a letter that no real numbers make."""


def _chosen(
    requirement: FormalizedRequirement, atoms: Sequence[str], every: Mapping[Valuation, Letter]
) -> _LetterValuations:
    """For each letter the valuation with the fewest true atoms that real numbers make."""
    if not comparisons(requirement):
        return _LetterValuations(_fewest_true_first(every))
    from compiler.formalization.numbers.reals import Impossible, Possible, Reals

    reals, excluded = Reals(requirement), dict[Letter, Exclusion]()
    possible, undecided = dict[Valuation, Letter](), dict[Valuation, Letter]()
    for valuation, letter in _by_true_atoms(every):
        if letter in possible.values():
            continue
        match reals.answer(dict(zip(atoms, valuation, strict=True))):
            case Possible():
                possible[valuation] = letter
            case Impossible(exclusion):
                excluded.setdefault(letter, exclusion)
            case _:
                undecided.setdefault(valuation, letter)
    spare = {v: letter for v, letter in undecided.items() if letter not in possible.values()}
    letters = _fewest_true_first({**possible, **spare})
    gone = (exclusion for letter, exclusion in excluded.items() if letter not in letters)
    return _LetterValuations(letters, frozenset(spare), next(gone, ()))


def _fewest_true_first(letter_of: Mapping[Valuation, Letter]) -> dict[Letter, Valuation]:
    """For each letter the valuation with the fewest true atoms; the quietest letters first."""
    chosen: dict[Letter, Valuation] = {}
    for valuation, letter in _by_true_atoms(letter_of):
        chosen.setdefault(letter, valuation)
    return chosen


def _by_true_atoms(letter_of: Mapping[Valuation, Letter]) -> Sequence[tuple[Valuation, Letter]]:
    return sorted(letter_of.items(), key=lambda pair: (sum(pair[0]), pair[0][::-1]))


# The search -------------------------------------------------------------------------------------


def _triggered(move: Move) -> bool:
    return move.triggered


def _waiting(move: Move) -> bool:
    return move.waits and not move.triggered


def _answered(move: Move) -> bool:
    """Whether a demand is met at this tick, not ended by its interval."""
    begun = move.triggered or move.before.counted != 0
    return begun and move.enforced and move.after is not None and not move.waits


def _cut(move: Move) -> bool:
    """Whether the interval ends with an open demand, without a violation."""
    return move.before.counted != 0 and move.after is not None and not move.enforced


def _last(move: Move) -> bool:
    return move.after is not None and move.after.counted == 1 and not move.triggered


def _broken(move: Move) -> bool:
    return move.after is None


class _ExampleSearch:
    """Candidates for examples, as words of an automaton."""

    def __init__(self, automaton: Automaton, letters: Mapping[Letter, Valuation]) -> None:
        self.words = ShortestWords(automaton)
        self.letters = letters
        self.template = automaton.template
        self.satisfiable = automaton.verdicts[0] != "violated"

    def satisfying(self) -> Iterator[AutomatonRun]:
        """Candidates for satisfying examples, the instructive ones first."""
        closed = self._closed
        ways: tuple[tuple[Waypoint, ...], ...] = (
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
            run = self.words.shortest(way, closed)
            if run is not None:
                yield self.words.followed(run, accepted=True)
        silent = self.words.shortest((), closed, among=lambda move: not move.triggered)
        if silent is not None:
            yield self.words.followed(silent, accepted=True)
        several = self.words.shortest((_triggered, lambda move: True), closed)
        if several is not None:
            yield self.words.followed(several, accepted=True)

    def violating(self) -> Iterator[AutomatonRun]:
        """Candidates for violating examples: broken demands, unanswered demands, ends."""
        ways: tuple[tuple[Waypoint, ...], ...] = (
            (_broken,),
            (self._deadline, _broken),
            (_last, _broken),
            (_waiting, _broken),
            (_answered, _broken),
            (lambda move: not move.triggered, _broken),
        )
        first = True
        for way in ways:
            run = self.words.shortest(way, lambda move: True)
            if run is None:
                continue
            yield run
            late = self._too_late(run) if first else None
            first = False
            if late is not None:
                yield late
        yield from self._never()

    def _never(self) -> Iterator[AutomatonRun]:
        """Runs on which a demand is open for ever, or at the end."""

        def unanswered(move: Move) -> bool:
            return move.target != BROKEN and not self.words.final[move.target]

        ways: tuple[tuple[Waypoint, ...], ...] = (
            (unanswered,),
            (_answered, unanswered),
            (_waiting, unanswered),
            (lambda move: not move.triggered, unanswered),
        )
        for way in ways:
            run = self.words.shortest(way, lambda move: True)
            if run is not None:
                yield self.words.followed(run, accepted=False)

    def _deadline(self, move: Move) -> bool:
        return move.after is not None and 0 < self.words.most == abs(move.after.counted)

    def _closed(self, move: Move) -> bool:
        """Whether FRET's verdict is `satisfied` if the run ends with this tick."""
        return move.target != BROKEN and self.words.final[move.target]

    def _too_late(self, broken: AutomatonRun) -> AutomatonRun | None:
        """The run with the response one tick after the deadline; None if there is no such run."""
        if not has_deadline(self.template):
            return None
        negated = self.template.scope is not None and self.template.scope.negates
        last = broken.moves[-1]
        for m, p, q, stop in self.words.automaton.letters:
            if m == last.letter[0] and p == last.letter[1] and q is not negated:
                late = Move(last.before, (m, p, q, stop), None, BROKEN, last.enforced, False)
                return AutomatonRun((*broken.moves, late))
        return None

    def example(self, run: AutomatonRun) -> Example:
        """The run as a trace of atoms."""
        end = run.moves[-1]
        satisfied = end.target != BROKEN and self.words.final[end.target]
        decided = self.words.decided(run, satisfied=satisfied)
        loop = run.loop if decided is None else ()
        return Example(
            satisfied,
            tuple(self.letters[move.letter] for move in run.moves),
            tuple(self.letters[move.letter] for move in loop),
            decided,
        )


def _different_examples(
    search: _ExampleSearch, runs: Iterator[AutomatonRun], wanted: int
) -> Iterator[Example]:
    """The first runs that behave differently, each checked by the definition."""
    seen: set[tuple[object, ...]] = set()
    spare: Example | None = None
    for run in runs:
        if len(seen) == wanted:
            return
        example = search.example(run)
        left_open = run.is_open and not search.words.needs_end and example.decided is None
        if left_open:
            spare = spare or example
        elif run.behaviour not in seen:
            seen.add(run.behaviour)
            _check(search, run, example)
            yield example
    if not seen and spare is not None and search.satisfiable:
        yield spare


def _check(search: _ExampleSearch, run: AutomatonRun, example: Example) -> None:
    """Check that automaton and definition agree on the trace and on each round after it."""
    word = [move.letter for move in run.moves]
    for _ in range(3 if example.loop else 1):
        m, p, q, stop = zip(*word, strict=True)
        assert is_satisfied(search.template, m, p, q, stop) is example.satisfied, (
            search.template,
            word,
        )
        word += [move.letter for move in run.loop]
