"""Mutants: sentences that parse, each another one, from every operator of the list."""

from __future__ import annotations

import pytest
from hypothesis import given

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.situations.changes import MOST_PARTS, changes
from compiler.situations.mutants import OPERATORS, Mutant, mutants
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.parser import parse
from fretish.printer import canonical
from fretish.printer import sentence as printed
from tests.effort import examples, some
from tests.emitting import requirement
from tests.strategies import sentences, templates

CLOCK = """
[clock]
time = "log_time"
tick = "100 ms"

[signal.person]
path = "/person.data"
unit = "m"
max_age = "1 s"
"""


def formalized(sentence: str) -> FormalizedRequirement | None:
    found, _ = formalize(RequirementEntry("R1", Source("r.fret", sentence).span()), None)
    return found


def timed(sentence: str) -> FormalizedRequirement:
    """With a clock and a signal."""
    declarations, _ = read_bindings(Source("bindings.toml", CLOCK))
    found, diagnostics = formalize(
        RequirementEntry("R1", Source("r.fret", sentence).span()), declarations
    )
    assert found is not None, diagnostics
    return found


def assert_others(original: FormalizedRequirement, found: tuple[Mutant, ...]) -> None:
    """Each is a sentence of its own, that its text says; keys are unique, and in order."""
    texts = [canonical(each.requirement.written) for each in found]
    assert len({*texts, canonical(original.written)}) == len(texts) + 1
    assert len({each.key for each in found}) == len(found)
    order = [[*OPERATORS].index(each.key.partition(":")[0]) for each in found]
    assert order == sorted(order)
    for each in found:
        read = parse(each.requirement.entry.wording)
        assert isinstance(read, s.Sentence)
        assert read == each.requirement.written
        assert each.requirement.id == original.id
        assert each.requirement.entry.params == original.entry.params
        assert {*each.requirement.variables} <= {*original.variables}


@pytest.mark.slow
@examples(5)
@given(sentences)
def test_no_two_mutants_say_the_same_and_each_says_what_its_text_says(sentence: s.Sentence) -> None:
    original = formalized(printed(sentence))
    if original is not None:
        assert_others(original, mutants(original))


@pytest.mark.slow
def test_every_template_has_mutants_of_its_own() -> None:
    for drawn in some(templates((2,)), 17):  # each scope, condition and timing is among them
        original = requirement(drawn.sentence)
        assert_others(original, mutants(original))


def keys(sentence: str) -> list[str]:
    return [each.key for each in mutants(requirement(sentence))]


def test_the_mutants_of_a_sentence() -> None:
    original = requirement("in m mode upon p & x < 1.20 the sw shall within 4 ticks satisfy q")
    assert [(each.key, each.requirement.entry.wording.text) for each in mutants(original)] == [
        (key, f"{scope}{condition} sw shall {timing} satisfy {response}".strip())
        for key, scope, condition, timing, response in EXPECTED
    ]


