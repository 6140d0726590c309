"""Lost messages of Zenoh: each is counted, and lies in the time in which it was lost."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.watch.sources.source import Missed
from fretc.watch.zenoh import sequence_numbers
from fretc.watch.zenoh.keys import Attachment
from fretc.watch.zenoh.sequence_numbers import Numbers

A, B = b"a" * 16, b"b" * 16
KEY = "0/x/T/h"


def sent(
    numbers: Numbers, number: int, at: int, gid: bytes = A, key: str = KEY,
    since: int | None = None, stamp: int | None = None,
) -> Missed | None:  # fmt: skip
    """One message that arrives at this time, and was sent then."""
    of = Attachment(number, at if stamp is None else stamp, gid)
    missed = numbers.missed(key, of, since, at)
    numbers.arrived(key, of, at)
    return missed


@given(st.lists(st.tuples(st.sampled_from([A, B]), st.booleans())))
def test_what_does_not_arrive_is_missed_once_a_later_message_arrives(
    messages: list[tuple[bytes, bool]],
) -> None:
    numbers = Numbers()
    lost: dict[bytes, list[int]] = {A: [], B: []}
    count, heard = {A: 0, B: 0}, {A: False, B: False}
    for place, (gid, arrives) in enumerate(messages):
        at = 10 * (place + 1)
        count[gid] += 1
        if not arrives:
            lost[gid] += [at] if heard[gid] else []
            continue
        missed = sent(numbers, count[gid], at, gid)
        assert (missed.count if missed else 0) == len(lost[gid])
        if missed is not None:
            assert missed.until == at - 1
            assert missed.since <= lost[gid][0]
            assert lost[gid][-1] <= missed.until
        lost[gid], heard[gid] = [], True


def test_the_messages_around_the_lost_ones_are_not_in_the_gap() -> None:
    numbers = Numbers()
    assert sent(numbers, 1, 10) is None
    assert sent(numbers, 5, 20) == Missed(11, 19, 3)
    assert sent(numbers, 6, 21) is None
    assert sent(numbers, 9, 22) == Missed(21, 21, 2)


def test_publishers_of_other_keys_count_for_themselves() -> None:
    numbers = Numbers()
    assert sent(numbers, 1, 10) is None
    assert sent(numbers, 7, 11, key="0/x/T/other") is None
    assert sent(numbers, 2, 12) is None


def test_the_first_number_counts_if_the_publisher_appeared_during_the_watch() -> None:
    assert sent(Numbers(), 4, 50) is None
    assert sent(Numbers(), 4, 50, since=30) == Missed(30, 49, 3)
    assert sent(Numbers(), 1, 50, since=30) is None
    assert sent(Numbers(), 0, 50, since=30) is None


def test_after_a_reconnection_the_first_number_counts() -> None:
    numbers = Numbers()
    sent(numbers, 3, 10)
    numbers.begin(40)
    assert sent(numbers, 9, 50) == Missed(11, 49, 5)
    assert sent(numbers, 2, 51, B) == Missed(40, 50, 1)


def test_a_cached_message_changes_nothing() -> None:
    numbers = Numbers()
    assert sent(numbers, 5, 10) is None
    assert sent(numbers, 3, 11, stamp=3) is None
    assert sent(numbers, 6, 12) is None


def test_a_publisher_may_begin_to_count_again() -> None:
    numbers = Numbers()
    sent(numbers, 5, 10)
    assert sent(numbers, 1, 11) is None
    assert sent(numbers, 3, 15) == Missed(12, 14, 1)
    numbers = Numbers()
    sent(numbers, 5, 10)
    numbers.gone(KEY)
    assert sent(numbers, 1, 20, stamp=1) is None
    assert sent(numbers, 4, 30, stamp=2) == Missed(21, 29, 2)


def test_numbers_of_strangers_are_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    numbers = Numbers()
    sent(numbers, 0, 10)
    assert sent(numbers, 2**63 - 1, 20) == Missed(11, 19, 2**53)
    monkeypatch.setattr(sequence_numbers, "MOST_PUBLISHERS", 3)
    for place in range(9):
        sent(numbers, 1, 30, bytes([place]) * 16)
    sent(numbers, 1, 40, bytes([6]) * 16)
    sent(numbers, 1, 41, bytes([9]) * 16)
    assert sent(numbers, 3, 50, bytes([6]) * 16) == Missed(41, 49, 1)
    assert sent(numbers, 3, 50, bytes([7]) * 16) is None


def test_the_last_message_of_a_key() -> None:
    numbers = Numbers()
    sent(numbers, 1, 10)
    sent(numbers, 1, 20, B)
    sent(numbers, 1, 5, key="0/x/T/other")
    assert numbers.last_of(KEY, 0) == 10
    assert numbers.last_of(KEY, 15) == 20
    assert numbers.last_of(KEY, 25) is None
