"""Untouched evidence stands, whatever the project declares: every command says the same of it.

Projects are drawn from a list with each field that bindings and headers may have.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import HealthCheck, Phase, assume, event, example, given, settings
from hypothesis import strategies as st
from mcap.writer import Writer

from fretish import documents
from fretish.bindings.tables import clock, coordinates, labels, propositions, signals, variables
from tests.command import Fretc, runner
from tests.effort import FULL

Fields = Mapping[str, tuple[Any, ...]]
"""Field → values of which one may be there, beside none."""

ROLES = ("input", "output", "internal")
CLOCK: Fields = {
    "time": ("log_time", "publish_time"),
    "phase": ("50 ms",),
    "end": ("inconclusive", "violated"),
    "rounding": ("exact", "conservative"),
    "lateness": (),
}
SIGNALS: Mapping[str, tuple[Mapping[str, Any], Fields]] = {
    "speed": (
        {"path": "/state.speed", "unit": "m/s"},
        {
            "type": ("robot/State",),
            "role": ROLES,
            "agg": ("any", "all", "last"),
            "max_age": ("300 ms",),
            "valid": ("x >= 0",),
            "invalid": ({"nan": "drop"}, {"nan": "unknown"}),
        },
    ),
    "mode": (
        {"path": "/state.mode", "values": ["drive", "dock", "mètre"]},
        {"max_age": ("300 ms",), "role": ("mode",), "agg": ("any", "last")},
    ),
    "gap": (
        {"path": "/scan.ranges[:]", "unit": "m", "reduce": "min"},
        {"max_age": ("250 ms",), "valid": ("0.1 <= x",)},
    ),
    "outline": (
        {
            "path": "/scan.ranges[:]",
            "unit": "m",
            "reduce": "outline",
            "footprint": [[0.3, 0.3], [-0.3, 0.3], [-0.3, -0.3], [0.3, -0.3]],
        },
        {"sensor": ([0.1, 0.0, 0.0],), "type": ("sensor_msgs/LaserScan",)},
    ),
    "pace": (
        {"value": "2 * speed"},
        {
            "value": ("abs(speed) + 1 m/s", "hypot(speed, 1 m/s)", "clamp(speed, 0 m/s, 2 m/s)"),
            "unit": ("cm/s", "m/s"),
            "role": ROLES,
            "agg": ("any", "all", "last"),
        },
    ),
}
PROPOSITIONS: Mapping[str, tuple[Mapping[str, Any], Fields]] = {
    "near": (
        {"expr": "gap < 1 m"},
        {
            "text": ("something is near: < 1 m",),
            "role": ROLES,
            "kind": propositions.KINDS,
            "agg": ("any", "all", "last"),
            "on_unknown": (True, False, "unknown"),
            "modality": ("B", "G"),
            "action": ("stop_moving",),
        },
    ),
    "slow": (
        {"expr": "speed < 0.3 m/s for 200 ms"},
        {"on_unknown": (True, False), "agg": ("last", "any")},
    ),
    "tight": ({"expr": "outline < 0.5 m or mode = dock"}, {}),
    "ahead": ({"expr": "pace > 1 m/s or speed > pace"}, {}),
    "rising": ({"expr": "speed > pre(0 m/s, speed)"}, {}),
}
VARIABLES: Mapping[str, tuple[Mapping[str, Any], Fields]] = {
    "limit": (
        {"value": "0.4"},
        {
            "type": ("double",),
            "role": ("internal", "mode"),
            "text": ("the limit",),
            "fret": ({"assignment": "0.4"},),
            "modality": ("B",),
            "action": ("keep_the_limit",),
        },
    ),
    "fast": ({"value": "speed > limit"}, {"component": ("agv",)}),
    "both": ({"value": "fast & near"}, {"of": ({"arm": {"value": "near"}},)}),
    "unbound": ({}, {"text": ("no log has it",)}),
}
LABELS: Fields = {"label": ({"scenario": "path:{scenario}.mcap"}, {"robot": "metadata:a.b"})}
MAP: Fields = {"x": ("/state.x",), "y": ("/state.y",)}
HEADER: Fields = {
    "kind": ("requirement", "assumption"),
    "title": ("Keep slow, schön langsam",),
    "text": ("The vehicle keeps slow.",),
    "parents": (["HAZ-1"], ["R0"], ["HAZ-1", "R0"]),
    "rationale": ("It is safe.",),
    "status": documents.STATUSES,
    "verify": (["audit"],),
    "params": ({"near": "1 m"},),
    "accept": ({"F204": "as it is meant"},),
    "fret": ({"project": "Warehouse"},),
}
SENTENCES = (
    "the agv shall always satisfy fast -> speed < 9",
    "whenever near the agv shall within 3 ticks satisfy slow",
    "upon near & mode = dock the agv shall within 300 milliseconds satisfy slow",
    "whenever near the agv shall with probability >= 0.5 within 2 ticks satisfy speed < limit",
    'the agv shall never satisfy mode = "mètre" & fast',
    "in near mode the agv shall always satisfy speed < 2 * limit",
    "before tight the arm shall always satisfy both | speed < 90 cm/s",
    "after both the agv shall eventually satisfy slow",
    "the agv shall always satisfy preBool(false, near) -> persisted(1, speed < 9)",
    "whenever rising the agv shall until near satisfy outline > 1 cm",
    "while tight the agv shall for 2 ticks satisfy !both",
    "whenever near the agv shall within 2 ticks satisfy pace < 3 & ahead",
    '"Drive with care."',
    '"Fahre vorsichtig, immer."',
)


def some_of(fields: Fields) -> st.SearchStrategy[dict[str, Any]]:
    """Some of the fields, each with one of its values."""
    chosen = {name: st.sampled_from(values) for name, values in fields.items() if values}
    return st.fixed_dictionaries({}, optional=chosen)


def table(least: Mapping[str, Any], fields: Fields) -> st.SearchStrategy[dict[str, Any]]:
    """A table with what it must have."""
    return some_of(fields).map(lambda more: {**least, **more})


def tables(
    known: Mapping[str, tuple[Mapping[str, Any], Fields]],
) -> st.SearchStrategy[dict[str, Any]]:
    """All tables of one kind, in some order."""
    parts = {name: table(*each) for name, each in known.items()}
    return st.permutations([*parts]).flatmap(
        lambda names: st.fixed_dictionaries({name: parts[name] for name in names})
    )


bindings = st.fixed_dictionaries(
    {
        "clock": some_of(CLOCK).map(lambda more: {"tick": "100 ms", **more}),
        "signal": tables(SIGNALS),
        "proposition": tables(PROPOSITIONS),
        "variable": tables(VARIABLES),
    },
    optional={
        "run": some_of(LABELS),
        "map": st.just({name: value for name, (value,) in MAP.items()}),
    },
)
requirements = st.lists(
    st.tuples(some_of(HEADER), st.sampled_from(SENTENCES)), min_size=2, max_size=6
)


PLAIN: Mapping[str, Any] = {
    "clock": {"tick": "100 ms"},
    "signal": {name: least for name, (least, _) in SIGNALS.items()},
    "proposition": {name: least for name, (least, _) in PROPOSITIONS.items()},
    "variable": {name: least for name, (least, _) in VARIABLES.items()},
}
"""Bindings with what they must have alone; of free text beside a sentence there is one example."""


@pytest.mark.parametrize(
    ("known", "drawn"),
    [
        (clock.FIELDS, {"tick", *CLOCK}),
        (signals.FIELDS, {name for each in SIGNALS.values() for part in each for name in part}),
        (
            propositions.FIELDS,
            {name for each in PROPOSITIONS.values() for part in each for name in part},
        ),
        (variables.FIELDS, {n for each in VARIABLES.values() for part in each for n in part}),
        (labels._RUN, {*LABELS}),
        (coordinates.FIELDS, {*MAP}),
        (documents.FIELDS, {"id", *HEADER}),
    ],
)
def test_every_field_is_drawn(known: tuple[str, ...], drawn: set[str]) -> None:
    assert drawn == {*known}


def write_log(path: Path) -> None:
    """One and a half seconds of a robot that comes near, with a gap and a reading that is none."""
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        topics = {}
        for topic, kind in (("/state", "robot/State"), ("/scan", "sensor_msgs/LaserScan")):
            schema = writer.register_schema(kind, "jsonschema", b"{}")
            topics[topic] = writer.register_channel(topic, "json", schema)
        writer.add_metadata("a", {"b": "r2d2 - ü"})
        for i in range(15):
            mode = ["drive", "dock", "mètre"][i // 5]
            state: dict[str, Any] = {
                "speed": [0.1, 0.5, None][i % 3],
                "mode": mode,
                "x": i / 10,
                "y": 0.0,
            }
            scan: dict[str, Any] = {"range_min": 0.1, "range_max": 9.0}
            scan |= {"angle_min": 0.0, "angle_increment": 0.1, "angle_max": 0.2}
            scan |= {"ranges": [3.0 - i / 5, 4.0, 5.0]}
            for topic, value in (("/state", state), ("/scan", scan)):
                if topic == "/state" or i not in (6, 7, 8, 9):
                    time = 10**9 + i * 100_000_000
                    data = json.dumps(value).encode()
                    writer.add_message(topics[topic], time, data, time)
        writer.finish()  # type: ignore[no-untyped-call]


def write_project(declared: Mapping[str, Any], written: list[tuple[dict[str, Any], str]]) -> None:
    folder = Path("requirements")
    folder.mkdir(exist_ok=True)
    (folder / "bindings.toml").write_text(tomli_w.dumps(declared), "utf-8")
    (folder / "hazards.toml").write_text('[HAZ-1]\ntitle = "It hits a person"\n', "utf-8")
    texts = []
    for place, (header, sentence) in enumerate(written):
        header = {"id": f"R{place}", **header}
        header["parents"] = [each for each in header.get("parents", ()) if each != header["id"]]
        texts.append(f"+++\n{tomli_w.dumps(header)}+++\n{sentence}\n")
    (folder / "all.fret").write_text("\n".join(texts), "utf-8")


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("honest")
    write_log(folder / "walk.mcap")
    return folder


@pytest.mark.slow
@settings(
    max_examples=300 if FULL else 3,
    deadline=None,
    suppress_health_check=[*HealthCheck],
    phases=[*Phase] if FULL else [Phase.explicit, Phase.generate],  # an example takes seconds
)
@example(declared=PLAIN, written=[({}, SENTENCES[0]), ({}, SENTENCES[-1])], stored=False)
@given(declared=bindings, written=requirements, stored=st.booleans())
def test_untouched_evidence_stands_in_every_command(
    declared: dict[str, Any],
    written: list[tuple[dict[str, Any], str]],
    stored: bool,
    place: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        fretc: Fretc = runner(patch, capsys)
        write_project(declared, written)
        Path("requirements/fretc.lock").unlink(missing_ok=True)
        file = "build/evidence" if stored else "build/evidence.json"
        audit = fretc("audit", "walk.mcap", "-o", file)
        event(f"audit {audit.status}")
        assume(audit.status != 2)
        review = ("--reviewer", "A", "--role", "b", "--comment", "c", "--accept-violations")
        lock = fretc("lock", "--evidence", file, *review)
        assert lock.status == 0, lock.err
        diff = fretc("diff", "--evidence", file)
        assert diff.status == 0, diff.out
        assert "as " in diff.out
        again = fretc("verify-evidence", file)
        assert again.status == 0, again.out
        check = fretc("check", "--evidence", file)
        assert not [code for code in ("F504", "F512") if code in check.out + check.err]
        report = fretc("report", "--evidence", file, "--json", "build/report.json")
        assert report.status == 0, report.err
        assert '"suspect": true' not in Path("build/report.json").read_text()
