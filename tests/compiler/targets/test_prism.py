"""PRISM files: the property says what the sentence says, in words that PRISM and Storm read."""

import re
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.spot import same_language
from compiler.targets.prism import complement, unrolled
from tests import meaning
from tests.compiler.formalization.test_pctl import templates
from tests.each import each
from tests.effort import some
from tests.emitting import MANY, PROBABLE, emitted, refused, requirement
from tests.programs import package
from tests.strategies import CONDITIONS, SCOPES, TIMINGS


def property_of(sentence: str) -> str:
    text = emitted("prism", sentence)["r1.props"]
    (line,) = [line for line in text.splitlines() if not line.startswith("//")]
    found = re.fullmatch(r'"r1": (.*);', line)
    assert found
    return found[1]


# The property ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sentence", "text"),
    [
        (
            "whenever p the sw shall with probability >= 0.9 within 3 ticks satisfy q",
            'P>=1 [ (G ((!"p") | P>=0.9 [ (F<=3 "q") ])) ]',
        ),
        (
            "whenever p the sw shall with probability > 0.95 for 3 ticks satisfy q",
            'P>=1 [ (G ((!"p") | P<0.05 [ (F<=3 (!"q")) ])) ]',
        ),
        (
            "the sw shall with probability = 0.5 eventually satisfy q",
            'P>=1 [ (P>=0.5 [ (F "q") ] & P<=0.5 [ (F "q") ]) ]',
        ),
        (
            "the sw shall with probability != 0.5 eventually satisfy q",
            'P>=1 [ (P<0.5 [ (F "q") ] | P>0.5 [ (F "q") ]) ]',
        ),
        (
            "whenever p the sw shall with probability < 0.1 after 1 tick satisfy q",
            'P>=1 [ (G ((!"p") | P<0.1 [ ((!"q") & (X (!"q")) & ("q" | (X ("q" | (X "q"))))) ])) ]',
        ),
        (
            "the sw shall with probability >= 1 until s satisfy x > 3",
            'P>=1 [ P>=1 [ (!((!"s") U (!("s" | "x_gt_3")))) ] ]',
        ),
    ],
)
def test_a_property_in_the_words_of_prism(sentence: str, text: str) -> None:
    assert property_of(sentence) == text


def without_probabilities(text: str) -> str:
    """The LTL within, of a property with `>= 0.9`: what is complemented is negated."""
    plain = re.sub(r"P<=0\.1 \[ ", "!( ", text)
    plain = re.sub(r"P>=(?:1|0\.9) \[ ", "( ", plain).replace(" ]", " )").replace('"', "")
    assert "P" not in plain
    spelt = re.sub(r"F<=(\d+)", r"F[0:\1]", plain)
    return spelt.replace("false", "0").replace("true", "1")


ALL = list(templates("with probability >= 0.9"))


@pytest.mark.slow
@each("sentence", some(ALL, 7))
def test_without_its_probabilities_it_is_the_future_time_formula(sentence: str) -> None:
    formula = printing.future(requirement(sentence).ft_infinite)
    assert same_language(without_probabilities(property_of(sentence)), formula)


@pytest.mark.slow
@each("sentence", some(ALL, 7, first=3))
def test_no_trap_of_prism_or_storm_is_in_it(sentence: str) -> None:
    text = property_of(sentence)
    words = set(re.findall(r"[A-Za-z]+", re.sub(r'"\w+"', "", text)))
    assert words <= {"P", "X", "F", "G", "U", "true", "false"}
    assert not re.search(r"=>|->|LAST|G<=|\[\d", text)
    for path in re.findall(r"\[ ((?:(?! \]).)*F<=.*?) \]", text):
        assert re.fullmatch(r'.*P[<>]=?[0-9.]+ \[ \(F<=\d+ (?:"q"|\(!"q"\))\)', f"P>1 [ {path}")


