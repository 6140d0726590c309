"""Sentences without X: equal to FRET's formulas, and refused where no such form exists."""

import json
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
import spot

from compiler.formalization.future import future
from compiler.formalization.obligation import (
    TRAITS,
    Demand,
    Obligation,
    ObligationKind,
    Trait,
    obligation,
)
from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.spot import equivalent, same_language
from compiler.targets.ajpf.without_next import (
    is_next_free,
    is_proved,
    is_weaker,
    never_begins,
    next_free,
    unbounded,
)
from fretish.diagnostics.source import Source
from fretish.parser import parse
from fretish.syntax import ConditionKind, ScopeKind, Sentence, duration
from tests.effort import some
from tests.strategies import Template, templates

TABLE = Path(__file__).parents[3] / "data/fret_templates.json"
SCOPES = (None, *ScopeKind)
CONDITIONS = (None, *ConditionKind)
M, P, Q = map(f.Atom, "mpq")


def read(text: str) -> Obligation:
    sentence = parse(Source("r.fret", text).span())
    assert isinstance(sentence, Sentence), sentence
    counted = duration(sentence.timing)
    return obligation(sentence, counted.amount if counted else 0)


def exact(meant: Obligation) -> f.Formula:
    return f.endless(future(meant))


def all_templates() -> list[Template]:
    return list(templates((2,)))


@pytest.mark.slow
def test_192_templates_have_a_form_and_the_other_96_count_ticks() -> None:
    made = Counter(next_free(read(t.sentence)) is not None for t in all_templates())
    assert made == {True: 192, False: 96}
    refused = {t.timing for t in all_templates() if next_free(read(t.sentence)) is None}
    assert refused == {"next", "within", "for", "after"}


@pytest.mark.slow
def test_each_form_is_next_free_and_has_the_language_of_the_formula() -> None:
    for template in some(all_templates(), 5, first=2):
        meant = read(template.sentence)
        form = next_free(meant)
        if form is not None:
            assert is_next_free(form), template
            assert equivalent(form, exact(meant)), template
            assert set(f.atoms(form)) <= set(template.columns)


@pytest.mark.slow
@pytest.mark.parametrize("group", ["template", "duration"])
def test_each_form_has_the_language_of_frets_own_formula(group: str) -> None:
    rows: list[dict[str, Any]] = json.loads(TABLE.read_text(encoding="utf-8"))
    compared = Counter[bool]()
    for row in rows:
        if row["group"] == group:
            form = next_free(read(row["fretish"]))
            compared[form is not None] += 1
            if form is None:
                assert row["timing"] in ("next", "within", "for", "after")
            else:
                assert same_language(printing.future(form), row["ft_inf"]), row["id"]
    assert compared[group == "template"] > 80


@pytest.mark.slow
def test_what_has_no_form_changes_when_a_trace_stutters() -> None:
    """No next-free form exists of it, so that the refusal is no weakness of ours."""
    for template in some(all_templates(), 5):
        meant = read(template.sentence)
        formula = spot.formula(printing.future(exact(meant)))
        assert spot.is_stutter_invariant(formula) is (next_free(meant) is not None), template


def test_the_proof_at_emission_is_asked_of_every_shape() -> None:
    for scope in SCOPES:
        for condition in CONDITIONS:
            for kind in ObligationKind:
                assert is_proved(scope, condition, kind) is (Trait.STEPS not in TRAITS[kind])


def test_a_wrong_form_is_not_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "compiler.targets.ajpf.without_next.next_free", lambda meant: f.eventually(f.Atom("r"))
    )
    is_proved.cache_clear()
    assert is_proved(None, None, ObligationKind.EVENTUALLY)
    assert not is_proved(None, ConditionKind.HOLDING, ObligationKind.EVENTUALLY)
    assert not is_proved(ScopeKind.IN, None, ObligationKind.EVENTUALLY)
    is_proved.cache_clear()


