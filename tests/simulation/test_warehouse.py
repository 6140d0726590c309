"""The warehouse vehicle of requirements/agv: from numbers and words in sentences to verdicts."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

import fretc
from fretc.api.audits import Audit
from monitors.loading import executed
from simulation import warehouse
from tests.command import Fretc
from tests.effort import some

AGV = Path(__file__).parents[2] / "requirements/agv"
IDS = [f"AGV-{i}" for i in range(1, 11)]
PLANTED = {"AGV-1": [(256, 280)], "AGV-2": [(305, 312)], "AGV-3": [(420, 465)]}
"""Ticks of 100 ms: 1.8 m/s after 25 s, a late stop at 30 s, a late way to the dock after 40 s."""
TICK = 100_000_000


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("agv")
    warehouse.main([str(folder / "good.mcap")])
    warehouse.main(["--planted", str(folder / "planted.mcap")])
    return {name: folder / f"{name}.mcap" for name in ("good", "planted")}


@pytest.fixture(scope="module")
def audit(logs: Mapping[str, Path]) -> Audit:
    return fretc.audit_logs(fretc.read_project(str(AGV)), *map(str, logs.values()))


def of_log(audit: Audit, name: str) -> dict[str, Any]:
    return {r["requirement"]: r for r in json.loads(audit.evidence)["results"] if name in r["run"]}


def test_nothing_is_bound_but_signals() -> None:
    project = fretc.read_project(str(AGV))
    assert [requirement.id for requirement in project.formalized] == IDS
    assert "[proposition" not in (AGV / "bindings.toml").read_text("utf-8")


def test_the_project_passes_its_check(fretc: Fretc) -> None:
    ran = fretc("check", "--requirements", str(AGV))
    assert ran.status == 0
    assert ran.err.endswith("\n10 requirements: 0 errors, 0 warnings\n")


@pytest.mark.slow
def test_the_good_drive_satisfies_all(audit: Audit) -> None:
    found = of_log(audit, "good")
    assert {id: r["verdict"] for id, r in found.items()} == dict.fromkeys(IDS, "satisfied")


@pytest.mark.slow
def test_the_other_drive_violates_what_is_planted_and_nothing_else(audit: Audit) -> None:
    found = of_log(audit, "planted")
    broken = {
        id: [(v["first_tick"], v["last_tick"]) for v in r["violations"]] for id, r in found.items()
    }
    assert broken == {**{id: [] for id in IDS}, **PLANTED}
    others = {r["verdict"] for id, r in found.items() if id not in PLANTED}
    assert others == {"satisfied"}


# The generated monitor ----------------------------------------------------------------------------

FIELDS = {
    "speed": ("/odom", "twist.twist.linear.x"),
    "turn": ("/odom", "twist.twist.angular.z"),
    "x": ("/odom", "pose.pose.position.x"),
    "y": ("/odom", "pose.pose.position.y"),
    "battery": ("/battery", "percentage"),
    "person": ("/person", "data"),
    "mode": ("/mode", "data"),
    "docked": ("/docked", "data"),
    "estop": ("/estop", "data"),
}


def ticks(log: Path) -> Iterator[dict[str, Any]]:
    """The last value of each signal at each tick, by another reader than that of the audit."""
    latest: dict[str, Any] = {}
    tick = warehouse.EPOCH
    with log.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, sent, message in reader.iter_decoded_messages():
            while sent.log_time > tick:
                yield dict(latest)
                tick += TICK
            for name, (topic, path) in FIELDS.items():
                if topic == channel.topic:
                    latest[name] = field(message, path)
    yield dict(latest)


def field(message: Any, path: str) -> Any:
    for part in path.split("."):
        message = getattr(message, part)
    return int(message) if isinstance(message, bool) else message


@pytest.mark.slow
@pytest.mark.parametrize("name", ["good", "planted"])
def test_a_monitor_says_of_the_numbers_what_the_audit_says_of_the_log(
    name: str, logs: Mapping[str, Path], audit: Audit, tmp_path: Path, capsys: Any
) -> None:
    text = fretc.monitor_text(*fretc.read_project(str(AGV)).formalized)
    module = executed(text, "agv_monitor")
    table = tmp_path / "t.csv"
    with table.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, list(FIELDS))
        writer.writeheader()
        writer.writerows(ticks(logs[name]))
    status = module.main_by_variables(module.MONITOR, [str(table), "--format", "json"])
    said = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    found = of_log(audit, name)
    assert [each["requirement"] for each in said] == IDS
    for each in said:
        result = found[each["requirement"]]
        assert each["verdict"] == result["verdict"], each
        assert each["violations"] == [
            [v["first_tick"], v["last_tick"]] for v in result["violations"]
        ], each
        assert each["triggers"] == [trigger["tick"] for trigger in result["triggers"]], each
    assert status == (1 if name == "planted" else 0)


@pytest.mark.slow
@pytest.mark.parametrize("file", some(["agv09", "agv02", "agv03"], 3))
def test_the_monitors_are_proved(file: str) -> None:
    """A unit, a word, and a unit that is converted; a proof of all ten takes some seconds."""
    proofs = fretc.verify(fretc.read_project(str(AGV / f"{file}.fret")), layers=["monitor"])
    assert [str(proof.result) for proof in proofs] == ["proved"]


@pytest.mark.slow
def test_the_report_shows_what_only_sentences_state(audit: Audit, tmp_path: Path) -> None:
    evidence = tmp_path / "evidence.json"
    evidence.write_text(audit.evidence, "utf-8")
    report = fretc.make_report(fretc.read_project(str(AGV)), str(evidence))
    assert "abs(speed) &lt;= 1.5 m/s" in report.html
    assert "Three requirements are violated in one of two runs; the most severe: " in report.html
    assert all(f"({id})" in report.html for id in PLANTED)
