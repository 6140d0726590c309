"""Stepping generated monitors: pieces, unknowns, checkpoints, and what a mistake leaves behind."""

import itertools
import json
import random
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from compiler.targets.python import monitor as target
from compiler.targets.python.names import MOST_PARAMETERS
from fretish.clock import Clock
from monitors.kernel import Monitor, evaluate
from monitors.kernel.outcomes import stepped as run_by_steps
from monitors.kernel.verdicts import Truth
from monitors.loading import load
from tests.effort import FULL
from tests.monitoring import emitted, monitor, packed, requirement, step

WINDOW = "sw shall always satisfy (p | occurred(2, 5, q))"
SENTENCES = (
    "whenever p sw shall within 3 ticks satisfy q",
    "in m mode, upon p sw shall after 2 ticks satisfy q",
    "only in m mode whenever p sw shall after 3 ticks satisfy q",
    "upon p sw shall for 2 ticks satisfy q",
    WINDOW,
)
Rows = list[tuple[Truth, ...]]


def rows(machine: Monitor, count: int, seed: int, unknown: float = 0.1) -> Rows:
    choose = random.Random(seed)
    width = len(machine.PROPOSITIONS)

    def value() -> Truth:
        return None if choose.random() < unknown else choose.random() < 0.4

    return [tuple(value() for _ in range(width)) for _ in range(count)]


def outputs(machine: Monitor) -> tuple[object, ...]:
    return machine.tick, machine.verdicts(), machine.statuses(), step(machine), machine.state()


@pytest.mark.slow
@pytest.mark.parametrize("sentence", SENTENCES)
@pytest.mark.parametrize("unknown", [0.0, 0.001, 0.3])
def test_a_run_is_its_steps_however_it_is_cut(sentence: str, unknown: float) -> None:
    whole, single, pieces = (monitor(sentence) for _ in range(3))
    table = rows(whole, 9_000, 3, unknown)
    whole.advance(table)
    for row in table:
        single.advance([row])
    for first in range(0, len(table), 1_700):
        pieces.advance(iter(table[first : first + 1_700]))
    assert outputs(whole) == outputs(single) == outputs(pieces)


LONG = (
    "only in m mode whenever p sw shall after 400 ticks satisfy q",
    "sw shall always satisfy (p | occurred(300, 1000, q))",
    "whenever occurred(2, 700, p) sw shall within 5 ticks satisfy persisted(3, 500, q)",
)


def of_runs(machine: Monitor, count: int, choose: random.Random) -> Rows:
    """Values that stay for a while, and some unknown ones."""
    columns = []
    for _ in machine.PROPOSITIONS:
        most, unknown = choose.choice((1, 3, 400)), choose.choice((0.0, 0.02))
        column: list[Truth] = []
        while len(column) < count:
            value = None if choose.random() < unknown else bool(choose.randrange(2))
            column += [value] * (1 if value is None else choose.randint(1, most))
        columns.append(column[:count])
    return list(zip(*columns, strict=True))


def in_pieces(machine: Monitor, table: Rows, choose: random.Random) -> None:
    """In single steps and batches, with batches that fail, and from saved states."""
    bad: Any = (3,) * len(machine.PROPOSITIONS)
    place = 0
    while place < len(table):
        rows = table[place : place + choose.choice((1, 2, 3, 50, 70, 300))]
        match choose.randrange(4):
            case 0:
                single: Any = machine
                for row in rows:
                    single.step(**dict(zip(machine.PROPOSITIONS.values(), row, strict=True)))
            case 1:
                with pytest.raises(TypeError):
                    machine.advance([*rows, bad])
                continue
            case 2:
                machine.restore(json.loads(json.dumps(machine.state())))
                machine.advance(rows)
            case _:
                machine.advance(rows)
        place += len(rows)


@pytest.mark.slow
@pytest.mark.parametrize("sentence", [*SENTENCES, *LONG])
@pytest.mark.parametrize("seed", range(4))
def test_steps_batches_mistakes_saved_states_and_columns_tell_the_same(
    sentence: str, seed: int
) -> None:
    choose = random.Random(seed)
    whole, pieces = monitor(sentence), monitor(sentence)
    table = of_runs(whole, choose.randint(1, 2_500), choose)
    whole.advance(table)
    in_pieces(pieces, table, choose)
    assert outputs(whole) == outputs(pieces)
    ticks, columns = packed(dict(zip(whole.PROPOSITIONS, zip(*table, strict=True), strict=True)))
    assert evaluate(whole, columns, ticks) == run_by_steps(whole, columns, ticks)
    assert outputs(whole) == outputs(pieces)


