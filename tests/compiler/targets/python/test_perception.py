"""What an emitted live node makes of messages is what the audit of the recording says."""

from __future__ import annotations

import ast
import math
from array import array
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals.policies import policy
from compiler.targets.python import monitor, perception
from fretc.logs.signals.signals import sample as audited
from fretc.watch.session import Session
from fretish import expressions as e
from fretish.bindings.declarations import Reduce, path
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from monitors.loading import executed
from tests.effort import examples
from tests.fretc.logs.logs import declare
from tests.fretc.watch.sent import MEMORIES, MS, SENTENCES, START, Sent, Setting, plan_of
from tests.fretc.watch.test_session import audited_rows, recorded
from tests.signal_policies import KINDS, SIGNS, Message, audited_sample, doubles, signals

settings_ = st.builds(
    Setting,
    time=st.sampled_from(["header.stamp", "log_time"]),
    more=st.sampled_from(["", 'phase = "3 ms"']),
    age=st.sampled_from(["", 'max_age = "17 ms"']),
    aggregate=st.sampled_from(["any", "all", "last"]),
    unknown=st.sampled_from(["", "on_unknown = true", "on_unknown = false"]),
    slow=st.sampled_from(
        [
            *("y < 5 and x < 9", "z < 5 for 25 ms", "((x < 5 for 12 ms) or y < 5) for 9 ms"),
            *("v < 9.1 for 12 ms", "w < 11 or v > 10"),
            *MEMORIES,
        ]
    ),
    lateness=st.sampled_from([0, 5, 20]),
)
messages = st.lists(
    st.builds(
        Sent,
        topic=st.sampled_from(["/x", "/x", "/y"]),
        value=st.sampled_from([1.0, 9.0, None]),
        at=st.integers(0, 120),
        delay=st.sampled_from([0, 0, 1, 5, 6, 21, 60]),
    ),
    min_size=1,
    max_size=25,
)


def requirements(bindings: str, sentences: Sequence[str]) -> list[FormalizedRequirement]:
    found = []
    for i, sentence in enumerate(sentences):
        entry = RequirementEntry(f"R{i}", Source("r.fret", sentence).span())
        requirement, wrong = formalize(entry, declare(bindings))
        assert requirement is not None, wrong
        found.append(requirement)
    return found


@cache
def module(setting: Setting) -> tuple[Any, Any]:
    """The two emitted files: what is perceived, and the monitors."""
    found = requirements(setting.bindings, SENTENCES)
    assert [render(no) for each in found if (no := perception.refuse(each)) is not None] == []
    return (
        executed(perception.text(found), "perception"),
        executed(monitor.text(*found), "monitors"),
    )


def judging(setting: Setting, some: Sequence[Sent], idle: int) -> tuple[Any, list[bool | None]]:
    """A node to which the messages have come, and what it said last."""
    live, monitors = module(setting)
    node = live.OnlineEvaluator(monitors.MONITOR, live.SETTING)
    for each in sorted(some, key=lambda each: each.arrival.log_time):
        arrival = each.arrival.log_time
        time = arrival if setting.time == "log_time" else START + each.at * MS
        value = math.nan if each.value is None else each.value
        node.arrive(each.topic, time, arrival, SimpleNamespace(data=value, other=4))
        obligation_pending = list(node.obligation_pending())
    node.pass_to(arrival + idle * MS)
    return node, obligation_pending


@pytest.mark.slow
@examples(12)
@given(settings_, messages, st.sampled_from([0, 3, 40]))
@example(Setting(slow="v < 9.1"), [Sent("/x", 1.0, 0), Sent("/y", 9.0, 5), Sent("/x", 9.0, 20)], 40)
@example(Setting(slow="w < 11"), [Sent("/x", 1.0, 0), Sent("/y", 1.0, 5), Sent("/x", 9.0, 20)], 40)
@example(
    Setting(slow="z < 5 for 25 ms", lateness=0), [Sent("/x", 1.0, 0, 60), Sent("/x", 1.0, 40)], 3
)
def test_every_tick_is_that_of_the_audit(setting: Setting, some: list[Sent], idle: int) -> None:
    node, _ = judging(setting, some, idle)
    session, _, recording = recorded(plan_of(setting), some, idle)
    rows = audited_rows(plan_of(setting), recording)
    live = [(node.ledger.time(i), dict(node.ledger.row(i))) for i in range(len(node.ledger))]
    assert live == rows[: len(live)]
    assert len(rows) - len(live) <= 40
    if session.origin is not None and live:
        assert node.perception.origin == session.origin


