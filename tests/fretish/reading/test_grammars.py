"""The tables that are stored are those of the grammars."""

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import pytest

from fretish import parser
from fretish.bindings import expressions
from fretish.reading.grammars import Grammar


@pytest.mark.parametrize("grammar", [parser.GRAMMAR, expressions.GRAMMAR], ids=lambda g: g.name)
def test_tables_are_stored_of_each_grammar(
    grammar: Grammar, request: pytest.FixtureRequest
) -> None:
    if request.config.getoption("--update-golden") and not grammar.is_stored:
        place = Path(str(files(grammar.package).joinpath(grammar.tables_file)))
        place.write_bytes(grammar.tables())
    assert grammar.is_stored, "pytest --update-golden writes them anew"


def test_tables_of_another_grammar_are_not_used() -> None:
    other = replace(expressions.GRAMMAR, addition="\n// another grammar")
    assert not other.is_stored
    assert other.parser().parse("a < 1 m") == expressions.GRAMMAR.parser().parse("a < 1 m")
