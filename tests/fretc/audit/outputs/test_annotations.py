"""The log that an audit writes for Foxglove, read back by the official reader."""

import json
import shutil
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import jsonschema  # type: ignore[import-untyped]
import pytest
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader

from fretc.audit.evidence.schema import Result
from fretc.audit.outputs.annotations import VERDICTS, sidecar, sidecars, state_topic
from tests.command import Fretc, write
from tests.fretc.audit import results
from tests.fretc.logs.broken import sound
from tests.fretc.logs.logs import X_TEXT
from tests.monitoring import requirement

S = 10**9
ROOT = Path(__file__).parents[4]
RULES = [requirement("whenever p the sw shall within 3 ticks satisfy q", id) for id in ("R1", "R2")]


def moment(tick: int, **more: Any) -> dict[str, Any]:
    return {"tick": tick, "ns": 100 * S + tick * S, "seconds": float(tick), **more}


def result(run: str = "a.mcap", id: str = "R1", **more: Any) -> Result:
    fields = {
        "run": run,
        "requirement": id,
        "verdict": "violated",
        "reason": "broken",
        "clock": "1 s, by log_time",
        "start_ns": 100 * S,
        "end_ns": 120 * S,
        "states": [
            moment(0, state="idle"),
            moment(2, state="open"),
            moment(5, state="violated"),
            moment(6, state="idle"),
        ],
        "triggers": [moment(1), moment(2)],
        "answers": [moment(1, trigger=1)],
        "violations": [
            {"start_ns": 105 * S, "end_ns": 105 * S, "trigger": moment(2), "values": {"x": 5.0}}
        ],
        "units": {"x": "km/h"},
        "hashes": {"log": "aa", "bindings": "bb", "sentence": "cc", "monitor": "dd"},
        **more,
    }
    return results.result(**fields)


def read(data: bytes) -> tuple[dict[str, list[tuple[int, Any]]], dict[str, str]]:
    """Messages by topic and the metadata; all of it is as the official readers want it."""
    reader = make_reader(BytesIO(data), validate_crcs=True)
    list(StreamReader(BytesIO(data), validate_crcs=True).records)
    messages: dict[str, list[tuple[int, Any]]] = {}
    before = 0
    for schema, channel, message in reader.iter_messages():
        assert schema is not None
        content = json.loads(message.data)
        jsonschema.validate(content, json.loads(schema.data))
        stamp = content["timestamp"]
        assert stamp["sec"] * S + stamp["nsec"] == message.log_time == message.publish_time
        assert (channel.message_encoding, schema.encoding) == ("json", "jsonschema")
        assert schema.name == ("foxglove.Log" if channel.topic == VERDICTS else "fretc.State")
        assert before <= message.log_time
        before = message.log_time
        messages.setdefault(channel.topic, []).append((message.log_time, content))
    (metadata,) = reader.iter_metadata()
    assert metadata.name == "fretc"
    return messages, metadata.metadata


