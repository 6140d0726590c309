"""Evidence that cannot be read, or contradicts itself, is refused by each command that reads it."""

import shutil
import sqlite3
from collections.abc import Callable, Mapping
from contextlib import closing
from pathlib import Path

import pytest

from compiler.project.folder import load
from fretc.api.refusal import Refusal
from fretc.api.reports import make_report
from tests import keys
from tests.command import Fretc, made_once, write
from tests.effort import some
from tests.fretc.audit.store.test_hostile import edit, seal, with_record
from tests.fretc.commands.test_verify_evidence import BINDINGS, R1, log

BY = ("--reviewer", "Ada", "--role", "engineer", "--comment", "c")
COMMANDS: Mapping[str, tuple[str, ...]] = {
    "check": ("check", "--evidence"),
    "diff": ("diff", "--evidence"),
    "lock": ("lock", *BY, "--lock", "out.lock", "--evidence"),
    "lock of violations": ("lock", *BY, "--accept-violations", "--lock", "out.lock", "--evidence"),
    "report": ("report", "--json", "out.json", "--evidence"),
    "report with a page to play": ("report", "--play", "-o", "out.html", "--evidence"),
    "trends": ("trends", "sound.json"),
    "coverage": ("coverage", "--evidence"),
    "summary": ("audit", "--summary"),
    "sign": ("sign", "--key", "ada"),
    "verify-evidence": ("verify-evidence",),
}
FILE, STORE = "build/e.json", "build/e"


CONTAINER = Path(STORE, "evidence.sqlite")


def _edited(statement: str) -> None:
    edit(Path(STORE), statement)
    seal(Path(STORE))


def _satisfied() -> None:
    """The verdict is changed, and the hash is not."""
    with closing(sqlite3.connect(CONTAINER)) as connection:
        (digest,) = connection.execute("SELECT sha256 FROM about").fetchone()
    with_record(Path(STORE), lambda run: run["results"][0].update(verdict="satisfied"))
    edit(Path(STORE), f"UPDATE about SET sha256 = '{digest}'")


def _named_otherwise() -> None:
    """One of the results is said to be of another run."""
    with_record(Path(STORE), lambda run: run["results"][0].update(run="other"))


def _emptied() -> None:
    shutil.rmtree(STORE)
    Path(STORE).mkdir()


def _cut() -> None:
    Path(FILE).write_text(Path(FILE).read_text()[:-40])


FAULTS: Mapping[str, tuple[str, Callable[[], object]]] = {
    "nothing is there": (STORE, lambda: shutil.rmtree(STORE)),
    "an empty folder": (STORE, _emptied),
    "a file that is cut": (STORE, lambda: CONTAINER.write_bytes(CONTAINER.read_bytes()[:-9])),
    "a file that is text": (STORE, lambda: CONTAINER.write_text("text")),
    "no file": (STORE, CONTAINER.unlink),
    "an audit that was stopped": (
        STORE,
        lambda: CONTAINER.rename(CONTAINER.with_name("unfinished-1.sqlite")),
    ),
    "a head of something else": (STORE, lambda: _edited("UPDATE about SET head = '{}'")),
    "a run that is missing": (STORE, lambda: edit(Path(STORE), "DELETE FROM runs")),
    "a record that is another": (
        STORE,
        lambda: edit(Path(STORE), "UPDATE runs SET record = x'00'"),
    ),
    "a verdict without a new hash": (STORE, _satisfied),
    "no violations, with a new hash": (
        STORE,
        lambda: with_record(Path(STORE), lambda run: run["results"][0].pop("violations")),
    ),
    "another run, with a new hash": (STORE, _named_otherwise),
    "JSON that is cut": (FILE, _cut),
    "an empty file": (FILE, lambda: Path(FILE).write_text("")),
    "JSON of something else": (FILE, lambda: Path(FILE).write_text('{"schema": "x"}')),
}


@pytest.fixture
def audited(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> Fretc:
    """A violated requirement that was reviewed before, and its evidence in a file and a store."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1790000000")

    def make() -> None:
        write("requirements/r1.fret", R1)
        write("requirements/bindings.toml", BINDINGS)
        keys.written("ada")
        log("logs/bad.mcap", 0, 1.5, 0, 0, 0, 0)
        for path in (FILE, STORE, "sound.json"):
            assert fretc("audit", "logs", "-o", path).status == 1
        assert fretc("lock", *BY, "--accept-violations", "--evidence", FILE).status == 0

    made_once("evidence that was reviewed", make)
    return fretc


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_no_command_draws_a_conclusion_from_bad_evidence(audited: Fretc, fault: str) -> None:
    """By default a third of the commands is tried with each fault, in turn."""
    place, make_it = FAULTS[fault]
    make_it()
    before = {path for path in Path().rglob("*") if path.is_file()}
    number = [*FAULTS].index(fault)
    for name, words in some(COMMANDS.items(), 3, number % 3):
        run = audited(*words, place)
        assert run.status == 2, name
        assert run.err.startswith("F") or " error: " in run.err, name
        assert not {path for path in Path().rglob("*") if path.is_file()} - before, name
        if name != "check":  # it lists all that is wrong, and counts it
            assert run.out == "", name
    if fault != "nothing is there":
        with pytest.raises(Refusal):
            make_report(load(["requirements/r1.fret"], "requirements/bindings.toml"), place)


@pytest.mark.slow
def test_sound_evidence_is_refused_by_none(audited: Fretc) -> None:
    for words in COMMANDS.values():
        for place in (FILE, STORE):
            run = audited(*words, place)
            assert not {"F503", "F516"} & {*(run.err + run.out).split()}
