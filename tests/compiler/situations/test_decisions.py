"""Operands that decide alone, unknown ones, and numbers beside thresholds."""

from __future__ import annotations

import random
from collections.abc import Mapping
from decimal import Decimal
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.formalization import reference
from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import letters_by_valuation
from compiler.formalization.reference import ReferenceState, step
from compiler.logic.evaluation import evaluate, evaluate_unknown
from compiler.logic.formula import atoms
from compiler.situations.situations import MEANINGS, Situation, situations
from compiler.situations.thresholds import ThresholdPosition, literal_number, threshold_positions
from fretish import expressions as e
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.printer import expression
from fretish.printer import sentence as printed
from fretish.syntax import Sentence
from monitors.kernel.columns import Column
from tests.bound_requirements import bound_requirement
from tests.effort import FULL
from tests.emitting import requirement
from tests.strategies import sentences

PARTS = {"mode": 0, "condition": 1, "response": 2, "stop": 3}
COMPOUND = (
    "while a & b, upon c | !d & g the sw shall within 2 ticks satisfy q xor r",
    "except while a -> b, whenever c & d the sw shall until s | u satisfy q <-> r",
    "before a | b, the sw shall always satisfy q & (r | !t)",
    "after a & !b, upon c the sw shall before s & u satisfy q | r",
    "only after a | b, whenever c xor d the sw shall for 2 ticks satisfy q & r",
    "only before a & b, upon c & d the sw shall at the next timepoint satisfy q | r",
    "only while a | b, the sw shall finally satisfy q & r",
    "whenever a & b the sw shall immediately satisfy q | r",
    "upon a | b the sw shall eventually satisfy q & r",
    "only after a | b, the sw shall after 1 tick satisfy q & r",
)
"""No atom stands in two parts, so that each flips one letter."""


class Judged:
    """A sentence of independent atoms, by its letters."""

    def __init__(self, sentence: str) -> None:
        self.requirement = requirement(sentence)
        self.atoms = tuple(sorted(self.requirement.propositions))
        self.letters = letters_by_valuation(self.requirement.sentence, self.atoms)
        self.counted = reference.template(self.requirement.sentence, self.requirement.ticks or 0)

    def letter(self, row: Mapping[str, bool]) -> tuple[bool, bool, bool, bool]:
        return self.letters[tuple(row[name] for name in self.atoms)]

    def result(self, before: ReferenceState, row: Mapping[str, bool], part: int) -> object:
        """What the tick leaves, as far as the part can matter."""
        after = step(self.counted, before, *self.letter(row))
        if after is None:
            return None
        return after.phase if part == 0 else (after.phase, after.counted)

    def run(
        self, choose: random.Random, length: int
    ) -> list[tuple[ReferenceState, dict[str, bool]]]:
        """Ticks, each with the state before it; only the last one may break anything."""
        state: ReferenceState | None = reference.initial(self.counted)
        found: list[tuple[ReferenceState, dict[str, bool]]] = []
        odds = {name: choose.choice((0.25, 0.5, 0.75)) for name in self.atoms}
        while state is not None and len(found) < length:
            rows = [{name: choose.random() < odds[name] for name in odds} for _ in range(8)]
            keeping = [row for row in rows if step(self.counted, state, *self.letter(row))]
            row = next(iter(keeping if len(found) < length - 1 else rows), rows[0])
            found.append((state, row))
            state = step(self.counted, state, *self.letter(row))
        return found

    def decides(
        self, before: ReferenceState, row: Mapping[str, bool], atom: str, part: int
    ) -> bool:
        other = {**row, atom: not row[atom]}
        return self.result(before, row, part) != self.result(before, other, part)


@pytest.mark.slow
@pytest.mark.parametrize("sentence", COMPOUND)
def test_an_operand_decides_alone_where_its_opposite_leads_elsewhere(sentence: str) -> None:
    judged = Judged(sentence)
    listed = {each.key: each for each in situations(judged.requirement)}
    choose, seen = random.Random(sentence), set[str]()
    alone = {key for key in listed if key.startswith("alone-")}
    for number in range(500):
        if not FULL and number >= 30 and seen == alone:
            break
        run = judged.run(choose, choose.choice((1, 1, 2, 3, 6)))
        bits = {n: sum(row[n] << t for t, (_, row) in enumerate(run)) for n in judged.atoms}
        for (name, part), atom in product(PARTS.items(), judged.atoms):
            keys = {v: f"alone-{str(v).lower()}:{name}:{atom}" for v in (True, False)}
            if keys[True] not in listed:
                continue
            columns = {v: evaluate(listed[keys[v]].formula, bits, len(run)) for v in keys}
            for at, (state, row) in enumerate(run):
                if name == "mode" and step(judged.counted, state, *judged.letter(row)) is None:
                    continue
                shown = {value: bool(columns[value] >> at & 1) for value in columns}
                expected = judged.decides(state, row, atom, part)
                value = judged.letter(row)[part]
                assert shown == {True: expected and value, False: expected and not value}
                seen |= {keys[v] for v in shown if shown[v]}
    assert seen == alone


