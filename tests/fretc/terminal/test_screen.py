"""Texts in columns: nothing is wider than it may be, and nothing is written that cannot be."""

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.terminal.screen import IN_ASCII, Screen, fitted, padded, screen, titled, width
from fretish.diagnostics.status_symbols import STATUS_SYMBOLS

ENCODINGS = ("utf-8", "latin-1", "ascii", "cp437")


@given(st.text(max_size=60), st.integers(3, 40), st.sampled_from(ENCODINGS))
def test_a_text_fits_into_its_columns(text: str, columns: int, encoding: str) -> None:
    shown = Screen(encoding=encoding).text(text)
    shown.encode(encoding)
    assert not [c for c in shown if unicodedata.category(c) in ("Cc", "Cf", "Zl", "Zp")]
    assert width(fitted(shown, columns)) <= columns
    assert width(padded(fitted(shown, columns), columns)) == columns


def test_what_is_cut_keeps_more_of_its_end() -> None:
    assert fitted("runs/2024/night/a.mcap", 12) == "run\N{HORIZONTAL ELLIPSIS}t/a.mcap"
    assert fitted("short", 12) == "short"


def test_a_wide_character_takes_two_columns() -> None:
    assert width("日本") == 4
    assert padded("日本", 6) == "日本  "


def test_a_hundred_marks_upon_a_letter_are_cut() -> None:
    assert len(fitted("a" + "\u0301" * 4000, 10)) <= 60


def test_each_sign_has_a_letter_of_its_own_for_terminals_that_cannot_write_it() -> None:
    letters = Screen(encoding="ascii").signs("".join(sign.glyph for sign in STATUS_SYMBOLS))
    assert letters.isascii()
    assert len({*letters}) == len(STATUS_SYMBOLS) == len(letters)
    assert all(width(sign.glyph) == width(sign.letter) == 1 for sign in STATUS_SYMBOLS)


def test_what_is_no_terminal_has_80_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    assert screen().width == 80


@pytest.mark.parametrize(
    ("title", "columns", "text"),
    [
        ("No contact", 40, "No contact (R14)"),
        ("", 40, "R14"),
        ("Point 1 is inspected before the return", 26, "Point 1 is inspecte… (R14)"),
        ("Point 1 is inspected before the return", 12, "R14"),
    ],
)
def test_a_title_is_shortened_and_its_id_never(title: str, columns: int, text: str) -> None:
    assert titled("R14", title, columns) == text


@given(st.text(), st.text(), st.integers(8, 60))
def test_a_titled_name_is_never_wider_than_its_room(id: str, title: str, columns: int) -> None:
    screen = Screen()
    assert width(titled(screen.text(id), screen.text(title), columns)) <= columns


def test_a_console_without_a_symbol_gets_its_letter_and_an_escape_for_any_other_character() -> None:
    text = "✔ R1 … 2 \N{MULTIPLICATION SIGN} 3 → 4 ─ “a” 日 \udcff"
    assert text.encode("cp1252", IN_ASCII).decode("cp1252") == (
        "+ R1 … 2 \N{MULTIPLICATION SIGN} 3 -> 4 - “a” \\u65e5 \\udcff"
    )
    assert text.encode("ascii", IN_ASCII).decode("ascii") == (
        '+ R1 . 2 x 3 -> 4 - "a" \\u65e5 \\udcff'
    )
