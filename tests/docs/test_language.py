"""docs/language.md leaves nothing out; its pictures, forms and tables are those of the code."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any, get_args

import pytest
from lark.grammar import Rule

from compiler.explanation.explain import explanation
from compiler.explanation.explain import text as explained
from fretish import checking, documents, keywords, parser, units
from fretish import syntax as s
from fretish.bindings.comparisons import FUNCTIONS
from fretish.diagnostics.diagnostic import has_errors
from fretish.diagnostics.source import Source
from fretish.meaning import meaning
from tests.docs import pages
from tests.docs.pages import FOLDER, blocks, rows, section, subjects
from tests.monitoring import requirement

PAGE = "language.md"
TEXT = (FOLDER / PAGE).read_text("utf-8")
GRAMMAR: Any = parser.GRAMMAR.lark()


# What the page asks for ---------------------------------------------------------------------------


def picture(sentence: str) -> str:
    """The meaning, one run drawn, and of the traces of `fretc explain` a good and a bad one.

    The good one answers, where there is one that does.
    """
    told = explanation(requirement(sentence))
    means = meaning(told.requirement.sentence, told.requirement.ticks, None)
    every = [shown for shown in told.traces if shown.satisfied]
    good = [shown for shown in every if "nothing is" not in shown.reason][-1:] or every[-1:]
    bad = [shown for shown in told.traces if not shown.satisfied][-1:]
    shown = explained(replace(told, traces=(*good, *bad), notes=()))
    drawn = shown.partition("  one run, drawn\n")[2]
    lines = [line.removeprefix("  ") for line in drawn.rstrip().splitlines()]
    return f"{means}\n\n```text\n{sentence}\n\n" + "\n".join(lines) + "\n```"


PARTS = {
    "scope": "m",
    "mode": "m",
    "named_mode": "m mode",
    "expression": "p",
    "duration": "n ticks",
    "IS_TRUE": "true",
    "IS_FALSE": "false",
}


def form(grammar_rule: Rule) -> str:
    """`except in m`, for a requirement whose parts are key words and `PARTS`."""
    return " ".join(PARTS.get(part.name, part.name.lower()) for part in grammar_rule.expansion)


def forms_of(name: str) -> list[str]:
    """Each way in which the grammar lets one spell a part of a sentence."""
    found = [form(r) for r in GRAMMAR.rules if name in (r.origin.name, r.alias)]
    return list(dict.fromkeys(found))


def forms(name: str) -> str:
    return "Written " + ", ".join(f"`{each}`" for each in forms_of(name)) + "."


def listed(name: str) -> str:
    words = {
        "keywords": sorted(keywords.RESERVED),
        "units": list(units.NAMES),
        "statuses": list(documents.STATUSES),
        "kinds": list(documents.KINDS),
    }[name]
    return ", ".join(f"`{word}`" for word in words)


MAKERS: pages.Makers = {"picture": picture, "forms": forms, "words": listed}


@pytest.mark.slow
def test_the_page_is_current(request: pytest.FixtureRequest) -> None:
    pages.is_current(PAGE, MAKERS, request)


# Completeness -------------------------------------------------------------------------------------

SENTENCES = [line for block in blocks(TEXT, "fretish") for line in block.splitlines() if line]


def test_each_sentence_of_the_page_is_read() -> None:
    assert len(SENTENCES) > 20
    for sentence in SENTENCES:
        assert not has_errors(parser.find_errors(Source("r.fret", sentence).span())), sentence


Use = tuple[str, str, str]
"""A rule of the grammar, its alias, and one part of it."""
ELSEWHERE = {
    *(("argument", "duration_argument", unit) for unit in ("MICROSECOND", "MINUTE", "HOUR")),
    ("duration", "", "MINUS"),
    ("probability", "", "MINUS"),
    ("value", "", "expression"),
}
"""What the grammar reads so that the message can be a good one, and values of variables."""


def uses_of(grammar_rule: Rule) -> set[Use]:
    name = grammar_rule.origin.name
    return {(name, grammar_rule.alias or "", part.name) for part in grammar_rule.expansion}


def uses_in(sentences: list[str]) -> set[Use]:
    """What of the grammar they are read by."""
    grammar = parser.GRAMMAR.lark()
    machine: Any = grammar.parser.parser
    found: set[Use] = set()

    def noting(each: Rule, build: Callable[[Any], Any]) -> Callable[[Any], Any]:
        def noted(children: Any) -> Any:
            found.update(uses_of(each))
            return build(children)

        return noted

    callbacks = machine.parser.callbacks
    for each, build in tuple(callbacks.items()):
        if isinstance(each, Rule):
            callbacks[each] = noting(each, build)
    for sentence in sentences:
        grammar.parse(sentence, start="start")
    return found


def test_each_alternative_of_the_grammar_stands_on_the_page() -> None:
    every = set[Use]().union(*map(uses_of, GRAMMAR.rules)) - ELSEWHERE
    assert every - uses_in([*SENTENCES, *subjects(TEXT, "picture"), *SPELT]) == set()


SCOPES = subjects(section(TEXT, "## Scopes: where"), "forms")
TIMINGS = subjects(section(TEXT, "## Timings: when the response is due"), "forms")
SPELT = [
    *(f"{form} the sw shall satisfy q" for name in SCOPES for form in forms_of(name)),
    *(
        f"the sw shall {form.replace('n ticks', '2 ticks')} satisfy q"
        for name in TIMINGS
        for form in forms_of(name)
    ),
]


def test_each_scope_and_timing_has_its_forms_and_a_picture() -> None:
    known = {r.alias for r in GRAMMAR.rules if r.origin.name in ("scope", "timing")}
    assert {*SCOPES, *TIMINGS} == known
    read = [requirement(sentence).sentence for sentence in subjects(TEXT, "picture")]
    assert {s.scope_key(each) for each in read} == {"null", *s.ScopeKind}
    assert {type(each.timing) for each in read} == {*get_args(s.Timing)}
    assert {s.condition_key(each) for each in read} == {"null", *s.ConditionKind}


def test_every_form_is_of_the_kind_that_its_heading_says() -> None:
    for sentence in SPELT:
        tree = parser.parse(Source("r.fret", sentence).span())
        assert isinstance(tree, s.Sentence), sentence


@pytest.mark.parametrize(
    ("heading", "names"),
    [
        (
            "## Predicates about other ticks",
            checking.LOOK_BACK | checking.LOOK_AHEAD - checking.FORMULA_OPERATORS,
        ),
        ("### Numbers", frozenset(FUNCTIONS)),
    ],
)
def test_each_function_and_predicate_has_a_row(heading: str, names: frozenset[str]) -> None:
    first = {row[0] for row in rows(section(TEXT, heading))}
    called = {name for cell in first for name in re.findall(r"`(\w+)", cell)}
    assert names <= called


def test_each_field_of_a_header_has_a_row_and_the_example_has_all() -> None:
    header = section(TEXT, "## The header of a `.fret` file")
    assert {row[0].strip("`") for row in rows(header)} == {*documents.FIELDS}
    (example,) = blocks(header, "text")
    (requirement,), wrong = documents.requirements(Source("r.fret", example))
    assert not wrong
    assert requirement.header is not None
    assert requirement.header.data.keys() == {*documents.FIELDS}


def test_operators_bind_as_the_table_says() -> None:
    shown = [row[2:] for row in rows(section(TEXT, "## Expressions")) if len(row) == 4]
    assert len(shown) == 11
    for pair in shown:
        written, spelt_out = (
            parser.parse(Source("r.fret", f"the sw shall satisfy {cell.strip('`')}").span())
            for cell in pair
        )
        assert isinstance(written, s.Sentence), pair
        assert written == spelt_out, pair
