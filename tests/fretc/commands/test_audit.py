"""What an audit prints for a person: a list of one run, a table of many, the worst, the counts."""

import itertools
import re
import shutil
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.evidence.schema import Result
from fretc.audit.outputs.totals import severity, sign_of, word_of
from fretc.commands.audit_table import MOST_NAMES, MOST_REQUIREMENTS, MOST_RUNS, table
from fretc.terminal.screen import Screen, width
from tests.command import Fretc, untimed, write
from tests.effort import examples
from tests.fretc.audit.outputs.test_totals import audits
from tests.fretc.audit.outputs.test_totals import marks as marks_of
from tests.fretc.audit.results import result
from tests.fretc.logs import logs

ROOT = Path(__file__).parents[3]


def shown(results: list[Result], columns: int = 80, encoding: str = "utf-8") -> list[str]:
    screen = Screen(columns, encoding)
    lines = table(marks_of(results), screen)
    return [screen.signs("".join(text for text, _ in line)) for line in lines]


def marks(lines: list[str]) -> Counter[str]:
    """How often each sign stands in the rows of a table whose ids are of one letter and digits."""
    rows = [re.fullmatch(r"  . (?:R\d+) *( .*)", line) for line in lines]
    return Counter("".join(row[1] for row in rows if row).replace(" ", ""))


def left_out(lines: list[str]) -> Counter[str]:
    (line,) = [line for line in lines if line.startswith("not in the table")] or [""]
    words = Counter[str]()
    for count, word in re.findall(r"([\d,]+) (violated|no data|inconclusive|vacuous|sat\w+)", line):
        words[sign_of(word).glyph] += int(count.replace(",", ""))
    return words


@examples(10)
@given(audits(), st.integers(40, 120))
def test_each_result_has_its_mark(results: list[Result], columns: int) -> None:
    expected = Counter(sign_of(word_of(each)).glyph for each in results)
    assert marks(shown(results, columns)) == expected


@pytest.mark.slow
@examples(10)
@given(
    st.lists(st.text(max_size=60), min_size=2, max_size=30, unique=True),
    st.lists(st.text(min_size=1, max_size=60), min_size=1, max_size=3, unique=True),
    st.integers(40, 120),
    st.sampled_from(["utf-8", "ascii", "latin-1"]),
)
def test_no_line_is_wider_than_the_screen_whatever_things_are_called(
    names: list[str], ids: list[str], columns: int, encoding: str
) -> None:
    results = [
        result(run=name, requirement=id, verdict="violated")
        for name, id in itertools.product(names, ids)
    ]
    for line in shown(results, columns, encoding):
        line.encode(encoding)
        assert "\n" not in line
        assert "\x1b" not in line
        assert width(line) <= columns


def many(runs: int, requirements: int) -> list[Result]:
    """All are satisfied but for a violation and an unknown at the end of the last ones."""
    bad = {
        (runs - 1, requirements - 1): "violated",
        (runs - 2, requirements - 2): "no data",
    }
    return [
        result(run=f"{i}.mcap", requirement=f"R{j}", verdict=bad.get((i, j), "satisfied"))
        for i in range(runs)
        for j in range(requirements)
    ]


@pytest.mark.slow
def test_what_does_not_fit_is_counted_and_is_never_the_worst() -> None:
    lines = shown(many(MOST_RUNS + 30, MOST_REQUIREMENTS + 3))
    kept = marks(lines)
    assert (kept["✘"], kept["?"]) == (1, 1)
    assert kept + left_out(lines) == Counter(
        {"✘": 1, "?": 1, "✔": (MOST_RUNS + 30) * (MOST_REQUIREMENTS + 3) - 2}
    )
    assert f"  run {MOST_RUNS + 30}: 1 violated: {MOST_RUNS + 29}.mcap" in lines
    assert len(lines) < 400


def test_of_more_violations_than_fit_the_others_are_counted() -> None:
    results = [result(run=f"{i}", verdict="violated") for i in range(MOST_RUNS + 7)]
    lines = shown(results)
    assert marks(lines) == {"✘": MOST_RUNS}
    assert "not in the table: 7 runs with 7 violated; `-v` lists them" in lines
    assert f"  and {MOST_RUNS - MOST_NAMES} more; `-v` lists them" in lines


