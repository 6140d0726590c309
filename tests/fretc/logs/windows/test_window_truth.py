"""A stream that evaluates its windows in lists has the ticks of one that uses arrays alone."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.messages.python_messages import Value
from fretc.logs.stream import SampleStream
from fretish.bindings.declarations import Declarations
from monitors.kernel.verdicts import Truth
from tests.effort import examples
from tests.fretc.logs.logs import declare

NAN = float("nan")
BINDINGS = """
[clock]
tick = "10 ns"
time = "header.stamp"
lateness = "{lateness} ns"
[signal.x]
path = "/x.data"
unit = "cm"
{age}
[signal.y]
path = "/y.data"
unit = "m"
{age}
[signal.z]
path = "/x.other"
[signal.mode]
path = "/m.data"
values = ["idle", "docking"]
[proposition.near]
expr = "x < 5 cm"
agg = "{aggregate}"
[proposition.same]
expr = "x < y or z >= 3"
agg = "any"
on_unknown = true
[proposition.held]
expr = "((x < 5 cm for 12 ns) or y < 5 m) for 9 ns"
agg = "{aggregate}"
[proposition.late]
expr = "not (abs(y - x) <= 3 m for 31 ns)"
agg = "all"
[proposition.docks]
expr = "mode = docking"
[proposition.before]
expr = "x - pre(9 cm, x) <= 0 cm"
[proposition.always]
expr = "(x < 5 cm or x >= 5 cm or true) for 25 ns"
"""
KINDS: list[np.dtype[Any]] = [np.dtype(each) for each in ("f4", "f8", np.longdouble)]
SINGLE, DOUBLE, EXACT = KINDS


@dataclass(frozen=True)
class Step:
    """A message, or a gap, and how much later it was received than its time, in nanoseconds."""

    topic: str
    after: int
    """Nanoseconds since the step before."""
    delay: int
    values: tuple[float, float]
    kind: np.dtype[Any]


steps = st.builds(
    Step,
    st.sampled_from(["/x", "/x", "/y", "/y", "/m", "gap"]),
    st.sampled_from([0, 1, 3, 6, 10, 25]),
    st.sampled_from([0, 0, 0, 2, 5, 9, 30]),
    st.tuples(*[st.sampled_from([1.0, 4.0, 7.0, 0.0, NAN])] * 2),
    st.sampled_from([DOUBLE] * 9 + [SINGLE] * 9 + [EXACT]),
)


def values(step: Step) -> dict[str, Value]:
    def value(number: float, kind: np.dtype[Any] = step.kind) -> Value:
        return number, None if isnan(number) else kind, ""

    match step.topic:
        case "/x":
            return {"x": value(step.values[0]), "z": value(step.values[1], DOUBLE)}
        case "/y":
            return {"y": value(step.values[0])}
        case _:
            return {"mode": value(min(step.values[0], 1.0), DOUBLE)}


class InArrays(SampleStream):
    """A stream that leaves everything to arrays."""

    def _truth_in_lists(self, times: Sequence[int]) -> dict[str, list[Truth]]:
        return {}


class Counted(SampleStream):
    """A stream that counts the truth values that come from lists."""

    count = 0

    def _truth_in_lists(self, times: Sequence[int]) -> dict[str, list[Truth]]:
        found = super()._truth_in_lists(times)
        self.count += len(found)
        return found


BEGIN = [Step(topic, 0, 0, (1.0, 4.0), DOUBLE) for topic in ("/m", "/x", "/y")]
"""The first messages of all topics, after which ticks can be placed."""


def told(stream: SampleStream, some: Sequence[Step], lateness: int) -> list[object]:
    """All that a stream says, after each step."""
    found: list[object] = []
    received = 1000
    for step in [*BEGIN, *some]:
        received += step.after
        time = received - step.delay
        if step.topic == "gap":
            found.append(stream.miss(time - 4, time))
        else:
            found.append(stream.arrive(step.topic, time, received, values(step)))
        found.append(stream.peek(received))
        found.append(stream.until(received - lateness))
    return [*found, stream.end(), stream.late, stream.findings]


def declared(lateness: int, age: str, aggregate: str) -> Declarations:
    return declare(BINDINGS.format(lateness=lateness, age=age, aggregate=aggregate))


@pytest.mark.slow
@given(
    st.lists(steps, min_size=8, max_size=40),
    st.sampled_from([0, 5, 40]),
    st.sampled_from(["", 'max_age = "7 ns"', 'max_age = "25 ns"']),
    st.sampled_from(["any", "all", "last"]),
)
@examples(30)
def test_the_ticks_are_those_of_arrays(
    some: list[Step], lateness: int, age: str, aggregate: str
) -> None:
    of = declared(lateness, age, aggregate)
    lists, arrays = (each(of, list(of.propositions)) for each in (SampleStream, InArrays))
    assert told(lists, some, lateness) == told(arrays, some, lateness)


def test_all_but_past_ticks_are_evaluated_in_lists() -> None:
    of = declared(0, 'max_age = "25 ns"', "any")
    some = [Step("/x" if i % 2 else "/y", 3, 0, (i % 7, 4.0), DOUBLE) for i in range(20)]
    stream = Counted(of, list(of.propositions))
    told(stream, some, 0)
    assert stream.count >= 10 * (len(of.propositions) - 1)
