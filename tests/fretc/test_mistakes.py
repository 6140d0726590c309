"""A mistake refuses what reads it, in every command; all else is made as without the refused.

What reads what is computed of the texts of the project. What a command is to make of the rest is
what it makes of a project in which the refused requirements, and the broken table, are not there.
"""

import csv
import io
import json
import re
import shutil
import tomllib
from collections.abc import Callable, Mapping
from contextlib import chdir
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from compiler.emit import TARGETS
from fretc import cli
from fretc.terminal.group import DEFAULT
from tests.command import Fretc, Run, without_processes, write
from tests.effort import FULL, some
from tests.fretc.audit.test_refusals import log

BINDINGS = """\
[clock]
tick = "100 ms"

[signal.x]
path = "/a.x"
role = "output"

[signal.y]
path = "/a.x"
role = "output"

[proposition.p]
expr = "x > 0"
role = "output"

[proposition.q]
expr = "y > 0 or x > 0"
role = "output"

[proposition.r]
expr = "x >= 0"
role = "output"

[interceptor]
stop = "/stop"
command = "/cmd_vel"
output = "/wheels"
period = "50 ms"
"""
HAZARDS = '[HAZ-1]\ntitle = "It collides"\n[HAZ-2]\ntitle = "It stops"\n'
SHARED = ("interceptor", "assume", "environment", "map", "run", "agent")
"""Tables that belong to no single requirement; `environment` is `[[assume.requirement]]`."""
SENTENCES = {
    "R1": "the alpha shall always satisfy p",
    "R2": "whenever q the alpha shall within 2 ticks satisfy q",
    "R3": "the beta shall always satisfy x >= 0",
    "R4": "the beta shall always satisfy r",
}
PARENTS = {"R1": '["HAZ-1"]', "R2": '["R1"]', "R3": "[]", "R4": "[]"}
FILES = {
    **{
        f"{id.lower()}.fret": f'+++\nid = "{id}"\nparents = {PARENTS[id]}\n+++\n{sentence}\n'
        for id, sentence in SENTENCES.items()
    },
    "bindings.toml": BINDINGS,
    "hazards.toml": HAZARDS,
    "fretc.toml": "",
}


@dataclass(frozen=True)
class Mistake:
    """One edit of one file, the code of the message, and the table that it breaks, if any."""

    file: str
    code: str
    old: str
    new: str
    table: tuple[str, str] | None = None

    @property
    def text(self) -> bytes:
        if self.old == "all":
            return self.new.encode("latin-1")
        assert FILES[self.file].count(self.old) == 1
        return FILES[self.file].replace(self.old, self.new).encode()


def of_table(name: str, new: str, code: str = "F303") -> Mistake:
    """A mistake in a table that belongs to no single requirement, at the end of the bindings."""
    return Mistake("bindings.toml", code, '"50 ms"\n', new, (name, ""))


MISTAKES = {
    "no FRETish": Mistake("r2.fret", "F107", "shall", "must"),
    "a misspelt timing": Mistake("r3.fret", "F107", "always", "allways"),
    "a header that is no TOML": Mistake("r1.fret", "F102", 'id = "R1"', 'id = "R1'),
    "an unknown field": Mistake("r4.fret", "F103", "parents", "parent"),
    "a bad value": Mistake("r2.fret", "F105", "parents", "status = 3\nparents"),
    "an open header": Mistake("r3.fret", "F113", "]\n+++", "]"),
    "an id that is taken": Mistake("r4.fret", "F201", '"R4"', '"R3"'),
    "a parameter without a binding": Mistake(
        "r1.fret", "F309", "+++\nthe", "params = { z = '1 m' }\n+++\nthe"
    ),
    "a file that is no text": Mistake("r2.fret", "F904", "all", "\xff\xfe\x00"),
    "half a tick": Mistake("r2.fret", "F307", "2 ticks", "50 milliseconds"),
    "a broken signal": Mistake(
        "bindings.toml", "F303", 'y]\npath = "/a.x"', 'y]\npath = "/a"', ("signal", "y")
    ),
    "a broken proposition": Mistake(
        "bindings.toml", "F308", "x >= 0", "x >=", ("proposition", "r")
    ),
    "a broken clock": Mistake("bindings.toml", "F303", '"100 ms"', '"0 ms"', ("clock", "")),
    "a broken interceptor": of_table("interceptor", '"0 ms"\n'),
    "a broken loop": of_table("assume", '"50 ms"\n[assume]\nlatency = 3\n'),
    "a broken assumption": of_table(
        "environment", '"50 ms"\n[[assume.requirement]]\nid = "E1"\n'
    ),
    "a broken map": of_table("map", '"50 ms"\n[map]\nx = 3\n'),
    "a broken label": of_table("run", '"50 ms"\n[run.label]\nversion = 3\n', "F551"),
    "a broken agent": of_table("agent", '"50 ms"\n[agent]\ntrace = 3\n'),
    "a broken hazard": Mistake("hazards.toml", "F502", '[HAZ-2]\ntitle = "It stops"', "[HAZ-2]"),
    "broken settings": Mistake("fretc.toml", "F520", "all", "accept = 3\n"),
}  # fmt: skip


