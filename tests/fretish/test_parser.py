"""The language: what is a sentence, what it says, and what is said where it is none."""

import json
import re
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from compiler.logic.spelling.reserved_words import FRET
from fretish import expressions as e
from fretish import syntax as s
from fretish.clock import NANOSECONDS, SYMBOLS
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.keywords import RESERVED
from fretish.parser import parse
from fretish.printer import expression
from fretish.printer import sentence as printed
from tests.each import each
from tests.effort import some
from tests.strategies import sentences

SURFACE = Path(__file__).parents[1] / "data" / "fret_surface_forms.json"
ROWS: list[dict[str, Any]] = json.loads(SURFACE.read_text(encoding="utf-8"))
CASE_STUDIES: list[dict[str, Any]] = json.loads(
    SURFACE.with_name("fret_case_studies.json").read_text(encoding="utf-8")
)
TEMPLATES: list[dict[str, Any]] = json.loads(
    SURFACE.with_name("fret_templates.json").read_text(encoding="utf-8")
)

p, q, r, t = e.Name("p"), e.Name("q"), e.Name("r"), e.Name("t")
x, y, z = e.Name("x"), e.Name("y"), e.Name("z")

SYMBOL = re.compile(rf"(?<=[0-9] )({'|'.join(SYMBOLS)})\b")


def number(digits: str) -> e.Number:
    return e.Number(digits)


def message_of(text: str) -> str:
    result = parse(Source("r.fret", text).span())
    assert isinstance(result, Diagnostic), f"read: {result}"
    return render(result)


def read(text: str) -> s.Sentence:
    result = parse(Source("r.fret", text).span())
    assert isinstance(result, s.Sentence), render(result)
    return result


def keys(sentence: s.Sentence) -> tuple[str, str, str]:
    return s.scope_key(sentence), s.condition_key(sentence), s.timing_key(sentence)


def response(text: str) -> e.Expression:
    return read(f"the sw shall always satisfy {text}").response


def condition(text: str) -> s.Condition:
    found = read(f"{text} the sw shall satisfy done").condition
    assert found is not None
    return found


# FRET's own table -----------------------------------------------------------------------------


def rows(*, accepted: bool, flagged: frozenset[str] = frozenset()) -> list[dict[str, Any]]:
    chosen = [
        row
        for row in ROWS
        if row["accepted"] is accepted and flagged == frozenset(row.get("flags", ())) & {"D5", "D6"}
    ]
    assert chosen
    return chosen


@each("row", rows(accepted=True))
def test_a_wording_that_fret_accepts_has_its_keys(row: dict[str, Any]) -> None:
    assert keys(read(row["fretish"])) == (row["scope"], row["condition"], row["timing"])


LOWER_CASE = re.compile(r" is (true|false) ")
"""After `is` FRET's lexer takes them for constants; fretc reads them as it does in capitals."""


_RESERVED_BY_FRET = re.compile(rf"\b({'|'.join(sorted(FRET.words))})\b")


@each("row", rows(accepted=False))
def test_a_wording_that_fret_rejects_is_a_mistake(row: dict[str, Any]) -> None:
    text = row["fretish"]
    if row.get("reason") == "reserved word":  # of the languages that FRET exports to
        quoted = _RESERVED_BY_FRET.sub(r'"\1"', text)
        assert quoted != text
        assert parse(Source("r.fret", text).span()) == read(quoted)
    elif SYMBOL.search(text):  # a unit of ours, which `fmt` writes in FRET's words
        words = SYMBOL.sub(lambda match: f"{SYMBOLS[match[0]]}s", text)
        assert parse(Source("r.fret", text).span()) == read(words)
    elif LOWER_CASE.search(text):
        capitals = LOWER_CASE.sub(lambda match: match[0].upper(), text)
        assert parse(Source("r.fret", text).span()) == read(capitals)
    else:
        assert isinstance(parse(Source("r.fret", text).span()), Diagnostic)


