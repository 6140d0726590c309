"""The self-test in Java needs only a JDK, passes, and names the tests that fail."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from fretc.testing.exports.files import SuiteFormat
from fretc.testing.exports.self_test import JAVA_NAME
from tests import meaning
from tests.each import each
from tests.effort import FULL, full_only
from tests.fretc.testing.exports.test_files import SENTENCES, SHORT, written
from tests.fretc.testing.exports.test_self_test import OTHERS
from tests.java_monitors import QUICK, compiled
from tests.programs import installed
from tests.strategies import templates


def result(folder: Path) -> tuple[int, list[str]]:
    """The exit status, and the printed lines."""
    assert compiled(folder) == ""
    command = [installed("java"), *QUICK, "-cp", "classes", JAVA_NAME.stem]
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert ran.stderr == ""
    return ran.returncode, ran.stdout.splitlines()


@pytest.mark.slow
def test_it_passes_without_a_warning(tmp_path: Path) -> None:
    sentences = (*SENTENCES[:3], *SHORT, *OTHERS) if FULL else (SENTENCES[1], *SHORT, *OTHERS[1:3])
    suite, _ = written(tmp_path, SuiteFormat.JAVA, *sentences)
    assert len(suite.tests) > 20
    assert result(tmp_path) == (0, [f"{len(suite.tests)} passed, 0 failed"])


@full_only("half a minute")
@each("scope", meaning.SCOPES)
def test_it_passes_for_every_template(scope: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp(scope)
    sentences = (each.sentence for each in templates((2,)) if each.scope == scope)
    suite, _ = written(folder, SuiteFormat.JAVA, *sentences)
    assert result(folder) == (0, [f"{len(suite.tests)} passed, 0 failed"])


@pytest.mark.slow
def test_it_names_the_test_that_expects_something_else(tmp_path: Path) -> None:
    suite, _ = written(tmp_path, SuiteFormat.JAVA, *SENTENCES[:2])
    path = tmp_path / JAVA_NAME
    old = re.compile(r'("2 " \+ .*), "(?:TRUE|FALSE|UNKNOWN)", ')
    text, count = old.subn(r'\1, "NONE", ', path.read_text("utf-8"))
    assert count == 1
    path.write_text(text, encoding="utf-8")
    status, (failed, last) = result(tmp_path)
    assert (status, failed) == (1, f"failed: 2 {suite.tests[1].name}")
    assert last == f"{len(suite.tests) - 1} passed, 1 failed"


FAULTS = (
    ("this.oldest_1 >= 3", "this.oldest_1 >= 2"),
    ("this.oldest_1 >= 3", "this.oldest_1 >= 4"),
    ("this.oldest_1 = 0;", "this.oldest_1 = 1;"),
    ("this.r1_broken | this.since_1", "this.r1_broken & this.since_1"),
    ("verdict = Verdict.PENDING;\n            }", "verdict = Verdict.SATISFIED;\n            }"),
    ("not_q = inputs.q != Truth.TRUE;", "not_q = inputs.q == Truth.FALSE;"),
    ("& now.is_p", "| now.is_p"),
)


@full_only("javac for each")
@pytest.mark.slow
def test_a_wrong_monitor_fails(tmp_path: Path) -> None:
    written(tmp_path, SuiteFormat.JAVA, OTHERS[0])
    path = tmp_path / "R1Monitor.java"
    right = path.read_text("utf-8")
    for old, new in FAULTS:
        assert old in right, old
        path.write_text(right.replace(old, new), encoding="utf-8")
        assert result(tmp_path)[0] == 1, (old, new)
