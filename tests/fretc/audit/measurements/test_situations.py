"""Which situations a run came by, against the definition of their formulas, tick by tick."""

import random
from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import pytest

from compiler.logic import formula as f
from compiler.logic.definition import holds
from compiler.situations.situations import Situation, situations
from fretc.audit.measurements.situations import SituationTicks, nowhere_known, situation_ticks
from monitors.kernel import Column
from monitors.kernel.verdicts import Truth
from tests.compiler.situations.by_index import At
from tests.each import each
from tests.effort import FULL, some
from tests.emitting import requirement
from tests.monitoring import packed
from tests.strategies import Template, templates

Row = Mapping[str, Truth]


def asked(situation: Situation, recorded: Sequence[Row]) -> list[int]:
    """The ticks that can count, from what was recorded."""
    ticks = [len(recorded) - 1] if situation.at_end else range(len(recorded))
    hole = situation.unknown
    return [tick for tick in ticks if hole is None or recorded[tick][hole] is None]


def met(
    situation: Situation, recorded: Sequence[Row], run: Sequence[Mapping[str, bool]]
) -> int | None:
    """The first tick of a run that may have been so, from the definition alone."""
    ticks = asked(situation, recorded)
    return next((tick for tick in ticks if holds(situation.formula, run, tick)), None)


def completions(run: Sequence[Row]) -> Iterator[list[dict[str, bool]]]:
    """Every run that it may have been."""
    unknown = [(tick, name) for tick, row in enumerate(run) for name in row if row[name] is None]
    for values in product((False, True), repeat=len(unknown)):
        chosen = dict(zip(unknown, values, strict=True))
        yield [
            {name: chosen[tick, name] if value is None else value for name, value in row.items()}
            for tick, row in enumerate(run)
        ]


def shown(of: Sequence[Situation], run: Sequence[Row]) -> dict[str, SituationTicks]:
    names = [*run[0]]
    ticks, columns = packed({name: [row[name] for row in run] for name in names})
    return {one.key: one for one in situation_ticks(of, columns, ticks, nowhere_known(ticks))}


def runs(drawn: Template, unknowns: int) -> Iterator[list[Row]]:
    choose = random.Random(repr(drawn))
    for length in (1, 3, 6, 9):
        run: list[dict[str, Truth]] = [
            {name: choose.random() < 0.5 for name in "mpqs"} for _ in range(length)
        ]
        for _ in range(unknowns):
            run[choose.randrange(length)][choose.choice("mpqs")] = None
        yield [*run]


@pytest.mark.slow
@each("template", [*templates((0, 2))][::8])
def test_what_is_known_is_seen_at_its_first_tick(template: Template) -> None:
    of = situations(requirement(template.sentence), exact=True)
    for run in runs(template, unknowns=0):
        (known,) = completions(run)
        expected = {one.key: SituationTicks(one.key, met(one, run, known), None) for one in of}
        assert shown(of, run) == expected


def exact(one: Situation, firsts: Sequence[int | None]) -> SituationTicks:
    """From the first tick of each completion: by when all have shown it, or some."""
    shows = [tick for tick in firsts if tick is not None]
    if shows and None not in firsts:
        return SituationTicks(one.key, max(shows), None)
    return SituationTicks(one.key, None, min(shows, default=None))


@pytest.mark.slow
@each("template", [*templates((0, 2))][4::8])
def test_seen_is_what_every_completion_shows_and_never_what_none_does(template: Template) -> None:
    of = situations(requirement(template.sentence), exact=True)
    for run in runs(template, unknowns=4 if FULL else 2):
        possible = [*completions(run)]
        expected = {one.key: exact(one, [met(one, run, each) for each in possible]) for one in of}
        assert shown(of, run) == expected


def by_table(template: Template, run: Sequence[Mapping[str, bool]]) -> dict[str, int]:
    """The first tick of each situation of a run, by lists of intervals and triggers alone."""
    columns = {name: [row[name] for row in run] for name in "mpqs"}
    ticks = [At(template, columns, at) for at in range(len(run))]
    found: dict[str, int] = {}
    for tick in ticks:
        for key in (*tick.keys(), *(tick.at_end() if tick is ticks[-1] else ())):
            found.setdefault(key, tick.at)
    return found


@pytest.mark.slow
@each("template", some(templates((0, 1, 3)), 16, 7))
def test_every_situation_is_that_of_the_table_whatever_is_unknown(template: Template) -> None:
    made = requirement(template.sentence)
    if template.scope != "null" and "m" not in made.propositions:
        return  # it is about tick 0 alone: nothing reads the mode
    of = [one for one in situations(made, exact=True) if ":" not in one.key]
    for run in runs(template, unknowns=5 if FULL else 3):
        tables = [by_table(template, completion) for completion in completions(run)]
        firsts = {one.key: [table.get(one.key) for table in tables] for one in of}
        assert shown(of, run) == {one.key: exact(one, firsts[one.key]) for one in of}, run


def test_a_proposition_without_a_column_is_unknown_throughout() -> None:
    here = Situation("here", "p", f.Atom("p"))
    gone = Situation("gone", "q", f.Atom("q"), at_end=True)
    found = situation_ticks([here, gone], {"p": Column(0b100, 0)}, 4, nowhere_known(4))
    assert [*found] == [SituationTicks("here", 2, None), SituationTicks("gone", None, 3)]


def test_a_run_without_a_tick_shows_nothing() -> None:
    always = Situation("always", "", f.TRUE)
    last = Situation("last", "", f.TRUE, at_end=True)
    found = situation_ticks([always, last], {}, 0, nowhere_known(0))
    assert [*found] == [SituationTicks("always", None, None), SituationTicks("last", None, None)]
