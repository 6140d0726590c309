"""Signals of words, from a log to evidence, report and JUnit: a word is always shown as a word."""

import json
from pathlib import Path

import pytest

from fretc.audit.evidence.reader import EvidenceFile, read
from tests.command import Fretc
from tests.command import write as put
from tests.fretc.logs.logs import MS, S, Sent, payload, write

BINDINGS = """
[clock]
tick = "100 ms"

[signal.mode]
path = "/mode.data"
values = ["drive", "docking"]

[signal.low]
path = "/low.data"

[proposition.low]
expr = "low"

[proposition.docks]
expr = "mode == 'docking'"
"""
STRING, BOOL = "std_msgs/msg/String", "std_msgs/msg/Bool"


def sent(words: list[str]) -> list[Sent]:
    found = []
    for i, word in enumerate(words):
        time = 1000 * S + i * 100 * MS
        found.append(Sent("/mode", STRING, payload(STRING, data=word), time))
        found.append(Sent("/low", BOOL, payload(BOOL, data=i == 2), time))
    return found


@pytest.fixture(autouse=True)
def project(fretc: Fretc) -> None:
    """A demand to dock within 300 ms, from 0.2 s on."""
    put("requirements/r.fret", "whenever low the agv shall within 300 milliseconds satisfy docks\n")
    put("requirements/bindings.toml", BINDINGS)


def audited(fretc: Fretc, words: list[str]) -> EvidenceFile:
    write(Path("log.mcap"), sent(words))
    fretc("audit", "log.mcap", "-o", "e.json")
    found = read("e.json")
    assert isinstance(found, EvidenceFile), found
    return found


def test_a_violation_shows_the_words_that_caused_it(fretc: Fretc) -> None:
    (result,) = audited(fretc, ["drive"] * 12).results
    assert (result.verdict, result.thresholds) == ("violated", ())
    (violation,) = result.violations
    assert violation.values == {"low": 0.0, "mode": "drive"}
    assert violation.window is not None
    assert {*violation.window.words["mode"].values} == {"drive"}
    assert {*violation.window.samples} == {"low"}
    assert fretc("report", "--evidence", "e.json", "--html", "r.html").status == 0
    page = Path("r.html").read_text("utf-8")
    assert "<code>mode</code> was &#34;drive&#34;, must be <code>docking</code>" in page
    assert "mode is &#34;drive&#34;." in page
    assert "<title>drive</title>" in page
    junit = fretc("audit", "log.mcap", "-o", "f.json", "--format", "junit").out
    assert 'mode = "drive"' in junit.replace("&quot;", '"')
    assert fretc("verify-evidence", "e.json").status == 0


def test_a_word_that_is_none_makes_nothing_true_and_nothing_false(fretc: Fretc) -> None:
    (result,) = audited(fretc, ["drive"] * 3 + ["parking"] * 9).results
    assert result.verdict == "no data"
    assert "F423" in {finding.code for finding in result.health.findings}


def test_a_demand_that_is_met_by_a_word_is_satisfied(fretc: Fretc) -> None:
    (result,) = audited(fretc, ["drive"] * 4 + ["docking"] * 8).results
    assert (result.verdict, result.latencies) == ("satisfied", (0.2,))


def test_evidence_of_words_is_refused_where_it_is_no_series(fretc: Fretc) -> None:
    audited(fretc, ["drive"] * 12)
    file = json.loads(Path("e.json").read_text("utf-8"))
    file["results"][0]["violations"][0]["window"]["words"]["mode"]["words"].pop()
    put("e.json", json.dumps(file))
    found = read("e.json")
    assert not isinstance(found, EvidenceFile)
    assert found.code.number == "F503"


def test_the_order_of_values_changes_nothing(fretc: Fretc) -> None:
    audited(fretc, ["drive"] * 12)
    put("requirements/bindings.toml", BINDINGS.replace('"drive", "docking"', '"docking", "drive"'))
    assert fretc("verify-evidence", "e.json").status == 0
