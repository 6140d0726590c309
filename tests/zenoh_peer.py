"""A peer on Zenoh for tests, in a process of its own, and what a watch of it has given.

It speaks as the design page of rmw_zenoh says: keys, liveliness tokens, and attachments by Zenoh's
own serializer. rmw_zenoh itself is not installed. The peer listens at one port of this machine and
looks for nobody.
"""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from base64 import b64encode
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Any

from fretc.logs.messages.ros2_types import definitions
from fretc.watch.zenoh.zenoh import Zenoh
from tests.source_listener import SourceListener, closed

STRING = "std_msgs::msg::dds_::String_"
NO_HASH = "TypeHashNotSupported"

_PEER = '''
"""Does what standard input says: an object of JSON a line. It prints each line that is done."""
import base64, json, sys, time
import zenoh
from zenoh.ext import (
    CacheConfig, HistoryConfig, Int64, MissDetectionConfig, UInt8, declare_advanced_publisher,
    z_serialize,
)

configuration = zenoh.Config()
for name, value in {
    "mode": "peer",
    "listen/endpoints": [f"tcp/127.0.0.1:{sys.argv[1]}"],
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": False,
    "transport/shared_memory/enabled": False,
    "timestamping/enabled": True,
}.items():
    configuration.insert_json5(name, json.dumps(value))
session = zenoh.open(configuration)
print(session.zid(), flush=True)
publishers, tokens, services, count = {}, {}, [], 0


def attached(number, time, gid):
    """The three fields, and nothing between them."""
    return b"".join(
        z_serialize(each).to_bytes() for each in (Int64(number), Int64(time), bytes.fromhex(gid))
    )


class Publisher:
    def __init__(self, domain, topic, type, hash, node="talker", gid=None, keeps=0, token=True):
        global count
        count += 1
        self.gid = gid or f"{count:032x}"
        self.number = 0
        key = f"{domain}/{topic.strip('/')}/{type}/{hash}"
        if keeps:
            self.publisher = declare_advanced_publisher(
                session, key, cache=CacheConfig(keeps), publisher_detection=True,
                congestion_control=zenoh.CongestionControl.BLOCK,
            )
        else:
            self.publisher = session.declare_publisher(
                key, congestion_control=zenoh.CongestionControl.BLOCK
            )
        mangled = topic.replace("/", "%")
        qos = f":{1 if keeps else ''}:,10:,:,:,,"
        name = (
            f"@ros2_lv/{domain}/{session.zid()}/0/{count}/MP/%/%/{node}/"
            f"{mangled}/{type}/{hash}/{qos}"
        )
        self.token = session.liveliness().declare_token(name) if token else None

    def send(self, data, number=None, time=None, attachment=None):
        self.number = self.number + 1 if number is None else number
        if attachment is None:
            attachment = attached(self.number, 7 if time is None else time, self.gid)
        self.publisher.put(data, attachment=attachment or None)

    def end(self):
        self.publisher.undeclare()
        if self.token is not None:
            self.token.undeclare()


def serve(key, request, data):
    """Answer requests that have the form of rmw_zenoh's; without data, only their end is sent."""

    def reply(query):
        attached = query.attachment.to_bytes()
        if query.payload.to_bytes() == request and len(attached) == 33 and attached[16] == 16:
            if data:
                query.reply(key, data, attachment=attached)

    services.append(session.declare_queryable(key, reply, complete=True))


def play(path, start, end, skip):
    """A part of a log, as it went, in seconds from its beginning; a message may be lost."""
    from mcap.reader import make_reader
    begin, first = None, None
    with open(path, "rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            first = first or message.log_time
            at = (message.log_time - first) / 1e9
            if channel.topic not in publishers or not start <= at < end:
                continue
            begin = begin or time.monotonic() - at
            time.sleep(max(0, begin + at - time.monotonic()))
            publisher = publishers[channel.topic]
            if publisher.number + 1 == skip:
                publisher.number += 1
            publisher.send(message.data, time=message.log_time)


for line in sys.stdin:
    asked = json.loads(line)
    do, name = asked.pop("do"), asked.pop("name", None)
    for word in ("data", "attachment", "request"):
        if asked.get(word) is not None:
            asked[word] = base64.b64decode(asked[word])
    match do:
        case "publish":
            publishers[name] = Publisher(**asked)
        case "send":
            publishers[name].send(**asked)
        case "flood":
            for _ in range(asked["count"]):
                publishers[name].send(asked["data"])
        case "end":
            publishers.pop(name).end()
        case "untoken":
            publishers[name].token.undeclare()
        case "put":
            session.put(asked["key"], asked["data"])
        case "delete":
            session.delete(asked["key"])
        case "token":
            tokens[asked["key"]] = session.liveliness().declare_token(asked["key"])
        case "drop":
            tokens.pop(asked["key"]).undeclare()
        case "serve":
            serve(**asked)
        case "play":
            play(*asked["part"], asked["skip"])
    print(do, flush=True)
'''


def digest(type_: str) -> str:
    """The hash of a standard type, of the latest release."""
    return [*definitions(type_)][-1]


def mangled(type_: str) -> str:
    """`std_msgs/msg/String` → `std_msgs::msg::dds_::String_`."""
    package, kind, name = type_.split("/")
    return f"{package}::{kind}::dds_::{name}_"


@dataclass
class Peer:
    """A peer; what it is asked to do is done when the call returns."""

    process: subprocess.Popen[str]
    port: int

    @property
    def locator(self) -> str:
        return f"tcp/127.0.0.1:{self.port}"

    def ask(self, do: str, **more: object) -> None:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        for word in ("data", "attachment", "request"):
            value = more.get(word)
            if isinstance(value, bytes):
                more[word] = b64encode(value).decode()
        print(json.dumps({"do": do, **more}), file=self.process.stdin, flush=True)
        assert self.process.stdout.readline() == f"{do}\n"

    def publish(self, name: str, topic: str = "/x", **more: object) -> None:
        usual: dict[str, object] = {"domain": 0, "type": STRING}
        usual["hash"] = digest("std_msgs/msg/String")
        self.ask("publish", name=name, topic=topic, **{**usual, **more})

    def send(self, name: str, data: bytes = b"x", **more: object) -> None:
        self.ask("send", name=name, data=data, **more)


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


@contextmanager
def peer(port: int | None = None) -> Iterator[Peer]:
    """A peer on a port that is free, or on this one."""
    port = free_port() if port is None else port
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    process = subprocess.Popen([sys.executable, "-c", _PEER, str(port)], **pipes)
    try:
        assert process.stdout is not None
        assert process.stdout.readline()
        yield Peer(process, port)
    finally:
        process.kill()
        process.communicate()


class Listened(SourceListener):
    """A source, and what it has given."""

    def __init__(self, locator: str, *topics: str) -> None:
        os.environ.pop("ROS_DOMAIN_ID", None)
        super().__init__(Zenoh(locator), *topics)


def listened(locator: str, *topics: str) -> AbstractContextManager[Listened]:
    return closed(Listened(locator, *topics))
