"""Requirements with a probability as a user audits them, on small logs with known triggers."""

import json
import random
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from mcap.writer import CompressionType

from tests.command import Fretc, Run, untimed, write
from tests.effort import FULL, some
from tests.fretc.audit.measurements.test_count_trials import fillings
from tests.fretc.logs.logs import MS, S, number
from tests.fretc.logs.logs import write as write_log
from tests.json_schemas import validate

BINDINGS = """
[clock]
time = "log_time"
tick = "100 ms"
[signal.x]
path = "/c.data"
max_age = "150 ms"
[signal.y]
path = "/r.data"
max_age = "150 ms"
[proposition.c]
expr = "x > 0.5"
[proposition.r]
expr = "y > 0.5"
"""
WITHIN = "whenever c the robot shall with probability >= 0.9 within 2 ticks satisfy r"
HALF = WITHIN.replace("0.9", "0.5")
"""Five logs support or refute it."""
AVERAGE = (
    "this is the average over the recorded triggers; PCTL demands the probability in "
    "every reachable state with a trigger, which is stronger"
)


@pytest.fixture
def fretc(fretc: Fretc) -> Fretc:
    """Run the command in a folder with bindings of c and r, and one requirement."""
    write("requirements/bindings.toml", BINDINGS)
    require(WITHIN)

    def run(command: str, *arguments: str) -> Run:
        """With evidence of several logs in one file, too."""
        named = {"-o", "--evidence", "--summary"} & {*arguments}
        more = () if command != "audit" or named else ("-o", "build/evidence.json")
        return fretc(command, *arguments, *more)

    return run


def require(sentence: str, id: str = "R7") -> None:
    write(f"requirements/{id}.fret", f'+++\nid = "{id}"\nverify = ["audit"]\n+++\n{sentence}\n')


