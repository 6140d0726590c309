"""Requirements from TLSF: Spot proves their meaning, and decides the same specifications."""

import json
import random

import pytest
import spot
from hypothesis import given
from hypothesis import strategies as st

from compiler.logic import formula as f
from compiler.logic import printing
from compiler.project.tlsf.importing import read_specification
from compiler.project.tlsf.patterns import as_formula, sentences
from compiler.project.tlsf.specification import ALWAYS, OF_ENVIRONMENT, Specification, read
from fretc.analysis.analysis import AnalysisOptions, analyze
from fretc.analysis.findings import RealizabilityVerdict
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Source
from tests.command import Fretc, write
from tests.effort import FULL, examples
from tests.requirement_sets import ROLES, requirement, requirements
from tests.strategies import future as temporal
from tests.strategies import leaves

HEAD = "INFO { SEMANTICS: Mealy TARGET: Mealy }\n"
NAMES = {name: name for name in "abxy"}
PATTERNS = (
    "G {p}", "{p}", "X {p}", "X X {p}", "F {p}", "G F {p}", "G (F X {p})", "G ({p} -> F {q})",
    "G ({p} -> X F {q})", "G ({p} -> G {q})", "G ({p} -> ({q} W {r}))", "G ({p} -> X ({q} U {r}))",
    "G ({p} -> ({q} R {r}))", "{p} W {q}", "{p} U {q}", "{p} R {q}", "G ({p} && X {q} -> X X {r})",
    "G ({p} <-> X {q})", "!F {p}", "!(G {p} -> F {q})", "G ({p} || F {q})",
    "G ({p} -> F {q} && {r})", "{p} <-> X {q}", "G G {p} && G (F {q} && {r})",
)  # fmt: skip
"""Formulas that have sentences, for any `p`, `q`, `r` without temporal operators."""
OTHERS = (
    "F G {p}", "G F {p} -> G F {q}", "G ({p} U (F {q} W {r}))", "G ({p} -> F X G {q})",
)  # fmt: skip


BOUNDS = st.sampled_from([f.EVER, f.Interval(0, 2), f.Interval(1, 3)])
FORMULAS = st.recursive(leaves, lambda inner: temporal(inner, BOUNDS), max_leaves=6)


def formula(text: str) -> f.Formula:
    found = read(Source("s.tlsf", specified(f"GUARANTEE {{ {text}; }}")))
    assert isinstance(found, Specification), (text, found)
    return found.formulas[0].formula


def filled(choose: random.Random, pattern: str) -> str:
    def part() -> str:
        one, other = (choose.choice(["", "!"]) + choose.choice("abxy") for _ in range(2))
        return choose.choice(
            [one, f"({one} && {other})", f"({one} || {other})", f"({one} -> {other})"]
        )

    return pattern.format(p=part(), q=part(), r=part())


def future(sentence: str) -> str:
    return printing.future(requirement("R", sentence).ft_infinite)


def specified(rest: str, inputs: str = "a; b;", outputs: str = "x; y;") -> str:
    return f"{HEAD}MAIN {{ INPUTS {{ {inputs} }} OUTPUTS {{ {outputs} }}\n{rest} }}"


class Definitions:
    """Propositions for temporal predicates, and what they are at each tick."""

    def __init__(self) -> None:
        self.names: dict[str, str] = {}
        self.formulas: list[str] = []

    def without_predicates(self, text: str) -> str:
        """A text in Spot's notation with a proposition for each predicate."""
        text = text.replace('"', "").replace("FTP", self._first())
        while (start := text.find("preBool(")) >= 0:
            end = closing(text, start + len("preBool"))
            first, _, inner = text[start + len("preBool(") : end].partition(",")
            name = self._named(text[start : end + 1])
            past = f"X {name} <-> ({self.without_predicates(inner)})"
            self.formulas.append(f"({'' if first == 'TRUE' else '!'}{name} & G({past}))")
            text = f"{text[:start]}{name}{text[end + 1 :]}"
        return text

    def _first(self) -> str:
        self.formulas.append("(first & X G !first)")
        return "first"

    def _named(self, whole: str) -> str:
        return self.names.setdefault(whole, f"past{len(self.names)}")


def closing(text: str, opening: int) -> int:
    """Index of the parenthesis that closes another one."""
    level = 0
    for index in range(opening, len(text)):
        level += {"(": 1, ")": -1}.get(text[index], 0)
        if level == 0:
            return index
    raise AssertionError(text)


def drawn(seed: int) -> str:
    choose = random.Random(seed)
    return filled(choose, PATTERNS[seed % len(PATTERNS)])


@pytest.mark.slow
def test_sentences_mean_what_the_formula_says() -> None:
    for seed in range(20 * len(PATTERNS) if FULL else 2 * len(PATTERNS)):
        text = drawn(seed)
        found = sentences(formula(text), NAMES)
        assert found, text
        definitions = Definitions()
        meant = " & ".join(f"({definitions.without_predicates(future(each))})" for each in found)
        known = " & ".join(definitions.formulas) or "1"
        said = printing.future(formula(text))
        assert spot.are_equivalent(f"{known} & {meant}", f"{known} & ({said})"), (text, found)


