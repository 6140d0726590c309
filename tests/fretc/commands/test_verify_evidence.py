"""`fretc verify-evidence`: evidence made again from its logs, and compared."""

import hashlib
import json
import shutil
from pathlib import Path

import pytest

from tests.command import Fretc, made_once, write
from tests.compiled_monitors import TONGUES
from tests.effort import some
from tests.fretc.commands.test_verify_languages import MADE
from tests.fretc.logs.logs import MS, X_TEXT, number
from tests.fretc.logs.logs import write as write_log
from tests.programs import installed

R1 = "whenever p the sw shall within 2 ticks satisfy q"
BINDINGS = X_TEXT + (
    '\n[proposition.p]\nexpr = "x > 1 m"\nagg = "last"\n'
    '\n[proposition.q]\nexpr = "x > 2 m"\nagg = "last"\n'
)


def log(path: str, *values: float) -> str:
    """One value a tick of 100 ms."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    sent = [number(v, 10**9 + i * 100 * MS) for i, v in enumerate(values)]
    write_log(Path(path), sent)
    return path


@pytest.fixture
def audited(fretc: Fretc) -> Fretc:
    """Two logs that were audited, one of them violated."""

    def make() -> None:
        write("requirements/r1.fret", R1)
        write("requirements/bindings.toml", BINDINGS)
        log("logs/good.mcap", 0, 1.5, 3, 0, 0, 0)
        log("logs/bad.mcap", 0, 1.5, 0, 0, 0, 0)
        assert fretc("audit", "logs", "-o", "build/evidence.json").status == 1

    made_once("audited", make)
    return fretc


def test_evidence_that_nobody_touched_stands(audited: Fretc) -> None:
    run = audited("verify-evidence")
    assert (run.status, run.err) == (0, "")
    assert run.out == (
        "logs/bad.mcap\n  ✔ r1  stands\nlogs/good.mcap\n  ✔ r1  stands\n"
        "stands 2, differs 0, not checked 0 (1 requirement of `requirements`; "
        "neither a lock nor a manifest lists the runs)\n"
    )


@pytest.mark.slow
def test_evidence_is_made_again_as_closely_as_it_claims(audited: Fretc) -> None:
    assert audited("audit", "logs", "-o", "build/evidence.json", "--integrity", "full").status == 1
    assert audited("verify-evidence").status == 0
    known = json.loads(Path("build/evidence.json").read_text())
    for result in known["results"]:
        result["health"]["checked"]["crc_checked"] += 1
    changed(results=known["results"])
    assert audited("verify-evidence").status == 1


@pytest.mark.slow
def test_what_was_never_hashed_does_not_stand(audited: Fretc) -> None:
    assert audited("audit", "logs", "-o", "build/evidence.json", "--integrity", "index").status == 1
    run = audited("verify-evidence")
    assert run.status == 3
    assert "? r1  not checked: its log was read by its index and was not hashed\n" in run.out
    manifested()
    assert audited("verify-evidence", "--manifest", "logs.sha256").status == 0


def test_a_verdict_that_was_changed_by_hand_is_found(audited: Fretc) -> None:
    text = Path("build/evidence.json").read_text()
    write("build/evidence.json", text.replace('"verdict": "violated"', '"verdict": "satisfied"'))
    run = audited("verify-evidence")
    assert run.status == 1
    assert run.out == (
        "logs/bad.mcap\n"
        "  ✘ r1  differs: the verdict is violated now, and was satisfied; "
        "it differs in phases\n"
        "logs/good.mcap\n"
        "  ✔ r1  stands\n"
        "stands 1, differs 1, not checked 0 (1 requirement of `requirements`; "
        "neither a lock nor a manifest lists the runs)\n"
    )


def test_another_log_under_the_same_name_is_found(audited: Fretc) -> None:
    log("logs/bad.mcap", 0, 1.5, 3, 0, 0, 0)
    run = audited("verify-evidence")
    assert run.status == 1
    assert "differs: the log has changed; the verdict is satisfied now, and was violated" in run.out


@pytest.mark.slow
@pytest.mark.parametrize("looked", ["index", "hash", "full"])
def test_another_log_of_the_same_verdicts_is_found(audited: Fretc, looked: str) -> None:
    assert audited("audit", "logs", "-o", "build/evidence.json", "--integrity", looked).status == 1
    log("logs/good.mcap", 0, 1.5, 3, 0, 0, 0.5)
    run = audited("verify-evidence")
    assert run.status == 1
    assert "logs/good.mcap\n  ✘ r1  differs: the log has changed" in run.out


def test_a_default_that_is_written_out_is_no_difference(audited: Fretc) -> None:
    write("requirements/bindings.toml", BINDINGS.replace("[clock]", "# as it is\n[clock]"))
    text = Path("requirements/bindings.toml").read_text()
    assert 'end = "inconclusive"' not in text
    write("requirements/bindings.toml", text.replace("tick =", 'end = "inconclusive"\ntick ='))
    assert audited("verify-evidence").status == 0


def test_an_assumption_that_was_put_in_by_hand_is_found(audited: Fretc) -> None:
    known = json.loads(Path("build/evidence.json").read_text())
    known["results"][0]["assumptions"].append("the brake holds")
    write("build/evidence.json", json.dumps(known))
    assert "differs: it differs in assumptions\n" in audited("verify-evidence").out


def test_a_hash_that_was_put_in_by_hand_does_not_help(audited: Fretc) -> None:
    known = json.loads(Path("build/evidence.json").read_text())
    log("logs/bad.mcap", 0, 1.5, 3, 0, 0, 0)
    shutil.copytree("logs", "others")
    assert audited("audit", "others", "-o", "other.json").status == 0
    other = json.loads(Path("other.json").read_text())
    known["results"][0]["hashes"]["log"] = other["results"][0]["hashes"]["log"]
    write("build/evidence.json", json.dumps(known))
    run = audited("verify-evidence")
    assert run.status == 1
    assert "the log has changed" not in run.out
    assert "the verdict is satisfied now, and was violated" in run.out


def test_another_binding_is_found(audited: Fretc) -> None:
    write("requirements/bindings.toml", BINDINGS.replace("x > 2 m", "x > 2.5 m"))
    run = audited("verify-evidence")
    assert run.status == 1
    assert "the bindings have changed" in run.out


def changed(**fields: object) -> None:
    known = json.loads(Path("build/evidence.json").read_text())
    write("build/evidence.json", json.dumps({**known, **fields}))


NO_HASH = "0" * 64


def named(id: str) -> dict[str, str]:
    return {"id": id, "sentence": "x", "sha256": NO_HASH}


def manifested(*lines: str) -> None:
    """What `sha256sum logs/*.mcap` prints, or these lines."""
    logs = sorted(Path("logs").glob("*.mcap"))
    whole = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path}" for path in logs]
    write("logs.sha256", "".join(f"{line}\n" for line in lines or whole))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("field", "value", "told"),
    [
        ("fretc", "0.0.1", "differs: the installed fretc is 0.1.0"),
        ("bindings", {"file": "x", "sha256": NO_HASH}, "the bindings have changed"),
        ("requirements", [], "differs: r1 is claimed, but the evidence does not name it"),
        ("requirements", [], "differs: the file does not name it among its requirements"),
        ("requirements", [named("r1"), named("r1")], "differs: it appears twice"),
        ("requirements", [named("r1")], "sentence has changed"),
        ("requirements", [named("r2")], "r2  differs: it is no longer claimed"),
    ],
)
def test_what_the_file_says_before_its_results_is_compared(
    audited: Fretc, field: str, value: object, told: str
) -> None:
    changed(**{field: value})
    run = audited("verify-evidence")
    assert run.status == 1
    assert told in run.out


def test_findings_about_a_log_are_compared_over_all_its_requirements(audited: Fretc) -> None:
    write("requirements/r2.fret", "whenever p the sw shall within 3 ticks satisfy q")
    assert audited("audit", "logs", "-o", "build/evidence.json").status == 1
    results = json.loads(Path("build/evidence.json").read_text())["results"]
    last = [result for result in results if result["run"] == "logs/good.mcap"][-1]
    place = {"file": "f", "line": 1, "column": 1}
    finding = {"code": "F404", "severity": "warning", "message": "m", "help": "h", **place}
    last["health"]["findings"] = [finding]
    changed(results=results)
    run = audited("verify-evidence")
    assert run.status == 1
    good = run.out.split("logs/good.mcap\n")[1]
    assert "  ✘     differs: the findings about its log differ\n" in good


def test_a_result_that_was_taken_out_is_found(audited: Fretc) -> None:
    write("requirements/r2.fret", "whenever p the sw shall within 3 ticks satisfy q")
    assert audited("audit", "logs", "-o", "build/evidence.json").status == 1
    results = json.loads(Path("build/evidence.json").read_text())["results"]
    worst = next(i for i, one in enumerate(results) if one["verdict"] == "violated")
    del results[worst]
    changed(results=results)
    run = audited("verify-evidence")
    assert run.status == 1
    assert "✘ r1  differs: r1 is claimed, but the evidence has no result for it\n" in run.out


def test_a_result_that_is_told_twice_is_found(audited: Fretc) -> None:
    results = json.loads(Path("build/evidence.json").read_text())["results"]
    changed(results=[*results, results[0]])
    assert "✘ r1  differs: it appears twice\n" in audited("verify-evidence").out


def test_the_name_of_a_run_cannot_write_on_the_terminal(audited: Fretc) -> None:
    results = json.loads(Path("build/evidence.json").read_text())["results"]
    changed(results=[{**one, "run": "\x1b[2K\u202e.mcap"} for one in results[:1]])
    assert audited("verify-evidence").out.startswith("\\x1b[2K\\u202e.mcap\n  ? r1")


def test_evidence_of_no_run_shows_nothing(audited: Fretc) -> None:
    changed(results=[])
    run = audited("verify-evidence")
    assert run.status == 3
    assert "not checked: it contains no run" in run.out


def test_a_log_that_is_gone_is_not_checked(audited: Fretc) -> None:
    Path("logs/good.mcap").unlink()
    run = audited("verify-evidence")
    assert run.status == 3
    assert "  ? r1  not checked: its log was not found\n" in run.out


def test_logs_that_were_moved_are_found_below_a_folder(audited: Fretc) -> None:
    shutil.move("logs", "archive")
    log("archive/old/bad.mcap", 0, 0)
    assert audited("verify-evidence").status == 3
    assert audited("verify-evidence", "--logs", "archive").status == 0


def test_a_requirement_that_is_gone_is_found(audited: Fretc) -> None:
    write("requirements/r1.fret", R1.replace("q", "p"))
    shutil.move("requirements/r1.fret", "requirements/r2.fret")
    run = audited("verify-evidence")
    assert run.status == 1
    assert "differs: it is no longer claimed" in run.out


@pytest.mark.slow
def test_a_report_is_made_again_and_compared(audited: Fretc) -> None:
    assert audited("report").status == 0
    run = audited("verify-evidence", "--report", "build/report.html")
    assert (run.status, run.out.splitlines()[-2]) == (0, "✔ report  the same, byte for byte")
    assert run.out.splitlines()[-1].startswith("stands 3, differs 0, not checked 0 (")
    page = Path("build/report.html").read_text()
    write("build/report.html", page.replace("violated", "satisfied", 1))
    run = audited("verify-evidence", "--report", "build/report.html", "--format", "json")
    assert run.status == 1
    assert json.loads(run.out)["report_is_the_same"] is False


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("no.json",), "F901 no run has been audited: there is no evidence in `no.json`"),
        (("--manifest", "no"), "F901 there is no file `no`"),
        (
            ("--manifest", "requirements/r1.fret"),
            "F545 the line is not in the format of `sha256sum`",
        ),
        (("--only", "r2"), "F907 no requirement `r2` is in force"),
        (("--verification", "no"), "F901 there is no file `no`"),
        (("--logs", "no"), "F901 there is no folder `no`"),
        (("--report", "no.html"), "F901 there is no file `no.html`"),
        (("requirements/r1.fret",), "F503"),
    ],
)
def test_wrong_use_is_told(audited: Fretc, arguments: tuple[str, ...], told: str) -> None:
    run = audited("verify-evidence", *arguments)
    assert run.status == 2
    assert told in run.err


# Places that evidence names -------------------------------------------------------------------


def renamed(old: str, new: str) -> None:
    """The evidence as somebody else may hand it over."""
    text = Path("build/evidence.json").read_text()
    write("build/evidence.json", text.replace(f'"{old}"', f'"{new}"'))


@pytest.mark.slow
@pytest.mark.parametrize("protocol", ["file://{}", "local://{}", "simplecache::file://{}", "{}"])
def test_a_place_that_evidence_names_is_opened_below_the_present_folder_only(
    audited: Fretc, tmp_path_factory: pytest.TempPathFactory, protocol: str
) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    shutil.copy("logs/good.mcap", elsewhere / "good.mcap")
    place = protocol.format(elsewhere / "good.mcap")
    renamed("logs/good.mcap", place)
    run = audited("verify-evidence")
    assert run.status == 3
    assert run.err.startswith("F921 warning: `")
    assert "good.mcap` is not opened: it" in run.err
    assert f"{place}\n  ? r1  not checked: its log was not found\n" in run.out


def test_what_the_user_names_is_opened(
    audited: Fretc, tmp_path_factory: pytest.TempPathFactory
) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    shutil.copy("logs/good.mcap", elsewhere / "good.mcap")
    renamed("logs/good.mcap", f"file://{elsewhere}/good.mcap")
    run = audited("verify-evidence", "--logs", f"file://{elsewhere}")
    assert (run.status, run.err) == (0, "")
    run = audited("verify-evidence", "--logs", f"file://{elsewhere}", "--offline")
    assert run.status == 3
    assert run.err.startswith("F921 warning: ")


def test_a_link_below_the_folder_leads_nowhere(
    audited: Fretc, tmp_path_factory: pytest.TempPathFactory
) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    shutil.move("logs/good.mcap", elsewhere / "good.mcap")
    Path("logs/good.mcap").symlink_to(elsewhere / "good.mcap")
    assert audited("verify-evidence", "--logs", "logs").status == 3
    run = audited("verify-evidence", "--logs", "logs", "--logs", str(elsewhere))
    assert (run.status, run.err) == (0, "")


# What is missing ------------------------------------------------------------------------------

BY = ("--reviewer", "A", "--role", "b", "--comment", "c", "--accept-violations")


def without(run: str) -> None:
    """All of a run is left out."""
    results = json.loads(Path("build/evidence.json").read_text())["results"]
    changed(results=[one for one in results if one["run"] != run])


def test_a_requirement_that_is_nowhere_in_the_evidence_is_missed(audited: Fretc) -> None:
    write("requirements/r2.fret", "whenever p the sw shall within 3 ticks satisfy q")
    run = audited("verify-evidence", "--format", "json")
    assert run.status == 1
    assert json.loads(run.out)["counts"] == {"stands": 2, "differs": 3, "not checked": 0}
    run = audited("verify-evidence", "--only", "r1")
    assert run.status == 3
    assert run.out.splitlines()[-1].startswith(
        "stands 2, differs 0, not checked 0 (only r1, a part; "
    )


def test_a_run_that_was_reviewed_is_missed(audited: Fretc) -> None:
    assert audited("lock", *BY).status == 0
    assert audited("verify-evidence").status == 0
    without("logs/bad.mcap")
    run = audited("verify-evidence")
    assert run.status == 1
    told = "✘ r1  differs: the lock names this run, but the evidence has no result for it\n"
    assert f"logs/bad.mcap\n  {told}" in run.out


def test_a_log_in_place_of_the_one_that_was_reviewed_is_found(audited: Fretc) -> None:
    assert audited("lock", *BY).status == 0
    log("logs/bad.mcap", 0, 1.5, 3, 0, 0, 0.5)
    assert audited("audit", "logs", "-o", "build/evidence.json").status == 0
    run = audited("verify-evidence")
    assert run.status == 1
    assert (
        "logs/bad.mcap\n  ✘ r1  differs: its log differs from the one that was reviewed\n"
        in run.out
    )


@pytest.mark.slow
@pytest.mark.parametrize(("then", "now"), [("index", "hash"), ("full", "index")])
def test_a_log_is_the_reviewed_one_however_closely_it_was_looked_at(
    audited: Fretc, then: str, now: str
) -> None:
    assert audited("audit", "logs", "-o", "build/evidence.json", "--integrity", then).status == 1
    assert audited("lock", *BY).status == 0
    assert audited("audit", "logs", "-o", "build/evidence.json", "--integrity", now).status == 1
    run = audited("verify-evidence", "--format", "json")
    assert json.loads(run.out)["counts"]["differs"] == 0
    log("logs/good.mcap", 0, 1.5, 3, 0, 0, 0.5)
    assert audited("audit", "logs", "-o", "build/evidence.json", "--integrity", now).status == 1
    assert "differs from the one that was reviewed" in audited("verify-evidence").out


@pytest.mark.slow
def test_a_requirement_that_was_reviewed_and_is_gone_is_missed(audited: Fretc) -> None:
    write("requirements/r2.fret", "whenever p the sw shall within 3 ticks satisfy q")
    assert audited("audit", "logs", "-o", "build/evidence.json").status == 1
    assert audited("lock", *BY).status == 0
    Path("requirements/r2.fret").unlink()
    assert audited("audit", "logs", "-o", "build/evidence.json").status == 1
    run = audited("verify-evidence")
    assert run.status == 1
    assert "r2  differs: it was claimed at the review, and is no longer claimed\n" in run.out


def test_a_manifest_names_all_logs(audited: Fretc) -> None:
    manifested()
    run = audited("verify-evidence", "--manifest", "logs.sha256")
    assert (run.status, run.out.splitlines()[-1].rpartition("; ")[2]) == (
        0,
        "runs by `logs.sha256`)",
    )
    without("logs/bad.mcap")
    run = audited("verify-evidence", "--manifest", "logs.sha256")
    assert run.status == 1
    assert "differs: the manifest names it, but the evidence has no result for it\n" in run.out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("line", "status", "told"),
    [
        ("{good}  logs/good.mcap", 0, ""),
        ("{GOOD} *./logs//good.mcap\r", 0, ""),
        ("# by hand\n{good}  archive/kept.mcap", 0, ""),
        (f"{NO_HASH}  logs/good.mcap", 1, "differs: the manifest has another hash for `logs/good"),
        (f"{NO_HASH}  logs/other.mcap", 1, "differs: the manifest does not name it"),
        ("{good}  logs/good.mcap\n{good}  logs/copy.mcap", 1, "the manifest names it, but the"),
        ("{good}  logs/good.mcap\n{good}  logs/good.mcap", 2, "names this log twice"),
        ("{good} logs/good.mcap", 2, "F545 the line is not in the format of `sha256sum`"),
        ("00  logs/good.mcap", 2, "F545 the line is not in the format of `sha256sum`"),
        ("# nothing", 2, "F545 `logs.sha256` names no log"),
    ],
)
def test_a_manifest_is_read_as_sha256sum_reads_it(
    audited: Fretc, line: str, status: int, told: str
) -> None:
    Path("logs/bad.mcap").unlink()
    assert audited("audit", "logs", "-o", "build/evidence.json").status == 0
    good = hashlib.sha256(Path("logs/good.mcap").read_bytes()).hexdigest()
    manifested(line.format(good=good, GOOD=good.upper()))
    run = audited("verify-evidence", "--manifest", "logs.sha256")
    assert run.status == status
    assert told in run.out + run.err


def test_names_that_sha256sum_escapes_are_read(audited: Fretc) -> None:
    Path("logs/bad.mcap").rename("logs/a\\b\n.mcap")
    assert audited("audit", "logs", "-o", "build/evidence.json").status == 1
    paths = sorted(Path("logs").iterdir())
    manifested(
        *(
            f"\\{hashlib.sha256(path.read_bytes()).hexdigest()}  "
            + str(path).replace("\\", "\\\\").replace("\n", "\\n")
            for path in paths
        )
    )
    assert audited("verify-evidence", "--manifest", "logs.sha256").status == 0


# Proofs ---------------------------------------------------------------------------------------


@pytest.mark.slow
def test_proofs_are_made_again(audited: Fretc) -> None:
    assert audited("verify", "requirements/r1.fret", "--monitor").status == 0
    run = audited("verify-evidence")
    assert run.status == 0
    assert "proofs\n  ✔ r1  stands: monitor: the monitor means what the sentence says\n" in run.out
    text = Path("build/verification.json").read_text()
    write("build/verification.json", text.replace('"proved"', '"counterexample"'))
    run = audited("verify-evidence")
    assert run.status == 1
    assert "it is proved now, and was counterexample\n" in run.out
    run = audited("verify-evidence", "--no-proofs")
    assert run.status == 3
    assert "not checked: the proofs were not repeated: `--no-proofs`\n" in run.out


@pytest.mark.slow
@pytest.mark.parametrize("name", some(MADE, 3, 2))
def test_proofs_of_a_monitor_in_another_language_are_made_again(audited: Fretc, name: str) -> None:
    made = MADE[name]
    installed(TONGUES[name.lower()].program)
    assert audited("requirements/r1.fret", "--emit", made.emit, "-o", ".").status == 0
    verify = ("verify", "requirements/r1.fret", "--file", made.file)
    assert audited(*verify).status == 0
    run = audited("verify-evidence")
    assert run.status == 0
    assert "proofs\n  ✔ r1  stands: monitor: the monitor means what the sentence says\n" in run.out
    text = Path("build/verification.json").read_text()
    write("build/verification.json", text.replace(made.flags[0], "--other"))
    run = audited("verify-evidence")
    assert run.status == 3
    assert " --other" in run.out
    write("build/verification.json", text.replace('"proved"', '"counterexample"'))
    assert audited("verify-evidence").status == 1
    monitor = Path(made.file)
    monitor.write_text(f"{monitor.read_text()}\n", encoding="utf-8")
    assert audited(*verify).status == 0
    run = audited("verify-evidence")
    assert run.status == 3
    assert f"it is about `{made.artefacts[0]}`, which this check does not generate" in run.out


def test_a_proof_that_is_planned_and_is_not_there_is_missed(audited: Fretc) -> None:
    write("requirements/r1.fret", f'+++\nid = "r1"\nverify = ["audit", "loop", "desk"]\n+++\n{R1}')
    assert audited("audit", "logs", "-o", "build/evidence.json").status == 1
    run = audited("verify-evidence")
    assert run.status == 3
    assert "r1  not checked: r1 plans `loop` but the file has no proof of it\n" in run.out


@pytest.mark.slow
@pytest.mark.parametrize("chosen", [("--sample", "1"), ("--since", "1970-01-01"), ()])
def test_what_is_said_of_the_choice_of_logs_fits_the_runs(
    audited: Fretc, chosen: tuple[str, ...]
) -> None:
    assert audited("audit", "logs", "-o", "build/evidence.json", *chosen).status in (0, 1)
    assert audited("verify-evidence").status == 0
    known = json.loads(Path("build/evidence.json").read_text())
    selection = known.get("selection", {"named": 2, "older": 0, "audited": 2})
    whole = {"since": None, "sample_of": None, "seed": None, **selection}
    for name in ("named", "older", "sample_of", "seed", "audited"):
        values = (0, 1, 2, 3, None if name in ("sample_of", "seed") else 9)
        for other in some([value for value in values if value != whole[name]], 2):
            changed(selection={**whole, name: other})
            is_other_chance = name == "seed" and None not in (other, whole["seed"])
            assert audited("verify-evidence").status == (0 if is_other_chance else 1), name
