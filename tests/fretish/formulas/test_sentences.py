"""Requirements that are formulas: Spot reads the same, mistakes have places, printing is exact."""

import pytest
import spot

from compiler.logic import printing
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.formulas.reader import MOST_NESTED
from fretish.formulas.sentences import find_errors, parse
from fretish.printer import sentence
from fretish.syntax import Sentence
from tests.each import each
from tests.requirement_sets import requirement

BEGINNING = "the system shall satisfy formula: "


def tree(text: str) -> Sentence:
    found = parse(Source("r.fret", BEGINNING + text).span())
    assert isinstance(found, Sentence), found
    return found


def mistake(text: str) -> Diagnostic:
    (found,) = find_errors(Source("r.fret", BEGINNING + text).span())
    return found


FORMULAS = (
    "G (a -> F b)", "a U b & b", "!a U b", "a & b | a -> (a <-> b)", "a -> b -> a",
    "F G a -> G F b", "a xor b", "(a U b) U a", "a W b", "!X a R b", "F[1,3] a & G[0,2] b", "X X a",
    "true U a",    "a <-> b <-> a", "a W (b R X a)", "G (a && b || a)",
)  # fmt: skip


@each("text", FORMULAS)
def test_a_formula_is_read_as_spot_reads_it(text: str) -> None:
    ours = printing.future(requirement("R", BEGINNING + text).ft_infinite)
    assert spot.are_equivalent(ours, text.replace(",", ":"))


@each("text", FORMULAS)
def test_a_printed_formula_is_read_as_the_same_tree(text: str) -> None:
    first = tree(text)
    assert parse(Source("r.fret", sentence(first)).span()) == first


def test_a_formula_compares_numbers_as_sentences_do() -> None:
    found = requirement("R", f'{BEGINNING}G (speed + 1 > 0.5 * limit -> F "in")')
    assert found.variables == ("speed", "limit", "in")
    assert "((speed + 1) > (0.5 * limit))" in found.propositions


@pytest.mark.parametrize(
    ("text", "message", "place"),
    [
        ('G "G"', "this is no formula: `G` is an operator", '"G"'),
        ("a U b U c", "this is no formula: `U` stands where a parenthesis around the formula "
         "before it, or an operator is expected", "U"),
        ("F[3,1] a", "this is no formula: `3,1` is no interval of ticks", "[3,1]"),
        ("G a)", "this is no formula: `)` stands where an operator is expected", ")"),
        ("G preBool(false, a)",
         "this is no formula: `preBool` of FRETish refers to other ticks", "preBool(false, a)"),
        ("G (a + 1)", "a truth value is needed here, and this is a number", "a + 1"),
        ("G #", "this is no formula: `#` begins no word", "#"),
        ("G (a", "this is no formula: the formula ends where `)` is expected", ""),
        ("!" * (MOST_NESTED + 1) + "a", "the formula has more than 400 levels of nesting", "!"),
    ],
)  # fmt: skip
def test_a_mistake_has_its_place(text: str, message: str, place: str) -> None:
    found = mistake(text)
    assert found.message == message
    assert found.span is not None
    assert found.span.text == place


def test_a_sentence_of_fretish_is_read_as_before() -> None:
    found = parse(Source("r.fret", "the system shall always satisfy formula").span())
    assert isinstance(found, Sentence)
    assert sentence(found) == "the system shall always satisfy formula"
