"""How many results have which verdict, and which one is to be looked at first."""

from collections.abc import Collection, Iterable
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.evidence.result_summaries import summary_of
from fretc.audit.evidence.schema import Result
from fretc.audit.outputs.totals import (
    COUNTED,
    NOT_JUDGED,
    VerdictWords,
    longest,
    runs,
    severity,
    totals,
    word_of,
)
from tests.fretc.audit.results import result

VERDICTS = ("violated", "no data", "inconclusive", "vacuous", "satisfied")
TRIALS = {"answered": 1, "failed": 0, "open": 0}


def marks(results: Iterable[Result], refused: Collection[str] = ()) -> VerdictWords:
    """Those of these results."""
    return VerdictWords.of(map(summary_of, results), (), refused)


def audits(most: int = 6) -> st.SearchStrategy[list[Result]]:
    """Some runs by some requirements."""
    sizes = st.tuples(st.integers(1, most), st.integers(1, most))
    return sizes.flatmap(
        lambda size: st.lists(
            st.sampled_from(VERDICTS), min_size=size[0] * size[1], max_size=size[0] * size[1]
        ).map(
            lambda words: [
                result(run=f"{i // size[1]}.mcap", requirement=f"R{i % size[1]}", verdict=word)
                for i, word in enumerate(words)
            ]
        )
    )


@given(audits(), st.sets(st.sampled_from(["R0", "R3"])))
def test_each_result_is_in_exactly_one_count(results: list[Result], refused: set[str]) -> None:
    counts = totals(marks(results, refused))
    assert sum(total.results for total in counts) == len(results)
    assert len({total.word for total in counts}) == len(counts)
    for total in counts:
        mine = [each for each in results if word_of(each, refused) == total.word]
        assert total.results == len(mine)
        assert total.requirements == len({each.requirement for each in mine})
        assert total.runs == len({each.run for each in mine})
    order = [severity(total.word) for total in counts]
    assert order == sorted(order)


@given(audits())
def test_what_is_violated_is_counted_first_and_named(results: list[Result]) -> None:
    violated = [each for each in results if each.verdict == "violated"]
    first = marks(results).worst
    if violated:
        assert totals(marks(results))[0].word == "violated"
        assert first == results.index(violated[0])
    assert (first is None) == all(each.verdict == "satisfied" for each in results)


def test_a_refused_requirement_is_not_judged_whatever_the_log() -> None:
    (total,) = totals(marks([result(verdict="no data")], {"R1"}))
    assert total.word == NOT_JUDGED


def test_a_run_that_only_counts_is_nothing_to_look_at() -> None:
    counting = [result(verdict=word, trials=TRIALS) for word in ("inconclusive", "vacuous")]
    assert {word_of(each) for each in counting} == {COUNTED}
    assert marks(counting).worst is None
    assert word_of(result(verdict="no data", trials=TRIALS)) == "no data"


def test_two_logs_of_one_name_are_two_runs() -> None:
    both = [result(run="a"), result(run="a"), result(run="b")]
    assert [len(run) for run in runs(both)] == [1, 1, 1]


def broken(id: str, *stretches: tuple[int, int]) -> Result:
    violations: list[dict[str, Any]] = [
        {"first_tick": first, "last_tick": last} for first, last in stretches
    ]
    return result(requirement=id, verdict="violated", violations=violations)


def test_the_worst_is_broken_for_the_most_ticks() -> None:
    short, long = broken("R1", (0, 3), (5, 5)), broken("R2", (0, 2), (7, 9))
    assert marks([short, long]).worst == 1
    found = longest(short)
    assert found is not None
    assert (found.first_tick, found.last_tick) == (0, 3)
