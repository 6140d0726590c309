"""Queues of subscriptions: throttle, queue length, and several subscriptions as one."""

from fretc.rosbridge.subscriptions import MOST_WAITING, Subscription, TopicQueue, fragments


def queue(*subscriptions: Subscription) -> TopicQueue:
    return TopicQueue({str(number): each for number, each in enumerate(subscriptions)})


def test_without_options_every_message_is_sent_at_once() -> None:
    topic = queue(Subscription())
    for number in range(3):
        topic.put(0, number, 10.0)
    assert topic.due() <= 10.0
    assert [topic.take(10.0) for _ in range(3)] == [0, 1, 2]
    assert topic.due() == float("inf")


def test_without_a_queue_messages_within_the_throttled_time_are_dropped() -> None:
    topic = queue(Subscription(throttle=1.0))
    topic.put(0, "a", 10.0)
    assert topic.take(10.0) == "a"
    topic.put(0, "b", 10.5)
    assert topic.due() == float("inf")
    topic.put(0, "c", 11.0)
    assert topic.due() == 11.0


def test_a_full_queue_loses_its_oldest_message() -> None:
    topic = queue(Subscription(throttle=1.0, queue=2))
    topic.put(0, "a", 10.0)
    topic.take(10.0)
    for message in "bcd":
        topic.put(0, message, 10.1)
    assert topic.due() == 11.0
    assert [topic.take(11.0), topic.take(12.0)] == ["c", "d"]


def test_a_slow_client_does_not_fill_the_memory() -> None:
    topic = queue(Subscription())
    for number in range(MOST_WAITING + 5):
        topic.put(0, number, 0.0)
    assert (len(topic.waiting), topic.take(0.0)) == (MOST_WAITING, 5)


def test_several_subscriptions_are_one_with_the_lowest_throttle_and_the_longest_queue() -> None:
    topic = queue(
        Subscription(0.5, 3, 100), Subscription(0.2, 1, None), Subscription(0.9, 0, 50, "cbor")
    )
    assert topic.merged == Subscription(0.2, 3, 50, "cbor")


def test_fragments_are_the_text_together() -> None:
    parts = [*fragments("abcdefgh", 3, "f1")]
    assert [(p["num"], p["total"], p["data"]) for p in parts] == [
        (0, 3, "abc"),
        (1, 3, "def"),
        (2, 3, "gh"),
    ]
    assert {(p["op"], p["id"]) for p in parts} == {("fragment", "f1")}
