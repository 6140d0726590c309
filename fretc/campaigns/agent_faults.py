"""What goes wrong with an agent in a simulated mission: its process, its connection, its clock."""

from __future__ import annotations

import subprocess
import time
from array import array
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from fretish.system.processes import kill_all
from simulation.world.scenario import AgentFault

DELAY = 500_000_000
"""Nanoseconds by which messages are delayed."""
COPIES = 3
"""How often a duplicated message comes."""
HEAP = "-Xmx64m"
"""An option of Java: so much memory is enough until messages are large."""
_NUMBERS = 1_900_000
"""Numbers of a message that exhausts the memory: 7.6 MB."""
_MOST_SENT, _PAUSE = 50, 0.2
"""The most of them, and seconds between two."""
_SECOND = 10**9
Message = tuple[str, Any]
"""Topic and message."""


class FaultyConnection:
    """The way of the robot's messages to the agent; times are nanoseconds of the mission."""

    def __init__(self, fault: AgentFault | None) -> None:
        self._kind = fault.kind if fault else None
        self._begin = round(fault.at * _SECOND) if fault else 0
        self._end = (
            self._begin + round(fault.seconds * _SECOND) if fault and fault.seconds else None
        )
        self._by = round(fault.by * _SECOND) if fault else 0
        self._held: list[tuple[int, Message]] = []

    def is_on(self, at: int) -> bool:
        """Whether the fault is there."""
        return (
            self._kind is not None and at >= self._begin and (self._end is None or at < self._end)
        )

    def step(self, at: int) -> int:
        """By how much the agent's clock is wrong, in nanoseconds."""
        return self._by if self._kind == "clock stepped" and self.is_on(at) else 0

    def carried(self, messages: Mapping[str, Any], now: int) -> Sequence[Message]:
        """The messages that arrive now, in their order, of those that are sent now and before."""
        sent = list(messages.items())
        match self._kind if self.is_on(now) else None:
            case "dropped":
                return []
            case "delayed":
                self._held += [(now + DELAY, message) for message in sent]
            case "duplicated":
                return [message for message in sent for _ in range(COPIES)]
            case "reordered":
                before, self._held = self._held, []
                if not before:
                    self._held = [(now, message) for message in sent]
                    return []
                return [*sent, *(message for _, message in before)]
            case _:
                self._held = [(0, message) for _, message in self._held]
                self._held += [(0, message) for message in sent]
        due = [message for at, message in self._held if at <= now]
        self._held = [(at, message) for at, message in self._held if at > now]
        return due


def kill(process: subprocess.Popen[bytes]) -> None:
    """Kill the agent."""
    kill_all(process)
    process.wait()


def flood(send: Callable[[Mapping[str, Any]], None], process: subprocess.Popen[bytes]) -> None:
    """Send messages that need more memory than the agent has, until it has ended."""
    message = {"ranges": array("f", bytes(4 * _NUMBERS))}
    for _ in range(_MOST_SENT):
        if process.poll() is not None:
            return
        send(message)
        time.sleep(_PAUSE)
