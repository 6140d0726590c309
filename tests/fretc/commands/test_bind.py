"""`fretc bind` as its users meet it."""

import json
import os
from pathlib import Path

import pytest

from tests.command import Fretc, Run
from tests.command import write as put
from tests.fretc.logs.logs import MS, TWELVE, X_TEXT, S, number, scan, write

R1 = '+++\nid = "R1"\n+++\nwhenever low the rover shall immediately satisfy high\n'
HIGH = '[proposition.high]\ntext = "not low"\nexpr = "x >= 8 cm"\n'


@pytest.fixture
def fretc(fretc: Fretc) -> Fretc:
    """A log with x from 0.00 to 0.11 m, a tenth of a second apart."""
    write(Path("run.mcap"), TWELVE)
    return fretc


def project(bindings: str = X_TEXT + HIGH) -> None:
    put("requirements/r1.fret", R1)
    put("requirements/bindings.toml", bindings)


# Drafts


def test_a_draft_is_printed_and_fills_in_what_the_requirements_name(fretc: Fretc) -> None:
    put("requirements/r1.fret", R1)
    run = fretc("bind", "--from", "run.mcap")
    assert (run.status, run.err) == (0, "")
    assert '[proposition.low]\ntext = ""\nexpr = "TODO: ' in run.out
    assert "[proposition.high]\n" in run.out
    assert "[signal.x]\n" in run.out
    project()
    assert "[proposition." not in fretc("bind", "--from", "run.mcap").out


def test_a_draft_goes_to_a_file_and_never_over_one(fretc: Fretc) -> None:
    run = fretc("bind", "--from", "run.mcap", "-o", "new/bindings.toml")
    assert run == Run(0, "", "wrote new/bindings.toml\n")
    text = Path("new/bindings.toml").read_text("utf-8")
    Path("new/bindings.toml").write_text("mine", "utf-8")
    refused = fretc("bind", "--from", "run.mcap", "-o", "new/bindings.toml")
    assert refused == Run(
        2,
        "",
        "F905 `new/bindings.toml` already exists\n"
        "help: name another file with `-o`, or overwrite it with `--force`\n",
    )
    assert Path("new/bindings.toml").read_text("utf-8") == "mine"
    assert fretc("bind", "--from", "run.mcap", "-o", "new/bindings.toml", "--force").status == 0
    assert Path("new/bindings.toml").read_text("utf-8") == text


def test_an_update_adds_what_is_missing_and_keeps_each_byte(fretc: Fretc) -> None:
    own = f"# mine\r\n{X_TEXT}{HIGH}\n\n# the end"
    project(own)
    put("requirements/r2.fret", "the rover shall always satisfy x < 1 m & battery > 2 | ready\n")
    before = Path("requirements/bindings.toml").read_bytes()
    run = fretc("bind", "--from", "run.mcap", "--update")
    assert (run.status, run.out, run.err) == (0, "", "wrote requirements/bindings.toml\n")
    after = Path("requirements/bindings.toml").read_bytes()
    assert after.startswith(before.rstrip(b"\n"))
    added = after[len(before) :].decode()
    assert [line for line in added.splitlines() if line.startswith("[")] == [
        "[proposition.ready]",
        "[signal.battery]",
    ]
    again = fretc("bind", "--from", "run.mcap", "--update")
    assert "nothing to add" in again.err
    assert Path("requirements/bindings.toml").read_bytes() == after


def test_an_update_takes_the_signal_that_a_draft_has_under_that_name(fretc: Fretc) -> None:
    project(X_TEXT)
    messages = [m for i in range(12) for m in (number(i, S + i * 100 * MS, "/volts"),)]
    write(Path("other.mcap"), messages)
    put("requirements/r1.fret", "the rover shall always satisfy volts < 12\n")
    assert fretc("bind", "--from", "other.mcap", "--update").status == 0
    assert "[signal.volts]\n" in Path("requirements/bindings.toml").read_text("utf-8")
    assert fretc("audit", "other.mcap").status == 0


def test_an_update_needs_bindings_and_a_log(fretc: Fretc) -> None:
    put("requirements/r1.fret", R1)
    assert fretc("bind", "--update").status == 2
    run = fretc("bind", "--from", "run.mcap", "--update")
    assert (run.status, "there are no bindings to update" in run.err) == (2, True)
    project("[clock\n")
    before = Path("requirements/bindings.toml").read_bytes()
    assert fretc("bind", "--from", "run.mcap", "--update").status == 2
    assert Path("requirements/bindings.toml").read_bytes() == before


