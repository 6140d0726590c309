"""Run AJPF on the files of this folder, and compare its answers with `manifest.json`.

Usage: AJPF_HOME=/path/to/mcapl JAVA_HOME=/path/to/jdk-11 python3 run.py [--agent FILE]

`--agent FILE` checks an agent of your own in place of `SIF.gwen`, which may be that file, edited.
Exit status 0: every verdict is the expected one; 1: AJPF refutes the requirement; 2: AJPF, Java or
a file of the bundle is missing or changed; 3: something is not shown. Environment variables:
AJPF_HOME, the folder of MCAPL; JAVA_HOME, if java and javac are not on PATH; AJPF_JAVA_OPTIONS,
options of java. It needs Java 11; javac may be newer. `logs/` keeps the output of AJPF, and
fretc reads `result.json`.
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
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any, NamedTuple

SCHEMA = "fretc-ajpf-result-1"
SHOWN, REFUTED, BAD, NOT_SHOWN = 0, 1, 2, 3
HOLDS, VIOLATED, ERROR = "HOLDS", "VIOLATED", "ERROR"
JAVA = 11
"""Java PathFinder reaches into a class of the JDK that newer ones have not."""
ANTLR = "antlr-4.13"
"""MCAPL's parsers are made by it; a library that is older cannot read them."""


class UnusableError(Exception):
    """AJPF cannot run; the text says why."""


class Tools(NamedTuple):
    """The programs that run.py calls, and their versions."""

    java: str
    version: str
    javac: str
    home: Path
    class_path: str


def main(arguments: Sequence[str]) -> int:
    """Check all keys of the bundle; print a line for each, and write the result."""
    parser = argparse.ArgumentParser(description="Check this bundle with AJPF.")
    parser.add_argument("--timeout", type=float, default=3600, help="seconds for each property")
    parser.add_argument("--agent", help="your own agent, instead of SIF.gwen")
    options = parser.parse_args(arguments)
    here = Path(__file__).resolve().parent
    own = Path(options.agent).resolve() if options.agent else None
    try:
        for place in (here, *([own] if own else [])):
            if re.search(r"[^\w./+@~-]", str(place), re.ASCII):
                raise UnusableError(
                    f"AJPF reads only paths of letters, digits and `_ . / + @ ~ -`, not {place}"
                )
        manifest = intact(here, own)
        programs = tools()
        lock = alone(here)
        ran_on = digests(here, manifest, own)
        (here / "result.json").unlink(missing_ok=True)
        compile_environment(here, programs)
        shutil.rmtree(here / "run", ignore_errors=True)
        (here / "run").mkdir()
        ran = {check["jpf"]: prepared(here, check, own) for check in manifest["checks"]}
        (here / "logs").mkdir(exist_ok=True)
    except UnusableError as error:
        print(f"error: {error}", file=sys.stderr)
        return BAD
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
        return BAD
    if own is not None:
        print(f"about the agent {own}, SHA-256 {ran_on[str(own)][:12]}...")
    command = [programs.java, *shlex.split(os.environ.get("AJPF_JAVA_OPTIONS", "")), "-cp"]
    command += [programs.class_path, "gov.nasa.jpf.tool.RunJPF"]
    answers = []
    for check in manifest["checks"]:
        answer = ask(here, [*command, str(ran[check["jpf"]])], check, options.timeout)
        answers.append(answer)
        why = f" ({answer['why']})" if answer["why"] else ""
        mark = "" if answer["told"] == check["expected"] else f"EXPECTED {check['expected']}"
        print(f"{check['jpf']}: {answer['told']}, {mark or 'as expected'}{why}", flush=True)
    status, words = conclusion(answers)
    try:
        if digests(here, manifest, own) != ran_on:
            raise UnusableError("a file was changed while AJPF was running: start run.py again")
        write(here, result(manifest, programs, own, ran_on, answers, status))
    except UnusableError as error:
        print(f"error: {error}", file=sys.stderr)
        return BAD
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
        return BAD
    finally:
        lock.close()
    print(words)
    return status


# Running ---------------------------------------------------------------------------------------


