"""fretc on aarch64, emulated: set it up in a folder, run commands and tests, and compare files.

    python -m benchmarks.aarch64 FOLDER [--tests tests/fretish tests/monitors] [--rust]

It needs Debian's `qemu-user-static`, `apt-get` and `dpkg-deb`, and its cross compilers of C for
`--rust`, which compiles generated Rust for aarch64 and armv7. Nothing outside of FOLDER changes.
Python and its libraries are Debian's for arm64, all others are wheels for aarch64. There is no
Spot for aarch64. Each command also runs on this machine, and both must write the same files, but
for measured seconds. Exit status 1: a status or a file differs, or a test fails.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

ROOT = Path(__file__).parent.parent
LOG = "traces/mission-seed15.mcap"
COMMANDS = (
    "--version",
    "requirements/r1.fret --emit monitor",
    "check",
    f"audit {LOG}",
    "report --html build/report.html",
    "explain R1",
    "test requirements/r1.fret",
    "analyze requirements/r1.fret",
    "verify requirements/r1.fret --monitor",
)
ABSENT = ("spottl",)
"""Requirements that are left out: there is no wheel of Spot for aarch64."""
TEST_TOOLS = ("hypothesis", "jsonschema", "pytest", "pytest-xdist", "rfc3987", "rosbags")
_SECONDS = re.compile(rb'"seconds": [0-9.]+')
EPOCH = {"SOURCE_DATE_EPOCH": "1700000000"}


def interpreter(folder: Path) -> Path:
    """An executable Python for aarch64, which processes can start as any other."""
    qemu = shutil.which("qemu-aarch64-static")
    if qemu is None:
        sys.exit("qemu-aarch64-static is missing: install qemu-user-static")
    system, environment = folder / "system", folder / "environment"
    python = environment / "bin/python"
    if not python.exists():
        download(folder / "packages", ["arm64"], ["python3.11", "libstdc++6", "libgomp1"])
        unpack(folder / "packages", "*", system)
        python.parent.mkdir(parents=True)
        real = system / "usr/bin/python3.11"
        settings = f"home = {real.parent}\ninclude-system-site-packages = false\n"
        (environment / "pyvenv.cfg").write_text(settings, encoding="utf-8")
        # Python finds its environment beside its own name, which `-0` sets.
        script = f'#!/bin/sh\nexec "{qemu}" -0 "{python}" -L "{system}" "{real}" "$@"\n'
        python.write_text(script, encoding="utf-8")
        python.chmod(0o755)
    return python


def download(packages: Path, architectures: Sequence[str], names: Sequence[str]) -> None:
    """Download packages of Debian with all that they need, as if nothing were installed."""
    for place in ("state/lists/partial", "cache/archives/partial"):
        (packages / place).mkdir(parents=True, exist_ok=True)
    status = packages / "state/status"
    status.touch()
    options = [
        ("Dir::State", packages / "state"),
        ("Dir::State::status", status),
        ("Dir::Cache", packages / "cache"),
        ("APT::Architecture", architectures[0]),
        *(("APT::Architectures::", architecture) for architecture in architectures),
        ("APT::Sandbox::User", "root"),
    ]
    apt = ["apt-get", "-qq", *(f"-o{name}={value}" for name, value in options)]
    subprocess.run([*apt, "update"], check=False)  # an older list of packages may do
    install = ["install", "--yes", "--no-install-recommends", "--download-only"]
    subprocess.run([*apt, *install, *names], check=True)


def unpack(packages: Path, pattern: str, folder: Path) -> None:
    """Unpack the downloaded packages whose file names match."""
    for package in sorted((packages / "cache/archives").glob(f"{pattern}.deb")):
        subprocess.run(["dpkg-deb", "-x", package, folder], check=True)


def rust(folder: Path) -> Path:
    """A folder with a `rustc` that compiles for this machine, aarch64 and armv7."""
    packages, system, program = folder / "rust-packages", folder / "rust", folder / "bin/rustc"
    if not program.exists():
        names = ["rustc", "libstd-rust-dev:arm64", "libstd-rust-dev:armhf"]
        download(packages, ["amd64", "arm64", "armhf"], names)
        for pattern in ("rustc_*", "libstd-rust-*", "libllvm*"):
            unpack(packages, pattern, system)
        program.parent.mkdir(exist_ok=True)
        libraries = system / "usr/lib/x86_64-linux-gnu"
        script = f'#!/bin/sh\nLD_LIBRARY_PATH={libraries} exec {system}/usr/bin/rustc "$@"\n'
        program.write_text(script, encoding="utf-8")
        program.chmod(0o755)
    return program.parent


def test_rust(folder: Path) -> bool:
    """Whether generated Rust tells on both processors what Python tells, at each tick."""
    path = f"{rust(folder)}{os.pathsep}{os.environ['PATH']}"
    file = "tests/compiler/targets/rust/test_rust_monitor.py"
    command = [sys.executable, "-m", "pytest", "-q", "-n0", "-rs", "-k", "processors", file]
    done = subprocess.run(command, cwd=ROOT, env={**os.environ, "PATH": path}, check=False)
    return done.returncode == 0


def install(python: Path) -> None:
    """Unpack the wheels of what fretc requires, and of the tools that tests need."""
    place = python.parent.parent / "lib/python3.11/site-packages"
    if place.exists():
        return
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    required = [each for each in project["dependencies"] if not each.startswith(ABSENT)]
    platforms = [f"--platform=manylinux_2_{minor}_aarch64" for minor in (17, 27, 28, 34)]
    options = ["--quiet", "--only-binary=:all:", "--python-version=3.11", f"--target={place}"]
    command = [sys.executable, "-m", "pip", "install", *options, *platforms]
    subprocess.run([*command, *required, *TEST_TOOLS], check=True)


def run(python: Path, folder: Path) -> tuple[list[tuple[int, str]], list[float]]:
    """Exit status and output of each command in a folder, and its seconds."""
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("requirements", "traces"):
        shutil.copytree(ROOT / name, folder / name)
    state = {"XDG_STATE_HOME": str(folder.parent / "state")}
    environment = {**os.environ, **EPOCH, **state, "PYTHONPATH": str(ROOT)}
    script = "from fretc.start import main; main()"
    ends, seconds = [], []
    for command in COMMANDS:
        since = time.monotonic()
        done = subprocess.run(
            [python, "-c", script, *command.split()],
            cwd=folder,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        seconds.append(time.monotonic() - since)
        ends.append((done.returncode, done.stdout))
    return ends, seconds


def written(folder: Path) -> dict[str, str]:
    """SHA-256 of each file that the commands wrote."""
    build = folder / "build"
    files = sorted(path for path in build.rglob("*") if path.is_file())
    return {
        str(path.relative_to(build)): sha256(_SECONDS.sub(b"", path.read_bytes())).hexdigest()
        for path in files
    }


def compare(folder: Path, python: Path) -> bool:
    """Run all commands emulated and here, print a line for each, and compare what they wrote."""
    emulated, slow = run(python, folder / "emulated")
    here, fast = run(Path(sys.executable), folder / "here")
    for command, (status, said), (expected, _), a, b in zip(
        COMMANDS, emulated, here, slow, fast, strict=True
    ):
        print(f"{command:40}  status {status} and {expected}  {a:6.1f} s and {b:5.1f} s")
        if status != expected:
            print(said)
    same = [status for status, _ in emulated] == [status for status, _ in here]
    files, others = written(folder / "emulated"), written(folder / "here")
    for name in sorted(files.keys() | others.keys()):
        is_equal = files.get(name) == others.get(name)
        same &= is_equal
        print(f"{name:40}  {'the same bytes' if is_equal else 'DIFFERS'}")
    return same


def test(python: Path, places: Sequence[str], folder: Path) -> bool:
    """Run the quick tests at these places; modules that import Spot are no failures."""
    options = ["-q", "-n2", "-p", "no:cacheprovider", "-m", "not slow"]
    options += [f"--basetemp={folder / 'tests'}", "--continue-on-collection-errors"]
    command: list[str | Path] = [python, "-m", "pytest", *options, *places]
    since = time.monotonic()
    done = subprocess.run(command, cwd=ROOT, env={**os.environ, "PYTHONPATH": ""}, check=False)
    print(f"tests: exit status {done.returncode} after {time.monotonic() - since:.0f} s")
    return done.returncode == 0


def main() -> int:
    """Set up, run and compare."""
    parser = argparse.ArgumentParser(description="Run fretc on an emulated aarch64.")
    parser.add_argument("folder", type=Path, help="where everything is installed and run")
    parser.add_argument("--tests", nargs="*", default=[], help="folders of tests, also to be run")
    parser.add_argument("--rust", action="store_true", help="also test generated Rust")
    options = parser.parse_args()
    folder = options.folder.resolve()
    python = interpreter(folder)
    install(python)
    same = compare(folder, python)
    same &= not options.rust or test_rust(folder)
    same &= not options.tests or test(python, options.tests, folder)
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