def test_a_draft_with_open_propositions_can_be_made_anew(fretc: Fretc) -> None:
    put("requirements/r1.fret", R1)
    where = ("-o", "requirements/bindings.toml")
    assert fretc("bind", "--from", "run.mcap", *where).status == 0
    check = fretc("bind", "--check", "run.mcap")
    assert (check.status, check.err.count("F308")) == (2, 2)
    assert 'expr = "TODO: when is it true?' in check.err
    assert fretc("bind", "--from", "run.mcap", *where, "--force").status == 0
    assert fretc("bind", "--from", "run.mcap").status == 2


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ((), "F907"),
        (("run.mcap",), "F907"),
        (("--from", "run.mcap", "--check"), "F907"),
        (("--from", "run.mcap", "run.mcap"), "F907"),
        (("--from", "no.mcap"), "F901"),
        (("--from", "text"), "F402"),
        (("--from", "run.mcap", "--requirements", "nowhere"), "F901"),
        (("--from", "run.mcap", "--bindings", "no.toml"), "F901"),
        (("--from", "run.mcap", "-o", "run.mcap", "--force"), "F905"),
        (("--check",), "F909"),
        (("--check", "run.mcap"), "F909"),
        (("--check", "run.mcap", "--bindings", "no.toml"), "F901"),
    ],
)
def test_bad_use_is_told_and_writes_nothing(
    fretc: Fretc, arguments: tuple[str, ...], code: str
) -> None:
    put("text", "no log at all")
    before = Path("run.mcap").read_bytes()
    run = fretc("bind", *arguments)
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith(f"{code} ")
    assert Path("run.mcap").read_bytes() == before
    assert sorted(os.listdir()) == ["run.mcap", "text"]


# Checks


def test_a_check_tells_what_each_proposition_was(fretc: Fretc) -> None:
    project()
    assert fretc("bind", "--check", "run.mcap") == Run(
        0,
        "✔ low: x < 5 cm\n"
        "    x = /x.data m\n"
        "  run.mcap  true 5, false 7, unknown 0 of 12 ticks; changed 1 time\n"
        "✔ high: x >= 8 cm\n"
        "    x = /x.data m\n"
        "  run.mcap  true 4, false 8, unknown 0 of 12 ticks; changed 1 time\n"
        "✔ phase of the ticks: no verdict depends on it\n",
        "",
    )


def test_a_proposition_that_took_one_value_only_is_told_and_is_status_3(fretc: Fretc) -> None:
    project(X_TEXT + HIGH.replace("8 cm", "8 m"))
    run = fretc("bind", "--check", "run.mcap")
    assert run.status == 3
    assert (
        "? high: x >= 8 m\n"
        "    x = /x.data m\n"
        "  run.mcap  true 0, false 12, unknown 0 of 12 ticks; changed 0 times\n"
    ) in run.out
    assert run.err.startswith(
        "F314 note: `high` never changed in the log: it was false at 12 ticks\n"
        "  --> requirements/bindings.toml:"
    )
    assert run.err.count("F314") == 1


def test_one_log_in_which_it_changed_is_enough_and_each_is_told(fretc: Fretc) -> None:
    project()
    write(Path("still.mcap"), [number(1.0, S + i * 100 * MS) for i in range(4)])
    run = fretc("bind", "--check", "run.mcap", "still.mcap")
    assert (run.status, run.err) == (0, "")
    assert run.out.splitlines()[2:5] == [
        "  run.mcap    true 5, false 7, unknown 0 of 12 ticks; changed 1 time",
        "  still.mcap  true 0, false 4, unknown 0 of 4 ticks; changed 0 times",
        "  all logs    true 5, false 11, unknown 0 of 16 ticks; changed 1 time",
    ]
    alone = fretc("bind", "--check", "still.mcap")
    assert alone.status == 3
    assert alone.err.count("F314") == 2


def test_a_log_that_cannot_be_read_is_status_2_and_the_others_are_told(fretc: Fretc) -> None:
    project()
    put("bad.mcap", "no log at all")
    run = fretc("bind", "--check", "bad.mcap", "run.mcap")
    assert run.status == 2
    assert run.err.startswith("F402 ")
    assert "  bad.mcap  cannot be read\n" in run.out
    assert "  run.mcap  true 5, " in run.out


def test_a_topic_that_is_missing_is_unknown_and_bad_input_as_in_an_audit(fretc: Fretc) -> None:
    project(X_TEXT.replace("/x.data", "/y.data") + HIGH)
    run = fretc("bind", "--check", "run.mcap")
    assert run.status == fretc("audit", "run.mcap").status == 2
    assert "true 0, false 0, unknown 12 of 12 ticks" in run.out
    assert "F405" in run.err


def test_an_unbound_proposition_of_a_requirement_is_bad_input(fretc: Fretc) -> None:
    project(X_TEXT)
    run = fretc("bind", "--check", "run.mcap")
    assert run.status == 2
    assert "F304 `high` of R1 has no binding" in run.err


