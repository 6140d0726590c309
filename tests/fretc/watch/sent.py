"""Messages that are sent to a watch, and the requirements that it watches."""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import strategies as st

from fretc.api.requirements import read_project
from fretc.audit.plan import Plan, planned
from fretc.watch.sources.source import Arrival, Channel

MS, START = 10**6, 10**12
SENTENCES = (
    "whenever near the r shall within 2 ticks satisfy still",
    "the r shall always satisfy !near | still",
    "upon near the r shall for 2 ticks satisfy slow",
    "whenever persisted(1, near) the r shall eventually satisfy slow",
    "whenever near the r shall with probability >= 0.9 within 2 ticks satisfy still",
)
BINDINGS = """
[clock]
tick = {tick}
time = "{time}"
{more}
[signal.x]
path = "/x.data"
{age}
[signal.y]
path = "/y.data"
[signal.z]
path = "/x.other"
[signal.v]
value = "hypot(x, y)"
[signal.w]
value = "clamp(x + v, 0, 11) + 0 * sqrt(x - 5)"
[signal.changing]
value = "rate(x)"
[signal.trend]
value = "rate(x, over = 12 ms)"
[signal.middle]
value = "mean(x, over = 25 ms)"
[signal.highest]
value = "max(x, over = 13 ms)"
[signal.lowest]
value = "min(x, over = 40 ms)"
[signal.ones]
value = "count(x, over = 30 ms)"
[proposition.near]
expr = "x < 5"
agg = "{aggregate}"
{unknown}
[proposition.still]
expr = "(y < 5 for 12 ms) or (x < 5 and not (z < 5))"
[proposition.slow]
expr = "{slow}"
"""
MEMORIES = (
    *("changing < 100 Hz", "trend < 100 Hz or trend > -1 Hz", "middle < 5 for 12 ms"),
    *("highest < 5 and y < 5", "lowest < 5 for 9 ms", "ones > 1", "ones < 2 or highest < 9"),
)
"""Conditions on signals with memory."""


@dataclass(frozen=True)
class Setting:
    """What bindings say."""

    tick: str = '"10 ms"'
    time: str = "header.stamp"
    more: str = ""
    age: str = ""
    aggregate: str = "any"
    unknown: str = ""
    slow: str = "y - pre(9, y) < 5"
    lateness: int = 5

    @property
    def bindings(self) -> str:
        waits = f'lateness = "{self.lateness} ms"'
        more = "\n".join([waits, *([self.more] if '"/' not in self.tick else [])])
        return BINDINGS.format(**{**vars(self), "more": more})


settings_ = st.builds(
    Setting,
    tick=st.sampled_from(['"10 ms"', '"10 ms"', '"/x"', '"/clock"']),
    time=st.sampled_from(["header.stamp", "header.stamp", "publish_time", "log_time"]),
    more=st.sampled_from(["", 'phase = "3 ms"', 'end = "violated"']),
    age=st.sampled_from(["", 'max_age = "17 ms"']),
    aggregate=st.sampled_from(["any", "all", "last"]),
    unknown=st.sampled_from(["", "on_unknown = true"]),
    slow=st.sampled_from(
        [
            *("y - pre(9, y) < 5", "y < 5 and x < 9", "z < 5 for 25 ms"),
            *("v < 9.1 for 12 ms", "w < 11 or v > 10", "v - pre(9, v) < 2"),
            *MEMORIES,
        ]
    ),
    lateness=st.sampled_from([0, 5, 20]),
)


@cache
def plan_of(setting: Setting) -> Plan:
    with TemporaryDirectory() as name:
        folder = Path(name)
        for i, sentence in enumerate(SENTENCES):
            (folder / f"R{i}.fret").write_text(sentence)
        (folder / "bindings.toml").write_text(setting.bindings)
        plan = planned(read_project(folder))
    assert isinstance(plan, Plan), plan
    assert len(plan.claims) == len(SENTENCES)
    return plan


@dataclass(frozen=True)
class Sent:
    """A message: its time, and how much later it was received, in milliseconds."""

    topic: str
    value: float | None
    at: int
    delay: int = 0
    stamped: bool = True

    @property
    def arrival(self) -> Arrival:
        stamp = START + self.at * MS
        sec, nanosec = divmod(stamp, 10**9)
        content: dict[str, object] = {"data": self.value, "other": 4}
        if self.stamped:
            content["header"] = {"stamp": {"sec": sec, "nanosec": nanosec}}
        channel = Channel(self.topic, "json", "", "", b"")
        received = stamp + self.delay * MS
        return Arrival(channel, json.dumps(content).encode(), received, stamp)
