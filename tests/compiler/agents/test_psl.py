"""Property files of AJPF: its grammar exactly, and every trap a mistake with its place."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.agents.psl import Property, read
from compiler.logic import formula as f
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source

A, P, Q = f.Atom("B(a,o)"), f.Atom("B(a,p)"), f.Atom("B(a,q)")


def properties(text: str) -> tuple[Property, ...]:
    found = read(Source("p.psl", text))
    assert not isinstance(found, Diagnostic), render(found)
    return found


def formula(text: str) -> f.Formula:
    (found,) = properties(f"R1: {text}")
    return found.formula


def refused(text: str) -> Diagnostic:
    diagnostic = read(Source("p.psl", text))
    assert isinstance(diagnostic, Diagnostic), diagnostic
    assert diagnostic.code is Code.BAD_PROPERTY
    assert diagnostic.is_error
    assert diagnostic.help
    assert diagnostic.span is not None
    return diagnostic


# What AJPF reads as it is written ---------------------------------------------------------------


def test_the_property_of_the_paper() -> None:
    text = "R1: [] ((B(agilex_agent,too_close)) -> (<> (B(agilex_agent,stopped))))"
    (found,) = properties(f"# comment: with a colon\n{text}\n")
    assert found.key == "R1"
    assert found.formula == f.Globally(
        f.Implies(
            f.Atom("B(agilex_agent,too_close)"),
            f.Eventually(f.Atom("B(agilex_agent,stopped)"), f.EVER),
        ),
        f.EVER,
    )
    assert found.span.text == text
    assert (found.span.line, found.span.column) == (2, 1)
    assert found.remarks == ()


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("[] B(a,o) -> B(a,p)", f.Implies(f.Globally(A, f.EVER), P)),
        ("A E B(a,p)", f.Globally(f.Eventually(P, f.EVER), f.EVER)),
        ("[] <> ~ B(a,p)", f.Globally(f.Eventually(f.Not(P), f.EVER), f.EVER)),
        ("~B(a,p) & B(a,q)", f.And((f.Not(P), Q))),
        ("B(a,o) & B(a,p) || B(a,q)", f.And((A, f.Or((P, Q))))),
        ("B(a,o) || B(a,p) & B(a,q)", f.And((f.Or((A, P)), Q))),
        ("B(a,o) -> B(a,p) & B(a,q)", f.Implies(A, f.And((P, Q)))),
        ("B(a,o) -> B(a,p) -> B(a,q)", f.Implies(f.Implies(A, P), Q)),
        ("B(a,o) -> B(a,p) U B(a,q)", f.Until(f.Implies(A, P), Q)),
        ("B(a,o) U B(a,p) -> B(a,q)", f.Until(A, f.Implies(P, Q))),
        ("B(a,o) R B(a,p) -> B(a,q)", f.Release(A, f.Implies(P, Q))),
        ("B(a,o) U B(a,p) R B(a,q)", f.Until(A, f.Release(P, Q))),
        ("B(a,o) U B(a,p) U B(a,q)", f.Until(f.Until(A, P), Q)),
        ("B(a,o) R B(a,p) R B(a,q)", f.Release(f.Release(A, P), Q)),
        ("B(a,o) & B(a,p) & B(a,q)", f.And((f.And((A, P)), Q))),
        ("B(a,o) || B(a,p) || B(a,q)", f.Or((f.Or((A, P)), Q))),
        ("(B(a,o) U (B(a,p)))", f.Until(A, P)),
        ("~(~(B(a,p)))", f.Not(f.Not(P))),
        ("B(a,p)/* no U here */&/**/B(a,q) // the end", f.And((P, Q))),
    ],
)
def test_operators_bind_as_ajpf_has_them(text: str, meant: f.Formula) -> None:
    assert formula(text) == meant


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("G(Ag_1, clean)", "G(Ag_1,clean)"),
        ("I(a,go_2)", "I(a,go_2)"),
        ("D(a,drive( 1.50 , fast ))", "D(a,drive(1.5,fast))"),
        ("ItD(a,stop)", "ItD(a,stop)"),
        ("B(ns.agent,at(_,x(y)))", "B(ns.agent,at(_,x(y)))"),
        ("B(a,p(1))", "B(a,p(1))"),
        ("B(a,p(1.0))", "B(a,p(1))"),
        ("B(a,p(0010))", "B(a,p(10))"),
        ("B(a,p([q, 2, [r]]))", "B(a,p([q,2,[r]]))"),
    ],
)
def test_atoms_are_spelt_without_white_space_and_numbers_by_value(text: str, name: str) -> None:
    assert formula(text) == f.Atom(name)


def test_a_string_is_read_with_a_warning_since_it_matches_nothing() -> None:
    (found,) = properties('R1: B(a,at("room 1"))')
    assert found.formula == f.Atom("B(a,at('room 1'))")
    (diagnostic,) = found.remarks
    assert diagnostic.severity is Severity.WARNING
    assert diagnostic.span is not None
    assert diagnostic.span.text == '"room 1"'


def test_a_file_has_several_properties_and_lines_are_put_together() -> None:
    found = properties(
        "# one\r\nR1: B(a,p)\r\n\r\n   & B(a,q)\r\nR1_reach:B(a,p)\n# : two\n7.b-c: B(a,q)"
    )
    assert {p.key: p.formula for p in found} == {"R1": f.And((P, Q)), "R1_reach": P, "7.b-c": Q}
    assert found[0].span.line == 2


def test_a_file_of_comments_has_no_property() -> None:
    assert properties("") == ()
    assert properties("# R1: X\n\n") == ()


# Traps ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message", "at"),
    [
        ("X B(a,p)", "`X` cannot begin a formula", "X"),
        ("[] (B(a,p) -> X B(a,q))", "`X` cannot begin a formula", "X"),
        ("! B(a,p)", "`!` cannot begin a formula", "!"),
        ("not B(a,p)", "`not` cannot begin a formula", "not"),
        ("B(a,~p)", "`~` is no name of a belief or an action", "~"),
        ("<> [] B(a,p)", "`[]` cannot begin a formula", "[]"),
        ("[] [] B(a,p)", "`[]` cannot begin a formula", "[]"),
        ("<> <> B(a,p)", "`<>` cannot begin a formula", "<>"),
        ("~ [] B(a,p)", "`[]` cannot begin a formula", "[]"),
        ("~~B(a,p)", "`~` cannot begin a formula", "~"),
        ("[] ~ <> B(a,p)", "`<>` cannot begin a formula", "<>"),
        ("(B(a,p)", "`)` is missing at the end", ""),
        ("B(a,p", "`)` is missing at the end", ""),
        ("((B(a,p)) & (B(a,q))", "`)` is missing at the end", ""),
        ("(B(a,p) W B(a,q))", "`)` is missing before `W`", "W"),
        ("B(a,p) )", "AJPF drops `)` and all that follows it", ")"),
        ("B(a,p) W B(a,q)", "AJPF drops `W` and all that follows it", "W"),
        ("B(a,p) M B(a,q)", "AJPF drops `M` and all that follows it", "M"),
        ("B(a,p) V B(a,q)", "AJPF drops `V` and all that follows it", "V"),
        ("B(a,p) <-> B(a,q)", "AJPF drops `<->` and all that follows it", "<->"),
        ("B(a,p) <=> B(a,q)", "AJPF drops `<=>` and all that follows it", "<=>"),
        ("B(a,p) => B(a,q)", "AJPF drops `=>` and all that follows it", "=>"),
        ("B(a,p) && B(a,q)", "AJPF drops `&&` and all that follows it", "&&"),
        ("B(a,p) | B(a,q)", "AJPF drops `|` and all that follows it", "|"),
        ("B(a,p) B(a,q)", "AJPF drops `B` and all that follows it", "B"),
        ("B(a,p) % shall", "AJPF drops `%` and all that follows it", "%"),
        ("B(a,p) # shall", "AJPF drops `#` and all that follows it", "#"),
        ("B(a,p) /* & B(a,q)", "AJPF drops `/*` and all that follows it", "/*"),
        ("B(a,p) UB(a,q)", "AJPF drops `UB` and all that follows it", "UB"),
        ("B(a,p) U UB(a,q)", "`UB` cannot begin a formula", "UB"),
        ("<>[3] B(a,p)", "`[` cannot begin a formula", "["),
        ("B(a,p) &", "a formula is missing", ""),
        ("   ", "a formula is missing", ""),
        ("# B(a,p)", "`#` cannot begin a formula", "#"),
        ("T", "`T` cannot begin a formula", "T"),
        ("[] (~F)", "`F` cannot begin a formula", "F"),
        ("<> P(obstacle)", "`P` cannot begin a formula", "P"),
        ("B(a,Too_close)", "`Too_close` is no name", "Too_close"),
        ("B(a,_p)", "`_p` is no name", "_p"),
        ("B(a,1p)", "`1p` is no name", "1p"),
        ("B(a,1)", "`1` is no name", "1"),
        ("B(a,_)", "`_` is no name", "_"),
        ("B(a,p<q)", "`p<q` is no name", "p<q"),
        ("B(a,p(X))", "`X` is no name", "X"),
        ("B(a,p(T))", "`T` is no name", "T"),
        ("B(a,p(ItD))", "`ItD` is no name", "ItD"),
        ("B(a,p())", "`)` is no name", ")"),
        ("B(a,p([]))", "`[]` is no name", "[]"),
        ("B(a,p(-1))", "`-` is no name", "-"),
        ("B(a,p(1e5))", "`1e5` is no name", "1e5"),
        ("B(a-b,p)", "`,` is missing before `-`", "-"),
        ("B(T,p)", "`T` is no name of an agent", "T"),
        ("B(ItD,p)", "`ItD` is no name of an agent", "ItD"),
        ("B(_a,p)", "`_a` is no name of an agent", "_a"),
        ("B(a)", "`,` is missing before `)`", ")"),
        ("B a,p)", "`(` is missing before `a`", "a"),
        ("too_close", "`too_close` cannot begin a formula", "too_close"),
        ("B(a,p('x'))", "`'` is no name", "'"),
        ("B(a,p) : B(a,q)", "AJPF drops what stands behind a second `:`", ": B(a,q)"),
        ("B(a,p\u00e9)", "`\u00e9` is not ASCII", "\u00e9"),
    ],
)
def test_what_ajpf_repairs_drops_or_crashes_on_is_refused(text: str, message: str, at: str) -> None:
    diagnostic = refused(f"# one\nR1: {text}\n")
    assert diagnostic.message.startswith(message), diagnostic.message
    assert diagnostic.span is not None
    assert diagnostic.span.text == at
    assert diagnostic.span.line == 2


@pytest.mark.parametrize(
    ("text", "message", "line"),
    [
        ("R1:\nB(a,p)", "nothing stands behind the `:`", 1),
        (":", "`` is no key", 1),
        ("R1: B(a,p)\n:\n", "`` is no key", 2),
        (" R1: B(a,p)", "` R1` is no key", 1),
        ("R1 : B(a,p)", "`R1 ` is no key", 1),
        ("R,1: B(a,p)", "`R,1` is no key", 1),
        ("R 1: B(a,p)", "`R 1` is no key", 1),
        ("// R1: B(a,p)", "`// R1` is no key", 1),
        (" # a comment: no\nR1: B(a,p)", "the `#` is not in column 1", 1),
        ("R1: B(a,p)\nR2: B(a,p)\nR1: B(a,q)", "the key `R1` comes twice", 3),
        ("B(a,p)\nR1: B(a,p)", "the text stands before the first key", 1),
        ("R1: B(a,p)\n% & B(a,q)", "AJPF drops `%` and all that follows it", 2),
        ("R1: B(a,p)\n # & B(a,q)", "AJPF drops `#` and all that follows it", 2),
        ("R1: B(a,p) // here\n & B(a,q)", "`//` swallows all lines", 1),
        ("R1: // here\nB(a,p)", "`//` swallows all lines", 1),
        ("R1: B(a,too\nclose)", "two lines become one word: `tooclose`", 1),
        ("R1: B(a,p) U\nB(a,q)", "two lines become one word: `UB`", 1),
        ('R1: B(a,p("x\ny"))', 'two lines become one word: `"xy"`', 1),
        ("R1: B(a,p)\nR2: X", "`X` cannot begin a formula", 2),
    ],
)
def test_the_file_reader_of_ajpf_has_traps_of_its_own(text: str, message: str, line: int) -> None:
    diagnostic = refused(text)
    assert diagnostic.message.startswith(message), diagnostic.message
    assert diagnostic.span is not None
    assert diagnostic.span.line == line


def test_a_refusal_shows_the_place_and_the_way_out() -> None:
    assert render(refused("R1: <> [] B(a,p)")) == (
        "F603 `[]` cannot begin a formula\n"
        "  --> p.psl:1:8\n"
        "   | R1: <> [] B(a,p)\n"
        "   |        ^^\n"
        "help: put parentheses around it: AJPF drops an operator that stands here"
    )


@pytest.mark.parametrize("text", ["(" * 5000 + "B(a,p)" + ")" * 5000, "B(a," + "p(" * 5000])
def test_nesting_has_an_end(text: str) -> None:
    assert refused(f"R1: {text}").message.startswith("more than 1000 parentheses")


def test_many_levels_are_read() -> None:
    assert formula("(" * 900 + "B(a,p)" + ")" * 900) == P


@given(st.text("RB(a,pq)U X&|<>[]~->:#/*%\"'_.1T\n \u00e9", max_size=40))
def test_every_text_is_read_or_refused(text: str) -> None:
    """No text raises; and what is read holds no word that is not of the grammar."""
    found = read(Source("p.psl", text))
    if isinstance(found, Diagnostic):
        assert found.code is Code.BAD_PROPERTY
    else:
        assert len({p.key for p in found}) == len(found)
