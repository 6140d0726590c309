"""Formulas as text: as people read them, and as Spot reads them back."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.formalization.formalize import formalize
from compiler.formalization.future import future
from compiler.formalization.obligation import obligation
from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.definition import holds
from compiler.logic.formula import endless
from compiler.logic.spot import same_language
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.parser import parse
from fretish.syntax import Sentence
from tests import fret_notation as fret
from tests.strategies import FORMULA_ATOMS, future_formulas, past_formulas, traces

a, b, c = f.Atom("a"), f.Atom("b"), f.Atom("c")
FAST = f.Atom("(x > 3)")


def response(text: str) -> f.Formula:
    """The formula of `always`, on infinite traces."""
    sentence = parse(Source("r.fret", f"the sw shall always satisfy {text}").span())
    assert isinstance(sentence, Sentence)
    return endless(future(obligation(sentence, 0)))


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        (f.Globally(f.Implies(a, f.Eventually(b, f.EVER)), f.EVER), "G(a -> F b)"),
        (f.Not(a), "!a"),
        (f.Not(f.And((a, b))), "!(a & b)"),
        (f.And((a, f.Or((b, c)))), "a & (b | c)"),
        (f.Implies(a, f.Implies(b, c)), "a -> b -> c"),
        (f.Implies(f.Implies(a, b), c), "(a -> b) -> c"),
        (f.Iff(a, f.Iff(b, c)), "a <-> (b <-> c)"),
        (f.Release(f.LAST, f.Until(f.Not(f.LAST), b)), "LAST R (!LAST U b)"),
        (f.Until(a, f.Until(b, c)), "a U (b U c)"),
        (f.Until(f.Until(a, b), c), "(a U b) U c"),
        (f.Since(f.Until(a, b), f.Release(a, c), f.EVER), "(a U b) S (a R c)"),
        (f.Xor(f.Xor(a, b), c), "(a xor b) xor c"),
        (f.Next(f.Until(a, b)), "X(a U b)"),
        (f.And((f.Until(a, b), c)), "a U b & c"),
        (f.Eventually(a, f.Interval(0, 1000)), "F[0,1000] a"),
        (f.Globally(f.Next(a), f.Interval(2, None)), "G[2,inf] X a"),
        (f.Since(f.Not(a), b, f.Interval(1, 3)), "!a S[1,3] b"),
        (f.Once(f.Historically(a, f.EVER), f.Interval(3, 3)), "O[3,3] H a"),
        (f.FIRST, "(Z FALSE)"),
        (f.And((f.Previous(a), f.WeakPrevious(b))), "Y a & Z b"),
        (f.TRUE, "TRUE"),
        (f.Not(FAST), "!(x > 3)"),
    ],
)
def test_a_person_reads_few_parentheses(formula: f.Formula, text: str) -> None:
    assert printing.readable(formula) == text


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        (f.Globally(f.Implies(a, f.Eventually(b, f.EVER)), f.EVER), "(G (a -> (F b)))"),
        (f.And((a, b, f.Not(c))), "(a & b & (! c))"),
        (f.Eventually(FAST, f.Interval(0, 3)), '(F[0:3] "(x > 3)")'),
        (f.Release(f.LAST, a), "(LAST R a)"),
        (f.Or((f.TRUE, f.FALSE)), "(1 | 0)"),
        (f.Xor(a, f.Next(b)), "(a xor (X b))"),
        (f.Atom("arm.joint"), "arm_DOT_joint"),
        (f.Atom("load%"), "load_PRC_"),
        (f.Atom("two words"), "two_SPC_words"),
        (f.Atom("a[3]"), "a_LSQ_3_RSQ_"),
    ],
)
def test_a_machine_reads_the_future_with_all_parentheses(formula: f.Formula, text: str) -> None:
    assert printing.future(formula) == text


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        (f.Historically(f.Implies(a, b), f.EVER), "(H (a -> b))"),
        (f.Once(a, f.Interval(0, 3)), "(O[0,3] a)"),
        (f.Since(a, f.And((b, f.FIRST)), f.EVER), "(a S (b & (Z FALSE)))"),
        (f.Not(f.Previous(FAST)), "(! (Y (x > 3)))"),
        (f.TRUE, "TRUE"),
    ],
)
def test_a_machine_reads_the_past_with_all_parentheses(formula: f.Formula, text: str) -> None:
    assert printing.past(formula) == text


# Read back ------------------------------------------------------------------------------------


@given(past_formulas, traces(*FORMULA_ATOMS, max_size=6))
def test_the_past_text_says_what_the_formula_says(
    formula: f.Formula, rows: list[dict[str, bool]]
) -> None:
    word = {name: [int(row[name]) for row in rows] for name in FORMULA_ATOMS}
    printed = fret.values(fret.parse(printing.past(formula)), word, len(rows))
    assert printed == [int(holds(formula, rows, at)) for at in range(len(rows))]


@given(future_formulas, traces(*FORMULA_ATOMS, max_size=6))
def test_the_future_text_says_what_the_formula_says(
    formula: f.Formula, rows: list[dict[str, bool]]
) -> None:
    word = {name: [int(row[name]) for row in rows] for name in FORMULA_ATOMS}
    printed = fret.values(fret.parse(printing.future(formula)), word, len(rows))
    assert printed == [int(holds(formula, rows, at)) for at in range(len(rows))]


@given(future_formulas, traces(*FORMULA_ATOMS, max_size=6))
def test_the_readable_text_says_what_the_formula_says(
    formula: f.Formula, rows: list[dict[str, bool]]
) -> None:
    word = {name: [int(row[name]) for row in rows] for name in FORMULA_ATOMS}
    printed = fret.values(fret.parse(printing.readable(formula)), word, len(rows))
    assert printed == [int(holds(formula, rows, at)) for at in range(len(rows))]


def spelled(formula: f.Formula) -> str:
    """The formula in Spot's operators, by the book: bounds as chains of X."""
    match formula:
        case f.Const(value):
            return "1" if value else "0"
        case f.Atom(name):
            return f'"{name}"'
        case f.Not(arg):
            return f"(!{spelled(arg)})"
        case f.And(args):
            return f"({' && '.join(map(spelled, args))})"
        case f.Or(args):
            return f"({' || '.join(map(spelled, args))})"
        case f.Xor(left, right):
            return f"({spelled(left)} ^ {spelled(right)})"
        case f.Implies(left, right):
            return f"({spelled(left)} => {spelled(right)})"
        case f.Iff(left, right):
            return f"({spelled(left)} <=> {spelled(right)})"
        case f.Next(arg):
            return f"(X {spelled(arg)})"
        case f.Until(left, right):
            return f"({spelled(left)} U {spelled(right)})"
        case f.Release(left, right):
            return f"({spelled(left)} V {spelled(right)})"
        case f.Eventually(arg, ahead):
            return spelled_bounds(spelled(arg), ahead, "<>", "||")
        case f.Globally(arg, ahead):
            return spelled_bounds(spelled(arg), ahead, "[]", "&&")
        case _:
            raise AssertionError(formula)


