"""A node of ROS 1 that hands every message on as bytes; a program of its own.

It runs under the Python that knows rospy, which may be older than fretc's, and imports nothing of
fretc. Standard input: lines of JSON, first the topics and whether something is published, then what
goes to `/diagnostics`: of each status level, name, message, keys with values. When it ends, so does
the node.
Standard output: frames, each two lengths of 4 bytes (little-endian), a head as JSON, and a payload.
"""

from __future__ import annotations

import json
import os
import queue
import struct
import sys
import threading
import time
from typing import Any, BinaryIO

LENGTHS = struct.Struct("<II")
_PERIOD = 0.5
"""Seconds between two looks at the master."""
_PATIENCE = 5.0
"""Seconds in which a master answers."""
_CONNECTING = 2.0
"""Seconds in which those who publish already should answer."""


class _Frames:
    """Frames to one stream, from any thread."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._lock = threading.Lock()
        self._channels: dict[tuple[str, ...], int] = {}

    def send(self, head: dict[str, Any], payload: bytes = b"") -> None:
        with self._lock:
            self._write(head, payload)

    def message(self, topic: str, about: dict[str, str], payload: bytes) -> None:
        """A message; before the first one of its kind, what its bytes mean."""
        key = topic, about.get("type", ""), about.get("message_definition", "")
        with self._lock:
            if key not in self._channels:
                self._channels[key] = len(self._channels)
                self._write({"kind": "channel", "channel": key}, b"")
            self._write({"kind": "message", "channel": self._channels[key]}, payload)

    def _write(self, head: dict[str, Any], payload: bytes) -> None:
        data = json.dumps(head).encode()
        self._stream.write(LENGTHS.pack(len(data), len(payload)) + data + payload)
        self._stream.flush()


def _main() -> None:
    del sys.path[0]  # this folder: its modules have common names
    frames = _Frames(os.fdopen(os.dup(1), "wb"))
    os.dup2(2, 1)  # rospy prints its log
    asked = json.loads(sys.stdin.readline())
    topics = asked["topics"]
    diagnoses: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(diagnoses,), daemon=True).start()
    try:
        import rosgraph
        import rospy
    except ImportError as error:
        frames.send({"kind": "no rospy", "why": str(error)})
        return
    master = rosgraph.Master("/fretc_watch")
    uri = rosgraph.get_master_uri()
    _end_in_silence(rosgraph.Master("/fretc_watch"), frames, uri)
    pid = _pid(master)
    if pid is None:
        frames.send({"kind": "no master", "uri": uri})
        return
    rospy.init_node("fretc_watch", anonymous=True, disable_signals=True)
    subscribers = {topic: _subscribe(rospy, frames, topic) for topic in topics}
    _connect(master, subscribers)
    if asked["diagnoses"]:
        _publish(rospy, frames, diagnoses)
    frames.send({"kind": "opened", "uri": uri})
    if rospy.get_param("/use_sim_time", False):
        frames.send({"kind": "simulated time"})
    _watch_master(master, pid, frames, topics)
    frames.send({"kind": "no master", "uri": uri})


def _subscribe(rospy: Any, frames: _Frames, topic: str) -> Any:
    def take(message: Any) -> None:
        frames.message(topic, message._connection_header, message._buff)

    return rospy.Subscriber(topic, rospy.AnyMsg, take, tcp_nodelay=True)


def _connect(master: Any, subscribers: dict[str, Any]) -> None:
    """Wait for all who publish already; one of them may be dead, so not for ever."""
    try:
        publishers = dict(master.getSystemState()[0])
    except Exception:  # the master is gone, which the next check reports
        return
    end = time.monotonic() + _CONNECTING
    for topic, subscriber in subscribers.items():
        while subscriber.get_num_connections() < len(publishers.get(topic, ())):
            if time.monotonic() > end:
                return
            time.sleep(0.01)


def _watch_master(master: Any, pid: int, frames: _Frames, topics: list[str]) -> None:
    """Until it is gone, or another one is there, which does not know this node."""
    pause = threading.Event()
    while _pid(master) == pid:
        try:
            publishers = dict(master.getSystemState()[0])
        except Exception:  # the master is gone; the exception depends on the cause
            break
        nodes = {topic: sorted(publishers.get(topic, ())) for topic in topics}
        frames.send({"kind": "alive", "publishers": nodes})
        pause.wait(_PERIOD)


def _pid(master: Any) -> int | None:
    """The process of the master; None: none answers."""
    try:
        return int(master.getPid())
    except Exception:  # as above
        return None


def _end_in_silence(master: Any, frames: _Frames, uri: str) -> None:
    """End the node where the master takes a call and does not answer it."""

    def look() -> None:
        pause = threading.Event()
        while True:
            timer = threading.Timer(_PATIENCE, give_up)
            timer.daemon = True
            timer.start()
            _pid(master)
            timer.cancel()
            pause.wait(_PERIOD)

    def give_up() -> None:
        frames.send({"kind": "no master", "uri": uri})
        os._exit(0)

    threading.Thread(target=look, daemon=True).start()


def _read(diagnoses: queue.SimpleQueue[Any]) -> None:
    for line in sys.stdin:
        diagnoses.put(json.loads(line))
    os._exit(0)


def _publish(rospy: Any, frames: _Frames, diagnoses: queue.SimpleQueue[Any]) -> None:
    """All that comes, from a thread of its own."""
    try:
        from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
    except ImportError as error:
        frames.send({"kind": "no diagnostics", "why": str(error)})
        return
    publisher = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=2)

    def run() -> None:
        while True:
            message = DiagnosticArray()
            statuses = diagnoses.get()
            message.header.stamp = rospy.Time.now()
            for level, name, text, values in statuses:
                pairs = [KeyValue(key, value) for key, value in values]
                message.status.append(DiagnosticStatus(level, name, text, "", pairs))
            publisher.publish(message)

    threading.Thread(target=run, daemon=True).start()


if __name__ == "__main__":
    try:
        _main()
    finally:
        os._exit(0)  # rospy's threads would continue
