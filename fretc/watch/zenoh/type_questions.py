"""Definitions of types that only a robot's own packages have, asked of its nodes over Zenoh.

A node on rmw_zenoh answers its service `~/get_type_description` by a queryable with the key
`<domain>/<service>/<type>/<hash>`. Messages of the type wait for the answer. An answer counts only
if its type hash is the one in the key of the messages.
"""

from __future__ import annotations

from dataclasses import field

from fretc.watch.sources.dds_types import Offer
from fretc.watch.sources.type_service import MOST_QUESTIONS, described
from fretc.watch.zenoh.keys import Kind, has_key
from fretish.classes.frozen import dataclass

MOST_NODES = 4
"""The most nodes that are asked for a type."""
MOST_HELD = 1000
"""The most messages of a key that wait; further ones are lost, which their numbers tell."""


@dataclass(frozen=True, slots=True)
class Held:
    """A message that waits."""

    topic: str
    payload: bytes
    attached: bytes


@dataclass(slots=True)
class Question:
    """A type that nodes are asked for."""

    key: str
    """The key of the messages of this type."""
    offer: Offer
    services: list[str]
    """The key expressions of the services that are asked."""
    definition: str | None = None
    """The answer."""
    is_sent: bool = False
    open: int = 0
    """How many of the services may still answer."""
    held: list[Held] = field(default_factory=list)

    def take(self, payload: bytes) -> None:
        """Take an answer, as CDR."""
        if self.definition is None:
            self.definition = described(payload, self.offer)


class TypeQuestions:
    """The questions without an answer, and the answers."""

    def __init__(self) -> None:
        """No question yet."""
        self._open: dict[str, Question] = {}
        self._definitions: dict[str, str | None] = {}

    def definition(self, key: str) -> str | None:
        """The definition of the messages with this key that a node has given; None: none has."""
        return self._definitions.get(key)

    def may_ask(self, key: str) -> bool:
        """Whether nobody was asked for the messages with this key, and still can be."""
        asked = len(self._open) + len(self._definitions)
        return asked < MOST_QUESTIONS and key not in self._open and key not in self._definitions

    def ask(self, domain: int, key: str, kind: Kind, nodes: list[str]) -> None:
        """Ask these nodes for the type of the messages with this key."""
        names = [node for node in nodes if has_key(node)][:MOST_NODES]
        services = [f"{domain}{name}/get_type_description/*/*" for name in names]
        if services:
            offer = Offer(kind.type, kind.hash)
            self._open[key] = Question(key, offer, services, open=len(services))
        else:
            self._definitions[key] = None

    def holds(self, key: str, message: Held) -> bool:
        """Whether a question about the messages with this key is open, so that this one waits."""
        question = self._open.get(key)
        if question is not None and len(question.held) < MOST_HELD:
            question.held.append(message)
        return question is not None

    def unsent(self) -> list[Question]:
        """The questions since the last call."""
        found = [each for each in self._open.values() if not each.is_sent]
        for each in found:
            each.is_sent = True
        return found

    def end(self, question: Question) -> list[Held]:
        """One of the services answers no more; after the last of them, the messages that waited."""
        question.open -= 1
        if question.open or self._open.get(question.key) is not question:
            return []
        del self._open[question.key]
        self._definitions[question.key] = question.definition
        return question.held

    def drop(self) -> None:
        """The connection is lost: what is open is asked again later, and what waits is lost."""
        self._open.clear()
