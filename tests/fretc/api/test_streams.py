"""A stream judges as an audit of the same samples does."""

from math import inf
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_ros2.decoder import DecoderFactory

import fretc
from fretc.audit.one_log import audit
from fretc.audit.plan import Plan, monitored_requirements, planned
from fretc.logs.signals.samples import Recording, Samples, Topic
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.rendering import render
from tests.effort import FULL, some

ROOT = Path(__file__).parent.parent.parent.parent
SENTENCES = (
    "whenever p r shall within 2 ticks satisfy q",
    "whenever p r shall eventually satisfy q",
    "r shall always satisfy q",
    "upon p r shall for 2 ticks satisfy q",
    "whenever p r shall immediately satisfy x - preReal(2, x) <= limit | falling",
    "r shall always satisfy (x + 1) mod 3 < 2 & x ^ 2 <= 16",
    "whenever p r shall within 1 tick satisfy wave < 7 & (wave > preReal(1, wave) | root > 1)",
)
BINDINGS = """
[clock]
tick = "10 ns"
end = "{end}"
[signal.x]
path = "/x.data"
max_age = "25 ns"
[signal.wave]
value = "norm(3, 2 * x) + sin(x * 1 rad)"
[signal.root]
value = "sqrt(x - 2)"
[variable.limit]
value = "2"
[variable.falling]
value = "x < preInt(1, preInt(4, x))"
[proposition.p]
expr = "x < 3"
agg = "any"
[proposition.q]
expr = "x > 1"
"""


@pytest.fixture(scope="module", params=["inconclusive", "violated"])
def project(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> object:
    folder = tmp_path_factory.mktemp("project")
    for number, sentence in enumerate(SENTENCES, 1):
        (folder / f"r{number}.fret").write_text(sentence)
    (folder / "bindings.toml").write_text(BINDINGS.format(end=request.param))
    return fretc.read_project(folder)


@pytest.fixture(scope="module")
def plan(project: fretc.Project) -> Plan:
    made = planned(project)
    assert isinstance(made, Plan)
    return made


def verdicts(plan: Plan, samples: list[tuple[int, float]]) -> dict[str, str]:
    """Those of an audit."""
    times = np.array([time for time, _ in samples], np.int64)
    signal = Samples(times, np.array([value for _, value in samples]))
    start, end = int(times[0]), int(times[-1])
    topic = Topic("/x", "", "", len(times), start, end, None, None, None)
    none, topics = np.zeros(0, np.int64), {"/x": topic}
    recording = Recording("r", "", 1, start, end, {"x": signal}, none, (), topics, {}, (), True)
    evidence = audit(recording, plan.declarations, monitored_requirements(plan))
    return {each.requirement: str(each.verdict) for each in evidence}


@pytest.mark.slow
@settings(max_examples=100 if FULL else 4)  # each looks at all phases of the ticks
@given(
    st.lists(
        st.tuples(st.integers(1, 120), st.sampled_from([0.0, 2.0, 4.0, float("nan")])), min_size=1
    ),
    st.lists(st.integers(0, 120), max_size=6),
)
def test_the_verdicts_at_the_end_are_those_of_an_audit(
    project: fretc.Project, plan: Plan, samples: list[tuple[int, float]], cuts: list[int]
) -> None:
    samples = sorted(samples, key=lambda sample: sample[0])
    stream = fretc.Stream(project)
    cuts = [cut for cut in sorted(cuts) if cut <= samples[-1][0]]
    for time, value in samples:
        while cuts and cuts[0] <= time:
            stream.until(cuts.pop(0))
        stream.add("x", time, value)
    assert dict(stream.end().verdicts) == verdicts(plan, samples)


def beginning(log: Path, copy: Path, seconds: float) -> Path:
    """A copy of the first seconds of a log."""
    with log.open("rb") as file, copy.open("wb") as stream:
        reader, writer = make_reader(file), Writer(stream)
        writer.start(reader.get_header().profile)
        channels = dict[int, int]()
        first = None
        for schema, channel, message in reader.iter_messages(["/scan", "/odom"]):
            first = message.log_time if first is None else first
            if message.log_time - first > seconds * 10**9:
                break
            if channel.id not in channels:
                assert schema is not None
                known = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, known
                )
            times = message.log_time, message.publish_time
            writer.add_message(channels[channel.id], times[0], message.data, times[1])
        writer.finish()  # type: ignore[no-untyped-call]
    return copy


