"""The requirements of docs/ros.md by which an audit compares two nodes of one package."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.command import Fretc, write
from tests.docs.pages import FOLDER, blocks
from tests.fretc.logs.logs import MS, S, Sent, payload
from tests.fretc.logs.logs import write as write_log

PYTHON, CPP = "/gwendolen_control", "/r1_monitor_cpp/stop"
SECONDS, BEAT = 10, 100 * MS


def requests(topic: str, stops: range, *, delay: int = 0, until: int = SECONDS * S) -> list[Sent]:
    """What a node publishes each 100 ms, and when that changes; `stops` is in milliseconds."""
    changes = {stops.start * MS + delay, stops.stop * MS + delay}
    times = sorted({*range(delay, until, BEAT), *changes})
    begin, end = stops.start * MS + delay, stops.stop * MS + delay
    return [
        Sent(topic, "std_msgs/Bool", payload("std_msgs/Bool", data=begin <= t < end), t)
        for t in times
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("other", "status", "python", "cpp"),
    [
        (requests(CPP, range(3_010, 5_010), delay=7 * MS), 0, "satisfied", "satisfied"),
        (requests(CPP, range(3_300, 5_010)), 1, "violated", "satisfied"),
        (requests(CPP, range(2_500, 5_010)), 1, "satisfied", "violated"),
        (requests(CPP, range(3_010, 4_500)), 1, "violated", "satisfied"),
        (requests(CPP, range(3_010, 5_010), until=4 * S), 3, "no data", "no data"),
    ],
    ids=["alike", "one comes late", "one comes early", "one ends early", "one is killed"],
)
def test_an_audit_compares_both_nodes(
    fretc: Fretc, other: list[Sent], status: int, python: str, cpp: str
) -> None:
    page = (FOLDER / "ros.md").read_text(encoding="utf-8")
    for name, sentence in zip(("python", "cpp"), blocks(page, "fret"), strict=True):
        write(f"requirements/{name}.fret", sentence)
    write("requirements/bindings.toml", *blocks(page, "toml"))
    sent = sorted([*requests(PYTHON, range(3_010, 5_010)), *other], key=lambda each: each.time)
    write_log(Path("run.mcap"), sent)
    run = fretc("audit", "run.mcap")
    assert run.status == status, run.err
    results = json.loads(Path("build/evidence.json").read_text("utf-8"))["results"]
    assert {each["requirement"]: each["verdict"] for each in results} == {
        "python": python,
        "cpp": cpp,
    }
