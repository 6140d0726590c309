"""How far an audit is, where standard error is a terminal."""

import io
import shutil
import sys
from pathlib import Path

import pytest

from fretc.terminal.progress import progress
from fretc.verification.layers import dafny as layer_dafny
from tests.command import Fretc, write

ROOT = Path(__file__).parents[3]


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_bar_tells_the_part_and_the_words(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress(200, "working") as tell:
        tell(50, "a quarter")
        tell(200, "all")
    shown = terminal.getvalue()
    assert shown.count("working") == 3
    assert "25%" in shown
    assert "a quarter" in shown
    assert "100%  all" in shown


def test_nothing_is_shown_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    file = io.StringIO()
    monkeypatch.setattr(sys, "stderr", file)
    with progress(200, "working") as tell:
        tell(50, "a quarter")
    assert file.getvalue() == ""


@pytest.mark.slow
def test_an_audit_counts_the_bytes_of_its_logs(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(ROOT / "requirements", "requirements")
    whole = (ROOT / "traces/mission-seed15.mcap").read_bytes()
    Path("a.mcap").write_bytes(whole)
    Path("b.mcap").write_bytes(whole[: len(whole) // 3])
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    fretc("audit", "a.mcap", "b.mcap", "no.mcap", "--jobs", "1")
    shown = terminal.getvalue()
    places = [shown.index(words) for words in (" 74%", "1/3 logs, 2/2 MB", "3/3 logs, 2/2 MB")]
    assert places == sorted(places)
    assert "auditing" in shown


def test_a_proof_tells_what_it_is_at(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write("r1.fret", "whenever p the sw shall within 2 ticks satisfy q")
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    options = ("--layer", "loop", "--layer", "agent", "--layer", "bounds", "--with", "dafny")
    monkeypatch.setattr(layer_dafny, "with_dafny", lambda *_, **__: ())
    fretc("verify", path, *options, "-o", "-")
    assert terminal.getvalue().splitlines() == [
        "r1: loop",
        "r1: bounds",
        "r1: Dafny",
        "agent: its properties",
    ]


def test_a_proof_tells_nothing_of_that_elsewhere(fretc: Fretc) -> None:
    path = write("r1.fret", "whenever p the sw shall within 2 ticks satisfy q")
    assert fretc("verify", path, "--layer", "loop", "-o", "-").err == ""


def test_a_single_log_needs_no_bar(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    shutil.copytree(ROOT / "requirements", "requirements")
    monkeypatch.setattr(sys, "stderr", terminal)
    fretc("audit", "no.mcap")
    assert "auditing" not in terminal.getvalue()
