"""Positions of the protocol against a definition that counts units character by character."""

from collections.abc import Callable

from hypothesis import given
from hypothesis import strategies as st
from lsprotocol import types as lsp

from fretc.lsp.positions import Positions
from tests.each import each

TEXTS = st.text(st.sampled_from("ab é\U0001f600\n\r\t\u2028\x0c\0"), max_size=30)
UNITS: dict[str, Callable[[str], int]] = {
    "utf-8": lambda character: len(character.encode()),
    "utf-16": lambda character: 1 + (ord(character) > 0xFFFF),
    "utf-32": lambda character: 1,
}


def defined(text: str, offset: int, encoding: str) -> tuple[int, int]:
    """Line and character, for an offset that is not between the two characters of a line end."""
    line = character = at = 0
    while at < offset:
        if text[at] == "\n" or (text[at] == "\r" and text[at : at + 2] != "\r\n"):
            line, character = line + 1, 0
        elif text[at] != "\r":
            character += UNITS[encoding](text[at])
        at += 1
    return line, character


@each("encoding", UNITS)
def test_every_offset_has_the_position_of_its_definition(encoding: str) -> None:
    @given(TEXTS)
    def holds(text: str) -> None:
        positions = Positions(text, encoding)
        for offset in range(len(text) + 1):
            if text[offset - 1 : offset + 1] == "\r\n" and offset:
                continue
            position = positions.position(offset)
            assert (position.line, position.character) == defined(text, offset, encoding)
            assert positions.offset(position) == offset

    holds()


def test_a_position_behind_the_end_means_the_end() -> None:
    positions = Positions("a\r\n\U0001f600b")
    assert positions.offset(lsp.Position(0, 9)) == 1
    assert positions.offset(lsp.Position(9, 0)) == 5
    assert positions.offset(lsp.Position(1, 2**31 - 1)) == 5
    assert positions.offset(lsp.Position(1, 1)) == 3, "within a character: before it"
