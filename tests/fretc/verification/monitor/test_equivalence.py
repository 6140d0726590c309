"""Monitors that are right are proved, those that are wrong are refuted by a shortest trace."""

from collections.abc import Callable, Hashable
from itertools import product

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from compiler.formalization.letters import Valuation, letters_by_valuation
from compiler.formalization.obligation import Uninterpreted, boolean
from compiler.logic import formula as f
from compiler.logic.definition import holds
from fretc.verification.monitor.equivalence import DifferingTrace, Equivalence, Judgement, compare
from fretish import expressions as e
from fretish import syntax as s
from fretish.diagnostics.source import Source
from fretish.parser import parse
from tests.effort import FULL, needs_deep_calls
from tests.strategies import sentences

LONG = 10_000 if FULL else 1000
PENDING, VIOLATED = ("pending", True), ("violated", False)


def read(text: str) -> s.Sentence:
    sentence = parse(Source("r.fret", text).span())
    assert isinstance(sentence, s.Sentence), sentence
    return sentence


def valuations(word: str) -> tuple[Valuation, ...]:
    """Words over p and q: `pq - q` is both, none, and q alone."""
    return tuple(("p" in letter, "q" in letter) for letter in word.split())


class Monitor:
    """A monitor as a function from a state and a letter to a state and a judgement."""

    def __init__(self, start: int, step: Callable[[int, Valuation], tuple[int, Judgement]]) -> None:
        self.state = start
        self.transition = step

    def save(self) -> Hashable:
        return self.state

    def load(self, state: Hashable) -> None:
        assert isinstance(state, int)
        self.state = state

    def step(self, letter: Valuation) -> Judgement:
        self.state, judgement = self.transition(self.state, letter)
        return judgement


Table = dict[tuple[int, bool], tuple[int, Judgement]]


def tabled(table: Table) -> Monitor:
    """A monitor of one proposition, from what it does in each state for each value."""
    return Monitor(0, lambda state, letter: table[state, letter[0]])


def within(n: int, restarts: bool = False) -> Monitor:
    """`whenever p ... within n ticks satisfy q`; the state is how long p has waited for q.

    One that `restarts` forgets the oldest trigger when another one comes.
    """

    def step(waited: int, letter: Valuation) -> tuple[int, Judgement]:
        p, q = letter
        if q or not (waited or p):
            return 0, PENDING
        waited = 1 if restarts and p else waited + 1
        return waited, VIOLATED if waited > n else PENDING

    return Monitor(0, step)


def sentence_within(n: int) -> s.Sentence:
    return read(f"whenever p the sw shall within {n} ticks satisfy q")


# Proofs ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [0, 1, 3, LONG])
def test_a_right_monitor_is_proved_at_its_own_bound(n: int) -> None:
    pairs = n + 2  # before tick 0; nothing waits; something has waited for 1..n ticks
    assert compare(within(n), sentence_within(n), n, ("p", "q")) == Equivalence(pairs, 4 * pairs)


def test_the_order_of_the_atoms_is_the_callers() -> None:
    def swapped(monitor: Monitor) -> Monitor:
        return Monitor(0, lambda state, letter: monitor.transition(state, (letter[1], letter[0])))

    assert isinstance(compare(swapped(within(3)), sentence_within(3), 3, ("q", "p")), Equivalence)
    assert compare(swapped(within(3)), sentence_within(3), 3, ("p", "q")) == DifferingTrace(
        valuations("q - - -"), expected=PENDING, actual=VIOLATED
    )


def test_a_monitor_may_read_more_than_the_sentence_says() -> None:
    def step(waited: int, letter: Valuation) -> tuple[int, Judgement]:
        return within(3).transition(waited, letter[1:])

    result = compare(Monitor(0, step), sentence_within(3), 3, ("other", "p", "q"))
    assert result == Equivalence(states=5, steps=5 * 8)


def test_nothing_is_asked_below_a_violation() -> None:
    def step(dead: int, letter: Valuation) -> tuple[int, Judgement]:
        if dead:
            raise AssertionError("stepped after a violation")
        return (0, PENDING) if letter[0] else (1, VIOLATED)

    assert compare(
        Monitor(0, step), read("the sw shall always satisfy q"), 0, ("q",)
    ) == Equivalence(2, 4)


def test_satisfied_is_for_ever_and_must_be_said_at_once() -> None:
    sentence = read("the sw shall within 1 tick satisfy q")

    judgement = ("satisfied", True)
    right: Table = {
        (0, False): (1, PENDING),
        (0, True): (2, judgement),
        (1, False): (1, VIOLATED),
        (1, True): (2, judgement),
        (2, False): (2, judgement),
        (2, True): (2, judgement),
    }
    late: Table = right | {(0, True): (2, PENDING)}
    assert isinstance(compare(tabled(right), sentence, 1, ("q",)), Equivalence)
    assert compare(tabled(late), sentence, 1, ("q",)) == DifferingTrace(
        ((True,),), expected=judgement, actual=PENDING
    )


