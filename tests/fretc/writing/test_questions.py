"""Questions between readings, by the meaning of sentences and for each intent of a person."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from fretc.testing.runs import Absence
from fretc.testing.words import RunColumns
from fretc.writing import questions
from fretc.writing.choices import Choice, choice
from fretc.writing.questions import (
    Question,
    allows,
    answered,
    compare,
    next_question,
    shortened,
)
from fretish import syntax as s
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.english.vocabulary import Vocabulary
from fretish.expressions import And, Expression, Iff, Implies, Name, Not, Or, Truth
from tests import meaning
from tests.each import each
from tests.emitting import requirement

TEXTS = (
    "if the battery is low, the drone must return within 2 seconds",
    "when a is on, the robot shall stop",
    "while m is on, the robot shall not stop",
    "the robot shall stop before the gate opens",
    "the robot shall not stop until the gate opens",
    "unless p is on, the lamp shall be red",
    "the robot may only stop after p is on",
    "when p is on or q is on and r is on, it shall beep for 2 ticks",
    "the lamp shall be red if p is on at the time of departure",
    "after p is on, the lamp must never be red",
)


def made(text: str) -> Choice:
    found = choice(text, Vocabulary(), None)
    assert not isinstance(found, Diagnostic)
    return found


def holds(tree: Expression, values: dict[str, bool]) -> bool:
    match tree:
        case Truth(value):
            return value
        case Name(id):
            return values[id]
        case Not(arg):
            return not holds(arg, values)
        case And(args):
            return all(holds(arg, values) for arg in args)
        case Or(args):
            return any(holds(arg, values) for arg in args)
        case Iff(left, right):
            return holds(left, values) is holds(right, values)
        case Implies(left, right):
            return not holds(left, values) or holds(right, values)
        case _:
            raise AssertionError(tree)


def means(reading: FormalizedRequirement, run: Sequence[dict[str, bool]]) -> bool:
    """Whether the run satisfies the sentence, by `tests.meaning`."""
    tree = reading.sentence
    stop = s.stop(tree.timing)

    def column(part: Expression | None) -> list[bool]:
        return [part is not None and holds(part, values) for values in run]

    return meaning.satisfied(
        s.scope_key(tree),
        s.condition_key(tree),
        s.timing_key(tree),
        reading.ticks or 0,
        column(tree.scope.mode if tree.scope else None),
        column(tree.condition.expression if tree.condition else None),
        column(tree.response),
        column(stop),
    )


def ticks(run: RunColumns) -> list[dict[str, bool]]:
    return [
        {name: bool(column >> tick & 1) for name, column in run.columns.items()}
        for tick in range(run.ticks)
    ]


@each("text", TEXTS)
@pytest.mark.slow
def test_a_question_divides_the_readings_as_their_meanings_do(text: str) -> None:
    found = made(text)
    for question in found.questions:
        run = ticks(question.run)
        allowed = {i for i, each in enumerate(found.requirements) if means(each, run)}
        assert question.allowed == allowed
        rows = [dict(row.values) for row in question.run.rows for _ in range(row.count)]
        assert rows == run


@each("text", TEXTS)
@pytest.mark.slow
def test_each_reading_is_reached_by_its_answers_and_by_no_useless_question(text: str) -> None:
    found = made(text)
    for intent in range(len(found.readings)):
        remaining = tuple(range(len(found.readings)))
        asked = 0
        while (question := next_question(remaining, found.questions)) is not None:
            left = answered(remaining, question, may_happen=intent in question.allowed)
            assert intent in left
            assert len(left) < len(remaining)
            remaining, asked = left, asked + 1
        assert remaining == (intent,)
        assert asked < len(found.readings)


@each("text", TEXTS)
@pytest.mark.slow
def test_merged_readings_agree_on_all_short_runs(text: str) -> None:
    """And those that are kept differ on the run of some question."""
    found = made(text)
    for other, index in found.same:
        twin = requirement(other.text)
        kept = found.requirements[index]
        names = sorted({*twin.propositions, *kept.propositions})
        for length in range(1, 5 if len(names) < 3 else 4):
            for bits in product((False, True), repeat=length * len(names)):
                run = [
                    dict(zip(names, bits[t * len(names) :], strict=False)) for t in range(length)
                ]
                assert means(twin, run) is means(kept, run)


def test_readings_with_the_same_meaning_are_merged_into_the_first() -> None:
    texts = (
        "the sw shall always satisfy p => q",
        "whenever p the sw shall immediately satisfy q",
        "when p the sw shall immediately satisfy q",
        "in p mode, the sw shall always satisfy q",
    )
    compared = compare([requirement(text) for text in texts], 10)
    assert compared.kept == (0, 2)
    assert compared.same == ((1, 0), (3, 0))
    assert compared.undecided == ""


def test_no_question_is_left_where_all_answer_alike() -> None:
    run = RunColumns((), {}, 1)
    questions = [Question(run, frozenset({0, 1})), Question(run, frozenset({2}))]
    assert next_question((0, 1), questions) is None
    assert next_question((0, 2), questions) is questions[0]
    assert answered((0, 2), questions[1], may_happen=True) == (2,)
    assert answered((0, 2), questions[1], may_happen=False) == (0,)


def test_the_most_even_question_comes_first_then_one_whose_end_does_not_matter() -> None:
    short, long = RunColumns((), {}, 1), RunColumns((), {}, 2)
    uneven = Question(short, frozenset({0}))
    open_end = Question(short, frozenset({0, 1}), open=1)
    settled = Question(long, frozenset({0, 1}))
    assert next_question(range(4), [uneven, open_end, settled]) is settled


@pytest.mark.slow
def test_a_long_bound_has_a_short_table() -> None:
    within = [
        requirement(f"{w} p the sw shall within 600 ticks satisfy q") for w in ("when", "whenever")
    ]
    compared = compare(within, 10)
    question = next_question(compared.kept, compared.questions)
    assert question is not None
    assert question.run.ticks > 600
    assert len(question.run.rows) < 6


def test_a_shortened_run_has_the_first_ticks() -> None:
    found = made(TEXTS[0])
    longest = max((q.run for q in found.questions), key=lambda run: run.ticks)
    short = shortened(longest, 2)
    assert ticks(short) == ticks(longest)[:2]
    assert sum(row.count for row in short.rows) == 2
    assert allows(found.requirements[0], shortened(longest, longest.ticks)) is allows(
        found.requirements[0], longest
    )


def test_readings_that_cannot_be_compared_are_kept_and_the_reason_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(questions, "difference", lambda *_: Absence(why="it is too large"))
    compared = compare([requirement("the sw shall satisfy p"), requirement("p shall satisfy p")], 9)
    assert (compared.kept, compared.questions) == ((0, 1), ())
    assert compared.undecided == "it is too large"


CERTAIN = (
    # (text, run of "name=bits", whether every reading allows it)
    ("The lamp must never be on", "lamp_on=010", False),
    ("The lamp must never be on", "lamp_on=000", True),
    ("The lamp must always be on", "lamp_on=110", False),
    ("No lamp shall be on while m is on", "m_on=010 lamp_on=010", False),
    ("No lamp shall be on while m is on", "m_on=010 lamp_on=101", True),
    ("If p is on, the lamp must be red within 2 ticks", "p_on=1000 lamp_red=0000", False),
    ("If p is on, the lamp must be red within 2 ticks", "p_on=1000 lamp_red=0010", True),
    ("If p is on, the lamp must never be red", "p_on=0100 lamp_red=0100", False),
    ("The lamp must be red until p is on", "p_on=0010 lamp_red=1100", True),
    ("The lamp must be red until p is on", "p_on=0010 lamp_red=0000", False),
    ("The lamp must not be red before p is on", "p_on=0010 lamp_red=0100", False),
    ("The lamp must be red before p is on", "p_on=0010 lamp_red=0000", False),
    ("The lamp may only be red when p is on", "p_on=0110 lamp_red=0010", True),
    ("The lamp may only be red when p is on", "p_on=0110 lamp_red=0001", False),
    ("The lamp may only be red after p is on", "p_on=0010 lamp_red=1000", False),
    ("Unless p is on, the lamp must never be red", "p_on=0110 lamp_red=1000", False),
    ("The lamp must be red if and only if p is on", "p_on=0110 lamp_red=0110", True),
    ("The lamp must be red if and only if p is on", "p_on=0110 lamp_red=0111", False),
    ("p must be followed by q within 1 tick", "p=100 q=010", True),
    ("p must be followed by q within 1 tick", "p=100 q=001", False),
    ("If neither p nor q is on, it must immediately beep", "p_on=010 q_on=100 beep=001", True),
    ("If neither p nor q is on, it must immediately beep", "p_on=010 q_on=100 beep=000", False),
    (
        "The lamp must be red for more than 2 ticks after p is on",
        "p_on=10000 lamp_red=11000",
        False,
    ),
    ("The lamp must be red for more than 2 ticks after p is on", "p_on=10000 lamp_red=11110", True),
    ("It must beep every 2 ticks", "beep=01001001", True),
    ("It must beep every 2 ticks", "beep=01000010", False),
)


@each("case", CERTAIN)
@pytest.mark.slow
def test_no_reading_contradicts_what_the_text_leaves_no_doubt_about(
    case: tuple[str, str, bool],
) -> None:
    text, columns, expected = case
    bits = dict(part.split("=") for part in columns.split())
    run = [
        {name: values[tick] == "1" for name, values in bits.items()}
        for tick in range(len(next(iter(bits.values()))))
    ]
    found = made(text)
    assert [means(each, run) for each in found.requirements] == [expected] * len(found.readings)
