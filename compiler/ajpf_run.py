"""Run AJPF on the files beside this one, and compare what it says with `manifest.json`.

Usage: AJPF_HOME=/path/to/mcapl python3 run.py [--timeout SECONDS]

Exit status 0: every verdict is the expected one; 1: AJPF refutes the requirement; 2: AJPF, Java or
a file of the bundle is missing or changed; 3: something is not shown. Of the environment are read:
AJPF_HOME, the folder of MCAPL; JAVA_HOME, if java and javac are not on PATH; AJPF_JAVA_OPTIONS,
options of java. What AJPF printed is kept in `logs/`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

SHOWN, REFUTED, BAD, NOT_SHOWN = 0, 1, 2, 3
HOLDS, VIOLATED, ERROR = "HOLDS", "VIOLATED", "ERROR"


class UnusableError(Exception):
    """What keeps AJPF from being run at all."""


def main(arguments: Sequence[str]) -> int:
    """Check all keys of the bundle; print a line for each."""
    parser = argparse.ArgumentParser(description="Check this bundle with AJPF.")
    parser.add_argument("--timeout", type=float, default=3600, help="seconds for each property")
    options = parser.parse_args(arguments)
    here = Path(__file__).resolve().parent
    try:
        if re.search(r"[\s,]", str(here)):
            raise UnusableError(f"AJPF cannot read a path with a space or a comma: {here}")
        checks = intact(here)
        java, javac, home = tools()
        built(here, javac, home)
        command = [java, *shlex.split(os.environ.get("AJPF_JAVA_OPTIONS", "")), "-jar"]
        jar = runner(home)
    except UnusableError as error:
        print(f"error: {error}", file=sys.stderr)
        return BAD
    (here / "logs").mkdir(exist_ok=True)
    found = []
    for check in checks:
        told, why = asked(here, [*command, str(jar), check["jpf"]], check, options.timeout)
        found.append((check, told))
        mark = "as expected" if told == check["expected"] else f"EXPECTED {check['expected']}"
        print(f"{check['jpf']}: {told}, {mark}{f' ({why})' if why else ''}", flush=True)
    return concluded(found)


def intact(here: Path) -> list[dict[str, Any]]:
    """The checks of the manifest, once every file of it is the one that was made."""
    try:
        manifest = json.loads((here / "manifest.json").read_text(encoding="utf-8"))
        files, checks = manifest["files"], manifest["checks"]
        for name, digest in files.items():
            if hashlib.sha256((here / name).read_bytes()).hexdigest() != digest:
                raise UnusableError(f"{name} is not the file that manifest.json tells of")
        if {check["role"] for check in checks} != {"requirement", "control", "mutant"}:
            raise UnusableError("manifest.json does not name all that is to be checked")
        if any(c["expected"] not in (HOLDS, VIOLATED) or c["jpf"] not in files for c in checks):
            raise UnusableError("manifest.json names something that cannot be checked")
        return list(checks)
    except OSError as error:
        raise UnusableError(f"{error.filename}: {error.strerror}") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise UnusableError(f"manifest.json cannot be read: {error}") from error


def tools() -> tuple[str, str, Path]:
    """Java, its compiler, and the folder of MCAPL."""
    home = os.environ.get("AJPF_HOME", "")
    if not home or not Path(home).is_dir():
        raise UnusableError("set AJPF_HOME to the folder of MCAPL")
    path = os.environ.get("PATH", os.defpath)
    if os.environ.get("JAVA_HOME"):
        path = f"{Path(os.environ['JAVA_HOME']) / 'bin'}{os.pathsep}{path}"
    java, javac = shutil.which("java", path=path), shutil.which("javac", path=path)
    if java is None or javac is None:
        raise UnusableError("java and javac are needed (JDK 11): set JAVA_HOME")
    return java, javac, Path(home).resolve()


def runner(home: Path) -> Path:
    """Of Java PathFinder."""
    jars = [home / "lib" / "3rdparty" / "RunJPF.jar", *sorted(home.rglob("RunJPF.jar"))]
    jar = next((jar for jar in jars if jar.is_file()), None)
    if jar is None:
        raise UnusableError(f"there is no RunJPF.jar below {home}")
    return jar


def built(here: Path, javac: str, home: Path) -> None:
    """Compile the environment, into `classes/`."""
    folders = [home / "bin", *sorted((home / "build").glob("*"))]
    libraries = sorted((home / "lib").rglob("*.jar"))
    places = [str(place) for place in (*folders, *libraries) if place.exists()]
    shutil.rmtree(here / "classes", ignore_errors=True)
    (here / "classes").mkdir()
    command = [javac, "--release", "11", "-nowarn", "-encoding", "UTF-8", "-d", "classes"]
    done = subprocess.run(
        [*command, "-cp", os.pathsep.join(places), "Env.java"],
        cwd=here,
        capture_output=True,
        text=True,
        errors="replace",
    )
    if done.returncode != 0:
        raise UnusableError(f"Env.java does not compile:\n{done.stdout}{done.stderr}")


def asked(here: Path, command: list[str], check: dict[str, Any], timeout: float) -> tuple[str, str]:
    """What AJPF says of one key, and why where that is an error."""
    log = here / "logs" / f"{check['jpf']}.txt"
    try:
        done = subprocess.run(
            command,
            cwd=here,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=timeout,
            text=True,
            errors="replace",
        )
    except subprocess.TimeoutExpired:
        return ERROR, f"no answer in {timeout:g} seconds"
    except OSError as error:
        return ERROR, f"java cannot be run: {error.strerror}"
    log.write_text(done.stdout, encoding="utf-8")
    return verdict(done.stdout, done.returncode)


def verdict(text: str, status: int) -> tuple[str, str]:
    """What a whole output says. What is not clearly a verdict is none.

    A complaint of a parser beats everything: AJPF goes on with another property than the one in
    the file.
    """
    complaint = re.search(r"line \d+:\d+.*", text)
    if complaint is not None:
        return ERROR, f"a file was misread: {complaint[0].strip()}"
    if "search constraint" in text:
        return ERROR, "the search was cut short"
    holds = "no errors detected" in text
    violated = "An Accepting Path has been found" in text
    if holds and violated:
        return ERROR, "the output says two things"
    if violated and status >= 0:
        return VIOLATED, ""
    if holds and status == 0 and not re.search(r"^error #\d", text, re.MULTILINE):
        return HOLDS, ""
    return ERROR, f"no verdict in the output, exit status {status}"


def concluded(found: list[tuple[dict[str, Any], str]]) -> int:
    """Say what all verdicts together show."""
    if any(check["role"] == "requirement" and told == VIOLATED for check, told in found):
        print("AJPF refutes the requirement")
        return REFUTED
    if any(told != check["expected"] for check, told in found):
        print("not shown: without each of these, the verdict about the requirement says nothing")
        return NOT_SHOWN
    print("AJPF says all that is expected of it")
    return SHOWN


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
