"""`fretc verify-evidence`: evidence made again from its logs, and compared."""

import json
import shutil
from pathlib import Path

import pytest

from tests.command import Fretc, write
from tests.monitors.logs import MS, X_TEXT, number
from tests.monitors.logs import write as write_log

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
    write("requirements/r1.fret", R1)
    write("requirements/bindings.toml", BINDINGS)
    log("logs/good.mcap", 0, 1.5, 3, 0, 0, 0)
    log("logs/bad.mcap", 0, 1.5, 0, 0, 0, 0)
    assert fretc("audit", "logs").status == 1
    return fretc


def test_evidence_that_nobody_touched_stands(audited: Fretc) -> None:
    run = audited("verify-evidence")
    assert (run.status, run.err) == (0, "")
    assert run.out == "logs/bad.mcap\n  ✔ r1  stands\nlogs/good.mcap\n  ✔ r1  stands\n"


@pytest.mark.parametrize("looked", ["index", "full"])
def test_how_much_of_a_log_was_looked_at_is_no_difference(audited: Fretc, looked: str) -> None:
    assert audited("audit", "logs", "--integrity", looked).status == 1
    assert audited("verify-evidence").status == 0


def test_a_verdict_that_was_changed_by_hand_is_found(audited: Fretc) -> None:
    text = Path("build/evidence.json").read_text()
    write("build/evidence.json", text.replace('"violated"', '"satisfied"'))
    run = audited("verify-evidence")
    assert run.status == 1
    assert run.out == (
        "logs/bad.mcap\n"
        "  ✘ r1  differs: the verdict is violated, and was satisfied; "
        "it differs in phases, states\n"
        "logs/good.mcap\n"
        "  ✔ r1  stands\n"
    )


def test_another_log_under_the_same_name_is_found(audited: Fretc) -> None:
    log("logs/bad.mcap", 0, 1.5, 3, 0, 0, 0)
    run = audited("verify-evidence")
    assert run.status == 1
    assert "differs: the log has changed; the verdict is satisfied, and was violated" in run.out


@pytest.mark.slow
@pytest.mark.parametrize("looked", ["index", "hash", "full"])
def test_another_log_of_the_same_verdicts_is_found(audited: Fretc, looked: str) -> None:
    assert audited("audit", "logs", "--integrity", looked).status == 1
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
    assert audited("audit", "others", "--evidence", "other.json").status == 0
    other = json.loads(Path("other.json").read_text())
    known["results"][0]["hashes"]["log"] = other["results"][0]["hashes"]["log"]
    write("build/evidence.json", json.dumps(known))
    run = audited("verify-evidence")
    assert run.status == 1
    assert "the log has changed" not in run.out
    assert "the verdict is satisfied, and was violated" in run.out


def test_another_binding_is_found(audited: Fretc) -> None:
    write("requirements/bindings.toml", BINDINGS.replace("x > 2 m", "x > 2.5 m"))
    run = audited("verify-evidence")
    assert run.status == 1
    assert "what the bindings say has changed" in run.out


def changed(**fields: object) -> None:
    known = json.loads(Path("build/evidence.json").read_text())
    write("build/evidence.json", json.dumps({**known, **fields}))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("field", "value", "told"),
    [
        ("fretc", "0.0.1", "differs: this is fretc 0.1.0"),
        ("bindings", {"file": "x", "sha256": "0"}, "differs: what the bindings say has changed"),
        ("requirements", [], "differs: the file does not name it among its requirements"),
        ("requirements", [{"id": "r1", "sentence": "x", "sha256": "0"}], "sentence has changed"),
        ("requirements", [{"id": "r2"}], "r2  differs: it is not claimed any more"),
        ("probabilities", [], None),
    ],
)
def test_what_the_file_says_before_its_results_is_compared(
    audited: Fretc, field: str, value: object, told: str | None
) -> None:
    changed(**{field: value})
    run = audited("verify-evidence")
    assert run.status == (0 if told is None else 1)
    assert (told or "") in run.out


def test_a_result_that_was_taken_out_is_found(audited: Fretc) -> None:
    write("requirements/r2.fret", "whenever p the sw shall within 3 ticks satisfy q")
    assert audited("audit", "logs").status == 1
    results = json.loads(Path("build/evidence.json").read_text())["results"]
    worst = next(i for i, one in enumerate(results) if one["verdict"] == "violated")
    del results[worst]
    changed(results=results)
    run = audited("verify-evidence")
    assert run.status == 1
    assert "✘ r1  differs: its result is left out\n" in run.out


def test_a_result_that_is_told_twice_is_found(audited: Fretc) -> None:
    results = json.loads(Path("build/evidence.json").read_text())["results"]
    changed(results=[*results, results[0]])
    assert "✘ r1  differs: it is told twice\n" in audited("verify-evidence").out


def test_the_name_of_a_run_cannot_write_on_the_terminal(audited: Fretc) -> None:
    results = json.loads(Path("build/evidence.json").read_text())["results"]
    changed(results=[{**one, "run": "\x1b[2K\u202e.mcap"} for one in results[:1]])
    assert audited("verify-evidence").out.startswith("\\x1b[2K\\u202e.mcap\n  ? r1")


def test_evidence_of_no_run_shows_nothing(audited: Fretc) -> None:
    changed(results=[])
    run = audited("verify-evidence")
    assert run.status == 3
    assert "not checked: it tells of no run" in run.out


def test_a_log_that_is_gone_is_not_checked(audited: Fretc) -> None:
    Path("logs/good.mcap").unlink()
    run = audited("verify-evidence")
    assert run.status == 3
    assert "  ? r1  not checked: its log is not found\n" in run.out


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
    assert "differs: it is not claimed any more" in run.out


def test_a_report_is_made_again_and_compared(audited: Fretc) -> None:
    assert audited("report").status == 0
    run = audited("verify-evidence", "--report", "build/report.html")
    assert (run.status, run.out.splitlines()[-1]) == (0, "✔ report  the same, byte for byte")
    page = Path("build/report.html").read_text()
    write("build/report.html", page.replace("violated", "satisfied", 1))
    run = audited("verify-evidence", "--report", "build/report.html", "--format", "json")
    assert run.status == 1
    assert json.loads(run.out)["report_is_the_same"] is False


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("no.json",), "F901 there is no file `no.json`"),
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
    assert f"{place}\n  ? r1  not checked: its log is not found\n" in run.out


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
