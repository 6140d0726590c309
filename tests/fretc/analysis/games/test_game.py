"""The game against Spot's synthesis, and both players' ways to win against the monitors."""

import random
from collections.abc import Sequence

import pytest

from compiler.logic.diagrams.decision_diagrams import Function
from compiler.logic.formula import atoms
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.games import game_traces, squaring
from fretc.analysis.games.game import Game, Letter
from fretc.analysis.games.game_traces import Counterstrategy
from fretc.analysis.games.replay import broken, columns
from fretc.analysis.realizability_problem import RealizabilityProblem
from tests.effort import FULL
from tests.fretc.analysis.games.strategies import Place, Strategy, first_breaches
from tests.requirement_sets import (
    assumed,
    drawn,
    requirement,
    roles,
    satisfiable,
    staged,
    synthesized,
)
from tests.spot_oracle import holds_on

SETS = 5_000 if FULL else 32
"""With `--hypothesis-profile=full` it takes two minutes."""
ENDLESS = Budget(float("inf"))


def assert_lost(setting: RealizabilityProblem) -> None:
    """The environment's play breaks something, at its last tick or by never meeting it."""
    game = setting.game(setting.arena.counters, ENDLESS)
    play = Counterstrategy(game, game.solution(traps=True), ENDLESS).play()
    alphabet, letters = setting.arena.alphabet, play.letters
    assert broken(setting.requirements, alphabet, play), play
    assert not broken(setting.assumptions, alphabet, play), play
    breaches = first_breaches(setting.requirements, known(setting, letters), len(letters))
    earlier = {tick for tick in breaches.values() if tick is not None} - {len(letters) - 1}
    assert not earlier, "a play ends with the first violation"


def known(setting: RealizabilityProblem, letters: Sequence[Letter]) -> dict[str, int]:
    names = {
        name
        for requirement in setting.requirements
        for s in requirement.watch.signals
        for name in atoms(s)
    }
    return columns(setting.arena.alphabet, [(letter, 1) for letter in letters], names)


def assert_won(setting: RealizabilityProblem, choose: random.Random) -> None:
    """The system's strategy breaks nothing, and meets its liveness where inputs go round."""
    alphabet = setting.arena.alphabet
    game = setting.game(setting.arena.counters, ENDLESS)
    strategy = Strategy(game, game.solution())
    place, letters = strategy.start, []
    for _ in range(12):
        inputs = {bit: choose.random() < 0.5 for bit in alphabet.inputs}
        outputs, place = strategy.reply(place, inputs)
        letters.append({**inputs, **outputs})
    again = [{bit: choose.random() < 0.5 for bit in alphabet.inputs} for _ in range(2)]
    begins: dict[Place, int] = {}
    while place not in begins:
        begins[place] = len(letters)
        for inputs in again:
            outputs, place = strategy.reply(place, inputs)
            letters.append({**inputs, **outputs})
    ticks = [alphabet.values(letter) for letter in letters]
    values = [{name: bool(value) for name, value in tick.items()} for tick in ticks]
    loop = begins[place]
    for each in setting.requirements:
        assert holds_on(each.ft_infinite, values[:loop], values[loop:]), each.entry.wording


@pytest.mark.slow
def test_the_game_is_spot_s_and_both_players_do_win() -> None:
    lost = 0
    for seed in range(SETS):
        setting = staged(*drawn(seed))
        is_realizable = setting.game(setting.arena.counters, ENDLESS).solution().is_realizable
        assert is_realizable is synthesized(setting.requirements), drawn(seed)
        if is_realizable:
            assert_won(setting, random.Random(seed))
        else:
            assert_lost(setting)
            lost += 1
    assert SETS / 8 < lost < SETS / 2, "both verdicts come often"


