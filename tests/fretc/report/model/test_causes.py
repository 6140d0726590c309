"""What is said of the cause of a violation is what the monitor saw; nothing else is said."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.project import Project
from fretc.audit.evidence.declared_units import in_declared_units
from fretc.audit.evidence.schema import Result
from fretc.audit.evidence.writer import as_record
from fretc.audit.one_log import audit
from fretc.audit.plan import monitored_requirements, planned
from fretc.logs.signals.samples import Recording, Samples
from fretc.logs.signals.traces import Trace, trace
from fretc.report.model.causes import causes, falsity, in_words
from fretish import expressions as e
from fretish import syntax as s
from tests.effort import FULL
from tests.fretc.audit.results import SHA
from tests.fretc.report.cases import project, requirement

MS = 10**6
BINDINGS = """
[clock]
tick = "100 ms"
[signal.d]
path = "/scan.d"
unit = "m"
max_age = "300 ms"
[signal.v]
path = "/odom.v"
unit = "cm/s"
[signal.mode]
path = "/mode.data"
values = ["drive", "docking"]
max_age = "1 s"
[signal.flag]
path = "/flag.data"
[proposition.near]
expr = "d < 50 cm"
agg = "any"
[proposition.still]
expr = "abs(v) < 0.01 m/s and d > 0 m for 200 ms"
[proposition.slow]
expr = "v <= 0.5 m/s or mode = docking"
agg = "all"
[proposition.fresh]
expr = "d > 0 m"
agg = "all"
on_unknown = false
[proposition.asleep]
expr = "not (d > 0 m)"
on_unknown = true
"""
SENTENCES = (
    "the robot shall always satisfy slow",
    "the robot shall never satisfy near",
    "the robot shall never satisfy asleep",
    "whenever near the robot shall within 3 ticks satisfy still",
    "upon near the robot shall within 2 ticks satisfy (still & slow)",
    "whenever near the robot shall immediately satisfy fresh",
    "when near the robot shall for 3 ticks satisfy (slow | fresh)",
    "whenever near the robot shall immediately satisfy (flag -> ! near)",
    "in near the robot shall always satisfy v < 30 cm/s",
    "the robot shall always satisfy mode = docking",
    "only in near the robot shall always satisfy slow",
    "upon near the robot shall eventually satisfy still",
)


@pytest.fixture(scope="module")
def known(tmp_path_factory: pytest.TempPathFactory) -> Project:
    texts = [requirement(f"R{n}", text) for n, text in enumerate(SENTENCES, 1)]
    found = project(tmp_path_factory.mktemp("causes"), *texts, bindings=BINDINGS)
    assert not [d for d in found.diagnostics if d.is_error], found.diagnostics
    return found


def samples(times: Sequence[int], values: Sequence[float], name: str, known: Project) -> Samples:
    assert known.declarations is not None
    signal = known.declarations.signals[name]
    kind = np.float32 if name == "d" else np.float64
    order = np.array(sorted(times), np.int64) * MS
    return Samples(order, np.array(values, kind), signal.scale, signal.values)


def recording(known: Project, of: dict[str, list[tuple[int, float]]], **changes: Any) -> Recording:
    found = {
        name: samples([t for t, _ in rows], [v for _, v in rows], name, known)
        for name, rows in of.items()
    }
    none = np.array([], np.int64)
    whole: dict[str, Any] = {"gaps": (), "findings": (), "intact": True, **changes}
    return Recording(
        name="a.mcap",
        sha256=SHA,
        size=1,
        start_ns=0,
        end_ns=2000 * MS,
        samples=found,
        ticks=none,
        topics={},
        nearest={},
        **whole,
    )


def judged(known: Project, log: Recording) -> list[tuple[FormalizedRequirement, Result, Trace]]:
    """Each requirement with its result in declared units, and what its monitor saw."""
    plan = planned(known)
    assert not isinstance(plan, tuple), plan
    assert known.declarations is not None
    results = [
        as_record(each) for each in audit(log, plan.declarations, monitored_requirements(plan))
    ]
    shown = [in_declared_units(each, known.declarations) for each in results]
    requirements = {requirement.id: requirement for requirement in known.formalized}
    return [
        (requirement, result, trace(requirement.declarations, log, requirement.watched))
        for result in shown
        for requirement in [requirements[result.requirement]]
        if requirement.declarations is not None
    ]


def kleene(
    tree: e.Expression, truths: Trace, tick: int, requirement: FormalizedRequirement
) -> bool | None:
    """The response at a tick, written down from the definition."""
    match tree:
        case e.Not(arg):
            value = kleene(arg, truths, tick, requirement)
            return None if value is None else not value
        case e.And(args):
            values = [kleene(arg, truths, tick, requirement) for arg in args]
            return False if False in values else None if None in values else True
        case e.Or(args):
            return kleene(
                e.Not(e.And(tuple(e.Not(arg) for arg in args))), truths, tick, requirement
            )
        case e.Implies(left, right):
            return kleene(e.Or((e.Not(left), right)), truths, tick, requirement)
        case e.Name(id):
            return truths.columns[id].at(tick)
        case _:
            (name,) = [name for name in truths.columns if name not in BINDINGS]
            return truths.columns[name].at(tick)


times = st.lists(st.integers(0, 1999), min_size=1, max_size=25, unique=True).map(sorted)
NAN, INF = float("nan"), float("inf")
VALUES = {
    "d": [0.2, 0.5, 0.50001, 1.0, -0.1, NAN, INF, -INF],
    "v": [0.0, 0.5, 1.0, 30.0, 50.0, 51.0, 200.0, -70.0, NAN],
    "mode": [0.0, 1.0, NAN],
    "flag": [0.0, 1.0, 2.0],
}


@st.composite
def signals(draw: st.DrawFn) -> dict[str, list[tuple[int, float]]]:
    found = {}
    for name, values in VALUES.items():
        if name in draw(st.sampled_from([tuple(VALUES), tuple(VALUES), ("d", "v")])):
            rows = [(time, draw(st.sampled_from(values))) for time in draw(times)]
            found[name] = rows
    return found


gaps = st.lists(
    st.tuples(st.integers(0, 1999), st.integers(0, 300)).map(
        lambda g: (g[0] * MS, (g[0] + g[1]) * MS)
    ),
    max_size=1,
)


@pytest.mark.slow
@given(signals(), gaps)
@settings(deadline=None, max_examples=200 if FULL else 8)
def test_the_words_agree_with_what_the_monitor_saw(
    known: Project, of: dict[str, list[tuple[int, float]]], lost: list[tuple[int, int]]
) -> None:
    log = recording(known, of, gaps=tuple(lost), intact=not lost)
    for formalized, result, truths in judged(known, log):
        for violation in result.violations:
            for cause in causes(violation, result, formalized):
                seen = truths.columns[cause.proposition].at(violation.first_tick)
                assert seen is cause.value, (formalized.id, cause)
            if falsity(violation, result, formalized):
                timing = formalized.sentence.timing
                trigger = violation.trigger if isinstance(timing, s.Within) else None
                first = trigger or violation.first
                for tick in range(first.tick, violation.last_tick + 1):
                    value = kleene(formalized.sentence.response, truths, tick, formalized)
                    assert value is isinstance(timing, s.Never), (formalized.id, tick, value)


def said(known: Project, id: str, of: dict[str, list[tuple[int, float]]]) -> tuple[str, str]:
    """What is said of the first violation of a requirement."""
    formalized, result, _ = next(
        one for one in judged(known, recording(known, of)) if one[0].id == id
    )
    first = result.violations[0]
    return falsity(first, result, formalized), in_words(causes(first, result, formalized))


def every(step: int, value: float) -> list[tuple[int, float]]:
    return [(time, value) for time in range(0, 2000, step)]


def test_a_bound_and_what_was_measured(known: Project) -> None:
    of = {
        "d": every(100, 1.0),
        "v": [(0, 10.0), (800, 52.0), (1200, 10.0)],
        "mode": every(100, 0.0),
    }
    assert said(known, "R1", of) == (
        "`slow` was false from 0.8 s to 1.2 s (400 ms), but had to be true",
        '`v` was 0.52 m/s, must be at most 0.5 m/s; `mode` was "drive", must be `docking`',
    )


def test_an_answer_that_comes_too_late(known: Project) -> None:
    of = {"d": [(0, 1.0), *((t, 0.2) for t in range(500, 2000, 100))], "v": every(100, 7.0)}
    words, why = said(known, "R4", {**of, "mode": every(100, 0.0), "flag": every(100, 0.0)})
    assert words == "`still` was false from 0.5 s to 2.1 s, but had to be true by 0.8 s"
    assert why == "`abs(v)` was 0.07 m/s, must be below 0.01 m/s"


def test_a_sample_that_is_too_old_counts_as_declared(known: Project) -> None:
    of = {"d": [(0, 1.0), (96, 1.0)], "v": every(100, 7.0)}
    words, why = said(known, "R3", {**of, "mode": every(100, 0.0), "flag": every(100, 0.0)})
    assert words.startswith("`asleep` was true from 0.4 s")
    assert why == (
        "the last sample of `d` was 304 ms old, 300 ms are allowed, so `asleep` counts as true"
    )


def test_a_value_at_its_bound_is_not_explained(known: Project) -> None:
    """As 32-bit floats both may be the bound: the monitor knows, the evidence does not."""
    of = {"d": every(100, 1.0), "v": every(100, 50.00000001), "mode": every(100, 0.0)}
    assert said(known, "R1", {**of, "flag": every(100, 0.0)})[1] == ""
