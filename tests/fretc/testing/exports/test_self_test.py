"""The self-test in C compiles as monitors do, passes, and fails where a monitor is wrong."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from fretc.testing.exports.files import SuiteFormat
from fretc.testing.exports.self_test import NAME
from tests import meaning
from tests.c_monitors import CHECKED, STRICT
from tests.each import each
from tests.effort import FULL, full_only, some
from tests.fretc.testing.exports.test_files import SENTENCES, SHORT, written
from tests.programs import installed
from tests.strategies import templates

OTHERS = (
    "in m mode whenever p the sw shall within 3 ticks satisfy q",
    "only after m whenever p the sw shall within 2 ticks satisfy q",
    "the sw shall eventually satisfy q",
    "before m mode the sw shall until p satisfy q",
)
"""Scopes, a ring, an end that is decided late or never."""
_BARE = ("-ffreestanding", "-fno-stack-protector", "-fno-pic")
_MAIN = """#include <stdio.h>
int fretc_self_test(void);
int main(void) { printf("%d", fretc_self_test()); return 0; }
"""


def built(folder: Path, cc: str, *flags: str, main: str = _MAIN) -> Path:
    (folder / "main.c").write_text(main)
    sources = [*folder.glob("*_monitor.c"), folder / NAME, folder / "main.c"]
    path = folder / "program"
    subprocess.run([installed(cc), *flags, "-o", path, *sources], check=True, cwd=folder)
    return path


def first_failing(folder: Path) -> int:
    """The number that the self-test gives; 0: all pass."""
    path = built(folder, "gcc", "-std=c99")
    ran = subprocess.run([path], capture_output=True, text=True, check=True)
    return int(ran.stdout)


@pytest.mark.slow
def test_it_passes_without_a_warning_or_undefined_behaviour(tmp_path: Path) -> None:
    sentences = (*SENTENCES[:3], *SHORT, *OTHERS) if FULL else (SENTENCES[1], *SHORT, *OTHERS[1:3])
    suite, _ = written(tmp_path, SuiteFormat.C, *sentences)
    text = (tmp_path / NAME).read_text()
    numbers = [int(number) for number in re.findall(r"^    /\* (\d+) r\d+-", text, re.MULTILINE)]
    assert numbers == [*range(1, len(suite.tests) + 1)]
    path = built(tmp_path, "gcc", *STRICT, *CHECKED, "-Wmissing-prototypes")
    ran = subprocess.run([path], capture_output=True, text=True, check=True)
    assert ran.stdout == "0"


@full_only("half a minute")
@each("scope", meaning.SCOPES)
def test_it_passes_for_every_template(scope: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp(scope)
    written(
        folder, SuiteFormat.C, *(each.sentence for each in templates((2,)) if each.scope == scope)
    )
    assert first_failing(folder) == 0


@pytest.mark.slow
@each("cc", [("gcc", "-m32"), ("clang",), ("g++", "-x", "c++", "-std=c++17")])
def test_it_compiles_without_a_library(cc: tuple[str, ...], tmp_path: Path) -> None:
    written(tmp_path, SuiteFormat.C, *OTHERS)
    name, *flags = cc
    strict = [flag for flag in STRICT if "g++" not in name or not flag.startswith("-std")]
    command = [installed(name), *flags, *strict, *_BARE, "-c", str(NAME)]
    subprocess.run(command, check=True, cwd=tmp_path)
    symbols = subprocess.run(
        [installed("nm"), "-u", NAME.with_suffix(".o")],
        capture_output=True,
        text=True,
        check=True,
        cwd=tmp_path,
    )
    unknown = {line.split()[-1] for line in symbols.stdout.splitlines()}
    assert all(re.search(r"_(init|step)", each) for each in unknown), unknown


@pytest.mark.slow
def test_its_main_tells_by_its_status(tmp_path: Path) -> None:
    written(tmp_path, SuiteFormat.C, OTHERS[0])
    path = built(tmp_path, "gcc", "-std=c99", "-DFRETC_SELF_TEST_MAIN", main="")
    assert subprocess.run([path], check=False).returncode == 0
    spoil(tmp_path, 1)
    path = built(tmp_path, "gcc", "-std=c99", "-DFRETC_SELF_TEST_MAIN", main="")
    assert subprocess.run([path], check=False).returncode == 1


def spoil(folder: Path, number: int) -> None:
    """Expect another finite verdict of a test."""
    path = folder / NAME
    old = re.compile(rf"(^    /\* {number} r.*\n    {{.*, )\d( }},)$", re.MULTILINE)
    text, count = old.subn(r"\g<1>7\2", path.read_text())
    assert count == 1
    path.write_text(text)


@pytest.mark.slow
def test_it_gives_the_number_of_the_test_that_fails(tmp_path: Path) -> None:
    suite, _ = written(tmp_path, SuiteFormat.C, *SENTENCES[:2])
    for number in some((len(suite.tests), len(suite.tests) // 2, 1), 2):
        spoil(tmp_path, number)
        assert first_failing(tmp_path) == number


FAULTS = (
    ("approximation->oldest_1 >= 3", "approximation->oldest_1 >= 2"),
    ("approximation->oldest_1 >= 3", "approximation->oldest_1 >= 4"),
    ("approximation->oldest_1 = 0;", "approximation->oldest_1 = 1;"),
    ("approximation->r1_broken | since_1", "approximation->r1_broken & since_1"),
    ("outcome->verdict = FRETC_PENDING;", "outcome->verdict = FRETC_SATISFIED;"),
    ("(outcome->certain.failed ? 0u : 1u)", "(outcome->certain.failed ? 1u : 0u)"),
    ("now.not_q = inputs->q != FRETC_TRUE;", "now.not_q = inputs->q == FRETC_FALSE;"),
    ("& now->is_p", "| now->is_p"),
)


@pytest.mark.slow
def test_a_wrong_monitor_fails(tmp_path: Path) -> None:
    written(tmp_path, SuiteFormat.C, OTHERS[0])
    path = tmp_path / "r1_monitor.c"
    right = path.read_text()
    assert first_failing(tmp_path) == 0
    for old, new in some(FAULTS, 3):
        assert old in right, old
        path.write_text(right.replace(old, new))
        assert first_failing(tmp_path) > 0, (old, new)
