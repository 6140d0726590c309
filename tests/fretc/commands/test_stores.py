"""Every command that reads evidence says of a store what it says of a file."""

import base64
import json
import re
from pathlib import Path

import pytest

from fretc.audit.store.anywhere import source
from fretish.diagnostics.diagnostic import Diagnostic
from tests import keys
from tests.command import Fretc, Run, made_once, write
from tests.fretc.commands.test_verify_evidence import BINDINGS, R1, log

BY = ("--reviewer", "Ada", "--role", "engineer", "--comment", "c", "--date", "2026-09-01")
FILE, STORE = "build/e.json", "build/e"
COMMANDS = {
    "check": ("check", "--evidence", "{}"),
    "diff": ("diff", "--evidence", "{}", "--format", "json"),
    "verify-evidence": ("verify-evidence", "{}", "--format", "json"),
    "report": ("report", "--evidence", "{}", "--json", "out.json"),
    "lock, refused": ("lock", *BY, "--evidence", "{}", "--lock", "out.lock"),
    "lock": ("lock", *BY, "--accept-violations", "--evidence", "{}", "--lock", "out.lock"),
    "sign": ("sign", "{}", "--key", "ada"),
}


@pytest.fixture
def audited(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> Fretc:
    """Two logs that were audited into a file and into a store, then reviewed; one is now worse."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1790000000")  # 2026-09-21

    def make() -> None:
        write("requirements/r1.fret", R1)
        write("requirements/bindings.toml", BINDINGS)
        keys.written("ada")
        log("logs/good.mcap", 0, 1.5, 3, 0, 0, 0)
        log("logs/bad.mcap", 0, 1.5, 3, 0, 0, 0)
        assert fretc("audit", "logs", "-o", FILE).status == 0
        assert fretc("lock", *BY, "--evidence", FILE).status == 0
        log("logs/bad.mcap", 0, 1.5, 0, 0, 0, 0)
        for path in (FILE, STORE):
            assert fretc("audit", "logs", "-o", path).status == 1
        assert Path(STORE, "evidence.sqlite").is_file()

    made_once("a file and a store", make)
    return fretc


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_a_store_is_to_a_command_what_a_file_is(audited: Fretc, command: str) -> None:
    file, store, slash = (said(audited, command, path) for path in (FILE, STORE, f"{STORE}/"))
    assert file == store == slash
    assert "bad.mcap" in f"{file}" or command == "check"


def said(fretc: Fretc, command: str, path: str) -> tuple[Run, str]:
    """What is printed, and what is written; the name and the hash of the evidence left out."""
    run = fretc(*(word.format(path) for word in COMMANDS[command]))
    outputs = [*Path().glob("out.*"), *Path("build").glob("*.intoto.jsonl")]
    written = "".join(output.read_text() for output in outputs)
    for output in outputs:
        output.unlink()
    return Run(run.status, _bare(run.out, path), _bare(run.err, path)), _bare(written, path)


def _bare(text: str, path: str) -> str:
    """Without what a file and a store must differ in; of an envelope what it says."""
    if text.startswith('{"payload'):
        text = base64.b64decode(json.loads(text)["payload"]).decode()
    known = source(path)
    assert not isinstance(known, Diagnostic)
    name = re.escape(path.rstrip("/"))
    text = text.replace(known.sha256, "SHA")
    text = text.replace(f'"evidence:{Path(path).name}"', '"evidence:EVIDENCE"')
    return re.sub(rf"\b{name}(?!\w)/?", "EVIDENCE", text)
