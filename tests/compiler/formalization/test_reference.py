"""The reference automata against the definition of FRETish and against Spot, for all templates."""

import random
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import product
from typing import Any

import buddy
import pytest
import spot
from hypothesis import given
from hypothesis import strategies as st

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import letters_by_valuation
from compiler.formalization.reference import (
    BROKEN,
    Automaton,
    Letter,
    ReferenceState,
    TooManyStatesError,
    Verdict,
    accepting,
    accepts,
    explore,
    initial,
    step,
    template,
)
from compiler.formalization.reference import Template as Counted
from compiler.logic import printing
from fretish import syntax as s
from fretish.syntax import ConditionKind, ScopeKind
from tests import meaning
from tests.effort import FULL, some
from tests.monitoring import requirement
from tests.strategies import COUNTS, Template, some_templates, templates, traces

SMALL = (0, 1, 2, 3)
SEVERAL = (*SMALL, 5) if FULL else (0, 1, 3)
LONGEST = {1: 10, 2: 5, 3: 3, 4: 3} if FULL else {1: 7, 2: 4, 3: 3, 4: 2}
"""How many ticks a trace has, for each number of columns, where all traces are visited."""
Valuation = tuple[bool, ...]


@cache
def counted(sentence: str) -> Counted:
    made = requirement(sentence)
    return template(made.sentence, made.ticks or 0)


def letters_of(columns: Sequence[str]) -> dict[Valuation, Letter]:
    """Each valuation of the columns, as a letter."""
    found = {}
    for valuation in product((False, True), repeat=len(columns)):
        value = dict(zip(columns, valuation, strict=True))
        m, p, q, stop = (value.get(name, False) for name in "mpqs")
        found[valuation] = (m, p, q, stop)
    return found


def every(scope: str, counts: tuple[int, ...]) -> list[Template]:
    return [template for template in some_templates(counts) if template.scope == scope]


# Finite traces --------------------------------------------------------------------------------


def after(counted: Counted, rows: Sequence[Mapping[str, bool]]) -> ReferenceState | None:
    state: ReferenceState | None = initial(counted)
    for row in rows:
        if state is None:
            return None
        state = step(counted, state, *(row.get(name, False) for name in "mpqs"))
    return state


def assert_judged_as_meant(template: Template, rows: Sequence[Mapping[str, bool]]) -> None:
    reference = counted(template.sentence)
    state = after(reference, rows)
    columns = {name: [row[name] for row in rows] for name in template.columns}
    found = state is not None and accepts(reference, state)
    assert found is template.satisfied(columns), (template, rows)


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_every_short_trace_is_judged_as_fretish_means_it(scope: str) -> None:
    for drawn in every(scope, COUNTS):
        names, reference = drawn.columns, counted(drawn.sentence)
        letters = letters_of(names)
        reached: list[tuple[ReferenceState | None, tuple[Valuation, ...]]] = [
            (initial(reference), ())
        ]
        for _ in range(LONGEST[len(names)]):
            reached = [
                (state and step(reference, state, *letter), (*word, valuation))
                for state, word in reached
                for valuation, letter in letters.items()
            ]
            for state, word in reached:
                columns = dict(zip(names, zip(*word, strict=True), strict=True))
                found = state is not None and accepts(reference, state)
                assert found is drawn.satisfied(columns), (drawn, word)


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_drawn_traces_are_judged_as_fretish_means_them(scope: str) -> None:
    for drawn in every(scope, (*SMALL, 5)):
        choose = random.Random(repr(drawn))
        for length in (*range(4, 10), 14, 20) if FULL else (4, 7, 14):
            for likely in (0.2, 0.5, 0.8):  # the response; triggers are rarer, and runs longer
                odds = {"m": 0.7, "p": 0.4, "q": likely, "s": 0.2}
                rows = [
                    {name: choose.random() < odds[name] for name in drawn.columns}
                    for _ in range(length)
                ]
                assert_judged_as_meant(drawn, rows)