def test_bindings_can_be_checked_without_requirements(fretc: Fretc) -> None:
    put("b.toml", X_TEXT)
    assert fretc("bind", "--check", "run.mcap", "--bindings", "b.toml").status == 0
    put("none.toml", '[clock]\ntick = "1 s"\n')
    run = fretc("bind", "--check", "run.mcap", "--bindings", "none.toml")
    assert run.status == 2
    assert run.err.startswith("F909 `none.toml` declares no proposition")


def test_json_holds_the_same_and_two_processes_change_nothing(fretc: Fretc) -> None:
    project()
    write(Path("still.mcap"), [number(1.0, S + i * 100 * MS) for i in range(4)])
    put("bad.mcap", "no log at all")
    logs = ("run.mcap", "still.mcap", "bad.mcap")
    run = fretc("bind", "--check", *logs, "--format", "json", "--jobs", "1")
    assert fretc("bind", "--check", *logs, "--format", "json", "--jobs", "2") == run
    told = json.loads(run.out)
    assert [(log["run"], log["read"], log["ticks"]) for log in told["logs"]] == [
        ("run.mcap", True, 12),
        ("still.mcap", True, 4),
        ("bad.mcap", False, 0),
    ]
    assert told["logs"][2]["findings"][0]["code"] == "F402"
    low, high = told["propositions"]
    assert low == {
        "name": "low",
        "expression": "x < 5 cm",
        "signals": {"x": "/x.data"},
        "took_both_values": True,
        "all": {"true": 5, "false": 11, "unknown": 0, "changes": 1},
        "logs": {
            "run.mcap": {"true": 5, "false": 7, "unknown": 0, "changes": 1},
            "still.mcap": {"true": 0, "false": 4, "unknown": 0, "changes": 0},
        },
    }
    assert high["name"] == "high"


# Findings that an audit and a check share


def test_drift_blind_zones_and_slow_topics_are_told_by_both(fretc: Fretc) -> None:
    scans = [scan([1.0, 2.0], 1000 * S + i * 300 * MS, range_min=0.2) for i in range(6)]
    write(Path("scan.mcap"), scans)
    put(
        "requirements/r1.fret",
        '+++\nid = "R1"\nparams = { low = "0.06 m" }\n+++\nthe rover shall always satisfy !low\n',
    )
    bindings = X_TEXT.replace("/x.data", "/scan.ranges[:]").replace(
        "max_age", 'reduce = "min"\nmax_age'
    )
    put("requirements/bindings.toml", bindings)
    for command in (("bind", "--check"), ("audit",)):
        run = fretc(*command, "scan.mcap")
        codes = [line.split()[0] for line in run.err.splitlines() if line.startswith("F")]
        assert sorted(codes) == ["F310", "F311", "F314", "F318"], command
    put(
        "requirements/r1.fret",
        Path("requirements/r1.fret").read_text("utf-8").replace("0.06 m", "50 mm"),
    )
    assert "F310" not in fretc("audit", "scan.mcap").err


def test_what_never_changed_is_told_once_over_all_logs_of_an_audit(fretc: Fretc) -> None:
    project(X_TEXT + HIGH.replace("8 cm", "8 m"))
    write(Path("still.mcap"), [number(1.0, S + i * 100 * MS) for i in range(4)])
    run = fretc("audit", "run.mcap", "still.mcap", "--jobs", "2")
    assert run.err.count("F314") == 1
    assert "`high` never changed in any of 2 logs: it was false at 16 ticks" in run.err


def test_what_a_sentence_compares_itself_is_checked_like_a_proposition(fretc: Fretc) -> None:
    """In its own words, and in no other numbers than the proposition that says the same."""
    put("requirements/r1.fret", '+++\nid = "R1"\n+++\nthe rover shall always satisfy x < 5 cm\n')
    signals = X_TEXT[: X_TEXT.index("[proposition")]
    put("requirements/bindings.toml", signals)
    alone = fretc("bind", "--check", "run.mcap", "--format", "json")
    (compared,) = json.loads(alone.out)["propositions"]
    put("requirements/bindings.toml", f'{signals}[proposition.p]\nexpr = "x < 5 cm"\n')
    put("requirements/r1.fret", "the rover shall always satisfy p")
    named = fretc("bind", "--check", "run.mcap", "--format", "json")
    (bound,) = json.loads(named.out)["propositions"]
    assert (alone.status, compared["took_both_values"]) == (named.status, True) == (0, True)
    assert (compared["all"], compared["signals"]) == (bound["all"], bound["signals"])
    assert "x < " in compared["expression"]
