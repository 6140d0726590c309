"""One name for each path, printable, and back."""

from __future__ import annotations

import os
import subprocess

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fretc.logs.storage.log_names import STDIN, is_url, name_of, path_of, shell_word

PARTS = st.sampled_from(
    [
        b"\\",
        b"\\n",
        b"\\xff",
        b"\n",
        b"\r",
        b"\xff",
        b"\xed\xb2\x80",
        b"%0A",
        b"\xc2\xa0",
        b"a",
        b"/",
    ]
)
NAMES = st.lists(PARTS | st.binary(max_size=3), min_size=1).map(b"".join)


@given(NAMES.map(lambda name: name.replace(b"\0", b"")).filter(bool))
@example(b"<stdin>")
@example(b"./<stdin>")
def test_a_name_is_printable_and_of_one_path(name: bytes) -> None:
    path = os.fsdecode(name)
    shown = name_of(path)
    assert shown.isprintable()
    assert shown.encode("utf-8")
    if path != STDIN and "://" not in path:
        assert os.path.normpath(path_of(shown)) == os.path.normpath(path)
        assert name_of(path_of(shown)) == shown


@given(NAMES.map(lambda name: name.replace(b"\0", b"")).filter(bool))
@settings(max_examples=20)
def test_a_shell_reads_the_word_of_a_path_as_that_path(name: bytes) -> None:
    word = shell_word(os.fsdecode(name))
    assert word.isprintable()
    done = subprocess.run(["bash", "-c", f"printf %s {word}"], capture_output=True, check=True)
    assert done.stdout.removeprefix(b"./") == name.removeprefix(b"./")


@given(st.text())
def test_a_name_from_elsewhere_is_a_path_that_has_a_name(name: str) -> None:
    path = path_of(name)
    assert path == name or name_of(path) == name
    assert "\0" not in path or path == name


def test_a_path_of_windows_is_shown_with_slashes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sep", "\\")
    assert name_of("C:\\logs\\run 1.mcap") == "C:/logs/run 1.mcap"
    assert path_of("C:/logs/run 1.mcap") == "C:/logs/run 1.mcap"
    assert not is_url("C://logs/run.mcap")
    assert is_url("s3://bucket/run.mcap")


def test_what_is_usual_stays_as_it_is() -> None:
    for path in ("runs/a b.mcap", "./café.mcap", "../x%20y", "https://x.org/a.mcap?v=1"):
        assert name_of(path) == path
        assert path_of(path) == path
    assert name_of(STDIN) == "<stdin>"
    assert (
        name_of("https://me:pw@x.org/\udcff.mcap?token=3") == r"https://x.org/\xff.mcap?token=..."
    )
