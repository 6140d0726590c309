"""Warnings that a project accepts: counted and listed, and told again once they are idle."""

import json
import re
from collections.abc import Mapping
from pathlib import Path

import pytest

from fretish.diagnostics.explanations import explanations
from tests.command import Fretc, Run, write
from tests.fretc.logs.logs import MS, X_TEXT, S, number
from tests.fretc.logs.logs import write as recorded
from tests.fretc.report import cases

BY = ("--reviewer", "A", "--role", "B", "--comment", "c", "--date", "2026-01-01")
SENTENCE = "whenever near the robot shall within 300 milliseconds satisfy stopped"
INTERCEPTOR = """
[interceptor]
stop = "/stop"
command = "/cmd_vel"
output = "/wheels"
scan = "/scan"
period = "50 ms"
hold = "900 ms"
stop_timeout = "1200 ms"
scan_timeout = "300 ms"
command_timeout = "500 ms"
form = "timer"
latching = false

[assume]
stands = "stopped"
latency = "100 ms"
lost = 2
requests = "level"
planner = "any"
braking = "400 ms"
"""
EVENT = """
[interceptor]
stop = "/stop"
command = "/cmd_vel"
output = "/wheels"
form = "event"
"""
FILES = {
    "r1.fret": cases.R1.replace(cases.R1.splitlines()[-1], SENTENCE),
    "bindings.toml": cases.BINDINGS + INTERCEPTOR,
    "hazards.toml": cases.HAZARDS,
}
PLAN, AJPF, BUNDLE = '["audit"]', '["audit", "ajpf"]', '["ajpf-bundle"]'
SLOW_ROBOT = '[proposition.slow]\nexpr = "abs(vx) < 1 m/s"\nagg = "last"\n'
PARENTS = 'parents = ["HAZ-1"]\n'


def sentence(text: str, plan: str = PLAN) -> Mapping[str, str]:
    return {SENTENCE: text, PLAN: plan}


CAUSES: Mapping[str, Mapping[str, str]] = {
    "F202": sentence("whenever persisted(3, near) the robot shall within 1 second satisfy stopped"),
    "F203": sentence("whenever near the robot shall eventually satisfy stopped"),
    "F204": sentence("if near the robot shall within 1 second satisfy stopped"),
    "F205": sentence("upon near the robot shall satisfy stopped"),
    "F206": sentence("in near mode the robot shall within 1 second satisfy stopped"),
    "F207": sentence("after near the robot shall within 1 second satisfy stopped"),
    "F208": sentence("before near the robot shall always satisfy stopped"),
    "F209": {'role = "input"\nkind = "belief"': 'role = "output"\nkind = "command"'},
    "F210": sentence(
        "whenever near & vx < 1 & vx > 2 the robot shall within 1 second satisfy stopped"
    ),
    "F501": {PARENTS: 'parents = ["HAZ-1", "HAZ-9"]\n'},
    "F522": {"[HAZ-1]\n": '[HAZ-2]\ntitle = "It falls"\n[HAZ-1]\n'},
    "F523": {PARENTS: ""},
    "F525": {PLAN: AJPF},
    "F527": {PARENTS: 'parents = ["HAZ-9"]\n'},
    "F528": {PLAN: '["audit", "auditt"]'},
    "F563": {
        'id = "R1"\n': 'id = "R1"\nkind = "assumption"\n',
        'role = "input"\nkind = "belief"': 'role = "output"\nkind = "belief"',
    },
    "F606": sentence("whenever near the robot shall immediately satisfy stopped", AJPF),
    "F607": sentence("the robot shall always satisfy stopped", AJPF),
    "F615": {
        **sentence("whenever near & !slow the robot shall eventually satisfy stopped", BUNDLE),
        "[proposition.stopped]": f"{SLOW_ROBOT}[proposition.stopped]",
    },
    "F630": {'hold = "900 ms"': 'hold = "100 ms"'},
    "F631": {'scan_timeout = "300 ms"\n': "", 'scan = "/scan"\n': ""},
    "F632": {INTERCEPTOR: EVENT},
    "F633": {"latching = false": "latching = true"},
}
"""Of each warning that can be accepted and needs no log and no review: what provokes it."""


