"""A quantity of the words that is not the one that is judged."""

from __future__ import annotations

import pytest

from compiler.formalization.formalize import formalize
from compiler.project.stated_numbers import check_stated_numbers, first_unit
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Source
from fretish.documents import requirements

BINDINGS = """\
[clock]
tick = "100 ms"
[signal.battery]
path = "/battery.percentage"
unit = "%"
[signal.range]
path = "/scan.range"
unit = "m"
[proposition.near]
expr = "range < 5 cm"
"""
SENTENCE = "whenever near & battery < 20 the agv shall within 5 seconds satisfy range > 1"


def codes(
    title: str = "", text: str = "", params: str = "", sentence: str = SENTENCE
) -> list[tuple[str, str]]:
    header = f'+++\nid = "R"\ntitle = "{title}"\ntext = "{text}"\nparams = {{{params}}}\n+++\n'
    ((entry,), wrong) = requirements(Source("r.fret", header + sentence))
    declared, mistakes = read_bindings(Source("bindings.toml", BINDINGS))
    assert not wrong
    assert not mistakes
    requirement, _ = formalize(entry, declared)
    assert requirement is not None
    assert requirement.declarations is not None
    diagnostics = check_stated_numbers(requirement, requirement.declarations)
    return [(each.code.name, each.span.text if each.span else "") for each in diagnostics]


@pytest.mark.parametrize(
    "words",
    [
        "Dock below 20 %", "Dock below 20 percent", "within 5 cm", "within 50 mm", "0.05 m", "1 m",
        "in 5 s", "in 5000 ms", "in 5 seconds", "ISO 3691-4", "R2 of 10", "3 robots at 5 o'clock",
        "at 4 m/s",  # no number of that kind is judged
    ],
)  # fmt: skip
def test_words_that_agree_are_left_in_peace(words: str) -> None:
    assert codes(title=words, text=words) == []


@pytest.mark.parametrize(
    ("words", "quantity"),
    [
        ("Dock below 15 %", "15 %"),
        ("Dock below 15 percent.", "15 percent"),
        ("An obstacle within 6 cm", "6 cm"),
        ("in 6 s", "6 s"),
        ("in 5 minutes, at 5 cm", "5 minutes"),
    ],
)
def test_another_number_is_found_at_its_place(words: str, quantity: str) -> None:
    expected = [(Code.PROSE_DRIFT.name, quantity)]
    assert codes(title=words) == codes(text=words) == expected


@pytest.mark.parametrize("duration", ["10 s", "10 seconds", "10000 ms"])
def test_a_duration_in_a_predicate_is_a_number_of_the_sentence(duration: str) -> None:
    sentence = f"whenever persisted({duration}, near) the agv shall immediately satisfy range > 1"
    assert codes(title="Near for 10 s", sentence=sentence) == []
    drift = [(Code.PROSE_DRIFT.name, "5 s")]
    assert codes(title="Near for 5 s", sentence=sentence) == drift


def test_a_parameter_belongs_to_a_proposition_or_to_a_signal() -> None:
    drift = Code.PARAMETER_DRIFT.name
    assert codes(params='near = "5 cm"') == codes(params='battery = "20 %"') == []
    assert [code for code, _ in codes(params='near = "6 cm"')] == [drift]
    assert [code for code, _ in codes(params='battery = "0.3"')] == [drift]
    assert [code for code, _ in codes(params='speed = "1 m/s"')] == [Code.UNKNOWN_NAME.name]


def test_the_first_unit_of_a_project_is_noted_and_bare_numbers_are_not() -> None:
    def note(sentence: str) -> str | None:
        ((entry,), _) = requirements(Source("r.fret", sentence))
        requirement, _ = formalize(entry, read_bindings(Source("bindings.toml", BINDINGS))[0])
        assert requirement is not None
        found = first_unit([requirement])
        return found.span.text if found is not None and found.span is not None else None

    assert note(SENTENCE) is None
    assert note("the agv shall always satisfy persisted(10 s, range > 1)") is None
    assert note(SENTENCE.replace("< 20", "< 20 %").replace("> 1", "> 1 m")) == "20 %"
