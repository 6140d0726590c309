"""Run the agent of this folder in MCAPL, beside a robot with rosbridge.

Usage: AJPF_HOME=/path/to/mcapl python3 run.py [--url ws://localhost:9090] [--agent FILE]

Exit status 2: MCAPL, Java or a file is missing or changed, an agent of your own does not fit the
bindings, or rosbridge refuses a topic. Else it runs until it is ended. Environment variables:
AJPF_HOME, the folder of MCAPL; JAVA_HOME, if java and javac are not on PATH; AGENT_JAVA_OPTIONS,
options of java. It needs Java 11 or newer.
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
    parser.add_argument("--agent", metavar="FILE", help="run this agent in place of SIF.gwen")
    options = parser.parse_args(arguments)
    here = Path(__file__).resolve().parent
    try:
        check(options)
        manifest = intact(here)
        agent = here / "SIF.gwen" if options.agent is None else Path(options.agent)
        events = None if options.agent is None else fitting(agent, manifest)
        java, javac, classes = tools()
        with tempfile.TemporaryDirectory(prefix="agent-") as build:
            compiled(here, Path(build), javac, classes)
            command = [java, DIES, *shlex.split(os.environ.get("AGENT_JAVA_OPTIONS", "")), "-cp"]
            command += [f"{build}{os.pathsep}{classes}", "ail.mas.AIL"]
            command.append(str(configured(here, Path(build), options, agent, events)))
            print(f"runs {manifest['agent']} of {agent.name} at {options.url}", flush=True)
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


def configured(
    here: Path, build: Path, options: argparse.Namespace, program: Path, events: str | None
) -> Path:
    """The `.ail` with absolute paths and the options."""
    text = (here / "SIF.ail").read_text(encoding="utf-8")
    shutil.copy(program, build / "SIF.gwen")
    agent = str(build / "SIF.gwen").replace("\\", "/")
    text = re.sub(r"(?m)^mas\.file = .*$", lambda match: f"mas.file = {agent}", text)
    for name in ("url", "clock", "trace", "compression"):
        text += f"bridge.{name} = {getattr(options, name)}\n"
    text += "" if events is None else f"bridge.events = {events}\n"
    path = build / "SIF.ail"
    path.write_text(text, encoding="utf-8")
    return path


def fitting(path: Path, manifest: Mapping[str, Any]) -> str:
    """The beliefs whose appearance an agent has a plan for, after a check against the bindings.

    It reads agents loosely: what it does not see is left to MCAPL.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise UnusableError(f"{path} is no text: {error}") from error
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", re.sub(r'"[^"\n]*"', '""', text), flags=re.DOTALL)
    name = re.search(r":name:\s*(\w+)", text)
    if name is None or name[1] != manifest["agent"]:
        raise UnusableError(f"{path} has no agent `{manifest['agent']}`: `:name:` has to be it")
    head, _, plans = text.partition(":Plans:")
    known = {*manifest["percepts"].values()}
    known |= {*re.findall(r"[a-z]\w*", head.partition(":Initial Beliefs:")[2].partition(":")[0])}
    bound = {each["action"] for kind in ("actions", "calls") for each in manifest[kind]}
    events = {*re.findall(r"(?:^|;)\s*\+\s*([a-z]\w*)[^:;]*:\s*\{", plans)}
    believed = events | {*re.findall(r"(?:^|;)\s*-\s*([a-z]\w*)[^:;]*:\s*\{", plans)}
    believed |= {*re.findall(r"\bB\s+([a-z]\w*)", plans)}
    deeds = [d.strip() for all_ in re.findall(r"<-([^;]*);", plans) for d in separate(all_)]
    known |= {m[1] for deed in deeds if (m := re.match(r"\+\s*([a-z]\w*)", deed))}
    for belief in sorted(believed - known):
        raise UnusableError(
            f"F919 no percept shows `{belief}`, and the agent does not add it: the percepts are "
            f"{', '.join(sorted(manifest['percepts'].values()))}"
        )
    actions = {deed for deed in deeds if re.match(r"[a-z]\w*", deed)}
    for action in sorted(a for a in actions if not re.match(r"print\b", a) and a not in bound):
        raise UnusableError(
            f"F919 nothing is bound to the action `{action}`: add `[action.{action}]` or "
            f"`[call.{action}]` to the bindings, and emit this folder again"
        )
    return " ".join(sorted(events))


def separate(deeds: str) -> Sequence[str]:
    """Deeds without white space, divided at the commas outside of parentheses."""
    parts, depth = [""], 0
    for sign in re.sub(r"\s", "", deeds):
        depth += (sign == "(") - (sign == ")")
        if sign == "," and not depth:
            parts.append("")
        else:
            parts[-1] += sign
    return parts


def ran(command: Sequence[str]) -> int:
    """The exit status of the command; a signal that ends this script ends it, too."""
    import signal

    process = subprocess.Popen(command, stdin=subprocess.DEVNULL)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: process.terminate())
    return process.wait()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