@given(
    st.sampled_from([*templates((*SMALL, 5)), *templates((4, 7))]),
    traces("m", "p", "q", "s", max_size=16),
)
def test_long_traces_are_judged_as_fretish_means_them(
    drawn: Template, rows: list[dict[str, bool]]
) -> None:
    assert_judged_as_meant(drawn, rows)


# Infinite traces: the language ----------------------------------------------------------------


def as_spot(automaton: Automaton, letters: Mapping[Valuation, Letter], names: Sequence[str]) -> Any:
    """The automaton as Spot's: deterministic, complete, Büchi acceptance on its states."""
    graph = spot.make_twa_graph(spot.make_bdd_dict())
    graph.set_buchi()
    graph.prop_state_acc(True)
    guards = guards_of(graph, names)
    graph.new_states(len(automaton.states) + 1)
    graph.set_init_state(0)
    sink = len(automaton.states)
    for origin, (state, row) in enumerate(zip(automaton.states, automaton.moves, strict=True)):
        marks = [0] if accepting(automaton.template, state) else []
        for valuation, letter in letters.items():
            target = row[automaton.letters.index(letter)]
            graph.new_edge(origin, sink if target == BROKEN else target, guards[valuation], marks)
    graph.new_edge(sink, sink, buddy.bddtrue)
    graph.merge_edges()
    return graph


def guards_of(graph: Any, names: Sequence[str]) -> dict[Valuation, Any]:
    """Each valuation as a cube over the propositions of the graph."""
    variables = [graph.register_ap(name) for name in names]
    guards = {}
    for valuation in product((False, True), repeat=len(names)):
        guard = buddy.bddtrue
        for variable, value in zip(variables, valuation, strict=True):
            guard = guard & (buddy.bdd_ithvar(variable) if value else buddy.bdd_nithvar(variable))
        guards[valuation] = guard
    return guards


def in_spot(made: FormalizedRequirement) -> Any:
    return spot.formula(printing.text(made.ft_infinite, printing.SPOT))


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_the_automaton_has_the_language_of_the_infinite_formula(scope: str) -> None:
    for drawn in every(scope, SEVERAL):
        letters = letters_of(drawn.columns)
        automaton = explore(counted(drawn.sentence), letters.values())
        graph = as_spot(automaton, letters, drawn.columns)
        assert spot.are_equivalent(graph, in_spot(requirement(drawn.sentence))), drawn


def test_the_comparison_with_spot_sees_a_difference_of_one_tick() -> None:
    sentence = "whenever p the sw shall within {} ticks satisfy q"
    letters = letters_of("pq")
    graph = as_spot(explore(counted(sentence.format(3)), letters.values()), letters, "pq")
    assert spot.are_equivalent(graph, in_spot(requirement(sentence.format(3))))
    assert not spot.are_equivalent(graph, in_spot(requirement(sentence.format(2))))
    assert not spot.are_equivalent(graph, in_spot(requirement(sentence.format(4))))


# Infinite traces: the instants of the verdicts ------------------------------------------------

Moves = list[dict[Valuation, int]]


def monitor(formula: Any, names: Sequence[str]) -> tuple[Moves, int | None]:
    """Spot's deterministic monitor and its first state; None where nothing can satisfy."""
    graph = spot.translate(formula, "monitor", "det")
    guards = guards_of(graph, names)
    moves = [
        {
            valuation: edge.dst
            for edge in graph.out(state)
            for valuation, guard in guards.items()
            if edge.cond & guard != buddy.bddfalse
        }
        for state in range(graph.num_states())
    ]
    first = graph.get_init_state_number()
    return moves, first if moves[first] else None


def moved(monitor: Moves, state: int | None, valuation: Valuation) -> int | None:
    """The next state; None, for good, where there is no edge: then nothing can satisfy."""
    return None if state is None else monitor[state].get(valuation)


def three_valued(kept: int | None, lost: int | None) -> Verdict:
    if kept is None:
        return "violated"
    return "satisfied" if lost is None else "pending"


