"""Commands that are shown are run by a shell, with names that somebody else has chosen."""

import hashlib
import os
import subprocess
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.files.shell_quoting import (
    UnencodableNameError,
    check_of,
    is_sha256,
    unquotable_comment,
    word,
    words,
)
from fretc.report.make import make
from tests.command import Fretc
from tests.effort import some
from tests.fretc.report.cases import as_json, project, report_of, result

HOSTILE = (
    "a b.mcap",
    "$(touch PWNED).mcap",
    "`touch PWNED`.mcap",
    "a.mcap; touch PWNED #.mcap",
    "' ; touch PWNED; '.mcap",
    '"$(touch PWNED)".mcap',
    "a\\.mcap",
    "\\n.mcap",
    "END",
    "-rf.mcap",
    "--output=PWNED.mcap",
    "*.mcap",
    "~root.mcap",
    " a.mcap ",
    "!!.mcap",
    "%s%n.mcap",
    "&& touch PWNED && .mcap",
    "ä€😀.mcap",
)


def shell(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["/bin/sh", "-c", command], cwd=folder, capture_output=True, text=True, check=False
    )


@given(st.lists(st.text(st.characters(exclude_characters="\0")), max_size=4))
def test_what_a_shell_reads_is_the_name_and_no_option(names: list[str]) -> None:
    try:
        command = words(names)
    except UnencodableNameError:
        assert any(not name or not name.isprintable() for name in names)
        return
    assert command.isprintable()
    done = subprocess.run(
        ["/bin/sh", "-c", f"printf '%s\\0' {command}"], capture_output=True, check=True
    )
    read = os.fsdecode(done.stdout).split("\0")[:-1] if names else []
    assert read == [f"./{name}" if name.startswith("-") else name for name in names]


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE)
def test_the_hashes_of_files_of_any_name_are_checked_and_nothing_else_happens(
    tmp_path: Path, name: str
) -> None:
    (tmp_path / name).write_text("good")
    sha256 = hashlib.sha256(b"good").hexdigest()
    before = sorted(os.listdir(tmp_path))
    assert shell(check_of([(sha256, name)]), tmp_path).returncode == 0
    (tmp_path / name).write_text("evil")
    assert shell(check_of([(sha256, name)]), tmp_path).returncode == 1
    assert sorted(os.listdir(tmp_path)) == before


@pytest.mark.parametrize(
    "name", ["a\nEND\ntouch PWNED\n.mcap", "a\r.mcap", "a\x1b[2Jb.mcap", "a\u202eb.mcap", ""]
)
def test_a_name_that_cannot_be_pasted_is_told_in_a_comment(tmp_path: Path, name: str) -> None:
    with pytest.raises(UnencodableNameError):
        word(name)
    with pytest.raises(UnencodableNameError):
        check_of([("0" * 64, name)])
    comment = unquotable_comment(name)
    assert comment.isprintable()
    assert (shell(comment, tmp_path).stdout, os.listdir(tmp_path)) == ("", [])


@pytest.mark.parametrize("sha256", ["", "0" * 63, "0" * 65, "A" * 64, "0" * 64 + "\n", "$(x)"])
def test_what_is_no_hash_is_not_shown_in_a_command(sha256: str) -> None:
    assert not is_sha256(sha256)
    assert check_of([(sha256, "a.mcap")]) == ""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a\nEND\ntouch PWNED\n.mcap", *some(HOSTILE, 4)])
def test_the_commands_of_a_report_execute_nothing_that_evidence_names(
    fretc: Fretc, tmp_path: Path, name: str
) -> None:
    """`fretc` is a stand-in that does nothing: whatever else is executed, a name has done."""
    known = project(tmp_path / "req")
    report_of(known, tmp_path, result(known, "satisfied", run=f"{name}.mcap"))
    commands = as_json(make(known, str(tmp_path / "evidence.json")))["commands"]
    place = tmp_path / "run"
    place.mkdir()
    for command in commands:
        shell(f"fretc() {{ :; }}\n{command['text']}", place)
    assert os.listdir(place) == []
