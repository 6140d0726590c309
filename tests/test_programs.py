"""Programs are found in one place, which hides them from the tests and what these start."""

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from fretc.verification.c import build as c
from fretc.verification.engines import frama_c
from fretc.verification.engines.dafny import answer
from fretc.verification.javascript import language as javascript
from fretc.verification.rust import build as rust
from tests import programs
from tests.each import each

ROOT = Path(__file__).parent.parent
FINDS = re.compile(r"\bwhich\(|/usr/bin/(?!env )|\bdefpath\b|\bskipif\(|\bskip\(|\bimportorskip\(")
STARTS = re.compile(r"\b(?:run|Popen|check_output|check_call)\(\s*\[\s*\"([\w+-]+)\"")
PLACES = {"programs.py", "effort.py", "test_programs.py"}
ROOMS = ("fretish", "monitors", "compiler", "fretc", "simulation")


def texts(*folders: str) -> Iterator[tuple[str, str]]:
    """Each module of them."""
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*.py")):
            name = str(path.relative_to(ROOT))
            if not name.startswith("tests/golden/"):
                yield name, path.read_text(encoding="utf-8")


@pytest.mark.slow
def test_nothing_else_looks_for_a_program_or_skips_a_test() -> None:
    found = [
        name
        for name, text in texts("tests")
        if FINDS.search(text) and name.removeprefix("tests/") not in PLACES
    ]
    assert found == []


@pytest.mark.slow
def test_no_test_starts_a_program_that_may_be_missing_by_its_name() -> None:
    """`installed(NAME)` starts it, and skips the test where it is missing."""
    found = [
        (name, program)
        for name, text in texts("tests")
        for program in STARTS.findall(text)
        if program in programs.PROGRAMS
    ]
    assert found == []


def test_fretc_looks_for_programs_on_the_path_alone() -> None:
    """Else hiding the path would not hide them; ROS 1 alone has its Python at a fixed place."""
    found = [
        name for name, text in texts(*ROOMS) if re.search(r"[\"']/(usr/)?s?bin/(?!sh\")", text)
    ]
    assert found == ["fretc/watch/sources/ros1.py"]


def test_a_path_without_programs_has_none_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", programs.path_without_programs())
    assert [name for name in programs.PROGRAMS if programs.path(name)] == []
    tools = (c.compiler, rust.compiler, javascript.tool, frama_c.program)
    assert [tool() for tool in tools] == [None] * len(tools)
    assert answer("lemma A()\n{\n}\n")[0].detail.startswith("Dafny is not installed")
    for name in ("gcc", "node"):
        assert subprocess.run(["sh", "-c", f"command -v {name}"], check=False).returncode
    shown = subprocess.run(["python3", "-c", "print(1)"], capture_output=True, check=True)
    assert shown.stdout == b"1\n"


@each("name", programs.PROGRAMS)
def test_a_skip_names_the_program_and_what_installs_it(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    mark = programs.needs(name).mark
    with pytest.raises(pytest.skip.Exception) as skipped:
        programs.installed(name)
    assert mark.args == (True,)
    for reason in (mark.kwargs["reason"], str(skipped.value)):
        assert re.fullmatch(
            rf"needs {re.escape(name)}: (apt-get|pip) install (--pre )?[\w+-]+", reason
        )


def test_debians_python_is_hidden_with_its_modules(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(programs, "_hidden", True)
    programs._missing.cache_clear()
    with pytest.raises(pytest.skip.Exception) as skipped:
        programs.debians_python(*programs.MODULES)
    programs._missing.cache_clear()
    for name, way in programs.MODULES.items():
        assert f" {name}: {way}" in str(skipped.value)