@each("row", rows(accepted=True, flagged=frozenset({"D6"})))
def test_a_duration_that_is_no_whole_number_is_refused_where_fret_misreads_it(
    row: dict[str, Any],
) -> None:
    result = parse(Source("r.fret", row["fretish"]).span())
    if row["fretish"] == "The sw shall within 2.0 ticks satisfy q":
        assert result == read("The sw shall within 2 ticks satisfy q")
        return
    assert isinstance(result, Diagnostic)
    assert result.code is Code.BAD_DURATION


@each("row", rows(accepted=True, flagged=frozenset({"D5"})))
def test_a_scope_word_inside_a_name_does_not_change_the_scope(row: dict[str, Any]) -> None:
    scopes = {
        "In readonly, the sw shall always satisfy q": "in",
        "In hereafter mode the sw shall always satisfy q": "in",
        "While heater_before > 0 the sw shall always satisfy q": "in",
        "Before standby_only mode the sw shall always satisfy q": "before",
    }
    assert keys(read(row["fretish"])) == (scopes[row["fretish"]], "null", "always")


@pytest.mark.parametrize("row", CASE_STUDIES, ids=lambda row: row["id"])
def test_a_published_requirement_has_its_keys(row: dict[str, Any]) -> None:
    assert keys(read(row["fretish"])) == (row["scope"], row["condition"], row["timing"])


@pytest.mark.slow
@each("row", TEMPLATES)
def test_a_sentence_of_the_template_table_has_its_keys(row: dict[str, Any]) -> None:
    assert keys(read(row["fretish"])) == (row["scope"], row["condition"], row["timing"])


# Conditions -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "kind", "expression"),
    [
        ("whenever p", "holding", p),
        ("when p", "regular", p),
        ("if p", "regular", p),
        ("upon p", "regular", p),
        ("where p", "regular", p),
        ("unless p", "regular", e.Not(p)),
        ("when p is TRUE", "regular", p),
        ("when p is True", "regular", p),
        ("when p is true", "regular", p),
        ("when p is false", "regular", e.Not(p)),
        ("unless p is false", "regular", p),
        ("when p is true and if q is false", "regular", e.And((p, e.Not(q)))),
        ("when true is false", "regular", e.Not(e.Truth(True))),
        ("when p is FALSE", "regular", e.Not(p)),
        ("whenever p is FALSE", "holding", e.Not(p)),
        ("unless p is TRUE", "regular", e.Not(p)),
        ("unless p is FALSE", "regular", p),
        ("when p and if q", "regular", e.And((p, q))),
        ("when p or if q", "regular", e.Or((p, q))),
        ("when p, if q", "regular", e.And((p, q))),
        ("when p if q", "regular", e.And((p, q))),
        ("when p, and if q,", "regular", e.And((p, q))),
        ("and when p", "regular", p),
        ("when p or if q and where r", "regular", e.And((e.Or((p, q)), r))),
        ("when p and if q or where r", "regular", e.Or((e.And((p, q)), r))),
        ("when p and unless q", "regular", e.And((p, e.Not(q)))),
        ("unless p and when q", "regular", e.And((e.Not(p), q))),
        ("unless p or unless q is FALSE", "regular", e.Or((e.Not(p), q))),
        ("when p | q and if r", "regular", e.And((e.Or((p, q)), r))),
        ("whenever p and whenever q", "holding", e.And((p, q))),
        ("whenever p and when q", "regular", e.And((p, q))),
        ("when p or whenever q", "regular", e.Or((p, q))),
        ("whenever p and whenever q and unless r", "regular", e.And((p, q, e.Not(r)))),
        ("whenever ~p", "holding", e.Not(p)),
    ],
)
def test_a_condition_is_joined_into_one_expression(
    text: str, kind: str, expression: e.Expression
) -> None:
    found = condition(text)
    assert (found.kind.value, found.expression) == (kind, expression)