def test_a_lost_cause_is_told_though_fret_would_still_accept_the_trace() -> None:
    """The second trigger forbids the response that the first one demands."""
    sentence = read("whenever p the sw shall after 2 ticks satisfy q")
    silent = Monitor(0, lambda state, letter: (0, PENDING))
    only_broken = compare(silent, sentence, 2, ("p", "q"))
    assert only_broken == DifferingTrace(valuations("pq"), expected=VIOLATED, actual=PENDING)

    def step(count: int, letter: Valuation) -> tuple[int, Judgement]:
        p, q = letter
        if count == 0:
            return int(p), VIOLATED if p and q else PENDING
        if count == 3:
            return 0, PENDING if q and not p else VIOLATED
        return count + 1, VIOLATED if q else ("violated", True) if p else PENDING

    assert isinstance(compare(Monitor(0, step), sentence, 2, ("p", "q")), Equivalence)


# Refutations ----------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [1, 3, LONG])
@pytest.mark.parametrize("slip", [-1, 1])
def test_a_deadline_that_is_one_tick_off_is_found(n: int, slip: int) -> None:
    result = compare(within(n + slip), sentence_within(n), n, ("p", "q"))
    wrong_at = n if slip > 0 else n - 1
    judgements = (VIOLATED, PENDING) if slip > 0 else (PENDING, VIOLATED)
    assert result == DifferingTrace(((True, False), *[(False, False)] * wrong_at), *judgements)


def test_a_trigger_that_restarts_the_clock_is_found() -> None:
    result = compare(within(2, restarts=True), sentence_within(2), 2, ("p", "q"))
    assert result == DifferingTrace(valuations("p - p"), VIOLATED, PENDING)


@pytest.mark.slow
def test_a_trigger_that_restarts_a_long_clock_is_found() -> None:
    """There are millions of pairs, but some thousand states decide."""
    n, most = (10_000, 10**6) if FULL else (500, 25_000)
    result = compare(within(n, restarts=True), sentence_within(n), n, ("p", "q"), most)
    assert isinstance(result, DifferingTrace)
    assert len(result.word) == n + 1
    assert result.word[0] == (True, False)
    assert any(p for p, _ in result.word[1:])
    assert not result.shortest


def test_the_verdict_on_the_finite_trace_counts() -> None:
    """FRET accepts a trace that ends before the deadline; this monitor does not."""

    def step(waited: int, letter: Valuation) -> tuple[int, Judgement]:
        after, (verdict, _) = within(2).transition(waited, letter)
        return after, (verdict, after == 0)

    result = compare(Monitor(0, step), sentence_within(2), 2, ("p", "q"))
    assert result == DifferingTrace(valuations("p"), expected=PENDING, actual=("pending", False))


def test_a_rule_for_every_tick_is_not_one_for_rising_edges() -> None:
    sentence = read("upon p the sw shall within 1 tick satisfy q")
    result = compare(within(1), sentence, 1, ("p", "q"))
    assert result == DifferingTrace(valuations("pq p -"), expected=PENDING, actual=VIOLATED)


def test_no_shorter_word_tells_the_two_apart() -> None:
    """All words up to the length of the refutation, through the right monitor and the wrong."""
    result = compare(within(3, restarts=True), sentence_within(3), 3, ("p", "q"))
    assert isinstance(result, DifferingTrace)

    def judgements(monitor: Monitor, word: tuple[Valuation, ...]) -> list[Judgement]:
        judgements = [monitor.step(letter) for letter in word]
        lost = [k for k, judgement in enumerate(judgements) if judgement == VIOLATED]
        return judgements[: lost[0] + 1] if lost else judgements

    for length in range(1, len(result.word)):
        for word in product(LETTERS, repeat=length):
            assert judgements(within(3), word) == judgements(within(3, restarts=True), word)
    assert judgements(within(3), result.word) != judgements(within(3, restarts=True), result.word)


LETTERS = tuple(product((False, True), repeat=2))
JUDGEMENTS: tuple[Judgement, ...] = (PENDING, VIOLATED, ("satisfied", True), ("pending", False))
Steps = dict[tuple[int, Valuation], tuple[int, Judgement]]


def with_a_double() -> Steps:
    """`within 2 ticks` in four states, of which 3 is another 1."""
    right = {(k, letter): within(2).transition(k, letter) for k in range(3) for letter in LETTERS}
    return right | {(3, letter): right[1, letter] for letter in LETTERS}


def tell_apart(steps: Steps) -> bool:
    """Whether a trace tells the machine from `within 2 ticks`: all pairs, again and again."""
    pairs = {(0, 0)}
    while True:
        reached = set(pairs)
        for (right, state), letter in product(pairs, LETTERS):
            expected, result = within(2).transition(right, letter), steps[state, letter]
            if expected[1] != result[1]:
                return True
            if result[1] != VIOLATED:
                reached.add((expected[0], result[0]))
        if reached == pairs:
            return False
        pairs = reached


