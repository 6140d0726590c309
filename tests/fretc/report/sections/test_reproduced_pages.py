"""The printed commands make the page again, byte for byte, from a copy of the project."""

import json
import shlex
import shutil
from pathlib import Path

import pytest

from tests.command import Fretc, write
from tests.effort import FULL, pairwise
from tests.fretc.logs.logs import MS, X_TEXT, number
from tests.fretc.logs.logs import write as write_log

LOOSE = "whenever p the sw shall within 2 ticks satisfy q"
TIGHT = "when p the sw shall within 1 ticks satisfy q"
ROLES = ('role = "input"', 'role = "output"')
BINDINGS = (
    X_TEXT.replace("[proposition.low]", '[proposition.low]\nrole = "input"')
    + f'\n[proposition.p]\nexpr = "x > 1 m"\nagg = "last"\n{ROLES[0]}\n'
    + f'\n[proposition.q]\nexpr = "x > 2 m"\nagg = "last"\n{ROLES[1]}\n'
)
WAIVER = """
["R1"]
verdict = "violated"
reason = "The test stand has no brake."
by = "Ada"
role = "safety engineer"
granted = "2026-01-01"
expires = "2999-12-31"
"""
AXES = (
    ("none", "default", "--as-fret", "one file"),
    ("none", "default", "--monitor", "one file"),
    ("", "--play"),
    ((), ("--label", "site=hall 7"), ("--integrity", "index"), ("--integrity", "full")),
    ("beside", "elsewhere"),
    ("none", "waivers", "lock"),
    ("evidence.json", "evidence"),
    ("", "4070908800"),
)
"""Analysis, verification, play, options of the audit, the place of the bindings and of the other
files, reviews, the form of the evidence, and `SOURCE_DATE_EPOCH`."""
COMBINATIONS = pairwise(*AXES)[:: 17 if FULL else 1]
"""All 3 072 would take two CPU hours; every seventeenth holds any three choices."""


def project(place: str) -> list[str]:
    """Write a project with two logs; the options that name its bindings and hazards."""
    for number_, text in enumerate((LOOSE, TIGHT), 1):
        header = f'+++\nid = "R{number_}"\ntitle = "T{number_}"\nparents = ["HAZ-1"]\n+++\n'
        write(f"req/r{number_}.fret", header + text + "\n")
    folder = "req" if place == "beside" else "other"
    write(f"{folder}/bindings.toml", BINDINGS)
    write(f"{folder}/hazards.toml", '["HAZ-1"]\ntitle = "It falls"\nseverity = "serious"\n')
    for name, values in (("a b", (0, 1.5, 3, 0, 0, 0)), ("bad", (0, 1.5, 0, 0, 0, 0))):
        Path("logs").mkdir(exist_ok=True)
        sent = [number(v, 10**9 + i * 100 * MS) for i, v in enumerate(values)]
        write_log(Path(f"logs/{name}.mcap"), sent)
    return [] if place == "beside" else ["--bindings", f"{folder}/bindings.toml"]


@pytest.mark.slow
@pytest.mark.parametrize("chosen", COMBINATIONS, ids=lambda chosen: " ".join(map(str, chosen)))
def test_the_printed_commands_make_the_same_page_in_another_folder(
    fretc: Fretc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, chosen: tuple[str, ...]
) -> None:
    analysis, verification, play, audit, place, reviews, form, epoch = chosen
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    bound = project(place)
    of = ["--requirements", "req", *bound]
    evidence = f"out/{form}"
    assert fretc("audit", "logs", *of, *audit, "-o", evidence).status == 1
    if analysis != "none":
        which = ["req/r1.fret", *bound] if analysis == "one file" else of
        extra = [analysis] if analysis.startswith("--") else []
        fretc("analyze", *which, *extra, "-o", "out/analysis.json")
    if verification != "none":
        which = ["req/r1.fret", *bound] if verification == "one file" else of
        extra = [verification] if verification.startswith("--") else []
        fretc("verify", *which, *extra, "-o", "out/proofs.json")
    copied = ["req", "other", "logs"]
    options = [*of, "--evidence", evidence, *([play] if play else [])]
    options += ["--analysis", "out/analysis.json"] if analysis != "none" else []
    options += ["--verification", "out/proofs.json"] if verification != "none" else []
    if place != "beside":
        options += ["--hazards", "other/hazards.toml"]
    if reviews == "waivers":
        write("other/waivers.toml" if place != "beside" else "req/waivers.toml", WAIVER)
        options += ["--waivers", "other/waivers.toml"] if place != "beside" else []
    if reviews == "lock":
        accept = ["--reviewer", "Ada", "--role", "QA", "--comment", "fine", "--accept-violations"]
        files = ["--hazards", "other/hazards.toml"] if place != "beside" else []
        there = ["--lock", "other/fretc.lock"] if place != "beside" else []
        run = fretc("lock", *of, "--evidence", evidence, *accept, *files, *there)
        assert run.status == 0, run.err
        options += there
    if epoch:
        monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
    first = fretc("report", *options, "--html", "one.html", "--json", "one.json")
    assert Path("one.html").exists(), first.err
    commands = json.loads(Path("one.json").read_text(encoding="utf-8"))["commands"]
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    again = tmp_path / "again"
    for name in copied:
        if Path(name).exists():
            shutil.copytree(name, again / name)
    page = Path("one.html").read_text(encoding="utf-8")
    monkeypatch.chdir(again)
    for command in commands:
        words = shlex.split(command["text"], comments=True)
        if words[0].startswith("SOURCE_DATE_EPOCH="):
            monkeypatch.setenv(*words.pop(0).split("=", 1))
        if words[0] == "fretc" and "--version" not in words:
            run = fretc(*words[1:])
            assert run.status in (0, 1, 3), (command, run.err)
    made = Path("build/report.html").read_text(encoding="utf-8")
    assert [*made.splitlines()] == [*page.splitlines()]
    assert made == page