# Expressions ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("p", p),
        ("true", e.Truth(True)),
        ("false", e.Truth(False)),
        ("!p", e.Not(p)),
        ("~p", e.Not(p)),
        ("!!p", e.Not(e.Not(p))),
        ("~(p & q)", e.Not(e.And((p, q)))),
        ("!p & q", e.And((e.Not(p), q))),
        ("p & ~q", e.And((p, e.Not(q)))),
        ("p & q | r", e.Or((e.And((p, q)), r))),
        ("p | q & r", e.Or((p, e.And((q, r))))),
        ("(p | q) & r", e.And((e.Or((p, q)), r))),
        ("p xor q | r", e.Xor(p, e.Or((q, r)))),
        ("p | q xor r", e.Xor(e.Or((p, q)), r)),
        ("p XoR q", e.Xor(p, q)),
        ("p xor q -> r", e.Implies(e.Xor(p, q), r)),
        ("p -> q xor r", e.Implies(p, e.Xor(q, r))),
        ("p -> q -> r", e.Implies(p, e.Implies(q, r))),
        ("p => q => r", e.Implies(p, e.Implies(q, r))),
        ("(p -> q) -> r", e.Implies(e.Implies(p, q), r)),
        ("p <-> q -> r", e.Iff(p, e.Implies(q, r))),
        ("p -> q <-> r", e.Iff(e.Implies(p, q), r)),
        ("p <-> q <-> r", e.Iff(e.Iff(p, q), r)),
        ("p <=> q <=> r", e.Iff(e.Iff(p, q), r)),
        ("if p then q", e.Implies(p, q)),
        ("if p => q then r", e.Implies(e.Implies(p, q), r)),
        ("p & if q then r", e.And((p, e.Implies(q, r)))),
        ("! if p then q", e.Not(e.Implies(p, q))),
        ("if p then q & if r then t", e.Implies(p, e.And((q, e.Implies(r, t))))),
        ("if p then q -> r", e.Implies(p, e.Implies(q, r))),
        ("if p | q then r | t", e.Implies(e.Or((p, q)), e.Or((r, t)))),
    ],
)
def test_boolean_operators_bind_as_the_specification_says(text: str, tree: e.Expression) -> None:
    assert response(text) == tree


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("x", x),
        ("x-3", e.Arithmetic("-", x, number("3"))),
        ("x -3", e.Arithmetic("-", x, number("3"))),
        ("x - 3", e.Arithmetic("-", x, number("3"))),
        ("-3", e.Negation(number("3"))),
        ("x - -3", e.Arithmetic("-", x, e.Negation(number("3")))),
        ("x * -3", e.Arithmetic("*", x, e.Negation(number("3")))),
        ("x + y * z", e.Arithmetic("+", x, e.Arithmetic("*", y, z))),
        ("(x + y) * z", e.Arithmetic("*", e.Arithmetic("+", x, y), z)),
        ("x - y - z", e.Arithmetic("-", e.Arithmetic("-", x, y), z)),
        ("x / y * z", e.Arithmetic("*", e.Arithmetic("/", x, y), z)),
        ("x mod y + z", e.Arithmetic("+", e.Arithmetic("mod", x, y), z)),
        ("x mOd y", e.Arithmetic("mod", x, y)),
        ("x ^ y ^ z", e.Arithmetic("^", x, e.Arithmetic("^", y, z))),
        ("x * y ^ z", e.Arithmetic("*", x, e.Arithmetic("^", y, z))),
        ("-x ^ y", e.Negation(e.Arithmetic("^", x, y))),
        ("-x * y", e.Arithmetic("*", e.Negation(x), y)),
        ("1.5e-3", number("1.5e-3")),
        ("f(x, y + z)", e.Call("f", (x, e.Arithmetic("+", y, z)))),
    ],
)
def test_arithmetic_binds_as_the_specification_says(text: str, tree: e.Expression) -> None:
    assert response(f"0 < {text}") == e.Comparison("<", number("0"), tree)


@pytest.mark.parametrize("op", ["<", "<=", ">", ">=", "=", "!="])
def test_a_comparison_binds_tighter_than_a_negation(op: Any) -> None:
    assert response(f"!x {op} 3 & p") == e.And((e.Not(e.Comparison(op, x, number("3"))), p))


