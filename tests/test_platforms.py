"""What is installed on each platform: all that has a wheel there."""

import subprocess
import sys
import tomllib
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from tests.effort import full_only
from tests.programs import leave_out

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
OF_DEVELOPERS = {"dev", "peers", "prose"}
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
MANYLINUX = ("2014", "_2_17", "_2_24", "_2_27", "_2_28", "_2_31", "_2_34")
MACOS = ("10_9", "10_12", "11_0", "12_0", "13_0", "14_0")
PLATFORMS = {
    ("linux", "x86_64"): [f"manylinux{v}_x86_64" for v in MANYLINUX],
    ("linux", "aarch64"): [f"manylinux{v}_aarch64" for v in MANYLINUX],
    ("darwin", "arm64"): [f"macosx_{v}_{a}" for v in MACOS for a in ("arm64", "universal2")],
    ("darwin", "x86_64"): [f"macosx_{v}_{a}" for v in MACOS for a in ("x86_64", "universal2")],
    ("win32", "AMD64"): ["win_amd64"],
}
"""`sys_platform` and `platform_machine`, with the tags of wheels that run there."""
ENVIRONMENTS = [*product(PYTHONS, PLATFORMS)]
BUILT = {("linux", "aarch64"): {"crosshair-tool"}}
"""No wheel, but a source that a C compiler builds."""


def demands() -> Iterator[Requirement]:
    """Those of fretc and of its extras for users."""
    yield from map(Requirement, PROJECT["dependencies"])
    for extra, texts in PROJECT["optional-dependencies"].items():
        if extra not in OF_DEVELOPERS:
            yield from map(Requirement, texts)


def demanded(
    python: str, platform: tuple[str, str], implementation: str = "cpython"
) -> list[Requirement]:
    environment = {
        "python_version": python,
        "sys_platform": platform[0],
        "platform_machine": platform[1],
        "implementation_name": implementation,
    }
    return [d for d in demands() if d.marker is None or d.marker.evaluate(environment)]


def test_what_lacks_wheels_is_left_out_there_and_nowhere_else() -> None:
    everything = {demand.name for demand in demands()}
    for python, platform in ENVIRONMENTS:
        missing = everything - {demand.name for demand in demanded(python, platform)}
        expected = set[str]()
        if python == "3.14" or platform != ("linux", "x86_64"):
            expected.add("spottl")
        if python == "3.14" or platform == ("linux", "aarch64"):
            expected.add("cyclonedds")
        assert missing == expected, (python, platform)


def test_spot_is_for_cpython_alone() -> None:
    names = {demand.name for demand in demanded("3.11", ("linux", "x86_64"), "pypy")}
    assert "spottl" not in names
    assert "oxidd" in names


PIP = (sys.executable, "-m", "pip")


@full_only("asks the registry")
@pytest.mark.parametrize(("python", "platform"), ENVIRONMENTS)
def test_each_of_them_has_a_wheel(python: str, platform: tuple[str, str], tmp_path: Path) -> None:
    asked = subprocess.run([*PIP, "index", "versions", "click"], capture_output=True, check=False)
    if asked.returncode != 0:
        leave_out("no registry of packages answers")
    names = [
        f"{demand.name}{demand.specifier}"
        for demand in demanded(python, platform)
        if demand.name not in BUILT.get(platform, ())
    ]
    tags = [word for tag in PLATFORMS[platform] for word in ("--platform", tag)]
    done = subprocess.run(
        [*PIP, "install", "--dry-run", "--no-deps", "--ignore-installed", "--only-binary=:all:",
         "--target", str(tmp_path), "--implementation", "cp", "--python-version", python,
         *tags, *names],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
