"""Run the agent of this folder in MCAPL, beside a robot with rosbridge.

Usage: AJPF_HOME=/path/to/mcapl python3 run.py [--url ws://localhost:9090]

Exit status 2: MCAPL, Java or a file is missing or changed, or rosbridge refuses a topic. Else it
runs until it is ended. Environment variables: AJPF_HOME, the folder of MCAPL; JAVA_HOME, if java
and javac are not on PATH; AGENT_JAVA_OPTIONS, options of java. It needs Java 11 or newer.
"""

import os
import sys

if __name__ == "__main__":  # no file of this folder is a library
    folder = os.path.dirname(os.path.realpath(__file__))
    sys.path = [place for place in sys.path if os.path.realpath(place) != folder]

import argparse
import hashlib
import json
import re
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

BAD = 2
RELEASE = "11"
ANTLR = "antlr-4.13"
"""MCAPL's parsers are made by it; a library that is older cannot read them."""
DIES = "-XX:+ExitOnOutOfMemoryError"
"""Without memory, the agent is silent, and the interceptor stops the robot."""
TOPIC = r"/?[A-Za-z_]\w*(?:/[A-Za-z_]\w*)*"


class UnusableError(Exception):
    """The agent cannot run; the text says why."""


def main(arguments: Sequence[str]) -> int:
    """Compile the environment and run the agent until it is ended."""
    parser = argparse.ArgumentParser(description="Run this agent in MCAPL, beside rosbridge.")
    parser.add_argument("--url", default="ws://localhost:9090", help="address of rosbridge")
    parser.add_argument("--clock", default="", help="topic of a simulated clock, such as /clock")
    parser.add_argument("--trace", default="", help="topic for what the agent believes and does")
    parser.add_argument(
        "--compression", choices=("cbor", "none"), default="cbor", help="encoding of messages"
    )
    options = parser.parse_args(arguments)
    here = Path(__file__).resolve().parent
    try:
        check(options)
        manifest = intact(here)
        java, javac, classes = tools()
        with tempfile.TemporaryDirectory(prefix="agent-") as build:
            compiled(here, Path(build), javac, classes)
            command = [java, DIES, *shlex.split(os.environ.get("AGENT_JAVA_OPTIONS", "")), "-cp"]
            command += [f"{build}{os.pathsep}{classes}", "ail.mas.AIL"]
            command.append(str(configured(here, Path(build), options)))
            print(f"runs {manifest['agent']} at {options.url}", flush=True)
            return ran(command)
    except UnusableError as error:
        print(f"error: {error}", file=sys.stderr)
        return BAD
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
        return BAD


def check(options: argparse.Namespace) -> None:
    """Check the options: they become lines of a file that MCAPL reads."""
    if not re.fullmatch(r"wss?://[\w.:\[\]-]+(?:/[\w./-]*)?", options.url, re.ASCII):
        raise UnusableError(f"`{options.url}` is no address such as ws://localhost:9090")
    for topic in (options.clock, options.trace):
        if topic and not re.fullmatch(TOPIC, topic, re.ASCII):
            raise UnusableError(f"`{topic}` is no topic")


def intact(here: Path) -> Mapping[str, Any]:
    """The manifest, after a check that its files are unchanged."""
    try:
        manifest: dict[str, Any] = json.loads((here / "manifest.json").read_text(encoding="utf-8"))
        for name, expected in manifest["files"].items():
            if hashlib.sha256((here / name).read_bytes()).hexdigest() != expected:
                raise UnusableError(f"{name} is not the file that manifest.json lists")
        if not {"SIF.gwen", "SIF.ail", "Environment.java"} <= manifest["files"].keys():
            raise UnusableError("manifest.json does not list all files")
        return manifest
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise UnusableError(f"manifest.json cannot be read: {error}") from error


def tools() -> tuple[str, str, str]:
    """java, javac, and the class path of MCAPL."""
    home = os.environ.get("AJPF_HOME", "")
    if not home or not Path(home).is_dir():
        raise UnusableError("set AJPF_HOME to the folder of MCAPL")
    path = os.environ.get("PATH", os.defpath)
    if os.environ.get("JAVA_HOME"):
        path = f"{Path(os.environ['JAVA_HOME']) / 'bin'}{os.pathsep}{path}"
    java, javac = shutil.which("java", path=path), shutil.which("javac", path=path)
    if java is None or javac is None:
        raise UnusableError(f"java and javac are needed (JDK {RELEASE} or newer): set JAVA_HOME")
    return java, javac, class_path(Path(home).resolve())


def class_path(home: Path) -> str:
    """The class path: MCAPL's classes, then all its libraries, the newest ANTLR first."""
    compiled = [home / "bin", *sorted((home / "build").glob("*"))]
    if not any((place / "ail/mas/AIL.class").is_file() for place in compiled):
        raise UnusableError(f"there is no ail/mas/AIL.class in {home / 'bin'}: compile MCAPL")
    libraries = sorted((home / "lib").rglob("*.jar"))
    if not any(jar.name.startswith(ANTLR) for jar in libraries):
        raise UnusableError(
            f"there is no {ANTLR}.*.jar below {home / 'lib'}: MCAPL's parsers need ANTLR 4.13.2"
        )
    libraries.sort(key=lambda jar: not jar.name.startswith(ANTLR))
    places = [path for path in (*compiled, *libraries) if path.exists()]
    return os.pathsep.join(map(str, places))


def compiled(here: Path, build: Path, javac: str, classes: str) -> None:
    """Compile the environment."""
    command = [javac, "--release", RELEASE, "-nowarn", "-encoding", "UTF-8", "-d", str(build)]
    done = subprocess.run(
        [*command, "-cp", classes, *map(str, sorted(here.glob("*.java")))],
        capture_output=True,
        text=True,
        errors="replace",
    )
    if done.returncode != 0:
        raise UnusableError(f"the environment does not compile:\n{done.stdout}{done.stderr}")


def configured(here: Path, build: Path, options: argparse.Namespace) -> Path:
    """The `.ail` with absolute paths and the options."""
    text = (here / "SIF.ail").read_text(encoding="utf-8")
    shutil.copy(here / "SIF.gwen", build / "SIF.gwen")
    agent = str(build / "SIF.gwen").replace("\\", "/")
    text = re.sub(r"(?m)^mas\.file = .*$", lambda match: f"mas.file = {agent}", text)
    for name in ("url", "clock", "trace", "compression"):
        text += f"bridge.{name} = {getattr(options, name)}\n"
    path = build / "SIF.ail"
    path.write_text(text, encoding="utf-8")
    return path


def ran(command: Sequence[str]) -> int:
    """The exit status of the command; a signal that ends this script ends it, too."""
    import signal

    process = subprocess.Popen(command, stdin=subprocess.DEVNULL)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: process.terminate())
    return process.wait()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