def test_an_occurrence_is_its_predicate() -> None:
    assert response("at the previous occurrence of p, q") == e.Call("prevOcc", (p, q))
    assert response("AT THE PREVIOUS OCCURRENCE OF p, q") == e.Call("prevOcc", (p, q))
    assert response("at the next occurrence of p, q") == e.Call("nextOcc", (p, q))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ('"two words"', "two words"),
        ('"a[3]"', "a[3]"),
        ("a.b", "a.b"),
        ("load%", "load%"),
        ("p.", "p"),
        ("afterwards", "afterwards"),
        ("before_2", "before_2"),
        ("in.x", "in.x"),
        ("trueish", "trueish"),
    ],
)
def test_a_name_is_read_whole(text: str, name: str) -> None:
    assert response(text) == e.Name(name)


def test_a_quoted_key_word_is_a_name() -> None:
    """The help of F109 says to quote it."""
    for word in sorted(RESERVED):
        assert response(f'"{word}"') == e.Name(word)


def test_a_quoted_key_word_stays_a_name_when_it_is_printed() -> None:
    trees = [read(f'the sw shall satisfy "{word}"') for word in sorted(RESERVED)]
    lost = [tree.response for tree in trees if parse(Source("r", printed(tree)).span()) != tree]
    assert lost == []


@pytest.mark.parametrize("field", ["component", "mode", "stop", "condition"])
def test_every_field_takes_quoted_names(field: str) -> None:
    text = 'in "my mode", when "my p" the "my sw" shall until "my s" satisfy q'
    tree = read(text)
    assert tree.scope is not None
    assert tree.condition is not None
    found = {
        "component": e.Name(tree.component),
        "mode": tree.scope.mode,
        "stop": tree.timing.stop if isinstance(tree.timing, s.Until) else None,
        "condition": tree.condition.expression,
    }
    names = {"component": "my sw", "mode": "my mode", "stop": "my s", "condition": "my p"}
    assert found[field] == e.Name(names[field])


# Negations ------------------------------------------------------------------------------------


@pytest.mark.parametrize("sign", ["!", "~"])
def test_no_negation_is_lost_in_any_field(sign: str) -> None:
    tree = read(
        f"while {sign}m, whenever {sign}p the sw shall until {sign}s satisfy {sign}(q | {sign}r)"
    )
    assert tree == s.Sentence(
        s.Scope(s.ScopeKind.IN, e.Not(e.Name("m"))),
        s.Condition(s.ConditionKind.HOLDING, e.Not(p)),
        "sw",
        None,
        s.Until(e.Not(e.Name("s"))),
        e.Not(e.Or((q, e.Not(r)))),
    )


@given(st.lists(st.sampled_from(["!", "~"]), max_size=6))
def test_every_negation_counts(signs: list[str]) -> None:
    depth, tree = 0, response("".join(signs) + "p")
    while isinstance(tree, e.Not):
        depth, tree = depth + 1, tree.arg
    assert (depth, tree) == (len(signs), p)


# Sentences ------------------------------------------------------------------------------------

PLAIN = s.Sentence(None, None, "sw", None, s.Always(), q)


@pytest.mark.parametrize(
    "text",
    [
        "the sw shall always satisfy q",
        "sw shall always satisfy q",
        "shall the sw always satisfy q",
        "shall sw always satisfy q",
        "THE sw SHALL ALWAYS SATISFY q",
        "the sw\n\tshall\r\nalways, satisfy q.",
        "the sw shall, always satisfy q",
        "the sw shall always satisfy (((q)))",
    ],
)
def test_the_same_sentence_in_other_words(text: str) -> None:
    assert read(text) == PLAIN