# What reads what ---------------------------------------------------------------------------------


def refused(mistake: Mistake) -> set[str]:
    """The requirements whose formulas and bindings a mistake reaches."""
    if mistake.file.endswith(".fret"):
        return {"R3", "R4"} if mistake.code == "F201" else {mistake.file[:-5].upper()}
    if mistake.table is None:
        return set()
    if mistake.table == ("clock", ""):
        return {*SENTENCES}
    if mistake.table[0] in SHARED:
        return set()
    expressions = {name: t["expr"] for name, t in tomllib.loads(BINDINGS)["proposition"].items()}
    broken = {mistake.table[1]} | {
        name for name, text in expressions.items() if mistake.table[1] in re.findall(r"\w+", text)
    }
    return {id for id, text in SENTENCES.items() if broken & {*re.findall(r"\w+", text)}}


def bindings(mistake: Mistake) -> set[str]:
    """Nothing is made of the bindings alone where none of them can be used."""
    return {*SENTENCES} if mistake.table == ("clock", "") else set()


def unreviewable(mistake: Mistake) -> set[str]:
    """Those, and the ones that read it on the way up to what they are there for.

    R2 has R1 above it, whose header it reads.
    """
    reached = refused(mistake)
    if mistake.file == "r1.fret" and mistake.code == "F102":
        reached |= {"R2"}
    if mistake.file == "hazards.toml":
        reached |= {"R1", "R2"}
    if mistake.file == "fretc.toml":
        reached |= {*SENTENCES}
    return reached


# The projects ------------------------------------------------------------------------------------


def whole(folder: str) -> None:
    for name, text in FILES.items():
        write(f"{folder}/requirements/{name}", text)
    log(f"{folder}/l.mcap", [1, 1, 2, 0])


def with_mistake(folder: str, mistake: Mistake) -> None:
    whole(folder)
    Path(folder, "requirements", mistake.file).write_bytes(mistake.text)


def without(folder: str, ids: set[str], mistake: Mistake) -> None:
    """The project in which what a mistake refuses is not there, each line in its place."""
    whole(folder)
    for id in ids:
        Path(folder, f"requirements/{id.lower()}.fret").unlink()
    if mistake.table and mistake.table[1]:
        tables = re.split(r"(?m)^(?=\[)", BINDINGS)
        kept = [each if not _is_lost(each, mistake.table[1]) else "#\n" * each.count("\n")
                for each in tables]  # fmt: skip
        write(f"{folder}/requirements/bindings.toml", "".join(kept))


def _is_lost(table: str, name: str) -> bool:
    return f".{name}]" in table or (table.startswith("[proposition") and f"{name} >" in table)


# What commands make ------------------------------------------------------------------------------

Made = Mapping[str, Any]
"""What a command makes, by requirement or by file."""


@dataclass(frozen=True)
class Command:
    words: tuple[str, ...]
    made: Callable[[Run], Made]
    """Of the current folder; what is about refused requirements is left out by `check`."""
    before: tuple[tuple[str, ...], ...] = ()
    """Commands on the whole project."""
    reads: Callable[[Mistake], set[str]] = refused
    tables: frozenset[str] = frozenset(SHARED)
    """The tables that belong to no single requirement and that it reads."""
    all_or_nothing: bool = False

    def reached(self, mistake: Mistake) -> set[str]:
        """The requirements that it cannot take."""
        if mistake.table is None or mistake.table[0] not in SHARED:
            return self.reads(mistake)
        return {*SENTENCES} if mistake.table[0] in self.tables else set()


