"""A mistake in one table of the bindings refuses the requirements that read it, and no others."""

import csv
import io
import json
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.emit import TARGETS
from compiler.project.folder import load
from compiler.project.project import Project
from fretc.audit.bindings.needs import missing_propositions
from fretc.audit.plan import Plan, planned
from fretc.audit.project_inputs import all_verdict_inputs
from fretc.terminal.output import EXIT_OK, EXIT_USAGE, EXIT_VIOLATION
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source
from tests.command import Fretc, made_once, write
from tests.effort import FULL, some
from tests.fretc.logs.logs import MS, S, said
from tests.fretc.logs.logs import write as write_log

BINDINGS = """\
[clock]
tick = "100 ms"

[signal.ax]
path = "/a.x"
unit = "m"

[signal.ay]
path = "/a.y"
unit = "m"

[signal.bx]
path = "/b.x"
unit = "m/s"

[proposition.low]
expr = "ax < 3 m"

[proposition.near]
expr = "ax < 9 m and ay < 9 m"

[proposition.slow]
expr = "bx < 3 m/s"

[proposition.still]
expr = "abs(bx) < 9 m/s for 100 ms"

[proposition.idle]
expr = "ay < 0 m"
"""
SENTENCES = {
    "R1": "the sw shall always satisfy low",
    "R2": "the sw shall always satisfy near",
    "R3": "the sw shall always satisfy slow",
    "R4": "whenever low the sw shall within 200 milliseconds satisfy still",
    "R5": "the sw shall never satisfy slow & near",
    "R6": "the sw shall always satisfy true",
}
TABLES = [
    (kind, name) for kind in ("signal", "proposition") for name in tomllib.loads(BINDINGS)[kind]
]
BREAKS: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "signal": {
        "F302": {"untis": "m"},
        "F303 no path": {"path": "/a"},
        "F303 a number for a path": {"path": 3},
        "F303 an array without reduce": {"path": "/a.x[:]"},
        "F303 reduce without an array": {"reduce": "min"},
        "F303 another reduce": {"path": "/a.x[:]", "reduce": "least"},
        "F303 a number for a type": {"type": 3},
        "F303 no duration": {"max_age": "soon"},
        "F302 another reading": {"invalid": {"nann": "drop"}},
        "F303 no unit": {"unit": 3},
        "F303 a pose of two": {"sensor": [1, 2]},
        "F306": {"unit": "parsec"},
        "F308": {"valid": "x <"},
        "F308 a number": {"valid": "x + 1"},
    },
    "proposition": {
        "F302": {"txt": "a"},
        "F303 a number": {"expr": 3},
        "F303 a text of numbers": {"text": 3},
        "F303 another role": {"role": "in"},
        "F303 another aggregate": {"agg": "some"},
        "F303 another kind": {"kind": "real"},
        "F303 no truth value": {"on_unknown": "maybe"},
        "F303 no action": {"action": "A b"},
        "F305": {"expr": "ax < 3 s"},
        "F306": {"expr": "ax < 3 parsec"},
        "F308": {"expr": "ax <"},
        "F308 a number for a truth value": {"expr": "ax"},
        "F309": {"expr": "az < 3 m"},
        "F316": {"modality": "P"},
    },
}  # fmt: skip
"""Each begins with the code of its mistake."""
CASES = [(*table, kind) for table in TABLES for kind in BREAKS[table[0]]]
Case = tuple[str, str, str]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each test writes its project into a folder of its own."""
    monkeypatch.chdir(tmp_path)


def broken(cases: Iterable[Case]) -> str:
    """The bindings with these mistakes in them."""
    data = tomllib.loads(BINDINGS)
    for table, name, kind in cases:
        data[table][name] |= BREAKS[table][kind]
    return tomli_w.dumps(data)


def refused(cases: Iterable[Case]) -> set[str]:
    """What reaches a table of the cases, by the words of the sentences and the bindings."""
    data, tables = tomllib.loads(BINDINGS), {(table, name) for table, name, _ in cases}
    bad = {
        name
        for name, fields in data["proposition"].items()
        if ("proposition", name) in tables
        or any(("signal", word) in tables for word in re.findall(r"\w+", fields["expr"]))
    }
    return {id for id, text in SENTENCES.items() if bad.intersection(text.split())}


def log() -> str:
    """Five values of each topic, 100 ms apart, all from the same time on."""
    messages = [
        said(topic, S + number * 100 * MS, x=number, y=5 - number)
        for topic in ("/a", "/b")
        for number in range(5)
    ]
    return str(write_log(Path("l.mcap"), messages))


def project(bindings: str = BINDINGS) -> Project:
    for id, sentence in SENTENCES.items():
        write(f"requirements/{id.lower()}.fret", f'+++\nid = "{id}"\n+++\n{sentence}\n')
    path = write("requirements/bindings.toml", bindings)
    return load([f"requirements/{id.lower()}.fret" for id in SENTENCES], path)


def verdicts_of(plan: Plan) -> dict[str, Any]:
    """All that the verdicts on each claim rest on, but for the log."""
    declared, verdicts = plan.declarations, {}
    for claim in plan.claims:
        verdict_inputs = {
            kind: text for kind, text in claim.verdict_inputs.items() if kind != "topics"
        }
        names = [
            name for name in declared.propositions if re.search(rf"\b{name}\b", claim.sentence)
        ]
        propositions = [declared.propositions[name] for name in names]
        signals = [declared.signals[name] for each in propositions for name in each.signals]
        verdicts[claim.id] = (claim.monitor, verdict_inputs, declared.clock, propositions, signals)
    return verdicts


@cache
def good_verdicts() -> dict[str, Any]:
    """The same of bindings without a mistake."""
    plan = planned(project())
    assert isinstance(plan, Plan)
    return verdicts_of(plan)


def check(cases: Sequence[Case]) -> None:
    """The law: what is refused, why, and that all else is what it was."""
    good = good_verdicts()
    flawed = project(broken(cases))
    plan = planned(flawed)
    assert isinstance(plan, Plan)
    refused_ids = refused(cases)
    assert {each.id for each in plan.refused} == refused_ids
    assert verdicts_of(plan) == {id: good[id] for id in good if id not in refused_ids}
    codes = {kind.split()[0] for _, _, kind in cases}
    errors = [each.code.number for each in flawed.diagnostics if each.is_error]
    assert {why.code.number for why in plan.refusals} <= {*errors} <= codes
    assert len(errors) <= len(cases), "each once"
    assert flawed.general == ()
    assert all(why.span and why.span.source.name.endswith(".toml") for why in plan.refusals)


@pytest.mark.slow
@pytest.mark.parametrize("table", TABLES, ids=".".join)
def test_what_reads_a_broken_table_is_refused_and_nothing_else(table: tuple[str, str]) -> None:
    same_kind = [each for each in TABLES if each[0] == table[0]]
    for kind in some(BREAKS[table[0]], len(same_kind), same_kind.index(table)):
        check([(*table, kind)])


@pytest.mark.slow
@given(st.lists(st.sampled_from(CASES), min_size=1, max_size=3, unique_by=lambda c: c[:2]))
@settings(max_examples=200 if FULL else 6)
def test_so_it_is_of_several_tables(cases: list[Case]) -> None:
    check(cases)


def results(text: str) -> dict[str, Any]:
    """What the evidence has of each requirement, but for which topics were read."""
    verdicts = {}
    for result in json.loads(text)["results"]:
        del result["hashes"]["topics"], result["health"]
        verdicts[result["requirement"]] = result
    return verdicts


def audit(fretc: Fretc) -> tuple[int, dict[str, Any], list[str]]:
    """Its status, results, and the codes of its errors."""
    run = fretc("audit", "l.mcap")
    codes = [code for code in re.findall(r"^F\d+", run.err, re.MULTILINE) if code != "F314"]
    return run.status, results(Path("build/evidence.json").read_text("utf-8")), codes


@pytest.mark.slow
@pytest.mark.parametrize("place", some(range(len(TABLES)), 3))
def test_an_audit_judges_the_others_as_before(fretc: Fretc, place: int) -> None:
    kinds = list(BREAKS[TABLES[place][0]])
    case = (*TABLES[place], kinds[place % len(kinds)])
    project()
    log()
    status, before, codes = audit(fretc)
    assert (status, codes) == (EXIT_VIOLATION, [])
    assert {result["verdict"] for result in before.values()} == {"satisfied", "violated"}
    project(broken([case]))
    status, now, codes = audit(fretc)
    assert (status, codes) == (EXIT_USAGE, [case[2].split()[0]]), "the mistake, once"
    refused_ids = refused([case])
    for id, result in now.items():
        assert result == before[id] if id not in refused_ids else result["verdict"] == "no data"
        assert id not in refused_ids or result["reason"].startswith(f"not judged: {codes[0]} ")


def audited(fretc: Fretc) -> None:
    """A project without a mistake, its log, and the evidence."""

    def make() -> None:
        project()
        log()
        assert fretc("audit", "l.mcap").status == EXIT_VIOLATION

    made_once("an audit of sound tables", make)


COMMANDS = [
    ("check",),
    ("report",),
    ("report", "--strict"),
    ("verify", "requirements"),
    ("verify-evidence",),
    ("lock", "--reviewer", "a", "--role", "b", "--comment", "c"),
    ("diff",),
    ("bind", "--check", "l.mcap"),
    ("explain", "R1"),
    ("requirements",),
    ("requirements", "--format", "json"),
    *(("--emit", kind, "requirements") for kind in some(TARGETS, 5)),
]


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_every_command_names_all_mistakes_and_makes_nothing_of_what_reads_them(
    fretc: Fretc, command: tuple[str, ...]
) -> None:
    audited(fretc)
    project(broken([("signal", "bx", "F306"), ("proposition", "idle", "F302")]))
    before = {path for path in Path().rglob("*") if path.is_file()}
    run = fretc(*command)
    assert run.status == EXIT_USAGE
    assert re.findall(r"^F30\d", run.err, re.MULTILINE) == ["F306", "F302"]
    assert "is not declared" not in run.err
    new = {path for path in Path().rglob("*") if path.is_file()} - before
    assert not any(path.name.startswith(("r3", "r4", "r5")) for path in new)


@pytest.mark.slow
@pytest.mark.parametrize("case", [("signal", "ay", "F306"), ("proposition", "near", "F302")])
def test_a_report_takes_no_earlier_verdict_on_what_reads_a_broken_table(
    fretc: Fretc, case: Case
) -> None:
    audited(fretc)
    assert suspect(fretc) == (EXIT_OK, set())
    project(broken([case]))
    assert suspect(fretc) == (EXIT_USAGE, refused([case]))


def suspect(fretc: Fretc) -> tuple[int, set[str]]:
    """The status of a report, and whose verdicts it takes for those of something else."""
    status = fretc("report", "--csv", "r.csv").status
    rows = csv.DictReader(io.StringIO(Path("r.csv").read_text("utf-8")))
    return status, {row["requirement"] for row in rows if row["currency"] == "suspect"}


def test_a_number_in_params_is_not_missed_in_a_broken_table(fretc: Fretc) -> None:
    """R1 reads `low` and is refused for its table; R3 only has a number that cannot be compared."""
    case = ("proposition", "low", "F302")
    project(broken([case]))
    for id in ("R1", "R3"):
        header = f'+++\nid = "{id}"\nparams = {{ low = "3 m" }}\n+++\n'
        write(f"requirements/{id.lower()}.fret", header + SENTENCES[id])
    log()
    status, verdicts, codes = audit(fretc)
    assert (status, codes) == (EXIT_USAGE, ["F302"])
    assert {id for id, result in verdicts.items() if result["verdict"] == "no data"} == refused(
        [case]
    )


@pytest.mark.slow
def test_a_signal_with_a_mistake_is_still_that_signal(fretc: Fretc) -> None:
    """`ay` of the sentence is the signal `ay`, whatever its table lacks, and never `ax`."""
    for text in (BINDINGS, broken([("signal", "ay", "F302")])):
        project(f"{text}\n[proposition.'(ay <= 4)']\nexpr = \"ax <= 4 m\"\n")
        write("requirements/r1.fret", '+++\nid = "R1"\n+++\nthe sw shall always satisfy ay <= 4\n')
        log()
        _, verdicts, codes = audit(fretc)
        assert verdicts["R1"]["reason"].startswith("not judged: F524 ")
        assert "F524" in codes


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('tick = "100 ms"', 'tick = "0 ms"'),
        ('tick = "100 ms"', 'tick = "100 ms"\nphase = "1 s"'),
        ("[clock]", "[clok]"),
        ("[clock]", "[defaults]\nunit = 3\n[clock]"),
        ("[clock]", "[variable.v]\ntype = 3\n[clock]"),
        ("[clock]", "[map]\nx = 3\n[clock]"),
        ("[clock]", "[run.label]\nversion = 3\n[clock]"),
        ("[signal.ax]", "[signal]\nax = 3\n[signal.ax2]"),
        ("[signal.ax]", "[signal.ax"),
    ],
)
@pytest.mark.parametrize("cases", [[], [("signal", "ay", "F306")]])
def test_any_other_mistake_refuses_everything(
    fretc: Fretc, old: str, new: str, cases: list[Case]
) -> None:
    text = broken(cases)
    assert text.count(old) == 1
    assert project(text.replace(old, new)).declarations is None
    log()
    assert fretc("audit", "l.mcap").status == EXIT_USAGE
    assert not Path("build").exists()


@pytest.mark.parametrize("case", [("signal", "bx", "F306"), ("proposition", "still", "F302")])
def test_nothing_is_assumed_of_a_stand_that_is_not_known(case: Case) -> None:
    more = '[assume]\nstands = "still"\nlatency = "1 s"\nbraking = "1 s"\n'
    good, _ = read_bindings(Source("b.toml", f"{BINDINGS}{more}"))
    flawed, (mistake,) = read_bindings(Source("b.toml", f"{broken([case])}\n{more}"))
    assert good is not None
    assert good.assumed is not None
    assert flawed is not None
    assert flawed.assumed is None
    assert flawed.mistakes["proposition", "still"] == (mistake,)


def test_verdict_inputs_are_what_they_are_without_the_broken_table() -> None:
    case = ("proposition", "idle", "F308")
    flawed = project(broken([case]))
    data = tomllib.loads(BINDINGS)
    del data["proposition"]["idle"]
    without = project(tomli_w.dumps(data))
    assert [*all_verdict_inputs(flawed).values()] == [*all_verdict_inputs(without).values()]


def test_a_draft_in_place_of_broken_bindings_has_all_propositions() -> None:
    names = [
        each.name for each in missing_propositions(project(broken([("signal", "ay", "F306")])))
    ]
    assert names == ["low", "near", "slow", "still"]
    assert missing_propositions(project()) == ()


def test_assumptions_are_those_of_tables_that_are_read() -> None:
    declarations, _ = read_bindings(Source("b.toml", broken([("signal", "bx", "F302")])))
    assert declarations is not None
    named = {
        name for kind, name in (each.part for each in declarations.defaults) if kind != "clock"
    }
    assert named == {"ax", "ay", "low", "near", "idle"}