def log(path: str, c: str, r: str, per_chunk: int | None = None) -> str:
    """A log with a message of each topic at each tick."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    messages = [
        number(float(value), 1000 * S + tick * 100 * MS, topic)
        for tick, values in enumerate(zip(c, r, strict=True))
        for topic, value in zip(("/c", "/r"), values, strict=True)
    ]
    write_log(Path(path), messages, per_chunk=per_chunk)
    return path


def logs(count: int, c: str, r: str, folder: str = "runs") -> None:
    """Logs of different lengths, so that none is a copy."""
    for i in range(count):
        log(f"{folder}/{i:03}.mcap", c + "0" * i, r + "0" * i)


def evidence() -> Any:
    content = json.loads(Path("build/evidence.json").read_text("utf-8"))
    results = content["results"]  # all alike but for the last ones
    some_results = results if FULL else [*results[:1], *results[1:][-2:]]
    validate("evidence.schema.json", {**content, "results": some_results})
    return content


def estimate() -> Any:
    (probability,) = evidence()["probabilities"]
    return probability


def counts() -> tuple[int, int, int]:
    triggers = estimate()["triggers"]
    return triggers["answered"], triggers["failed"], triggers["open"]


def suspicions(fretc: Fretc) -> list[str]:
    """Why a report does not count what the evidence says of all runs."""
    fretc("report", "--json", "report.json")
    (requirement,) = json.loads(Path("report.json").read_text("utf-8"))["requirements"]
    return list(requirement["probability"]["suspicions"])


@pytest.mark.slow
def test_many_answers_support_it(fretc: Fretc) -> None:
    logs(33, "1000", "0100")
    run = fretc("audit", "runs")
    assert (run.status, run.err) == (0, "wrote build/evidence.json\n")
    assert counts() == (33, 0, 0)
    listed = fretc("audit", "runs/000.mcap", "runs/001.mcap", "-v").out
    assert listed.startswith(
        "runs/000.mcap\n"
        "  ◔ R7  inconclusive  1 of 1 trigger answered: judged over all runs\n"
        "runs/001.mcap\n"
    )
    assert untimed(run.out) == (
        "    run 1          11         21         31\n"
        "  ✔ R7  ◔◔◔◔◔◔◔◔◔◔ ◔◔◔◔◔◔◔◔◔◔ ◔◔◔◔◔◔◔◔◔◔ ◔◔◔\n"
        "R7 over"
        " all runs, with probability >= 0.9\n"
        "  ✔ supported     it lies between 0.9022 and 1.0000, so >= 0.9\n"
        "    33 of 33 triggers answered, 0 failed, 0 open, in 33 logs\n"
        "    estimate 1.0000; bounds (the logs are the independent units) at 95 % each: 0.9022 "
        "to 1.0000\n"
        f"    {AVERAGE}\n"
        "2 of 20 situations seen, 18 never: `fretc coverage` lists them\n"
        "33 runs \N{MULTIPLICATION SIGN} 1 requirement: 1 supported over all runs, "
        "33 counted over all runs\n"
    )


@pytest.mark.slow
def test_a_violated_trigger_alone_is_no_violation_and_its_place_is_kept(fretc: Fretc) -> None:
    logs(10, "1000", "0100")
    log("runs/bad.mcap", "0010000", "0000000")
    run = fretc("audit", "runs", "-v")
    assert run.status == 3
    assert "◔ R7  inconclusive  0 of 1 trigger answered, 1 failed: judged over all runs" in run.out
    assert "at least 59 more logs, all triggers answered, would be needed" in run.out
    bad = evidence()["results"][-1]
    assert (bad["verdict"], bad["trials"]) == (
        "inconclusive",
        {"answered": 0, "failed": 1, "open": 0},
    )
    assert [v["first_tick"] for v in bad["violations"]] == [4]


@pytest.mark.slow
def test_many_failures_refute_it(fretc: Fretc) -> None:
    logs(10, "10001000", "01000001")
    run = fretc("audit", "runs")
    assert run.status == 1
    assert "  ✘ refuted       it lies between 0.3566 and 0.6434, so not >= 0.9\n" in run.out
    assert run.err == "wrote build/evidence.json\n"
    assert counts() == (10, 10, 0)


@pytest.mark.slow
def test_so_few_logs_cannot_support_it_however_many_triggers_they_have(fretc: Fretc) -> None:
    require(HALF)
    logs(4, "1000" * 20, "0100" * 20)
    run = fretc("audit", "runs")
    assert (run.status, run.err) == (
        3,
        "F506 warning: the probability of R7 is estimated from 4 logs with a trigger\n"
        "help: audit 5 or more: triggers of one log may depend on each other, so logs are "
        "counted, not triggers\n"
        "wrote build/evidence.json\n",
    )
    assert "    80 of 80 triggers answered, 0 failed, 0 open, in 4 logs\n" in run.out
    assert "    at least 1 more log, all triggers answered, would be needed\n" in run.out
    logs(5, "1000" * 20, "0100" * 20)
    assert fretc("audit", "runs").status == 0


@pytest.mark.slow
def test_the_counts_are_those_of_the_truth_columns(fretc: Fretc) -> None:
    """Naively: an answer within two ticks, none in two ticks, or the log ends before."""
    chance, expected = random.Random(7), [0, 0, 0]
    for i in range(12):
        length = chance.randrange(4, 40)
        c = "".join(chance.choice("0001") for _ in range(length))
        r = "".join(chance.choice("001") for _ in range(length))
        log(f"runs/{i}.mcap", c, r)
        for t in range(length):
            if c[t] == "1":
                ahead = r[t : t + 3]
                expected[0 if "1" in ahead else 1 if len(ahead) == 3 else 2] += 1
    fretc("audit", "runs")
    assert counts() == tuple(expected)
    assert min(expected) > 0


NAMES = [f"{part}{i}" for part in "mpqs" for i in (1, 2)]


@pytest.mark.slow
def test_no_sentence_with_a_probability_ends_an_audit_and_each_is_counted(fretc: Fretc) -> None:
    """Templates with any expressions, constants among them, each a requirement of its own."""
    chance = random.Random("audits")
    expected = {}
    columns = {name: [chance.random() < 0.5 for _ in range(6)] for name in NAMES}
    for i, filled in enumerate(some([*fillings(chance)][::8], 4)):
        require(filled.sentence, f"P{i}")
        expected[f"P{i}"] = filled.naive({name: columns[name] for name in filled.names})
    Path("requirements/R7.fret").unlink()
    signals = [f'[signal.v{name}]\npath = "/{name}.data"\n' for name in NAMES]
    bound = [f'[proposition.{name}]\nexpr = "v{name} > 0.5"\n' for name in NAMES]
    clock = '[clock]\ntime = "log_time"\ntick = "100 ms"\n'
    write("requirements/bindings.toml", "".join([clock, *signals, *bound]))
    messages = [
        number(float(columns[name][tick]), 1000 * S + tick * 100 * MS, f"/{name}")
        for tick in range(6)
        for name in NAMES
    ]
    write_log(Path("run.mcap"), messages)
    run = fretc("audit", "run.mcap")
    assert run.status == 3
    triggers = {one["requirement"]: one["triggers"] for one in evidence()["probabilities"]}
    assert len(triggers) == len(expected) == (108 if FULL else 27)
    for id, counted in expected.items():
        numbers = {name: getattr(counted, name) for name in ("answered", "failed", "open")}
        assert triggers[id] == numbers, id


def test_what_no_run_can_meet_is_failed_at_each_trigger(fretc: Fretc) -> None:
    require("whenever c the robot shall with probability >= 0.9 finally satisfy false")
    logs(3, "1010", "0000")
    run = fretc("audit", "runs", "-v")
    assert run.status == 1
    assert "◔ R7  inconclusive  0 of 2 triggers answered, 2 failed: judged over all runs" in run.out
    assert counts() == (0, 6, 0)


@pytest.mark.slow
def test_what_is_unknown_in_the_middle_is_open_and_damage_withholds_support(fretc: Fretc) -> None:
    require(HALF)
    logs(5, "1" * 20, "1" * 20)
    assert fretc("audit", "runs").status == 0
    path = Path(log("runs/cut.mcap", "1" * 20, "1" * 20, per_chunk=8))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    run = fretc("audit", "runs")
    assert run.status == 3
    assert (
        "1 log is damaged or could not be read: the lost part could contradict the requirement"
        in run.out
    )
    answered, failed, _ = counts()
    assert (answered > 100, failed) == (True, 0)
    assert estimate()["logs"]["damaged"] == 1


@pytest.mark.slow
def test_damage_hides_no_failure_that_was_seen(fretc: Fretc) -> None:
    logs(10, "1000", "0001")
    path = Path(log("runs/cut.mcap", "1000" * 50, "0001" * 50, per_chunk=40))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert fretc("audit", "runs").status == 1


def test_a_topic_that_falls_silent_leaves_triggers_open(fretc: Fretc) -> None:
    messages = [
        number(value, 1000 * S + i * 100 * MS, "/c") for i, value in enumerate([1, 0, 0, 0, 0])
    ]
    write_log(
        Path("a.mcap"),
        [*messages, number(0, 1000 * S, "/r"), number(0, 1000 * S + 4 * 10**8, "/r")],
    )
    fretc("audit", "a.mcap")
    assert counts() == (0, 0, 1)


@pytest.mark.slow
def test_a_copy_of_a_log_counts_once(fretc: Fretc) -> None:
    logs(2, "1000", "0100")
    shutil.copy("runs/000.mcap", "runs/copy.mcap")
    assert fretc("audit", "runs").status == 3
    assert (counts(), estimate()["logs"]["copies"]) == ((2, 0, 0), 1)
    assert suspicions(fretc) == []


@pytest.mark.slow
@pytest.mark.parametrize("integrity", ["index", "hash", "full"])
def test_a_log_that_was_written_again_counts_once(fretc: Fretc, integrity: str) -> None:
    """The same messages with other chunks, another compression, and a topic that nobody reads."""
    logs(2, "1000", "0100")
    messages = [
        number(float(value), 1000 * S + tick * 100 * MS, topic)
        for tick, values in enumerate(zip("1000", "0100", strict=True))
        for topic, value in zip(("/c", "/r", "/note"), (*values, "7"), strict=True)
    ]
    unnoted = [one for one in messages if one.topic != "/note"]
    write_log(Path("runs/noted.mcap"), messages)
    write_log(Path("runs/chunks.mcap"), unnoted, per_chunk=1)
    write_log(Path("runs/loose.mcap"), unnoted, compression=CompressionType.NONE)
    write_log(Path("runs/bare.mcap"), unnoted, data_crcs=True, statistics=False)
    assert fretc("audit", "runs", "--integrity", integrity).status == 3
    assert (counts(), estimate()["logs"]["copies"]) == ((2, 0, 0), 4)
    assert suspicions(fretc) == []


@pytest.mark.slow
def test_runs_that_differ_in_a_value_or_a_time_are_no_copies(fretc: Fretc) -> None:
    log("runs/a.mcap", "1000", "0100")
    log("runs/b.mcap", "1000", "0010")
    write_log(
        Path("runs/c.mcap"),
        [
            number(float(value), 2000 * S + tick * 100 * MS, topic)
            for tick, values in enumerate(zip("1000", "0100", strict=True))
            for topic, value in zip(("/c", "/r"), values, strict=True)
        ],
    )
    fretc("audit", "runs")
    assert estimate()["logs"]["copies"] == 0
    assert estimate()["logs"]["counted"] == 3


@pytest.mark.confined
@pytest.mark.slow
def test_the_order_of_the_logs_changes_nothing(fretc: Fretc) -> None:
    chance = random.Random(3)
    paths = [
        log(f"{i}.mcap", "".join(chance.choices("0001", k=12)), "".join(chance.choices("01", k=12)))
        for i in range(8)
    ]
    fretc("audit", *paths)
    first = estimate()
    for _ in range(3 if FULL else 1):
        chance.shuffle(paths)
        fretc("audit", *paths, "--jobs", "2")
        assert estimate() == first


@pytest.mark.slow
def test_a_log_that_is_written_anew_counts_anew(fretc: Fretc) -> None:
    logs(3, "1000", "0100")
    fretc("audit", "runs")
    content = Path("build/evidence.json").read_bytes()
    log("runs/001.mcap", "10000", "00000")
    fretc("audit", "runs")
    assert Path("build/evidence.json").read_bytes() != content
    assert counts() == (2, 1, 0)


def test_without_a_trigger_nothing_is_known(fretc: Fretc) -> None:
    logs(2, "0000", "0100")
    run = fretc("audit", "runs", "-v")
    assert run.status == 3
    assert "∅ R7  vacuous" in run.out
    assert "◔ inconclusive  there was no trigger\n" in run.out
    assert (estimate()["estimate"], estimate()["needed"]) == (None, 33)


@pytest.mark.slow
def test_an_unreadable_log_is_bad_input_and_supports_nothing(fretc: Fretc) -> None:
    require(HALF)
    logs(5, "1000", "0100")
    write("runs/bad.mcap", "no log")
    run = fretc("audit", "runs")
    assert run.status == 2
    assert (estimate()["answer"], estimate()["logs"]["damaged"]) == (
        "inconclusive",
        1,
    )


@pytest.mark.slow
def test_the_stated_confidence_is_used(fretc: Fretc) -> None:
    require(HALF)
    logs(5, "1000", "0100")
    assert fretc("audit", "runs", "--confidence", "0.99").status == 3
    assert estimate()["confidence"] == 0.99
    assert " --confidence 0.99 -o " in json.dumps(reported(fretc)["commands"])
    assert fretc("audit", "runs", "--confidence", "0.9").status == 0
    for value in ("0.5", "1", "95", "x"):
        assert fretc("audit", "runs", "--confidence", value).status == 2


@pytest.mark.slow
def test_beside_other_requirements_each_is_judged_its_way(fretc: Fretc) -> None:
    require(HALF)
    logs(5, "1000", "0100")
    require("whenever c the robot shall within 2 ticks satisfy r", "R8")
    assert fretc("audit", "runs").status == 0
    require("whenever c the robot shall immediately satisfy r", "R9")
    run = fretc("audit", "runs")
    assert run.status == 1
    assert "✔ supported" in run.out
    kinds = {(r["requirement"], "trials" in r) for r in evidence()["results"]}
    assert kinds == {("R7", True), ("R8", False), ("R9", False)}


def test_without_probabilities_nothing_of_it_is_there(fretc: Fretc) -> None:
    require("whenever c the robot shall within 2 ticks satisfy r")
    run = fretc("audit", log("a.mcap", "1000", "0100"), "--format", "json")
    assert "probabilities" not in evidence()
    assert json.loads(run.out) == evidence()["results"]


def test_what_no_monitor_can_say_is_told_at_its_place(fretc: Fretc) -> None:
    require(f"whenever  c robot shall with probability > 0.5 satisfy {'!(' * 80}r{')' * 80}")
    run = fretc("audit", log("a.mcap", "1000", "0100"))
    assert run.status == 2
    assert "  --> requirements/R7.fret:5:1\n   | whenever  c robot shall with prob" in run.err


def test_the_monitor_of_one_run_is_refused_still(fretc: Fretc) -> None:
    run = fretc("requirements/R7.fret", "--emit", "monitor")
    assert run.status == 2
    assert "`fretc audit` estimates it over many" in run.err


# Other forms -----------------------------------------------------------------------------------


def test_json_has_runs_and_probabilities_by_name(fretc: Fretc) -> None:
    logs(2, "1000", "0100")
    content = json.loads(fretc("audit", "runs", "--format", "json").out)
    assert content == {name: evidence()[name] for name in ("results", "probabilities")}


@pytest.mark.slow
@pytest.mark.parametrize(("r", "kinds"), [("0100", []), ("0001", ["failure"])])
def test_junit_has_a_suite_of_all_runs(fretc: Fretc, r: str, kinds: Sequence[str]) -> None:
    require(HALF)
    logs(5, "1000", r)
    *_, suite = ElementTree.fromstring(fretc("audit", "runs", "--format", "junit").out)
    (case,) = suite
    assert (suite.get("name"), suite.get("failures")) == ("all runs", str(len(kinds)))
    assert [child.tag for child in case] == kinds


@pytest.mark.slow
def test_github_and_sarif_say_it_at_the_sentence_once_and_runs_are_no_alerts(fretc: Fretc) -> None:
    logs(10, "1000", "0001")
    lines = fretc("audit", "runs", "--format", "github").out.splitlines()
    assert [line.split(" ")[0] for line in lines] == ["::notice"] * 10 + ["::error"]
    assert lines[-1].startswith(
        "::error file=requirements/R7.fret,line=5,title=R7 refuted::all runs"
    )
    assert AVERAGE in lines[-1]
    (run,) = json.loads(fretc("audit", "runs", "--format", "sarif").out)["runs"]
    assert [(one["kind"], one["level"]) for one in run["results"]] == [("fail", "error")]


def reported(fretc: Fretc) -> Any:
    run = fretc("report", "--json", "build/report.json")
    assert run.status == 0
    content = json.loads(Path("build/report.json").read_text("utf-8"))
    validate("report.schema.json", content)
    return content


@pytest.mark.slow
def test_the_report_shows_the_interval_and_the_bound(fretc: Fretc) -> None:
    require(HALF)
    logs(5, "1000", "0100")
    fretc("audit", "runs")
    content = reported(fretc)
    (section,) = content["requirements"]
    assert section["mark"]["word"] == section["probability"]["mark"]["word"] == "supported"
    assert section["probability"]["text"] == (
        "Estimate 1.0000; bounds (the logs are the independent units) 0.5109 to 1.0000; "
        "the bound of the sentence is 0.5."
    )
    assert content["reservations"] == [f"R7 is supported: {AVERAGE}.", "R7 is a draft."]
    page = Path("build/report.html").read_text("utf-8")
    assert '<line class="bound"' in page
    assert section["probability"]["text"] in page
    ElementTree.fromstring(page[page.index("<svg") : page.index("</svg>") + 6])


@pytest.mark.slow
def test_the_report_of_a_refuted_one_is_broken(fretc: Fretc) -> None:
    logs(10, "1000", "0001")
    fretc("audit", "runs")
    content = reported(fretc)
    assert content["overall"]["headline"] == "R7 is refuted."
    assert content["requirements"][0]["reasons"] == [
        "over all runs: refuted, it lies between 0.0000 and 0.2868, so not >= 0.9"
    ]


@pytest.mark.slow
def test_evidence_that_does_not_add_up_is_suspect(fretc: Fretc) -> None:
    require(HALF)
    logs(5, "1000", "0100")
    fretc("audit", "runs")
    content = evidence()
    content["probabilities"][0]["triggers"]["failed"] = 3
    write("build/evidence.json", json.dumps(content))
    (section,) = reported(fretc)["requirements"]
    assert (section["mark"]["word"], section["mark"]["suspect"]) == ("supported", True)
    assert "do not add up" in section["probability"]["suspicions"][0]


@pytest.mark.slow
@pytest.mark.parametrize("bound", ["x", "2", "1/0", 0.9])
def test_evidence_with_a_bound_that_is_none_cannot_be_read(fretc: Fretc, bound: object) -> None:
    fretc("audit", log("a.mcap", "1000", "0100"))
    content = evidence()
    content["probabilities"][0]["bound"] = bound
    write("build/evidence.json", json.dumps(content))
    run = fretc("report")
    assert run.status == 2
    assert run.err.startswith("F503")


@pytest.mark.slow
def test_what_all_runs_say_is_made_again_with_the_evidence(fretc: Fretc) -> None:
    logs(2, "1000", "0000")
    assert fretc("audit", "runs", "--confidence", "0.9").status == 1
    run = fretc("verify-evidence")
    assert run.status == 0
    assert "all runs\n  ✔ R7  stands\n" in run.out
    text = Path("build/evidence.json").read_text()
    evidence = json.loads(text)
    write("build/evidence.json", text.replace('"refuted"', '"supported"'))
    run = fretc("verify-evidence")
    assert run.status == 1
    assert "✘ R7  differs: the answer is refuted now, and was supported\n" in run.out
    for field, value, reason in [
        ("confidence", 0.99, "differs: the answer is inconclusive now, and was refuted"),
        ("confidence", 0.9995, "differs: its confidence is not above 0.5 and at most 0.999"),
        ("reason", "so it is", "differs: it differs in reason"),
    ]:
        (estimate,) = evidence["probabilities"]
        write(
            "build/evidence.json",
            json.dumps({**evidence, "probabilities": [{**estimate, field: value}]}),
        )
        run = fretc("verify-evidence")
        assert run.status == 1
        assert reason in run.out
    del evidence["probabilities"]
    write("build/evidence.json", json.dumps(evidence))
    assert "its estimate over all runs is missing from the file" in fretc("verify-evidence").out
    shutil.rmtree("runs")
    write("build/evidence.json", text)
    assert fretc("verify-evidence").status == 3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("answers", "status", "kinds"), [("00", 1, ["failure"]), ("01", 0, []), ("0", 3, ["skipped"])]
)
def test_a_report_fails_where_all_runs_refute_and_passes_where_they_support(
    fretc: Fretc, answers: str, status: int, kinds: list[str]
) -> None:
    require(HALF)
    logs(5 if len(answers) > 1 else 1, "10"[: len(answers)] + "000", f"{answers}000")
    fretc("audit", "runs")
    assert fretc("report", "--strict", "--junit", "r.xml").status == status
    (case,), *runs = ElementTree.parse("r.xml").getroot()
    assert [child.tag for child in case] == kinds
    assert {child.tag for run in runs for one in run for child in one} == {"skipped"}
