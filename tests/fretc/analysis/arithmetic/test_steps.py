"""Samples of a tick as letters: against what an audit sees of real samples, both ways."""

import random
from collections.abc import Mapping, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.formalization.formalize import formalize
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.budget import ENDLESS
from fretc.analysis.arena.transition import Transition
from fretc.analysis.arena.variables import numbers
from fretc.analysis.arithmetic.alphabet import Cells
from fretc.logs.signals.samples import Recording, Samples
from fretc.logs.signals.traces import trace
from fretish.bindings.declarations import Declarations, Role
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from monitors.kernel.columns import truths
from tests.effort import FULL
from tests.fretc.logs.logs import declare

TICK = 10
"""Nanoseconds."""
TICKS = 6
Pairs = Sequence[tuple[int, float]]
COMPARISONS = (
    "x < 1",
    "x > 2",
    "x = 1",
    "x + y > 3",
    "x < 2 and y > 1",
    "y <= 0",
    "x < 1 or y < 2",
)
OTHERS = ("", 'agg = "any"', 'agg = "all"')


@st.composite
def texts(draw: st.DrawFn) -> tuple[str, ...]:
    """Tables of propositions p0, p1, ..., without their names."""
    found = []
    for _ in range(draw(st.integers(1, 4))):
        comparison = draw(st.sampled_from(COMPARISONS))
        if draw(st.integers(0, 3)) == 0:
            found.append(f'expr = "{comparison} for {draw(st.sampled_from((10, 20, 30)))} ns"')
            continue
        unknown = draw(st.sampled_from(("", "", "on_unknown = false", "on_unknown = true")))
        found.append(f'expr = "{comparison}"\n{draw(st.sampled_from(OTHERS))}\n{unknown}')
    return tuple(found)


def declared(tables: Sequence[str]) -> Declarations:
    signals = "".join(
        f'[signal.{name}]\npath = "/{name}.data"\ntype = "std_msgs/Int8"\n' for name in "xy"
    )
    parts = "".join(f"[proposition.p{n}]\n{table}\n" for n, table in enumerate(tables))
    return declare(f'[clock]\ntick = "{TICK} ns"\n{signals}{parts}')


def lettered(tables: Sequence[str], role: Role = Role.OUTPUT) -> tuple[Declarations, Cells]:
    """The letters of propositions, all of which one player chooses."""
    declarations = declared(tables)
    names = [f"p{n}" for n in range(len(tables))]
    sentence = f"the sw shall always satisfy {' | '.join(names)}"
    entry = RequirementEntry("R1", Source("R1.fret", sentence).span())
    requirement, remarks = formalize(entry, declarations)
    assert requirement is not None, remarks
    roles = dict.fromkeys(names, role)
    alphabet = Cells([requirement], roles, numbers(), role, ENDLESS)
    for name in names:
        alphabet.atom(name)
    return declarations, alphabet


def audited(
    declarations: Declarations, samples: Mapping[str, Pairs]
) -> dict[str, list[bool | None]]:
    """What an audit sees of samples, tick by tick."""
    columns = {
        name: Samples(
            np.array([time for time, _ in pairs], np.int64),
            np.array([value for _, value in pairs], np.float64),
        )
        for name, pairs in samples.items()
    }
    end = TICK * (TICKS - 1)
    log = Recording(
        "log", "", 0, 0, end, columns, np.zeros(0, np.int64), (), {}, {}, (), intact=True
    )
    names = list(declarations.propositions)
    found = trace(declarations, log, names)
    return {name: truths(found.columns[name], len(found.timeline.times)) for name in names}


def stepped(alphabet: Cells, letter: Mapping[int, bool]) -> dict[str, list[float]]:
    """Samples that make up a tick, step by step; all of one step come together."""
    found: dict[str, list[float]] = {}
    for group in alphabet._groups:
        if group.is_used:
            point = group.numbers(letter, ())
            for name in {*point} & {"x", "y"}:
                others = sorted(each for each in point if each.startswith(f"{name} at step"))
                found[name] = [float(point[each]) for each in (*others, name)]
    return found


def remembering(alphabet: Cells) -> Transition:
    memory = alphabet.memory()
    return Transition([] if memory is None else [memory])