def assert_decides_as_early_as_spot(
    automaton: Automaton, letters: Mapping[Valuation, Letter], names: Sequence[str], formula: Any
) -> int:
    """Compare with LTL3 monitors, after every finite trace: all their states are visited.

    Source: Bauer, Leucker, Schallhart, TOSEM 20 (2011): one monitor of the formula, one of its
    negation; the first that is stuck decides.
    """
    keeps, kept_first = monitor(formula, names)
    loses, lost_first = monitor(spot.formula.Not(formula), names)
    start = (0, kept_first, lost_first)
    reached, waiting = {start}, [start]
    while waiting:
        state, kept, lost = waiting.pop()
        found = "violated" if state == BROKEN else automaton.verdicts[state]
        assert found == three_valued(kept, lost), (automaton.template, state)
        for valuation, letter in letters.items() if state != BROKEN else ():
            triple = (
                automaton.moves[state][automaton.letters.index(letter)],
                moved(keeps, kept, valuation),
                moved(loses, lost, valuation),
            )
            if triple not in reached:
                reached.add(triple)
                waiting.append(triple)
    return len(reached)


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_verdicts_come_at_the_earliest_instant(scope: str) -> None:
    for drawn in every(scope, SEVERAL):
        letters = letters_of(drawn.columns)
        automaton = explore(counted(drawn.sentence), letters.values())
        formula = in_spot(requirement(drawn.sentence))
        assert_decides_as_early_as_spot(automaton, letters, drawn.columns, formula)


SHARING = [
    "whenever p the sw shall within {n} ticks satisfy !p",
    "whenever p the sw shall for {n} ticks satisfy !p",
    "whenever p the sw shall after {n} ticks satisfy p",
    "whenever p the sw shall after {n} ticks satisfy !p",
    "whenever !p the sw shall after {n} ticks satisfy p",
    "upon p the sw shall after {n} ticks satisfy p",
    "upon p the sw shall after {n} ticks satisfy !p",
    "upon p | q the sw shall after {n} ticks satisfy q",
    "upon p & q the sw shall within {n} ticks satisfy p xor q",
    "whenever p the sw shall within {n} ticks satisfy p | !p",
    "whenever p the sw shall within {n} ticks satisfy p & !p",
    "whenever p & !p the sw shall for {n} ticks satisfy q",
    "in p mode whenever q the sw shall within {n} ticks satisfy !p",
    "in p mode upon q the sw shall after {n} ticks satisfy p",
    "in p mode whenever !p the sw shall after {n} ticks satisfy q",
    "in p mode the sw shall eventually satisfy !p",
    "in p mode the sw shall finally satisfy p & q",
    "when not in p mode the sw shall for {n} ticks satisfy p | q",
    "before p mode upon q the sw shall eventually satisfy p",
    "before p mode the sw shall within {n} ticks satisfy p",
    "after p mode whenever q the sw shall after {n} ticks satisfy !q",
    "after p mode upon p the sw shall eventually satisfy !p & q",
    "only in p mode whenever q the sw shall after {n} ticks satisfy !q",
    "only in p mode the sw shall within {n} ticks satisfy p",
    "only before p mode the sw shall for {n} ticks satisfy p",
    "only after p mode upon q the sw shall after {n} ticks satisfy p & q",
    "only after p mode whenever q the sw shall always satisfy p -> q",
    "upon p the sw shall until !p satisfy q",
    "upon p the sw shall before q satisfy !p & q",
    "whenever p the sw shall until q satisfy !q",
    "whenever p the sw shall before !p satisfy p <-> q",
    "the sw shall immediately satisfy x > 3 | !(x > 3)",
    "whenever x > 3 the sw shall within {n} ticks satisfy !(x > 3) & y = 0",
]


