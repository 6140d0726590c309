"""What a stream tells at each tick is what an audit of the same samples computes."""

from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fretc.logs.mcap.damage import LATEST
from fretc.logs.signals.samples import Recording, Samples, Topic
from fretc.logs.signals.traces import Trace, trace
from fretc.logs.stream import ClockTick, SampleStream, StreamEnd, lookback
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Code, Diagnostic
from monitors.kernel.columns import truths
from monitors.kernel.verdicts import Truth
from tests.fretc.logs.logs import declare

NAN = float("nan")
PATHS = {"x": "/x.data", "y": "/y.data", "z": "/y.other"}
EXPRESSIONS = (
    "x < 5",
    "x < 5 and y < 5",
    "x < y or z < 3",
    "x < 5 for 15 ns",
    "((x < 5 for 12 ns) or y < 5) for 9 ns",
    "(y < 5 for 30 ns) and not (x < 5 for 4 ns)",
    "x = 7",
)
PAST = (
    "x - pre(9, x) <= 0",
    "pre(1, pre(9, x)) < 5 and y < 5",
    "x < pre(y, pre(y, x)) or (y < 5 for 12 ns)",
    "x < pre(4, pre(4, pre(4, z)))",
)
"""Those that look back by ticks."""


@dataclass(frozen=True)
class Sample:
    signal: str
    time: int
    value: float


def bindings(
    expression: str,
    aggregate: str = "last",
    age: int | None = None,
    unknown: str = '"unknown"',
    phase: int = 0,
    clock: str = 'tick = "10 ns"',
) -> Declarations:
    lines = ["[clock]", clock, f'phase = "{phase} ns"' if phase else ""]
    for name, path in PATHS.items():
        lines += [f"[signal.{name}]", f'path = "{path}"']
        lines += [f'max_age = "{age} ns"'] if age is not None else []
    lines += ["[proposition.p]", f'expr = "{expression}"', f'agg = "{aggregate}"']
    lines += [f"on_unknown = {unknown}"]
    found = declare("\n".join(lines))
    return found.restricted_to(["p"])


def batch(
    declarations: Declarations, samples: Sequence[Sample], end: int, clock: Iterable[int] = ()
) -> Trace:
    """The same as one recording, in the order of the file."""
    columns, topics = {}, {}
    for name, signal in declarations.signals.items():
        own = sorted((s for s in samples if s.signal == name), key=lambda s: s.time)
        times = np.array([s.time for s in own], np.int64)
        columns[name] = Samples(times, np.array([s.value for s in own], float), signal.scale)
    for signal in declarations.signals.values():
        topic = signal.path.topic
        alike = {n for n, s in declarations.signals.items() if s.path.topic == topic}
        begins = [s.time for s in samples if s.signal in alike]
        if begins:
            topics[topic] = Topic(topic, "", "", 1, min(begins), None, None, None, None)
    known = [s.time for s in samples if s.signal in declarations.signals]
    start = min([*known, *clock])
    ticks = np.array(sorted(clock), np.int64)
    last = max([end, *known, *clock])
    recording = Recording("log", "", 0, start, last, columns, ticks, (), topics, {}, (), True)
    return trace(declarations, recording, ["p"])


def rows(found: Trace) -> list[tuple[int, Truth]]:
    times = found.timeline.times.tolist()
    return list(zip(times, truths(found.columns["p"], len(times)), strict=True))


def ticks(found: tuple[ClockTick, ...] | Diagnostic) -> list[tuple[int, Truth]]:
    assert not isinstance(found, Diagnostic), found
    return [(tick.time, tick.truth["p"]) for tick in found]


def ended(stream: SampleStream) -> StreamEnd:
    found = stream.end()
    assert isinstance(found, StreamEnd), found
    return found


VALUES = st.sampled_from([1.0, 4.0, 7.0, 9.0, NAN])
SAMPLES = st.lists(
    st.builds(Sample, st.sampled_from(list(PATHS)), st.integers(1, 160), VALUES), min_size=1
)
CUTS = st.lists(st.integers(0, 170), max_size=12)


@st.composite
def declared(
    draw: st.DrawFn, clock: str = 'tick = "10 ns"', expressions: Sequence[str] = EXPRESSIONS
) -> Declarations:
    expression = draw(st.sampled_from(expressions))
    return bindings(
        expression,
        draw(st.sampled_from(["last"] if "pre" in expression else ["any", "all", "last"])),
        draw(st.sampled_from([None, 1, 7, 25])),
        draw(st.sampled_from(['"unknown"', "true", "false"])),
        draw(st.sampled_from([0, 0, 3, 9])) if "ns" in clock else 0,
        clock,
    )