@pytest.mark.slow
@examples(12)
@given(settings_, messages)
def test_what_is_pending_on_arrival_is_what_a_watch_says(
    setting: Setting, some: list[Sent]
) -> None:
    _, obligation_pending = judging(setting, some, 0)
    session = Session(plan_of(setting))
    for each in sorted(some, key=lambda each: each.arrival.log_time):
        session.arrive(each.arrival)
    if session.origin is None:
        return
    said = [state.obligation_pending for state in session.states()]
    assert obligation_pending == said


@cache
def live_module() -> Any:
    slow = Setting(slow="y < 5")
    return executed(perception.text(requirements(slow.bindings, SENTENCES[:1])), "perception")


@pytest.mark.slow
@examples(12)
@given(st.data())
def test_a_sample_is_that_of_the_audit(data: st.DataObject) -> None:
    signal = data.draw(signals("a"))
    kind = data.draw(st.sampled_from(["float", "double", "int64", "uint8", "int32"]))
    each = data.draw(st.lists(KINDS[kind], max_size=5) if signal.path.each else KINDS[kind])
    beside = {"least": 0.5, "most": data.draw(st.sampled_from([2.0, 3.0, math.nan]))}
    field = np.array(each, np.asarray(each).dtype) if isinstance(each, list) else each
    if isinstance(each, list):
        field = np.array(each, {"float": np.float32, "double": np.float64}.get(kind, kind))
    expected = audited_sample(signal, Message(field, **beside, at=0))[0]
    try:
        printed = perception._policy(policy(signal))
    except ValueError:
        return
    live = live_module()
    plain = field.tolist()
    found = live.sample(
        eval(printed, vars(live)), SimpleNamespace(field=plain, **beside), kind == "float"
    )
    assert found == expected or (found is None and np.isnan(expected))


truths_of_fields = st.recursive(
    st.builds(
        e.Comparison,
        st.sampled_from(SIGNS),
        st.sampled_from([e.Name("x"), e.Name("least"), e.Name("most")]),
        st.sampled_from([e.Name("x"), e.Name("least"), e.Name("most")]),
    ),
    lambda parts: st.one_of(
        st.builds(e.Not, parts),
        st.tuples(parts, parts).map(e.And),
        st.tuples(parts, parts).map(e.Or),
    ),
    max_leaves=4,
)


@pytest.mark.slow
@examples(12)
@given(
    signals("a"),
    truths_of_fields | st.none(),
    st.sampled_from(["min", "max"]),
    st.lists(doubles.map(float), max_size=6),
    st.tuples(doubles, doubles),
    st.sampled_from([tuple, list, lambda values: array("d", values)]),
    st.booleans(),
)
def test_a_whole_array_at_once_gives_what_its_elements_give(
    signal: Any,
    valid: Any,
    reduce: str,
    values: list[float],
    beside: Any,
    container: Callable[[list[float]], Sequence[float]],
    single: bool,
) -> None:
    whole = replace(
        signal, path=path("/a.field[:]"), reduce=Reduce(reduce), valid=valid, max_age=None
    )
    live = live_module()
    found = eval(perception._policy(policy(whole)), vars(live))
    assert found.quick is not None
    least, most = map(float, beside)
    message = SimpleNamespace(field=container(values), least=least, most=most)
    one = live.sample(found, message, single)
    other = live.sample(found._replace(quick=None), message, single)
    assert (one, type(one)) == (other, type(other))


READINGS = st.sampled_from(["drop", "far", "near", "unknown"])