def test_what_no_sentence_means_has_none() -> None:
    for text in OTHERS:
        assert sentences(formula(text.format(p="a", q="b", r="x")), NAMES) is None, text


def synthesized(specification: Specification) -> bool:
    """Spot's answer for the formula of a specification."""

    def joint(*, of_environment: bool) -> str:
        parts = [
            f"({'G' if each.section in ALWAYS else ''} ({printing.future(each.formula)}))"
            for each in specification.formulas
            if (each.section in OF_ENVIRONMENT) is of_environment
        ]
        return " & ".join(parts) or "1"

    whole = f"({joint(of_environment=True)}) -> ({joint(of_environment=False)})"
    return bool(spot.solve_game(spot.ltl_to_game(whole, [*specification.outputs])))


@pytest.mark.slow
def test_imported_specifications_are_realizable_just_where_spot_says() -> None:
    verdicts = set()
    for seed in range(400 if FULL else 24):
        choose = random.Random(repr(("tlsf", seed)))
        parts = "; ".join(
            filled(choose, choose.choice((*PATTERNS, *OTHERS, *OTHERS)))
            for _ in range(choose.randint(1, 3))
        )
        given = choose.choice(
            ["", "ASSUME { G F a; } ", "REQUIRE { a -> !b; } ", "INITIALLY { !a; } "]
        )
        text = specified(f"{given}GUARANTEE {{ {parts}; }}")
        specification = read(Source("s.tlsf", text))
        assert isinstance(specification, Specification)
        imported = read_specification(Source("s.tlsf", text))
        assert {each.code for each in imported.diagnostics} <= {Code.NO_PATTERN}, text
        texts = imported.artifacts[0].text.split("+++\n")
        pairs = [*zip(texts[1::2], texts[2::2], strict=True)]
        assumed = [line.strip() for header, line in pairs if "assumption" in header]
        demanded = [line.strip() for header, line in pairs if "assumption" not in header]
        found = analyze(
            requirements(*demanded),
            ROLES,
            [requirement(f"A{number}", each) for number, each in enumerate(assumed)],
            AnalysisOptions(repairs=False),
        )
        if found.verdict is RealizabilityVerdict.NOT_CHECKED:  # Spot's game knows no `preBool`.
            assert "formula:" in imported.artifacts[0].text
            assert "preBool" in imported.artifacts[0].text
            continue
        is_realizable = found.verdict is RealizabilityVerdict.REALIZABLE
        assert is_realizable is synthesized(specification), text
        verdicts.add(is_realizable)
    assert verdicts == {True, False}


def test_a_specification_becomes_a_project(fretc: Fretc) -> None:
    rest = "ASSUME { G F !req; } ASSERT { req -> F grant; cancel -> X !grant; grant || G1'; }"
    text = specified(rest, "req; cancel;", "grant; G1';")
    run = fretc("import", write("s.tlsf", text), "-o", "set")
    assert run.status == 0, run.err
    assert "imported 4 requirements (1 of them assumptions), 4 variables" in run.err
    run = fretc("analyze", "set", "--format", "json", "-o", "a.json")
    assert run.status == 1, run.err
    assert [each["requirements"] for each in json.loads(run.out)["conflicts"]] == [["G2", "G3"]]


def test_formulas_without_a_sentence_stay_formulas_and_a_warning_says_so(fretc: Fretc) -> None:
    text = specified("GUARANTEE {\n F G x;\n F x;\n F G a -> F G y; }")
    run = fretc("import", write("s.tlsf", text), "-o", "set")
    assert run.status == 0
    assert [line for line in run.err.splitlines() if line.startswith(("F622", "  -->"))] == [
        "F622 warning: no sentence of FRETish means `F G x`, nor 1 other formula: imported as a "
        "formula",
        "  --> s.tlsf:4:2",
    ]  # fmt: skip
    run = fretc("analyze", "set", "-o", "a.json")
    assert run.status == 0, run.err
    assert "G1, G2 (about x): the system wins the game of the formulas" in run.out


@examples(100)
@given(FORMULAS)
def test_an_imported_formula_is_read_back_with_its_meaning(formula: f.Formula) -> None:
    text = as_formula(formula, {name: name for name in f.atoms(formula)})
    again = requirement("R", text).ft_infinite
    assert spot.are_equivalent(printing.future(again), printing.future(formula)), text


@pytest.mark.parametrize(("semantics", "target"), [("Moore", "Mealy"), ("Mealy", "Moore")])
def test_another_semantics_is_refused(semantics: str, target: str) -> None:
    head = f"INFO {{ SEMANTICS: {semantics} TARGET: {target} }}"
    found = read_specification(Source("s.tlsf", f"{head} MAIN {{ INPUTS {{ }} OUTPUTS {{ x; }} }}"))
    (mistake,) = found.diagnostics
    assert mistake.message == (
        f"its semantics is `{semantics}` and its target `{target}`: only Mealy is imported"
    )


def test_an_assumption_about_outputs_is_warned_of() -> None:
    text = specified("ASSUME { G (x -> X a); } ASSERT { x; }")
    found = read_specification(Source("s.tlsf", text))
    (warning,) = found.diagnostics
    assert warning.code is Code.ASSUMPTION_READS_OUTPUTS
    assert found.artifacts
