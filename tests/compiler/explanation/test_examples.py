"""Traces that explain a sentence: right, short, different, and decided when a monitor says so."""

from functools import cache
from itertools import product

import pytest

from compiler.explanation import examples as made_of
from compiler.explanation.examples import Example, Examples, examples
from compiler.explanation.reasons import why
from compiler.formalization.formalized import FormalizedRequirement
from tests import meaning
from tests.effort import FULL
from tests.monitoring import monitor, requirement, steps
from tests.spot_oracle import holds_on
from tests.strategies import Template, some_templates

QUIET = 3
"""Rounds after a trace that are looked at."""


@cache
def found(sentence: str) -> tuple[FormalizedRequirement, Examples]:
    made = requirement(sentence)
    return made, examples(made)


def every(scope: str, counts: tuple[int, ...]) -> list[Template]:
    return [drawn for drawn in some_templates(counts) if drawn.scope == scope]


def columns(atoms: tuple[str, ...], example: Example, rounds: int) -> dict[str, list[bool]]:
    word = (*example.prefix, *example.loop * rounds)
    return {name: [values[i] for values in word] for i, name in enumerate(atoms)}


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_a_trace_is_judged_as_fretish_means_it_however_often_it_repeats(scope: str) -> None:
    for drawn in every(scope, (0, 1, 2, 5) if FULL else (0, 2, 5)):
        _, told = found(drawn.sentence)
        for example in (*told.satisfied, *told.violated):
            for rounds in range(QUIET if example.loop else 1):
                rows = columns(told.atoms, example, rounds)
                assert drawn.satisfied(rows) is example.satisfied, (drawn, example)


@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_every_template_has_traces_of_both_kinds_and_mostly_two(scope: str) -> None:
    for drawn in every(scope, (0, 2)):
        _, told = found(drawn.sentence)
        assert 1 <= len(told.satisfied) <= 2, drawn
        assert 1 <= len(told.violated) <= 2, drawn
        assert len({*told.satisfied, *told.violated}) == len(told.satisfied) + len(told.violated)
        if drawn.condition != "null":
            assert len(told.satisfied) == len(told.violated) == 2, drawn


@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_the_first_violation_is_a_shortest_one(scope: str) -> None:
    """No shorter trace is violated whatever follows; or, if none ever is, at its end."""
    for drawn in every(scope, (0, 1)):
        _, told = found(drawn.sentence)
        first = told.violated[0]
        if first.decided is None or first.loop:
            continue
        names = drawn.columns
        for length in range(1, min(len(first.prefix), 4 if len(names) < 4 else 3)):
            for values in product((False, True), repeat=length * len(names)):
                rows = {name: list(values[i :: len(names)]) for i, name in enumerate(names)}
                assert drawn.satisfied(rows) or not is_doomed(drawn, rows), (drawn, rows)


def is_doomed(drawn: Template, rows: dict[str, list[bool]]) -> bool:
    """Whether no continuation by up to two ticks satisfies it."""
    names = drawn.columns
    for more in (1, 2):
        for values in product((False, True), repeat=more * len(names)):
            longer = {n: rows[n] + list(values[i :: len(names)]) for i, n in enumerate(names)}
            if drawn.satisfied(longer):
                return False
    return True


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_a_monitor_decides_at_the_same_tick(scope: str) -> None:
    for drawn in (each for each in some_templates((2,)) if each.scope == scope):
        _, told = found(drawn.sentence)
        machine = monitor(drawn.sentence)
        for example in (*told.satisfied, *told.violated):
            rows = columns(told.atoms, example, 1)
            stepped = steps(machine, {name: rows[name] for name in machine.PROPOSITIONS})
            at_end = stepped[len(example.prefix) - 1]
            assert at_end.finite is example.satisfied, (drawn, example)
            verdict = "satisfied" if example.satisfied else "violated"
            decided = next((step.tick for step in stepped if step.decided == verdict), None)
            if drawn.timing == "finally" and scope in ("null", "after", "onlyBefore"):
                assert example.decided is None  # an endless run has no last tick
            else:
                assert decided == example.decided, (drawn, example)


@pytest.mark.slow
@pytest.mark.parametrize("scope", ["null", "in", "after", "onlyBefore"])
def test_spot_judges_endless_traces_alike(scope: str) -> None:
    for drawn in every(scope, (1,)):
        if drawn.condition == "regular" and drawn.timing not in ("eventually", "within"):
            continue  # time
        made, told = found(drawn.sentence)
        for example in (*told.satisfied, *told.violated):
            if not example.loop and example.decided is None:
                continue
            prefix = [dict(zip(told.atoms, values, strict=True)) for values in example.prefix]
            loop = [dict(zip(told.atoms, values, strict=True)) for values in example.loop]
            said = holds_on(made.ft_infinite, prefix, loop or prefix[-1:])
            assert said is example.satisfied, (drawn, example)


def test_within_is_answered_at_once_or_at_the_deadline_and_broken_by_silence_or_late() -> None:
    _, told = found("whenever p the sw shall within 2 ticks satisfy q")
    yes, no = True, False
    assert told.atoms == ("p", "q")
    assert told.satisfied == (
        Example(True, ((yes, yes),), ((no, no),), None),
        Example(True, ((yes, no), (no, no), (no, yes)), ((no, no),), None),
    )
    assert told.violated == (
        Example(False, ((yes, no), (no, no), (no, no)), (), 2),
        Example(False, ((yes, no), (no, no), (no, no), (no, yes)), (), 2),
    )