IN, UPON, WITHIN = "in m mode, ", "upon p & x < 1.20 the", "within 4 ticks"
EXPECTED = (
    ("scope:in->notin", "except in m mode, ", UPON, WITHIN, "q"),
    ("scope:in->before", "before m mode, ", UPON, WITHIN, "q"),
    ("scope:in->after", "after m mode, ", UPON, WITHIN, "q"),
    ("scope:in->onlyIn", "only in m mode, ", UPON, WITHIN, "q"),
    ("scope:in->onlyBefore", "only before m mode, ", UPON, WITHIN, "q"),
    ("scope:in->onlyAfter", "only after m mode, ", UPON, WITHIN, "q"),
    ("scope:missing", "", UPON, WITHIN, "q"),
    ("condition:regular->holding", IN, "whenever p & x < 1.20 the", WITHIN, "q"),
    ("condition:missing", IN, "the", WITHIN, "q"),
    ("timing:within->immediately", IN, UPON, "immediately", "q"),
    ("timing:within->next", IN, UPON, "at the next timepoint", "q"),
    ("timing:within->finally", IN, UPON, "finally", "q"),
    ("timing:within->eventually", IN, UPON, "eventually", "q"),
    ("timing:within->always", IN, UPON, "always", "q"),
    ("timing:within->never", IN, UPON, "never", "q"),
    ("timing:within->for", IN, UPON, "for 4 ticks", "q"),
    ("timing:within->after", IN, UPON, "after 4 ticks", "q"),
    ("bound:+1", IN, UPON, "within 5 ticks", "q"),
    ("bound:-1", IN, UPON, "within 3 ticks", "q"),
    ("bound:half", IN, UPON, "within 2 ticks", "q"),
    ("bound:double", IN, UPON, "within 8 ticks", "q"),
    ("bound:0", IN, UPON, "within 0 ticks", "q"),
    ("negated:mode", "while !m, ", UPON, WITHIN, "q"),
    ("negated:condition", IN, "upon !(p & x < 1.20) the", WITHIN, "q"),
    ("negated:condition:p", IN, "upon !p & x < 1.20 the", WITHIN, "q"),
    ("negated:condition:x<1.20", IN, "upon p & !(x < 1.20) the", WITHIN, "q"),
    ("negated:response", IN, UPON, WITHIN, "!q"),
    ("stuck:mode-true", "while true, ", UPON, WITHIN, "q"),
    ("stuck:mode-false", "while false, ", UPON, WITHIN, "q"),
    ("stuck:condition-true", IN, "upon true the", WITHIN, "q"),
    ("stuck:condition-false", IN, "upon false the", WITHIN, "q"),
    ("stuck:response-true", IN, UPON, WITHIN, "true"),
    ("stuck:response-false", IN, UPON, WITHIN, "false"),
    ("dropped:condition:p", IN, "upon x < 1.20 the", WITHIN, "q"),
    ("dropped:condition:x<1.20", IN, "upon p the", WITHIN, "q"),
    ("operator:condition:p|x<1.20", IN, "upon p | x < 1.20 the", WITHIN, "q"),
    ("compared:condition:x<=1.20", IN, "upon p & x <= 1.20 the", WITHIN, "q"),
    ("compared:condition:x>1.20", IN, "upon p & x > 1.20 the", WITHIN, "q"),
    ("threshold:condition:x<1.21", IN, "upon p & x < 1.21 the", WITHIN, "q"),
    ("threshold:condition:x<1.19", IN, "upon p & x < 1.19 the", WITHIN, "q"),
)


@pytest.mark.parametrize(
    ("sentence", "expected"),
    [
        ("the sw shall satisfy q -> r", "operator:response:q<->r"),
        ("the sw shall satisfy q <-> r", "operator:response:q->r"),
        ("the sw shall satisfy q xor r", "operator:response:q|r"),
        ("the sw shall until s | q satisfy r", "operator:stop:s&q"),
        ("the sw shall satisfy !(q & r)", "operator:response:q|r"),
        ("the sw shall satisfy x > -1", "threshold:response:x>-2"),
        ("the sw shall satisfy x > 0", "threshold:response:x>-1"),
        ("the sw shall satisfy 3 <= x", "compared:response:3<x"),
    ],
)
def test_an_operator_finds_its_place(sentence: str, expected: str) -> None:
    assert expected in keys(sentence)


def test_a_bound_keeps_its_unit_where_it_can_and_a_threshold_its_own() -> None:
    made = mutants(timed("whenever person < 120 cm the sw shall within 1 second satisfy q"))
    texts = {each.key: each.requirement.entry.wording.text for each in made}
    assert "within 1100 milliseconds" in texts["bound:+1"]
    assert "within 2 seconds" in texts["bound:double"]
    assert "person < 121 cm" in texts["threshold:condition:person<121cm"]


def test_a_mutant_keeps_what_its_requirement_states() -> None:
    made = timed("whenever person < 1.2 m the sw shall within 1 second satisfy q")
    assert all(each.requirement.declarations is not None for each in mutants(made))
    assert all(each.requirement.clock == made.clock for each in mutants(made))


def test_of_a_large_expression_no_part_is_changed_alone() -> None:
    parts = [e.Name(f"p{i}") for i in range(MOST_PARTS)]
    assert len([*changes(e.And(tuple(parts[1:])))]) == 2 * MOST_PARTS - 1
    assert [*changes(e.And(tuple(parts)))] == []