# Many propositions, and rows in another order ---------------------------------------------------


@cache
def wide(count: int) -> str:
    """A monitor of so many propositions."""
    return emitted(
        f'sw shall always satisfy {" | ".join(f"p{i}" for i in range(count - 1))} | "odd name"'
    )


WIDE = (MOST_PARAMETERS, MOST_PARAMETERS + 1)


@pytest.mark.parametrize("count", WIDE)
def test_a_step_of_many_propositions_is_that_of_few(count: int) -> None:
    single, whole = load("m", wide(count)), load("m", wide(count))
    table = [(False, True, None) * count for _ in range(3)]
    table = [row[i : i + count] for i, row in enumerate(table)] + [(False,) * count]
    step_of: Any = single
    for row in table:
        step_of.step(**dict(zip(single.PROPOSITIONS.values(), row, strict=True)))
    whole.advance(table)
    assert outputs(single) == outputs(whole)
    assert whole.statuses()[0].first_violation == 3


@pytest.mark.parametrize("count", [2, *WIDE])
def test_a_step_names_what_is_missing_or_no_parameter_as_python_does(count: int) -> None:
    machine: Any = load("m", wide(count))
    values: dict[str, Any] = dict.fromkeys(machine.PROPOSITIONS.values(), True)
    name = list(values)[-1]
    less = {each: True for each in values if each != name}
    with pytest.raises(TypeError, match=rf"R1Monitor.step\(\) missing .*: '{name}'"):
        machine.step(**less)
    for arguments in (values, less):
        with pytest.raises(TypeError, match="unexpected keyword argument 'other'"):
            machine.step(**arguments, other=True)
    with pytest.raises(TypeError, match="is True, False or None"):
        machine.step(**{**values, name: 1})
    assert machine.tick == -1


@pytest.mark.parametrize("sentence", ["whenever p sw shall satisfy q", "sw shall satisfy p"])
def test_rows_in_another_order_are_put_into_that_of_the_monitor(sentence: str) -> None:
    first, second = monitor(sentence), monitor(sentence)
    table = rows(first, 50, 2)
    first.advance(table)
    names = tuple(second.PROPOSITIONS)
    second.advance(second.rows_of(names[::-1])(row[::-1] for row in table))
    assert outputs(first) == outputs(second)
    for wrong in ((True,) * (len(names) + 1), ()):
        with pytest.raises(ValueError, match="values"):
            second.advance(second.rows_of(names[::-1])([wrong]))
    assert outputs(first) == outputs(second)