@pytest.mark.slow
@pytest.mark.parametrize("seconds", some([12, inf], 2))
def test_a_recorded_run_gives_the_ticks_and_the_verdict_of_its_audit(
    tmp_path: Path, seconds: float
) -> None:
    (whole,) = ROOT.joinpath("traces").glob("*.mcap")
    log = whole if seconds == inf else beginning(whole, tmp_path / whole.name, seconds)
    project = fretc.read_project(ROOT / "requirements")
    (result,) = fretc.audit_logs(project, log).results
    stream = fretc.Stream(project)
    ticks: list[fretc.Tick] = []
    with log.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages(["/scan", "/odom"]):
            ticks.extend(stream.until(message.log_time))
            stream.add_message(channel.topic, message.log_time, decoded)
    end = stream.end()
    ticks.extend(end.ticks)
    assert end.verdicts == {"R1": result.verdict}
    assert len(ticks) == result.ticks
    assert len(ticks) > 100
    close = [tick.number for tick in ticks if tick.truth["too_close"]]
    assert close == [moment.tick for moment in result.triggers] != []
    assert result.end_ns is not None
    assert 0 <= result.end_ns - ticks[-1].time_ns < 10**8


def refused(tmp_path: Path, sentence: str) -> fretc.Refusal:
    (tmp_path / "r1.fret").write_text(sentence)
    (tmp_path / "bindings.toml").write_text(BINDINGS.format(end="inconclusive"))
    with pytest.raises(fretc.Refusal) as refusal:
        fretc.Stream(fretc.read_project(tmp_path))
    return refusal.value


@pytest.mark.parametrize(
    ("sentence", "code"),
    [
        ("r shall always satisfy other", Code.UNBOUND),
        ("r shall allways satisfy p", Code.MISSPELT),
        ("r shall with probability > 0.9 eventually satisfy p", Code.NOT_EXPRESSIBLE),
    ],
)
def test_a_requirement_that_no_run_can_show_is_refused_and_not_left_out(
    tmp_path: Path, sentence: str, code: Code
) -> None:
    (tmp_path / "r2.fret").write_text("r shall always satisfy p")
    assert code in [diagnostic.code for diagnostic in refused(tmp_path, sentence).diagnostics]


def test_a_signal_that_is_not_declared_is_refused(project: fretc.Project) -> None:
    with pytest.raises(fretc.Refusal, match="F309 the bindings declare no signal `y`"):
        fretc.Stream(project).add("y", 1, 1.0)


def test_a_sample_of_a_computed_signal_is_refused(project: fretc.Project) -> None:
    with pytest.raises(fretc.Refusal) as refusal:
        fretc.Stream(project).add("root", 1, 1.0)
    (only,) = refusal.value.diagnostics
    assert render(only) == (
        "F309 `root` has no samples: it is computed, by `sqrt(x - 2)`\n"
        "help: add samples of the signals that it reads"
    )


def test_the_former_name_of_the_statuses_of_a_tick_gives_them_with_a_warning(
    project: fretc.Project,
) -> None:
    stream = fretc.Stream(project)
    stream.add("x", 1, 2.0)
    (tick, *_) = stream.until(30)
    with pytest.warns(DeprecationWarning, match="`standings` is now `statuses`") as told:
        assert tick.standings == tick.statuses
    assert told[0].filename == __file__
    assert len(tick.statuses) == len(SENTENCES)
