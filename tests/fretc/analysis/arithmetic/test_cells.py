"""Comparisons as letters: against all numbers of small ranges, and against monitors."""

import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import pytest
import spot

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.targets.python import monitor as target
from fretc.analysis.analysis import AnalysisOptions, analyze
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arithmetic import cells
from fretc.analysis.findings import RealizabilityVerdict
from fretc.analysis.games.game_traces import Counterstrategy
from fretc.analysis.realizability_problem import RealizabilityProblem, stage
from fretc.analysis.verdicts import verdict
from fretish.bindings.declarations import Variable
from monitors.loading import load
from tests.effort import FULL, some
from tests.fretc.analysis.games.strategies import Strategy
from tests.requirement_sets import analyzed, requirement, requirements, roles, staged

REALIZABLE, UNREALIZABLE = RealizabilityVerdict.REALIZABLE, RealizabilityVerdict.UNREALIZABLE
ENDLESS = Budget(float("inf"))
BITS = {"i": 2, "j": 1, "o": 2, "u": 1}
"""Variables of drawn sets: whole numbers of so many bits."""
SIZES = {**BITS, "p": 2}
ROLES = roles(["i", "j"], ["o", "u"])
TIMINGS = (
    "immediately",
    "always",
    "eventually",
    "within 2 ticks",
    "at the next timepoint",
    "for 1 tick",
)
SETS = range(16) if FULL else range(6, 16, 2)
"""Seeds of drawn sets; those that are left out by default take longest."""


def whole(found: FormalizedRequirement) -> FormalizedRequirement:
    """The requirement, with all of its variables declared as whole numbers."""
    declared = {name: Variable(name, type="integer") for name in found.variables}
    return replace(found, glossary=declared)


def ranges(names: str) -> str:
    return " & ".join(f"{name} >= 0 & {name} < {2 ** BITS[name]}" for name in names)


def comparison(choose: random.Random, names: Sequence[str] = (*BITS,)) -> str:
    left, right = choose.sample(names, 2)
    factor = choose.choice(["", "2 * "])
    term = choose.choice([left, f"{factor}{left} - {right}", f"{left} + {right}"])
    return f"{term} {choose.choice(['<', '<=', '=', '!=', '>', '>='])} {choose.randint(-1, 4)}"


def drawn(seed: int, names: Sequence[str] = (*BITS,)) -> tuple[list[str], dict[str, str]]:
    """Sentences over atoms c0, c1, ..., and the comparison for which each of these stands."""
    choose = random.Random(seed)
    meant = {f"c{k}": comparison(choose, names) for k in range(choose.randint(2, 3))}

    def literal() -> str:
        return choose.choice(["", "!"]) + choose.choice([*meant])

    def sentence() -> str:
        condition = choose.choice(["", f"whenever {literal()}", f"upon {literal()}"])
        timing = choose.choice(TIMINGS)
        return f"{condition} the sw shall {timing} satisfy {literal()} | {literal()}"

    return [sentence() for _ in range(choose.randint(1, 4))], meant


def written(sentence: str, meant: Mapping[str, str]) -> str:
    for name, text in meant.items():
        sentence = sentence.replace(f"!{name}", f"!({text})").replace(name, f"({text})")
    return sentence


def synthesized(
    sentences: Sequence[str], meant: Mapping[str, str], links: str = "1", outputs: str = "ou"
) -> bool:
    """What Spot says, with each number as its bits."""
    text = " & ".join(f"({printing.future(requirement('R', s).ft_infinite)})" for s in sentences)
    for name, comparison in meant.items():
        text = text.replace(name, f"({in_bits(comparison)})")
    bits = [f"{name}{k}" for name in outputs for k in range(SIZES[name])]
    return bool(spot.solve_game(spot.ltl_to_game(f"{text} & {links}", bits)))


def in_bits(comparison: str) -> str:
    names = [name for name in SIZES if name in comparison]
    terms = []
    python = comparison.replace(" = ", " == ")
    for values in product(*(range(2 ** SIZES[name]) for name in names)):
        numbers = dict(zip(names, values, strict=True))
        if eval(python, {}, dict(numbers)):
            bits = [(n, k, numbers[n] >> k & 1) for n in names for k in range(SIZES[n])]
            terms.append(" & ".join(f"{'' if on else '!'}{n}{k}" for n, k, on in bits))
    return " | ".join(terms) or "0"


def staged_numbers(sentences: Sequence[str], meant: Mapping[str, str]) -> RealizabilityProblem:
    texts = [written(each, meant) for each in sentences]
    texts.append(f"the sw shall always satisfy {ranges('ou')}")
    assumed = whole(requirement("A1", f"the op shall always satisfy {ranges('ij')}"))
    return stage([whole(each) for each in requirements(*texts)], [assumed], ROLES)


def setting(seed: int) -> RealizabilityProblem:
    return staged_numbers(*drawn(seed))