def project(edits: Mapping[str, str], accepted: Mapping[str, str] | None = None) -> None:
    """A project with nothing to be said of it, edited; and what it accepts."""
    files = dict(FILES)
    for old, new in edits.items():
        assert any(old in text for text in files.values()), old
        files = {name: text.replace(old, new) for name, text in files.items()}
    header, settings = "", "[accept]\n"
    for code, reason in (accepted or {}).items():
        match explanations()[code].accept:
            case "requirement":
                header += f"{code} = '{reason}'\n"
            case _:
                settings += f"{code} = '{reason}'\n"
    if header:
        files["r1.fret"] = files["r1.fret"].replace("\n+++\n", f"\n[accept]\n{header}+++\n")
    for name, text in (*files.items(), ("fretc.toml", settings)):
        write(f"requirements/{name}", text)


def codes(run: Run, word: str) -> list[str]:
    """The numbers of the diagnostics that begin with one, and this word."""
    heads = (line.split()[:2] for line in run.err.splitlines() if line.startswith("F"))
    return [head[0] for head in heads if head[1] == word]


def test_a_cause_is_known_of_each_warning_that_can_be_accepted() -> None:
    acceptable = {number for number, each in explanations().items() if each.accept}
    assert acceptable == {*CAUSES, "F315", "F544"}


@pytest.mark.slow
@pytest.mark.parametrize("code", CAUSES)
def test_an_accepted_warning_is_counted_and_an_idle_acceptance_told(
    fretc: Fretc, code: str
) -> None:
    project({})
    assert fretc("check").status == 0
    project(CAUSES[code])
    run = fretc("check")
    warnings = codes(run, "warning:")
    assert (run.status, code in warnings) == (3, True)
    accepted = {number: f"reason of {number}" for number in warnings}
    project(CAUSES[code], accepted)
    run = fretc("check")
    assert (run.status, codes(run, "warning:")) == (0, [])
    assert sorted(codes(run, "accepted:")) == sorted(warnings)
    assert run.err.count(f"reason: reason of {code}\n") == warnings.count(code)
    assert run.err.endswith(f"0 errors, 0 warnings, {len(warnings)} accepted\n")
    project({}, accepted)
    run = fretc("check")
    assert run.status == 3
    idle = codes(run, "warning:")
    assert {*idle} == {"F550"}
    for each in accepted:
        assert f"F550 warning: {each} is accepted, but there is no such warning" in run.err


def test_a_warning_that_is_accepted_for_another_hazard_stays_open(fretc: Fretc) -> None:
    project(CAUSES["F522"])
    write("requirements/fretc.toml", '[accept]\nF522 = { HAZ-1 = "a guard rail" }\n')
    assert sorted(codes(fretc("check"), "warning:")) == ["F522", "F550"]
    write("requirements/fretc.toml", '[accept]\nF522 = { HAZ-2 = "a guard rail" }\n')
    assert (fretc("check").status, codes(fretc("check"), "accepted:")) == (0, ["F522"])


@pytest.mark.slow
def test_a_requirement_that_waits_for_its_review_is_accepted_until_then(fretc: Fretc) -> None:
    project({})
    assert fretc("lock", *BY).status == 0
    second = FILES["r1.fret"].replace('"R1"', '"R2"')
    write("requirements/r2.fret", second)
    assert codes(fretc("check"), "warning:") == ["F544"]
    waits = second.replace("\n+++\n", '\naccept = { F544 = "a draft" }\n+++\n')
    write("requirements/r2.fret", waits)
    run = fretc("check")
    assert (run.status, codes(run, "accepted:")) == (0, ["F544"])
    assert "a draft" in page(fretc)
    assert fretc("lock", *BY, "R2").err.count("; accepted warnings: R2 F544\n") == 1
    assert codes(fretc("check"), "warning:") == ["F550"]


def page(fretc: Fretc) -> str:
    assert fretc("report", "--html", "build/report.html").status == 0
    return Path("build/report.html").read_text("utf-8")


