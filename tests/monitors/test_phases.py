"""For which phases of the ticks each verdict holds, against audits at every nanosecond."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from compiler.pipeline import formalize
from compiler.targets.monitor import text
from fretish.bindings import read_bindings
from fretish.declarations import Declarations
from fretish.documents import requirements
from fretish.source import Source
from monitors import kernel
from monitors.judgement import judged
from monitors.kernel import Monitor
from monitors.loading import load
from monitors.phases import Phases, phases
from monitors.samples import Recording, Samples, Topic
from monitors.traces import trace

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
    ((requirement,), _) = requirements(Source("R1.fret", sentence))
    rule, said = formalize(requirement, declared())
    assert rule is not None, said
    return load("monitor", text(rule))


def declared(
    p: str = "x < 5",
    q: str = "y < 5",
    p_agg: str = "last",
    q_agg: str = "last",
    p_unknown: str = "",
    end: str = "inconclusive",
) -> Declarations:
    told = BINDINGS.format(p=p, q=q, p_agg=p_agg, q_agg=q_agg, p_unknown=p_unknown)
    told = told.replace("[clock]", f'[clock]\nend = "{end}"')
    declarations, wrong = read_bindings(Source("bindings.toml", told))
    assert declarations is not None, wrong
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
        f"/{name}": Topic(f"/{name}", "", "", len(found.times), int(found.times[0]), end, 0, 0, 0)
        for name, found in signals.items()
        if len(found.times)
    }
    none = np.array([], np.int64)
    return Recording("log", "", 0, start, end, signals, none, gaps, topics, {}, (), intact=not gaps)


def at(phase: int, declarations: Declarations, log: Recording, watching: Monitor) -> str:
    """The verdict of an audit whose clock declares the phase, step by step."""
    clock = replace(declarations.clock, phase=phase)
    shifted = replace(declarations, clock=clock)
    seen = trace(shifted, log, watching.PROPOSITIONS)
    return judged(
        watching,
        {name: seen.columns[name] for name in watching.PROPOSITIONS},
        seen.cut,
        len(seen.timeline.times),
        intact=log.intact,
        end=str(clock.end),
        engine=kernel.stepped,
    ).verdict


def found(declarations: Declarations, log: Recording, watching: Monitor) -> Phases:
    (told,) = phases(declarations, log, [watching]).values()
    return told


def each(told: Phases) -> list[str | None]:
    """The verdict at each phase, by the stretches, which must follow each other."""
    verdicts = [s.verdict for s in told.stretches for _ in range(s.first, s.last + 1)]
    assert [s.first for s in told.stretches] == [
        0,
        *(stretch.last + 1 for stretch in told.stretches[:-1]),
    ]
    assert all(a.verdict != b.verdict for a, b in pairwise(told.stretches))
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


@st.composite
def logs(draw: st.DrawFn) -> Recording:
    length = draw(st.sampled_from([10, 30, 100]))  # short ones: what is near the end decides
    x, y = draw(pairs(length)), draw(pairs(length))
    times = [time for time, _ in (*x, *y)]
    start = min(times, default=0)
    last = max(times, default=0)
    gaps = draw(st.sampled_from([(), (), (), ((30, 41),), ((5, 5),)]))
    gaps = tuple(gap for gap in gaps if start <= gap[0] and gap[1] <= last)
    return recorded(x, y, last, gaps, start)


LAST_TICK_CHANGES = recorded(
    [(0, 9.0), (26, 1.0)], [(0, 1.0), (10, 1.0), (20, 1.0), (30, 1.0), (32, 9.0), (40, 9.0)], 40
)
"""From 32 on the last tick sees what the cut one sees, which then takes nothing back."""
CUT_TICK_DEPENDS = recorded(
    [(0, 9.0), (20, 1.0)], [(0, 1.0), (10, 1.0), (20, 1.0), (28, 1.0), (40, 9.0)], 40
)
"""What the cut tick asks for depends on a tick before the last one."""


@example(declared(), LAST_TICK_CHANGES, SENTENCES[-2], 0)
@example(declared(), CUT_TICK_DEPENDS, SENTENCES[-1], 0)
@given(declarations_, logs(), st.sampled_from(SENTENCES), st.integers(0, 11))
def test_each_phase_has_the_verdict_of_an_audit_that_declares_it(
    declarations: Declarations, log: Recording, sentence: str, phase: int
) -> None:
    watching = monitor(sentence)
    declarations = replace(declarations, clock=replace(declarations.clock, phase=phase))
    told = found(declarations, log, watching)
    assert told.exact
    assert each(told) == [at(s, declarations, log, watching) for s in range(12)]
    assert told.verdict == each(told)[phase]


def test_a_last_tick_that_changes_divides_the_phases() -> None:
    told = found(declared(), LAST_TICK_CHANGES, monitor(SENTENCES[-2]))
    assert each(told)[5:] == ["inconclusive"] * 3 + ["vacuous"] * 4


def test_a_cut_tick_whose_demand_depends_on_the_phase_divides_them() -> None:
    told = found(declared(), CUT_TICK_DEPENDS, monitor(SENTENCES[-1]))
    assert each(told)[5:] == ["vacuous"] * 3 + ["inconclusive"] * 4
