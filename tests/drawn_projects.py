"""Projects drawn at random, whose bindings may have any field of any table."""

import json
import random
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w
from mcap.writer import Writer

MS = 10**6
CLOCK: Mapping[str, Any] = {
    "time": "publish_time",
    "phase": "50 ms",
    "lateness": "50 ms",
    "end": "violated",
    "rounding": "conservative",
}
NUMBER: Mapping[str, Any] = {
    "role": "input",
    "agg": "any",
    "type": "A",
    "max_age": "300 ms",
    "valid": "-100 <= x and x <= 100",
    "invalid": {"nan": "unknown", "other": "unknown"},
}
SIGNALS: Mapping[str, tuple[Mapping[str, Any], Mapping[str, Any]]] = {
    "ax": ({"path": "/a.x", "unit": "m"}, {**NUMBER, "valid": "-100 m <= x and x <= 100 m"}),
    "ay": ({"path": "/a.y", "unit": "cm"}, {k: v for k, v in NUMBER.items() if k != "valid"}),
    "bx": ({"path": "/b.x"}, NUMBER),
    "on": ({"path": "/b.on"}, {"role": "output", "max_age": "1 s"}),
    "mode": ({"path": "/b.mode", "values": ["idle", "dock"]}, {"role": "mode", "agg": "last"}),
    "gear": ({"path": "/b.gear", "values": {"park": 0, "drive": 4}}, {"max_age": "1 s"}),
    "row": ({"path": "/b.row[:]", "reduce": "min", "unit": "m"}, {"max_age": "1 s"}),
    "third": ({"path": "/b.row[2]", "unit": "m"}, {}),
}
"""Each with the fields that it needs, and those that it may have."""
MAY: Mapping[str, Any] = {
    "text": "as it is said",
    "role": "output",
    "kind": "command",
    "agg": "all",
    "on_unknown": False,
    "modality": "G",
    "action": "act",
}
EXPRESSIONS: Mapping[str, str] = {
    "low": "ax < 3 m",
    "near": "ax < 9 m and ay < 900 cm",
    "still": "abs(bx) < 9 for 100 ms",
    "docked": "mode == 'dock' or gear != 'park'",
    "lit": "on",
    "stepped": "ax - previous(ax) > 1 m",
    "clear": "min(row, third) > 0.5 m",
    "idle": "not on and mode = idle",
}
VARIABLES: Mapping[str, Mapping[str, Any]] = {
    "limit": {"value": "3 m", "text": "how near", "component": "sw"},
    "calm": {"value": "low & still"},
    "elsewhere": {"type": "boolean", "role": "input", "of": {"arm": {"role": "output"}}},
    "goal": {"modality": "G", "action": "reach"},
}
TABLES: Mapping[str, Any] = {
    "interceptor": {
        "stop": "/stop",
        "command": "/cmd_vel",
        "output": "/wheels",
        "scan": "/scan",
        "period": "50 ms",
        "hold": "200 ms",
        "stop_timeout": "500 ms",
        "scan_timeout": "500 ms",
    },
    "assume": {
        "stands": "still",
        "latency": "100 ms",
        "braking": "400 ms",
        "lost": 1,
        "requirement": [
            {"id": "A1", "text": "never both", "sentence": "the sw shall never satisfy low & lit"}
        ],
    },
    "map": {"x": "/a.x", "y": "/a.y"},
    "run": {"label": {"version": ["metadata:build.version", "path:{version}-*.mcap"]}},
}
SENTENCES = (
    "the sw shall always satisfy low",
    "the sw shall always satisfy ax <= 5 m",
    "whenever near the sw shall within 300 milliseconds satisfy still",
    "whenever mode = dock the sw shall eventually satisfy lit",
    "the sw shall never satisfy gear = drive & on",
    "whenever ax < limit the sw shall within 2 ticks satisfy calm",
    "in idle mode the sw shall always satisfy clear",
    "whenever persisted(2, low) the arm shall immediately satisfy docked",
    "whenever low the sw shall with probability >= 0.9 within 2 ticks satisfy lit",
    "upon stepped the arm shall until near satisfy ay + ax > 0.1 m",
    "the arm shall after 300 milliseconds satisfy abs(bx) < 3 | elsewhere",
    "the sw shall always satisfy nowhere",
    "the sw shall always satisfy persists(2, low)",
    "the sw shall always satisfy row > third",
    '"it stops in time"',
    "the sw shall always satisfy true",
)
HEADER: Mapping[str, Any] = {
    "title": "As it is called",
    "text": "in words",
    "parents": ["HAZ-1"],
    "rationale": "because",
    "status": "approved",
    "verify": ["audit", "monitor", "ajpf"],
    "params": {"low": "3 m"},
    "accept": {"F203": "we know"},
}
HAZARDS = '[HAZ-1]\ntitle = "It collides"\nseverity = "minor"\n[HAZ-2]\ntitle = "It stops"\n'


def drawn(seed: int, folder: Path) -> None:
    """Write `requirements` and `l.mcap` into a folder: some of everything above."""
    chance = random.Random(seed)

    def some(fields: Mapping[str, Any], share: float = 0.3) -> dict[str, Any]:
        return {key: value for key, value in fields.items() if chance.random() < share}

    tick = chance.choice(["100 ms", "100 ms", "/a"])
    bindings: dict[str, Any] = {
        "clock": {"tick": tick, **some(CLOCK, 0.15)},
        "signal": {name: {**must, **some(may)} for name, (must, may) in SIGNALS.items()},
        "proposition": {
            name: {"expr": text, **some(MAY, 0.15)} for name, text in some(EXPRESSIONS, 0.9).items()
        },
        "variable": some(VARIABLES, 0.7),
        **some(TABLES, 0.7),
    }
    place = folder / "requirements"
    place.mkdir(parents=True)
    for number, sentence in enumerate(chance.sample(SENTENCES, 6), 1):
        header = tomli_w.dumps({"id": f"R{number}", **some(HEADER)})
        (place / f"r{number}.fret").write_text(f"+++\n{header}+++\n{sentence}\n")
    if chance.random() < 0.9:
        (place / "bindings.toml").write_text(tomli_w.dumps(bindings))
    if chance.random() < 0.8:
        (place / "hazards.toml").write_text(HAZARDS)
    log(folder / "l.mcap", chance)


def log(path: Path, chance: random.Random) -> None:
    """A message of each topic every 100 ms, or nearly; some fields are missing now and then."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("A", "jsonschema", b"{}")
        channels = [writer.register_channel(topic, "json", schema) for topic in ("/a", "/b")]
        for number in range(12):
            time = 10**9 + number * 100 * MS + chance.randrange(30) * MS
            a: dict[str, Any] = {"x": chance.uniform(-1, 9), "y": chance.randrange(1000)}
            b: dict[str, Any] = {
                "x": chance.randrange(-9, 9),
                "on": chance.random() < 0.5,
                "mode": chance.choice(["idle", "dock", "other"]),
                "gear": chance.choice([0, 4, 5]),
                "row": [chance.random() for _ in range(4)],
            }
            for channel, fields in zip(channels, (a, b), strict=True):
                kept = {key: value for key, value in fields.items() if chance.random() < 0.95}
                writer.add_message(channel, time, json.dumps(kept).encode(), time)
        writer.finish()  # type: ignore[no-untyped-call]
