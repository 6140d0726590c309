"""The text of TLSF as signals and formulas: compared with Spot's reading, mistakes with places."""

import pytest
import spot

from compiler.logic import printing
from compiler.project.tlsf.specification import Specification, read
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source

HEAD = 'INFO {\n  TITLE: "a test"\n  SEMANTICS: Mealy\n  TARGET: Mealy\n}\n'
SIGNALS = "INPUTS { a; b; } OUTPUTS { x; y }"


def specification(formula: str, section: str = "GUARANTEE") -> Specification:
    found = read(Source("s.tlsf", f"{HEAD}MAIN {{ {SIGNALS} {section} {{ {formula}; }} }}"))
    assert isinstance(found, Specification), found
    return found


@pytest.mark.parametrize(
    ("formula", "as_spot"),
    [
        ("!a && b || x -> y", "((!a & b) | x) -> y"),
        ("a -> b -> x", "a -> (b -> x)"),
        ("a -> b <-> x", "a -> (b <-> x)"),
        ("a <-> b -> x", "a <-> (b -> x)"),
        ("a <-> b W x", "(a <-> b) W x"),
        ("a W b W x", "a W (b W x)"),
        ("a W b U x", "(a W b) U x"),
        ("a U b R x", "(a U b) R x"),
        ("a || b U x", "(a | b) U x"),
        ("!a W b", "(!a) W b"),
        ("a R b R x", "(a R b) R x"),
        ("X X a && F b", "(X X a) & (F b)"),
        ("G F a -> G F b", "(G F a) -> (G F b)"),
        ("a AND NOT b OR x IMPLIES y EQUIV true", "(((a & !b) | x) -> (y <-> 1))"),
        ("G (a /* one */ -> // two\n X b)", "G (a -> X b)"),
    ],
)  # fmt: skip
def test_operators_bind_as_the_format_says(formula: str, as_spot: str) -> None:
    (part,) = specification(formula).formulas
    assert spot.are_equivalent(printing.future(part.formula), as_spot)


def test_signals_and_sections_are_kept_in_order() -> None:
    text = (
        f"{HEAD}MAIN {{ {SIGNALS} INITIALLY {{ !a; }} ASSUMPTIONS {{ G F a; G F b; }} "
        "INVARIANTS { x -> X y; } GUARANTEES { F x; } }\n//#!SYNTCOMP\n//STATUS : realizable"
    )
    found = read(Source("s.tlsf", text))
    assert isinstance(found, Specification)
    assert (found.title, found.semantics, found.target) == ("a test", "Mealy", "Mealy")
    assert (found.inputs, found.outputs) == (("a", "b"), ("x", "y"))
    sections = [(each.section, each.span.text) for each in found.formulas]
    assert sections == [
        ("INITIALLY", "!a"), ("ASSUME", "G F a"), ("ASSUME", "G F b"), ("ASSERT", "x -> X y"),
        ("GUARANTEE", "F x"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "code", "message", "line"),
    [
        (f"{HEAD}MAIN {{ {SIGNALS}\nASSERT {{ x & y; }} }}", "F620",
         "it is not TLSF: `&` stands where `;` is expected", 7),
        (f"{HEAD}MAIN {{ {SIGNALS}\nASSERT {{ z; }} }}", "F620",
         "it is not TLSF: `z` is no input or output", 7),
        (f"{HEAD}MAIN {{ {SIGNALS}\nASSERTS {{ x; }} }}", "F620",
         "it is not TLSF: TLSF has no section `ASSERTS`", 7),
        (f"{HEAD}MAIN {{ {SIGNALS}\nASSERT {{ (x; }} }}", "F620",
         "it is not TLSF: `;` stands where `)` is expected", 7),
        (f"{HEAD}MAIN {{ {SIGNALS}", "F620",
         "it is not TLSF: the file ends where more is expected", 6),
        ("{}", "F620", "it is not TLSF: `{` stands where `INFO` is expected", 1),
        (f"{HEAD}GLOBAL {{ }}\nMAIN {{ }}", "F621",
         "`GLOBAL` belongs to the full format of TLSF", 6),
        (f"{HEAD}MAIN {{\nINPUTS {{ b[2]; }} }}", "F621",
         "a bus or an index belongs to the full format of TLSF", 7),
    ],
)  # fmt: skip
def test_a_mistake_has_its_place(text: str, code: str, message: str, line: int) -> None:
    found = read(Source("s.tlsf", text))
    assert isinstance(found, Diagnostic)
    assert (found.code.value[0], found.message) == (code, message)
    assert found.span is not None
    assert text.count("\n", 0, found.span.start) + 1 == line


def test_deep_formulas_are_refused_in_words() -> None:
    text = f"{HEAD}MAIN {{ {SIGNALS} ASSERT {{ {'(' * 2_000}x{')' * 2_000}; }} }}"
    found = read(Source("s.tlsf", text))
    assert isinstance(found, Diagnostic)
    assert found.message == "it is not TLSF: the formula is nested too deep"