@pytest.mark.parametrize(
    ("text", "duration"),
    [
        ("2 ticks", s.Duration(2, "tick")),
        ("1 tick", s.Duration(1, "tick")),
        ("2secs", s.Duration(2, "second")),
        ("2 sec", s.Duration(2, "second")),
        ("2 SECONDS", s.Duration(2, "second")),
        ("250 milliseconds", s.Duration(250, "millisecond")),
        ("250 millisec", s.Duration(250, "millisecond")),
        ("7 microsecs", s.Duration(7, "microsecond")),
        ("5 minutes", s.Duration(5, "minute")),
        ("0 hours", s.Duration(0, "hour")),
        ("500 ms", s.Duration(500, "millisecond")),
        ("500ms", s.Duration(500, "millisecond")),
        ("7 us", s.Duration(7, "microsecond")),
        ("2 s", s.Duration(2, "second")),
        ("2 min", s.Duration(2, "minute")),
        ("2 h", s.Duration(2, "hour")),
        ("1.5 seconds", s.Duration(1500, "millisecond")),
        ("0.5 s", s.Duration(500, "millisecond")),
        ("2.0 s", s.Duration(2, "second")),
        ("60.0 minutes", s.Duration(60, "minute")),
        ("90.5 min", s.Duration(5430, "second")),
        ("0.000001 s", s.Duration(1, "microsecond")),
        ("999999999999999 h", s.Duration(999999999999999, "hour")),
    ],
)
def test_a_duration_is_a_whole_number_of_a_unit(text: str, duration: s.Duration) -> None:
    assert read(f"the sw shall within {text} satisfy q").timing == s.Within(duration)
    assert read(f"the sw shall for {text} satisfy q").timing == s.For(duration)
    assert read(f"the sw shall after {text} satisfy q").timing == s.After(duration)


@pytest.mark.parametrize(
    ("digits", "op"), [("1.0", ">"), ("0", "<"), ("1.5", "<"), ("-0.5", ">="), ("2", "=")]
)
def test_a_probability_lies_between_0_and_1(digits: str, op: str) -> None:
    result = parse(
        Source("r.fret", f"the sw shall with probability {op} {digits} satisfy q").span()
    )
    assert isinstance(result, Diagnostic)
    assert result.code is Code.BAD_PROBABILITY


def test_a_thousand_parentheses_are_read() -> None:
    assert response("(" * 1000 + "q" + ")" * 1000) == q


def test_a_thousand_conjuncts_are_read() -> None:
    tree = response(" & ".join(["q"] * 1000))
    assert tree == e.And((q,) * 1000)


@pytest.mark.slow
@given(sentences)
@example(s.Sentence(None, None, "sw", None, s.Always(), e.Not(e.Comparison("=", e.Negation(x), y))))
def test_a_printed_sentence_is_read_back_as_the_same_tree(tree: s.Sentence) -> None:
    assert read(printed(tree)) == tree


def of_two(left: e.Expression, right: e.Expression) -> list[e.Expression]:
    """Every Boolean operator over two operands."""
    return [
        e.both(left, right),
        e.either(left, right),
        e.Xor(left, right),
        e.Implies(left, right),
        e.Iff(left, right),
        e.Not(left),
        e.Call("f", (left, right)),
    ]


@pytest.mark.slow
def test_every_operator_under_every_operator_is_read_back() -> None:
    for inner in of_two(p, q):
        for tree in (*of_two(inner, r), *of_two(r, inner), *of_two(inner, inner)):
            assert response(expression(tree)) == tree
            for outer in some((*of_two(tree, t), *of_two(t, tree)), 7):
                assert response(expression(outer)) == outer


@pytest.mark.slow
def test_every_arithmetic_operator_under_every_other_is_read_back() -> None:
    operators: list[e.ArithmeticOperator] = ["+", "-", "*", "/", "mod", "^"]
    inner: list[e.Expression] = [e.Negation(x), e.Call("f", (x, y))]
    inner += [e.Arithmetic(op, x, y) for op in operators]
    for part in inner:
        for op in operators:
            terms: list[e.Expression] = [e.Arithmetic(op, part, z), e.Arithmetic(op, z, part)]
            for term in (*terms, e.Negation(part)):
                for tree in (e.Comparison("<", term, z), e.Comparison(">=", z, e.Negation(term))):
                    assert response(expression(tree)) == tree


@pytest.mark.slow
@given(sentences)
def test_printing_a_sentence_that_was_read_changes_nothing(tree: s.Sentence) -> None:
    assert printed(read(printed(tree))) == printed(tree)


