"""The audit as a user runs it, on the recorded mission that the repository carries."""

import hashlib
import json
import os
import shutil
import signal
from dataclasses import replace
from itertools import takewhile
from pathlib import Path
from typing import Any

import pytest

from fretc.audit import many_logs as auditing
from fretc.audit.evidence.writer import text
from fretc.audit.plan import Plan
from fretc.audit.store.anywhere import read
from fretish.diagnostics.diagnostic import Diagnostic
from tests.command import Fretc, Run, untimed
from tests.effort import some
from tests.fretc.audit.stepping import stepping
from tests.json_schemas import validate
from tests.traces import MISSION, part

ROOT = Path(__file__).parents[3]


@pytest.fixture
def fretc(fretc: Fretc) -> Fretc:
    """Run the command in a folder with the repository's requirements and its log."""
    shutil.copytree(ROOT / "requirements", "requirements")
    shutil.copy(MISSION, "run.mcap")
    return fretc


def evidence() -> Any:
    found = read("build/evidence" if Path("build/evidence").is_dir() else "build/evidence.json")
    assert not isinstance(found, Diagnostic), found.message
    return json.loads(text(found.document))


def change(path: str, old: str, new: str) -> None:
    text = Path(path).read_text("utf-8")
    assert old in text
    Path(path).write_text(text.replace(old, new), "utf-8")


def test_the_recorded_mission_shows_r1_with_the_stops_that_a_person_sees_in_it(
    fretc: Fretc,
) -> None:
    run = fretc("audit", "run.mcap")
    assert replace(run, out=untimed(run.out)) == Run(
        0,
        "run.mcap\n"
        "  ✔ Stop when an obstacle is within 5 cm (R1)  satisfied     held, 98 triggers, "
        "answered after 0 s (median), 39.8 s (longest)\n"
        "15 of 20 situations seen, 5 never: `fretc coverage` lists them\n"
        "1 run \N{MULTIPLICATION SIGN} 1 requirement: 1 satisfied\n",
        "wrote build/evidence.json\n",
    )
    (result,) = evidence()["results"]
    triggers = [moment["seconds"] for moment in result["triggers"]]
    # traces/README.md: stops requested at 5.5, 21.5 and 64.2 s, by the scan just before.
    assert {5.5, 21.5, 64.2} <= set(triggers)
    assert not [t for t in triggers if 9.5 < t < 21.0]


@pytest.mark.slow
def test_the_evidence_fits_its_schema_and_is_the_same_again(fretc: Fretc) -> None:
    fretc("audit", "run.mcap")
    first = Path("build/evidence.json").read_bytes()
    validate("evidence.schema.json", evidence())
    fretc("audit", "run.mcap")
    assert Path("build/evidence.json").read_bytes() == first


def test_json_goes_to_standard_output_as_one_array(fretc: Fretc) -> None:
    run = fretc("audit", "run.mcap", "--format", "json")
    assert json.loads(run.out) == evidence()["results"]


def test_a_bound_makes_the_slow_answer_a_violation(fretc: Fretc) -> None:
    change("requirements/r1.fret", "shall eventually", "shall within 300 milliseconds")
    run = fretc("audit", "run.mcap")
    assert run.status == 1
    assert "  ✘ Stop when an obstacle is within 5 cm (R1)  violated      from " in run.out
    (result,) = evidence()["results"]
    first = result["violations"][0]
    assert first["trigger"] is not None
    assert set(first["values"]) == {"clearance", "vx", "wz"}