@pytest.mark.slow
def test_the_tick_before_gives_no_wrong_verdict() -> None:
    """`p` is the value that i or o had; for Spot an output whose bits are linked to theirs."""
    answers = []
    for seed in range(8) if FULL else (0, 2, 6, 7):
        sentences, meant = drawn(seed, "ioup")
        of = "io"[seed % 2]
        links = " & ".join(f"!p{k} & G(X p{k} <-> {of}{k})" for k in range(2))
        past = {name: text.replace("p", f"preInt(0, {of})") for name, text in meant.items()}
        found, _ = verdict(staged_numbers(sentences, past), Budget(60))
        if found.verdict is not RealizabilityVerdict.NOT_CHECKED:
            is_realizable = synthesized(sentences, meant, links, "oup")
            assert (found.verdict is REALIZABLE) is is_realizable, (sentences, past)
        answers.append(found.verdict)
    for each in (REALIZABLE, UNREALIZABLE):
        assert answers.count(each) > (1 if FULL else 0)


@pytest.mark.slow
def test_cells_are_all_numbers() -> None:
    """The verdict is Spot's for all numbers one by one; plays and strategies win in numbers."""
    lost = 0
    for seed in SETS:
        found = setting(seed)
        game = found.game(found.arena.counters, ENDLESS)
        assert not found.arena.beyond
        assert not found.arena.alphabet.uncertainties
        is_realizable = game.solution().is_realizable
        assert is_realizable is synthesized(*drawn(seed)), drawn(seed)
        if is_realizable:
            assert_won(found, random.Random(seed))
        else:
            assert_lost(found)
            lost += 1
    assert len(SETS) // 5 < lost < len(SETS) * 4 // 5


def assert_lost(found: RealizabilityProblem) -> None:
    """The environment's numbers keep its promise, and the system's break something at the end."""
    game = found.game(found.arena.counters, ENDLESS)
    play = Counterstrategy(game, game.solution(traps=True), ENDLESS).play()
    rounds = 1 if play.loop is None else 3
    letters = [*play.letters, *(play.letters[play.loop :] * (rounds - 1))]
    verdicts = stepped(found, [found.arena.alphabet.values(letter) for letter in letters])
    *before, last = verdicts
    assert not any("violated" in each.values() for each in before)
    assert last.get("A1") != "violated"
    assert ("violated" in last.values()) is (play.loop is None)


def assert_won(found: RealizabilityProblem, choose: random.Random) -> None:
    """The numbers of a strategy break nothing."""
    game = found.game(found.arena.counters, ENDLESS)
    strategy = Strategy(game, game.solution())
    place, ticks = strategy.start, []
    for _ in range(12):
        inputs: dict[int, bool] = {}
        options = strategy.legal(place)
        for bit in found.arena.alphabet.inputs:
            wish = choose.random() < 0.5
            inputs[bit] = wish if options & bdd.literal(bit, wish) != bdd.false() else not wish
            options = options & bdd.literal(bit, inputs[bit])
        outputs, place = strategy.reply(place, inputs)
        ticks.append(found.arena.alphabet.values({**inputs, **outputs}))
    for verdicts in stepped(found, ticks):
        if verdicts.get("A1") == "violated":
            return  # the environment has broken its promise
        assert "violated" not in verdicts.values()


def stepped(found: RealizabilityProblem, ticks: Sequence[Tick]) -> list[dict[str, str]]:
    """Tick by tick the verdicts of the requirements and of the promise."""
    machine: Any = load("monitor.py", target.text(*found.requirements, *found.assumptions))
    verdicts = []
    for tick in ticks:
        machine.step(**tick)
        pairs = zip(machine.REQUIREMENTS, machine.verdicts(), strict=True)
        verdicts.append({requirement.id: str(verdict) for requirement, verdict in pairs})
    return verdicts


# Published and written sets ---------------------------------------------------------------------


def test_a_play_has_numbers() -> None:
    found = analyzed(
        "whenever t > 30 the sw shall within 2 ticks satisfy v > t + 1",
        "whenever t > 20 the sw shall immediately satisfy v >= 25 & v <= 31",
        roles=roles(["t"], ["v"]),
    )
    (conflict,) = found.conflicts
    assert conflict.requirements == ("R1", "R2")
    assert conflict.because == (
        "at tick 2 R1 demands `(v > (t + 1))` (since tick 0, by tick 2), and R2 demands "
        "`(v >= 25)` and `(v <= 31)`"
    )
    for tick in conflict.play:
        assert isinstance(tick["t"], int | float)
        assert tick["t"] > 30 or conflict.play[0]["t"] != tick["t"]
    assert found.terms[-1].startswith("numbers are")


