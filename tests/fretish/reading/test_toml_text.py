from itertools import pairwise

import pytest

from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Source
from fretish.reading.toml_text import Tables, read

TEXT = """\
top = 1

[signal.near]
path = "/a"
far = "in the wrong table"

[ signal . far ]
path = "/b"

["signal".'x.y']
path = "/c"

[map]
inline = { path = "/d" }
"""


def tables(text: str) -> Tables:
    found = read(Source("b.toml", text).span(), Code.BAD_BINDINGS, "the file")
    assert isinstance(found, Tables)
    return found


@pytest.mark.parametrize(
    ("path", "line", "text"),
    [
        (("top",), 1, "top"),
        (("signal",), 3, "signal"),
        (("signal", "near"), 3, "signal.near"),
        (("signal", "far"), 7, "signal . far"),
        (("signal", "far", "path"), 8, "path"),
        (("signal", "x.y"), 10, "\"signal\".'x.y'"),
        (("signal", "x.y", "path"), 11, "path"),
        (("map", "inline", "path"), 14, "path"),
        (("map", "absent"), 13, "map"),
        (("absent",), 1, ""),
    ],
)
def test_a_key_is_found_in_its_own_table(path: tuple[str, ...], line: int, text: str) -> None:
    place = tables(TEXT).place(*path)
    assert (place.line, place.text) == (line, text)


def test_a_value_stands_behind_its_key() -> None:
    found = tables(TEXT)
    assert found.value("signal", "far", "path").text == '"/b"'
    assert found.value("map", "inline").text == '{ path = "/d" }'


def test_each_of_many_tables_has_a_place_of_its_own() -> None:
    names = [f"s{number}" for number in range(50)]
    found = tables("".join(f'[signal.{name}]\npath = "/t"\n' for name in names))
    lines = [found.value("signal", name, "path").line for name in names]
    assert all(after == before + 2 for before, after in pairwise(lines))
