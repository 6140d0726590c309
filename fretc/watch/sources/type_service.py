"""Definitions of types that only a robot's own packages have, asked of its nodes.

Since ROS 2 Iron each node answers `~/get_type_description` with the definition of a type. An answer
counts only if its type hash is the one that the publisher announces. Nothing is compiled or
imported. Only nodes on Fast DDS are asked: other middlewares put a header of their own before each
request.

Source: REP 2016, section "Run-time Interface Type Description"; names of the topics of a service:
https://design.ros2.org/articles/topic_and_service_names.html.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from fretc.logs.messages import ros2_types
from fretc.logs.messages.type_descriptions import (
    DescribedField,
    DescribedType,
    definition,
    type_hash,
)
from fretc.watch.sources.dds_domain import DdsWriter, Domain, Reader
from fretc.watch.sources.dds_types import Offer, UnreadableTypeError
from fretish.classes.frozen import dataclass

PATIENCE = 3 * 10**9
"""Nanoseconds for an answer."""
MOST_QUESTIONS = 100
"""The most types that are asked for; the definitions of further ones stay unknown."""
_MOST_SERVICES = 50
"""The most nodes of a process that are asked."""
_MOST_PARTICIPANTS = 1000
"""The most processes whose services are kept."""
_LONGEST = 2**20
"""Bytes of an answer; longer ones are ignored."""
_FAST_DDS = "010f"
"""The vendor of Fast DDS, with which the identifiers of its participants begin."""
_REQUESTS = re.compile(r"rq/([\w/]{1,250}/get_type_description)Request", re.ASCII)
_SERVICE = "type_description_interfaces/srv/GetTypeDescription"
_FIELDS_OF_REQUEST = "string type_name\nstring type_hash\nbool include_type_sources\n"
_FIELDS_OF_RESPONSE = (
    "bool successful\n"
    "string failure_reason\n"
    "type_description_interfaces/TypeDescription type_description\n"
    "type_description_interfaces/TypeSource[] type_sources\n"
    "type_description_interfaces/KeyValue[] extra_information\n"
)


@dataclass(slots=True)
class _Question:
    """A type that nodes of a process are asked for."""

    participant: str
    offer: Offer
    since: int
    clients: dict[str, _Client]
    """The name of each service that is asked → its client."""


class TypeService:
    """The definitions that nodes of a domain have given, and the questions without an answer."""

    def __init__(self, domain: Domain, now: Callable[[], int]) -> None:
        """A client without questions.

        Args:
            domain: the domain of the nodes.
            now: the present time in nanoseconds.
        """
        self._domain, self._now = domain, now
        self._services: dict[str, list[str]] = {}
        """Participant → its services."""
        self._questions: dict[Offer, _Question] = {}
        self._definitions: dict[Offer, str | None] = {}
        """The answer to each question; None: there was none in time."""

    def definition(self, offer: Offer) -> str | None:
        """The definition that a node has given; None: none has."""
        return self._definitions.get(offer)

    def asks(self, participant: str, offer: Offer) -> bool:
        """Whether the answer about the type of a publisher is still open; asks if it is new."""
        if offer in self._definitions or offer.hash is None:
            return False
        if offer not in self._questions:
            asked = len(self._questions) + len(self._definitions)
            if not participant.startswith(_FAST_DDS) or asked >= MOST_QUESTIONS:
                return False
            self._questions[offer] = _Question(participant, offer, self._now(), {})
        return True

    def answers(self) -> Iterator[Offer]:
        """The offers whose questions have ended since the last call, answered or not."""
        for participant, topic in self._domain.readers_of_others():
            match = _REQUESTS.fullmatch(topic)
            if match is not None:
                self._note(participant, match[1])
        for offer, question in [*self._questions.items()]:
            text = self._answer(question)
            if text is None and self._now() - question.since < PATIENCE:
                continue
            self._definitions[offer] = text
            del self._questions[offer]
            for client in question.clients.values():
                client.close()
            yield offer

    def _note(self, participant: str, service: str) -> None:
        if participant not in self._services and len(self._services) >= _MOST_PARTICIPANTS:
            del self._services[next(iter(self._services))]
        services = self._services.setdefault(participant, [])
        if service not in services and len(services) < _MOST_SERVICES:
            services.append(service)

    def _answer(self, question: _Question) -> str | None:
        services = self._services.get(question.participant, [])
        for service in [*services]:
            try:
                if service not in question.clients:
                    question.clients[service] = _Client(self._domain, service, question.offer)
                text = question.clients[service].answer()
            except UnreadableTypeError:  # its name is no topic, or it takes no request
                services.remove(service)
                continue
            if text is not None:
                return text
        return None


class _Client:
    """One request to a service, and its answer."""

    def __init__(self, domain: Domain, service: str, offer: Offer) -> None:
        self._domain, self._offer, self._is_sent = domain, offer, False
        reply = Offer(f"{_SERVICE}_Response", reliable=True)
        request = Offer(f"{_SERVICE}_Request", reliable=True)
        self._reader: Reader = domain.reader(f"rr/{service}Reply", reply, None)
        self._writer: DdsWriter = domain.writer(f"rq/{service}Request", request, None)

    def answer(self) -> str | None:
        """The definition, once the service has sent the one with the type hash of the offer."""
        if not self._is_sent and self._writer.readers and self._reader.publishers:
            self._writer.write(request(self._offer))
            self._is_sent = True
        for sample in self._reader.samples():
            text = described(sample.payload, self._offer)
            if text is not None:
                return text
        return None

    def close(self) -> None:
        self._domain.release(self._reader, self._writer)


def described(payload: bytes, offer: Offer) -> str | None:
    """The definition in an answer; None: it is no answer, or not that of the publisher's type.

    Args:
        payload: the answer as CDR, with its head.
        offer: the type and its hash.
    """
    if len(payload) > _LONGEST:
        return None
    try:
        response = _store().deserialize_cdr(payload, _name("Response"))
        description = response.type_description
        main = _type(description.type_description)
        referenced = [_type(each) for each in description.referenced_type_descriptions]
        if main.name != offer.type or type_hash(main, referenced) != offer.hash:
            return None
        return definition(main, referenced)
    except Exception:  # for bytes of others, the decoder of rosbags may raise any exception
        return None


def _type(individual: Any) -> DescribedType:
    fields = (
        DescribedField(
            field.name,
            int(field.type.type_id),
            int(field.type.capacity),
            int(field.type.string_capacity),
            field.type.nested_type_name,
        )
        for field in individual.fields
    )
    return DescribedType(individual.type_name, tuple(fields))


def request(offer: Offer) -> bytes:
    """The question for the definition of a type, as CDR with its head."""
    name = _name("Request")
    kind = _store().types[name]
    question = kind(type_name=offer.type, type_hash=offer.hash, include_type_sources=False)
    return bytes(_store().serialize_cdr(question, name))


def _name(part: str) -> str:
    """The name of a part of the service as rosbags has it."""
    return f"{_SERVICE.replace('/srv/', '/msg/')}_{part}"


@cache
def _store() -> Any:
    """The types of ROS 2, with the parts of the service."""
    return ros2_types.extended(
        {_name("Request"): _FIELDS_OF_REQUEST, _name("Response"): _FIELDS_OF_RESPONSE}
    )