@pytest.mark.slow
@pytest.mark.parametrize("sentence", some(SHARING, 2))
def test_verdicts_come_at_the_earliest_instant_where_expressions_share_variables(
    sentence: str,
) -> None:
    for n in (SMALL if FULL else (0, 2)) if "{n}" in sentence else (0,):
        made = requirement(sentence.format(n=n))
        names = made.propositions
        letters = letters_by_valuation(made.sentence, names)
        automaton = explore(template(made.sentence, n), letters.values())
        assert_decides_as_early_as_spot(automaton, letters, names, in_spot(made))
        assert spot.are_equivalent(as_spot(automaton, letters, names), in_spot(made))


def verdict(sentence: str, word: str) -> Verdict:
    """After the letters of the word, each a valuation of p such as `-` (false) or `p`."""
    made = requirement(sentence)
    letters = letters_by_valuation(made.sentence, ("p",))
    automaton = explore(template(made.sentence, made.ticks or 0), letters.values())
    state = 0
    for letter in word:
        if state != BROKEN:
            state = automaton.moves[state][automaton.letters.index(letters[(letter == "p",)])]
    return "violated" if state == BROKEN else automaton.verdicts[state]


@pytest.mark.parametrize(
    ("sentence", "word", "expected"),
    [
        ("the sw shall finally satisfy p", "", "satisfied"),
        ("whenever p the sw shall immediately satisfy p", "", "satisfied"),
        ("whenever p the sw shall immediately satisfy !p", "--", "pending"),
        ("whenever p the sw shall immediately satisfy !p", "--p", "violated"),
        ("the sw shall always satisfy p & !p", "", "violated"),
        ("whenever !p the sw shall after 0 ticks satisfy p", "-", "pending"),
        ("whenever !p the sw shall after 1 tick satisfy p", "-", "violated"),
        ("in p mode the sw shall eventually satisfy !p", "-", "pending"),
        ("in p mode the sw shall eventually satisfy !p", "-p", "violated"),
    ],
)
def test_a_verdict_may_follow_from_the_expressions_alone(
    sentence: str, word: str, expected: Verdict
) -> None:
    assert verdict(sentence, word) == expected


# What is decided, and when --------------------------------------------------------------------

SCOPES: list[ScopeKind | None] = [None, *ScopeKind]
CONDITIONS: list[ConditionKind | None] = [None, *ConditionKind]
TIMINGS: list[type[s.Timing]] = [
    *(s.Immediately, s.Next, s.Finally, s.Eventually, s.Always, s.Never),
    *(s.Within, s.For, s.After, s.Until, s.Before),
]


def every_kind(n: int) -> Iterator[Counted]:
    for scope, condition, timing in product(SCOPES, CONDITIONS, TIMINGS):
        yield Counted(scope, condition, timing, n)


def of_any_letters(kind: Counted) -> Automaton:
    return explore(kind, letters_of("mpqs").values())


def states_with(verdict: Verdict, automaton: Automaton) -> list[ReferenceState]:
    pairs = zip(automaton.states, automaton.verdicts, strict=True)
    return [state for state, found in pairs if found == verdict]


@pytest.mark.slow
@pytest.mark.parametrize("n", SMALL)
def test_only_a_second_trigger_of_after_is_a_violation_before_a_demand_is_broken(n: int) -> None:
    """It forbids the response where the first demands it, and the scope must not end before."""
    spacing = {ConditionKind.HOLDING: 1, ConditionKind.TRIGGER: 2}
    for kind in every_kind(n):
        lost = {state.counted for state in states_with("violated", of_any_letters(kind))}
        endless = kind.scope in (None, ScopeKind.AFTER) and kind.timing is s.After
        nearest = spacing.get(kind.condition, n + 1) if kind.condition and endless else n + 1
        assert lost == {-seen for seen in range(nearest + 1, n + 2)}, kind


