"""`fretc trends` as its users meet it: what it prints, what it writes, what it exits with."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from fretish.diagnostics.diagnostic import Diagnostic
from tests.command import Fretc, Run, write
from tests.fretc.trends.nights import document, evidence, judged
from tests.stores import write_document

ROOT = Path(__file__).parents[3]
MISSION = ROOT / "traces/mission-seed15.mcap"


def test_a_new_violation_is_told_and_is_the_exit_status(fretc: Fretc) -> None:
    evidence(Path("1.json"), judged("a.mcap"), judged("b.mcap", requirement="R2"))
    evidence(
        Path("2.json"),
        judged("a.mcap", "violated", night=1),
        judged("b.mcap", "no data", "R2", night=1),
    )
    assert fretc("trends", "1.json", "2.json") == Run(
        1,
        "2 rounds, 4 runs, 2 requirements, 2 scenarios; a round is each evidence\n"
        "newest: 2.json (2025-11-09, 2 runs)\n"
        "rounds are ordered by time (label `date`, else start of the logs); `fretc audit\n"
        "  --label date=...` decides\n"
        "\n"
        "✘ 1 newly violated\n"
        "    R1            a.mcap                  ✔✘  violated\n"
        "\n"
        "? 1 decided before, undecided now\n"
        "    R2            b.mcap                  ✔?  no data\n"
        "\n"
        "0 shown as before, 0 never shown; 0 flaky in all\n"
        "latencies and margins, the newest round against the rounds before it: 0\n"
        "  regressed, 0 no worse than chance, 0 with too few runs to tell\n",
        "",
    )


def test_the_page_has_titles_of_requirements_and_replaces_none_of_their_files(
    fretc: Fretc,
) -> None:
    evidence(Path("1.json"), judged("a.mcap"))
    assert fretc("trends", "1.json", "--html", "t.html").status == 3
    assert "Stop in time" not in Path("t.html").read_text("utf-8")
    missing = fretc("trends", "1.json", "--html", "n.html", "--requirements", "none")
    assert (missing.status, missing.err.partition("\n")[0]) == (
        2,
        "F901 there is no folder `none`",
    )
    assert not Path("n.html").exists()
    write("none/r1.fret", '+++\nid = "R1"\ntitle = "Stop in time"\n+++\nr shall always satisfy p')
    named = ("--requirements", "none", "--html")
    assert fretc("trends", "1.json", *named, "t.html").status == 3
    assert "Stop in time" in Path("t.html").read_text("utf-8")
    assert fretc("trends", "1.json", *named, "none/r1.fret").status == 2
    assert "Stop in time" in Path("none/r1.fret").read_text("utf-8")


def test_the_exit_status_says_whether_something_is_worse_lost_or_incomparable(
    fretc: Fretc,
) -> None:
    def status(before: str, now: str) -> int:
        evidence(Path("1.json"), judged("a.mcap", before))
        evidence(Path("2.json"), judged("a.mcap", now, night=1))
        return fretc("trends", "1.json", "2.json").status

    assert status("satisfied", "satisfied") == 0
    assert status("violated", "satisfied") == 0
    assert status("violated", "violated") == 0
    assert status("satisfied", "violated") == 1
    assert status("no data", "violated") == 1
    assert status("violated", "no data") == 3
    assert fretc("trends", "1.json").status == 1  # what was never judged before is violated
    evidence(Path("1.json"), judged("a.mcap"))
    run = fretc("trends", "1.json")
    assert run.status == 3
    assert "F560" in run.err
    evidence(Path("2.json"), judged("other.mcap", night=1))
    assert fretc("trends", "1.json", "2.json").status == 3


def test_bad_input_is_one_diagnostic_each_and_writes_nothing(fretc: Fretc) -> None:
    evidence(Path("1.json"), judged("a.mcap"))
    Path("bad.json").write_text("{}")
    run = fretc("trends", "1.json", "bad.json", "none.json", "--html", "t.html")
    assert run.status == 2
    assert [line[:4] for line in run.err.splitlines() if line[:1] == "F"] == ["F901", "F503"]
    assert not Path("t.html").exists()
    assert fretc("trends", "1.json", "--by", "robot").err.startswith("F560 ")
    assert fretc("trends", "1.json", "--by", "robot").status == 2
    before = Path("1.json").read_bytes()
    assert fretc("trends", "1.json", "--html", "1.json").status == 2
    assert Path("1.json").read_bytes() == before


def test_a_store_says_what_a_file_says_and_a_broken_one_says_nothing(fretc: Fretc) -> None:
    nights = [
        [judged(f"{run}.mcap", night=night, late=[0.1], margin=0.2, v="1") for run in range(3)]
        for night in range(2)
    ]
    for night, results in enumerate(nights):
        evidence(Path(f"{night}.json"), *results)
        assert not isinstance(write_document(Path(f"{night}"), document(results)), Diagnostic)
    files = fretc("trends", "0.json", "1.json", "--format", "json", "--html", "files.html")
    stores = fretc("trends", "0", "1", "--format", "json", "--html", "stores.html")
    assert json.loads(stores.out)["items"] == json.loads(files.out)["items"]
    assert json.loads(stores.out)["comparisons"] == json.loads(files.out)["comparisons"]
    table = Path("1/evidence.sqlite")
    table.write_bytes(table.read_bytes()[:-4096])
    broken = fretc("trends", "0", "1", "--html", "broken.html")
    assert broken.status == 2
    assert broken.err.startswith("F516 ")
    assert not Path("broken.html").exists()


@pytest.mark.slow
def test_many_changes_fit_one_screen_and_what_is_left_out_is_counted(fretc: Fretc) -> None:
    names = [f"{i}.mcap" for i in range(300)]
    evidence(Path("1.json"), *(judged(name, scenario=name) for name in names))
    now = [judged(name, "violated", night=1, scenario=name) for name in names[:250]]
    evidence(Path("2.json"), *now)
    run = fretc("trends", "1.json", "2.json")
    lines = run.out.splitlines()
    assert len(lines) <= 40
    assert max(map(len, lines)) <= 80
    assert "✘ 250 newly violated" in lines
    assert "    and 242 more, of R1: see --html or --format json" in lines
    assert "? 50 gone: judged before, not in the newest round" in lines
    items = json.loads(fretc("trends", "1.json", "2.json", "--format", "json").out)["items"]
    assert sum(item["change"] == "new" for item in items) == 250


def test_texts_of_a_stranger_do_not_reach_the_terminal(fretc: Fretc) -> None:
    hostile = "\x1b[31m\u202edoor\n\n" + "x" * 180
    evidence(Path("1.json"), judged("a.mcap", scenario=hostile, version="\x07"))
    evidence(Path("2.json"), judged("a.mcap", "violated", night=1, scenario=hostile))
    run = fretc("trends", "1.json", "2.json")
    assert run.status == 1
    assert not {*"\x1b\x07\u202e"} & {*run.out}
    assert max(map(len, run.out.splitlines())) <= 80


def test_evidence_with_a_label_that_no_audit_writes_is_refused(fretc: Fretc) -> None:
    text = Path(evidence(Path("1.json"), judged("a.mcap", scenario="door"))).read_text("utf-8")
    for label in ('"door"', '"scenario": '):
        assert label in text
    for wrong in (f'"{"x" * 10**6}"', '""', "3"):
        Path("1.json").write_text(text.replace('"door"', wrong), "utf-8")
        run = fretc("trends", "1.json")
        assert run.status == 2
        assert run.err.startswith("F503 ")


@pytest.mark.slow
def test_labels_go_from_the_command_and_the_path_into_the_evidence(fretc: Fretc) -> None:
    shutil.copytree(ROOT / "requirements", "requirements")
    with Path("requirements/bindings.toml").open("a", encoding="utf-8") as file:
        file.write('\n[run.label]\nseed = "path:{scenario}-seed{seed}.mcap"\n')
    shutil.copy(MISSION, "hall-seed15.mcap")
    fretc("audit", "hall-seed15.mcap", "--label", "version=2.1")
    (result,) = json.loads(Path("build/evidence.json").read_text())["results"]
    assert result["labels"] == {"seed": "15", "version": "2.1"}
    again = ("verify-evidence", "--no-proofs")
    assert "it differs in labels" in fretc(*again).out
    assert fretc(*again, "--label", "version=2.1").status == 0
    Path("moved").mkdir()
    Path("hall-seed15.mcap").rename("moved/hall-seed15.mcap")
    assert fretc(*again, "--label", "version=2.1", "--logs", "moved").status == 0
    forged = Path("build/evidence.json").read_text().replace('"seed": "15"', '"seed": "16"')
    Path("build/evidence.json").write_text(forged)
    assert fretc(*again, "--label", "version=2.1", "--logs", "moved").status == 1


def test_a_label_that_is_none_stops_an_audit_before_it_begins(fretc: Fretc) -> None:
    run = fretc("audit", "none.mcap", "--label", "version")
    assert run.status == 2
    assert run.err.startswith("F551 `--label version` is no label")
