"""Whatever bytes a file has, its reader answers with a message of its own, and soon.

Some files for each reader, and more with the full profile; `python -m tests.fuzzing --readers 1000`
feeds as many as are asked for.
"""

from collections.abc import Mapping
from pathlib import Path

import pytest

from tests.each import each
from tests.effort import FULL
from tests.readers import (
    AJPF,
    EXPORT,
    NEEDS,
    STRICTDOC,
    Reader,
    command,
    fuzzed,
    put,
    readers,
)

_SLOW = {"monitor", "interceptor", "psl", "Gwendolen"}
"""Their proofs run in processes of their own."""


@pytest.fixture(scope="module")
def known(tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, Reader]:
    return readers(tmp_path_factory.mktemp("sound"))


@pytest.mark.slow
def test_every_reader_reads_its_sound_file(known: Mapping[str, Reader], tmp_path: Path) -> None:
    for number, (name, reader) in enumerate(known.items()):
        folder = tmp_path / str(number)
        put(folder, {**reader.beside, reader.file: reader.sound})
        status, text, _ = command(folder, *reader.args)
        assert status in (0, 1, 3), f"{name}: {text}"


@pytest.mark.slow
def test_mutations_get_an_answer_from_every_reader(
    known: Mapping[str, Reader], tmp_path: Path
) -> None:
    for number, (name, reader) in enumerate(known.items()):
        count = (3 if name in _SLOW else 30) if FULL else (1 if name in _SLOW else 4)
        fuzzed(name, reader, tmp_path / str(number), count, seed=16)


TWICE = {
    "FRET's JSON": EXPORT.replace(
        '"fulltext":', '"fulltext": "the sw shall satisfy q", "fulltext":'
    ),
    "needs.json": NEEDS.replace('"title":', '"title": "u", "title":'),
    "StrictDoc": STRICTDOC.replace('"STATEMENT":', '"STATEMENT": "u", "STATEMENT":'),
    "Doorstop": "HAZ-1: {active: true, level: 1.0, text: a}\n" * 2,
    "AJPF's result": AJPF.replace('"told": "HOLDS"', '"told": "VIOLATED", "told": "HOLDS"'),
}


@pytest.mark.slow
@each("kind", TWICE)
def test_a_key_that_comes_twice_is_refused(
    known: Mapping[str, Reader], tmp_path: Path, kind: str
) -> None:
    """Of two values by one key no reader takes one: another reader would take the other."""
    reader, folder = known[kind], tmp_path / kind
    put(folder, reader.beside)
    for text, refused in ((reader.sound.decode(), False), (TWICE[kind], True)):
        put(folder, {reader.file: text})
        status, said, _ = command(folder, *reader.args)
        assert ("twice" in said) is refused, said
        assert status == 2 or not refused