def test_chains_of_next_mean_the_bounds() -> None:
    p, q = f.Atom("p"), f.Atom("q")
    for bounded in (
        f.eventually(p, f.Interval(0, 3)),
        f.globally(p, f.Interval(0, 3)),
        f.eventually(p, f.Interval(2, 2)),
        f.globally(f.or_(p, f.eventually(q, f.Interval(1, 2))), f.Interval(1, 3)),
    ):
        chain = unrolled(bounded)
        assert f.longest_bound(chain) == 0
        assert same_language(printing.future(chain), printing.future(bounded))


def test_a_complement_is_exact_whatever_its_digits() -> None:
    digits = "0." + "9" * 40
    odds = f.ProbabilityBound(">=", digits, f.globally(f.Atom("q"), f.Interval(0, 2)))
    found = complement(odds)
    assert found.op == "<="
    assert Fraction(found.bound) == 1 - Fraction(digits)
    assert found.arg == f.eventually(f.not_(f.Atom("q")), f.Interval(0, 2))


# The model ------------------------------------------------------------------------------------


def test_the_frame_of_a_model() -> None:
    text = emitted("prism", PROBABLE.replace("q", "x > 3"))["r1.prism"]
    assert text.split("dtmc\n")[1] == (
        "\n"
        "const double p_p;  // how likely p is true at a tick\n"
        "const double p_x_gt_3;  // how likely x > 3 is true at a tick\n"
        "\n"
        "module draw_p\n"
        "  p : bool;\n"
        "  [tick] true -> p_p : (p' = true) + 1 - p_p : (p' = false);\n"
        "endmodule\n"
        "\n"
        "module draw_x_gt_3\n"
        "  x_gt_3 : bool;\n"
        "  [tick] true -> p_x_gt_3 : (x_gt_3' = true) + 1 - p_x_gt_3 : (x_gt_3' = false);\n"
        "endmodule\n"
        "\n"
        "// The first tick is drawn as any other: every state that it can be begins a trace.\n"
        "init\n"
        "  (p ? p_p > 0 : p_p < 1) & (x_gt_3 ? p_x_gt_3 > 0 : p_x_gt_3 < 1)\n"
        "endinit\n"
        "\n"
        'label "p" = p;\n'
        'label "x_gt_3" = x_gt_3;  // x > 3\n'
    )


def test_the_frame_says_that_it_is_one() -> None:
    text = emitted("prism", PROBABLE)["r1.prism"]
    assert "A frame to be replaced: it runs, but it is not a model of your system." in text
    assert "//   prism r1.prism r1.props -const p_p=0.5,p_q=0.5\n" in text


@each("names", [("1.main-x", "r1_main_x"), ("R-1.2", "r_1_2")])
def test_a_property_has_a_name_that_prism_reads(names: tuple[str, str]) -> None:
    """An identifier in quotes: it begins with a letter."""
    id, name = names
    files = emitted("prism", PROBABLE, id)
    assert f'\n"{name}": P>=1 [ ' in next(text for path, text in files.items() if ".props" in path)


def test_names_of_chances_are_no_names_of_propositions() -> None:
    text = emitted("prism", PROBABLE.replace("q", "p_p & init_ & draw_p"))["r1.prism"]
    names = re.findall(r"(?:const double|module|label) \"?(\w+)", text.split("dtmc")[1])
    found = re.findall(r"^  (\w+) : bool;", text, re.M) + re.findall(r"^module (\w+)", text, re.M)
    assert len(names) == 3 * 4
    assert len({*found, *re.findall(r"const double (\w+)", text)}) == 3 * 4


# Storm ----------------------------------------------------------------------------------------

Check = Callable[[str, dict[str, float]], bool]