def digest(path: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def intact(here: Path, own: Path | None) -> dict[str, Any]:
    """The manifest, after a check that its files are unchanged; except an agent of the user."""
    try:
        manifest: dict[str, Any] = json.loads((here / "manifest.json").read_text(encoding="utf-8"))
        files, checks = manifest["files"], manifest["checks"]
        for name, expected in files.items():
            if digest(here / name) != expected and (own is None or name != "SIF.gwen"):
                more = "; `--agent SIF.gwen` checks an agent of your own" * (name == "SIF.gwen")
                raise UnusableError(f"{name} is not the file that manifest.json lists{more}")
        if {check["role"] for check in checks} != {"requirement", "control", "mutant"}:
            raise UnusableError("manifest.json does not list all files and checks")
        if any(c["expected"] not in (HOLDS, VIOLATED) or c["jpf"] not in files for c in checks):
            raise UnusableError("manifest.json lists a check that cannot be run")
        if own is not None:
            check_name(own, manifest["agent"])
        return manifest
    except OSError as error:
        raise UnusableError(f"{error.filename}: {error.strerror}") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise UnusableError(f"manifest.json cannot be read: {error}") from error


def digests(here: Path, manifest: Mapping[str, Any], own: Path | None) -> dict[str, str]:
    """SHA-256 of each file that AJPF reads, by its name; of the user's own agent by its path."""
    by_name = {name: digest(here / name) for name in sorted(manifest["files"])}
    return by_name if own is None else {**by_name, str(own): digest(own)}


def alone(here: Path) -> IO[str]:
    """A lock, held while the file is open: two runs in one folder would read each other's files."""
    file = (here / "run.lock").open("w")
    try:
        import fcntl

        if sys.platform != "win32":
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except ImportError:
        pass  # a system without such locks
    except OSError:
        file.close()
        raise UnusableError(f"another run.py is running in {here}") from None
    return file


def check_name(own: Path, name: str) -> None:
    """Check that the user's agent has the name in the properties: AJPF crashes on any other."""
    match = re.search(r"^\s*:name:\s*(\S+)", own.read_text(encoding="utf-8"), re.MULTILINE)
    if match is None or match[1] != name:
        fault = f"is called `{match[1]}`" if match else "has no `:name:`"
        raise UnusableError(f"the agent of {own} {fault}; the properties are about `{name}`")


def tools() -> Tools:
    """Java, its compiler, and MCAPL."""
    home = os.environ.get("AJPF_HOME", "")
    if not home or not Path(home).is_dir():
        raise UnusableError("set AJPF_HOME to the folder of MCAPL")
    path = os.environ.get("PATH", os.defpath)
    if os.environ.get("JAVA_HOME"):
        path = f"{Path(os.environ['JAVA_HOME']) / 'bin'}{os.pathsep}{path}"
    java, javac = shutil.which("java", path=path), shutil.which("javac", path=path)
    if java is None or javac is None:
        raise UnusableError("java and javac are needed (JDK 11): set JAVA_HOME")
    folder = Path(home).resolve()
    libraries = class_path(folder)
    return Tools(java, java_version(java), javac, folder, libraries)


def java_version(java: str) -> str:
    """The version, such as `11.0.22`; Java PathFinder runs on Java 11 only."""
    try:
        done = subprocess.run(
            [java, "-version"], capture_output=True, text=True, errors="replace", timeout=60
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise UnusableError(f"{java} does not print its version: {error}") from error
    match = re.search(r'version "((?:1\.)?(\d+)[^"]*)"', f"{done.stderr}\n{done.stdout}")
    if match is None:
        raise UnusableError(f"{java} does not print its version")
    if int(match[2]) != JAVA:
        raise UnusableError(
            f"{java} is Java {match[1]}, and AJPF needs Java {JAVA}: other versions fail with "
            f"`NoSuchMethodError`; set JAVA_HOME to a JDK {JAVA}"
        )
    return match[1]


def class_path(home: Path) -> str:
    """The class path: MCAPL's classes, then all its libraries, the newest ANTLR first."""
    compiled = [home / "bin", *sorted((home / "build").glob("*"))]
    libraries = sorted((home / "lib").rglob("*.jar"))
    if not any(jar.name == "RunJPF.jar" for jar in libraries):
        raise UnusableError(f"there is no RunJPF.jar below {home / 'lib'}")
    if not any(jar.name.startswith(ANTLR) for jar in libraries):
        raise UnusableError(
            f"there is no {ANTLR}.*.jar below {home / 'lib'}: MCAPL's parsers need ANTLR 4.13.2"
        )
    libraries.sort(key=lambda jar: not jar.name.startswith(ANTLR))
    places = [path for path in (*compiled, *libraries) if path.exists()]
    return os.pathsep.join(map(str, places))


def compile_environment(here: Path, programs: Tools) -> None:
    """Compile the environment, into `classes/`."""
    shutil.rmtree(here / "classes", ignore_errors=True)
    (here / "classes").mkdir()
    command = [programs.javac, "--release", str(JAVA), "-nowarn", "-encoding", "UTF-8"]
    done = subprocess.run(
        [*command, "-d", "classes", "-cp", programs.class_path, "Env.java"],
        cwd=here,
        capture_output=True,
        text=True,
        errors="replace",
    )
    if done.returncode != 0:
        raise UnusableError(f"Env.java does not compile:\n{done.stdout}{done.stderr}")


def prepared(here: Path, check: Mapping[str, Any], own: Path | None) -> Path:
    """The `.jpf` and its `.ail` below `run/`, with absolute paths: AJPF may start anywhere."""
    place = here / "run"
    ail = (here / check["agent"]).read_text(encoding="utf-8")
    agent = here / check["agent"].replace(".ail", ".gwen")
    if own is not None and check["agent"] == "SIF.ail":
        agent = own
    ail = re.sub(r"(?m)^mas\.file = .*$", lambda match: f"mas.file = {agent}", ail)
    (place / check["agent"]).write_text(ail, encoding="utf-8")
    jpf: str = (here / check["jpf"]).read_text(encoding="utf-8")
    jpf = jpf.replace(f"${{config_path}}/{check['agent']}", str(place / check["agent"]))
    jpf = jpf.replace("${config_path}", str(here))
    path = place / str(check["jpf"])
    path.write_text(jpf, encoding="utf-8")
    return path


def ask(
    here: Path, command: Sequence[str], check: Mapping[str, Any], timeout: float
) -> dict[str, Any]:
    """Ask AJPF about one key: the check and its answer."""
    log = here / "logs" / f"{check['jpf']}.txt"
    began, status = time.monotonic(), 0
    why = ""
    with log.open("wb") as output:
        try:
            status = subprocess.run(
                command,
                cwd=here / "run",  # a `jpf.properties` there would count, and there is none
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                timeout=timeout,
            ).returncode
        except subprocess.TimeoutExpired:
            why = f"no answer in {timeout:g} seconds"
        except OSError as error:
            why = f"java cannot be run: {error.strerror}"
    text = log.read_text(encoding="utf-8", errors="replace")
    outcome, why = (ERROR, why) if why else verdict(text, status)
    return {
        **{name: check[name] for name in ("role", "key", "jpf", "property", "expected")},
        "told": outcome,
        "why": why,
        "seconds": round(time.monotonic() - began, 3),
        "states": states(text),
        "log": f"logs/{log.name}",
        "log_sha256": digest(log),
        "trace": trace(text) if outcome == VIOLATED else None,
    }


# Answers of AJPF -------------------------------------------------------------------------------

RESULTS = re.compile(r"^=+ results\s*$", re.MULTILINE)
EXPLAINED = (
    (
        "Could not deserialize ATN",
        "the class path begins with an ANTLR that is older than MCAPL's parsers",
    ),
    ("NoSuchMethodError", f"AJPF needs Java {JAVA}"),
)


def verdict(text: str, status: int) -> tuple[str, str]:
    """The verdict of an output; ERROR if it is not clear.

    A parser error overrides any verdict: AJPF continues with a property that differs from the
    file's.
    """
    for sign, why in EXPLAINED:
        if sign in text:
            return ERROR, why
    complaint = re.search(r"line \d+:\d+.*", text)
    if complaint is not None:
        return ERROR, f"a file was misread: {complaint[0].strip()}"
    severe = re.search(r"^.*\[SEVERE\].*$", text, re.MULTILINE)
    if severe is not None:
        return ERROR, severe[0].strip()
    if "search constraint" in text:
        return ERROR, "the search was cut short"
    if "MODEL PRODUCED BY AJPF" in text:
        return ERROR, "only the model was built (`ajpf.model_only`)"
    parts = RESULTS.split(text)
    results = parts[-1] if len(parts) == 2 else ""
    holds = re.search(r"^no errors detected\s*$", results, re.MULTILINE) is not None
    errors = re.findall(r"^error #\d+: (.*)$", results, re.MULTILINE)
    path = 'ajpf.MCAPLListener "An Accepting Path has been found'
    violated = bool(errors) and all(error.startswith(path) for error in errors)
    if holds and (errors or "An Accepting Path has been found" in text):
        return ERROR, "the output has two verdicts"
    if violated and status >= 0:
        return VIOLATED, ""
    if holds and status == 0:
        return HOLDS, ""
    if errors:
        return ERROR, f"AJPF stopped: {errors[0][:200]}"
    return ERROR, f"no verdict in the output, exit status {status}"


def states(text: str) -> dict[str, int]:
    """The numbers of the line `states:  new=303,visited=52,...`; empty if there is no such line."""
    lines = re.findall(r"^states:\s+(\S+)\s*$", text, re.MULTILINE)
    parts = lines[-1].split(",") if lines else []
    numbers = (re.fullmatch(r"(\w+)=(\d+)", part) for part in parts)
    return {number[1]: int(number[2]) for number in numbers if number}


def trace(text: str) -> dict[str, Any] | None:
    """The run that violates a property, a row for each state of the program; None if there is none.

    AJPF logs the changes of a state after its `New State is N`. Other values are those of the state
    before, and None before their first change. An action is logged before the state to which it
    leads.
    """
    path = [int(state) for state in _path(text)]
    if not path:
        return None
    prefix, cycle = folded(path)
    changes, actions = logged(text)
    names = sorted({name for number in prefix for name in changes.get(number, {})})
    values: dict[str, bool] = {}
    rows = []
    for number in prefix:
        values |= changes.get(number, {})
        rows.append([values.get(name) for name in names])
    return {
        "names": names,
        "rows": rows,
        "states": prefix,
        "actions": [actions.get(number, "") for number in prefix],
        "cycle": cycle,
    }


def _path(text: str) -> Iterator[str]:
    """The program states of the first path that is printed."""
    begin = text.find("An Accepting Path has been found")
    state = re.compile(r"\s*\[MS: (-?\d+), BS: -?\d+, UN: -?\d+\],?")
    place = text.find("[MS:", begin) if begin >= 0 else -1
    while place >= 0 and (match := state.match(text, place)) is not None:
        yield match[1]
        place = match.end()


def folded(path: Sequence[int]) -> tuple[list[int], int | None]:
    """The run without its second round, and the index where its end leads back; None: no loop."""
    for length in range(1, len(path) + 1):
        for start in range(length):
            period = length - start
            again = all(path[i] == path[i - period] for i in range(length, len(path)))
            if again and len(path) > length and len(path) - start >= 2 * period - 1:
                return list(path[:length]), start
    return list(path), None


def logged(text: str) -> tuple[dict[int, dict[str, bool]], dict[int, str]]:
    """The changes of truth values of each new state, and the action that led to it."""
    changes: dict[int, dict[str, bool]] = {}
    actions: dict[int, str] = {}
    state, action = None, ""
    form = re.compile(
        r"\[INFO\] New State is (-?\d+)|\[FINE\] Updating (.+) to (true|false)\s*$"
        r"|\[INFO\] \S+ done (.+?)\s*$"
    )
    for line in text.splitlines():
        match = form.search(line)
        if match is None:
            continue
        if match[1] is not None:
            state = int(match[1])
            changes.setdefault(state, {})
            if action:
                actions[state] = action
            action = ""
        elif match[2] is not None and state is not None:
            changes[state][match[2].replace("()", "")] = match[3] == "true"
        elif match[4] is not None:
            action = match[4]
    return changes, actions


# The result ------------------------------------------------------------------------------------


def conclusion(answers: Sequence[Mapping[str, Any]]) -> tuple[int, str]:
    """The conclusion from all verdicts: an exit status, and words."""
    if any(check["role"] == "requirement" and check["told"] == VIOLATED for check in answers):
        return REFUTED, "AJPF refutes the requirement"
    if any(check["told"] != check["expected"] for check in answers):
        words = "not shown: the verdict about the requirement counts only if each of these is shown"
        return NOT_SHOWN, words
    return SHOWN, "AJPF gives every expected verdict"


def result(
    manifest: Mapping[str, Any],
    programs: Tools,
    own: Path | None,
    ran_on: Mapping[str, str],
    answers: Sequence[Mapping[str, Any]],
    status: int,
) -> dict[str, Any]:
    """The result for fretc; its schema is `ajpf-result.schema.json`."""
    files = {name: ran_on[name] for name in sorted(manifest["files"])}
    return {
        "schema": SCHEMA,
        "requirement": manifest["requirement"],
        "fretc": manifest["fretc"],
        "weakened": manifest["weakened"],
        "verdict": {SHOWN: "shown", REFUTED: "refuted"}.get(status, "not shown"),
        "agent": {"file": str(own), "sha256": ran_on[str(own)]} if own is not None else None,
        "mcapl": {"commit": commit(programs.home)},
        "java": programs.version,
        "files": files,
        "checks": list(answers),
    }


def commit(home: Path) -> str | None:
    """The commit of a checkout, from its `.git`; None if there is none."""
    try:
        git = home / ".git"
        head = (git / "HEAD").read_text(encoding="utf-8").strip()
        if not head.startswith("ref: "):
            return head
        name = head.removeprefix("ref: ")
        if (git / name).is_file():
            return (git / name).read_text(encoding="utf-8").strip()
        packed = (git / "packed-refs").read_text(encoding="utf-8")
        return next((x.split()[0] for x in packed.splitlines() if x.endswith(f" {name}")), None)
    except (OSError, ValueError):
        return None


def write(here: Path, content: Mapping[str, Any]) -> None:
    """Write a complete result, or none."""
    path = here / "result.json.new"
    path.write_text(f"{json.dumps(content, indent=2)}\n", encoding="utf-8")
    path.replace(here / "result.json")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