def after(transition: Transition, states: Function, letters: Function) -> Function:
    """The states that such letters lead to."""
    found = bdd.false()
    rest = states & letters
    while rest != bdd.false():
        whole = dict.fromkeys(transition.start, False) | bdd.witness(rest)
        state = {bit: whole[bit] for bit in transition.start}
        at_state = bdd.at(rest, bdd.point(state))
        reached = bdd.false()
        while at_state != bdd.false():
            letter = bdd.witness(at_state)
            known = bdd.point(dict.fromkeys(every_bit(transition), False) | state | letter)
            new = bdd.point(transition.next(known))
            reached = reached | new
            at_state = at_state - transition.moved_from(new, bdd.point(state))
        found = found | reached
        rest = rest - bdd.point(state)
    return found


def every_bit(transition: Transition) -> list[int]:
    return [*{n for bit in transition.start for n in (bit, *bdd.support(transition.step(bit)))}]


@pytest.mark.slow
@settings(max_examples=settings().max_examples // (4 if FULL else 7))
@given(texts(), st.data())
def test_what_samples_make_true_together_is_a_letter(
    tables: tuple[str, ...], data: st.DataObject
) -> None:
    declarations, alphabet = lettered(tables)
    value = st.one_of(st.integers(-1, 4).map(float), st.just(float("nan")))
    pairs = st.lists(st.tuples(st.integers(0, TICK * (TICKS - 1)), value), max_size=10)
    seen = audited(
        declarations, {name: sorted(data.draw(pairs), key=lambda p: p[0]) for name in "xy"}
    )
    transition = remembering(alphabet)
    states = transition.initial
    replaced = any("on_unknown" in table for table in tables)
    for tick in range(TICKS):
        if replaced and any(column[tick] is None for column in seen.values()):
            return  # letters have what no `on_unknown` replaces as known
        letters = alphabet.possible
        for name, column in seen.items():
            if column[tick] is not None:  # what is unknown may be either
                so = alphabet.atom(name)
                letters = letters & (so if column[tick] else -so)
        states = after(transition, states, letters)
        assert states != bdd.false(), (tables, seen, tick)


@pytest.mark.slow
@settings(max_examples=settings().max_examples // (4 if FULL else 7))
@given(texts(), st.integers(0, 2**32))
def test_what_is_a_letter_for_certain_some_samples_make_true(
    tables: tuple[str, ...], seed: int
) -> None:
    declarations, alphabet = lettered(tables)
    transition = remembering(alphabet)
    if alphabet.certain == bdd.false():
        return
    choose = random.Random(seed)
    samples: dict[str, list[tuple[int, float]]] = {"x": [], "y": []}
    wanted: dict[str, list[bool]] = {name: [] for name in declarations.propositions}
    state = transition.start
    for tick in range(TICKS):
        letter: dict[int, bool] = {}
        options = bdd.at(alphabet.certain, bdd.point(state))
        if options == bdd.false():
            return  # what has lasted since the first tick is unknown
        for bit in [*alphabet.inputs, *alphabet.outputs]:
            wish = choose.random() < 0.5
            letter[bit] = wish if options & bdd.literal(bit, wish) != bdd.false() else not wish
            options = options & bdd.literal(bit, letter[bit])
        known = bdd.point({**state, **letter})
        for name, column in wanted.items():
            column.append(bdd.at(alphabet.atom(name), known) == bdd.true())
        for name, values in stepped(alphabet, letter).items():
            samples[name] += [(TICK * tick, value) for value in values]
        state = transition.next(known)
    for pairs in samples.values():
        pairs[:0] = [] if pairs else [(0, 0.0)]
    assert audited(declarations, samples) == wanted, (tables, samples)


@pytest.mark.parametrize(
    ("first", "second", "together"),
    [
        ('expr = "x < 1"\nagg = "any"', 'expr = "x > 2"\nagg = "any"', True),
        ('expr = "x < 1"\nagg = "all"', 'expr = "x > 2"\nagg = "any"', False),
        ('expr = "x < 1"\nagg = "any"', 'expr = "x > 2"', True),
        ('expr = "x < 1"\nagg = "all"', 'expr = "x > 2"', False),
        ('expr = "x < 1"', 'expr = "x > 2"', False),
        ('expr = "x < 1"\nagg = "any"', 'expr = "x > 2"\nagg = "all"', False),
    ],
)
def test_several_samples_make_true_what_one_cannot(first: str, second: str, together: bool) -> None:
    _, alphabet = lettered([first, second])
    both = alphabet.possible & alphabet.atom("p0") & alphabet.atom("p1")
    assert (both != bdd.false()) is together
