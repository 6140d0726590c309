"""When the completions of a run show a formula, against every completion and the definition."""

from __future__ import annotations

from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from compiler.logic import completions
from compiler.logic import formula as f
from compiler.logic.completions import FirstTicks, first_ticks
from compiler.logic.definition import holds
from monitors.kernel import Column
from tests.monitoring import packed
from tests.strategies import past_formulas, three_valued

Runs = list[dict[str, bool | None]]


def by_definition(formula: f.Formula, run: Runs, counted: int) -> FirstTicks:
    """Every completion is made, and looked through tick by tick."""
    unknown = [(tick, name) for tick, row in enumerate(run) for name in row if row[name] is None]
    firsts = []
    for values in product((False, True), repeat=len(unknown)):
        whole = [{name: bool(value) for name, value in row.items()} for row in run]
        for (tick, name), value in zip(unknown, values, strict=True):
            whole[tick][name] = value
        ticks = (at for at in range(len(run)) if counted >> at & 1 and holds(formula, whole, at))
        firsts.append(next(ticks, None))
    some = [tick for tick in firsts if tick is not None]
    return FirstTicks(min(some, default=None), None if None in firsts else max(some))


@given(past_formulas, three_valued("a", "b", max_size=4), st.integers(0, 15))
def test_some_and_all_are_those_of_the_completions(
    formula: f.Formula, run: Runs, counted: int
) -> None:
    ticks, columns = packed({name: [row[name] for row in run] for name in ("a", "b")})
    assert first_ticks(formula, columns, ticks, counted) == by_definition(formula, run, counted)


def test_a_run_without_a_tick_shows_nothing() -> None:
    assert first_ticks(f.TRUE, {}, 0, -1) == FirstTicks(None, None)


def test_each_completion_may_show_it_at_another_tick() -> None:
    rises = f.and_(f.Atom("a"), f.previous(f.not_(f.Atom("a"))))
    assert first_ticks(rises, {"a": Column(0b100, 0b010)}, 3, -1) == FirstTicks(1, 2)


def test_a_search_that_takes_too_long_is_given_up() -> None:
    """The memory of each unknown value of a long window has a state of its own."""
    window = f.since(f.Atom("a"), f.Atom("b"), f.Interval(40, 60))
    every = (1 << 100) - 1
    columns = {"a": Column(every, 0), "b": Column(0, every)}
    assert first_ticks(window, columns, 100, every) is None
    assert first_ticks(f.Atom("a"), columns, 100, every) == FirstTicks(0, 0)
    many = completions.MOST_STEPS + 1
    assert first_ticks(f.Atom("a"), {"a": Column(0, 0)}, many, -1) is None


def test_more_unknown_values_at_a_tick_than_can_be_tried_take_no_memory() -> None:
    atoms = [f.Atom(f"a{number}") for number in range(60)]
    columns = {atom.name: Column(0, 1) for atom in atoms}
    assert first_ticks(f.and_(*atoms), columns, 1, 1) is None
