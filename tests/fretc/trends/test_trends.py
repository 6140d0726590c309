"""From evidence to trends: rounds in order of time, red never lost, nothing compared by chance."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.schema import Result
from fretc.trends.changes import RED, VerdictChange
from fretc.trends.comparisons import ComparisonFinding
from fretc.trends.trends import Trends, gone, not_selected
from fretc.trends.trends import trends as trends_of
from tests.effort import examples
from tests.fretc.audit.results import SHA
from tests.fretc.trends.nights import document, judged, sample

OTHER = "1" * 64


def trends(*nights: Sequence[Result], by: str | None = None) -> Trends:
    """Of evidence that is named by its number, in the order given."""
    sources = [EvidenceFile(f"{i}.json", SHA, document(night)) for i, night in enumerate(nights)]
    found = trends_of(sources, by)
    assert isinstance(found, Trends), found
    return found


def changes(found: Trends) -> dict[tuple[str, str], VerdictChange]:
    return {(item.requirement, str(item.scenario)): item.change for item in found.items}


def test_evidence_is_ordered_by_its_runs_and_not_as_it_is_named() -> None:
    old = [judged("a.mcap", "satisfied", night=1)]
    new = [judged("a.mcap", "violated", night=2)]
    for given_order in ((old, new), (new, old)):
        assert changes(trends(*given_order)) == {("R1", "a.mcap"): VerdictChange.NEW}


def test_a_label_says_when_a_run_was() -> None:
    first = [judged("a.mcap", "violated", night=9, date="2026-11-20")]
    second = [judged("a.mcap", "satisfied", night=1, date="2026_11_21-22_00_00")]
    found = trends(second, first)
    assert changes(found) == {("R1", "a.mcap"): VerdictChange.FIXED}
    assert [each.days for each in found.rounds] == ["2026-11-20", "2026-11-21"]


@pytest.mark.parametrize("night", [0, -30_000])
@given(order=st.permutations(["2", "9", "10", "100"]))
def test_equal_times_and_missing_ones_are_in_the_natural_order_of_names(
    night: int, order: Sequence[str]
) -> None:
    verdicts = {"2": "satisfied", "9": "violated", "10": "satisfied", "100": "violated"}
    sources = [
        EvidenceFile(
            f"n/{name}.json", SHA, document([judged("a.mcap", verdicts[name], night=night)])
        )
        for name in order
    ]
    found = trends_of(sources)
    assert isinstance(found, Trends)
    assert [each.name for each in found.rounds] == [f"n/{n}.json" for n in (2, 9, 10, 100)]
    assert changes(found) == {("R1", "a.mcap"): VerdictChange.NEW}
    why = "by name, since not all have a time" if night else "those of equal times by name"
    assert why in found.order
    assert "`fretc audit --label date=...` decides" in found.order


@given(order=st.permutations(["v9", "v10", "v11"]), by=st.sampled_from(["version", "evidence"]))
def test_versions_of_one_time_are_in_their_natural_order(order: Sequence[str], by: str) -> None:
    nights = [
        EvidenceFile(f"{v}.json", SHA, document([judged(f"{v}/a.mcap", version=v)])) for v in order
    ]
    found = trends_of(nights, by)
    assert isinstance(found, Trends)
    assert [each.versions for each in found.rounds] == [("v9",), ("v10",), ("v11",)]
    assert (found.compared.before, found.compared.after) == ("version v10", "version v11")


def test_runs_of_a_scenario_are_comparable_whatever_their_names() -> None:
    before = [judged("x/1.mcap", scenario="door"), judged("x/2.mcap", scenario="door")]
    now = [judged("y/3.mcap", "violated", night=1, scenario="door")]
    assert changes(trends(before, now)) == {("R1", "door"): VerdictChange.NEW}
    apart = [judged("y/door", "violated", night=1)]
    assert VerdictChange.GONE in changes(trends(before, apart)).values()


def test_one_evidence_is_compared_day_by_day_or_by_a_label() -> None:
    runs = [
        judged("1/a.mcap", "satisfied", night=0, version="1"),
        judged("2/a.mcap", "violated", night=1, version="2"),
        judged("3/a.mcap", "violated", night=2, version="2"),
    ]
    found = trends(runs)
    assert [each.name for each in found.rounds] == ["2025-11-08", "2025-11-09", "2025-11-10"]
    assert changes(found) == {("R1", "a.mcap"): VerdictChange.STILL}
    assert changes(trends(runs, by="version")) == {("R1", "a.mcap"): VerdictChange.NEW}
    unlabelled = trends_of([EvidenceFile("", SHA, document(runs))], "robot")
    assert not isinstance(unlabelled, Trends)
    assert unlabelled.code.number == "F560"


def test_what_is_gone_is_named_by_scenario_and_by_requirement() -> None:
    before = [
        judged(f"{scenario}.mcap", verdict, id, scenario=scenario)
        for scenario, verdict in (("door", "violated"), ("hall", "satisfied"))
        for id in ("R1", "R2")
    ]
    now = [judged("hall.mcap", "satisfied", "R1", night=1, scenario="hall")]
    found = trends(before, now)
    lines = ["scenario door: 2 violated", "requirement R2: 1 shown"]
    assert [each.text for each in gone(found)] == lines
    assert not found.is_comparable
    assert not found.is_worse


CHOICES = {
    "all": None,
    "a sample": sample(1, of=4),
    "a sample of all": sample(4, of=4),
    "since later": sample(2, of=2, since="2025-11-09T00:00:00+00:00", older=2),
    "since earlier": sample(2, of=2, since="2025-11-07T00:00:00+00:00", older=2),
}
"""Choices of the second night, 2025-11-09; runs of the first were a day before."""


@pytest.mark.parametrize("choice", CHOICES)
def test_what_the_choice_of_logs_may_have_left_out_is_neither_gone_nor_fixed(choice: str) -> None:
    before = [
        judged("a.mcap", "satisfied"),
        judged("b.mcap", "violated"),
        judged("c.mcap", "satisfied", "R2"),
        judged("1.mcap", "violated", "R3", scenario="door", log=1),
        judged("2.mcap", "satisfied", "R3", scenario="door", log=2),
    ]
    now = [
        judged("other.mcap", "satisfied", night=1),
        judged("2.mcap", "satisfied", "R3", scenario="door", log=2),
    ]
    found = chosen(before, now, choice)
    left_out = (
        VerdictChange.NOT_SELECTED if choice in ("a sample", "since later") else VerdictChange.GONE
    )
    door = (
        VerdictChange.NOT_SELECTED
        if left_out is VerdictChange.NOT_SELECTED
        else VerdictChange.FIXED
    )
    assert changes(found) == {
        ("R1", "a.mcap"): left_out,
        ("R1", "b.mcap"): left_out,
        ("R1", "other.mcap"): VerdictChange.FIRST,
        (
            "R2",
            "c.mcap",
        ): VerdictChange.GONE,  # the newest round does not have the requirement at all
        ("R3", "door"): door,
    }
    if left_out is VerdictChange.NOT_SELECTED:
        groups = {group.text for group in not_selected(found)}
        assert groups == {
            "scenario a.mcap: 1 shown", "scenario b.mcap: 1 violated", "scenario door: 1 violated",
        }  # fmt: skip


@pytest.mark.parametrize(
    ("verdict", "choice", "comparable"),
    [("satisfied", "a sample", True), ("violated", "a sample", False), ("satisfied", "all", False)],
)
def test_a_sample_hides_no_violation_and_is_no_loss_beside(
    verdict: str, choice: str, comparable: bool
) -> None:
    kept = judged("a.mcap", "satisfied", night=1)
    found = chosen([judged("a.mcap"), judged("b.mcap", verdict)], [kept], choice)
    assert found.is_comparable is comparable
    assert not found.is_worse


def test_a_newer_log_of_a_scenario_takes_the_place_of_one_left_out_by_its_date() -> None:
    before = [judged("1.mcap", "violated", scenario="door")]
    now = [judged("2.mcap", "satisfied", night=1, scenario="door")]
    assert changes(chosen(before, now, "since later")) == {("R1", "door"): VerdictChange.FIXED}
    assert changes(chosen(before, now, "a sample")) == {("R1", "door"): VerdictChange.NOT_SELECTED}


def chosen(before: Sequence[Result], now: Sequence[Result], choice: str) -> Trends:
    """Two nights, the second of which audited a choice of its logs."""
    nights = [document(before), document(now, CHOICES[choice])]
    found = trends_of([EvidenceFile(f"{i}.json", SHA, night) for i, night in enumerate(nights)])
    assert isinstance(found, Trends)
    return found


def test_a_violation_is_told_where_the_requirement_has_changed_and_that_is_said() -> None:
    before = [judged("a.mcap", "satisfied")]
    now = [judged("a.mcap", "violated", night=1, sentence=OTHER)]
    (item,) = trends(before, now).items
    assert (item.change, item.changed, item.flaky) == (VerdictChange.NEW, True, False)


def test_one_commit_with_both_outcomes_is_flaky() -> None:
    runs = [
        judged("1.mcap", "satisfied", scenario="door", commit="abc"),
        judged("2.mcap", "violated", scenario="door", commit="abc"),
    ]
    (item,) = trends(runs).items
    assert item.flaky
    assert item.change is VerdictChange.FIRST_VIOLATED


def test_it_is_worse_only_where_that_is_more_than_chance() -> None:
    def nights(slow: float) -> list[list[Result]]:
        return [
            [
                judged(
                    f"{night}-{run}.mcap",
                    night=night,
                    late=[0.2 + run / 100 + (slow if night > 3 else 0)],
                    scenario="door",
                    version="2" if night > 3 else "1",
                )
                for run in range(5)
            ]
            for night in range(6)
        ]

    steady, slower = trends(*nights(0.0)), trends(*nights(0.1))
    assert not steady.with_finding(ComparisonFinding.REGRESSED)
    (found,) = slower.with_finding(
        ComparisonFinding.REGRESSED
    )  # of one answer, the longest is the median
    assert str(found.measure) == "longest latency"
    assert (found.runs_before, found.runs_after) == (20, 10)
    assert slower.is_worse
    faster = trends(*nights(-0.1))
    assert not faster.is_worse


def test_a_margin_that_shrinks_is_worse_and_one_that_is_crossed_has_none_left() -> None:
    def night(number: int, margin: float) -> list[Result]:
        return [
            judged(
                f"{number}-{run}.mcap",
                "satisfied",
                id,
                night=number,
                margin=margin and margin + run / 1000,
                scenario="door",
            )
            for run in range(6)
            for id in ("R1", "R2")
        ]

    found = trends(night(0, 0.2), night(1, 0.0))
    (one,) = found.with_finding(ComparisonFinding.REGRESSED)
    assert one.measure.requirements == ("R1", "R2")
    assert one.measure.threshold == "clearance < 0.05 m (too_close)"
    assert one.after == 0
    assert not trends(night(0, 0.1), night(1, 0.2)).is_worse


def test_few_runs_tell_nothing_and_that_is_said() -> None:
    before = [judged("0.mcap", late=[0.1], scenario="door")]
    now = [judged("1.mcap", night=1, late=[9.0], scenario="door")]
    found = trends(before, now)
    assert len(found.with_finding(ComparisonFinding.TOO_FEW)) == 1
    assert not found.is_worse


def test_a_copy_of_a_log_counts_once() -> None:
    """The same slow log in the newest evidence again and again is one run."""
    before = [judged(f"{run}.mcap", late=[0.1 + run / 100], scenario="d") for run in range(12)]

    def late(logs: Sequence[int]) -> list[Result]:
        return [
            judged(f"s{run}.mcap", night=1, late=[9.0], scenario="d", log=log)
            for run, log in enumerate(logs)
        ]

    assert trends(before, late(range(12))).with_finding(ComparisonFinding.REGRESSED)
    assert not trends(before, late([7] * 12)).with_finding(ComparisonFinding.REGRESSED)


def test_runs_of_a_requirement_that_was_another_one_are_not_compared() -> None:
    before = [judged(f"{run}.mcap", late=[0.1], scenario="d", sentence=OTHER) for run in range(12)]
    now = [judged(f"n{run}.mcap", night=1, late=[9.0], scenario="d") for run in range(12)]
    assert not trends(before, now).with_finding(ComparisonFinding.REGRESSED)


VERDICTS = st.sampled_from(["satisfied", "violated", "no data", "vacuous", "inconclusive"])
RUNS = st.lists(
    st.tuples(st.sampled_from("abc"), st.sampled_from(["R1", "R2"]), VERDICTS, st.booleans()),
    min_size=1,
    max_size=8,
    unique_by=lambda each: each[:2],
)


@pytest.mark.slow
@examples(25)
@given(st.lists(RUNS, min_size=1, max_size=4))
def test_no_violation_of_the_newest_round_is_lost(
    nights: list[list[tuple[str, str, str, bool]]],
) -> None:
    found = trends(
        *(
            [
                judged(f"{run}.mcap", verdict, id, night=night, sentence=OTHER if other else SHA)
                for run, id, verdict, other in sorted(runs)
            ]
            for night, runs in enumerate(nights)
        )
    )
    told = changes(found)
    keys = {(id, f"{run}.mcap") for runs in nights for run, id, _, _ in runs}
    assert told.keys() == keys
    for run, id, verdict, _ in nights[-1]:
        red = told[id, f"{run}.mcap"] in (*RED, VerdictChange.STILL)
        assert red == (verdict == "violated")
    missing = keys - {(id, f"{run}.mcap") for run, id, _, _ in nights[-1]}
    assert {key for key, change in told.items() if change is VerdictChange.GONE} == missing
    in_groups = [(i.requirement, str(i.scenario)) for group in gone(found) for i in group.items]
    assert sorted(in_groups) == sorted(missing)


def test_the_same_evidence_gives_the_same_trends(tmp_path: Path) -> None:
    night = [judged(f"{run}.mcap", late=[0.1 * run + 0.1], margin=0.1) for run in range(4)]
    assert trends(night, night).items == trends(night, night).items
