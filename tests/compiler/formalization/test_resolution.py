"""The propositions that sentences state by signals."""

import pytest

from compiler.formalization.formalize import formalize
from fretish.bindings.declarations import Aggregate
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from fretish.printer import expression

BINDINGS = """\
[clock]
tick = "100 ms"
[signal.x]
path = "/a.x"
agg = "any"
[signal.y]
path = "/a.y"
agg = "any"
[signal.z]
path = "/a.z"
[signal.mode]
path = "/m.data"
values = ["drive", "dock"]
agg = "all"
[proposition.z]
expr = "z > 1"
"""


def stated(response: str) -> dict[str, tuple[str, Aggregate]] | list[Diagnostic]:
    """The propositions that a sentence adds to the bindings, or its mistakes."""
    declared, mistakes = read_bindings(Source("bindings.toml", BINDINGS))
    assert declared is not None, mistakes
    ((entry,), _) = requirements(Source("r.fret", f"the agv shall always satisfy {response}"))
    requirement, remarks = formalize(entry, declared)
    if requirement is None:
        return [*remarks]
    assert requirement.declarations is not None
    own = requirement.declarations.propositions
    return {
        name: (expression(own[name].expression), own[name].aggregate)
        for name in own
        if name not in declared.propositions
    }


@pytest.mark.parametrize(
    ("response", "expected"),
    [
        ("x < 1", {"(x < 1)": ("x < 1", Aggregate.ANY)}),
        ("x < y", {"(x < y)": ("x < y", Aggregate.ANY)}),
        ("z < 1", {"(z < 1)": ("z < 1", Aggregate.LAST)}),
        ("mode = dock", {'(mode = dock)': ('"mode" = dock', Aggregate.ALL)}),
        ("z", {}),
        ("x", {"x": ("x", Aggregate.ANY)}),
    ],
)  # fmt: skip
def test_a_comparison_takes_the_samples_of_a_tick_as_its_signals_declare(
    response: str, expected: dict[str, tuple[str, Aggregate]]
) -> None:
    assert stated(response) == expected


@pytest.mark.parametrize("response", ["x < z", "preReal(0, x) < 1", "x + z < 1"])
def test_signals_that_combine_otherwise_are_not_compared(response: str) -> None:
    result = stated(response)
    assert isinstance(result, list)
    assert [each.code for each in result] == [Code.SEVERAL_AGGREGATES]
