"""Situations: what their formulas say, which sentence has which, and that runs can come by them."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import formula as f
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.evaluation import evaluate
from compiler.situations.demands import of_demand
from compiler.situations.situations import Situation, situations
from compiler.situations.tick_predicates import tick_predicates
from fretc.analysis.arena.memory import Memory, PastMemory, RequirementCounter
from fretc.analysis.arena.transition import Transition
from tests import meaning
from tests.compiler.situations.by_index import At, kind
from tests.emitting import requirement
from tests.strategies import Template, few_templates


def of(scope: str) -> Iterator[Template]:
    return (drawn for drawn in few_templates() if drawn.scope == scope)


def timed(made: FormalizedRequirement, *, exact: bool = False) -> list[Situation]:
    """Those that are not about single operands."""
    return [each for each in situations(made, exact=exact) if ":" not in each.key]


def words(drawn: Template, lengths: Sequence[int]) -> Iterator[dict[str, list[bool]]]:
    choose = random.Random(repr(drawn))
    for length in lengths:
        for likely in (0.2, 0.5, 0.8):
            odds = {"m": choose.choice((0.3, 0.7)), "p": 0.4, "q": likely, "s": 0.2}
            yield {name: [choose.random() < odds[name] for _ in range(length)] for name in odds}


def shown(listed: Sequence[Situation], columns: Mapping[str, Sequence[bool]]) -> list[set[str]]:
    """The situations of each tick, and of a run that ends with it, as their formulas tell them."""
    length = len(columns["q"])
    bits = {name: sum(v << t for t, v in enumerate(c)) for name, c in columns.items()}
    found = {each.key: evaluate(each.formula, bits, length) for each in listed}
    return [{key for key, column in found.items() if column >> at & 1} for at in range(length)]


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_a_formula_says_what_its_words_say(scope: str) -> None:
    """Exactly, for recorded runs; for a search, demands may be left out once a deadline passed."""
    for drawn in of(scope):
        made = requirement(drawn.sentence)
        recorded, searched = timed(made, exact=True), timed(made)
        assert [each.key for each in recorded] == [each.key for each in searched]
        if drawn.scope != "null" and "m" not in made.propositions:
            assert drawn == Template("onlyAfter", "null", "immediately", 0)
            continue  # it is about tick 0 alone: nothing reads the mode
        for columns in words(drawn, (5, 10)):
            ticks = [At(drawn, columns, at) for at in range(len(columns["q"]))]
            expected = [{*tick.keys(), *tick.at_end()} for tick in ticks]
            assert shown(recorded, columns) == expected, (drawn, columns)
            found = shown(searched, columns)
            assert all(map(set.issubset, found, expected)), (drawn, columns)
            passed = deadline_passes(drawn, expected)
            assert found[: passed + 1] == expected[: passed + 1], (drawn, columns)


def deadline_passes(drawn: Template, expected: Sequence[set[str]]) -> int:
    """The first tick at which a deadline passes without an answer, or the length of the run."""
    passing = {"missed-by-one", "never-answered"}
    if kind(drawn) not in ("within", "after", "not after"):
        return len(expected)
    ticks = (at for at, keys in enumerate(expected) if keys & passing)
    return next(ticks, len(expected))


# Which runs come by them ------------------------------------------------------------------------


class Search:
    """All runs of the atoms m, p, q and s, and what a formula of the past says of them."""

    def __init__(self, formula: f.Formula) -> None:
        fresh = iter(range(10_000))
        letters = {name: next(fresh) for name in "mpqs"}
        self.memory = Memory(fresh, {})
        self.goal = PastMemory(lambda name: bdd.variable(letters[name]), self.memory).value(formula)
        self.letters = bdd.cube(letters.values())

    @property
    def bits(self) -> int:
        return len(self.memory.needed([self.goal]))

    def is_reached(self) -> bool:
        """Whether a run comes by a tick at which the formula holds: backwards from there."""
        bits = self.memory.needed([self.goal])
        steps = tuple(self.memory.steps[bit] for bit in bits)
        true = bdd.true()
        transition = Transition([RequirementCounter("", bits, steps, true, None, (), true, true)])
        found, states = bdd.false(), bdd.exists(self.goal, self.letters)
        while states != found:
            if (transition.initial & states) != bdd.false():
                return True
            found = states
            states = states | bdd.exists(transition.moved(states), self.letters)
        return False


def impossible(drawn: Template) -> set[str]:
    """What no run can show, by hand."""
    found: set[str] = set()
    if drawn.scope == "after":
        found.add("triggered-at-start")  # the mode comes first, and has to end
    n = drawn.n
    short = {"next": True, "within": n == 1, "for": n == 1, "after": n == 0, "not after": n == 0}
    if drawn.condition == "regular" and short.get(kind(drawn), False):
        found.add("triggered-while-open")  # after a trigger the condition has to be false first
    return found


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_each_situation_is_come_by_or_cannot_be(scope: str) -> None:
    for drawn in of(scope):
        listed = situations(requirement(drawn.sentence))
        missing = {each.key for each in listed if not Search(each.formula).is_reached()}
        assert missing == impossible(drawn), drawn


def test_no_key_is_given_twice() -> None:
    for drawn in few_templates((0, 2)):
        keys = [key for key, _ in of_demand(tick_predicates(requirement(drawn.sentence)))]
        assert len({*keys}) == len(keys), drawn


def test_what_a_sentence_does_not_read_is_in_none_of_its_situations() -> None:
    made = requirement("only after m mode the sw shall immediately satisfy q")
    assert [each.key for each in situations(made)] == [
        "answered-at-once",
        "missed-by-one",
        "unknown:response:q",
    ]


def test_a_sentence_that_looks_ahead_has_none() -> None:
    assert situations(requirement("whenever p the sw shall always satisfy occurs(2, q)")) == ()


def test_a_predicate_that_looks_back_is_read_as_it_is() -> None:
    """The condition holds from tick 2 on, where p has held for three ticks."""
    made = requirement("whenever persisted(2, p) the sw shall within 1 tick satisfy q")
    listed = {each.key: each.formula for each in situations(made)}
    at_last_tick = evaluate(listed["answered-at-last-tick"], {"p": 0b1111, "q": 0b1000}, 4)
    assert at_last_tick == 0b1000
    assert evaluate(listed["unknown:response:q"], {"p": 0b1111, "q": 0}, 4) == 0b1100


@pytest.mark.slow
@pytest.mark.parametrize("condition", ["", "upon p", "whenever p"])
@pytest.mark.parametrize("timing", ["within", "for", "after"])
@pytest.mark.parametrize("scope", ["", "in m mode", "only in m mode"])
def test_a_long_bound_costs_bits_and_not_ticks(scope: str, timing: str, condition: str) -> None:
    made = requirement(f"{scope} {condition} the sw shall {timing} 10000 ticks satisfy q")
    assert max(Search(each.formula).bits for each in situations(made)) <= 3 * 14 + 10