# What has no acceptance ------------------------------------------------------------------------


def test_what_is_wrong_with_an_acceptance_is_an_error_and_the_warning_stays(fretc: Fretc) -> None:
    for code, reason, message in (
        ("F203", " ", "F549 F203 is accepted without a reason"),
        ("F2O3", "x", "F549 `F2O3` is not a code of fretc"),
        ("F101", "x", "F549 F101 cannot be accepted: the sentence is not FRETish"),
        ("F310", "x", "F549 F310 cannot be accepted: the requirement and its binding state"),
        ("F631", "x", "F549 F631 is not about one requirement"),
    ):
        project(CAUSES["F203"])
        fields = f"\naccept = {{ {code} = {json.dumps(reason)} }}\n+++\n"
        text = Path("requirements/r1.fret").read_text().replace("\n+++\n", fields, 1)
        write("requirements/r1.fret", text)
        run = fretc("check")
        assert run.status == 2
        assert message in run.err
        assert "--> requirements/r1.fret:9:" in run.err
        assert codes(run, "accepted:") == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[accept]\nF631 = ""\n', "F549 F631 is accepted without a reason"),
        ('[accept]\nF404 = "x"\n', "F549 F404 cannot be accepted: a part of the log is damaged"),
        ('[accept]\nF203 = { R1 = "x" }\n', "F549 F203 is not about a topic or a hazard"),
        ("[accept]\nF631 = 1\n", "F520 `F631` must have a reason, or a table of reasons"),
        ("accept = 1\n", "F520 `accept` must be a table"),
        ('acept = { F631 = "x" }\n', "F520 unknown field `acept` in fretc.toml"),
        ("[accept\n", "F520 fretc.toml is not TOML"),
    ],
)
def test_a_mistake_of_the_settings_is_told_by_every_command(
    fretc: Fretc, text: str, message: str
) -> None:
    project({})
    write("requirements/fretc.toml", text)
    for command in (("check",), ("requirements/r1.fret",)):
        run = fretc(*command)
        assert (run.status, run.err.count(message)) == (2, 1)


def test_a_warning_of_a_damaged_project_is_never_accepted(fretc: Fretc) -> None:
    """All that is accepted is accepted: what may make a verdict wrong is a warning all the same."""
    project({}, None)
    everything = "".join(f'{code} = "x"\n' for code in CAUSES)
    write("requirements/fretc.toml", f"[accept]\n{everything}")
    drift = FILES["r1.fret"].replace("\n+++\n", '\nparams = { near = "6 cm" }\n+++\n', 1)
    write("requirements/r1.fret", drift)
    assert "F310" in codes(fretc("check"), "warning:")


# Where it counts -------------------------------------------------------------------------------


def test_the_whole_project_accepts_for_every_requirement_and_pyproject_is_as_good(
    fretc: Fretc,
) -> None:
    project(CAUSES["F204"])
    write(
        "requirements/r2.fret", FILES["r1.fret"].replace('"R1"', '"R2"').replace("whenever", "if")
    )
    Path("requirements/fretc.toml").unlink()
    for name, table in (("pyproject.toml", "tool.fretc.accept"), ("fretc.toml", "accept")):
        write(name, f'[{table}]\nF204 = "the team knows FRET"\n')
        run = fretc("check")
        assert (run.status, codes(run, "accepted:")) == (0, ["F204", "F204"])
    write("pyproject.toml", '[tool.fretc.accept]\nF204 = ""\n')
    assert fretc("check").status == 0  # fretc.toml beside it counts alone
    write("requirements/fretc.toml", "")
    assert codes(fretc("check"), "warning:") == ["F204", "F204"]


def test_the_header_of_one_requirement_answers_for_no_other_one(fretc: Fretc) -> None:
    project({})
    first = FILES["r1.fret"].replace("whenever", "if")
    second = first.replace('"R1"', '"R2"')
    accepting = first.replace("\n+++\n", '\naccept = { F204 = "meant" }\n+++\n', 1)
    for text in (f"{accepting}{second}", f"{second}{accepting}"):
        write("requirements/r1.fret", text)
        run = fretc("check")
        assert (codes(run, "accepted:"), codes(run, "warning:")) == (["F204"], ["F204"])


