"""Of two values by one key no reader takes one: another reader would take the other."""

from pathlib import Path

import pytest

from tests.readers import AJPF, EXPORT, NEEDS, STRICTDOC, command, put, readers

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
@pytest.mark.parametrize("kind", TWICE)
def test_a_key_that_comes_twice_is_refused(tmp_path: Path, kind: str) -> None:
    reader = readers(tmp_path / "sound")[kind]
    put(tmp_path, reader.beside)
    for text, refused in ((reader.sound.decode(), False), (TWICE[kind], True)):
        put(tmp_path, {reader.file: text})
        status, said, _ = command(tmp_path, *reader.args)
        assert ("twice" in said) is refused, said
        assert status == 2 or not refused