def streamed(
    declarations: Declarations, messages: Sequence[tuple[str, Sample]], cuts: Sequence[int]
) -> tuple[list[tuple[int, Truth]], StreamEnd]:
    """All ticks, where each message comes before time has passed it, and in no other order."""
    stream, found, left = SampleStream(declarations, ["p"]), [], list(messages)
    for cut in [*sorted(cuts), LATEST]:
        for topic, sample in left:
            if sample.time < cut:
                wrong = (
                    stream.message(topic, sample.time, {"data": sample.value})
                    if topic
                    else stream.add(sample.signal, sample.time, sample.value)
                )
                assert wrong is None
        left = [each for each in left if each[1].time >= cut]
        if cut != LATEST:
            found += ticks(stream.until(cut))
    end = ended(stream)
    return found + ticks(end.ticks), end


@pytest.mark.slow
@given(declared(expressions=(*EXPRESSIONS, *PAST)), SAMPLES, CUTS)
@example(bindings("x < 5 for 15 ns", "any"), [Sample("x", 1, 1.0), Sample("x", 25, 9.0)], [22, 60])
@example(bindings("x < 5"), [Sample("x", 1, 1.0), Sample("x", 11, 9.0)], [11])
@example(bindings("x < 5", "any", phase=9), [Sample("x", 1, 1.0), Sample("x", 5, 9.0)], [20])
def test_ticks_are_those_of_the_whole_log_however_time_passes(
    declarations: Declarations, samples: list[Sample], cuts: list[int]
) -> None:
    known = [sample for sample in samples if sample.signal in declarations.signals]
    found, end = streamed(declarations, [("", sample) for sample in known], cuts)
    if not known:
        assert not found
        return
    whole = batch(declarations, known, max(cuts, default=0))
    assert (found, end.cut) == (rows(whole), whole.cut)


@pytest.mark.slow
@given(
    declared('tick = "/clock"', [e for e in (*EXPRESSIONS, *PAST) if "z" not in e]),
    SAMPLES,
    CUTS,
    st.lists(st.integers(1, 160), min_size=1),
)
def test_a_clock_of_messages_ticks_with_each_of_them(
    declarations: Declarations, samples: list[Sample], cuts: list[int], clock: list[int]
) -> None:
    known = [sample for sample in samples if sample.signal in declarations.signals]
    messages = [(f"/{sample.signal}", sample) for sample in known]
    messages += [("/clock", Sample("", time, 0.0)) for time in clock]
    found, end = streamed(declarations, messages, cuts)
    whole = batch(declarations, known, max(cuts, default=0), clock)
    assert (found, end.cut) == (rows(whole), whole.cut)


def code(found: object) -> Code | None:
    return found.code if isinstance(found, Diagnostic) else None


def test_what_comes_late_is_refused_and_changes_nothing() -> None:
    stream = SampleStream(bindings("x < 5"), ["p"])
    assert stream.add("x", 30, 9.0) is None
    assert ticks(stream.until(31)) == [(30, False)]
    assert code(stream.add("x", 30, 1.0)) is Code.OUT_OF_ORDER
    assert stream.add("x", 31, 1.0) is None
    assert ticks(stream.until(51)) == [(40, True), (50, True)]


def test_time_does_not_go_back() -> None:
    stream = SampleStream(bindings("x < 5"), ["p"])
    stream.add("x", 30, 9.0)
    stream.until(45)
    assert ticks(stream.until(10)) == []
    assert code(stream.add("x", 44, 1.0)) is Code.OUT_OF_ORDER


@pytest.mark.parametrize(
    ("time", "why"), [(0, Code.ZERO_STAMP), (-1, Code.BAD_MESSAGE), (2**62, Code.BAD_MESSAGE)]
)
def test_a_time_that_no_clock_tells_is_refused(time: int, why: Code) -> None:
    assert code(SampleStream(bindings("x < 5"), ["p"]).add("x", time, 1.0)) is why


def test_no_tick_is_given_while_a_topic_that_is_missing_may_move_the_first_one() -> None:
    stream = SampleStream(three(), ["p"])
    stream.add("x", 1, 1.0)
    stream.add("y", 4, 1.0)
    assert ticks(stream.until(60)) == []
    assert stream.waiting == ("/w",)
    stream.add("w", 61, 1.0)
    assert [time for time, _ in ticks(stream.until(62))] == [1, 11, 21, 31, 41, 51, 61]
    assert not stream.waiting


def test_the_end_places_the_first_tick() -> None:
    stream = SampleStream(three(), ["p"])
    stream.add("x", 1, 1.0)
    stream.add("y", 4, 1.0)
    stream.until(20)
    assert [tick.time for tick in ended(stream).ticks] == [4, 14]


