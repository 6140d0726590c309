"""Numbers of the tick before: what is certain of them, and what is left open."""

import pytest

from fretc.analysis.findings import Verdict
from tests.requirement_sets import analyzed, conflicts, roles

RATE = "the sw shall always satisfy absReal(v - preReal(0.0, v)) <= 1"
NAMED = roles(["t", "a"], ["v", "x"])


@pytest.mark.parametrize(
    "others",
    [
        ["the sw shall always satisfy v <= 10"],
        [
            "the sw shall always satisfy v >= 0 & v <= 10",
            "when a the sw shall eventually satisfy x",
        ],
        ["whenever preReal(0.0, v) > 3 the sw shall immediately satisfy v > 2 & v < 9"],
        ["whenever preReal(0.0, t) > 2 the sw shall immediately satisfy v < 0.5"],
    ],
)
def test_a_rate_can_be_kept(others: list[str]) -> None:
    found = analyzed(RATE, *others, roles=NAMED)
    assert found.verdict is Verdict.REALIZABLE, found.why


def test_the_first_tick_has_the_number_that_stands_there() -> None:
    late = "whenever preReal({}, v) > 3 the sw shall immediately satisfy v > 9"
    rest = ("the sw shall always satisfy v <= 3",)
    assert analyzed(late.format("0.0"), *rest, roles=NAMED).verdict is Verdict.REALIZABLE
    assert conflicts(analyzed(late.format("4.0"), *rest, roles=NAMED)) == [("R1", "R2")]


def test_what_is_not_remembered_is_left_open() -> None:
    """From 0 by steps of 1 it takes five ticks to 5; no comparison tells 4 from 1."""
    jump = "whenever preBool(false, a) the sw shall immediately satisfy v >= 5"
    found = analyzed(RATE, jump, roles=NAMED)
    assert found.verdict is Verdict.NOT_CHECKED
    assert "no more is remembered than which comparisons it makes true" in found.why


def test_conflicts_with_the_past_and_beside_it_are_found() -> None:
    fight = (
        "whenever a the sw shall immediately satisfy v > 3",
        "the sw shall never satisfy v > 2",
    )
    found = analyzed(RATE, *fight, roles=NAMED)
    assert found.verdict is Verdict.UNREALIZABLE
    assert conflicts(found) == [("R1", "R2"), ("R2", "R3")]
    with_the_past, beside_it = found.conflicts
    assert "no play is shown" in with_the_past.because
    assert beside_it.play
    assert not found.complete


@pytest.mark.parametrize("start", ["0.0", "7.0"])
def test_what_no_number_before_helps_cannot_be_kept(start: str) -> None:
    """Whoever comes from below 1 by steps of 1 is not above 5 at the next tick."""
    sentences = (
        "the sw shall always satisfy v - preReal(0.0, v) <= 1",
        "whenever !a the sw shall immediately satisfy v < 1",
        "whenever a the sw shall immediately satisfy v > 5",
    )
    found = analyzed(*sentences, roles=NAMED)
    assert found.verdict is Verdict.UNREALIZABLE
    assert conflicts(found) == [("R1", "R3")]  # a may come at the first tick
    later = [each.replace("0.0", start) for each in sentences]
    found = analyzed(*later, roles=NAMED)
    assert conflicts(found) == [("R1", "R3") if start == "0.0" else ("R1", "R2", "R3")]