def test_a_hundred_runs_take_a_screen() -> None:
    assert len(shown(many(100, 15))) < 50


def test_the_sign_of_a_row_is_that_of_its_worst_result() -> None:
    results = [result(run=f"{i}", verdict=word) for i, word in enumerate(["satisfied", "violated"])]
    assert shown(results)[1] == "  ✘ R1  ✔✘"
    assert severity("violated") < severity("satisfied")


BINDINGS = """\
[clock]
tick = "100 ms"
[signal.charge]
path = "/x.data"
unit = "%"
[proposition.charged]
expr = "charge > 5 %"
"""
SENTENCE = '+++\nid = "R1"\ntitle = "Enough is left"\n+++\nthe robot shall always satisfy charged\n'


@pytest.fixture
def robot(fretc: Fretc) -> Fretc:
    """A project about a percentage; its log has 0 % to 11 %."""
    write("requirements/r1.fret", SENTENCE)
    write("requirements/bindings.toml", BINDINGS)
    charges = [logs.number(i, 1000 * logs.S + i * 100 * logs.MS) for i in range(12)]
    logs.write(Path("run.mcap"), charges)
    return fretc


def test_the_worst_is_named_with_title_value_limit_times_and_commands(robot: Fretc) -> None:
    run = robot("audit", "run.mcap", "-o", "e v.json")
    assert run.status == 1
    listed, worst = untimed(run.out).split("\n\n")
    assert listed.startswith("run.mcap\n  ✘ Enough is left (R1)  violated")
    assert worst == (
        "worst: Enough is left (R1) violated in run.mcap\n"
        "  at 0 s (1000 s by the clock of the log), until 0.6 s (600 ms)\n"
        "  demanded: charged; recorded: charge = 0 %\n"
        "  limit: charge > 5 % (charged); from 0 % to 11 % in this run\n"
        "  seconds count from the first tick, at 1000 s by the clock of the log\n"
        "  more: fretc report --evidence 'e v.json'\n"
        "        fretc explain R1\n"
        "5 of 7 situations seen, 2 never: `fretc coverage --evidence 'e v.json'` lists them\n"
        "1 run \N{MULTIPLICATION SIGN} 1 requirement: 1 violated\n"
    )


@pytest.mark.slow
def test_many_runs_are_a_table_and_verbose_lists_them(robot: Fretc) -> None:
    shutil.copy("run.mcap", "same.mcap")
    run = robot("audit", "run.mcap", "same.mcap")
    assert run.out.startswith(
        f"    {'run':<19} 1\n  ✘ Enough is left (R1) ✘✘\n\n"
        "  run 1: 1 violated: run.mcap\n  run 2: 1 violated: same.mcap\n\n"
    )
    listed = robot("audit", "run.mcap", "same.mcap", "-v")
    assert "same.mcap\n  ✘ Enough is left (R1)  violated" in listed.out
    last = "2 runs \N{MULTIPLICATION SIGN} 1 requirement: 2 violated (1 requirement in 2 runs)\n"
    assert untimed(run.out).endswith(last)
    assert untimed(listed.out).endswith(last)
    assert (run.status, listed.status) == (1, 1)


@pytest.mark.parametrize("form", ["text", "junit", "github", "sarif"])
def test_a_value_has_the_declared_unit_in_every_form(robot: Fretc, form: str) -> None:
    out = robot("audit", "run.mcap", "--format", form).out.replace("%25", "%")
    assert "charge = 0 %" in out
    assert "0.05" not in out
    if form == "junit":
        words = ElementTree.fromstring(out)[0][0][0].text
        assert words == "from 0 s to 0.6 s (600 ms): charge = 0 %"


def test_what_is_not_judged_is_counted_apart(robot: Fretc) -> None:
    write("requirements/r2.fret", "the robot shall always satisfy nothing_bound\n")
    run = robot("audit", "run.mcap")
    assert run.status == 2
    assert untimed(run.out).endswith("2 requirements: 1 violated, 1 not judged\n")


def test_where_all_is_satisfied_nothing_is_to_be_looked_at(robot: Fretc) -> None:
    write("requirements/bindings.toml", BINDINGS.replace("> 5 %", "> -5 %"))
    run = robot("audit", "run.mcap")
    assert run.status == 0
    assert "worst" not in run.out
    assert untimed(run.out).endswith(": 1 satisfied\n")