@pytest.mark.parametrize(
    ("sentence", "form"),
    [
        ("whenever p the sw shall eventually satisfy q", "G(p -> F q)"),
        ("when p the sw shall eventually satisfy q", "(p -> F q) & G(p | p R (p -> F q))"),
        ("when p the sw shall immediately satisfy q", "(p -> q) & G(p | p R (p -> q))"),
        ("in m, whenever p sw shall eventually satisfy q", "G(m & p -> m U (m & q))"),
        ("in m, the sw shall immediately satisfy q", "(m -> q) & G(m | m R (m -> q))"),
        ("before m, the sw shall eventually satisfy q", "m | !m U (!m & q)"),
        ("after m, the sw shall always satisfy q", "m R (m -> !m R (m | G q))"),
        ("only after m, the sw shall always satisfy q", "!m U ((!m & !q) | (m & m U (m & !q)))"),
        ("whenever true the sw shall eventually satisfy q", "G F q"),
        ("whenever p the sw shall until false satisfy q", "G(p -> G q)"),
        ("whenever p the sw shall before true satisfy q", "G !p"),
        ("the sw shall finally satisfy q", "TRUE"),
        ("in m, the sw shall eventually satisfy false", "!m & G(m | m R !m)"),
        ("while true, the sw shall eventually satisfy q", "F q"),
    ],
)
def test_forms_are_short_and_constants_fold(sentence: str, form: str) -> None:
    found = next_free(read(sentence))
    assert found is not None
    assert printing.readable(found) == form


def test_no_form_is_long() -> None:
    forms = (next_free(read(t.sentence)) for t in all_templates())
    lengths = sorted(len(printing.readable(form)) for form in forms if form is not None)
    assert lengths[len(lengths) // 2] < 60
    assert lengths[-1] < 600


@pytest.mark.parametrize(
    ("formula", "free"),
    [
        (f.Globally(f.Implies(P, f.Until(P, f.Release(P, Q))), f.EVER), True),
        (f.Xor(P, f.Iff(P, f.Not(Q))), True),
        (f.Next(P), False),
        (f.Or((P, f.Next(P))), False),
        (f.Eventually(P, f.Interval(0, 2)), False),
        (f.Globally(P, f.Interval(1, None)), False),
        (f.Globally(f.Once(P, f.EVER), f.EVER), False),
        (f.LAST, False),
        (f.ProbabilityBound(">=", "1", P), False),
    ],
)
def test_next_free_is_logic_and_unbounded_operators_of_the_future(
    formula: f.Formula, free: bool
) -> None:
    assert is_next_free(formula) is free


# Without a bound --------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("n", [0, 1, 3])
def test_without_its_bound_within_says_less_and_not_more(n: int) -> None:
    """And strictly less: with a bound, too late is too late."""
    weakened = 0
    for template in templates((n,)):
        if template.timing != "within" or template.scope.startswith("only"):
            continue
        meant = read(template.sentence)
        weak = unbounded(meant)
        assert weak is not None
        assert is_next_free(weak)
        assert equivalent(f.And((exact(meant), weak)), exact(meant)), template
        assert not equivalent(exact(meant), weak), template
        weakened += 1
    assert weakened == 15


def test_plain_eventually_would_be_stronger_where_the_scope_ends() -> None:
    bound, ever = (
        exact(read(f"in m, whenever p sw shall {timing} satisfy q"))
        for timing in ("within 3 ticks", "eventually")
    )
    assert not equivalent(f.And((bound, ever)), bound)


@pytest.mark.slow
def test_nothing_else_loses_a_bound() -> None:
    for template in all_templates():
        if template.timing != "within" or template.scope.startswith("only"):
            assert unbounded(read(template.sentence)) is None


def test_the_weaker_shape_is_proved_for_every_bound() -> None:
    for scope in SCOPES:
        for condition in CONDITIONS:
            assert is_weaker(scope, condition) is (scope is None or not scope.negates)


# Triggers ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("scope", SCOPES)
@pytest.mark.parametrize("condition", CONDITIONS)
def test_never_begins_is_that_no_demand_is_ever_made(
    scope: ScopeKind | None, condition: ConditionKind | None
) -> None:
    """That is: even what cannot be met, demanded at once, is met."""
    meant = Obligation(
        scope,
        M if scope else f.TRUE,
        condition,
        P if condition else f.TRUE,
        Demand(ObligationKind.ALWAYS, Q),
    )
    impossible = Demand(ObligationKind.IMMEDIATELY, f.FALSE)
    never = never_begins(meant)
    if condition is None and scope is None:
        assert never is None
    elif condition is None and scope in (ScopeKind.BEFORE, ScopeKind.ONLY_AFTER):
        assert never == f.Globally(f.Not(M), f.EVER)
    else:
        assert never is not None
        assert is_next_free(never)
        demands = exact(Obligation(scope, meant.mode, condition, meant.trigger, impossible))
        assert equivalent(never, demands)
