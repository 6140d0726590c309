"""Each stretch is in exactly one mark, at its time, and no cut hides what is worse."""

from collections import Counter
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.report.across.lanes import MOST_LANES, plan
from fretc.report.across.stretches import Stretches
from fretc.report.model.pictures import LaneMark, Lanes
from fretc.report.model.results import ResultRow
from tests.effort import examples
from tests.fretc.report.cases import row

times = st.floats(0, 1e4).map(lambda number: round(number, 3))
spans = st.lists(st.tuples(times, times).map(lambda pair: (min(pair), max(pair))), max_size=60)


@st.composite
def stretches(draw: st.DrawFn) -> Stretches:
    return Stretches(
        draw(times),
        tuple(draw(spans)),
        tuple(draw(spans)),
        tuple(draw(st.lists(times, max_size=4))),
    )


Drawn = list[tuple[ResultRow, Stretches]]


def lanes(drawn: Drawn, most: int = MOST_LANES, marks: int = 1_200) -> Lanes | None:
    """The picture of results with these stretches."""
    chosen = plan("all", [each for each, _ in drawn], most, marks)
    return chosen.lanes({each.place: (own, ()) for each, own in drawn})


def result(place: int, word: str, own: Stretches, run: int, id: str) -> tuple[ResultRow, Stretches]:
    count = {
        "violations_total": len(own.violations),
        "unknown": len(own.unknown),
        "open": len(own.open),
    }
    return row(run, word, id, place=place, **count), own


@st.composite
def results(draw: st.DrawFn) -> Drawn:
    found: Drawn = []
    for run in range(draw(st.integers(1, 6))):
        for id in draw(st.sampled_from([("R1",), ("R1", "R2")])):
            own = draw(stretches())
            word = "violated" if own.violations else draw(st.sampled_from(["satisfied", "no data"]))
            found.append(result(len(found), word, own, run, id))
    return found


def expected(own: Stretches) -> list[tuple[str, float, float]]:
    return [
        *(("violated", *span) for span in own.violations),
        *(("unknown", *span) for span in own.unknown),
        *(("open", start, max(start, own.length)) for start in own.open),
    ]


def covers(mark: LaneMark, kind: str, start: float, end: float, id: str) -> bool:
    inside = mark.start - 1e-6 <= start and end <= mark.end + 1e-6
    return mark.kind == kind and inside and id in mark.requirements


@pytest.mark.slow
@given(results(), st.integers(1, 40), st.sampled_from([1, 30, 1000]))
@examples(20)
def test_each_stretch_is_in_exactly_one_mark_at_its_time(
    drawn: Drawn, most: int, marks: int
) -> None:
    picture = lanes(drawn, most, marks)
    if picture is None:
        runs = {each.run for each, _ in drawn}
        ends = [end for _, own in drawn for _, _, end in expected(own)]
        assert len(runs) > most or not any(ends)  # the worst may be runs without a tick
        return
    for lane in picture.lanes:
        mine = [pair for pair in drawn if pair[0].run == lane.anchor]
        of_run = [(*one, each.requirement) for each, own in mine for one in expected(own)]
        for one in of_run:
            assert any(covers(mark, *one) for mark in lane.marks), one
        counts = Counter(dict.fromkeys(("violated", "unknown", "open"), 0))
        for mark in lane.marks:
            counts[mark.kind] += mark.count
        assert counts == counts | Counter(kind for kind, *_ in of_run)
        assert sum(counts.values()) == len(of_run)
        for kind in counts:  # marks of one kind lie apart: a stretch is not in two of them
            of_kind = [mark for mark in lane.marks if mark.kind == kind]
            assert all(a.end <= b.start + 2e-6 for a, b in pairwise(of_kind))


@pytest.mark.slow
@given(results(), st.integers(1, 5))
@examples(20)
def test_what_is_left_out_is_counted_and_never_worse(drawn: Drawn, most: int) -> None:
    picture = lanes(drawn, most)
    runs = {each.run for each, _ in drawn}
    if picture is None:
        return
    kept = {lane.anchor for lane in picture.lanes}
    left = [each for each, _ in drawn if each.run not in kept]
    assert len(kept) == min(most, len(runs))
    assert picture.left_out.startswith(f"{len(runs) - len(kept)} run") == (len(runs) > len(kept))
    worst = max(lane.mark.severity for lane in picture.lanes)
    assert all(each.mark.severity >= worst for each in left)
    total = sum(each.count[0] for each in left)
    assert (f"{total} violation" in picture.left_out) == bool(total)


def one(
    run: int, length: float, *violations: tuple[float, float], id: str = "R1"
) -> tuple[ResultRow, Stretches]:
    word = "violated" if violations else "satisfied"
    own = Stretches(length, violations, (), ())
    return result(hash((id, run)), word, own, run, id)


def picture(*drawn: tuple[ResultRow, Stretches]) -> Lanes:
    found = lanes([*drawn])
    assert found is not None
    return found


def test_a_mark_leads_to_the_first_of_its_violations() -> None:
    (lane,) = picture(
        one(1, 100.0, (3.0, 3.1), (50.0, 51.0)), one(1, 100.0, (50.5, 52.0), id="R2")
    ).lanes
    assert [(m.start, m.end, m.count, m.anchor, m.number, m.requirements) for m in lane.marks] == [
        (3.0, 3.1, 1, "R1.1", 1, ("R1",)),
        (50.0, 52.0, 2, "R1.1", 2, ("R1", "R2")),
    ]
    assert lane.marks[1].text == "R1 and R2: 2 violations, 50 s to 52 s"


def test_the_text_says_the_same() -> None:
    drawn = picture(one(1, 9.0), one(2, 10.0, (3.0, 3.1)))
    assert drawn.text == "Run 2 (2.mcap): 1 violation; 1 run without such a tick."
