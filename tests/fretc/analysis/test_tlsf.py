"""Components in TLSF: read back by our own importer, and solved by Spot from their formulas."""

import pytest
import spot

from compiler.logic import printing
from compiler.project.tlsf.specification import ALWAYS, OF_ENVIRONMENT, Specification, read
from fretc.analysis.analysis import AnalysisOptions, analyze
from fretc.analysis.arena.roles import Roles
from fretc.analysis.findings import RealizabilityVerdict
from fretc.analysis.tlsf import LONGEST, specifications
from fretish.diagnostics.source import Source
from tests.command import Fretc, write
from tests.effort import FULL
from tests.requirement_sets import ROLES, assumed, drawn, requirement, requirements, roles

NUMBERS = roles(["t", "a"], ["v", "on"])


def solved(text: str) -> bool:
    """Whether a specification is realizable, as Spot says."""
    found = read(Source("component.tlsf", text))
    assert isinstance(found, Specification), found

    def joint(*, of_environment: bool) -> str:
        parts = [
            f"({'G' if each.section in ALWAYS else ''} ({printing.future(each.formula)}))"
            for each in found.formulas
            if (each.section in OF_ENVIRONMENT) is of_environment
        ]
        return " & ".join(parts) or "1"

    whole = f"({joint(of_environment=True)}) -> ({joint(of_environment=False)})"
    return bool(spot.solve_game(spot.ltl_to_game(whole, [*found.outputs])))


def compared(sentences: tuple[str, ...], given: tuple[str, ...], named: Roles) -> bool:
    """The verdict of a set, which is that of its files."""
    assumptions = [requirement(f"A{number}", each) for number, each in enumerate(given)]
    options = AnalysisOptions(repairs=False)
    found = analyze(requirements(*sentences), named, assumptions, options)
    files, refused = specifications(requirements(*sentences), assumptions, named, 20)
    assert not refused
    assert len(files) == len(found.components)
    for component, file in zip(found.components, files, strict=True):
        is_realizable = component.verdict is RealizabilityVerdict.REALIZABLE
        assert solved(file.text) is is_realizable, (sentences, given, file.text)
    return found.verdict is RealizabilityVerdict.REALIZABLE


@pytest.mark.slow
def test_a_component_has_the_verdict_of_its_file() -> None:
    verdicts = set()
    for seed in range(400 if FULL else 24):
        given = (assumed(("tlsf", seed)),) if seed % 3 == 0 else ()
        if (
            given
            and not spot.translate(
                printing.future(requirement("A0", given[0]).ft_infinite)
            ).is_empty()
        ):
            verdicts.add(compared(drawn(("tlsf", seed)), given, ROLES))
        elif not given:
            verdicts.add(compared(drawn(("tlsf", seed)), (), ROLES))
    assert verdicts == {True, False}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sentences", "verdict"),
    [
        (("whenever t > 3 the sw shall within 2 ticks satisfy v > 5",
          "the sw shall always satisfy on | v < 6"), True),
        (("whenever t > 3 the sw shall immediately satisfy v > 5",
          "the sw shall always satisfy v < t"), False),
        (("the sw shall always satisfy v < t", "upon a the sw shall for 2 ticks satisfy v > 2",
          "whenever t > 4 the sw shall eventually satisfy on"), False),
        (("the sw shall always satisfy v < t",
          "whenever t > 4 the sw shall eventually satisfy v > 2"), True),
    ],
)  # fmt: skip
def test_comparisons_are_propositions_with_the_patterns_of_numbers(
    sentences: tuple[str, ...], verdict: bool
) -> None:
    assert compared(sentences, (), NUMBERS) is verdict


def test_each_component_that_tlsf_cannot_state_is_named() -> None:
    sentences = (
        "the sw shall always satisfy x",
        f"whenever a the sw shall within {LONGEST + 1} ticks satisfy y",
        "the sw shall always satisfy z | preBool(false, z)",
        "the sw shall always satisfy v <= preReal(0.0, v)",
    )
    files, refused = specifications(
        requirements(*sentences), (), roles(["a"], ["x", "y", "z", "v"]), 20
    )
    assert [str(file.path) for file in files] == ["component-1.tlsf"]
    assert [each.message for each in refused] == [
        f"R2 cannot be written as TLSF: R2 lasts {LONGEST + 1} ticks, more than {LONGEST}",
        "R3 cannot be written as TLSF: R3 reads earlier or later ticks by `preBool`",
        "R4 cannot be written as TLSF: of the previous value `preReal(0.0, v)` only the truth of "
        "its comparisons is kept",
    ]


def test_the_command_writes_a_file_that_it_imports_again(fretc: Fretc) -> None:
    write("set/r.fret", "whenever a the sw shall within 1 tick satisfy x\n")
    write("set/bindings.toml", '[variable.a]\nrole = "input"\n[variable.x]\nrole = "output"\n')
    run = fretc("analyze", "set", "--emit", "tlsf", "--emit-to", "out")
    assert run.status == 0, run.err
    run = fretc("analyze", "set", "--emit", "tlsf", "--emit-to", "-", "-o", "a.json")
    assert run.out == (
        'INFO {\n  TITLE:       "r"\n  DESCRIPTION: "A component of a requirement set"\n'
        "  SEMANTICS:   Mealy\n  TARGET:      Mealy\n}\nMAIN {\n  INPUTS {\n    a;\n  }\n"
        "  OUTPUTS {\n    x;\n  }\n  GUARANTEE {\n"
        "    // r: whenever a the sw shall within 1 tick satisfy x\n"
        "    (G (a -> (x || X x)));\n  }\n}\n"
    )
    run = fretc("import", "out/component-1.tlsf", "-o", "again")
    assert run.status == 0, run.err