@pytest.mark.parametrize(
    "rest",
    [
        "the sw shall satisfy r",
        "p",
        "!",
        ")",
        ",",
        ";",
        "and when p",
        "# a comment",
        "-- a comment",
        ". .",
        "< 3 < 5",
        "satisfy q",
        "within 3 ticks",
    ],
)
def test_nothing_is_accepted_after_a_whole_sentence(rest: str) -> None:
    start = "the sw shall always satisfy q"
    read(start)
    assert isinstance(parse(Source("r.fret", f"{start} {rest}").span()), Diagnostic)


@pytest.mark.slow
@given(sentences, st.text(alphabet='abpq .,()!&|<>=-"3\n', max_size=8))
def test_any_text_gives_a_sentence_or_one_mistake(tree: s.Sentence, rest: str) -> None:
    text = printed(tree) + rest
    result = parse(Source("r.fret", text).span())
    if isinstance(result, Diagnostic):
        assert render(result)
    else:
        assert read(printed(result)) == result


def test_a_sentence_is_read_where_it_stands_in_its_file() -> None:
    source = Source("r.fret", "+++\n+++\nthe sw shall q")
    result = parse(source.span(8))
    assert isinstance(result, Diagnostic)
    assert render(result) == (
        "F104 missing `satisfy` before `q`\n"
        "  --> r.fret:3:14\n"
        "   | the sw shall q\n"
        "   |              ^\n"
        "help: write `satisfy q`"
    )


# Mistakes, whole ------------------------------------------------------------------------------


def test_a_missing_satisfy_is_put_in() -> None:
    assert message_of("the Rover shall always stopped") == (
        "F104 missing `satisfy` before `stopped`\n"
        "  --> r.fret:1:24\n"
        "   | the Rover shall always stopped\n"
        "   |                        ^^^^^^^\n"
        "help: write `satisfy stopped`"
    )


def test_a_misspelt_timing_is_fixed() -> None:
    assert message_of("whenever p the sw shall eventualy satisfy q") == (
        "F107 FRETish does not allow the word `eventualy` here\n"
        "  --> r.fret:1:25\n"
        "   | whenever p the sw shall eventualy satisfy q\n"
        "   |                         ^^^^^^^^^\n"
        "help: did you mean `eventually`?"
    )


def test_a_misspelt_condition_word_is_fixed() -> None:
    assert message_of("wen p the sw shall satisfy q") == (
        "F107 FRETish does not allow the word `wen` here\n"
        "  --> r.fret:1:1\n"
        "   | wen p the sw shall satisfy q\n"
        "   | ^^^\n"
        "help: did you mean `when`?"
    )


def test_another_misspelt_condition_word_is_fixed() -> None:
    assert message_of("wenever p the sw shall satisfy q") == (
        "F107 FRETish does not allow the word `wenever` here\n"
        "  --> r.fret:1:1\n"
        "   | wenever p the sw shall satisfy q\n"
        "   | ^^^^^^^\n"
        "help: did you mean `whenever`?"
    )


def test_a_missing_unit_is_asked_for() -> None:
    assert message_of("the sw shall within 3 satisfy q") == (
        "F108 a duration needs a unit\n"
        "  --> r.fret:1:23\n"
        "   | the sw shall within 3 satisfy q\n"
        "   |                       ^^^^^^^\n"
        "help: write ticks, or a unit of time: `within 3 seconds`, `within 500 ms`"
    )


def test_an_unknown_unit_is_named() -> None:
    assert message_of("the sw shall within 3 days satisfy q") == (
        "F108 a duration needs a unit, and `days` is not one\n"
        "  --> r.fret:1:23\n"
        "   | the sw shall within 3 days satisfy q\n"
        "   |                       ^^^^\n"
        "help: write ticks, or a unit of time: `within 3 seconds`, `within 500 ms`"
    )


