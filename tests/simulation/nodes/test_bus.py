from itertools import pairwise
from typing import Any

from simulation.nodes.bus import Bus
from simulation.world.scenario import Transport


def arrivals(ways: dict[str, Transport], count: int, faults_from: int = 0) -> list[tuple[int, int]]:
    """Number and arrival (in milliseconds) of messages that are sent every 100 ms."""
    log: list[tuple[str, Any, int]] = []
    bus = Bus(lambda topic, message, now: log.append((topic, message, now)), ways, 1, faults_from)
    received: list[tuple[int, int]] = []
    bus.subscribe("/a", lambda message, now: received.append((message, now // 1_000_000)))
    for number in range(count):
        bus.publish("/a", number, number * 100_000_000)
    while bus.next < float("inf"):
        bus.run()
    assert [(message, now // 1_000_000) for _, message, now in log] == received
    return received


def test_a_message_arrives_when_it_was_sent_and_is_recorded() -> None:
    assert arrivals({}, 3) == [(0, 0), (1, 100), (2, 200)]
    assert arrivals({"/b": Transport(loss=1.0)}, 3) == [(0, 0), (1, 100), (2, 200)]


def test_a_delayed_message_arrives_later() -> None:
    assert arrivals({"/a": Transport(delay=0.15)}, 2) == [(0, 150), (1, 250)]


def test_a_share_of_the_messages_is_lost() -> None:
    assert arrivals({"/a": Transport(loss=1.0)}, 3) == []
    assert 120 < len(arrivals({"/a": Transport(loss=0.3)}, 200)) < 160


def test_a_swapped_message_comes_after_the_next_one() -> None:
    numbers = [number for number, _ in arrivals({"/a": Transport(swap=0.2)}, 200)]
    assert sorted(numbers) == list(range(200))
    late = sum(later < before for before, later in pairwise(numbers))
    assert 15 < late < 55


def test_before_faults_begin_nothing_is_late() -> None:
    assert arrivals({"/a": Transport(delay=0.05)}, 3, 150_000_000) == [(0, 0), (1, 100), (2, 250)]


def test_things_happen_in_order_of_time_and_then_of_asking() -> None:
    bus, done = Bus(lambda topic, message, now: None, {}, 1), list[str]()
    bus.at(2, lambda now: done.append("c"))
    bus.at(1, lambda now: done.append("a"))
    bus.at(1, lambda now: done.append("b"))
    bus.every(10, 5, lambda now: done.append(str(now)))
    while bus.next < 26:
        bus.run()
    assert done == ["a", "b", "c", "5", "15", "25"]