def test_what_happened_is_told_in_order_of_time() -> None:
    messages, _ = read(sidecar([result()], RULES))
    events = [(ns // S, one["level"], one["message"]) for ns, one in messages[VERDICTS]]
    assert events == [
        (102, 2, "R1: triggered, waiting for the response"),
        (105, 4, "R1: violated from here on, triggered at 2 s: x = 5 km/h"),
        (105, 4, "R1: violated up to here"),
        (120, 4, "R1: violated: broken"),
    ]
    _, first = messages[VERDICTS][0]
    assert (first["name"], first["file"], first["line"]) == ("R1", "r.fret", 1)


def test_only_changes_of_state_are_messages() -> None:
    states = [(0, "idle"), (10, "open"), (14, "idle"), (20, "unknown"), (25, "idle")]
    quiet = result(
        verdict="satisfied",
        states=[moment(tick, state=state) for tick, state in states],
        triggers=[moment(tick) for tick in (*range(10, 14), *range(30, 90))],
        answers=[
            *(moment(14, trigger=tick) for tick in range(10, 14)),
            *(moment(tick, trigger=tick) for tick in range(30, 90)),
        ],
        violations=[],
    )
    messages, _ = read(sidecar([quiet], RULES))
    assert [(ns // S - 100, one["message"]) for ns, one in messages[VERDICTS]] == [
        (10, "R1: triggered, waiting for the response"),
        (14, "R1: response after 4 s"),
        (20, "R1: unknown from here on"),
        (20, "R1: satisfied: broken"),
        (25, "R1: known again"),
    ]


def test_each_requirement_has_its_states() -> None:
    messages, _ = read(sidecar([result(), result(id="R2")], RULES))
    assert set(messages) == {VERDICTS, "/fretc/R1", "/fretc/R2"}
    states = [(ns // S, one["state"], one["requirement"]) for ns, one in messages["/fretc/R2"]]
    assert states == [
        (100, "idle", "R2"),
        (102, "open", "R2"),
        (105, "violated", "R2"),
        (106, "idle", "R2"),
    ]


@pytest.mark.parametrize(
    ("verdict", "level"),
    [("satisfied", 2), ("violated", 4), ("inconclusive", 3), ("vacuous", 3), ("no data", 3)],
)
def test_the_verdict_comes_last_with_its_level(verdict: str, level: int) -> None:
    messages, metadata = read(sidecar([result(verdict=verdict)], RULES))
    _, last = messages[VERDICTS][-1]
    assert (last["level"], last["message"]) == (level, f"R1: {verdict}: broken")
    assert metadata["R1.verdict"] == verdict


def test_the_metadata_say_what_was_judged_and_by_what() -> None:
    _, metadata = read(sidecar([result()], RULES))
    assert metadata == {
        "fretc": metadata["fretc"],
        "run": "a.mcap",
        "clock": "1 s, by log_time",
        "sha256.log": "aa",
        "R1.verdict": "violated",
        "R1.reason": "broken",
        "R1.sha256.sentence": "cc",
        "R1.sha256.bindings": "bb",
        "R1.sha256.monitor": "dd",
    }


def test_no_requirement_has_the_topic_of_the_verdicts() -> None:
    assert state_topic("R1") == "/fretc/R1"
    assert state_topic("verdicts") == "/fretc/verdicts/state"


@pytest.mark.parametrize(
    ("runs", "names"),
    [
        (["a.mcap", "x/b.mcap"], ["a", "b"]),
        (["x/a.mcap", "y/a.mcap", "b.mcap"], ["x/a", "y/a", "b"]),
        (["/r/x/1/a.mcap", "/r/y/1/a.mcap"], ["x/1/a", "y/1/a"]),
        (["a.mcap", "x/a.mcap"], ["a", "x/a"]),
        (["run.bag", "run.mcap", "run-2.mcap", "run.db3"], ["run", "run-2", "run-2-2", "run-3"]),
        (["a b.mcap", "a_b.mcap"], ["a_b", "a_b-2"]),
        (["../a.mcap", "../../a.mcap"], ["a", "_/a"]),
        (["<stdin>", "bag.v2"], ["_stdin_", "bag.v2"]),
    ],
)
def test_each_run_has_a_file_of_its_own_and_none_outside(
    runs: Sequence[str], names: Sequence[str]
) -> None:
    paths = list(sidecars([result(run) for run in runs], RULES, Path("out")))
    assert paths == [Path(f"out/{name}.fretc.mcap") for name in names]


def test_of_a_log_that_could_not_be_read_there_is_nothing() -> None:
    assert sidecars([result(start_ns=None, end_ns=None)], RULES, Path("out")) == {}


# By the command


@pytest.fixture
def fretc(fretc: Fretc) -> Fretc:
    """Run the command beside a requirement that the log violates, and one that it satisfies."""
    write(
        "requirements/r.fret",
        '+++\nid = "R1"\n+++\nthe sw shall always satisfy low\n'
        '+++\nid = "R2"\n+++\nwhenever low the sw shall within 300 milliseconds satisfy high\n',
    )
    write("requirements/bindings.toml", f'{X_TEXT}\n[proposition.high]\nexpr = "not (x < 5 cm)"\n')
    Path("run.mcap").write_bytes(sound().data)
    return fretc


def test_the_command_writes_it_beside_the_log_and_leaves_the_log(fretc: Fretc) -> None:
    before = Path("run.mcap").read_bytes()
    run = fretc("audit", "run.mcap", "--annotate")
    assert run.status == 1
    assert "wrote build/annotations/run.fretc.mcap\n" in run.err
    assert run.err.endswith("wrote build/annotations/foxglove-layout.json\n")
    assert Path("run.mcap").read_bytes() == before
    first = Path("build/annotations/run.fretc.mcap").read_bytes()
    messages, metadata = read(first)
    # x is below 5 cm from 1000.0 s to 1000.4 s; a tick is 0.1 s.
    start = 1000 * S
    tenths = [((ns - start) // (S // 10), one["state"]) for ns, one in messages["/fretc/R1"]]
    assert tenths[-1] == (5, "violated")
    assert {one["state"] for _, one in messages["/fretc/R2"]} >= {"open", "violated"}
    assert metadata["R1.verdict"] == "violated"
    fretc("audit", "run.mcap", "--annotate")
    assert Path("build/annotations/run.fretc.mcap").read_bytes() == first


def test_annotations_go_where_the_user_wants_and_are_no_logs(fretc: Fretc) -> None:
    Path("logs").mkdir()
    shutil.move("run.mcap", "logs/run.mcap")
    for _ in range(2):
        run = fretc("audit", "logs", "--annotations", "logs")
        assert run.status == 1
        assert ".fretc.mcap" not in run.out
        assert "run.mcap\n  ✘" in run.out
    assert sorted(path.name for path in Path("logs").iterdir()) == [
        "foxglove-layout.json",
        "run.fretc.mcap",
        "run.mcap",
    ]


def test_nothing_is_written_where_something_cannot_be(fretc: Fretc) -> None:
    Path("file").write_text("not a folder")
    run = fretc("audit", "run.mcap", "--annotations", "file")
    assert run.status == 2
    assert "F905" in run.err
    assert not list(Path("build").iterdir())
    assert Path("file").read_text() == "not a folder"


def test_evidence_is_not_lost_to_an_annotation(fretc: Fretc) -> None:
    run = fretc("audit", "run.mcap", "--annotations", "x", "-o", "x/run.fretc.mcap")
    assert run.status == 2
    assert run.err.startswith("F905 `x/run.fretc.mcap` cannot be written: ")
    assert Path("x/run.fretc.mcap/evidence.sqlite").exists()


@pytest.mark.slow
def test_a_log_is_never_replaced(fretc: Fretc) -> None:
    shutil.copy("run.mcap", "run.fretc.mcap")
    before = Path("run.fretc.mcap").read_bytes()
    run = fretc("audit", "run.mcap", "run.fretc.mcap", "--annotations", ".")
    assert run.status == 2
    assert "which is an input" in run.err
    assert Path("run.fretc.mcap").read_bytes() == before


def test_without_the_option_there_is_none(fretc: Fretc) -> None:
    fretc("audit", "run.mcap")
    assert [path.name for path in Path("build").iterdir()] == ["evidence.json"]