@pytest.mark.slow
@examples(12)
@given(
    st.lists(st.floats(0, 10, width=32) | st.sampled_from([math.inf, -math.inf, math.nan])),
    st.tuples(READINGS, READINGS, READINGS, READINGS),
    st.floats(-3.2, 3.2),
    st.sampled_from([0.01, 0.5]),
    st.sampled_from(["1", "1/1000", "381/1250"]),
)
def test_a_clearance_of_near_beams_is_that_of_all(
    ranges: list[float], invalid: Any, start: float, step: float, scale: str
) -> None:
    signal = declare(SCAN).signals["clearance"]
    live = live_module()
    found = eval(perception._policy(policy(signal)), vars(live))
    found = found._replace(invalid=invalid, scale=scale)
    scan = {"angle_min": start, "angle_increment": step, "range_min": 0.1, "range_max": 9.0}
    message = SimpleNamespace(ranges=array("f", ranges), **scan)
    assert live.sample(found, message) == live.sample(found._replace(quick=None), message)


@pytest.mark.slow
@examples(12)
@given(
    st.lists(st.floats(0, 10, width=32) | st.sampled_from([math.inf, -math.inf, math.nan])),
    st.floats(-3.2, 3.2),
    st.sampled_from([0.01, 0.5]),
)
def test_a_clearance_is_that_of_the_audit_up_to_rounding(
    ranges: list[float], start: float, step: float
) -> None:
    declared = declare(SCAN)
    signal = declared.signals["clearance"]
    assert signal.reduce is Reduce.OUTLINE
    scan = {"angle_min": start, "angle_increment": step, "range_min": 0.1, "range_max": 9.0}
    expected = audited(
        signal, SimpleNamespace(ranges=np.array(ranges, np.float32), **scan), single=True
    )
    live = live_module()
    found = live.sample(
        eval(perception._policy(policy(signal)), vars(live)),
        SimpleNamespace(ranges=ranges, **scan),
        True,
    )
    if found is None:
        assert math.isnan(expected)
    else:
        assert found == pytest.approx(expected, abs=1e-12)


SCAN = """
[clock]
tick = "100 ms"
[signal.clearance]
path = "/scan.ranges[:]"
reduce = "outline"
footprint = [[0.306, 0.290], [-0.306, 0.290], [-0.1, 0.0], [-0.306, -0.290], [0.306, -0.290]]
sensor = [0.1, 0.0, 0.5]
unit = "m"
valid = "range_min <= x and x <= range_max"
invalid = { nan = "drop", "+inf" = "far", "-inf" = "near", other = "drop", empty = "unknown" }
[proposition.p]
expr = "clearance < 5 cm"
"""


def test_the_text_is_of_python_3_10() -> None:
    found = requirements(Setting(slow="y < 5").bindings, SENTENCES[:1])
    ast.parse(perception.text(found), feature_version=(3, 10))


@pytest.mark.parametrize(
    ("bindings", "why"),
    [
        (Setting(tick='"/x"').bindings, "its clock is each message of /x"),
        (Setting(time="publish_time").bindings, "the time of publication"),
        (Setting().bindings.replace("lateness", "#"), "how long a tick waits"),
        (Setting(slow="y - pre(9, y) < 5").bindings, "looks back by ticks"),
        (Setting().bindings.replace("proposition.near", "proposition.far"), "do not define `near`"),
    ],
)
def test_what_cannot_be_computed_live_is_refused(bindings: str, why: str) -> None:
    subject = requirements(bindings, ["whenever near the r shall immediately satisfy slow"])[0]
    refusal = perception.refuse(subject)
    assert refusal is not None
    assert why in refusal.message + (refusal.help or "")


def test_the_way_out_of_a_comparison_is_a_signal() -> None:
    subject = requirements(Setting().bindings, ["the r shall always satisfy (level + 1 > 2)"])[0]
    refusal = perception.refuse(subject)
    assert refusal is not None
    assert refusal.help == (
        "add `[signal.level]` with its `path` to bindings.toml; "
        "`fretc bind --from LOG` drafts signals"
    )