def three() -> Declarations:
    return declare(
        '[clock]\ntick = "10 ns"\n'
        + "".join(f'[signal.{name}]\npath = "/{name}.data"\n' for name in "xyw")
        + '[proposition.p]\nexpr = "x < 5 and y < 5 and w < 5"\n'
    )


def test_nothing_follows_the_end() -> None:
    stream = SampleStream(bindings("x < 5"), ["p"])
    stream.add("x", 1, 1.0)
    ended(stream)
    calls = (stream.end(), stream.until(5), stream.add("x", 9, 1.0))
    assert [code(found) for found in calls] == [Code.BAD_USAGE] * 3


def test_a_million_ticks_at_once_are_a_wrong_unit_of_time() -> None:
    stream = SampleStream(bindings("x < 5"), ["p"])
    stream.add("x", 1, 1.0)
    assert code(stream.until(10**9)) is Code.TOO_LARGE
    assert ticks(stream.until(2)) == [(1, True)]


def test_a_sample_keeps_to_the_kind_of_number_that_ticks_have_seen() -> None:
    """0.9 as a 32-bit float is 0.9, and is below it as a 64-bit float."""
    declarations = bindings("x < 0.9")
    stream = SampleStream(declarations, ["p"])
    stream.add("x", 1, np.float32(0.9))
    assert ticks(stream.until(2)) == [(1, False)]
    assert code(stream.add("x", 2, 0.5)) is Code.SEVERAL_TYPES
    assert stream.add("x", 2, None) is None
    other = SampleStream(declarations, ["p"])
    other.add("x", 1, np.float32(0.9))
    other.add("x", 2, 0.5)
    assert ticks(other.until(2)) == [(1, True)]


def test_whole_numbers_beyond_floats_are_compared_exactly() -> None:
    stream = SampleStream(bindings(f"x = {2**60 + 1}"), ["p"])
    stream.add("x", 1, 2**60 + 1)
    stream.add("x", 2, 2**60)
    found = ticks(stream.until(2))
    assert found + ticks(ended(stream).ticks) == [(1, True)]


class Rclpy:
    """A message as rclpy generates it: its slots are not the names of its fields."""

    __slots__ = ("_data",)

    def __init__(self, data: object) -> None:
        self._data = data

    @property
    def data(self) -> object:
        return self._data

    def get_fields_and_field_types(self) -> dict[str, str]:
        return {"data": "float"}


NESTED = '[clock]\ntick = "10 ns"\n[signal.a]\npath = "/t.m.data"\n[signal.b]\npath = "/t.n[1]"\n'


@pytest.mark.parametrize(
    "message",
    [
        {"m": {"data": 3}, "n": [0, 1]},
        {"m": Rclpy(3.0), "n": array("f", [0, 1])},
        SimpleNamespace(m=SimpleNamespace(data=np.float64(3)), n=np.array([0, 1])),
    ],
    ids=["mapping", "rclpy", "attributes"],
)
def test_messages_are_mappings_or_objects(message: object) -> None:
    stream = SampleStream(declare(f'{NESTED}[proposition.p]\nexpr = "a = 3 and b = 1"\n'), ["p"])
    assert stream.message("/t", 1, message) is None
    assert stream.message("/other", 1, message) is None
    assert ticks(stream.until(2)) == [(1, True)]


def test_a_message_without_a_field_gives_none_of_its_samples() -> None:
    stream = SampleStream(declare(f'{NESTED}[proposition.p]\nexpr = "a = 3 or b = 1"\n'), ["p"])
    found = stream.message("/t", 1, {"m": {"data": 3}, "nn": [0, 1]})
    assert isinstance(found, Diagnostic)
    assert (found.code, found.help) == (Code.NO_FIELD, "did you mean `nn`?")
    assert ticks(stream.until(50)) == []


def test_a_clock_of_messages_needs_messages() -> None:
    stream = SampleStream(bindings("x < 5", clock='tick = "/x"'), ["p"])
    assert code(stream.add("x", 1, 1.0)) is Code.MESSAGE_CLOCK


def test_lookback_adds_up_what_is_within_each_other() -> None:
    expressions = [bindings(text).propositions["p"].expression for text in EXPRESSIONS]
    assert [lookback(expression) for expression in expressions] == [0, 0, 0, 15, 21, 30, 0]


def test_memory_does_not_grow_with_time() -> None:
    stream = SampleStream(bindings("((x < 5 for 12 ns) or y < 5) for 9 ns"), ["p"])
    for time in range(1, 500):
        stream.add("x", time, 1.0)
        stream.add("y", time, 1.0)
        stream.until(time)
    assert max(len(queue.times) for queue in stream._queues.values()) < 50
