"""What packages of ROS 1 and ROS 2 share: names that are legal, texts that run by themselves."""

import keyword
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path, PurePosixPath

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.folder import load
from compiler.project.paths import expanded_paths
from compiler.targets.ros import package as p
from compiler.targets.target import TargetOptions
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import IDENTIFIER
from tests.effort import examples, some
from tests.emitting import requirement

ROOT = Path(__file__).parents[4]


def described(path: str) -> p.Package:
    paths = expanded_paths([str(ROOT / path)])
    assert not isinstance(paths, Diagnostic)
    project = load(paths)
    assert project.formalized
    assert [d for each in project.formalized if (d := p.refuse(each))] == []
    options = TargetOptions(declarations=project.declarations, attribution=project.attribution)
    return p.package(project.formalized, options)


def written(package: p.Package, folder: Path) -> Path:
    """The shared texts, as both printers place them."""
    own = folder / package.name
    own.joinpath("src", package.name).mkdir(parents=True)
    own.joinpath("test").mkdir()
    for name, text in {"__init__.py": "", **p.modules(package)}.items():
        own.joinpath("src", package.name, name).write_text(text)
    own.joinpath("test/test_monitor.py").write_text(p.tests(package))
    return own


@pytest.mark.slow
@pytest.mark.parametrize(
    "path", some(["requirements/agv", "requirements/mission", "requirements/r1.fret"], 3)
)
def test_the_tests_of_a_package_pass_by_the_standard_library_alone(
    path: str, tmp_path: Path
) -> None:
    package = described(path)
    own = written(package, tmp_path)
    ran = subprocess.run(
        [sys.executable, "-I", "-m", "unittest", "discover", "-v", "test"],
        cwd=own,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    assert "Ran 5 tests" in ran.stderr
    assert set(package.ids) >= set(package.parameters[-1].value)  # type: ignore[arg-type]


@pytest.mark.slow
def test_a_wrong_verdict_of_the_monitor_fails_the_tests_of_the_package(tmp_path: Path) -> None:
    own = written(described("requirements/r1.fret"), tmp_path)
    tests = own / "test/test_monitor.py"
    text = tests.read_text()
    assert '"violated", False' not in text  # R1 sets no bound
    assert text.count("'too_close': True") > 0
    tests.write_text(text.replace("'too_close': True", "'too_close': False"))
    ran = subprocess.run(
        [sys.executable, "-I", "-m", "unittest", "discover", "test"],
        cwd=own,
        capture_output=True,
        check=False,
    )
    assert ran.returncode == 1


@examples(12)
@given(
    st.lists(st.from_regex(IDENTIFIER, fullmatch=True), min_size=1, max_size=2, unique=True),
    st.lists(st.text("aZ9.-_ ä~\n'<", min_size=1, max_size=5).filter(lambda t: "/" not in t)),
)
def test_a_name_is_legal_in_ros_and_is_no_word_of_python(
    ids: list[str], folders: list[str]
) -> None:
    subject = requirement("the sw shall satisfy p")
    requirements = [replace(subject, entry=replace(subject.entry, id=id)) for id in ids]
    found = p.name(requirements, Source(str(PurePosixPath(*folders, "bindings.toml")), ""))
    assert re.fullmatch(r"[a-z]([a-z0-9]|_(?!_))*[a-z0-9]", found)
    assert not keyword.iskeyword(found)
    assert found not in sys.stdlib_module_names


BINDINGS = """
[clock]
tick = "100 ms"
[signal.v]
path = "/a.data"
type = "std_msgs/Float64"
[proposition.p]
expr = "v < 3"
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('type = "std_msgs/Float64"\n', "", "`v` has no type"),
        ("std_msgs/Float64", "foxglove.Thing", "`v` has the type `foxglove.Thing`"),
        ("/a.data", "/a-b.data", "`/a-b` is not a valid ROS topic name"),
        (
            "[proposition.p]",
            '[signal.w]\npath = "/a.other"\ntype = "std_msgs/Bool"\n[proposition.p]',
            "/a has the type `std_msgs/Float64` for one signal and another type",
        ),
        ('tick = "100 ms"', 'tick = "100 ms"\ntime = "header.stamp"', "how long a tick waits"),
    ],
)
def test_what_no_node_can_subscribe_to_is_refused(
    old: str, new: str, said: str, tmp_path: Path
) -> None:
    assert p.refuse(_one(BINDINGS, tmp_path)) is None
    found = p.refuse(_one(BINDINGS.replace(old, new), tmp_path))
    assert found is not None
    assert found.code == Code.NOT_EXPRESSIBLE
    assert said in found.message
    assert found.help


def _one(bindings: str, folder: Path) -> FormalizedRequirement:
    (folder / "bindings.toml").write_text(bindings)
    (folder / "a.fret").write_text("the sw shall always satisfy p\n")
    (subject,) = load([str(folder / "a.fret")]).formalized
    return subject


def test_without_an_interceptor_it_says_that_nothing_carries_out_a_stop(tmp_path: Path) -> None:
    subject = _one(BINDINGS, tmp_path)
    options = TargetOptions(declarations=subject.declarations)
    (found,) = p.remarks(options)
    assert found.code == Code.NO_INTERCEPTOR
    assert not found.is_error
    package = p.package([subject], options)
    assert package.stop == "/a_monitor/stop"
    assert package.dependencies == ("diagnostic_msgs", "std_msgs")


def test_only_what_asks_the_robot_to_stand_stops_it_by_default() -> None:
    mission, agv = (described(f"requirements/{name}") for name in ("mission", "agv"))
    assert mission.parameters[-1].value == ("R1",)
    assert agv.parameters[-1].value == agv.ids  # nothing says what standing is
