"""How much of a bound was used: by hand, and that no cut hides what is worse."""

from math import inf
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.evidence.schema import ThresholdRecord
from fretc.report.across.uses import RunThresholds, percent, uses
from tests.effort import examples
from tests.fretc.report.cases import row


def threshold(comparison: Any, least: Any, greatest: Any, **changes: Any) -> ThresholdRecord:
    kept = comparison in ("true", "false")
    near = greatest if comparison == "true" else least
    bound = changes.pop("bound", 0.4)
    margin = abs(bound - near) if kept and near is not None else None
    of: Any = ("fast", "vx", "<=", bound, "m/s", least, greatest, comparison, margin, None)
    return replace_record(ThresholdRecord(*of), **changes)


def replace_record(each: ThresholdRecord, **changes: Any) -> ThresholdRecord:
    from compiler.files.records import replace as changed

    return changed(each, **changes)


def run(number: int, word: str = "satisfied", **changes: Any) -> RunThresholds:
    thresholds = changes.pop("thresholds", ())
    return row(number, word, **changes), thresholds


def test_a_latency_is_a_part_of_the_time_allowed() -> None:
    found = uses([run(1, latency_max_s=0.1), run(2, latency_max_s=0.3), run(3, "violated")], 0.4, 9)
    assert found is not None
    assert [(row.label, row.uses[0].share, row.uses[0].text) for row in found.rows] == [
        ("Run 3", None, "no answer within 0.4 s"),
        ("Run 2", 0.3 / 0.4, "answered after 0.3 s of 0.4 s"),
        ("Run 1", 0.25, "answered after 0.1 s of 0.4 s"),
    ]


def test_a_bound_is_what_good_runs_keep_and_a_crossing_of_it_stands_first() -> None:
    over = threshold("crossed", 0.0, 0.5)
    always_over = threshold("false", 0.44, 0.5)
    found = uses(
        [
            run(1, thresholds=(threshold("true", 0.0, 0.3),)),
            run(2, "violated", thresholds=(over,)),
            run(3, "violated", thresholds=(always_over,)),
            run(4, thresholds=(threshold(None, None, None),)),
        ],
        None,
        9,
    )
    assert found is not None
    rows = [(row.label, row.uses[0].is_crossed, row.uses[0].text) for row in found.rows]
    assert rows == [
        ("Run 2", True, "0.5 m/s, bound 0.4 m/s"),
        ("Run 3", True, "0.5 m/s, bound 0.4 m/s"),
        ("Run 1", False, "0.3 m/s, bound 0.4 m/s"),
    ]
    shares = [row.uses[0].share or 0.0 for row in found.rows]
    assert [round(share, 9) for share in shares] == [1.25, 1.25, 0.75]
    assert found.notes == ("How much of the bound was used is not known in Run 4 (satisfied).",)


def test_a_threshold_that_good_runs_cross_is_no_bound() -> None:
    crossing = threshold("crossed", 0.0, 0.5)
    assert uses([run(1, thresholds=(crossing,)), run(2, thresholds=(crossing,))], None, 9) is None


def test_infinite_values_have_no_share() -> None:
    found = uses(
        [
            run(1, thresholds=(threshold("true", 0.0, 0.2),)),
            run(2, "violated", thresholds=(threshold("crossed", 0.0, "+inf"),)),
        ],
        None,
        9,
    )
    assert found is not None
    assert found.rows[0].uses[0].share is None
    assert found.rows[0].uses[0].text == "+inf, bound 0.4 m/s"


def test_a_percentage_is_never_rounded_onto_the_bound() -> None:
    assert percent(0.9999) == "just below 100 %"
    assert percent(1.0001) == "just above 100 %"
    assert [percent(share) for share in (0.0, 0.634, 1.0, 1.26)] == [
        "0 %",
        "63 %",
        "100 %",
        "126 %",
    ]


@pytest.mark.slow
@given(
    st.lists(
        st.tuples(
            st.sampled_from(["satisfied", "violated", "no data"]),
            st.none() | st.floats(0, 10),
            st.sampled_from(["true", "false", "crossed", None]),
            st.floats(-10, 10),
        ),
        max_size=12,
    ),
    st.integers(1, 4),
)
@examples(25)
def test_what_is_left_out_is_never_worse(drawn: list[Any], most: int) -> None:
    runs = [
        run(n, word, latency_max_s=late, thresholds=(threshold(kept, -abs(value), value),))
        for n, (word, late, kept, value) in enumerate(drawn)
    ]
    short, whole = uses(runs, 5.0, most), uses(runs, 5.0, len(runs))
    if whole is None or short is None:
        assert short is whole
        return
    assert whole.rows[:most] == short.rows
    ranks = [
        (
            row.mark.word == "violated",
            row.uses[0].is_crossed,
            inf if row.uses[0].share is None else row.uses[0].share,
        )
        for row in whole.rows
    ]
    assert ranks == sorted(ranks, reverse=True)
    bad = [row for row in whole.rows[most:] if row.mark.word == "violated"]
    left = short.notes[0] if len(whole.rows) > most else ""
    assert left.startswith(f"{max(0, len(whole.rows) - most)} more run") == bool(left)
    assert (f"{len(bad)} of them violated" in left) == bool(bad)
    used = [use for each in whole.rows for use in each.uses]
    assert all(use.is_crossed or (use.share is not None and use.share <= 1) for use in used)
