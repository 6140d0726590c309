"""What each trigger asks for, against the meaning written down directly."""

from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.explanation.windows import (
    Expectation,
    ObligationWindow,
    TickRange,
    intervals,
    is_satisfied,
    window,
)
from compiler.formalization.reference import Template as Counted
from compiler.formalization.reference import template as counted_of
from fretish import syntax as s
from fretish.diagnostics.source import Source
from fretish.parser import parse
from tests import meaning
from tests.strategies import Template, few_templates, templates, traces


def counted(drawn: Template) -> Counted:
    sentence = parse(Source("r.fret", drawn.sentence).span())
    assert isinstance(sentence, s.Sentence)
    return counted_of(sentence, drawn.n)


@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_the_intervals_are_those_of_the_definition(scope: str) -> None:
    kind = None if scope == "null" else s.ScopeKind(scope)
    for length in range(1, 8):
        for m in product((False, True), repeat=length):
            assert intervals(kind, m) == list(meaning.intervals(scope, m))


@pytest.mark.slow
def test_every_short_trace_is_judged_as_fretish_means_it() -> None:
    for drawn in few_templates((0, 1, 2)):
        requirement, names = counted(drawn), drawn.columns
        for length in range(1, 4 if len(names) < 4 else 3):
            for values in product((False, True), repeat=len(names) * length):
                columns = {n: list(values[i :: len(names)]) for i, n in enumerate(names)}
                m, p, q, stop = (columns.get(name, columns["q"]) for name in "mpqs")
                assert is_satisfied(requirement, m, p, q, stop) is drawn.satisfied(columns), (
                    drawn,
                    columns,
                )


@given(st.sampled_from([*templates((0, 1, 2, 3, 5))]), traces("m", "p", "q", "s", max_size=14))
def test_long_traces_are_judged_as_fretish_means_them(
    drawn: Template, rows: list[dict[str, bool]]
) -> None:
    columns = {name: [row[name] for row in rows] for name in "mpqs"}
    expected = drawn.satisfied(columns)
    assert is_satisfied(counted(drawn), *(columns[name] for name in "mpqs")) is expected


def test_after_asks_twice() -> None:
    requirement = Counted(None, s.ConditionKind.HOLDING, s.After, 2)
    parts = (TickRange(1, 3, Expectation.NONE), TickRange(4, 4, Expectation.ALL))
    assert window(requirement, 1, 9, [False] * 10) == ObligationWindow(1, 9, parts)
