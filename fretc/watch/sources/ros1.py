"""Messages of ROS 1 as bytes, through a node under the Python that has rospy.

The arrival time of a message is the time at which this process gets it. The node ends with the
master, because a new master does not know it; until there is a new one, all messages may be lost.
"""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path
from threading import Lock
from typing import IO, Any

from fretc.watch.sources import ros1_bridge
from fretc.watch.sources.middleware import Middleware, several_publishers
from fretc.watch.sources.source import Channel
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.system.processes import OWN_GROUP
from monitors.stop_supervisor import Status

PYTHON = "/usr/bin/python3"
"""The Python of Debian and Ubuntu, for which ROS is packaged."""


class Ros1(Middleware):
    """The graph of the master in `ROS_MASTER_URI`."""

    def __init__(self, python: str = PYTHON) -> None:
        """A source that is not yet open; `python` is a Python with rospy."""
        super().__init__("ros1")
        self._python = python
        self._lock = Lock()
        self._node: subprocess.Popen[bytes] | None = None
        self._several: set[str] = set()
        self._simulated = False
        self._statuses: Sequence[Status] | None = None
        """The statuses to publish; None: nothing is ever published."""
        self._is_mute = False
        """Whether the node cannot publish."""

    def diagnose(self, statuses: Sequence[Status]) -> None:
        """Publish the statuses with the next heartbeat of the node, twice a second."""
        self._statuses = statuses

    @property
    def _diagnoses(self) -> bool:
        return self._statuses is not None and not self._is_mute

    def close(self) -> None:
        """End the node."""
        super().close()
        with self._lock:
            if self._node is not None:
                self._node.kill()

    def _listen(self, topics: list[str]) -> bool:
        """Run the node until it ends; whether it has found a master."""
        try:
            node = self._start()
        except OSError as error:
            self._lost(_no_rospy(self._python, error.strerror or str(error)))
            return False
        if node is None:
            return False
        assert node.stdin is not None
        assert node.stdout is not None
        opened = False
        channels: list[Channel] = []
        try:
            with node:
                try:
                    asked = {"topics": topics, "diagnoses": self._diagnoses}
                    _write(node.stdin, asked)
                    for head, payload in _frames(node.stdout):
                        opened |= head["kind"] == "opened"
                        self._take(head, payload, channels)
                        if head["kind"] == "alive" and self._diagnoses and self._statuses:
                            _write(node.stdin, self._statuses)
                finally:
                    node.kill()
        except OSError:
            pass  # its pipe is broken: the node has ended
        self._lost(diagnostic("node_ended"))
        return opened

    def _start(self) -> subprocess.Popen[bytes] | None:
        """Start the node, unless the source was closed meanwhile."""
        with self._lock:
            if self._closed.is_set():
                return None
            environment = {k: v for k, v in os.environ.items() if k != "PYTHONHOME"}
            self._node = subprocess.Popen(
                [self._python, str(Path(ros1_bridge.__file__))],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=environment,
                start_new_session=True,  # Ctrl-C is for the watch, which then ends the node
                creationflags=OWN_GROUP,
            )
            return self._node

    def _take(self, head: dict[str, Any], payload: bytes, channels: list[Channel]) -> None:
        match head["kind"]:
            case "message":
                self._put(channels[head["channel"]], payload)
            case "channel":
                topic, type_, definition = head["channel"]
                channels.append(Channel(topic, "ros1", type_, "ros1msg", definition.encode()))
            case "opened":
                self._opened(f"the ROS 1 master {head['uri']}")
            case "alive":
                self._is_alive(self._mailbox.now)
                self._count_publishers(head["publishers"])
            case "simulated time":
                self._warn_of_simulated_time()
            case "no diagnostics":
                self._warn(diagnostic("no_diagnostics_type", python=self._python, why=head["why"]))
                self._is_mute = True
            case "no master":
                self._lost(diagnostic("no_master", uri=head["uri"]))
            case "no rospy":
                self._lost(_no_rospy(self._python, head["why"]))
            case kind:
                raise AssertionError(f"the node sends nothing of this kind: {kind}")

    def _count_publishers(self, publishers: dict[str, list[str]]) -> None:
        for topic, nodes in publishers.items():
            if len(nodes) > 1 and topic not in self._several:
                self._several.add(topic)
                self._warn(several_publishers(topic, len(nodes), nodes))

    def _warn_of_simulated_time(self) -> None:
        if not self._simulated:
            self._simulated = True
            self._warn(diagnostic("simulated_time"))


def _write(stream: IO[bytes], content: object) -> None:
    """A line of JSON; a status is an array."""
    stream.write(json.dumps(content).encode() + b"\n")
    stream.flush()


def _frames(stream: IO[bytes]) -> Iterator[tuple[dict[str, Any], bytes]]:
    """All complete frames."""
    lengths = ros1_bridge.LENGTHS
    while len(start := stream.read(lengths.size)) == lengths.size:
        of_head, of_payload = lengths.unpack(start)
        data = stream.read(of_head + of_payload)
        if len(data) < of_head + of_payload:
            return
        yield json.loads(data[:of_head]), data[of_head:]


def _no_rospy(python: str, why: str) -> Diagnostic:
    return diagnostic("no_rospy", python=python, why=why)