@pytest.mark.slow
def test_leaps_over_many_ticks_change_no_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    """Here they begin at once, where they never do with such small bounds."""
    monkeypatch.setattr(squaring.IterativeSquaring, "is_due", lambda self: True)
    monkeypatch.setattr(game_traces, "_LONG", 0)
    leaps, surviving = 0, Game.surviving

    def counted(game: Game, states: Function, inputs: Letter) -> Function:
        nonlocal leaps
        found = surviving(game, states, inputs)
        leaps += found != states
        return found

    monkeypatch.setattr(Game, "surviving", counted)
    for seed in range(SETS // 2):
        sentences, given = (
            drawn(("leap", seed), most=4),
            [assumed(("leap", seed))] if seed % 2 else [],
        )
        setting = staged(*sentences, assumed=given)
        assumptions = [requirement("A1", sentence) for sentence in given]
        if given and not satisfiable(assumptions):
            continue
        is_realizable = setting.game(setting.arena.counters, ENDLESS).solution().is_realizable
        assert is_realizable is synthesized(setting.requirements, assumptions), (sentences, given)
        if not is_realizable:
            assert_lost(setting)
        elif not given:
            assert_won(setting, random.Random(seed))
    assert leaps > SETS / 20


@pytest.mark.slow
def test_what_inputs_are_assumed_to_keep_is_an_implication_to_spot() -> None:
    found = {True: 0, False: 0}
    for seed in range(SETS // 2):
        sentences, given = drawn(("given", seed), most=5), [assumed((seed, i)) for i in range(2)]
        setting = staged(*sentences, assumed=given)
        assumptions = [requirement(f"A{i}", sentence) for i, sentence in enumerate(given, 1)]
        if not satisfiable(assumptions):
            continue  # nothing follows from assumptions that no run keeps
        solution = setting.game(setting.arena.counters, ENDLESS).solution(traps=True)
        assert solution.is_realizable is synthesized(setting.requirements, assumptions), (
            sentences,
            given,
        )
        found[solution.is_realizable] += 1
        if not solution.is_realizable:
            assert_lost(setting)
    assert min(found.values()) > SETS / 50


@pytest.mark.parametrize(
    "sentences",
    [
        ("whenever a the sw shall eventually satisfy x", "the sw shall never satisfy x"),
        (
            "whenever a the sw shall eventually satisfy x",
            "whenever b the sw shall always satisfy !x",
        ),
        (
            "whenever a the sw shall eventually satisfy x & y",
            "whenever b the sw shall immediately satisfy !x",
            "whenever !b the sw shall immediately satisfy !y",
        ),
    ],
)
def test_the_environment_may_win_by_waiting_for_ever(sentences: tuple[str, ...]) -> None:
    setting = staged(*sentences)
    assert not synthesized(setting.requirements)
    game = setting.game(setting.arena.counters, ENDLESS)
    play = Counterstrategy(game, game.solution(traps=True), ENDLESS).play()
    assert play.loop is not None
    assert_lost(setting)


def test_two_duties_take_turns() -> None:
    setting = staged(
        "whenever a the sw shall eventually satisfy x",
        "whenever a the sw shall eventually satisfy y",
        "the sw shall always satisfy !(x & y)",
        "whenever b the sw shall immediately satisfy !x & !y",
        "whenever b the sw shall at the next timepoint satisfy x | y",
    )
    assert not setting.game(setting.arena.counters, ENDLESS).solution().is_realizable
    kept = staged(
        "whenever a the sw shall eventually satisfy x",
        "whenever a the sw shall eventually satisfy y",
        "the sw shall always satisfy !(x & y)",
    )
    assert_won(kept, random.Random(1))


@pytest.mark.slow
def test_eight_deadlines_on_one_resource() -> None:
    """As many as fit into the shortest deadline: one tick less, and they do not."""
    names = roles([f"a{i}" for i in range(8)], [f"x{i}" for i in range(8)])
    exclusions = [f"the sw shall always satisfy !x{i} | !x{j}" for i in range(8) for j in range(i)]
    for bound, fits in ((50, True), (7, True), (6, False)):
        deadlines = [
            f"whenever a{i} the sw shall within {bound} ticks satisfy x{i}" for i in range(8)
        ]
        setting = staged(*deadlines, *exclusions, roles=names)
        game = setting.game(setting.arena.counters, Budget(20))
        assert game.solution().is_realizable is fits


def test_a_question_that_takes_too_long_says_so() -> None:
    setting = staged(
        "whenever a the sw shall within 100000 ticks satisfy x",
        "whenever b the sw shall for 100001 ticks satisfy !x",
    )
    with pytest.raises(OutOfTimeError, match="not answered within"):
        setting.game(setting.arena.counters, Budget(0.05)).solution()
