"""Evidence that cannot be read, or contradicts itself, is refused by each command that reads it."""

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

import pyarrow as pa
import pytest

from compiler.project.folder import load
from fretc.api.refusal import Refusal
from fretc.api.reports import make_report
from fretc.audit.store.reader import Store, opened
from fretc.audit.store.tables import RESULTS, VIOLATIONS
from tests import keys
from tests.command import Fretc, made_once, write
from tests.effort import some
from tests.fretc.audit.store.test_hostile import changed, with_table
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


def _of_table(name: str) -> Path:
    (path,) = Path(STORE, name).iterdir()
    return path


def _truncated(name: str) -> None:
    path = _of_table(name)
    path.write_bytes(path.read_bytes()[:-9])


def _satisfied() -> None:
    """The verdict is changed, and the manifest has the new hash."""
    table = _tables().whole(RESULTS)
    verdicts = pa.array(["satisfied"] * len(table), pa.string())
    place = table.schema.get_field_index("verdict")
    with_table(Path(STORE), RESULTS, table.set_column(place, table.field(place), verdicts))


def _without_violations() -> None:
    with_table(Path(STORE), VIOLATIONS, _tables().whole(VIOLATIONS).slice(0, 0))


def _named_otherwise() -> None:
    """The results of one requirement are said to be of another one."""
    table = _tables().whole(RESULTS)
    names = pa.array(["other"] * len(table), pa.string())
    place = table.schema.get_field_index("requirement")
    with_table(Path(STORE), RESULTS, table.set_column(place, table.field(place), names))


def _tables() -> Store:
    store = opened(STORE)
    assert isinstance(store, Store)
    return store


def _emptied() -> None:
    shutil.rmtree(STORE)
    Path(STORE).mkdir()


def _cut() -> None:
    Path(FILE).write_text(Path(FILE).read_text()[:-40])


FAULTS: Mapping[str, tuple[str, Callable[[], object]]] = {
    "nothing is there": (STORE, lambda: shutil.rmtree(STORE)),
    "an empty folder": (STORE, _emptied),
    "a manifest that is cut": (STORE, lambda: Path(STORE, "manifest.json").write_text('{"sch')),
    "a manifest that is not text": (
        STORE,
        lambda: Path(STORE, "manifest.json").write_bytes(b"\xff"),
    ),
    "no manifest": (STORE, lambda: Path(STORE, "manifest.json").unlink()),
    "an audit that was stopped": (
        STORE,
        lambda: Path(STORE, "manifest.json").rename(Path(STORE, "unfinished.json")),
    ),
    "a field too many": (STORE, lambda: changed(Path(STORE), lambda m: m.update(more=1))),
    "a table that is missing": (STORE, lambda: _of_table("violations").unlink()),
    "a table that is cut": (STORE, lambda: _truncated("events")),
    "a verdict with a new hash": (STORE, _satisfied),
    "no violations, with a new hash": (STORE, _without_violations),
    "another requirement, with a new hash": (STORE, _named_otherwise),
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
