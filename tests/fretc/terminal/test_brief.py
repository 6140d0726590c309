"""Warnings about sentences are `check`'s matter: other commands count them in one line."""

import json
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.terminal import output
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.rendering import render
from tests.command import Fretc, write
from tests.fretc.logs.logs import TWELVE
from tests.fretc.logs.logs import write as record
from tests.fretc.report import cases

diagnostics = st.lists(
    st.builds(
        Diagnostic,
        st.sampled_from(Code),
        st.text("abc", min_size=1),
        severity=st.sampled_from(Severity),
    ),
    max_size=8,
)


@given(diagnostics)
def test_errors_are_never_shortened_and_each_warning_counts(given_: list[Diagnostic]) -> None:
    printed: list[str] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(output, "print_status", printed.append)
        output.print_project_diagnostics(given_, "requirements")
    text = "\n".join(printed)
    counted = 0
    for each in given_:
        if each.severity is Severity.WARNING and each.code.number.startswith("F2"):
            counted += 1
            assert f" {each.code.number}" in printed[-1]
        else:
            assert render(each) in text
    assert (
        sum(int(n) for n in re.findall(r"(\d+) F2\d\d", printed[-1] if counted else "")) == counted
    )


SENTENCES = {
    "R1": "when near the robot shall within 300 milliseconds satisfy stopped",
    "R2": "if near the robot shall within 300 milliseconds satisfy stopped",
    "R3": "before near the robot shall within 300 milliseconds satisfy stopped",
}
LINES = (
    "audit run.mcap",
    "report",
    "diff",
    "bind --check run.mcap",
    "lock --reviewer A --role B --comment c",
)


@pytest.mark.slow
@pytest.mark.parametrize("line", LINES)
def test_a_command_says_them_in_one_line_and_check_says_them_all(fretc: Fretc, line: str) -> None:
    for id, sentence in SENTENCES.items():
        write(f"req/{id}.fret", cases.requirement(id, sentence))
    write("req/bindings.toml", cases.BINDINGS)
    write("req/hazards.toml", cases.HAZARDS)
    record(Path("run.mcap"), TWELVE)
    run = fretc(*line.split(), "--requirements", "req")
    (brief,) = [one for one in run.err.splitlines() if "about sentences" in one]
    found = re.fullmatch(
        r"(\d+) warnings about sentences \((.*)\): see `fretc check --requirements req`", brief
    )
    assert found
    checked = json.loads(fretc("check", "--requirements", "req", "--format", "json").out)
    codes = [d["code"] for d in checked["diagnostics"] if d["code"].startswith("F2")]
    counts = sorted((code, codes.count(code)) for code in {*codes})
    assert int(found[1]) == len(codes)
    assert found[2] == ", ".join(f"{count} {code}" for code, count in counts)
    assert not re.search("^F2", run.err, re.MULTILINE)
