from fretc.audit.measurements.intervals import Moment, end_ns, end_s, interval_words

FIRST, LAST = Moment(132, 13_200_000_000, 13.2), Moment(134, 13_400_000_000, 13.4)


def test_an_interval_ends_with_the_tick_after_its_last_one() -> None:
    clock = "100 ms by log_time"
    assert (end_ns(LAST, clock), end_s(LAST, clock)) == (13_500_000_000, 13.5)
    assert interval_words(FIRST, LAST, clock) == "from 13.2 s to 13.5 s (300 ms)"


def test_a_single_tick_lasts() -> None:
    assert interval_words(FIRST, FIRST, "100 ms by log_time") == "from 13.2 s to 13.3 s (100 ms)"


def test_a_tick_by_message_has_no_known_end() -> None:
    clock = "messages of /scan by log_time"
    assert (end_ns(LAST, clock), end_s(LAST, clock)) == (None, None)
    assert interval_words(FIRST, FIRST, clock) == "at the message at 13.2 s"
    assert interval_words(FIRST, LAST, clock) == ("from the message at 13.2 s to the one at 13.4 s")