def test_a_retired_requirement_keeps_its_acceptances(fretc: Fretc) -> None:
    project({'"approved"': '"retired"', PARENTS: ""}, {"F203": "x"})
    write("requirements/hazards.toml", "")
    assert fretc("check").status == 0


def test_other_commands_count_what_is_accepted(fretc: Fretc) -> None:
    project(CAUSES["F204"], {"F204": "meant"})
    run = fretc("requirements/r1.fret")
    assert (run.status, run.err) == (0, "1 warning is accepted: `fretc check` lists the reasons\n")


@pytest.mark.parametrize("emit", [(), ("--emit", "monitor"), ("--emit", "json")])
def test_a_file_whose_header_accepts_its_warning_is_shown_without_it(
    fretc: Fretc, emit: tuple[str, ...]
) -> None:
    project(CAUSES["F203"], {"F203": "meant"})
    run = fretc("requirements/r1.fret", *emit)
    assert run.status == 0
    assert run.err.endswith("1 warning is accepted: `fretc check` lists the reasons\n")
    assert "F203" not in run.err


@pytest.mark.parametrize(
    "words",
    [
        ("requirements", "--emit", "interceptor"),
        ("requirements", "--emit", "interceptor", "--emit", "monitor"),
        ("requirements", "--emit", "interceptor", "--emit", "interceptor"),
    ],
    ids=" ".join,
)
def test_what_is_accepted_is_counted_once_wherever_it_comes_from(
    fretc: Fretc, words: tuple[str, ...]
) -> None:
    """One warning is about the sentence, and one about the interceptor."""
    project({**CAUSES["F203"], 'scan_timeout = "300 ms"\n': ""}, {"F203": "meant"})
    write("requirements/fretc.toml", '[accept]\nF631 = "meant"\n')
    run = fretc(*words)
    assert re.findall(r"\S+ warnings? \w+ accepted", run.err) == ["2 warnings are accepted"]


# Reviews and the report ------------------------------------------------------------------------


def audited(*findings: Mapping[str, object]) -> None:
    """Evidence of a run that satisfies R1, of the project as it is now."""
    from compiler.project.folder import load_folder
    from compiler.project.project import Project

    known = load_folder("requirements")
    assert isinstance(known, Project)
    result = cases.result(known, "satisfied")
    result["health"]["findings"] = list(findings)
    write("build/evidence.json", json.dumps(cases.evidence(known, result)))


SLOW = {
    "code": "F315", "severity": "warning", "message": "`/odom` comes every 500 ms",
    "file": "requirements/bindings.toml", "line": 14, "column": 2, "help": None, "subject": "/odom",
}  # fmt: skip


@pytest.mark.slow
def test_an_acceptance_is_a_change_since_the_review_and_leaves_the_evidence_current(
    fretc: Fretc,
) -> None:
    project(CAUSES["F203"])
    audited()
    assert fretc("lock", *BY).status == 0
    project(CAUSES["F203"], {"F203": "meant"})
    run = fretc("diff")
    assert run.status == 3
    assert "  reason to accept R1 F203: none → meant\n" in run.out
    assert "verdict" not in run.out
    run = fretc("check")
    assert codes(run, "warning:") == ["F512"]
    assert "has changed since then: reason to accept R1 F203: none → meant" in run.err
    assert "Changed since the review: R1: reason to accept R1 F203: none → meant." in page(fretc)
    assert fretc("lock", *BY).err.count("; accepted warnings: R1 F203\n") == 1
    assert (fretc("diff").status, fretc("check").status) == (0, 0)
    for changed in ({"F203": "other words"}, {}):
        project(CAUSES["F203"], changed)
        assert "reason to accept R1 F203: " in fretc("diff").out
        assert "F504" not in fretc("check").err


