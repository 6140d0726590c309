"""What a middleware's thread puts in comes out in order, and what does not fit is counted."""

from threading import Thread

from fretc.watch.sources.mailbox import Mailbox
from fretc.watch.sources.source import Arrival, Channel, Idle, Missed, Reconnected

SCAN = Channel("/scan", "json", "", "", b"")


def test_messages_come_out_in_the_order_of_their_arrival() -> None:
    mailbox = Mailbox()

    def send() -> None:
        for i in range(200):
            mailbox.put(SCAN, b"%d" % i)

    threads = [Thread(target=send) for _ in range(4)]
    for thread in threads:
        thread.start()
    found = [mailbox.take() for _ in range(800)]
    for thread in threads:
        thread.join()
    times = [each.log_time for each in found if isinstance(each, Arrival)]
    assert len(times) == 800
    assert times == sorted(times)


def test_what_does_not_fit_is_missed_at_its_place() -> None:
    mailbox = Mailbox(most=2)
    for i in range(5):
        mailbox.put(SCAN, b"%d" % i, publish_time=i)
    first = mailbox.take()
    assert isinstance(first, Arrival)
    assert (first.payload, first.publish_time) == (b"0", 0)
    mailbox.tell(Reconnected(1, 2))
    second, missed, event = mailbox.take(), mailbox.take(), mailbox.take()
    assert isinstance(second, Arrival)
    assert isinstance(missed, Missed)
    assert missed.count == 3
    assert second.log_time <= missed.since <= missed.until
    assert event == Reconnected(1, 2)
    mailbox.put(SCAN, b"6")
    assert isinstance(mailbox.take(), Arrival)


def test_large_messages_fill_it_too() -> None:
    mailbox = Mailbox(most_bytes=10)
    mailbox.put(SCAN, bytes(8))
    mailbox.put(SCAN, bytes(8))
    assert isinstance(mailbox.take(), Arrival)
    assert isinstance(mailbox.take(), Missed)
    mailbox.put(SCAN, bytes(8))
    assert isinstance(mailbox.take(), Arrival)


def test_idle_says_up_to_when_all_was_handed_on() -> None:
    mailbox = Mailbox()
    before = mailbox.now
    idle = mailbox.take()
    assert isinstance(idle, Idle)
    assert idle.now is not None
    assert before <= idle.now <= mailbox.now


def test_what_waits_can_be_taken_after_the_end() -> None:
    mailbox = Mailbox()
    mailbox.put(SCAN, b"")
    mailbox.close()
    assert isinstance(mailbox.take(), Arrival)
    assert mailbox.take() is None
