"""The core of an emitted node on DDS: what it sees at each tick, from a subscription of its own.

    python -m tests.dds_node FOLDER SINGLES

runs `perception.py` and `monitors.py` of the folder. SINGLES are the signals that are fields of
32-bit floats, with commas between. It ends when nobody publishes any more, and prints the rows of
all ticks and where each requirement stands.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from fretc.watch.sources.dds import Dds
from fretc.watch.sources.source import Arrival, Problem
from fretish.diagnostics.diagnostic import Code
from simulation.nodes.messages import TYPES


def loaded(path: Path) -> Any:
    """The file as a module, as `python3` runs it."""
    module = ModuleType(path.stem)
    sys.modules[path.stem] = module  # dataclasses look their module up
    exec(compile(path.read_text(), str(path), "exec"), module.__dict__)
    return module


def settled(ledger: Any, first: int, last: int) -> list[object]:
    """The rows from `first` on, but for the last ones, which may still become unknown."""
    return [[ledger.time(i), dict(ledger.row(i))] for i in range(first, len(ledger) - last)]


def main(folder: str, singles: str) -> None:
    """Listen until the end."""
    live, monitors = (loaded(Path(folder, name)) for name in ("perception.py", "monitors.py"))
    node = live.OnlineEvaluator(monitors.MONITOR, live.SETTING)
    source, left, latest = Dds(), set(live.SETTING.topics), 0
    rows: list[object] = []
    for item in source.arrivals(live.SETTING.topics):
        if isinstance(item, Arrival):
            message: Any = TYPES.deserialize_cdr(item.payload, item.channel.schema_name)
            if hasattr(message, "ranges"):
                message.ranges = message.ranges.tolist()
            stamp = message.header.stamp
            sent = stamp.sec * 10**9 + stamp.nanosec
            latest = max(latest, sent)
            node.arrive(item.channel.topic, sent, item.log_time, message, singles.split(","))
            rows += settled(node.ledger, len(rows), live.KEPT // 2)
        if isinstance(item, Problem) and item.diagnostic.code is Code.PUBLISHER_GONE:
            left -= {topic for topic in left if f"`{topic}`" in item.diagnostic.message}
            if not left:
                source.close()
    node.pass_to(latest + live.SETTING.lateness + 1)  # nothing more comes of what is before it
    rows += settled(node.ledger, len(rows), 0)
    statuses = {each.requirement: str(each.verdict) for each in node.monitor.statuses()}
    print(json.dumps({"rows": rows, "statuses": statuses, "resets": node.resets}))


if __name__ == "__main__":
    main(*sys.argv[1:])