def test_the_acceptance_of_a_topic_bears_upon_those_that_read_it(fretc: Fretc) -> None:
    project({})
    assert fretc("lock", *BY).status == 0
    write("requirements/fretc.toml", '[accept]\nF315 = { "/other" = "x" }\n')
    assert fretc("diff").status == 0
    write("requirements/fretc.toml", '[accept]\nF315 = { "/odom" = "x" }\n')
    assert "  reason to accept F315 /odom: none → x\n" in fretc("diff").out


def test_a_slow_topic_is_accepted_by_its_name_and_idle_once_a_log_shows_it_fast(
    fretc: Fretc,
) -> None:
    aged = {'max_age = "100 ms"\n': ""}
    project(aged)
    accept = '[accept]\nF315 = { "/odom" = "slow by design" }\n'
    write("requirements/fretc.toml", accept)
    assert fretc("check").status == 0  # no log was audited yet
    audited(SLOW)
    run = fretc("check")
    assert (run.status, codes(run, "accepted:")) == (0, ["F315"])
    assert "; no other findings." in page(fretc)
    write("requirements/fretc.toml", accept.replace("/odom", "/scan"))
    assert codes(fretc("check"), "warning:") == ["F550"]
    assert "; other findings in " in page(fretc)
    write("requirements/fretc.toml", accept)
    audited()
    assert codes(fretc("check"), "warning:") == ["F550"]
    project({})
    write("requirements/fretc.toml", accept)
    Path("build/evidence.json").unlink()
    assert codes(fretc("check"), "warning:") == ["F550"]  # max_age is stated: it comes no more


def test_every_form_of_the_report_that_has_room_lists_what_is_accepted(fretc: Fretc) -> None:
    reason = "<b>meant</b>"
    project({**CAUSES["F203"], 'max_age = "100 ms"\n': ""}, {"F203": reason})
    write("requirements/fretc.toml", '[accept]\nF315 = "slow by design"\n')
    audited(SLOW)
    forms = ("html", "json", "junit", "sarif", "markdown")
    options = [word for form in forms for word in (f"--{form}", f"build/report.{form}")]
    run = fretc("report", *options)
    assert "2 warnings are accepted: `fretc check` lists the reasons" in run.err
    made = {form: Path(f"build/report.{form}").read_text("utf-8") for form in forms}
    assert "Accepted warnings: 2" in made["html"]
    assert "Reason: &lt;b&gt;meant&lt;/b&gt;" in made["html"]
    known = json.loads(made["json"])
    accepted = {each["code"]: each["accepted"] for each in known["remarks"] if each["accepted"]}
    assert accepted == {"F203": reason, "F315": "slow by design"}
    assert [each["accepted"] for each in known["runs"][0]["findings"]] == ["slow by design"]
    told = json.loads(made["sarif"])["runs"][0]["invocations"][0]["toolExecutionNotifications"]
    assert {e["descriptor"]["id"]: e["properties"]["accepted"] for e in told} == accepted
    assert 'value="slow by design"' in made["junit"]
    assert "Accepted warnings: 2: " in made["markdown"]


def test_the_evidence_of_a_log_is_the_same_whatever_is_accepted_of_it(fretc: Fretc) -> None:
    project({})
    unaged = X_TEXT.replace('max_age = "250 ms"\n', "")
    write("requirements/bindings.toml", unaged)
    write("requirements/r1.fret", "the rover shall always satisfy !low")
    write("requirements/fretc.toml", "")
    log = Path("run.mcap")
    recorded(log, [number(i / 10, 1000 * S + i * 300 * MS) for i in range(12)])
    run = fretc("audit", str(log), "-o", "open.json")
    assert codes(run, "warning:") == ["F315"]
    status = run.status
    write("requirements/fretc.toml", '[accept]\nF315 = { "/x" = "slow by design" }\n')
    run = fretc("audit", str(log), "-o", "accepted.json")
    assert (run.status, codes(run, "warning:")) == (status, [])
    assert "1 warning is accepted: `fretc check` lists the reasons" in run.err
    assert Path("accepted.json").read_bytes() == Path("open.json").read_bytes()
    run = fretc("check", "--evidence", "accepted.json")
    assert codes(run, "accepted:") == ["F315"]
