"""Faults of the product: which are drawn, and what becomes of them."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

from tests.effort import FULL
from tests.fault_injection.__main__ import main
from tests.fault_injection.drawing import (
    ROOT,
    Fault,
    Place,
    drawn,
    is_whole,
    of_module,
    of_template,
)
from tests.fault_injection.known import Misfit, known
from tests.fault_injection.selection import Neighbourhood
from tests.fault_injection.trial import Bench, Finding
from tests.programs import installed

MODULE = '''\
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import re
NAMES = {"a", *EVER}
Kind = int | str


@cached(size=5)
def reading(width: int = 2, *, strict: bool = True) -> list[int]:
    """At most 9."""
    assert width > 1, "it is a mistake of ours"
    if width < 4 and is_wide:
        return [3, width]
    log(quote(width), strict=False)
    rest = f"{width + 1}" + "m"
    each = min(x for x in (low.start if not high else -1) if x != None)
    return each // 10**9
'''
CHANGES = """\
number: 2 -> 3
truth value: True -> False
check left out: width < 4 and is_wide -> False
comparison: < -> <=
connective: and -> or
number: 4 -> 5
entry lost: width -> 3
number: 3 -> 4
call left out: log(quote(width), strict=False) -> pass
call unwrapped: quote(width) -> (width)
name: min -> max
branches exchanged: low.start if not high else -1 -> -1 if not high else low.start
name: start -> end
negation: not high -> (high)
number: 1 -> 2
filter left out: x != None -> True
comparison: != -> ==
operator: // -> *
number: 10 -> 11
number: 9 -> 10
"""


def changes(faults: list[Fault]) -> list[str]:
    return sorted(f"{fault.kind}: {fault.old} -> {fault.new}" for fault in faults)


def test_each_kind_of_change_of_a_module() -> None:
    text = MODULE.encode()
    faults = of_module("compiler/a.py", text)
    assert changes(faults) == sorted(CHANGES.splitlines())
    assert all(is_whole(fault, text) for fault in faults)


def test_sizes_on_a_page_are_not_changed() -> None:
    text = b"def bar(x):\n    return x + 4 if x > left else left + x\n"
    plain = {"number: 4 -> 5", "operator: + -> -"}
    assert plain <= {*changes(of_module("fretc/a.py", text))}
    assert changes(of_module("fretc/report/pictures/bars.py", text)) == [
        "branches exchanged: x + 4 if x > left else left + x -> left + x if x > left else x + 4",
        "comparison: > -> >=",
        "operator: + -> -",
    ]


def test_each_kind_of_change_of_a_template() -> None:
    text = b"{% if a %}x = {{ b | js }};{% elif not c %}if (x <= 1 && !y) {}{% endif %}"
    assert changes(of_template("js/a.js.j2", text)) == [
        "comparison: && -> ||",
        "comparison: <= -> <",
        "condition:  -> not ",
        "condition: not  -> ",
        "filter left out:  | js -> ",
    ]
    assert not any(each.kind == "comparison" for each in of_template("a.css.j2", b"a > b { c: 1 }"))


def test_a_fault_keeps_its_id_while_its_line_stays() -> None:
    before = of_module("a.py", b"x = 1\ny = x < 2\n")
    after = of_module("a.py", b"import a\n\nx = 5 + 5\nx = 1\n\ny = x < 2\n")
    assert {each.id for each in before} < {each.id for each in after}
    twice = of_module("a.py", b"x = 1\nx = 1\n")
    assert len({each.id for each in twice}) == 2


@pytest.mark.slow
def test_what_is_drawn_of_the_product(tmp_path: Path) -> None:
    """By default of three rooms alone."""
    root = ROOT
    if not FULL:
        root = tmp_path
        for room in ("fretish", "monitors", "templates"):
            shutil.copytree(ROOT / room, tmp_path / room)
    faults = drawn(root, seed=1, count=150)
    assert len({fault.id for fault in faults}) == len(faults) >= 145
    assert len({(fault.path, fault.place.line, fault.place.number) for fault in faults}) == len(
        faults
    )
    for fault in faults:
        text = ROOT.joinpath(fault.path).read_bytes()
        assert fault.applied(text) != text
        assert is_whole(fault, text), fault


@pytest.mark.slow
def test_each_wrong_answer_that_was_there_is_one_of_today() -> None:
    faults = list(known(ROOT))
    assert 30 <= len(faults) <= 100
    assert not [fault for fault in faults if isinstance(fault, Misfit)]
    assert len({fault.id for fault in faults if isinstance(fault, Fault)}) == len(faults)
    for fault in faults:
        assert isinstance(fault, Fault)
        text = ROOT.joinpath(fault.path).read_bytes()
        assert fault.applied(text) != text
        assert is_whole(fault, text), fault


def test_known_faults_of_another_tree_are_named_where_they_do_not_fit(tmp_path: Path) -> None:
    misfits = [fault for fault in known(tmp_path) if isinstance(fault, Misfit)]
    assert len(misfits) == len(list(known(ROOT)))


PROJECT = {
    "pyproject.toml": "[tool.pytest.ini_options]\naddopts = '--import-mode=importlib'\n",
    "monitors/__init__.py": "",
    "monitors/gap.py": "def near(gap):\n    return gap < 5\n",
    "monitors/brake.py": (
        "from monitors.gap import near\n\n\ndef brake(gap):\n    return near(gap)\n"
    ),
    "monitors/search.py": "def last(n):\n    while n > 0:\n        n = n - 1\n    return n\n",
    "tests/monitors/test_gap.py": (
        "from monitors.gap import near\n\n\n"
        "def test_near():\n    assert near(4)\n    assert not near(5)\n\n\n"
        "def test_that_fails_anyway():\n    assert not near(4)\n"
    ),
    "tests/monitors/test_search.py": (
        "from monitors.search import last\n\n\ndef test_last():\n    assert last(3) == 0\n"
    ),
    "tests/test_brakes.py": "from monitors.brake import brake\n",
    "templates/empty.j2": "",
}

OTHERS = ("survived", "cut", "short", "out", "of", "time", "equivalent")


@pytest.fixture
def project(tmp_path: Path) -> Path:
    for name, text in PROJECT.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    subprocess.run([installed("git"), "init", "-q"], cwd=tmp_path, check=True)
    return tmp_path


def test_the_tests_near_a_module(project: Path) -> None:
    near = Neighbourhood(project)
    own, others = near.files("monitors/gap.py")
    assert own == ["tests/monitors/test_gap.py"]
    assert others == ["tests/monitors/test_search.py", "tests/test_brakes.py"]


def test_of_another_tree_the_known_faults_are_left_out_and_the_sum_is_printed(
    project: Path,
) -> None:
    ended = CliRunner().invoke(main, ["--tree", str(project), "--count", "0"])
    assert ended.exit_code == 0, ended.output
    assert ended.stderr.count("left out: ") == len(list(known(ROOT)))
    assert ended.stdout.splitlines()[1].split() == ["found", *OTHERS]
    assert ended.stdout.splitlines()[2:] == [f"{'all':<24}" + f"{0:>13}" * 5, "0 faults in 0 s"]


@pytest.mark.slow
def test_what_becomes_of_a_fault(project: Path) -> None:
    def fault(path: str, old: str, new: str) -> Fault:
        return Fault(Place(path), PROJECT[path].index(old), old, new, "test")

    faults = [
        fault("monitors/gap.py", "<", "<="),
        fault("monitors/brake.py", "near(gap)\n", "True\n"),
        fault("monitors/search.py", "- 1", "+ 0"),
    ]
    bench = Bench(project, jobs=1, seconds=3)
    found, survived, endless = bench.trials(faults)
    assert (found.finding, found.why) == (
        Finding.FOUND,
        "tests/monitors/test_gap.py::test_near",
    )
    assert (found.fault, found.line) == (faults[0], 2)
    assert (survived.finding, survived.line, survived.why) == (Finding.SURVIVED, 5, "")
    assert (endless.finding, endless.why) == (
        Finding.OUT_OF_TIME,
        "tests/monitors/test_search.py::test_last",
    )
    assert bench.fails_anyway == {"tests/monitors/test_gap.py::test_that_fails_anyway"}
    assert {name: project.joinpath(name).read_text("utf-8") for name in PROJECT} == PROJECT
    assert not list(project.rglob("__pycache__"))
