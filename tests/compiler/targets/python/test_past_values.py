"""A monitor that is stepped by variables knows the tick before as an audit does."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python.monitor import text
from fretc.logs.signals.samples import Recording, Samples
from fretc.logs.signals.traces import trace
from monitors.kernel.columns import truths
from monitors.loading import load
from tests.bound_requirements import bound_requirement

BINDINGS = """
[clock]
tick = "10 ns"
[signal.x]
path = "/x.data"
unit = "km/h"
[variable.limit]
value = "0.5 m/s"
"""
COMPARISONS = (
    "x - preReal(0, x) <= limit",
    "x mod 3 = preInt(1, x) mod 2",
    "preReal(0.9, x) < 0.9",
    "x = preReal(0.3, preReal(0.7, x))",
    "x > preReal(0.1, 0.9)",
    "x < preReal(0.9 m/s, x)",
    "x ^ 2 - preReal(1, x ^ 2) < 1 - preReal(x, x)^3 / x",
)


@cache
def requirement(comparison: str) -> FormalizedRequirement:
    return bound_requirement(f"the r shall always satisfy {comparison}", BINDINGS)


@cache
def monitor(comparison: str) -> Any:
    return load("monitor", text(requirement(comparison)))


VALUES = st.lists(
    st.sampled_from([0.0, 0.3, 0.7, 0.9, 1.0, 1.8, 2.5, 3.24, float("nan")]), min_size=1, max_size=7
)


@pytest.mark.slow
@given(st.sampled_from(COMPARISONS), VALUES, st.sampled_from([np.float32, np.float64]))
def test_a_step_compares_as_a_tick_of_an_audit(
    comparison: str, values: list[float], kind: type[np.floating[Any]]
) -> None:
    declarations = requirement(comparison).declarations
    assert declarations is not None
    times = np.arange(len(values), dtype=np.int64) * 10
    samples = Samples(times, np.array(values, kind), declarations.signals["x"].scale)
    end, none = int(times[-1]), np.zeros(0, np.int64)
    log = Recording("log", "", 0, 0, end, {"x": samples}, none, (), {}, {}, (), True)
    (name,) = requirement(comparison).watched
    audited = truths(trace(declarations, log, [name]).columns[name], len(values))
    stepped = type(monitor(comparison))()
    broken = False
    for value, expected in zip(samples.values, audited, strict=True):
        stepped.step(x=None if np.isnan(value) else value)
        broken = broken or expected is False
        (status,) = stepped.statuses()
        assert (status.verdict == "violated") is broken
    known = None not in audited
    assert known or broken or status.verdict == "no data"
