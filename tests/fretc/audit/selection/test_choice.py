"""Some logs by chance: the same for a seed, in their order, and nearly the same with one more."""

from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.selection.choice import chosen, in_words

names = st.lists(st.text(min_size=1), unique=True, max_size=30)


@given(names, st.integers(1, 40), st.integers(0, 3), st.randoms())
def test_a_sample_depends_on_names_and_seed_alone_and_keeps_the_order(
    logs: list[str], count: int, seed: int, chance: object
) -> None:
    some, selection = chosen(logs, None, count, seed)
    assert len(some) == min(count, len(logs))
    assert some == [log for log in logs if log in some]
    assert {*chosen(logs[::-1], None, count, seed)[0]} == {*some}
    assert selection is not None
    assert (selection.named, selection.sample_of, selection.seed) == (len(logs), len(logs), seed)
    assert (selection.audited, selection.older, selection.since) == (len(some), 0, None)


@given(names.filter(bool), st.integers(1, 40), st.integers(0, 3))
def test_one_log_more_displaces_at_most_one(logs: list[str], count: int, seed: int) -> None:
    before = {*chosen(logs[:-1], None, count, seed)[0]}
    after = {*chosen(logs, None, count, seed)[0]}
    assert len(before - after) <= 1
    assert after - before <= {logs[-1]}


def test_another_seed_is_another_sample() -> None:
    logs = [f"{n}.mcap" for n in range(100)]
    samples = {tuple(chosen(logs, None, 10, seed)[0]) for seed in range(20)}
    assert len(samples) == 20
    taken = [log for sample in samples for log in sample]
    assert max(taken.count(log) for log in logs) < 10  # 2 is the mean


def test_without_a_choice_all_logs_are_audited_and_nothing_is_said() -> None:
    assert chosen(["a", "b"], None, None, 0) == (["a", "b"], None)
    _, selection = chosen(["a", "b"], None, 1, 7)
    assert selection is not None
    assert in_words(selection) == "1 of 2 logs: a sample of 2 chosen at random, seed 7"
