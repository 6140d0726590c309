"""Statuses of goals and events of services over DDS, published by real rclpy."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest

from fretc.logs.reader import read
from fretc.logs.signals.samples import Recording
from tests.effort import full_only
from tests.fretc.logs.logs import declare
from tests.fretc.watch.watched import Watched
from tests.programs import needs_package
from tests.ros2.real.network import PATIENCE, Network, network

SERVER = Path(__file__).parents[3] / "ros2/real/server.py"
BINDINGS = """
[clock]
tick = "50 ms"

[signal.goal]
action = "/navigate_to_pose"
agg = "any"

[signal.arm]
service = "/arm"
agg = "any"

[proposition.ended]
expr = "goal = succeeded or goal = aborted"
agg = "any"

[proposition.responded]
agg = "any"
expr = "arm = response_sent"
on_unknown = false
"""
FRET = """
+++
id = "ENDS"
+++
whenever goal = accepted the navigator shall within 2 seconds satisfy ended
+++
id = "CANCELED"
+++
the navigator shall never satisfy goal = canceled
+++
id = "CALLED"
+++
the navigator shall never satisfy responded
"""

pytestmark = [pytest.mark.slow, needs_package("cyclonedds")]


@pytest.fixture(params=["jazzy", pytest.param("kilted", marks=full_only("a second release"))])
def here(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Network]:
    with network(tmp_path, request.param) as place:
        yield place


def until(what: str, holds: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end, what
        time.sleep(0.05)


def test_a_watch_hears_goals_that_end_and_one_that_is_lost(here: Network, tmp_path: Path) -> None:
    folder = tmp_path / "requirements"
    folder.mkdir()
    (folder / "bindings.toml").write_text(BINDINGS)
    (folder / "all.fret").write_text(FRET)
    server = here.start(str(SERVER), stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def send(line: str) -> None:
        assert server.stdin is not None
        assert server.stdout is not None
        print(line, file=server.stdin, flush=True)
        assert server.stdout.readline() == "done\n"

    send("2")  # A late subscriber gets this status: the goal was accepted before.
    environment = {**os.environ, **here.of_fretc}
    watch = Watched(environment, tmp_path, "dds", "--record", "run.mcap")
    with closing(watch):
        send("call")
        until("the service is heard", lambda: heard(watch, send, "CALLED"))
        assert watch.verdict("CANCELED") != "violated"
        for line in ("4", "4 1", "4 2", "4 6", "4 6 1", "4 6 2", "4 6 3", "4 6 5"):
            send(line)
            time.sleep(0.1)
        until("the third goal is canceled", lambda: watch.verdict("CANCELED") == "violated")
        until("it neither succeeds nor aborts", lambda: watch.verdict("ENDS") == "violated")
        watch.end()
    recording = read(str(tmp_path / "run.mcap"), declare(BINDINGS), ["goal", "arm"])
    assert isinstance(recording, Recording)
    goal, arm = recording.samples["goal"], recording.samples["arm"]
    words = [goal.words[int(place)] for place in goal.values]
    assert words[0] == "executing"
    assert words[-8:] == [
        *("succeeded", "accepted", "executing", "aborted"),
        *("accepted", "executing", "canceling", "canceled"),
    ]
    events = {arm.words[int(place)] for place in arm.values}
    assert events == {"request_sent", "request_received", "response_sent", "response_received"}


def heard(watch: Watched, send: Callable[[str], None], requirement: str) -> bool:
    """Whether a call of the service has violated a requirement."""
    send("call")
    return watch.verdict(requirement) == "violated"
