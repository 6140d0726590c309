from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.measurements.tallies import NOTHING, PropositionTally, tally
from monitors.kernel.columns import code, column

TRUTHS = st.lists(st.sampled_from([True, False, None]), max_size=40)


def counted(*values: bool | None) -> PropositionTally:
    return tally(column(bytes(map(code, values))), len(values))


def test_what_is_unknown_in_between_changes_nothing() -> None:
    assert counted(True, None, True, None, False, None) == PropositionTally(2, 1, 3, 1)
    assert counted(None, None) == PropositionTally(0, 0, 2, 0)
    assert counted(False, True, True, False) == PropositionTally(2, 2, 0, 2)
    assert counted() == NOTHING


def test_from_one_run_to_the_next_nothing_changes() -> None:
    assert counted(True) + counted(False) == PropositionTally(1, 1, 0, 0)


@given(TRUTHS)
def test_it_agrees_with_counting(values: list[bool | None]) -> None:
    changes, last = 0, None
    for value in values:
        changes += None not in (value, last) and value != last
        last = last if value is None else value
    expected = PropositionTally(
        values.count(True), values.count(False), values.count(None), changes
    )
    assert counted(*values) == expected
