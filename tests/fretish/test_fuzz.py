"""Whatever is fed to the parser, it answers with a tree or with a diagnostic of its own."""

import pytest

from compiler.formalization.formalize import formalize
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.parser import parse
from tests.effort import FULL
from tests.fuzzing import check, sentences


@pytest.mark.slow
def test_near_sentences_get_a_formula_or_a_diagnostic() -> None:
    many = 10_000 if FULL else 250
    accepted = sum(check(text) for text in sentences(many, seed=20))
    assert many / 5 < accepted < many / 5 * 4


def read(response: str) -> object:
    return parse(Source("r.fret", f"the sw shall always satisfy {response}").span())


def test_a_thousand_parentheses_around_a_name_are_that_name() -> None:
    assert read("(" * 1_000 + "p" + ")" * 1_000) == read("p")


@pytest.mark.slow
def test_a_thousand_levels_of_operators_are_formalized_or_told_to_be_too_deep() -> None:
    text = "the sw shall always satisfy " + "a & (b | " * 1_000 + "c" + ")" * 1_000
    requirement, diagnostics = formalize(
        RequirementEntry("deep", Source("r.fret", text).span()), None
    )
    assert requirement is not None or [d.code for d in diagnostics] == [Code.TOO_DEEP]


@pytest.mark.slow
def test_more_levels_than_any_pass_has_room_for_are_told() -> None:
    diagnostic = read("!(" * 5_000 + "p" + ")" * 5_000)
    assert isinstance(diagnostic, Diagnostic)
    assert diagnostic.code is Code.TOO_DEEP