@pytest.mark.slow
@pytest.mark.parametrize("sentence", COMPOUND)
def test_an_unknown_decides_where_both_values_may_lead_elsewhere(sentence: str) -> None:
    """The formula holds for certain, though the atom that it is about is unknown."""
    judged = Judged(sentence)
    choose, seen = random.Random(sentence), set[str]()
    listed = [each for each in situations(judged.requirement) if each.unknown is not None]
    assert {each.unknown for each in listed} == {*judged.atoms}
    for each, number in product(listed, range(300)):
        assert each.unknown is not None
        if not FULL and number >= 10 and each.key in seen:
            continue
        run = judged.run(choose, choose.randrange(1, 6))
        state, row = run[-1]
        at, length = len(run) - 1, len(run)
        if step(judged.counted, state, *judged.letter(row)) is None and ":mode:" in each.key:
            continue
        bits = {n: sum(row[n] << t for t, (_, row) in enumerate(run)) for n in judged.atoms}
        columns = {name: Column(true, 0) for name, true in bits.items()}
        columns[each.unknown] = Column(bits[each.unknown] & ~(1 << at), 1 << at)
        certain = evaluate_unknown(each.formula, columns, length).true >> at & 1
        part = PARTS[each.key.split(":")[1]]
        assert certain == judged.decides(state, row, each.unknown, part)
        seen |= {each.key} if certain else set()
    assert seen == {each.key for each in listed}


@pytest.mark.slow
@given(sentences)
def test_keys_are_unique_and_in_the_order_of_the_list(sentence: Sentence) -> None:
    made, _ = formalize(RequirementEntry("R1", Source("r.fret", printed(sentence)).span()), None)
    if made is None:
        return
    listed = situations(made)
    keys = [each.key for each in listed]
    assert len({*keys}) == len(keys)
    order = [*MEANINGS]
    places_of = [order.index(key.partition(":")[0]) for key in keys]
    assert places_of == sorted(places_of)
    assert all(set(atoms(each.formula)) <= {*made.propositions} for each in listed)
    assert not any("{" in each.words or "``" in each.words for each in listed)
    assert situations(made) == listed


# Thresholds -------------------------------------------------------------------------------------

BINDINGS = """
[clock]
time = "log_time"
tick = "100 ms"

[signal.person]
path = "/person.data"
unit = "m"
max_age = "1 s"

[signal.speed]
path = "/odom.speed"
unit = "m/s"
max_age = "1 s"

[proposition.stands]
expr = "abs(speed) < 0.010 m/s for 200 ms"
"""


def bound(sentence: str) -> FormalizedRequirement:
    return bound_requirement(sentence, BINDINGS)


def thresholds(made: FormalizedRequirement) -> list[Situation]:
    return [each for each in situations(made) if each.place is not None]


def test_a_threshold_is_met_a_step_below_at_and_above_it_in_the_unit_it_is_written_in() -> None:
    made = bound("whenever person < 120 cm the sw shall within 1 second satisfy stands")
    assert [(each.key, each.words) for each in thresholds(made)] == [
        (
            "threshold-below:condition:person<120cm",
            "`person` one step below the threshold of `person < 120 cm` (119 cm)",
        ),
        (
            "threshold-below:response:stands:abs(speed)<0.010m/s",
            "`abs(speed)` one step below the threshold of `stands` (0.009 m/s)",
        ),
        (
            "threshold-at:condition:person<120cm",
            "`person` at the threshold of `person < 120 cm` (120 cm)",
        ),
        (
            "threshold-at:response:stands:abs(speed)<0.010m/s",
            "`abs(speed)` at the threshold of `stands` (0.010 m/s)",
        ),
        (
            "threshold-above:condition:person<120cm",
            "`person` one step above the threshold of `person < 120 cm` (121 cm)",
        ),
        (
            "threshold-above:response:stands:abs(speed)<0.010m/s",
            "`abs(speed)` one step above the threshold of `stands` (0.011 m/s)",
        ),
    ]
    at = thresholds(made)[2].place
    assert at is not None
    assert expression(at.exact) == "person = 120 cm"
    assert expression(at.near) == "person >= 119.5 cm & person < 120.5 cm"


@pytest.mark.parametrize("text", ["5", "0.40", "1.5e-3", "20"])
@pytest.mark.parametrize("negative", [False, True])
def test_each_number_is_near_one_of_the_places_around_a_threshold(
    text: str, *, negative: bool
) -> None:
    """The three places lie side by side, and a number between two of them is near just one."""
    side: e.Expression = e.Negation(e.Number(text)) if negative else e.Number(text)
    found: list[ThresholdPosition] = [
        place for _, place in threshold_positions(e.Comparison("<", e.Name("x"), side))
    ]
    numbers = [
        literal_number(part) for each in found for part in (each.least, each.number, each.limit)
    ]
    values = [each.value for each in numbers if each is not None]
    step_ = literal_number(side)
    assert step_ is not None
    assert values[1::3] == [step_.value - step_.step, step_.value, step_.value + step_.step]
    assert values[2:7:3] == values[3::3]
    assert values[8] - values[0] == 3 * step_.step
    assert places_of_mirrored(side) == found


def places_of_mirrored(side: e.Expression) -> list[ThresholdPosition]:
    return [place for _, place in threshold_positions(e.Comparison(">", side, e.Name("x")))]


@pytest.mark.parametrize(
    "comparison",
    [
        e.Comparison("<", e.Name("x"), e.Name("y")),
        e.Comparison("<", e.Number("2"), e.Number("3")),
        e.Comparison("=", e.Name("mode"), e.Word("docking")),
        e.Comparison("<", e.Name("x"), e.Number("1e999999999")),
        e.Comparison("<", e.Name("x"), e.Number("9" * 100)),
    ],
)
def test_what_is_no_number_of_a_common_size_is_no_threshold(comparison: e.Comparison) -> None:
    assert [*threshold_positions(comparison)] == []


@given(st.decimals(allow_nan=False, allow_infinity=False, places=3, min_value=-99, max_value=99))
def test_a_number_is_written_as_it_was_moved(by: Decimal) -> None:
    five = literal_number(e.Quantity("5.00", "cm"))
    assert five is not None
    moved = literal_number(five.moved(by))
    assert moved is not None
    assert moved.value == Decimal("5.00") + by
