"""The tables that are kept are those of the grammars, and parse alike."""

from importlib.resources import files
from pathlib import Path

import pytest
from lark import Lark
from lark.exceptions import UnexpectedCharacters, UnexpectedToken

from compiler.agents import gwendolen
from fretish import parser
from fretish.bindings import expressions
from fretish.reading.grammars import Grammar

SENTENCES = (
    "whenever a r shall eventually satisfy b",
    "in m when x > 3.5 km/h & !p the robot shall within 10 s satisfy persisted(2, q) => z",
    "Upon c r shall satisfy p 3",
)


@pytest.mark.parametrize(
    "grammar", [parser.GRAMMAR, expressions.GRAMMAR, gwendolen.GRAMMAR], ids=lambda g: g.name
)
def test_tables_are_kept_of_each_grammar(grammar: Grammar, request: pytest.FixtureRequest) -> None:
    if request.config.getoption("--update-golden") and not grammar.is_kept:
        place = Path(str(files(grammar.package).joinpath(grammar.tables_file)))
        place.write_bytes(grammar.tables())
    assert grammar.is_kept, "pytest --update-golden writes them anew"


def test_tables_of_another_grammar_are_not_used() -> None:
    kept = parser.GRAMMAR
    other = Grammar(kept.package, kept.name, {**kept.options, "start": ["value"]}, kept.addition)
    assert kept.is_kept
    assert not other.is_kept
    assert other.parser().options.start == ["value"]


@pytest.mark.slow
def test_kept_tables_parse_as_new_ones() -> None:
    kept, new = parser.GRAMMAR.parser(), parser.GRAMMAR._new()
    for sentence in SENTENCES:
        assert _answer(kept, sentence) == _answer(new, sentence), sentence


def _answer(lark: Lark, sentence: str) -> object:
    """The tree, or where it goes wrong and what would go on from there."""
    try:
        return lark.parse(sentence, start="start")
    except UnexpectedToken as error:
        return error.token, error.token.start_pos, error.accepts
    except UnexpectedCharacters as error:
        return error.char, error.pos_in_stream, error.allowed
