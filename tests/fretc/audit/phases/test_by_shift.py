"""For which phases of the ticks each verdict holds, against audits at every nanosecond."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from compiler.formalization.formalize import formalize
from compiler.targets.python.monitor import text
from fretc.audit.measurements.judgement import judge
from fretc.audit.phases.by_shift import PhaseInterval, Phases, phases
from fretc.logs.signals.samples import Late, Recording, Samples, Topic
from fretc.logs.signals.traces import trace
from fretish.bindings.declarations import Declarations
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from monitors import kernel
from monitors.kernel import Monitor
from monitors.kernel.verdicts import Verdict
from monitors.loading import load

BINDINGS = """
[clock]
tick = "12 ns"
[signal.x]
path = "/x.data"
[signal.y]
path = "/y.data"
max_age = "17 ns"
[proposition.p]
expr = "{p}"
agg = "{p_agg}"
{p_unknown}
[proposition.q]
expr = "{q}"
agg = "{q_agg}"
"""
SENTENCES = (
    "the r shall always satisfy p",
    "the r shall never satisfy p & q",
    "when p the r shall immediately satisfy q",
    "when p the r shall within 2 ticks satisfy q",
    "whenever p the r shall within 1 tick satisfy q",
    "whenever p the r shall eventually satisfy q",
    "upon p the r shall at the next timepoint satisfy q",
    "whenever p the r shall for 1 tick satisfy q",
    "whenever p the r shall until q satisfy !q | p",
    "while p the r shall finally satisfy q",
    "whenever persisted(1, p) the r shall within 2 ticks satisfy q",
    "whenever persisted(2, p) the r shall within 2 ticks satisfy q",
)


@cache
def monitor(sentence: str) -> Monitor:
    ((entry,), _) = requirements(Source("R1.fret", sentence))
    requirement, diagnostics = formalize(entry, declared())
    assert requirement is not None, diagnostics
    return load("monitor", text(requirement))


def declared(
    p: str = "x < 5",
    q: str = "y < 5",
    p_agg: str = "last",
    q_agg: str = "last",
    p_unknown: str = "",
    end: str = "inconclusive",
) -> Declarations:
    text = BINDINGS.format(p=p, q=q, p_agg=p_agg, q_agg=q_agg, p_unknown=p_unknown)
    text = text.replace("[clock]", f'[clock]\nend = "{end}"')
    declarations, diagnostics = read_bindings(Source("bindings.toml", text))
    assert declarations is not None, diagnostics
    return declarations


Pairs = Sequence[tuple[int, float]]


def samples(pairs: Pairs) -> Samples:
    ordered = sorted(pairs, key=lambda pair: pair[0])
    times, values = [time for time, _ in ordered], [value for _, value in ordered]
    return Samples(np.array(times, np.int64), np.array(values, np.float64))


def recorded(
    x: Pairs, y: Pairs, end: int, gaps: tuple[tuple[int, int], ...] = (), start: int = 0
) -> Recording:
    """The log of both; each topic begins with its first sample."""
    signals = {"x": samples(x), "y": samples(y)}
    topics = {
        f"/{name}": Topic(
            f"/{name}", "", "", len(samples.times), int(samples.times[0]), end, 0, 0, 0
        )
        for name, samples in signals.items()
        if len(samples.times)
    }
    none = np.array([], np.int64)
    return Recording("log", "", 0, start, end, signals, none, gaps, topics, {}, (), intact=not gaps)


def at(phase: int, declarations: Declarations, log: Recording, watching: Monitor) -> str:
    """The verdict of an audit whose clock declares the phase, step by step."""
    clock = replace(declarations.clock, phase=phase)
    other = replace(declarations, clock=clock)
    truths = trace(other, log, watching.PROPOSITIONS)
    (judgement,) = judge(
        watching,
        {name: truths.columns[name] for name in watching.PROPOSITIONS},
        truths.cut,
        len(truths.timeline.times),
        intact=log.intact,
        end=Verdict(clock.end),
        engine=kernel.stepped,
    )
    return judgement.verdict


def phases_of(declarations: Declarations, log: Recording, watching: Monitor) -> Phases:
    (result,) = phases(declarations, log, [watching]).values()
    return result


def each(result: Phases) -> list[str | None]:
    """The verdict at each phase, by the stretches, which must follow each other."""
    verdicts = [s.verdict for s in result.stretches for _ in range(s.first, s.last + 1)]
    assert [s.first for s in result.stretches] == [
        0,
        *(stretch.last + 1 for stretch in result.stretches[:-1]),
    ]
    assert all(a.verdict != b.verdict for a, b in pairwise(result.stretches))
    return verdicts


values = st.sampled_from([1.0, 9.0, 9.0, 1.0, float("nan")])


def pairs(last: int) -> st.SearchStrategy[list[tuple[int, float]]]:
    return st.lists(st.tuples(st.integers(0, last), values), max_size=12)


declarations_ = st.builds(
    declared,
    p=st.sampled_from(["x < 5", "x < 5 for 9 ns", "x < 5 or y < 5", "not (x < 5)"]),
    q=st.sampled_from(["y < 5", "y < 5 for 14 ns", "x > 5"]),
    p_agg=st.sampled_from(["any", "all", "last"]),
    q_agg=st.sampled_from(["any", "all", "last"]),
    p_unknown=st.sampled_from(["", "on_unknown = true", "on_unknown = false"]),
    end=st.sampled_from(["inconclusive", "violated"]),
)


PAST = (
    "x - pre(0, x) < 3",
    "pre(9, pre(1, x)) < 5 or x > 5",
    "x <= pre(y, x + pre(1, y)) and (x < 5 for 9 ns)",
    "not (pre(1, y) < 5)",
)
past_declarations = st.builds(
    declared,
    p=st.sampled_from(PAST),
    q=st.sampled_from(["y < 5", "x > 5", *PAST]),
    p_unknown=st.sampled_from(["", "on_unknown = true"]),
    end=st.sampled_from(["inconclusive", "violated"]),
)


@st.composite
def logs(draw: st.DrawFn) -> Recording:
    length = draw(st.sampled_from([10, 30, 100]))  # short ones: what is near the end decides
    x, y = draw(pairs(length)), draw(pairs(length))
    times = [time for time, _ in (*x, *y)]
    start = min(times, default=0)
    last = max(times, default=0)
    gaps = draw(st.sampled_from([(), (), (), ((30, 41),), ((5, 5),)]))
    gaps = tuple(gap for gap in gaps if start <= gap[0] and gap[1] <= last)
    log = recorded(x, y, last, gaps, start)
    late = draw(st.dictionaries(st.sampled_from(["/x", "/y"]), late_spans(length)))
    origin = draw(st.none() | st.integers(start, start + 11))
    return replace(log, late=late, origin=origin)


def late_spans(length: int) -> st.SearchStrategy[Late]:
    spans = st.tuples(st.integers(0, length), st.integers(0, 20))
    return st.lists(spans, min_size=1, max_size=3).map(
        lambda some: Late(
            np.array([first for first, _ in some]), np.array([first + more for first, more in some])
        )
    )


LAST_TICK_CHANGES = recorded(
    [(0, 9.0), (26, 1.0)], [(0, 1.0), (10, 1.0), (20, 1.0), (30, 1.0), (32, 9.0), (40, 9.0)], 40
)
"""From 32 on the last tick sees what the cut one sees, which then takes nothing back."""
CUT_TICK_DEPENDS = recorded(
    [(0, 9.0), (20, 1.0)], [(0, 1.0), (10, 1.0), (20, 1.0), (28, 1.0), (40, 9.0)], 40
)
"""What the cut tick asks for depends on a tick before the last one."""


@pytest.mark.slow
@example(declared(), LAST_TICK_CHANGES, SENTENCES[-2], 0)
@example(declared(), CUT_TICK_DEPENDS, SENTENCES[-1], 0)
@given(declarations_ | past_declarations, logs(), st.sampled_from(SENTENCES), st.integers(0, 11))
def test_each_phase_has_the_verdict_of_an_audit_that_declares_it(
    declarations: Declarations, log: Recording, sentence: str, phase: int
) -> None:
    watching = monitor(sentence)
    declarations = replace(declarations, clock=replace(declarations.clock, phase=phase))
    result = phases_of(declarations, log, watching)
    assert result.exact
    assert each(result) == [at(s, declarations, log, watching) for s in range(12)]
    assert result.verdict == each(result)[phase]


def test_a_last_tick_that_changes_divides_the_phases() -> None:
    result = phases_of(declared(), LAST_TICK_CHANGES, monitor(SENTENCES[-2]))
    assert each(result)[5:] == ["inconclusive"] * 3 + ["vacuous"] * 4


def test_a_cut_tick_whose_demand_depends_on_the_phase_divides_them() -> None:
    result = phases_of(declared(), CUT_TICK_DEPENDS, monitor(SENTENCES[-1]))
    assert each(result)[5:] == ["vacuous"] * 3 + ["inconclusive"] * 4


# Where not all phases are judged


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fretc.audit.phases.by_shift.MOST", 0)
    monkeypatch.setattr("fretc.audit.phases.by_shift.FEWEST", 3)


BUSY = recorded(
    [(t, 1.0 if t % 7 < 3 else 9.0) for t in range(0, 200, 2)],
    [(t, 1.0 if t % 5 < 3 else 9.0) for t in range(0, 200, 3)],
    199,
)


@pytest.mark.slow
@pytest.mark.usefixtures("few")
@pytest.mark.parametrize("sentence", SENTENCES)
def test_what_is_not_judged_is_left_out_and_the_rest_is_right(sentence: str) -> None:
    expected = [at(phase, declared(), BUSY, monitor(sentence)) for phase in range(12)]
    for phase in range(12):
        declarations = replace(declared(), clock=replace(declared().clock, phase=phase))
        result = phases_of(declarations, BUSY, monitor(sentence))
        assert each(result)[phase] == result.verdict == expected[phase], phase
        for one, other in zip(each(result), expected, strict=True):
            assert one in (other, None), phase


@pytest.mark.usefixtures("few")
def test_a_search_that_ends_early_says_so() -> None:
    result = phases_of(declared(), BUSY, monitor(SENTENCES[2]))
    assert not result.exact
    assert "not computed in " in result.text
    assert "no change within " in result.text
    assert "changes it" not in result.text


# What is reported


def phases_with(*stretches: PhaseInterval, declared: int = 0, period: int = 100) -> Phases:
    return Phases(period, declared, stretches)


def test_one_verdict_at_all_phases_is_not_told() -> None:
    result = phases_with(PhaseInterval(0, 99, "satisfied"))
    assert (result.text, result.nearest, result.exact, result.varies) == ("", None, True, False)


def test_the_nearest_change_is_found_around_the_end_of_the_tick() -> None:
    stretches = (
        PhaseInterval(0, 39, "satisfied"),
        PhaseInterval(40, 90, "violated"),
        PhaseInterval(91, 99, "vacuous"),
    )
    assert [phases_with(*stretches, declared=d).nearest for d in (0, 8, 20, 39, 90, 91)] == [
        1, 9, 20, 1, 1, 1,
    ]  # fmt: skip


def test_a_share_is_never_rounded_to_nothing_or_to_all() -> None:
    result = phases_with(
        PhaseInterval(0, 0, "violated"), PhaseInterval(1, 999, "satisfied"), period=1000
    )
    assert result.text == (
        "the verdict depends on where the ticks begin: violated in less than 1 % of cases, "
        "satisfied in 99 %; a shift of 1 ns changes it"
    )


def test_a_clock_that_ticks_by_message_has_no_phases() -> None:
    clock = replace(declared().clock, period=None, topic="/x")
    assert phases(replace(declared(), clock=clock), BUSY, [monitor(SENTENCES[0])]) == {}


def test_a_log_shorter_than_a_tick_has_no_tick_at_the_later_phases() -> None:
    result = phases_of(declared(), recorded([(0, 1.0)], [(0, 1.0)], 4), monitor(SENTENCES[0]))
    assert result.stretches == (PhaseInterval(0, 4, "satisfied"), PhaseInterval(5, 11, "no data"))
