"""Facts against the reference automaton, on random words of every template."""

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import pytest

from compiler.formalization import reference
from compiler.formalization.obligation import ObligationKind
from compiler.formalization.reference import ReferenceState, step, tick_role
from compiler.logic import formula as f
from compiler.logic.evaluation import evaluate
from compiler.situations.tick_predicates import TickPredicates, tick_predicates
from fretish.syntax import ConditionKind
from tests import meaning
from tests.emitting import requirement
from tests.strategies import Template, few_templates

Row = Mapping[str, bool]
LETTERS = "mpqs"


@dataclass(frozen=True)
class Tick:
    """One tick of a run of the reference automaton, unbroken before."""

    number: int
    row: Row
    before: ReferenceState
    after: ReferenceState | None


def ticks(counted: reference.Template, rows: Sequence[Row]) -> Iterator[Tick]:
    """Up to and including the first that breaks the sentence."""
    state: ReferenceState | None = reference.initial(counted)
    for number, row in enumerate(rows):
        assert state is not None
        after = step(counted, state, *(row[name] for name in LETTERS))
        yield Tick(number, row, state, after)
        if after is None:
            return
        state = after


def words(drawn: Template) -> Iterator[list[Row]]:
    choose = random.Random(repr(drawn))
    for length in (4, 12, 24):
        for likely in (0.2, 0.5, 0.8):
            odds = {"m": 0.6, "p": 0.4, "q": likely, "s": 0.2}
            yield [{name: choose.random() < odds[name] for name in LETTERS} for _ in range(length)]


class Run:
    """A word beside what the facts say of it."""

    def __init__(self, known: TickPredicates, rows: Sequence[Row]) -> None:
        self.length = len(rows)
        self.columns = {
            name: sum(row[name] << tick for tick, row in enumerate(rows)) for name in LETTERS
        }
        self.known = known
        self._shown: dict[int, tuple[f.Formula, int]] = {}

    def has(self, fact: f.Formula, tick: int) -> bool:
        """A formula is known by its identity, and kept so that no other has it."""
        if id(fact) not in self._shown:
            self._shown[id(fact)] = fact, evaluate(fact, self.columns, self.length)
        return bool(self._shown[id(fact)][1] >> tick & 1)


def changed(counted: reference.Template, tick: Tick, letter: str) -> bool:
    """Whether the value of a letter decides what is demanded after the tick, or where it lies."""

    def result(value: bool) -> object:
        row = {**tick.row, letter: value}
        after = step(counted, tick.before, *(row[name] for name in LETTERS))
        if after is None:
            return None
        return after.phase if letter == "m" else after.counted

    return result(True) != result(False)


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_facts_are_those_of_the_definition(scope: str) -> None:
    for drawn in (each for each in few_templates() if each.scope == scope):
        made = requirement(drawn.sentence)
        counted = reference.template(made.sentence, made.ticks or 0)
        for known in (tick_predicates(made), tick_predicates(made, exact=True)):
            distances = [distance(known, counted, back) for back in range(counted.ticks + 2)]
            for rows in words(drawn):
                run = Run(known, rows)
                for tick in ticks(counted, rows):
                    assert_same(counted, run, tick)
                    assert_distances(counted, run, tick, distances)


def assert_same(counted: reference.Template, run: Run, tick: Tick) -> None:
    known, at = run.known, tick.number
    found = tick_role(counted, tick.before, tick.row["m"], tick.row["p"])
    assert run.has(known.inside, at) is found.enforced
    assert run.has(known.triggered, at) is found.triggered
    assert run.has(known.ended, at) is (ended(tick, counted) and at > 0)
    was_open = found.enforced and tick.before.counted != 0
    assert run.has(known.was_open, at) is was_open
    assert run.has(known.waiting, at) is (was_open or found.triggered)
    if tick.after is not None:
        assert run.has(known.open, at) is (tick.after.counted != 0)
    assert_asked(counted, run, tick)


def ended(tick: Tick, counted: reference.Template) -> bool:
    enforced = (reference.Phase.INSIDE, reference.Phase.LAST_RUN)
    here = tick_role(counted, tick.before, tick.row["m"], tick.row["p"]).enforced
    return tick.before.phase in enforced and not here


def assert_asked(counted: reference.Template, run: Run, tick: Tick) -> None:
    """What decides is what changes something; nothing is said of runs that are lost already."""
    known, at = run.known, tick.number
    enforced = tick_role(counted, tick.before, tick.row["m"], tick.row["p"]).enforced
    if known.demand.kind is ObligationKind.AFTER and tick.before.counted < 0:
        return  # two demands clash
    if enforced:
        assert run.has(known.asks_for_condition, at) is (
            counted.condition is not None and changed(counted, tick, "p")
        ), (counted, tick)
        assert run.has(known.asks_for_answer, at) is changed(counted, tick, "q"), (counted, tick)
    else:
        assert not run.has(known.asks_for_condition, at)
        assert not run.has(known.asks_for_answer, at)


def distance(known: TickPredicates, counted: reference.Template, back: int) -> f.Formula | None:
    """The trigger that counts lies so far back; None where the automaton does not tell."""
    if known.demand.kind in (ObligationKind.WITHIN, ObligationKind.AFTER):
        return known.oldest(back)
    if known.demand.kind is ObligationKind.FOR and back <= counted.ticks:
        return known.newest(back)
    return None


def assert_distances(
    counted: reference.Template, run: Run, tick: Tick, distances: Sequence[f.Formula | None]
) -> None:
    count = tick.before.counted
    found = tick_role(counted, tick.before, tick.row["m"], tick.row["p"])
    newest = run.known.demand.kind is ObligationKind.FOR
    for back, formula in enumerate(distances):
        if formula is None:
            continue
        if back == 0:
            expected = found.triggered and (newest or not count)
        elif newest:
            expected = found.enforced and not found.triggered
            expected = expected and count == counted.ticks + 1 - back
        else:
            expected = found.enforced and abs(count) == back
        assert run.has(formula, tick.number) is expected


def test_a_condition_that_cannot_trigger_again_is_not_asked_for() -> None:
    known = tick_predicates(requirement("upon p the sw shall within 2 ticks satisfy q"))
    assert known.whole.condition is ConditionKind.TRIGGER
    rows = [{"m": False, "p": True, "q": True, "s": False}] * 3
    run = Run(known, rows)
    assert [run.has(known.triggered, at) for at in range(3)] == [True, False, False]
    assert not any(run.has(known.asks_for_condition, at) for at in (1, 2))
