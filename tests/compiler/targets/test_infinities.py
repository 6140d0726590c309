"""What an infinite number means, to all that read numbers; written from docs/bindings.md.

In C, Rust and JavaScript, and live, samples are compared with `sample` with every `invalid`, by
`test_signals` of each language and `test_perception`; here `sample` is compared with the page.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.javascript import monitor as javascript
from compiler.targets.python import monitor as python
from fretc.logs.signals.signals import sample
from fretc.logs.stream import SampleStream, StreamEnd
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from monitors.kernel.variable_tables import read_variables
from monitors.kernel.verdicts import Truth
from monitors.loading import load
from tests.each import each
from tests.fretc.logs.logs import declare
from tests.node import needs_node, outcomes

HUGE = 1e308
NUMBERS = (1.0, 9.0, HUGE, -HUGE, math.inf, -math.inf, math.nan)
MEANINGS = ("unknown", "drop", "far", "near")
SENTENCE = "the sw shall always satisfy s < 5 & s > -5 & s * s >= 0 & 1 / s < 2"
DEFAULT = ("unknown",) * 4


@dataclass(frozen=True)
class Bound:
    """A signal: what NaN, both infinities and an invalid number mean, and how an array is one."""

    invalid: tuple[str, str, str, str] = DEFAULT
    reduce: str = ""
    valid: str = ""

    @property
    def text(self) -> str:
        lines = ["[clock]", 'tick = "10 ms"', "[signal.s]"]
        lines += [f'path = "/r.{"values[:]" if self.reduce else "value"}"']
        lines += [f'reduce = "{self.reduce}"'] if self.reduce else []
        lines += [f'valid = "{self.valid}"'] if self.valid else []
        if self.invalid != DEFAULT:
            keys = ("nan", '"+inf"', '"-inf"', "other")
            named = [f'{key} = "{word}"' for key, word in zip(keys, self.invalid, strict=True)]
            lines += [f"invalid = {{ {', '.join(named)} }}"]
        return "\n".join([*lines, '[proposition.low]\nexpr = "s < 5"'])

    def takes(self, value: float) -> bool:
        """Whether it is a number, and a valid one."""
        return math.isfinite(value) and not (self.valid and value >= 100)

    def meant(self, values: Sequence[float]) -> float | None:
        """The number of a message; None: unknown."""
        found = []
        for value in values:
            kind = 0 if math.isnan(value) else 1 if value == math.inf else 2
            kind = 3 if math.isfinite(value) else kind
            if self.takes(value):
                found.append(value)
            elif self.invalid[kind] == "unknown":
                return None
            elif self.invalid[kind] != "drop":
                found.append(math.inf if self.invalid[kind] == "far" else -math.inf)
        return self._reduced(found) if found else None

    def _reduced(self, found: list[float]) -> float | None:
        if self.reduce != "mean":
            return max(found) if self.reduce == "max" else min(found)
        infinite = {value for value in found if math.isinf(value)}
        if infinite:
            return infinite.pop() if len(infinite) == 1 else None
        return float(sum(map(Fraction, found)) / len(found))


def rule_of(bound: Bound) -> FormalizedRequirement:
    source = Source("r.fret", SENTENCE)
    found, wrong = formalize(RequirementEntry("R1", source.span()), declare(bound.text))
    assert found is not None, wrong
    return found


@cache
def monitor_of(bound: Bound) -> Any:
    return load("r1_monitor", python.text(rule_of(bound)))


def expected(value: float | None) -> tuple[Truth, ...]:
    """The truth of each comparison of the sentence."""
    if value is None:
        return (None,) * 4
    return value < 5, value > -5, True, 1 / value < 2 if value else None


def streamed(bound: Bound, message: Mapping[str, object]) -> Truth:
    stream = SampleStream(declare(bound.text), ["low"])
    assert stream.message("/r", 10**9, message) is None
    found = stream.end()
    assert isinstance(found, StreamEnd)
    return found.ticks[0].truth["low"]


bounds = st.builds(
    Bound,
    st.tuples(*(st.sampled_from(MEANINGS) for _ in range(4))) | st.just(DEFAULT),
    st.sampled_from(["", "min", "max", "mean"]),
    st.sampled_from(["", "x < 100"]),
)


@pytest.mark.slow
@example(Bound(), [math.inf])
@example(Bound(reduce="mean"), [HUGE, HUGE])
@example(Bound(reduce="mean"), [1, HUGE, -HUGE])
@given(bounds, st.lists(st.sampled_from(NUMBERS), min_size=1, max_size=3))
def test_a_reading_means_the_same_in_a_log_a_watch_and_a_monitor(
    bound: Bound, values: list[float]
) -> None:
    values = values if bound.reduce else values[:1]
    value = bound.meant(values)
    signal = declare(bound.text).signals["s"]
    message = SimpleNamespace(values=np.array(values), value=values[0])
    in_log = sample(signal, message)
    if value is None:
        assert math.isnan(in_log)
    elif bound.reduce == "mean" and math.isfinite(value):
        size = max(abs(x) for x in values if bound.takes(x))
        assert in_log == pytest.approx(value, rel=1e-15, abs=1e-15 * size)  # it is rounded
        value = in_log
    else:
        assert in_log == value
    low = None if value is None else value < 5
    assert streamed(bound, {"values": values, "value": values[0]}) is low
    monitor = monitor_of(bound)
    for given_value in (value, np.float64(math.nan if value is None else value)):
        assert monitor.truths(given_value) == expected(value)
    for text in tables(value):
        (row,) = read_variables(text, monitor.VARIABLES, "t")
        assert monitor.truths(*row) == expected(value)


def tables(value: float | None) -> Iterator[list[str]]:
    """As CSV and as JSON."""
    yield ["s,tick", f"{'' if value is None else repr(value)},0"]
    yield [json.dumps({"s": value})]


RAW = [10**400, -(10**400), math.inf, -math.inf, math.nan, np.float32(math.inf), None]


@each("value", RAW)
def test_a_number_that_no_float_holds_is_unknown_where_nothing_says_what_it_means(
    value: Any,
) -> None:
    """Unknown is never satisfied: each comparison is unknown."""
    assert monitor_of(Bound()).truths(value) == (None,) * 4
    beyond = ["s", "1e999"], ["s", f"-{'9' * 400}"], ['{"s": -1e999}']
    for text in beyond:
        (row,) = read_variables(text, monitor_of(Bound()).VARIABLES, "t")
        assert monitor_of(Bound()).truths(*row) == (None,) * 4


@pytest.mark.slow
@needs_node
def test_in_javascript_they_mean_the_same(tmp_path: Path) -> None:
    bounds_ = [
        Bound(),
        Bound(("far", "far", "near", "drop")),
        Bound(("drop", "far", "drop", "far")),
    ]
    texts = [javascript.text(rule_of(bound)) for bound in bounds_]
    values = [*NUMBERS, None]
    written = [value if value is None else {"float": _in_js(value)} for value in values]
    words = [(place, [[value]]) for place in range(len(texts)) for value in written]
    told = outcomes(tmp_path, texts, words, by="truths")
    found = [tuple(rows[0]) for rows in told]
    assert found == [monitor_of(b).truths(value) for b in bounds_ for value in values]


def _in_js(value: float) -> str:
    names = {math.inf: "Infinity", -math.inf: "-Infinity"}
    return "NaN" if math.isnan(value) else names.get(value, repr(value))