def files(_: Run) -> Made:
    """Every file below `build`, but for how long it took, and answers kept for this very folder."""
    found = (path for path in Path("build").rglob("*") if path.is_file())
    found = (path for path in found if path.suffix != ".answers")
    return {str(p): re.sub(rb'"seconds": [\d.e-]+', b"", p.read_bytes()) for p in found}


def rows(path: str, key: str = "requirement", part: str = "") -> Callable[[Run], Made]:
    """The objects of a file of JSON, each by its requirement."""

    def made(_: Run) -> Made:
        data = json.loads(Path(path).read_text()) if Path(path).exists() else {}
        return {str(each[key]): each for each in (data.get(part) or ())}

    return made


def audited(run: Run) -> Made:
    """What evidence has of each requirement, but for the log as a whole and fingerprints of it."""
    made = rows("build/evidence.json", part="results")(run)
    return {id: {k: v for k, v in each.items() if k != "health"} for id, each in made.items()}


def printed(key: str) -> Callable[[Run], Made]:
    return lambda run: {each[key]: each for each in (json.loads(run.out) if run.out else [])}


def covered(run: Run) -> Made:
    return {each["id"]: each for each in json.loads(run.out)["requirements"]} if run.out else {}


def watched(run: Run) -> Made:
    ends = [json.loads(line) for line in run.out.splitlines() if '"type": "run"' in line]
    return dict(ends[-1]["verdicts"]) if ends else {}


def played(_: Run) -> Made:
    page = Path("build/play.html")
    text = page.read_text() if page.exists() else ""
    return {line.split('"')[1]: line for line in text.splitlines() if line.startswith('  { id: "')}


def reported(_: Run) -> Made:
    if not Path("r.csv").exists():
        return {}
    table = csv.DictReader(io.StringIO(Path("r.csv").read_text()))
    return {row["requirement"]: row["verdict"] for row in table}


def locked(_: Run) -> Made:
    path = Path("requirements/fretc.lock")
    return tomllib.loads(path.read_text())["review"] if path.exists() else {}


def checked(run: Run) -> Made:
    """Propositions of `bind --check`: they are those of the bindings, no matter who names them."""
    found = json.loads(run.out)["propositions"] if run.out else []
    return {each["name"]: each for each in found if not each["name"].startswith("(")}


def nothing(_: Run) -> Made:
    return {}


READ_THE_LOOP = {"dafny", "interceptor", "ros1-package", "ros2-package", "ros2-cpp-package"}
OF_LOOP = frozenset({"interceptor", "assume"})
OF_AUDITS = frozenset({"map", "run", "agent"})
OF_TESTS = OF_AUDITS | {"environment"}
AUDIT = ("audit", "l.mcap", "-o", "build/evidence.json", "--jobs", "1")
LOCK = ("lock", "--reviewer", "a", "--role", "b", "--comment", "c", "--date", "2026-11-20",
        "--accept-violations")  # fmt: skip