@pytest.mark.slow
def test_one_changed_byte_in_the_middle_changes_the_hash_and_is_no_pass(fretc: Fretc) -> None:
    fretc("audit", "run.mcap")
    before = evidence()["results"][0]["hashes"]["log"]
    data = bytearray(Path("run.mcap").read_bytes())
    data[len(data) // 2] ^= 1
    Path("run.mcap").write_bytes(data)
    run = fretc("audit", "run.mcap")
    (result,) = evidence()["results"]
    assert (run.status, result["verdict"]) == (3, "no data")
    assert result["hashes"]["log"] != before
    assert result["health"]["intact"] is False
    assert run.err.startswith("F404 warning: the log is damaged near byte ")


@pytest.mark.slow
def test_a_log_that_ends_in_the_middle_shows_what_is_whole_and_satisfies_nothing(
    fretc: Fretc,
) -> None:
    data = Path("run.mcap").read_bytes()
    for share in (0.2, 0.5, 0.9, 0.999):
        Path("cut.mcap").write_bytes(data[: int(len(data) * share)])
        run = fretc("audit", "cut.mcap")
        assert run.status == 3
        assert run.err.startswith("F403 warning: the log breaks off after byte ")
        (result,) = evidence()["results"]
        assert result["verdict"] in ("inconclusive", "no data")
        assert result["ticks"] > 0
        validate("evidence.schema.json", evidence())


@pytest.mark.slow
def test_a_violation_in_a_log_that_ends_in_the_middle_is_a_violation(fretc: Fretc) -> None:
    change("requirements/r1.fret", "eventually", "within 1 ticks")
    data = Path("run.mcap").read_bytes()
    Path("cut.mcap").write_bytes(data[: len(data) // 2])
    assert fretc("audit", "run.mcap").status == 1
    whole = evidence()["results"][0]["violations"]
    assert fretc("audit", "cut.mcap").status == 1
    cut = evidence()["results"][0]["violations"]
    assert cut[:-1] == whole[: len(cut) - 1]
    assert cut[-1]["first_tick"] == whole[len(cut) - 1]["first_tick"]


def test_a_log_without_one_whole_message_is_bad_input(fretc: Fretc) -> None:
    Path("cut.mcap").write_bytes(Path("run.mcap").read_bytes()[:60])
    run = fretc("audit", "cut.mcap")
    assert run.status == 2
    assert run.err.startswith("F403 the log breaks off after byte ")
    assert not Path("build").exists()


def test_an_unreadable_log_keeps_the_evidence_of_the_last_audit(fretc: Fretc) -> None:
    fretc("audit", "run.mcap")
    before = Path("build/evidence.json").read_bytes()
    assert fretc("audit", "rnu.mcap").status == 2
    assert Path("build/evidence.json").read_bytes() == before


@pytest.mark.slow
def test_a_bad_log_beside_a_good_one_is_in_the_evidence_and_in_the_status(fretc: Fretc) -> None:
    Path("bad.mcap").write_bytes(b"no log")
    run = fretc("audit", "run.mcap", "bad.mcap")
    assert run.status == 2
    verdicts = [(result["run"], result["verdict"]) for result in evidence()["results"]]
    assert verdicts == [("run.mcap", "satisfied"), ("bad.mcap", "no data")]
    validate("evidence.schema.json", evidence())


def test_a_topic_that_is_not_in_the_log_is_told_at_its_binding(fretc: Fretc) -> None:
    change("requirements/bindings.toml", '"/scan.ranges[:]"', '"/scna.ranges[:]"')
    run = fretc("audit", "run.mcap")
    assert run.status == 2
    assert run.err.splitlines()[:5] == [
        "F405 the topic `/scna` is not in the log",
        "  --> requirements/bindings.toml:9:13",
        '   | path      = "/scna.ranges[:]"',
        "   |             ^^^^^^^^^^^^^^^^^",
        "help: did you mean `/scan`?",
    ]


def test_a_proposition_without_a_binding_is_told_at_the_sentence(fretc: Fretc) -> None:
    change("requirements/r1.fret", "satisfy stopped", "satisfy halted")
    run = fretc("audit", "run.mcap")
    assert run == Run(
        2,
        "",
        "F304 `halted` of R1 has no binding in requirements/bindings.toml\n"
        "  --> requirements/r1.fret:12:58\n"
        "   | whenever too_close agilex_agent shall eventually satisfy halted\n"
        "   |                                                          ^^^^^^\n"
        "help: add `[proposition.halted]` with its `expr` to requirements/bindings.toml\n",
    )


def test_a_bound_that_the_sensor_cannot_see_is_told(fretc: Fretc) -> None:
    change("requirements/bindings.toml", 'reduce    = "outline"', 'reduce    = "min"')
    run = fretc("audit", "run.mcap")
    assert (run.status, evidence()["results"][0]["verdict"]) == (3, "vacuous")
    assert run.err.startswith(
        "F311 warning: `too_close` compares `clearance` with 0.05 m, and `/scan` reports nothing "
        "nearer than 0.12 m"
    )


def test_a_retired_requirement_is_not_audited(fretc: Fretc) -> None:
    change("requirements/r1.fret", '"approved"', '"retired"')
    assert fretc("audit", "run.mcap") == Run(2, "", "F909 there is no requirement to audit\n")


def test_without_bindings_nothing_can_be_audited(fretc: Fretc) -> None:
    Path("requirements/bindings.toml").unlink()
    run = fretc("audit", "run.mcap")
    assert run.status == 2
    assert run.err.startswith("F304 no bindings map the propositions to messages\n")


@pytest.mark.confined
@pytest.mark.slow
def test_a_folder_of_logs_gives_the_same_with_any_number_of_processes(fretc: Fretc) -> None:
    for name in ("a", "b", "deep/c"):
        target = Path(f"runs/{name}.mcap")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(part())
    Path("runs/bad.mcap").write_bytes(b"no log")
    texts = []
    for jobs in ("1", *some(("7", "2"), 2)):
        run = fretc("audit", "runs", "--jobs", jobs)
        assert run.status == 2
        texts.append((untimed(run.out), evidence()))
        shutil.rmtree("build")
    assert all(one == texts[0] for one in texts)
    assert [result["run"] for result in texts[0][1]["results"]] == [
        "runs/a.mcap",
        "runs/b.mcap",
        "runs/bad.mcap",
        "runs/deep/c.mcap",
    ]


@pytest.mark.slow
def test_stepping_shows_the_same_as_columns(fretc: Fretc) -> None:
    fretc("audit", "run.mcap")
    before = Path("build/evidence.json").read_bytes()
    with stepping():
        fretc("audit", "run.mcap")
    assert Path("build/evidence.json").read_bytes() == before


@pytest.mark.slow
def test_results_can_be_read_by_other_tools(fretc: Fretc) -> None:
    junit = fretc("audit", "run.mcap", "--format", "junit")
    assert (junit.status, junit.out.startswith('<?xml version="1.0"')) == (0, True)
    assert (
        '<testcase name="Stop when an obstacle is within 5 cm (R1)" classname="run.mcap"'
        in junit.out
    )
    github = fretc("audit", "run.mcap", "--format", "github")
    assert github.out.startswith("::notice file=requirements/r1.fret,line=")


@pytest.mark.confined
@pytest.mark.slow
@pytest.mark.parametrize("jobs", some(["2", "1"], 2))
def test_a_log_whose_audit_kills_its_process_is_no_data_and_the_others_are_audited(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch, jobs: str
) -> None:
    real = auditing.audit_log

    def deadly(plan: Plan, log: str, *rest: Any) -> auditing.LogResult:
        if log == "bad.mcap":
            os.kill(os.getpid(), signal.SIGKILL)
        return real(plan, log, *rest)

    monkeypatch.setattr(auditing, "audit_log", deadly)
    for name in ("run", "bad", "other"):
        Path(f"{name}.mcap").write_bytes(part())
    run = fretc("audit", "run.mcap", "bad.mcap", "other.mcap", "--jobs", jobs)
    assert run.status == 2
    assert run.err == (
        "F419 the process that audited `bad.mcap` was killed, and again when it ran alone: "
        "signal 9\n"
        "  --> bad.mcap\n"
        "help: it may have run out of memory: audit this log on a machine with more memory\n"
        "wrote build/evidence\n"
    )
    content = evidence()
    validate("evidence.schema.json", content)
    verdicts = [(result["run"], result["verdict"]) for result in content["results"]]
    assert verdicts == [
        ("run.mcap", "satisfied"),
        ("bad.mcap", "no data"),
        ("other.mcap", "satisfied"),
    ]
    hashes = [result["hashes"] for result in content["results"]]
    assert hashes[1] == hashes[0]


@pytest.mark.slow
def test_a_table_is_written_beside_the_evidence(fretc: Fretc) -> None:
    run = fretc("audit", "run.mcap", "--parquet", "build/runs.parquet")
    assert run.err == "wrote build/evidence.json\nwrote build/runs.parquet\n"
    table = fretc("audit", "--summary", "build/runs.parquet", "--format", "json")
    assert table.out == fretc("audit", "--summary", "build/evidence.json", "--format", "json").out
    assert table.status == 0


@pytest.mark.parametrize("path", ["-", "requirements", "build/evidence.json"])
def test_a_table_goes_to_a_file_of_its_own(fretc: Fretc, path: str) -> None:
    run = fretc("audit", "run.mcap", "--parquet", path)
    assert (run.status, run.out, run.err[:4]) == (2, "", "F905")
    assert not Path("build").exists()


def test_evidence_that_cannot_be_written_is_told_before_the_audit(fretc: Fretc) -> None:
    run = fretc("audit", "run.mcap", "no.mcap", "-o", "requirements")
    assert run == Run(
        2,
        "",
        "F905 `requirements` cannot be written: the folder contains other files\n"
        "help: name a new folder, an empty one, or a store that `fretc audit` has written\n",
    )
    Path("x.json").mkdir()
    run = fretc("audit", "run.mcap", "no.mcap", "-o", "x.json")
    assert run.err.startswith("F905 `x.json` cannot be written: it is not a regular file\n")


@pytest.mark.slow
def test_what_is_true_of_many_logs_is_told_once(fretc: Fretc) -> None:
    change("requirements/bindings.toml", 'reduce    = "outline"', 'reduce    = "min"')
    of_one = fretc("audit", "run.mcap").err
    logs = [f"{number}.mcap" for number in range(4)]
    for log in logs:
        shutil.copy("run.mcap", log)
    Path(logs[2]).write_bytes(Path("run.mcap").read_bytes()[:900_000])
    of_all = fretc("audit", *logs).err
    first, *others = takewhile(lambda line: not line.startswith("F314"), of_one.splitlines())
    lines = of_all.splitlines()
    at = lines.index(f"{first} (in 4 of 4 logs, first in `0.mcap`)")
    assert of_all.count("F311") == 1
    assert lines[at + 1 : at + len(others)] == others[: len(others) - 1]
    assert of_all.count("F314") == 1
    assert of_all.count("F403") == 1
    assert "  --> 2.mcap\n" in of_all


@pytest.mark.slow
@pytest.mark.parametrize("integrity", ["index", "hash", "full"])
def test_verdicts_do_not_depend_on_what_is_looked_at_of_the_log(
    fretc: Fretc, integrity: str
) -> None:
    assert fretc("audit", "run.mcap").status == 0
    (usual,) = evidence()["results"]
    assert fretc("audit", "run.mcap", "--integrity", integrity).status == 0
    content = evidence()
    validate("evidence.schema.json", content)
    (result,) = content["results"]
    assert {**result, "health": 0, "hashes": 0} == {**usual, "health": 0, "hashes": 0}
    assert result["health"]["checked"]["by_index"] is (integrity != "full")
    sha256 = hashlib.sha256(Path("run.mcap").read_bytes()).hexdigest()
    assert result["hashes"].get("log") == (None if integrity == "index" else sha256)
    assert ("log_summary" in result["hashes"]) is (integrity == "index")


def test_a_log_that_was_not_read_whole_is_reported_as_such(fretc: Fretc) -> None:
    fretc("audit", "run.mcap", "--integrity", "index")
    assert fretc("report", "--json", "report.json").status == 0
    (run,) = json.loads(Path("report.json").read_text("utf-8"))["runs"]
    assert run["sha256"] == ""
    assert run["checked"].endswith("read by the index; not hashed")
