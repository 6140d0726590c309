"""PCTL*: a probability around what is demanded at each trigger, and almost surely everywhere."""

import re
from collections.abc import Iterator

import pytest

from compiler.formalization.record import formulas
from compiler.logic import printing
from compiler.logic.spot import same_language
from tests import meaning
from tests.each import each
from tests.effort import some
from tests.monitoring import requirement
from tests.strategies import CONDITIONS, SCOPES, TIMINGS


def pctl(sentence: str) -> str:
    formula = requirement(sentence).pctl
    assert formula is not None
    return printing.pctl(formula)


@pytest.mark.parametrize(
    ("sentence", "text"),
    [
        (
            "the sw shall with probability > 0.9 satisfy q",
            "P>=1 [ P>0.9 [ (F q) ] ]",
        ),
        (
            "whenever p the sw shall with probability >= 0.95 within 3 ticks satisfy q",
            "P>=1 [ (G ((!p) | P>=0.95 [ (F[0,3] q) ])) ]",
        ),
        (
            "in m mode upon p the sw shall with probability <= 0.1 eventually satisfy q",
            "P>=1 [ ("
            "(G ((!(m & (!p) & (!(X (!m))) & (X p))) | (X P<=0.1 [ ((!(X (!m))) U q) ])))"
            " & (G ((!((!m) & (X m))) | (X ((!p) | P<=0.1 [ ((!(X (!m))) U q) ]))))"
            " & ((!m) | (!p) | P<=0.1 [ ((!(X (!m))) U q) ])"
            ") ]",
        ),
        (
            "only in m mode the sw shall with probability > 0.5 eventually satisfy q",
            "P>=1 [ ("
            "(G ((!(m & (X (!m)))) | (X P>0.5 [ (!((!(X m)) U q)) ])))"
            " & (m | P>0.5 [ (!((!(X m)) U q)) ])"
            ") ]",
        ),
        (
            "upon p the sw shall with probability != 0.25 until s satisfy q",
            "P>=1 [ ("
            "(G ((!((!p) & (X p))) | (X P!=0.25 [ (!((!s) U (!(s | q)))) ])))"
            " & ((!p) | P!=0.25 [ (!((!s) U (!(s | q)))) ])"
            ") ]",
        ),
        (
            "whenever p the sw shall with probability = 1 immediately satisfy q <-> r",
            "P>=1 [ (G ((!p) | P=1 [ ((q & r) | ((!q) & (!r))) ])) ]",
        ),
        (
            "the sw shall with probability < 0.5 always satisfy q xor r",
            "P>=1 [ P<0.5 [ (G ((q & (!r)) | ((!q) & r))) ] ]",
        ),
    ],
)
def test_a_demand_has_its_probability_from_its_trigger_on(sentence: str, text: str) -> None:
    assert pctl(sentence) == text


# All templates --------------------------------------------------------------------------------


def templates(probability: str) -> Iterator[str]:
    """Every template with a probability, those that count with 0 and 2."""
    for scope in SCOPES.values():
        for condition in CONDITIONS.values():
            for key, timing in TIMINGS.items():
                for n in (0, 2) if key in meaning.COUNTING else (0,):
                    said = timing.format(n=n)
                    yield f"{scope} {condition} the sw shall {probability} {said} satisfy q"


ALL = list(templates("with probability >= 0.9"))


def without_probabilities(text: str) -> str:
    """The LTL within PCTL*, in the spelling of Spot."""
    plain = re.sub(r"P(?:[<>]=?|!?=)[0-9.]+ \[ ", "( ", text).replace(" ]", " )")
    spelt = re.sub(r"\[(\d+),(\d+)\]", r"[\1:\2]", plain)
    return spelt.replace("false", "0").replace("true", "1")


def test_taking_the_probabilities_out_leaves_the_rest() -> None:
    assert without_probabilities("P>=1 [ (G ((!p) | P>=0.95 [ (F[0,3] q) ])) ]") == (
        "( (G ((!p) | ( (F[0:3] q) ))) )"
    )


def test_all_templates_are_there() -> None:
    assert len(ALL) == len(set(ALL)) == 8 * 3 * (9 + 3 * 2)


@pytest.mark.slow
@each("sentence", some(ALL, 5))
def test_without_its_probabilities_it_is_the_future_time_formula(sentence: str) -> None:
    formula = printing.future(requirement(sentence).ft_infinite)
    assert same_language(without_probabilities(pctl(sentence)), formula)


@pytest.mark.slow
@each("sentence", some(ALL, 5))
def test_the_model_checkers_know_every_operator(sentence: str) -> None:
    """They have no implication and no release within a path, and no last tick."""
    words = re.findall(r"->|=>|\w+", re.sub(r"P>=(?:0\.9|1) \[", "[", pctl(sentence)))
    numbers = {"0", "1", "2", "3"}
    assert set(words) <= {"m", "p", "q", "s", "G", "F", "X", "U", "true", "false"} | numbers


@pytest.mark.slow
@each("sentence", some(ALL, 5))
def test_every_path_is_within_a_probability(sentence: str) -> None:
    """`P>=1` stands around the whole, and no bound stands without what is demanded."""
    text = pctl(sentence)
    assert text.startswith("P>=1 [ ")
    assert text.count("[ ") == text.count(" ]")
    assert "P>=0.9 [ " in text


@pytest.mark.slow
@each("sentence", some(templates(""), 5))
def test_a_sentence_without_a_probability_has_none(sentence: str) -> None:
    formalized = requirement(sentence)
    assert formalized.pctl is None
    assert formulas(formalized)["pctl"] is None
