"""Diagnostics on the wire of ROS 2, read by another participant, with the official decoder."""

from threading import Thread
from typing import Any

import pytest
from mcap.records import Schema
from mcap_ros2.decoder import DecoderFactory

from fretc.watch.publishing.choice import chosen
from fretc.watch.publishing.publishing import Publishing
from fretc.watch.sources.dds import Dds
from fretc.watch.sources.source import Arrival, Idle, Opened
from fretc.watch.watch import Watch
from fretish.diagnostics.diagnostic import Diagnostic
from monitors.stop_supervisor import ERROR, OK
from tests.dds import domain, environment
from tests.fretc.watch.sent import Sent, Setting, plan_of
from tests.programs import needs_package
from tests.ros1 import until

pytestmark = [pytest.mark.slow, needs_package("cyclonedds")]


class Listening:
    """A source in a thread, and what it has given."""

    def __init__(self, source: Dds, *topics: str) -> None:
        self.source, self.items = source, list[object]()
        self._thread = Thread(
            target=lambda: self.items.extend(source.arrivals(topics)), daemon=True
        )
        self._thread.start()
        until("it is opened", lambda: any(isinstance(each, Opened) for each in [*self.items]))

    def close(self) -> None:
        self.source.close()
        self._thread.join(10)
        assert not self._thread.is_alive()

    def statuses(self) -> dict[str, Any]:
        """Of the last message."""
        found = [each for each in [*self.items] if isinstance(each, Arrival)]
        if not found:
            return {}
        about = found[-1].channel
        schema = Schema(
            id=1, name=about.schema_name, encoding=about.schema_encoding, data=about.schema
        )
        decode = DecoderFactory().decoder_for("cdr", schema)
        assert decode is not None
        message: Any = decode(found[-1].payload)
        assert message.header.stamp.sec > 0
        return {each.name: each for each in message.status}


def test_diagnostics_are_read_back_by_another_participant(monkeypatch: pytest.MonkeyPatch) -> None:
    with domain() as number:
        for name, value in environment(number).items():
            monkeypatch.setenv(name, value)
        source = Dds()
        publishers = chosen(["diagnostics"], source)
        assert not isinstance(publishers, Diagnostic)
        watch, publishing = Watch(plan_of(Setting(slow="y < 5"))), Publishing(publishers)
        robot, reader = Listening(source, "/x"), Listening(Dds(), "/diagnostics")
        at = iter(range(0, 10**6, 10))

        def level(requirement: str, x: float) -> int | None:
            now = next(at)
            for item in (Sent("/x", x, now).arrival, Sent("/y", 9.0, now).arrival, Idle(None)):
                list(watch.take(item))
                publishing.take(item, watch)
            found = reader.statuses().get(f"fretc watch: {requirement}")
            return None if found is None else int(found.level)

        try:
            until("R1 is well", lambda: level("R1", 9.0) == OK, 30)
            until("R1 is violated", lambda: level("R1", 1.0) == ERROR, 30)
            values = reader.statuses()["fretc watch: R1"].values
            assert ("verdict", "violated") in [(each.key, each.value) for each in values]
        finally:
            robot.close()
            reader.close()
