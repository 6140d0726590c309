"""Requirements that are formulas: their monitors, plays and refusals."""

import pytest

from compiler.emit import TARGETS
from compiler.logic import formula as f
from compiler.targets.python.monitor import refuse
from fretc.analysis.findings import RealizabilityVerdict
from tests.command import Fretc, write
from tests.requirement_sets import analyzed, requirement

BEGINNING = "the sw shall satisfy formula: "


def test_a_formula_is_formalized_as_it_is_written() -> None:
    found = requirement("R", f"{BEGINNING}G (a -> X x)")
    assert found.ft_infinite == f.globally(f.implies(f.Atom("a"), f.next_(f.Atom("x"))))
    assert found.watch.violation == f.and_(f.previous(f.Atom("a")), f.not_(f.Atom("x")))
    assert found.watch.violated_if_ended == f.FALSE


def test_an_explanation_says_that_it_is_a_formula(fretc: Fretc) -> None:
    run = fretc("explain", write("r.fret", f"{BEGINNING}G (a -> F x)\n"))
    assert run.status == 0
    assert "It is no sentence of FRETish." in run.out


@pytest.mark.parametrize("formula", ["G ((a U b) R c)", "F[0,100] a"])
def test_a_formula_without_a_monitor_is_refused(formula: str) -> None:
    found = refuse(requirement("R", f"{BEGINNING}{formula}"))
    assert found is not None
    assert found.message.startswith("a monitor cannot express the formula: ")


@pytest.mark.parametrize("target", ["fret-json", "hoa", "smv", "dafny"])
def test_a_target_for_sentences_refuses_a_formula_in_words(target: str) -> None:
    found = TARGETS[target].refuse(requirement("R", f"{BEGINNING}G F a"))
    assert found is not None
    assert "G (formula)" in found.message or "a formula" in found.message


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sentences", "verdict", "conflict"),
    [
        ((f"{BEGINNING}G F x", f"{BEGINNING}F G !x"), "unrealizable", None),
        ((f"{BEGINNING}F (a & X (b U a)) <-> G F x", ), "realizable", None),
        ((f"{BEGINNING}G (a -> X (x W b))", "the sw shall never satisfy x"), "unrealizable",
         ("R1", "R2")),
        ((f"{BEGINNING}G F (a & X x)", ), "unrealizable", ("R1",)),
        ((f"{BEGINNING}G F a -> G F x", "whenever b the sw shall within 2 ticks satisfy !x"),
         "realizable", None),
    ],
)  # fmt: skip
def test_formulas_are_analyzed_with_sentences(
    sentences: tuple[str, ...], verdict: str, conflict: tuple[str, ...] | None
) -> None:
    found = analyzed(*sentences)
    assert found.verdict == RealizabilityVerdict(verdict)
    conflicts = [each.requirements for each in found.conflicts]
    assert conflicts == ([] if conflict is None else [conflict])


@pytest.mark.slow
def test_an_assumption_that_reads_outputs_leaves_a_game_of_formulas_undecided() -> None:
    found = analyzed(f"{BEGINNING}F G (a -> x)", assumed=(f"{BEGINNING}F G !x -> F G a",))
    assert found.verdict is RealizabilityVerdict.NOT_CHECKED
