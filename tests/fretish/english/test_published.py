"""How often the published sentence is among the readings of its English text."""

import pytest

from benchmarks.writing import Criterion, halves, is_offered, is_same, pairs
from fretish.diagnostics.source import Source
from fretish.parser import parse
from fretish.syntax import Sentence
from tests.effort import FRET, needs_fret

FLOORS = {Criterion.NEW_NAMES: 18, Criterion.KNOWN_NAMES: 20, Criterion.SAME_NAMES: 4}
"""Of the thirty requirements for which no rule was made."""


@pytest.mark.slow
@needs_fret
@pytest.mark.parametrize("criterion", Criterion)
def test_the_rules_read_as_many_as_they_did(criterion: Criterion) -> None:
    made, measured = halves(pairs(FRET))
    assert (len(made), len(measured)) == (31, 30)
    assert {(p.study, p.id) for p in made}.isdisjoint((p.study, p.id) for p in measured)
    right = [pair.id for pair in measured if is_offered(pair, criterion)]
    assert len(right) >= FLOORS[criterion]


def same(left: str, right: str, *, exact: bool = False) -> bool:
    one, other = (parse(Source("s", text).span()) for text in (left, right))
    assert isinstance(one, Sentence)
    assert isinstance(other, Sentence)
    return is_same(one, other, exact=exact)


def test_the_criterion_compares_meanings_up_to_names() -> None:
    always = "the sw shall always satisfy (a & x > 5) => b"
    assert same(always, "whenever x > 5 & a the sw shall immediately satisfy b", exact=True)
    assert same(always, "whenever q & p the robot shall immediately satisfy r")
    assert not same(always, "whenever q & p the robot shall immediately satisfy r", exact=True)
    assert not same(always, "when q & p the robot shall immediately satisfy r")
    assert not same(always, "whenever q & p the robot shall eventually satisfy r")
    assert same(
        "the sw shall always satisfy x <= 5", "the sw shall never satisfy x > 5", exact=True
    )
    assert not same("the sw shall always satisfy a", "the sw shall never satisfy a")
    assert same(
        "the sw shall never satisfy persisted(100, x > 50)",
        "the sw shall never satisfy persisted(100, long)",
    )