@given(
    st.dictionaries(
        st.tuples(st.integers(0, 3), st.sampled_from(LETTERS)),
        st.tuples(st.integers(0, 3), st.sampled_from(JUDGEMENTS[:1] * 5 + JUDGEMENTS)),
        max_size=3,
    )
)
def test_what_is_proved_is_equal_and_what_is_equal_is_proved(changes: Steps) -> None:
    steps = with_a_double() | changes
    machine = Monitor(0, lambda state, letter: steps[state, letter])
    result = compare(machine, sentence_within(2), 2, ("p", "q"))
    assert isinstance(result, DifferingTrace) is tell_apart(steps)
    assert isinstance(result, DifferingTrace) is not isinstance(result, Equivalence)
    if isinstance(result, DifferingTrace):
        right, wrong = within(2), Monitor(0, machine.transition)
        judgements = [(right.step(letter), wrong.step(letter)) for letter in result.word]
        assert judgements[-1] == (result.expected, result.actual)
        assert all(one == other for one, other in judgements[:-1])


# What cannot be checked -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "predicate"),
    [
        ("whenever persisted(2, p) the sw shall immediately satisfy q", "persisted"),
        ("the sw shall always satisfy occurred(1, 3, q)", "occurred"),
        ("while prevOcc(p, q) the sw shall always satisfy q", "prevOcc"),
        ("upon p & preBool(false, q) the sw shall immediately satisfy q", "preBool"),
        ("the sw shall until nextOcc(p, q) satisfy q", "nextOcc"),
        ("the sw shall always satisfy occurs(2, q)", "occurs"),
        ("the sw shall always satisfy persists(2, q)", "persists"),
        ("the sw shall always satisfy !FTP -> q", "FTP"),
    ],
)
def test_predicates_about_other_ticks_are_left(text: str, predicate: str) -> None:
    result = compare(within(0), read(text), 0, ("p", "q"))
    assert (
        result == f"`{predicate}` refers to other ticks, and the automaton reads one tick at a time"
    )


def test_thirteen_propositions_are_too_many() -> None:
    names = ("p", "q", *(f"r{k}" for k in range(11)))
    result = compare(within(3), sentence_within(3), 3, names)
    assert result == "13 propositions, more than 12"


def test_an_automaton_may_be_too_large() -> None:
    sentence = read("only before m whenever p the sw shall after 500 ticks satisfy q")
    result = compare(within(3), sentence, 500, ("m", "p", "q"), limit=1000)
    assert result == "the automaton has more than 1000 states"


def test_a_monitor_may_never_come_back() -> None:
    counting = Monitor(0, lambda ticks, letter: (ticks + 1, PENDING if letter[0] else VIOLATED))
    result = compare(counting, read("the sw shall always satisfy q"), 0, ("q",), limit=1000)
    assert result == "the automaton and the monitor have more than 1000 states"


def test_an_atom_that_is_not_named_is_the_callers_mistake() -> None:
    with pytest.raises(KeyError, match="q"):
        compare(within(3), sentence_within(3), 3, ("p",))


# Letters --------------------------------------------------------------------------------------


def test_what_the_values_of_the_atoms_make_of_the_expressions() -> None:
    sentence = read("before x > 3 upon a & b the sw shall until a satisfy b -> x > 3")
    assert letters_by_valuation(sentence, ("(x > 3)", "a", "b")) == {
        (False, False, False): (False, False, True, False),
        (False, False, True): (False, False, False, False),
        (False, True, False): (False, False, True, True),
        (False, True, True): (False, True, False, True),
        (True, False, False): (True, False, True, False),
        (True, False, True): (True, False, True, False),
        (True, True, False): (True, False, True, True),
        (True, True, True): (True, True, True, True),
    }


def test_what_a_sentence_lacks_is_false() -> None:
    letters = letters_by_valuation(read("the sw shall always satisfy q"), ("q",))
    assert letters == {(False,): (False,) * 4, (True,): (False, False, True, False)}


@pytest.mark.slow
@given(sentences)
def test_letters_have_the_values_of_the_expressions(sentence: s.Sentence) -> None:
    timing = sentence.timing
    read = [
        boolean(part, Uninterpreted().alone()) if part is not None else f.FALSE
        for part in (
            sentence.scope.mode if sentence.scope else None,
            sentence.condition.expression if sentence.condition else None,
            sentence.response,
            timing.stop if isinstance(timing, s.Until | s.Before) else None,
        )
    ]
    names = tuple(dict.fromkeys(name for formula in read for name in f.atoms(formula)))
    assume(len(names) <= 6)
    letters = letters_by_valuation(sentence, names)
    assert len(letters) == 2 ** len(names)
    for valuation, letter in letters.items():
        row = dict(zip(names, valuation, strict=True))
        assert letter == tuple(holds(formula, [row]) for formula in read)


@needs_deep_calls
def test_a_deep_expression_is_read() -> None:
    response: e.Expression = e.Name("q")
    for _ in range(1000):
        response = e.both(e.Name("p"), e.Not(response))
        response = e.Implies(e.Name("p"), response)
    sentence = s.Sentence(None, None, "sw", None, s.Always(), response)
    assert letters_by_valuation(sentence, ("p", "q"))[False, False] == (False, False, True, False)
