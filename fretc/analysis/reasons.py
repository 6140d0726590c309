"""The reason why a game is lost, in one sentence."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import assert_never

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import TRAITS, ObligationKind, Trait
from compiler.logic import formula as f
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from compiler.logic.evaluation import evaluate
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.memory import RequirementCounter
from fretc.analysis.games.game import Game
from fretc.analysis.games.game_traces import GameTrace
from fretc.analysis.games.replay import broken, columns
from fretish.printer import expression
from fretish.syntax import Timing, ends_with_run, stop

_MOST_TERMS = 3
"""Maximum number of alternatives of a demand in the sentence."""
_LONGEST = 1_000
"""Maximum length of a trace whose ticks are all examined."""


def because(
    requirements: Sequence[FormalizedRequirement],
    counters: Sequence[RequirementCounter],
    game: Game,
    play: GameTrace,
) -> str:
    """What the requirements demand when the game is lost.

    Args:
        requirements: requirements of a minimal conflict.
        counters: their counters.
        game: their game.
        play: trace in which the environment wins.
    """
    details = {
        requirement.id: _details(requirement, game.alphabet, play) for requirement in requirements
    }
    if play.loop is not None:
        return _for_ever(requirements, game, play, _asked(counters, game, play), details)
    last = play.ticks - 1
    now = _asked_last(counters, game, play)
    if not now or len(requirements) == 1:
        id = requirements[0].id
        return (
            f"at tick {last} no output satisfies {id}{details[id]}, whatever the earlier "
            "outputs were"
        )
    parts: list[str] = []
    wanted = ""
    for id, words in now.items():
        verb, _, what = words.partition(" ")
        same = what == wanted and verb in ("demands", "forbids")
        parts.append(f"{id} {verb} {'it' if same else what}{details[id]}")
        wanted = what
    silent = _asked([counter for counter in counters if counter.id not in now], game, play)
    before = [each for id, words in silent.items() for each in _before(id, words)]
    return f"at tick {last} {_joined(parts)}{''.join(f'; {each}' for each in before)}"


def _asked_last(
    counters: Sequence[RequirementCounter], game: Game, play: GameTrace
) -> dict[str, str]:
    """Id → outputs that the requirement demands at the last tick, in words."""
    inputs = {number: play.runs[-1][0][number] for number in game.alphabet.inputs}
    known = bdd.point({**play.state, **inputs})
    words = {counter.id: _words(bdd.at(counter.safe, known), game) for counter in counters}
    return {id: each for id, each in words.items() if each}


def _asked(
    counters: Sequence[RequirementCounter], game: Game, play: GameTrace
) -> Mapping[str, tuple[str, ...]]:
    """Id → outputs that the requirement demands at each tick, in words; empty for a long trace."""
    if not counters or play.ticks > _LONGEST:
        return {}
    states = [game.transition.start]
    for letter in play.letters[:-1]:
        states.append(game.transition.next(bdd.point({**states[-1], **letter})))
    inputs = [{n: letter[n] for n in game.alphabet.inputs} for letter in play.letters]
    known = [bdd.point({**state, **each}) for state, each in zip(states, inputs, strict=True)]
    return {
        counter.id: tuple(_words(bdd.at(counter.safe, tick), game) for tick in known)
        for counter in counters
    }


def _before(id: str, words: Sequence[str]) -> Iterator[str]:
    """The last demand of a requirement for outputs."""
    ticks = [tick for tick, each in enumerate(words) if each]
    if ticks:
        first = last = ticks[-1]
        while first and words[first - 1] == words[last]:
            first -= 1
        yield f"{id} {words[last]} at {_span(first, last)}"


def _span(first: int, last: int) -> str:
    return f"tick {last}" if first == last else f"ticks {first} to {last}"


def _joined(parts: Sequence[str]) -> str:
    return ", and ".join(part for part in (", ".join(parts[:-1]), *parts[-1:]) if part)


def _details(requirement: FormalizedRequirement, alphabet: Alphabet, play: GameTrace) -> str:
    """` (since tick 3, by tick 5)` for the obligation that is open at the last tick; or nothing."""
    begun, last = _begun(requirement, alphabet, play), play.ticks - 1
    words = [] if begun in (None, last) else [f"since tick {begun}"]
    if play.loop is None:
        words.extend(_limit(requirement, alphabet, begun, last))
    return f" ({', '.join(words)})" if words else ""


def _limit(
    requirement: FormalizedRequirement, alphabet: Alphabet, begun: int | None, last: int
) -> Iterator[str]:
    """Duration or end of the obligation that began at a tick, if it is known."""
    scope = requirement.sentence.scope
    demand = requirement.demanded.demand
    match demand.kind:
        case ObligationKind.WITHIN:
            if begun is not None and begun < last == begun + demand.ticks:
                yield f"by tick {last}"
        case ObligationKind.FOR:
            kind = scope.kind if scope else None
            if begun is not None and demand.ticks and ends_with_run(kind):
                yield f"up to tick {begun + demand.ticks}"
        case ObligationKind.UNTIL:
            yield f"until `{_stop(requirement.written.timing)}`"
            names = f.atoms(demand.stop)
            inputs = {alphabet.labels.get(number) for number in alphabet.inputs}
            if names and inputs.issuperset(names):
                yield "which the environment withholds"
        case ObligationKind.BEFORE:
            yield f"before `{_stop(requirement.written.timing)}`"
        case (
            ObligationKind.IMMEDIATELY
            | ObligationKind.NEXT
            | ObligationKind.FINALLY
            | ObligationKind.EVENTUALLY
            | ObligationKind.ALWAYS
        ):
            return
        case ObligationKind.AFTER | ObligationKind.NOT_AFTER:
            return
        case _:
            assert_never(demand.kind)


def _stop(timing: Timing) -> str:
    condition = stop(timing)
    assert condition is not None
    return expression(condition)


def _begun(requirement: FormalizedRequirement, alphabet: Alphabet, play: GameTrace) -> int | None:
    """Tick at which the obligation began that is open at the last tick, or None."""
    if requirement.sentence.condition is None:
        return None
    signals = (requirement.watch.trigger, requirement.watch.obligation_pending)
    atoms = dict.fromkeys(name for signal in signals for name in f.atoms(signal))
    known = columns(alphabet, play.runs, atoms)
    ticks = play.ticks
    trigger, obligation_pending = (evaluate(signal, known, ticks) for signal in signals)
    if (
        Trait.FORBIDS in TRAITS[requirement.demanded.demand.kind]
    ):  # The open obligation is that of the newest trigger.
        return trigger.bit_length() - 1 if trigger else None
    settled = ~obligation_pending & ((1 << ticks - 1) - 1)
    tick = settled.bit_length()
    stretch = trigger >> tick << tick
    if not stretch:
        return None
    return (
        stretch.bit_length() - 1
        if requirement.watch.renewed
        else (stretch & -stretch).bit_length() - 1
    )


def _for_ever(
    requirements: Sequence[FormalizedRequirement],
    game: Game,
    play: GameTrace,
    asked: Mapping[str, Sequence[str]],
    details: Mapping[str, str],
) -> str:
    assert play.loop is not None
    lost = broken(requirements, game.alphabet, play)
    others = [requirement.id for requirement in requirements if requirement.id not in lost]
    open_ = listed([f"{id}{details[id]}" for id in lost])
    again = _span(play.loop, play.ticks - 1)
    always = {id: set(asked[id][play.loop :]) for id in others if id in asked}
    if always and all(len(words) == 1 and any(words) for words in always.values()):
        why = f", because {listed([f'{id} {words.pop()}' for id, words in always.items()])}"
    else:
        verb = "is" if len(others) == 1 else "are"
        why = f", as long as {listed(others)} {verb} satisfied" if others else ""
    verb = "is" if len(lost) == 1 else "are"
    return f"{open_} {verb} never met{why}: the environment repeats {again} for ever"


def _words(asked: Function, game: Game) -> str:
    """Outputs that a requirement demands, in words; empty: any."""
    if asked == bdd.true():
        return ""
    if asked & game.reachable == bdd.false():
        return "cannot be satisfied by any output"
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