COMMANDS = {
    **{
        f"--emit {name}": Command(
            ("requirements", "--emit", name),
            files,
            all_or_nothing=not target.per_rule and not target.of_bindings,
            reads=bindings if target.of_bindings else refused,
            tables=OF_LOOP if name in READ_THE_LOOP else frozenset(),
        )
        for name, target in TARGETS.items()
    },
    "--one-file": Command(
        ("requirements", "--emit", "monitor", "--one-file"),
        files,
        all_or_nothing=True,
        tables=frozenset(),
    ),
    "--format json": Command(
        ("requirements", "--format", "json"), printed("id"), tables=frozenset()
    ),
    "explain": Command(
        ("explain", "requirements/", "--format", "json"), printed("id"), tables=frozenset()
    ),
    "analyze": Command(("analyze",), files, tables=frozenset({"environment"})),
    "analyze --component": Command(
        ("analyze", "--component", "alpha"), files, tables=frozenset({"environment"})
    ),
    "test": Command(("test", "--jobs", "1"), files, tables=OF_TESTS),
    "test --emit": Command(("test", "--jobs", "1", "--emit", "csv"), files, tables=OF_TESTS),
    "play": Command(("play",), played, tables=frozenset({"environment"})),
    "verify": Command(("verify", "--layer", "monitor"), files, tables=OF_LOOP),
    "audit": Command(AUDIT, audited, tables=OF_AUDITS),
    "coverage": Command(
        ("coverage", "l.mcap", "--format", "json", "--jobs", "1"), covered, tables=OF_AUDITS
    ),
    "mutate": Command(
        ("mutate", "--against", "l.mcap", "--format", "json", "--jobs", "1"),
        covered,
        tables=OF_AUDITS,
    ),
    "watch": Command(("watch", "l.mcap", "--format", "jsonl"), watched, tables=OF_AUDITS),
    "report": Command(("report", "--csv", "r.csv"), reported, (AUDIT,)),
    "check": Command(("check",), nothing, (), unreviewable),
    "lock": Command(LOCK, locked, (AUDIT,), unreviewable),
    "diff": Command(("diff", "--format", "json"), printed("requirement"), (LOCK,), unreviewable),
    "verify-evidence": Command(
        ("verify-evidence", "--no-proofs", "--no-analysis", "--jobs", "1"), nothing, (AUDIT,)
    ),
    "bind --check": Command(
        ("bind", "--check", "l.mcap", "--format", "json", "--jobs", "1"),
        checked,
        tables=OF_AUDITS,
    ),
}
NO_PROJECT = {
    "init", "fmt", "import", "info", "trends", "sign", "sbom", "completion", "simulate",
    "lsp", "write",
}  # fmt: skip
"""Commands that take no project, each file of it by itself, or its names alone."""


def test_every_command_that_takes_a_project_is_tried() -> None:
    named = {each.words[0] for each in COMMANDS.values()} - {"requirements"}
    assert named | NO_PROJECT | {DEFAULT} == {*cli.cli.commands}


def outcome(
    fretc: Fretc, folder: str, command: Command, edit: Callable[[], None]
) -> tuple[Run, Made]:
    """A command in a project that was whole for the commands before it."""
    whole(folder)
    with chdir(folder):
        for words in command.before:
            fretc(*words)
    edit()
    with chdir(folder):
        run = fretc(*command.words)
        return run, command.made(run)


def check(fretc: Fretc, mistake: Mistake, command: Command) -> None:
    """The law: all but what reads the mistake is made, the rest is named, and the status is 2."""
    reached = command.reached(mistake)
    run, now = outcome(fretc, "now", command, lambda: with_mistake("now", mistake))
    _, rest = outcome(fretc, "then", command, lambda: others("then", mistake, command))
    assert run.status == 2 or not _is_read(mistake, command)
    assert f"{mistake.code} " in run.err or not _is_read(mistake, command)
    if (command.all_or_nothing and reached) or reached == {*SENTENCES}:
        assert not set(now) - {"R1", "R2", "R3", "R4", "r1", "r2"} or not now
        rest = {}
    names = reached | {id.lower() for id in reached}
    kept = {key: value for key, value in now.items() if key not in names}
    assert kept == {key: value for key, value in rest.items() if key not in names}
    for id in reached if reached < {*SENTENCES} and command.made is not nothing else ():
        assert id in now or re.search(rf"\b{id}\b", f"{run.err}{run.out}", re.IGNORECASE), id


def others(folder: str, mistake: Mistake, command: Command) -> None:
    """Take out what is refused; what is above a requirement is part of its review, and stays."""
    if command.reads is not unreviewable:
        without(folder, refused(mistake), mistake)


def _is_read(mistake: Mistake, command: Command) -> bool:
    """Whether the command reads the file at all: hazards are nothing to a formula."""
    return mistake.file != "hazards.toml" or command.words[0] in ("report", "check", "lock", "diff")


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_a_mistake_refuses_what_reads_it_and_nothing_else(
    fretc: Fretc, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    """Each target, and what draws tests, with one mistake; the rest with one of a requirement and
    with one of the other files; with all with the full profile."""
    if not FULL:
        without_processes(monkeypatch)
    step = len(MISTAKES) if command.startswith(("--emit", "test")) else 10
    for kind in some(MISTAKES, step, [*COMMANDS].index(command) % step):
        for folder in ("now", "then"):
            shutil.rmtree(folder, ignore_errors=True)
        try:
            check(fretc, MISTAKES[kind], COMMANDS[command])
        except BaseException as error:
            error.add_note(f"where the mistake is {kind}")
            raise
