"""`fretc coverage` and `fretc mutate` as their users meet them: what they print and exit with."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema  # type: ignore[import-untyped]
import pytest

from compiler.files.templating import template_root
from tests.command import Fretc, write
from tests.fretc.logs import logs

BINDINGS = """\
[clock]
tick = "100 ms"
[signal.x]
path = "/x.data"
[proposition.near]
expr = "x < 5"
role = "input"
[proposition.stopped]
expr = "x > 8"
role = "output"
"""
SENTENCE = "whenever near the robot shall within 2 ticks satisfy stopped"


def run_of(name: str, *values: float) -> str:
    start = 1000 * logs.S
    sent = [logs.number(v, start + i * 100 * logs.MS) for i, v in enumerate(values)]
    logs.write(Path(name), sent)
    return name


@pytest.fixture
def robot(fretc: Fretc) -> Fretc:
    """A project whose first run is answered at once only, and whose second is late."""
    write("requirements/r1.fret", f'+++\nid = "R1"\n+++\n{SENTENCE}\n')
    write("requirements/bindings.toml", BINDINGS)
    run_of("idle.mcap", 6, 6, 6, 6)
    run_of("late.mcap", 6, 3, 6, 9, 6)
    return fretc


def situations(text: str) -> dict[str, str]:
    (one,) = json.loads(text)["requirements"]
    return {each["key"]: each["standing"] for each in one["situations"]}


def test_evidence_is_sought_only_if_no_log_is_named(robot: Fretc) -> None:
    write("build/evidence.json", "{}")
    Path("build/evidence").mkdir()
    assert robot("coverage", "idle.mcap").status == 3
    run = robot("coverage")
    assert (run.status, "evidence is in `build/evidence.json` and in" in run.err) == (2, True)


@pytest.mark.slow
def test_logs_and_their_evidence_show_the_same(robot: Fretc) -> None:
    run = robot("coverage", "idle.mcap", "late.mcap", "--format", "json")
    assert run.status == 3
    found = json.loads(run.out)
    schema = json.loads((template_root() / "json/coverage.schema.json").read_text("utf-8"))
    jsonschema.validate(found, schema)
    assert found["runs"] == ["idle.mcap", "late.mcap"]
    statuses = situations(run.out)
    assert statuses["answered-at-last-tick"] == "seen"
    assert statuses["never-triggered"] == "seen"
    assert statuses["missed-by-one"] == "never"
    assert found["least_runs"] == [0, 1]
    assert robot("audit", "idle.mcap", "late.mcap").status == 3
    assert robot("coverage", "--format", "json").out == run.out
    assert robot("coverage", "--evidence", "build/evidence", "--format", "json").out == run.out


def test_an_audit_says_how_much_was_seen_and_how_to_see_more(robot: Fretc) -> None:
    last = robot("audit", "late.mcap", "-o", "e v.json").out.splitlines()[-2]
    assert last.endswith("never: `fretc coverage --evidence 'e v.json'` lists them")
    count = last.partition(" situations seen")[0]
    assert (
        robot("coverage", "--evidence", "e v.json")
        .out.splitlines()[-1]
        .endswith(last.partition(": `")[0])
    )
    assert count in robot("coverage", "late.mcap").out
    assert "fretc coverage" not in robot("audit", "late.mcap", "-o", "-").out


@pytest.mark.slow
def test_tests_say_how_a_run_comes_by_what_was_not_seen(robot: Fretc) -> None:
    assert robot("test").status == 0
    run = robot("coverage", "idle.mcap")
    assert run.status == 3
    assert "        record: start with `near` " in run.out
    assert "        only a run that violates the requirement can show it: start with " in run.out
    assert "are not seen yet that a run can show" in run.out
    write("requirements/r1.fret", f'+++\nid = "R1"\n+++\n{SENTENCE.replace("2", "3")}\n')
    run = robot("coverage", "idle.mcap")
    assert "record:" not in run.out
    assert "the tests were generated for earlier sentences of R1: run `fretc test` again" in run.err


@pytest.mark.slow
def test_what_is_not_measured_is_not_seen(robot: Fretc) -> None:
    write("cut.mcap", "no log")
    assert robot("mutate", "--against", "late.mcap", "--against", "cut.mcap").status == 2
    run = robot("coverage", "late.mcap", "cut.mcap", "--format", "json")
    assert run.status == 2  # as an audit of them
    (one,) = json.loads(run.out)["requirements"]
    assert (one["measured"], one["unmeasured"]) == ([0], [1])
    assert robot("coverage", "cut.mcap").status == 2
    assert robot("audit", "late.mcap").status == 0
    path = Path("build/evidence.json")
    evidence = json.loads(path.read_text("utf-8"))
    for each in (*evidence["results"], *evidence["requirements"]):
        del each["situations"]
    write(str(path), json.dumps(evidence))
    run = robot("coverage")
    assert run.status == 3
    assert run.out.startswith("? R1: situations not measured\n")


@pytest.mark.slow
def test_a_mutant_that_no_run_notices_is_listed_with_its_sentence(robot: Fretc) -> None:
    run = robot("mutate", "--against", "idle.mcap")
    assert run.status == 3
    double = f"      {SENTENCE.replace('2 ticks', '4 ticks')}\n"
    assert double in run.out
    run = robot("mutate", "requirements", "--against", "late.mcap", "--against", "idle.mcap")
    assert double in run.out  # nothing was answered later than it may be
    assert SENTENCE.replace("within 2 ticks", "immediately") not in run.out
    run_of("worse.mcap", 6, 3, 6, 6, 6, 9, 6)
    run = robot("mutate", "--against", "*.mcap", "--format", "json")
    found = json.loads(run.out)
    schema = json.loads((template_root() / "json/mutation.schema.json").read_text("utf-8"))
    jsonschema.validate(found, schema)
    (one,) = found["requirements"]
    assert {each["sentence"]: each["outcome"] for each in one["mutants"]}[
        double.strip()
    ] == "noticed"
    assert found["runs"] == ["idle.mcap", "late.mcap", "worse.mcap"]


@pytest.mark.slow
def test_bad_use_and_bad_input_are_told_from_what_is_not_seen(robot: Fretc) -> None:
    assert robot("coverage").err.startswith("F901 ")
    assert robot("coverage", "late.mcap", "--evidence", "x.json").status == 2
    assert robot("coverage", "none.mcap").status == 2
    assert robot("mutate").status == 2
    assert robot("mutate", "--against", "none.mcap").status == 2
    write("cut.mcap", "no log")
    assert robot("mutate", "--against", "cut.mcap").status == 2
    write("suite.json", "{}")
    run = robot("coverage", "late.mcap", "--tests", "suite.json")
    assert run.status == 2
    assert run.err.startswith("F503 `suite.json` is not what `fretc test` writes")
    write("suite.json", "[" * 100_000)
    assert robot("mutate", "--against", "late.mcap", "--tests", "suite.json").status == 2
    write("requirements/r1.fret", "the robot shall")
    assert robot("coverage", "late.mcap").status == 2
    assert robot("mutate", "--against", "late.mcap").status == 2


@pytest.mark.slow
def test_the_first_run_that_notices_is_named_whatever_else_could_not_be_read(robot: Fretc) -> None:
    write("cut.mcap", "no log")
    logs_in_order = [f"--against={name}" for name in ("cut.mcap", "idle.mcap", "late.mcap")]
    run = robot("mutate", *logs_in_order, "--format", "json", "--jobs", "2")
    found = json.loads(run.out)
    assert found["runs"] == ["idle.mcap", "late.mcap"]
    (one,) = found["requirements"]
    alone = [
        {m["key"] for m in json.loads(text)["requirements"][0]["mutants"] if m["notice"]}
        for text in (
            robot("mutate", "--against", name, "--format", "json").out for name in found["runs"]
        )
    ]
    for mutant in one["mutants"]:
        by = [place for place, keys in enumerate(alone) if mutant["key"] in keys]
        assert (mutant["notice"] and mutant["notice"]["run"]) == (by[0] if by else None)
