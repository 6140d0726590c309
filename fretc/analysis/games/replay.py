"""Check of game traces by the formulas of the monitors.

Only the valuations of a trace are taken from the game: a finding is shown only if the monitors of
its requirements confirm it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import formula as f
from compiler.logic.definition import holds_on_lasso
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.evaluation import evaluate
from compiler.logic.spot import is_bad_prefix
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.transition import Transition
from fretc.analysis.games.game import Letter
from fretc.analysis.games.game_traces import GameTrace, Run
from fretish.checking import is_formula

ROUNDS = 3
"""Number of repetitions of a loop; an obligation that stays open for all of them stays open."""


def columns(alphabet: Alphabet, runs: Sequence[Run], atoms: Iterable[str]) -> dict[str, int]:
    """Each atom over time, bit i for tick i."""
    functions = {name: alphabet.atom(name) for name in atoms}
    bits: dict[str, list[str]] = {name: [] for name in functions}
    for letter, count in reversed([*remembering(alphabet, runs)]):
        known = bdd.point(letter)
        for name, function in functions.items():
            bits[name].append(("1" if bdd.at(function, known) == bdd.true() else "0") * count)
    return {name: int("".join(values) or "0", 2) for name, values in bits.items()}


def remembering(alphabet: Alphabet, runs: Iterable[Run]) -> Iterator[Run]:
    """Valuations from the first tick on, each with the stored facts before it."""
    memory = alphabet.memory()
    if memory is None:
        yield from runs
        return
    transition = Transition([memory])
    state = transition.start
    for letter, count in runs:
        left = count
        while left:
            known = {**letter, **state}
            after = transition.next(bdd.point(known))
            ticks = left if after == state else 1  # Other bits of memory do not change.
            yield known, ticks
            state, left = after, left - ticks


def broken(
    requirements: Sequence[FormalizedRequirement],
    alphabet: Alphabet,
    play: GameTrace,
    *,
    as_fret: bool = False,
) -> tuple[str, ...]:
    """The requirements that the trace violates at its last tick, or never meets in its loop.

    Args:
        requirements: requirements of a conflict.
        alphabet: alphabet of the valuations.
        play: trace up to the first violation, or endless.
        as_fret: whether no obligation may be open at the end of any tick.
    """
    runs = play.repeated(ROUNDS)
    return tuple(
        requirement.id
        for requirement in requirements
        if _is_broken(requirement, alphabet, runs, play.loop, as_fret=as_fret)
    )


def _is_broken(
    requirement: FormalizedRequirement,
    alphabet: Alphabet,
    runs: Sequence[Run],
    loop: int | None,
    *,
    as_fret: bool,
) -> bool:
    if is_formula(requirement.sentence):
        return _is_formula_broken(requirement, alphabet, runs, loop)
    ticks = sum(count for _, count in runs)
    violation, violated_if_ended = _watched(
        (requirement.watch.violation, requirement.watch.violated_if_ended), alphabet, runs
    )
    last = 1 << ticks - 1
    if loop is None:
        return bool((violation | (violated_if_ended if as_fret else 0)) & last)
    rounds = ((1 << ticks) - 1) >> loop << loop
    return violation == 0 and violated_if_ended & rounds == rounds


def _is_formula_broken(
    requirement: FormalizedRequirement, alphabet: Alphabet, runs: Sequence[Run], loop: int | None
) -> bool:
    """Whether the trace violates a formula, by its definition on endless traces.

    A prefix violates it if no run that begins with it satisfies the formula.
    """
    letters = [letter for letter, count in runs for _ in range(count)]
    valuations = _valuations(requirement, alphabet, letters)
    if loop is None:
        return is_bad_prefix(requirement.ft_infinite, valuations)
    return not holds_on_lasso(requirement.ft_infinite, valuations[:loop], valuations[loop:])


def _valuations(
    requirement: FormalizedRequirement, alphabet: Alphabet, letters: Sequence[Letter]
) -> list[dict[str, bool]]:
    """The atoms of a requirement at each tick."""
    runs = [(letter, 1) for letter in letters]
    known = columns(alphabet, runs, f.atoms(requirement.ft_infinite))
    return [
        {name: bool(column >> tick & 1) for name, column in known.items()}
        for tick in range(len(letters))
    ]


def kept(
    requirements: Sequence[FormalizedRequirement],
    alphabet: Alphabet,
    letters: Sequence[Letter],
    tail: int,
    waiting: Collection[str],
    *,
    as_fret: bool = False,
) -> bool:
    """Whether a run violates no requirement, and leaves none unmet in its last ticks.

    Args:
        requirements: all requirements to satisfy.
        alphabet: alphabet of the valuations.
        letters: valuations, with the loop of the run repeated.
        tail: number of ticks of the loop.
        waiting: ids of requirements whose obligations may not stay open for ever; `finally` on an
            endless run is met.
        as_fret: whether no obligation may be open at the end of any tick.
    """
    end = ((1 << tail) - 1) << len(letters) - tail
    for requirement in requirements:
        if is_formula(requirement.sentence):
            valuations = _valuations(requirement, alphabet, letters)
            start = len(letters) - tail
            if not holds_on_lasso(
                requirement.ft_infinite, valuations[:start], valuations[start:] or valuations[-1:]
            ):
                return False
            continue
        signals = (
            requirement.watch.violation,
            requirement.watch.violation_inevitable,
            requirement.watch.violated_if_ended,
        )
        violation, violation_inevitable, violated_if_ended = _watched(
            signals, alphabet, [(letter, 1) for letter in letters]
        )
        is_open = requirement.id in waiting and violated_if_ended & end == end
        if violation or (violated_if_ended if as_fret else violation_inevitable or is_open):
            return False
    return True


def _watched(
    signals: Sequence[f.Formula], alphabet: Alphabet, runs: Sequence[Run]
) -> Iterator[int]:
    """Each signal over time, bit i for tick i."""
    atoms = dict.fromkeys(name for signal in signals for name in f.atoms(signal))
    known, ticks = columns(alphabet, runs, atoms), sum(count for _, count in runs)
    return (evaluate(signal, known, ticks) for signal in signals)
