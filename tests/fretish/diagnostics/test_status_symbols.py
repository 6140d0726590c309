from pathlib import Path

import pytest

from fretish.diagnostics.status_symbols import STATUS_SYMBOLS, StatusSymbol

ROOT = Path(__file__).parents[3]
ROOMS = ("fretish", "monitors", "compiler", "fretc", "simulation", "templates")
HOME = ROOT / "fretish/diagnostics/status_symbols.py"
GLYPHS = [sign.glyph for sign in STATUS_SYMBOLS if sign.glyph not in ("!", "?", "w", "\N{EN DASH}")]


@pytest.mark.parametrize("room", ROOMS)
def test_no_glyph_stands_outside_of_the_table(room: str) -> None:
    for path in ROOT.joinpath(room).rglob("*"):
        if path.suffix in (".py", ".j2", ".toml", ".css") and path != HOME:
            text = path.read_text(encoding="utf-8")
            assert not any(glyph in text for glyph in GLYPHS), path


def test_no_two_outcomes_look_the_same() -> None:
    assert (
        len({sign.glyph for sign in STATUS_SYMBOLS})
        == len({sign.kind for sign in STATUS_SYMBOLS})
        == len(STATUS_SYMBOLS)
    )


@pytest.mark.parametrize("sign", STATUS_SYMBOLS, ids=lambda sign: sign.kind)
def test_the_style_sheet_has_a_colour_for_each(sign: StatusSymbol) -> None:
    style = (ROOT / "templates/report/style.css.j2").read_text(encoding="utf-8")
    assert any(f".{sign.kind}{end}" in style for end in (" {", ","))
