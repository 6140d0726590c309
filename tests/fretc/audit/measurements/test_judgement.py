"""What the end of a log takes back of a verdict."""

import pytest

from compiler.formalization.formalize import formalize
from compiler.targets.python.monitor import text
from fretc.audit.measurements.judgement import Engine, judge
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from monitors import kernel
from monitors.kernel import Monitor
from monitors.kernel.columns import column
from monitors.loading import load
from tests.fretc.logs.logs import declare

BINDINGS = """
[clock]
tick = "1 s"
[signal.x]
path = "/x.data"
[proposition.p]
expr = "x < 5"
[proposition.q]
expr = "x > 7"
"""
F, T, U = 0, 1, 2
"""Codes of false, true and unknown in columns."""
TRUTHS = (False, True, None)


def monitor(sentence: str) -> Monitor:
    ((entry,), _) = requirements(Source("R1.fret", sentence))
    requirement, diagnostics = formalize(entry, declare(BINDINGS))
    assert requirement is not None, diagnostics
    return load("monitor", text(requirement))


@pytest.mark.slow
@pytest.mark.parametrize("engine", [kernel.evaluate, kernel.stepped])
@pytest.mark.parametrize(
    ("last", "cut", "expected"),
    [
        ((F, T), (F, T), "satisfied"),
        ((F, T), (T, T), "satisfied"),
        ((F, T), (T, F), "inconclusive"),
        ((T, F), (T, F), "satisfied"),
        ((U, F), (F, F), "satisfied"),
        ((U, F), (U, F), "inconclusive"),  # false and then true would be a trigger without answer
        ((U, U), (U, U), "inconclusive"),
        ((U, T), (U, T), "satisfied"),
    ],
)
def test_a_cut_tick_counts_as_unchanged_only_where_all_of_it_is_known(
    engine: Engine, last: tuple[int, int], cut: tuple[int, int], expected: str
) -> None:
    watching = monitor("when p the r shall immediately satisfy q")
    columns = {"p": column(bytes([T, last[0]])), "q": column(bytes([T, last[1]]))}
    (judgement,) = judge(
        watching,
        columns,
        {"p": TRUTHS[cut[0]], "q": TRUTHS[cut[1]]},
        2,
        intact=True,
        end=kernel.INCONCLUSIVE,
        engine=engine,
    )
    assert judgement.verdict == expected