def spelled_bounds(arg: str, ahead: f.Interval, ever: str, joined: str) -> str:
    if ahead.hi is None:
        return f"({'X ' * ahead.lo}({ever} {arg}))"
    steps = (f"({'X ' * i}{arg})" for i in range(ahead.lo, ahead.hi + 1))
    return f"({f' {joined} '.join(steps)})"


SMALL_BOUNDS = future_formulas.filter(lambda formula: len(printing.future(formula)) < 150)


@settings(max_examples=60)
@given(SMALL_BOUNDS)
def test_spot_reads_the_formula_that_was_printed(formula: f.Formula) -> None:
    assert same_language(printing.future(formula), spelled(formula))


# Names ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    "Fault Good Xpos GF GoalReached F1 G2 M W M1 W2 U1 R1 p0 true_ xor1 TRUE1 FALSE1 first_ a.b "
    'load% "two_words" "1" "0" "true" "false" "2x" "a)" "x>3" "\u00e9" "LAST_"'.split(),
)
def test_spot_reads_a_name_as_one_proposition(name: str) -> None:
    """`G Fault` is about Fault, not about `ault`; a quoted `1` is a name, not true."""
    import spot

    read = spot.formula(printing.future(response(name)))
    assert str(read.kindstr()) == "G", read
    assert str(read[0].kindstr()) == "ap", read
    if name.isidentifier():
        assert read[0].ap_name() == name


@pytest.mark.parametrize(
    ("one", "two"),
    [
        ('"a-b"', '"a+b"'),
        ('"é"', '"ö"'),
        ('"x"', "x_"),
        ('"x "', "x"),
        ('"LAST "', "LAST_"),
    ],
)
def test_two_names_are_two_propositions(one: str, two: str) -> None:
    text = printing.future(response(f"({one} -> {two})"))
    import spot

    found = spot.atomic_prop_collect(spot.formula(text))
    assert len(list(found)) == 2, text


@pytest.mark.parametrize(
    ("one", "two"), [("a.b", "a_DOT_b"), ("a%", "a_PRC_"), ('"a b"', '"a_SPC_b"')]
)
def test_two_names_that_formulas_would_spell_alike_are_refused(one: str, two: str) -> None:
    text = f"the sw shall always satisfy {one} -> {two}"
    requirement, diagnostics = formalize(
        RequirementEntry("R1", Source("r.fret", text).span()), None
    )
    assert requirement is None
    assert [d.code for d in diagnostics] == [Code.NAME_CLASH]


def test_a_variable_whose_text_looks_like_a_comparison_is_not_that_comparison() -> None:
    text = printing.future(response('("(x > 3)" -> x > 3)'))
    assert not same_language(text, "1")


@given(st.sampled_from(["x > 3", "x + 2 * y <= -1", "f(p, x)", "absReal(x) > 1.5e-3"]))
def test_a_comparison_is_one_proposition(text: str) -> None:
    printed = printing.future(response(text))
    assert same_language(printed, printed.replace("(G ", "(0 R "))
    assert printed.count('"') == 2