@pytest.mark.slow
@pytest.mark.parametrize("ticks", [10, 5_000 if FULL else 1000])
def test_a_long_play_has_numbers_as_a_short_one_has(ticks: int) -> None:
    """The longer one is of requirements that are looked at by themselves, and leaps."""
    sentences = (
        f"whenever t > 30 the sw shall within {ticks} ticks satisfy v > t + 1",
        f"whenever t > 20 the sw shall for {ticks + 1} ticks satisfy v <= 31",
    )
    named = roles(["t"], ["v"])
    found = analyze(requirements(*sentences), named, (), AnalysisOptions(repairs=False))
    assert found.verdict is UNREALIZABLE
    assert found.complete
    (conflict,) = found.conflicts
    assert len(conflict.play) == ticks + 1
    pairs = [(float(tick["t"]), float(tick["v"])) for tick in conflict.play]
    assert pairs[0][0] > 30
    assert all(v <= min(31, t + 1) for t, v in pairs[:-1])
    t, v = pairs[-1]
    assert not t + 1 < v <= 31


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sum_", "answer"),
    some([("<= 20", REALIZABLE), ("< 20", UNREALIZABLE), ("!= 7", UNREALIZABLE)], 2),
)
def test_what_the_system_can_reach_depends_on_the_inputs(
    sum_: str, answer: RealizabilityVerdict
) -> None:
    """Two pumps give what is asked of them, up to 10 each, where no more than 20 is asked."""
    found = analyzed(
        f"the sw shall always satisfy (v + w {sum_}) & v >= 0 & w >= 0 & v <= 10 & w <= 10",
        "whenever t >= 0 & t <= 20 the sw shall immediately satisfy v + w = t",
        roles=roles(["t"], ["v", "w"]),
    )
    assert found.verdict is answer


@pytest.mark.parametrize("type_", ["integer", "double"])
def test_whole_numbers_stay_whole(type_: str) -> None:
    """Between 2 and 3 there is no whole number."""
    found = requirement("R1", "whenever a the sw shall immediately satisfy v > 2 & v < 3")
    declared = replace(found, glossary={"v": Variable("v", type=type_)})
    answer = analyze([declared], roles(["a"], ["v"])).verdict
    assert answer is (UNREALIZABLE if type_ == "integer" else REALIZABLE)


def test_opposites_share_a_bit() -> None:
    sentence = "the sw shall always satisfy (v < 3 | v >= 3) & !(v < 3 & 3 <= v)"
    found = staged(sentence, roles=roles([], ["v"]))
    assert len(found.arena.alphabet.outputs) == 1


def test_what_is_not_linear_is_not_checked() -> None:
    named = roles(["t"], ["v"])
    found = analyzed("whenever t > 1 the sw shall immediately satisfy v * t > 1", roles=named)
    assert found.verdict is RealizabilityVerdict.NOT_CHECKED
    assert found.why == "R1: `((v * t) > 1)` is not linear"


@pytest.mark.slow
def test_too_many_patterns_are_not_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Here 2^(count + 1), where half as many are not too many."""
    count = 12 if FULL else 6
    assert cells.MOST == 2**12
    monkeypatch.setattr(cells, "MOST", 2**count)
    for more, answer in ((0, REALIZABLE), (1, RealizabilityVerdict.NOT_CHECKED)):
        many = " & ".join(f"v{i} + v{i + 1} > {i}" for i in range(count + more))
        found = analyzed(
            f"whenever t > 1 the sw shall immediately satisfy {many}",
            roles=roles(["t"], [f"v{i}" for i in range(14)]),
        )
        assert found.verdict is answer, found.why
    assert f"have more than {2**count} patterns" in found.why


def thresholds(count: int) -> list[str]:
    """An alarm for each threshold of one signal; a higher alarm has all lower ones with it."""
    return [
        *(f"whenever t > {n} the sw shall immediately satisfy x{n}" for n in range(count)),
        *(f"the sw shall always satisfy x{n + 1} -> x{n}" for n in range(count - 1)),
    ]


@pytest.mark.slow
def test_many_thresholds_of_one_signal_cost_in_proportion() -> None:
    nodes = []
    for count in (12, 24, 48):
        found = staged(*thresholds(count), roles=roles(["t"], [f"x{n}" for n in range(count)]))
        game = found.game(found.arena.counters, ENDLESS)
        assert game.solution().is_realizable
        nodes.append(bdd.size(game.safe))
    assert nodes[2] - nodes[1] < 2.5 * (nodes[1] - nodes[0]), nodes


@pytest.mark.slow
def test_a_conflict_among_many_thresholds_is_found() -> None:
    sentences = [*thresholds(30), "the sw shall never satisfy x20"]
    found = analyzed(*sentences, roles=roles(["t"], [f"x{n}" for n in range(30)]))
    assert found.verdict is UNREALIZABLE
    assert ("R21", "R60") in {conflict.requirements for conflict in found.conflicts}
    above = next(each for each in found.conflicts if each.requirements == ("R21", "R60"))
    assert above.play[-1]["t"] > 20  # type: ignore[operator]