@pytest.mark.slow
@pytest.mark.parametrize("n", SMALL)
def test_nothing_is_broken_where_the_end_decides_and_there_is_none(n: int) -> None:
    unbreakable = {
        (kind.scope, kind.timing)
        for kind in every_kind(n)
        if not any(BROKEN in row for row in of_any_letters(kind).moves)
    }
    assert unbreakable == {
        *((scope, s.Finally) for scope in (None, ScopeKind.AFTER, ScopeKind.ONLY_BEFORE)),
        *((scope, s.Eventually) for scope in (None, ScopeKind.AFTER)),
        *((ScopeKind.ONLY_BEFORE, timing) for timing in (s.Always, s.Never)),
    }


@pytest.mark.slow
@pytest.mark.parametrize("n", SMALL)
def test_satisfied_is_said_where_no_trigger_can_come_any_more(n: int) -> None:
    """With a condition: only of a scope that is over, and of `finally` where nothing ends."""
    for kind in every_kind(n):
        said = states_with("satisfied", of_any_letters(kind))
        nothing_ends = kind.scope in (None, ScopeKind.AFTER, ScopeKind.ONLY_BEFORE)
        if kind.timing is s.Finally and nothing_ends:
            assert len(said) == len(of_any_letters(kind).states)
        elif kind.scope in (ScopeKind.IN, ScopeKind.NOT_IN, ScopeKind.ONLY_IN):
            assert said == []
        elif kind.condition is not None:
            assert {state.phase.name for state in said} <= {"OVER"}
            assert bool(said) is (kind.scope in (ScopeKind.BEFORE, ScopeKind.ONLY_AFTER))
        else:
            assert {state.counted for state in said} <= {0}


# Size -----------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("timing", [s.Within, s.For, s.After])
@pytest.mark.parametrize("scope", SCOPES)
@pytest.mark.parametrize("condition", CONDITIONS)
def test_states_grow_with_the_bound_as_a_line(
    scope: ScopeKind | None, condition: ConditionKind | None, timing: type[s.Timing]
) -> None:
    if timing is s.After and condition and scope and scope.negates:
        return  # a register: see below
    few, more, most = (
        len(of_any_letters(Counted(scope, condition, timing, n)).states) for n in (10, 20, 30)
    )
    assert most - more == more - few <= 60


def test_a_bound_of_ten_thousand_ticks_is_explored() -> None:
    kind = Counted(None, ConditionKind.HOLDING, s.Within, 10_000)
    automaton = explore(kind, letters_of("pq").values())
    assert len(automaton.states) == 10_002  # before tick 0; none open; 1..10 000 ticks open
    assert set(automaton.verdicts) == {"pending"}


def test_the_negated_after_remembers_which_ticks_were_triggers() -> None:
    kind = Counted(ScopeKind.ONLY_BEFORE, ConditionKind.HOLDING, s.After, 9)
    letters = [(True, p, q, False) for p in (False, True) for q in (False, True)]
    assert len(explore(kind, letters).states) == 2**10 + 1


def test_the_negated_after_without_a_condition_has_one_trigger_an_interval() -> None:
    kind = Counted(ScopeKind.ONLY_IN, None, s.After, 2_000)
    assert len(of_any_letters(kind).states) == 2_003


def test_an_automaton_that_is_too_large_is_given_up() -> None:
    kind = Counted(ScopeKind.ONLY_IN, ConditionKind.HOLDING, s.After, 10_000)
    with pytest.raises(TooManyStatesError, match="more than 1000 states"):
        explore(kind, letters_of("mpqs").values(), limit=1000)


# Templates ------------------------------------------------------------------------------------


def test_the_template_of_a_sentence() -> None:
    assert counted("in m mode, upon p the sw shall within 3 ticks satisfy q") == Counted(
        ScopeKind.IN, ConditionKind.TRIGGER, s.Within, 3
    )
    assert counted("the sw shall satisfy q") == Counted(None, None, s.Eventually)


def test_a_timing_that_counts_nothing_has_no_ticks() -> None:
    sentence = requirement("the sw shall always satisfy q").sentence
    assert template(sentence, 5) == Counted(None, None, s.Always, 0)