def test_a_demand_for_ever_later_is_violated_by_a_lasso() -> None:
    _, told = found("whenever p the sw shall eventually satisfy q")
    assert told.violated[0] == Example(False, ((True, False),), ((False, False),), None)


def test_what_cannot_be_violated_or_satisfied_has_no_trace() -> None:
    assert not found("the sw shall always satisfy q | !q")[1].violated
    assert not found("the sw shall always satisfy q & !q")[1].satisfied
    assert found("the sw shall always satisfy q | !q")[1].satisfied
    assert found("the sw shall always satisfy q & !q")[1].violated


def test_a_trace_is_of_the_propositions_of_compound_parts() -> None:
    _, told = found("whenever a & !b the sw shall immediately satisfy c | d")
    assert told.atoms == ("a", "b", "c", "d")
    assert told.violated[0].prefix == ((True, False, False, False),)


def test_a_verdict_is_certain_before_the_trace_ends_where_parts_share_propositions() -> None:
    _, told = found("whenever !p the sw shall after 3 ticks satisfy p")
    assert {example.decided for example in told.violated} == {0}


@pytest.mark.slow
def test_long_bounds_have_traces_and_too_long_ones_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    _, told = found("upon p the sw shall within 1000 ticks satisfy q")
    assert [len(example.prefix) for example in told.satisfied] == [1, 1001]
    assert [example.decided for example in told.violated] == [1000, 1000]
    most = made_of.MOST_STATES if FULL else 2000
    monkeypatch.setattr(made_of, "MOST_STATES", most)
    _, none = found("only in m mode, whenever p the sw shall after 60 ticks satisfy q")
    assert none.note == f"its automaton has more than {most} states"
    assert not none.satisfied
    assert not none.violated


# Reasons --------------------------------------------------------------------------------------

REASONS = {
    ("whenever p the sw shall within 2 ticks satisfy q", "10 00 01"): (
        "triggered at tick 0, `q` is true at tick 2, 2 ticks later; the bound is 2 ticks"
    ),
    ("whenever p the sw shall within 2 ticks satisfy q", "10 00 00 01"): (
        "triggered at tick 0, `q` is true at tick 3 only, one tick too late; the bound is 2 ticks"
    ),
    ("upon p the sw shall for 2 ticks satisfy q", "11 00"): (
        "triggered at tick 0, `q` is false at tick 1, 1 tick later; it must be true at ticks 0 to "
        "2; the bound is 2 ticks"
    ),
    ("upon p the sw shall after 1 tick satisfy q", "10 00 01"): (
        "triggered at tick 0, `q` is false at ticks 0 to 1 and `q` is true at tick 2; the bound is "
        "1 tick"
    ),
    ("upon p the sw shall always satisfy q", "00 11 01 10"): (
        "triggered at tick 1, `q` is false at tick 3, 2 ticks later; it must be true from tick 1 on"
    ),
    ("upon p the sw shall immediately satisfy q", "00"): "`p` is never true: nothing is demanded",
    ("in m mode, the sw shall always satisfy q", "00"): (
        "the sentence is enforced at none of these ticks: nothing is demanded"
    ),
    ("in m mode, the sw shall within 3 ticks satisfy q", "10 10 00"): (
        "begins at tick 0, and the scope ends at tick 1, before the deadline at tick 3: nothing is "
        "required; the bound is 3 ticks"
    ),
    ("in m mode, the sw shall eventually satisfy q", "10 10 00"): (
        "begins at tick 0, `q` is false at ticks 0 to 1, where the scope ends"
    ),
    ("the sw shall before s satisfy q", "00 01"): (
        "begins at tick 0, `q` is false at tick 0, and then `s` is true"
    ),
    (
        "the sw shall until s satisfy q",
        "10 01",
    ): "begins at tick 0, `q` is true at tick 0, until `s`",
    ("whenever p the sw shall immediately satisfy q", "11 11 11 11"): (
        "triggered at tick 0, `q` is true at tick 0; triggered at tick 1, `q` is true at tick 1; "
        "and so on, 2 more times"
    ),
}


@pytest.mark.parametrize(("sentence", "word"), REASONS)
def test_a_reason_names_trigger_answer_and_bound(sentence: str, word: str) -> None:
    made, told = found(sentence)
    rows = [dict(zip(told.atoms, (c == "1" for c in tick), strict=True)) for tick in word.split()]
    letters = [tuple(row.get(name, False) for name in "mpqs") for row in rows]
    assert why(made, letters) == REASONS[sentence, word]  # type: ignore[arg-type]


def test_a_reason_says_never_of_an_endless_run() -> None:
    made, _ = found("whenever p the sw shall eventually satisfy q")
    prefix, loop = [(False, True, False, False)], [(False, False, False, False)]
    assert why(made, prefix, loop) == ("triggered at tick 0, `q` is never true from that tick on")


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_a_reason_can_be_given_for_every_short_trace(scope: str) -> None:
    for drawn in every(scope, (1,)):
        made, told = found(drawn.sentence)
        for values in product((False, True), repeat=2 * len(told.atoms)):
            word = [values[: len(told.atoms)], values[len(told.atoms) :]]
            rows = [dict(zip(told.atoms, tick, strict=True)) for tick in word]
            letters = [tuple(row.get(name, False) for name in "mpqs") for row in rows]
            assert why(made, letters, ends=True)  # type: ignore[arg-type]