def test_a_fraction_of_a_tick_is_refused() -> None:
    assert message_of("the sw shall within 2.5 ticks satisfy q") == (
        "F108 `2.5 ticks` is not a whole number of ticks or of microseconds\n"
        "  --> r.fret:1:21\n"
        "   | the sw shall within 2.5 ticks satisfy q\n"
        "   |                     ^^^^^^^^^\n"
        "help: write a whole number of ticks, or a duration of whole microseconds: `0.5 s`"
    )


@pytest.mark.parametrize("unit", ["m", "kg", "ns", "s^2", "m/s", "ms/s", "Hz"])
def test_a_unit_of_something_else_is_no_unit_of_time(unit: str) -> None:
    assert f"`{unit}` is not one" in message_of(f"the sw shall within 3 {unit} satisfy q")


@given(
    st.decimals(0, 10**6, allow_nan=False, places=5),
    st.sampled_from(["us", "ms", "s", "min", "h"]),
)
def test_a_duration_has_the_length_that_is_written(amount: Decimal, symbol: str) -> None:
    length = Fraction(amount) * NANOSECONDS[SYMBOLS[symbol]]
    result = parse(Source("r.fret", f"the sw shall for {amount} {symbol} satisfy q").span())
    if isinstance(result, Diagnostic):
        assert result.code is Code.BAD_DURATION
        assert (length / 1000).denominator > 1
    else:
        assert isinstance(result.timing, s.For)
        duration = result.timing.duration
        assert duration.amount * NANOSECONDS[duration.unit] == length
        assert read(printed(result)) == result


@pytest.mark.parametrize("name", ["s", "h", "ms", "us", "min"])
def test_the_symbol_of_a_unit_is_a_name_elsewhere(name: str) -> None:
    words = read(f"when {name} the {name} shall within 3 {name} satisfy {name} > 3")
    assert words.component == name
    assert words.condition is not None
    assert words.condition.expression == e.Name(name)


@pytest.mark.parametrize("start", ["whenever p", "when p,", "in m mode", ""])
def test_a_missing_component_is_asked_for(start: str) -> None:
    result = parse(Source("r.fret", f"{start} shall eventually satisfy q".strip()).span())
    assert isinstance(result, Diagnostic)
    assert result.code is Code.MISSING_COMPONENT
    assert result.message == "there is no component before `shall`"
    assert result.help == "name what must satisfy the requirement: `the rover shall ...`"


def test_a_key_word_is_told() -> None:
    assert message_of("the sw shall satisfy next") == (
        "F109 `next` is a key word of FRETish and cannot be a name\n"
        "  --> r.fret:1:22\n"
        "   | the sw shall satisfy next\n"
        "   |                      ^^^^\n"
        'help: choose another name, or quote it: `"next"`'
    )


def test_an_empty_text_is_told() -> None:
    assert message_of("").splitlines()[:2] == ["F106 there is no sentence here", "  --> r.fret"]
    assert message_of(" \n ").splitlines()[0] == "F106 there is no sentence here"


def test_an_open_parenthesis_is_told_at_the_end() -> None:
    assert message_of("the sw shall satisfy p & (q | r") == (
        "F101 1 `(` is not closed\n"
        "  --> r.fret:1:32\n"
        "   | the sw shall satisfy p & (q | r\n"
        "   |                                ^\n"
        "help: write `)` here, or where the part in parentheses must end"
    )


def test_a_number_as_response_is_told_with_its_place() -> None:
    assert message_of("the sw shall satisfy x + 1") == (
        "F112 a truth value is needed here, and this is a number\n"
        "  --> r.fret:1:22\n"
        "   | the sw shall satisfy x + 1\n"
        "   |                      ^^^^^\n"
        "help: compare a number: `x > 3`"
    )


def test_a_second_sentence_is_told() -> None:
    assert message_of("the sw shall satisfy q the sw shall satisfy r") == (
        "F117 a second sentence begins here\n"
        "  --> r.fret:1:24\n"
        "   | the sw shall satisfy q the sw shall satisfy r\n"
        "   |                        ^^^\n"
        "help: give each sentence a header with an `id` between two lines `+++`, or its own file"
    )
