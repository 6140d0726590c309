"""What is emitted runs by itself, agrees with the suite, and fails where a monitor is wrong."""

from __future__ import annotations

import atexit
import csv
import json
import re
import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from itertools import product
from pathlib import Path

import pytest

from compiler.files.records import replace
from compiler.formalization.formalized import FormalizedRequirement
from fretc.testing.assembly import suite
from fretc.testing.exports import simulator
from fretc.testing.exports.files import INDEX, SuiteFormat, files
from fretc.testing.exports.pytest_file import MonitorLanguage
from fretc.testing.generation import Batch, batch
from fretc.testing.suite import Polarity, Suite
from monitors.loading import executed, load
from tests.each import each
from tests.effort import FULL, some
from tests.monitoring import requirement as formalized
from tests.programs import needs
from tests.requirement_sets import requirement, requirements

LONG = 600 if FULL else 20
SENTENCES = (
    "upon a the sw shall within 3 ticks satisfy x",
    "in b mode whenever a the sw shall for 2 ticks satisfy x & !y",
    "whenever a the sw shall until b satisfy y",
    f"upon level > 5 the sw shall within {LONG} ticks satisfy speed < 0.5 | x",
)


SHORT = (
    "upon level > 5 the sw shall within 3 ticks satisfy speed < 0.5 | x",
    "the sw shall satisfy true",
)
"""Numbers, and no input."""


@cache
def batch_of(id: str, sentence: str) -> Batch:
    """The tests of one requirement; the suites that have it share them."""
    return batch(requirement(id, sentence), (), 60)


@cache
def made(*sentences: str) -> tuple[Suite, tuple[FormalizedRequirement, ...]]:
    """A suite, each requirement by itself."""
    every = requirements(*sentences)
    return suite(every, (), [batch_of(f"R{i}", s) for i, s in enumerate(sentences, 1)]), every


def written(
    folder: Path,
    form: SuiteFormat,
    *sentences: str,
    languages: Sequence[MonitorLanguage] = (MonitorLanguage.PYTHON,),
) -> tuple[Suite, tuple[FormalizedRequirement, ...]]:
    found, every = made(*sentences)
    artifacts, _ = files(found, every, form, languages)
    for artifact in artifacts:
        (folder / artifact.path).write_text(artifact.text)
    return found, every


def failures(path: Path) -> list[str]:
    """What the tests of an emitted file say that fail, without pytest."""
    text = path.read_text().replace("Path(__file__)", f"Path({str(path)!r})")
    module = executed(text, path.name)
    failed = []
    for function in dir(module):
        if function.startswith("test_"):
            try:
                getattr(module, function)()
            except Exception as error:  # of whatever is wrong
                failed.append(f"{type(error).__name__}: {error}")
    if hasattr(module, "FOLDER"):  # else it would do that at the end of this process
        module.FOLDER.cleanup()
        if module._node.cache_info().currsize:
            module._node().communicate()
            atexit.unregister(module._node().communicate)
    return failed


