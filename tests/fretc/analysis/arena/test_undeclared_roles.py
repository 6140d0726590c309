"""Verdicts about variables without a role hold for each role, and for each definition."""

import pytest

from fretc.analysis.arena.budget import Budget
from fretc.analysis.findings import RealizabilityVerdict
from fretc.analysis.realizability_problem import stage
from fretc.analysis.verdicts import verdict
from tests.command import Fretc, write
from tests.effort import FULL
from tests.requirement_sets import ROLES, drawn, requirements, synthesized

REALIZABLE = RealizabilityVerdict.REALIZABLE
UNREALIZABLE = RealizabilityVerdict.UNREALIZABLE


@pytest.mark.slow
def test_a_verdict_without_a_role_is_that_of_both_roles() -> None:
    known = {name: role for name, role in ROLES.items() if name != "x"}
    verdicts = set()
    for seed in range(600 if FULL else 40):
        sentences = drawn(("role", seed))
        found, _ = verdict(stage(requirements(*sentences), (), known), Budget(60))
        by_system, by_environment = (
            synthesized(requirements(*sentences), outputs=outputs) for outputs in ("xy", "y")
        )
        if not any("x" in each.variables for each in requirements(*sentences)):
            continue
        expected = RealizabilityVerdict.NOT_CHECKED
        if by_system is by_environment:
            expected = REALIZABLE if by_system else UNREALIZABLE
        assert found.verdict is expected, sentences
        verdicts.add(found.verdict)
    assert verdicts == {*RealizabilityVerdict}


BINDINGS = """\
[variable.a]
role = "input"
[variable.on]
role = "output"
[variable.other]
role = "output"
[variable.level]
role = "internal"
type = "double"
fret = {{ assignment = "{}" }}
"""


@pytest.mark.parametrize(
    ("assignment", "sentence", "why"),
    [
        ("if a then 1.0 else 2.0", "whenever level > 1 the sw shall immediately satisfy on",
         "the system has a strategy, whatever `level` is"),
        ("if on then 1.0 else 2.0", "whenever level > 1 the sw shall immediately satisfy on",
         "r: `level` has no single role"),
        ("if a then 1.0 else 2.0", "the sw shall always satisfy level > 1",
         "r: `level` has no single role"),
        ("if on then 1.0 else 2.0",
         "the sw shall always satisfy on & (level > 2 | !on) & level < 1",
         "the environment wins, whatever `level` is"),
    ],
)  # fmt: skip
def test_a_definition_that_is_not_read_may_be_any(
    fretc: Fretc, assignment: str, sentence: str, why: str
) -> None:
    """The system must not know what depends on its own outputs of the same tick."""
    write("set/r.fret", f"{sentence}\n")
    write("set/s.fret", "whenever a the sw shall immediately satisfy other\n")
    write("set/bindings.toml", BINDINGS.format(assignment))
    run = fretc("analyze", "set", "-o", "a.json")
    assert "F354 `level` has no role" in run.err
    assert f": {why}\n" in run.out
    assert run.status == 2, "one role is missing"