@pytest.mark.parametrize(
    ("names", "why"),
    [("p", "`q` is missing"), ("pqs", "`s` is no name"), ("pqq", "more than once"), ("", "`p`")],
)
def test_names_that_are_not_the_propositions_are_refused(names: str, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        monitor("whenever p sw shall satisfy q").rows_of(tuple(names))


def test_rows_of_variables_may_come_in_another_order() -> None:
    sentence = "whenever speed > 2 sw shall satisfy stopped"
    first, second = monitor(sentence), monitor(sentence)
    one, other = (3.0, None), (None, 3.0)
    taken: Any = first
    verdict = taken.run([one])
    taken = second
    assert tuple(taken.VARIABLES) == ("speed", "stopped")
    assert taken.run(taken.rows_of(("stopped", "speed"))([other])) == verdict
    assert outputs(first) == outputs(second)


def test_rows_may_be_given_by_name() -> None:
    first, second = monitor(*SENTENCES), monitor(*SENTENCES)
    table = rows(first, 50, 1)
    first.advance(table)
    second.advance([dict(zip(second.PROPOSITIONS, row, strict=True)) for row in table])
    assert first.statuses() == second.statuses()


@pytest.mark.parametrize("sentence", [*SENTENCES, "whenever !p sw shall immediately satisfy !q"])
def test_booleans_of_numpy_are_those_of_python(sentence: str) -> None:
    python, numpy, single = (monitor(sentence) for _ in range(3))
    table = rows(python, 500, 4)
    same: Any = [tuple(one if one is None else np.bool_(one) for one in row) for row in table]
    python.advance(table)
    numpy.advance(same)
    stepped: Any = single
    for row in same:
        stepped.step(**dict(zip(single.PROPOSITIONS.values(), row, strict=True)))
    assert outputs(python) == outputs(numpy) == outputs(single)
    assert type(numpy.certain.signals()[0].trigger) is bool


@pytest.mark.slow
@pytest.mark.parametrize("sentence", SENTENCES)
@pytest.mark.parametrize("bad", [1, "true", float("nan")])
@pytest.mark.parametrize("unknown", [0.0, 0.3])
def test_a_bad_value_leaves_the_last_whole_piece(sentence: str, bad: Any, unknown: float) -> None:
    machine, other = monitor(sentence), monitor(sentence)
    table = rows(machine, 5_000, 5, unknown)
    broken: Any = [*table[:4_990], (bad,) * len(machine.PROPOSITIONS), *table[4_990:]]
    with pytest.raises(TypeError, match="is True, False or None"):
        machine.advance(broken)
    assert machine.tick == 4_095
    assert machine.possible.tick == machine.certain.tick
    other.advance(table[:4_096])
    machine.advance(table[4_096:])
    other.advance(table[4_096:])
    assert outputs(machine) == outputs(other)


def test_rows_that_can_be_read_once_leave_no_half_step() -> None:
    machine = monitor("whenever p sw shall immediately satisfy q")
    fleeting: Any = (iter(row) for row in [(False, True), (None, False)])
    with pytest.raises((TypeError, ValueError)):
        machine.advance(fleeting)
    assert machine.certain.tick == machine.possible.tick == -1


def test_whatever_stops_a_run_both_approximations_stay_together() -> None:
    def source() -> Iterator[tuple[Truth, ...]]:
        yield from [(None, True)] * 4_096
        yield from [(True, True)] * 10
        raise KeyboardInterrupt

    machine = monitor("whenever p sw shall immediately satisfy q")
    with pytest.raises(KeyboardInterrupt):
        machine.advance(source())
    assert machine.certain.tick == machine.possible.tick == 4_095


# One approximation again ----------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("sentence", [*SENTENCES, *LONG])
@pytest.mark.parametrize("seed", range(3))
def test_a_monitor_whose_approximations_meet_again_tells_what_one_tells_whose_approximations_do_not(
    sentence: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    choose = random.Random(seed)
    one, other = monitor(sentence), monitor(sentence)
    monkeypatch.setattr(other, "_meet", lambda: None)
    single: Any = one
    for tick, row in enumerate(of_runs(one, 2_000, choose)):
        single.step(**dict(zip(one.PROPOSITIONS.values(), row, strict=True)))
        other.advance([row])
        if tick % 97 == 0:
            assert outputs(one) == outputs(other)


@pytest.mark.parametrize("batch", [1, 7, 5_000])
@pytest.mark.parametrize(
    ("sentence", "last"),
    [
        ("whenever p sw shall within 3 ticks satisfy q", (True, True)),
        ("sw shall always satisfy (p | occurred(2, 5, q))", (True, False)),
        ("whenever p sw shall eventually satisfy q", (True, True)),
    ],
)
def test_approximations_meet_again_soon_after_all_is_known(
    sentence: str, last: tuple[bool, bool], batch: int
) -> None:
    machine = monitor(sentence)
    machine.advance([(True, None)])
    assert machine.possible is not machine.certain
    for _ in range(400 // batch + 2):
        machine.advance([last] * batch)
    assert machine.possible is machine.certain


def test_approximations_stay_two_where_a_violation_is_possible() -> None:
    machine = monitor("whenever p sw shall immediately satisfy q")
    machine.advance([(True, None), *[(False, True)] * 9_000])
    assert machine.possible is not machine.certain
    assert machine.statuses()[0].finite is None


def test_nothing_is_known_to_be_pending_before_the_first_tick() -> None:
    assert (
        monitor("whenever p sw shall eventually satisfy q").statuses()[0].obligation_pending is None
    )


@pytest.mark.parametrize("sentence", SENTENCES[:4])
def test_what_is_pending_holds_whatever_the_unknown_values_are(sentence: str) -> None:
    """A definite answer is that of each completion; unknown values leave some of them open."""
    machine, known = monitor(sentence), monitor(sentence)
    seen = set()
    for seed in range(60):
        table = rows(machine, 5, seed, 0.2)
        machine.reset()
        machine.advance(table)
        obligation_pending = machine.statuses()[0].obligation_pending
        choices = [(True, False) if value is None else (value,) for row in table for value in row]
        for values in itertools.islice(itertools.product(*choices), 128):
            known.reset()
            known.advance(zip(*[iter(values)] * len(table[0]), strict=True))
            assert obligation_pending in (None, known.statuses()[0].obligation_pending)
        seen.add(obligation_pending)
    assert seen == {True, False, None}


@pytest.mark.parametrize("after", [100, 500])
def test_approximations_stay_two_as_long_as_their_windows_differ(after: int) -> None:
    """All else agrees; that `q` may have held shows where `p` fails 300 to 1 000 ticks later."""
    machine = monitor("sw shall always satisfy (p | occurred(300, 1000, q))")
    machine.advance([(True, None)])
    for _ in range(after):
        machine.advance([(True, False)])
    machine.advance([(False, False)])
    assert machine.statuses()[0].finite is (None if after == 500 else False)
    machine.reset()
    machine.advance([(True, None)])
    for _ in range(2_100):
        machine.advance([(True, False)])
    assert machine.possible is machine.certain


def test_approximations_part_no_more_often_than_every_64_ticks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A copy of an approximation costs more than some steps of a second one."""
    machine: Any = monitor("whenever p sw shall within 3 ticks satisfy q")
    parted: list[int] = []
    part = machine._part

    def noted(possible: object) -> None:
        parted.append(machine.tick)
        part(possible)

    monkeypatch.setattr(machine, "_part", noted)
    for tick in range(1_000):
        machine.step(p=False, q=None if tick % 3 == 0 else True)
    assert all(later - sooner > 63 for sooner, later in pairwise(parted))
    assert parted


# Checkpoints ----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("unknown", [0.0, 0.2])
def test_a_monitor_goes_on_from_its_state(unknown: float) -> None:
    machine = monitor(*SENTENCES)
    table = rows(machine, 60, 8, unknown)
    for cut in range(0, 60, 7):
        whole, restored = monitor(*SENTENCES), monitor(*SENTENCES)
        whole.advance(table[:cut])
        restored.restore(json.loads(json.dumps(whole.state())))
        for row in table[cut:]:
            whole.advance([row])
            restored.advance([row])
            assert outputs(whole) == outputs(restored)


def monitor_of(*named: tuple[str, str], clock: Clock | None = None) -> Monitor:
    return load("m", target.text(*(requirement(text, id, clock) for id, text in named)))


A = ("A", "whenever p sw shall within 5 ticks satisfy q")
B = ("B", "whenever m sw shall within 5 ticks satisfy s")


@pytest.mark.parametrize(
    "other",
    [
        lambda: monitor_of(B, A),
        lambda: monitor_of(A),
        lambda: monitor_of(A, ("C", B[1])),
        lambda: monitor_of(A, ("B", B[1].replace("5", "6"))),
    ],
)
def test_a_state_fits_no_other_monitor(other: Callable[[], Monitor]) -> None:
    with pytest.raises(ValueError, match="another monitor"):
        other().restore(monitor_of(A, B).state())


def test_a_state_fits_no_other_clock() -> None:
    text = ("A", "upon p sw shall for 1 second satisfy q")
    slow, fast = (monitor_of(text, clock=Clock(period)) for period in (5 * 10**8, 10**8))
    with pytest.raises(ValueError, match="another monitor"):
        fast.restore(slow.state())


def changed(state: Mapping[str, Any], *path: str, value: Any) -> dict[str, Any]:
    copy: dict[str, Any] = json.loads(json.dumps(state))
    inner = copy
    for name in path[:-1]:
        inner = inner[name]
    inner[path[-1]] = value
    return copy


def test_a_state_that_was_changed_is_refused() -> None:
    machine = monitor(WINDOW, SENTENCES[0])
    machine.advance(rows(machine, 30, 4, 0.3))
    state, before = machine.state(), outputs(machine)
    names = [
        (approximation, name)
        for approximation in ("certain", "possible")
        for name in state[approximation]
    ]
    wrong: list[Any] = [changed(state, *path, value=-999) for path in names]
    wrong += [
        changed(state, "possible", value=None),
        changed(state, "certain", "is_possible", value=True),
    ]
    wrong += [{**state, "more": 1}, {**state, "sha256": ""}, {}, [], None, "x", {"program": 3}]
    for other in wrong:
        with pytest.raises(ValueError, match="state"):
            machine.restore(other)
        assert outputs(machine) == before
    assert len(names) > 20


def test_reset_forgets_everything() -> None:
    machine = monitor(*SENTENCES)
    fresh = machine.state()
    machine.advance(rows(machine, 40, 2))
    machine.reset()
    assert machine.state() == fresh


# Several requirements -------------------------------------------------------------------------


def test_each_requirement_is_told_as_if_it_were_alone() -> None:
    together = monitor(*SENTENCES)
    alone = [monitor(sentence) for sentence in SENTENCES]
    for row in rows(together, 80, 6):
        named = dict(zip(together.PROPOSITIONS, row, strict=True))
        together.advance([named])
        for single in alone:
            single.advance([{name: named[name] for name in single.PROPOSITIONS}])
        assert together.verdicts() == tuple(single.verdicts()[0] for single in alone)
        for found, single in zip(together.statuses(), alone, strict=True):
            assert found[1:] == single.statuses()[0][1:]


def test_a_requirement_takes_five_slots_beside_its_cells() -> None:
    """Beyond 8 191 slots of a class, CPython 3.11 looks each up by its name: a thousand fit."""
    approximation = monitor(*SENTENCES).APPROXIMATION
    assert len(approximation.__slots__) == len(("is_possible", "tick")) + len(
        approximation.CELLS
    ) + 5 * len(SENTENCES)


@pytest.mark.parametrize("count", [1, 2])
def test_a_monitor_without_propositions_is_stepped(count: int) -> None:
    machine: Any = monitor(*["the sw shall always satisfy true"] * count)
    other = monitor(*["the sw shall always satisfy true"] * count)
    machine.step()
    other.advance([()])
    assert outputs(machine) == outputs(other)
    assert machine.tick == 0


def test_what_requirements_share_is_computed_once() -> None:
    text = emitted("whenever p sw shall within 9 ticks satisfy q", "upon m sw shall satisfy s")
    both = emitted("whenever p sw shall within 9 ticks satisfy q", "whenever p sw shall satisfy q")
    assert text.count(" S ") > both.count(" S ")
    assert both.count("oldest_1 = 0") == 1
    assert "oldest_2" not in both


@pytest.mark.parametrize("sentence", SENTENCES)
def test_a_look_ahead_says_what_would_be_and_changes_nothing(sentence: str) -> None:
    machine, other = monitor(sentence), monitor(sentence)
    for seed in range(60 if FULL else 15):
        block = rows(machine, 1 + seed % 3, seed, 0.1 if seed % 2 else 0.0)
        before = machine.state()
        copy = monitor(sentence)
        copy.restore(before)
        copy.advance(rows(machine, 4, 100 + seed))
        more = rows(machine, 4, 100 + seed)
        assert machine.statuses_after(more) == copy.statuses()
        assert machine.obligation_pending_after(more) == tuple(
            each.obligation_pending for each in copy.statuses()
        )
        assert machine.state() == before
        machine.advance(block)
        other.advance(block)
        assert machine.state() == other.state()


def test_a_look_ahead_that_fails_changes_nothing() -> None:
    machine = monitor(SENTENCES[0])
    machine.advance(rows(machine, 5, 1))
    before = machine.state()
    with pytest.raises(TypeError):
        machine.statuses_after([("no truth", True)])  # type: ignore[list-item]
    assert machine.state() == before
    assert machine.statuses_after([]) == machine.statuses()
    assert monitor(SENTENCES[0]).obligation_pending_after([]) == (None,)


def test_the_former_names_give_the_same_values_and_a_warning() -> None:
    machine = monitor("whenever p sw shall eventually satisfy q")
    machine.advance([(True, False)])
    with pytest.warns(DeprecationWarning, match="`owed` is now `obligation_pending`") as told:
        assert machine.statuses()[0].owed is True
    assert told[0].filename == __file__
    with pytest.warns(DeprecationWarning, match="`standings` is now `statuses`"):
        assert machine.standings() == machine.statuses()
    with pytest.warns(DeprecationWarning, match="is now `statuses_after`"):
        later = machine.standings_after([(False, True)])
    assert later == machine.statuses_after([(False, True)]) != machine.statuses()
    with pytest.warns(DeprecationWarning, match="is now `obligation_pending_after`"):
        assert machine.owed_after([(False, True)]) == (False,)