def by_pytest(folder: Path) -> subprocess.CompletedProcess[str]:
    """All tests of a folder, run from another one."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(folder)]
    return subprocess.run(command, cwd="/", capture_output=True, text=True, check=False)


@pytest.mark.slow
@each("sentence", SENTENCES)
def test_emitted_tests_pass(sentence: str, tmp_path: Path) -> None:
    found, _ = written(tmp_path, SuiteFormat.PYTEST, sentence)
    text = (tmp_path / "test_r1.py").read_text()
    assert len(re.findall(r"^def test_", text, re.MULTILINE)) == len(found.tests)
    assert failures(tmp_path / "test_r1.py") == []


@pytest.mark.slow
def test_long_bounds_stay_short(tmp_path: Path) -> None:
    found, _ = written(tmp_path, SuiteFormat.PYTEST, SENTENCES[3])
    assert max(test.ticks for test in found.tests) > LONG
    assert len((tmp_path / "test_r1.py").read_text()) < 40000


@pytest.mark.slow
def test_no_file_of_a_test_is_that_of_a_monitor_and_pytest_runs_them_from_anywhere(
    tmp_path: Path,
) -> None:
    """The tests of `x_monitor` are in `test_x_monitor.py`, and so is the monitor of `test_x`."""
    every = formalized(SENTENCES[0], "x_monitor"), formalized(SENTENCES[2], "test_x")
    found = suite(every, (), [batch(each, (), 60) for each in every])
    artifacts, _ = files(found, every, SuiteFormat.PYTEST)
    assert len({each.path for each in artifacts}) == len(artifacts) == 4
    for artifact in artifacts:
        (tmp_path / artifact.path).write_text(artifact.text)
    for name in ("test_x_monitor.py", "test_test_x.py"):
        assert failures(tmp_path / name) == []
    if FULL:  # by default the test of three languages runs pytest
        ran = by_pytest(tmp_path)
        assert ran.returncode == 0, ran.stdout
        assert f"{len(found.tests)} passed" in ran.stdout


def test_no_table_of_a_test_is_the_index() -> None:
    found, every = made(SENTENCES[0])
    named = replace(found, tests=(replace(found.tests[0], name="tests"), *found.tests[1:]))
    artifacts, left = files(named, every, SuiteFormat.CSV)
    assert len({each.path for each in artifacts}) == len(artifacts)
    assert left == {"tests": "`tests.csv` is the table of all tests"}


FAULTS = (
    (r">= 3\b", ">= 2"),
    (r">= 3\b", ">= 4"),
    (r"\band not ", "and "),
    (r" and ", " or "),
    (r"r1_broken = tick", "r1_broken = tick + 1"),
    (r"= 0$", "= 1"),
    (r"\+ 1\b", "+ 2"),
    (r"if not ", "if "),
    (r"< 0 and ", "< 0 or "),
)
"""What is replaced in the step of an approximation, at each place by itself."""
TICKS = 6 if FULL else 4


def faulty(text: str) -> list[str]:
    """Monitors that are wrong at one place."""
    begin = text.index("        for (", text.index("# The requirements -"))
    end = text.index("if tick == self.tick", begin)
    return [
        text[: begin + found.start()] + wrong + text[begin + found.end() :]
        for pattern, wrong in FAULTS
        for found in re.finditer(pattern, text[begin:end], re.MULTILINE)
    ]


def judgements(text: str) -> list[object]:
    """What a monitor says of all runs of some ticks, tick by tick."""
    monitor = load("r1_monitor.py", text)
    found: list[object] = []
    for word in product(product((False, True), repeat=len(monitor.PROPOSITIONS)), repeat=TICKS):
        monitor.reset()
        for row in word:
            monitor.advance([row])
            (status,) = monitor.statuses()
            found.append((*monitor.verdicts(), status.finite, status.first_violation))
    return found


@pytest.mark.slow
def test_a_wrong_monitor_fails(tmp_path: Path) -> None:
    written(tmp_path, SuiteFormat.PYTEST, SENTENCES[0])
    path = tmp_path / "r1_monitor.py"
    right = path.read_text()
    expected = judgements(right)
    wrong = [text for text in faulty(right) if judgements(text) != expected]
    assert len(wrong) >= 5
    for text in wrong:
        path.write_text(text)
        assert failures(tmp_path / "test_r1.py"), set(text.splitlines()) - {*right.splitlines()}


ALL = (*MonitorLanguage,)
needs_both = needs("cc", "node")


@needs_both
@pytest.mark.slow
def test_one_file_steps_monitors_in_three_languages(tmp_path: Path) -> None:
    """Two of them in one process, each with a library of its own."""
    sentences = SENTENCES[:3] if FULL else SENTENCES[1:2]
    found, _ = written(tmp_path, SuiteFormat.PYTEST, *sentences, *SHORT, languages=ALL)
    ran = by_pytest(tmp_path)
    assert ran.returncode == 0, ran.stdout
    assert f"{len(found.tests)} passed" in ran.stdout


WRONG = (
    ("r1_monitor.c", r"approximation->oldest_1 >= 3", "approximation->oldest_1 >= 2", "in C"),
    ("r1_monitor.c", r"possible\.failed \? 1u", "possible.failed ? 0u", "in C"),
    ("r1_monitor.c", r"= FRETC_VIOLATED;", "= 7;", "IndexError"),
    ("r1_monitor.c", r"\Z", "\n#error\n", "CalledProcessError"),
    ("r1_monitor.mjs", r">= 3\b", ">= 2", "in JavaScript"),
    ("r1_monitor.mjs", r"atEnd:", "other:", "in JavaScript"),
    ("r1_monitor.mjs", r"\Z", "\nthrow 1;\n", "Node has ended"),
    ("r1_monitor.py", r">= 3\b", ">= 2", "in Python"),
)


@needs_both
@pytest.mark.slow
@each("wrong", some(WRONG, 2))
def test_a_wrong_monitor_fails_in_its_language(
    wrong: tuple[str, str, str, str], tmp_path: Path
) -> None:
    """Anyone who of the three it is, and where it cannot be run."""
    name, old, new, reason = wrong
    written(tmp_path, SuiteFormat.PYTEST, SENTENCES[0], languages=ALL)
    path = tmp_path / name
    right = path.read_text()
    assert re.search(old, right), old
    path.write_text(re.sub(old, new, right))
    found = failures(tmp_path / "test_r1.py")
    assert any(reason in each for each in found), found
    if FULL:
        ran = by_pytest(tmp_path)
        assert ran.returncode == 1
        assert reason in ran.stdout
    path.write_text(right)


@pytest.mark.slow
@each("sentence", SENTENCES[:3])
def test_tables_are_read_by_the_monitor(sentence: str, tmp_path: Path) -> None:
    """Each ends with the verdict that the index states."""
    written(tmp_path, SuiteFormat.CSV, sentence)
    with (tmp_path / INDEX).open(newline="") as lines:
        rows = [*csv.DictReader(lines)]
    assert rows
    command = [sys.executable, "-ISE", "r1_monitor.py", "--format", "json"]
    for option in {row["option"] for row in rows}:
        own = [row for row in rows if row["option"] == option]
        names = [*filter(None, [option]), *(row["file"] for row in own)]
        ran = subprocess.run(
            [*command, *names], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        found = [json.loads(line) for line in ran.stdout.splitlines()]
        assert [row["verdict"] for row in found] == [row["verdict"] for row in own], ran.stderr
        assert [str(row["ticks"]) for row in found] == [row["ticks"] for row in own]


def test_a_number_that_is_known_at_some_ticks_alone_is_no_column_of_the_simulator(
    tmp_path: Path,
) -> None:
    """A proposition of the bindings has numbers only where some make it so."""
    found, (rule,) = written(tmp_path, SuiteFormat.FRET, SENTENCES[0])
    test = next(each for each in found.tests if len(each.rows) > 1)
    for place in range(len(test.rows)):
        rows = [replace(row, values={**row.values, "number": 1.0}) for row in test.rows]
        rows[place] = test.rows[place]
        some = replace(test, rows=tuple(rows))
        assert simulator.refusal(rule, some) is None
        assert simulator.table(rule, some) == simulator.table(rule, test)


@pytest.mark.slow
def test_traces_of_the_simulator_have_its_form(tmp_path: Path) -> None:
    found, _ = written(tmp_path, SuiteFormat.FRET, *SENTENCES[:3])
    traces = json.loads((tmp_path / "ltlsim.json").read_text())
    shown = [test for test in found.tests if test.polarity is not Polarity.UNKNOWN]
    assert [known["traceID"] for known in traces] == [test.name for test in shown]
    for known, test in zip(traces, shown, strict=True):
        trace = known["theTrace"]
        size = len(trace["keys"])
        assert trace["traceLength"] == max(4, test.ticks)
        assert len(trace["values"]) == size * trace["traceLength"]
        assert {len(trace[key]) for key in ("type", "canChange", "minval", "maxval")} == {size}
        lines = (tmp_path / f"{test.name}.csv").read_text().splitlines()
        assert lines[0].split(",") == ["LAST", *trace["keys"]]
        values = [float(cell) for line in lines[1:] for cell in line.split(",")[1:]]
        assert values == trace["values"]
        assert [line.split(",")[0] for line in lines[1:]] == ["0"] * (len(lines) - 2) + ["1"]
