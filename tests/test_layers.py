"""Imports point one way, and each library comes in through its own door."""

import ast
import re
import sys
from pathlib import Path

import pytest

from tests.each import each

ROOT = Path(__file__).parent.parent
ROOMS = ("fretish", "monitors", "compiler", "simulation")
MAY_IMPORT = {
    "fretish": {"fretish"},
    "monitors": {"fretish", "monitors"},
    "compiler": {"fretish", "monitors", "compiler", "simulation"},
    "simulation": {"simulation"},
}
DOORS = {
    "lark": {
        "fretish/parser.py",
        "fretish/binding.py",
        "compiler/gwendolen.py",
        "compiler/gwendolen_mistakes.py",
    },
    "spot": {"compiler/automata.py"},
    "buddy": {"compiler/automata.py"},
    "jinja2": {"compiler/templating.py"},
    "click": {
        f"compiler/cli/{name}.py"
        for name in (
            "__init__",
            "bind",
            "check",
            "evidence",
            "explain",
            "group",
            "output",
            "progress",
            "reports",
            "requirements",
            "reviews",
            "runs",
            "simulations",
            "summaries",
            "verify",
        )
    },
    "pyarrow": {"compiler/table.py"},
    "duckdb": {"compiler/summary.py"},
    "distributed": {"compiler/fleet.py"},
    "dask": {"compiler/fleet.py"},
    "mujoco": {"simulation/robot.py"},
    "matplotlib": {"simulation/picture.py"},
    "scipy": {"compiler/binomial.py"},
    "rosbags": {
        "simulation/messages.py",
        "simulation/recording.py",
        "monitors/idl.py",
        "monitors/bags.py",
    },
    "mcap": {
        "compiler/annotations.py",
        "monitors/bags.py",
        "monitors/container.py",
        "monitors/decoding.py",
        "monitors/index.py",
        "monitors/projection.py",
        "monitors/walk.py",
        "simulation/recording.py",
    },
    "fsspec": {"monitors/inputs.py"},
    "aiohttp": {"monitors/web.py"},
    "z3": {"compiler/bounds.py"},
    "reqif": {"compiler/parents.py", "compiler/report/forms/reqif.py"},
    "yaml": {"compiler/report/forms/gsn.py", "monitors/yamltext.py"},
    "mcap_protobuf": {"monitors/protobuf.py"},
    "mcap_ros1": {"monitors/decoding.py"},
    "mcap_ros2": {"monitors/decoding.py"},
    "zstandard": {"monitors/container.py"},
    "lz4": {"monitors/container.py"},
}


def modules() -> list[Path]:
    return [path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py"))]


def imported(module: Path) -> set[str]:
    """The top-level names of everything that the module imports, wherever in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: imports are absolute"
            names.add((node.module or "").partition(".")[0])
    return names


@pytest.mark.slow
@each("module", modules())
def test_a_module_imports_only_from_its_left(module: Path) -> None:
    room = module.relative_to(ROOT).parts[0]
    assert imported(module) & set(ROOMS) <= MAY_IMPORT[room]


@pytest.mark.slow
@each("module", modules())
def test_a_library_comes_in_through_its_door(module: Path) -> None:
    name = str(module.relative_to(ROOT))
    for library in imported(module) & DOORS.keys():
        assert name in DOORS[library], f"{name} imports {library}"


def test_only_the_command_imports_the_simulation() -> None:
    users = {str(m.relative_to(ROOT)) for m in modules() if "simulation" in imported(m)}
    assert {user for user in users if not user.startswith("simulation/")} == {
        "compiler/campaign.py",
        "compiler/cli/simulations.py",
    }


def test_the_kernel_needs_the_standard_library_only() -> None:
    """And itself: its text is copied into every monitor."""
    for module in (ROOT / "monitors/kernel").glob("*.py"):
        assert imported(module) <= {*sys.stdlib_module_names, "monitors"}, module
        assert set(re.findall(r"from (monitors\S*) import", module.read_text())) <= {
            f"monitors.kernel.{path.stem}" for path in module.parent.glob("*.py")
        }


def test_the_interceptor_needs_the_standard_library_only() -> None:
    """Its text is copied into every emitted one."""
    assert imported(ROOT / "monitors/interceptor.py") <= {*sys.stdlib_module_names}
