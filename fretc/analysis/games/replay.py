"""Plays judged once more, by the formulas that monitors are made of.

Nothing of the game is believed here but the letters of a play: a finding is shown only where the
monitors of its requirements find it, too.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import decision_diagrams as bdd
from compiler.logic import formula as f
from compiler.logic.evaluation import evaluate
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.transition import Transition
from fretc.analysis.games.game import Letter
from fretc.analysis.games.game_traces import GameTrace, Run

ROUNDS = 3
"""How often a loop is read: a demand that stays open that long stays open."""


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
    """Letters from the first tick on, each with what is remembered before it."""
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
            ticks = left if after == state else 1  # nothing new is remembered of the others
            yield known, ticks
            state, left = after, left - ticks


def broken(
    requirements: Sequence[FormalizedRequirement],
    alphabet: Alphabet,
    play: GameTrace,
    *,
    as_fret: bool = False,
) -> tuple[str, ...]:
    """The requirements that the play breaks at its last tick, or never meets in its loop.

    Args:
        requirements: those of a conflict.
        alphabet: of the letters.
        play: up to the first breach, or an endless one.
        as_fret: whether nothing may be owed at the end of any tick.
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
    ticks = sum(count for _, count in runs)
    breach, fails = _watched((requirement.watch.breach, requirement.watch.fails), alphabet, runs)
    last = 1 << ticks - 1
    if loop is None:
        return bool((breach | (fails if as_fret else 0)) & last)
    rounds = ((1 << ticks) - 1) >> loop << loop
    return breach == 0 and fails & rounds == rounds


def kept(
    requirements: Sequence[FormalizedRequirement],
    alphabet: Alphabet,
    letters: Sequence[Letter],
    tail: int,
    waiting: Collection[str],
    *,
    as_fret: bool = False,
) -> bool:
    """Whether a run breaks none of the requirements, and leaves none unmet in its last ticks.

    Args:
        requirements: all that are to be kept.
        alphabet: of the letters.
        letters: with the loop of the run, several times.
        tail: how many ticks the loop has.
        waiting: ids of those whose demands may not stay open for ever; `finally` on a run without
            an end is met.
        as_fret: whether nothing may be owed at the end of any tick.
    """
    end = ((1 << tail) - 1) << len(letters) - tail
    for requirement in requirements:
        signals = (requirement.watch.breach, requirement.watch.doom, requirement.watch.fails)
        breach, doom, fails = _watched(signals, alphabet, [(letter, 1) for letter in letters])
        is_open = requirement.id in waiting and fails & end == end
        if breach or (fails if as_fret else doom or is_open):
            return False
    return True


def _watched(
    signals: Sequence[f.Formula], alphabet: Alphabet, runs: Sequence[Run]
) -> Iterator[int]:
    """Each signal over time, bit i for tick i."""
    atoms = dict.fromkeys(name for signal in signals for name in f.atoms(signal))
    known, ticks = columns(alphabet, runs, atoms), sum(count for _, count in runs)
    return (evaluate(signal, known, ticks) for signal in signals)


def first_breaches(
    requirements: Sequence[FormalizedRequirement], known: Mapping[str, int], ticks: int
) -> dict[str, int | None]:
    """For each requirement the tick at which it is broken; None: it is not.

    Args:
        requirements: of which all atoms are known.
        known: each atom over time.
        ticks: the length of the run.
    """
    found: dict[str, int | None] = {}
    for requirement in requirements:
        breach = evaluate(requirement.watch.breach, known, ticks)
        found[requirement.id] = (breach & -breach).bit_length() - 1 if breach else None
    return found
