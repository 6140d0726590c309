"""Definitions that only a robot's nodes have: asked of real ROS 2, and of bytes that lie."""

from __future__ import annotations

import json
import os
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from fretc.logs.messages.definitions import types
from fretc.logs.messages.ros2_types import definitions
from fretc.logs.messages.type_descriptions import DescribedField, DescribedType, type_hash
from fretc.watch.sources import dds, type_service
from fretc.watch.sources.dds import Dds
from fretc.watch.sources.dds_types import Offer, UnreadableTypeError
from fretc.watch.sources.source import Arrival, Idle, Problem
from fretc.watch.sources.type_service import TypeService, described
from fretish.diagnostics.diagnostic import Code
from tests.effort import FULL
from tests.fretc.logs.messages.test_type_descriptions import described as description_of
from tests.fretc.logs.messages.test_type_descriptions import store, within
from tests.programs import needs_package
from tests.ros2.real.environment import python
from tests.ros2.real.network import Network, network

SCAN = "sensor_msgs/msg/LaserScan"

pytestmark = [pytest.mark.slow, needs_package("cyclonedds")]


def offer_of(name: str) -> Offer:
    return Offer(name, [*definitions(name)][-1])


def answer(name: str) -> bytes:
    """The answer of a node about a standard type, as CDR."""
    known, own = type_service._store(), store()
    kinds = {each.rpartition("/")[2]: kind for each, kind in known.types.items() if "descr" in each}

    def individual(each: str) -> Any:
        fields = [
            kinds["Field"](
                name=field.name,
                type=kinds["FieldType"](
                    type_id=field.type_id,
                    capacity=field.capacity,
                    string_capacity=field.string_capacity,
                    nested_type_name=field.nested_type_name,
                ),
                default_value="",
            )
            for field in description_of(own, each).fields
        ]
        return kinds["IndividualTypeDescription"](type_name=each, fields=fields)

    whole = kinds["TypeDescription"](
        type_description=individual(name),
        referenced_type_descriptions=[*map(individual, within(own, name))],
    )
    response = type_service._name("Response")
    return bytes(
        known.serialize_cdr(
            known.types[response](
                successful=True,
                failure_reason="",
                type_description=whole,
                type_sources=[],
                extra_information=[],
            ),
            response,
        )
    )


def test_an_answer_counts_only_with_the_hash_and_the_name_of_the_publisher() -> None:
    payload, offer = answer(SCAN), offer_of(SCAN)
    text = described(payload, offer)
    assert text is not None
    (standard,) = definitions(SCAN).values()
    assert types(SCAN, text, ros1=False) == types(SCAN, standard, ros1=False)
    assert described(payload, Offer(SCAN, offer_of("nav_msgs/msg/Odometry").hash)) is None
    assert described(payload, Offer("a/msg/LaserScan", offer.hash)) is None
    assert described(answer("nav_msgs/msg/Odometry"), offer) is None


def test_no_change_of_bytes_gives_another_definition() -> None:
    payload, offer, choose = answer(SCAN), offer_of(SCAN), random.Random(1)
    (text, *_) = {described(payload, offer)}
    for _ in range(5_000 if FULL else 200):
        changed = bytearray(payload)
        for _ in range(choose.randint(1, 3)):
            changed[choose.randrange(len(changed))] = choose.choice([0, 1, 127, 255])
        cut = changed[: choose.choice([len(changed), choose.randrange(len(changed))])]
        assert described(bytes(cut), offer) in (text, None)
    assert described(b"", offer) is None
    assert described(bytes(2**20 + 1), offer) is None


def test_the_hash_is_the_one_that_the_installed_messages_carry() -> None:
    share = python("jazzy").parents[1] / "share"
    files = sorted(share.glob("*/msg/*.json"))
    assert len(files) > 100
    for file in files:
        document = json.loads(file.read_text())
        description = document["type_description_msg"]
        main, *parts = (
            DescribedType(
                each["type_name"],
                tuple(DescribedField(field["name"], **field["type"]) for field in each["fields"]),
            )
            for each in (
                description["type_description"],
                *description["referenced_type_descriptions"],
            )
        )
        hashes = {each["type_name"]: each["hash_string"] for each in document["type_hashes"]}
        assert type_hash(main, parts) == hashes[main.name], main.name


class Refusing:
    """A domain with a service whose topics cannot be opened, and many processes."""

    def __init__(self, participants: int) -> None:
        topics = ("rq/evil/get_type_descriptionRequest", "rt/scan")
        self.others = [(f"010f{n:08}", topic) for n in range(participants) for topic in topics]
        self.asked = 0

    def readers_of_others(self) -> list[tuple[str, str]]:
        others, self.others = self.others, []
        return others

    def reader(self, *_: object) -> None:
        self.asked += 1
        raise UnreadableTypeError("no topic")


def test_a_service_that_cannot_be_asked_is_asked_once_and_ends_nothing() -> None:
    domain, time = Refusing(2_000), [0]
    service = TypeService(domain, lambda: time[0])  # type: ignore[arg-type]
    offer = offer_of(SCAN)
    assert service.asks("010f00001999", offer)
    for _ in range(3):
        assert [*service.answers()] == []
    assert domain.asked == 1
    assert len(service._services) <= 1_000
    time[0] = type_service.PATIENCE
    assert [*service.answers()] == [offer]
    assert service.definition(offer) is None
    assert not service.asks("010f00001999", offer)


# A robot ----------------------------------------------------------------------------------------


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Network]:
    with network(tmp_path) as place:
        for name, value in place.of_fretc.items():
            monkeypatch.setitem(os.environ, name, value)
        yield place


def first_arrival(source: Dds) -> tuple[Arrival, list[Code]]:
    """The first scan, and the problems before it."""
    problems: list[Code] = []
    for item in source.arrivals(["/scan"]):
        if isinstance(item, Arrival):
            return item, problems
        if isinstance(item, Problem):
            problems.append(item.diagnostic.code)
        assert isinstance(item, Idle) or len(problems) < 20
    raise AssertionError("the source has ended")


@pytest.mark.parametrize("answered", [True, False])
def test_a_type_that_fretc_does_not_know_is_asked_of_its_node(
    here: Network, monkeypatch: pytest.MonkeyPatch, *, answered: bool
) -> None:
    monkeypatch.setattr(dds, "definition", lambda type_, digest: None)
    if not answered:
        monkeypatch.setattr(type_service, "_FAST_DDS", "another vendor")
    robot = here.robot()
    robot.ask("go")
    source = Dds()
    try:
        arrival, problems = first_arrival(source)
    finally:
        source.close()
    assert robot.ask()["speed"] is not None
    assert arrival.channel.schema_name == SCAN
    if answered:
        (standard,) = definitions(SCAN).values()
        own = types(SCAN, arrival.channel.schema.decode(), ros1=False)
        assert own == types(SCAN, standard, ros1=False)
        assert Code.NO_DEFINITION not in problems
    else:
        assert arrival.channel.schema == b""
        assert Code.NO_DEFINITION in problems
