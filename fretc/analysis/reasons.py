"""Why a play is lost, in one sentence."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.formalization.formalized import Formalized
from compiler.logic import decision_diagrams as bdd
from compiler.logic import formula as f
from compiler.logic.decision_diagrams import Function
from compiler.logic.evaluation import evaluate
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.counters import Counter
from fretc.analysis.games.game import Game
from fretc.analysis.games.plays import Play
from fretc.analysis.games.replay import broken, columns

_MOST_TERMS = 3
"""Alternatives that a demand is shown with."""


def because(
    rules: Sequence[Formalized], counters: Sequence[Counter], game: Game, play: Play
) -> str:
    """What the requirements ask for where the play is lost.

    Args:
        rules: of a minimal conflict.
        counters: of the same.
        game: of the same.
        play: in which the environment wins.
    """
    begun = {rule.id: _begun(rule, game.alphabet, play) for rule in rules}
    if play.loop is not None:
        return _for_ever(rules, game, play, begun)
    last = len(play.letters) - 1
    known = _known(game, play)
    asked = {counter.id: _words(bdd.at(counter.safe, known), game) for counter in counters}
    parts = [f"{id}{begun[id]} {words}" for id, words in asked.items() if words]
    if not parts or len(rules) == 1:
        id = rules[0].id
        return f"at tick {last} no output keeps {id}{begun[id]}, whatever was done before"
    return f"at tick {last} {listed(parts)}"


def _known(game: Game, play: Play) -> Function:
    """The state before the last tick, and its inputs."""
    inputs = {number: play.letters[-1][number] for number in game.alphabet.inputs}
    return bdd.point({**play.state, **inputs})


def _begun(rule: Formalized, alphabet: Alphabet, play: Play) -> str:
    """` (since tick 3)`: when the demand began that is open at the last tick; or nothing."""
    signals = (rule.watch.trigger, rule.watch.owed)
    atoms = dict.fromkeys(name for signal in signals for name in f.atoms(signal))
    known = columns(alphabet, play.letters, atoms)
    ticks = len(play.letters)
    trigger, owed = (evaluate(signal, known, ticks) for signal in signals)
    if rule.sentence.condition is None:
        return ""
    tick = ticks - 1
    while tick > 0 and owed >> (tick - 1) & 1:
        tick -= 1
    stretch = trigger >> tick << tick
    if not stretch:
        return ""
    first = (
        stretch.bit_length() - 1 if rule.watch.renewed else (stretch & -stretch).bit_length() - 1
    )
    return "" if first == ticks - 1 else f" (since tick {first})"


def _for_ever(rules: Sequence[Formalized], game: Game, play: Play, begun: dict[str, str]) -> str:
    assert play.loop is not None
    lost = broken(rules, game.alphabet, play)
    others = [rule.id for rule in rules if rule.id not in lost]
    open_ = listed([f"{id}{begun[id]}" for id in lost])
    last = len(play.letters) - 1
    again = f"tick {last}" if play.loop == last else f"ticks {play.loop} to {last}"
    verb = "is" if len(others) == 1 else "are"
    keeping = f", as long as {listed(others)} {verb} kept" if others else ""
    return f"{open_} is never met{keeping}: {again} can come again for ever"


def _words(asked: Function, game: Game) -> str:
    """What outputs a requirement asks for; empty: any."""
    if asked == bdd.true():
        return ""
    if asked & game.reachable == bdd.false():
        return "can be kept by no output"
    terms: list[str] = []
    rest = asked
    while rest != bdd.false() and len(terms) < _MOST_TERMS:
        term = bdd.witness(rest)
        rest = rest - bdd.point(term)
        terms.append(_term(term, game.alphabet))
    more = " or other outputs" if rest != bdd.false() else ""
    if len(terms) == 1 and terms[0].startswith("not ") and " and " not in terms[0]:
        return f"forbids {terms[0].removeprefix('not ')}"
    return f"demands {' or '.join(terms)}{more}"


def _term(values: dict[int, bool], alphabet: Alphabet) -> str:
    named = [
        f"{'' if value else 'not '}`{alphabet.labels[number]}`"
        for number, value in values.items()
        if number in alphabet.labels
    ]
    return " and ".join(named) or "other outputs"


def listed(names: Sequence[str]) -> str:
    """`R1, R2 and R3`."""
    return " and ".join(part for part in (", ".join(names[:-1]), *names[-1:]) if part)