@pytest.fixture
def storm(tmp_path: Path) -> Check:
    """Whether the frame satisfies the property, with such chances."""
    stormpy = package("stormpy")

    def check(sentence: str, chances: dict[str, float]) -> bool:
        files = emitted("prism", sentence)
        path = tmp_path / "model.prism"
        path.write_text(
            re.sub(
                r"const double p_(\w+);",
                lambda found: f"const double p_{found[1]} = {chances.get(found[1], 0.5)};",
                files["r1.prism"],
            )
        )
        program = stormpy.parse_prism_program(str(path))
        (asked,) = stormpy.parse_properties(files["r1.props"], program)
        model = stormpy.build_model(program, [asked])
        result = stormpy.model_checking(model, asked)
        return all(result[state] for state in model.initial_states)

    return check


@pytest.mark.parametrize(
    ("sentence", "bound"),
    [
        # q may come at the trigger; it does not where only the later ticks are drawn: 3 of them
        ("whenever p the sw shall with probability >= {} within 3 ticks satisfy q", 1 - 0.4**3),
        ("whenever p & q the sw shall with probability >= {} for 2 ticks satisfy q", 0.6**2),
        ("whenever p & !q the sw shall with probability >= {} after 1 tick satisfy q", 0.4 * 0.6),
        ("whenever p the sw shall with probability >= {} at the next timepoint satisfy q", 0.6),
    ],
)
def test_storm_computes_the_probability_that_the_sentence_means(
    storm: Check, sentence: str, bound: float
) -> None:
    chances = {"p": 0.3, "q": 0.6}
    assert storm(sentence.format(f"{bound - 0.01:.4f}"), chances)
    assert not storm(sentence.format(f"{bound + 0.01:.4f}"), chances)


@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("timing", TIMINGS)
def test_storm_reads_every_timing(storm: Check, condition: str, timing: str) -> None:
    wording = TIMINGS[timing].format(n=2)
    for op in (">=", "=", "!=", "<"):
        storm(
            f"{CONDITIONS[condition]} the sw shall with probability {op} 0.9 {wording} satisfy q",
            {},
        )


@pytest.mark.parametrize("scope", [scope for scope in meaning.SCOPES if scope != "null"])
def test_storm_reads_every_scope(storm: Check, scope: str) -> None:
    for timing in ("within 2 ticks", "for 2 ticks", "finally", "eventually"):
        storm(f"{SCOPES[scope]} upon p sw shall with probability >= 0.9 {timing} satisfy q", {})


# Refusals -------------------------------------------------------------------------------------


def test_a_sentence_without_a_probability_is_refused() -> None:
    assert refused("prism", "whenever p the sw shall within 3 ticks satisfy q") == (
        "F601 PRISM cannot express a requirement without a probability, such as that of R1\n"
        "  --> r.fret:1:1\n"
        "   | whenever p the sw shall within 3 ticks satisfy q\n"
        "   | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^\n"
        "help: add `with probability >= 0.99` before the timing, or use `--emit smv` or `hoa`"
    )


@pytest.mark.parametrize(
    ("sentence", "message"),
    [
        (
            "in m mode the sw shall with probability > 0.9 within 65 ticks satisfy q",
            "F601 PRISM cannot express more than 64 ticks of `within 65 ticks` in one path formula",
        ),
        (
            "whenever prevOcc(p, q) the sw shall with probability > 0.9 eventually satisfy q",
            "F601 PRISM cannot express the predicate `prevOcc`, which looks back,",
        ),
    ],
)
def test_what_its_formulas_cannot_say_is_refused(sentence: str, message: str) -> None:
    assert refused("prism", sentence).startswith(message)


def test_a_long_bound_around_states_is_one_operator() -> None:
    sentence = PROBABLE.replace("2 ticks", "100000 ticks").replace("p the", f"{MANY} the")
    assert "F<=100000" in property_of(sentence)


def test_equivalences_that_would_double_again_and_again_are_refused() -> None:
    chain = "p0"
    for i in range(1, 30):
        chain = f"(p{i} <-> {chain})"
    sentence = f"whenever {chain} the sw shall with probability > 0.9 eventually satisfy q"
    assert refused("prism", sentence).startswith(
        "F670 the property of R1 has more than 100000 operators"
    )
