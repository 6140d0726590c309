"""What surrounds a violation; the verdicts themselves are the kernel's."""

from collections.abc import Sequence

import numpy as np
import pytest

from compiler.files.records import plain
from fretc.audit.evidence.writer import as_record
from fretc.audit.expected_response import demand
from fretc.audit.measurements.intervals import Moment
from fretc.audit.measurements.violations import (
    MOST_SAMPLES,
    MOST_WINDOWS,
    DemandText,
    ViolationInterval,
    violations,
)
from fretc.logs.signals.samples import Recording, Samples
from monitors.kernel import VIOLATED, Outcome
from tests.fretc.audit.test_one_log import FAR, MOVING, NEAR, STILL, audited, recorded
from tests.monitoring import requirement

S = 10**9
NAN, INF = float("nan"), float("inf")
NO_DEADLINE = DemandText()
WITHIN = "whenever near the rover shall within 2 ticks satisfy still"


def violations_of(
    outcome: Outcome, deadline_ticks: int | None = None, demand: DemandText = NO_DEADLINE
) -> list[ViolationInterval]:
    log = recorded([FAR] * outcome.ticks, [MOVING] * outcome.ticks)
    return list(
        violations(
            outcome, demand, deadline_ticks, lambda t: Moment(t, t * S, float(t)), log, ["d"]
        )
    )


def outcome(
    runs: Sequence[tuple[int, int]],
    triggers: Sequence[int],
    answers: Sequence[tuple[int, int]] = (),
    open_: Sequence[tuple[int, int | None]] = (),
    ticks: int = 20,
) -> Outcome:
    return Outcome(
        "R1", ticks, VIOLATED, False, 0, tuple(runs), (), tuple(triggers), tuple(answers),
        tuple(open_),
    )  # fmt: skip


def triggers_of(stretches: Sequence[ViolationInterval]) -> list[int | None]:
    return [violation.trigger.tick if violation.trigger else None for violation in stretches]


def test_the_trigger_is_the_oldest_whose_deadline_has_passed() -> None:
    evidence = audited(WITHIN, recorded([FAR, NEAR, NEAR, NEAR, FAR, FAR], [MOVING] * 6))
    (violation,) = evidence.violations
    assert violation.first.tick == 3
    assert violation.trigger == Moment(1, S, 1.0)
    assert evidence.reason == "from 3 s to 6 s (3 s), triggered at 1 s"


def test_one_that_was_answered_is_not_to_blame() -> None:
    stretches = violations_of(outcome([(9, 9)], [5, 7, 8], answers=[(5, 6)]), deadline_ticks=4)
    assert triggers_of(stretches) == [7]


def test_without_a_deadline_it_is_the_last_trigger_and_at_the_end_the_oldest_open() -> None:
    assert triggers_of(violations_of(outcome([(9, 9)], [3, 5, 12]))) == [5]
    assert triggers_of(violations_of(outcome([(9, 9)], []))) == [None]
    ended = outcome([(19, 19)], [3, 5, 12], answers=[(3, 4)], open_=[(5, None), (12, None)])
    assert triggers_of(violations_of(ended)) == [5]


def test_the_deadline_is_told_where_there_is_one_within_the_run() -> None:
    one = outcome([(9, 9)], [5])
    (violation,) = violations_of(one, deadline_ticks=4, demand=DemandText("still", 4))
    assert violation.deadline == Moment(9, 9 * S, 9.0)
    assert violation.missing == "still"
    (none,) = violations_of(one, deadline_ticks=4, demand=DemandText("still"))
    assert none.deadline is None
    (later,) = violations_of(
        outcome([(9, 9)], [5], ticks=10), deadline_ticks=6, demand=DemandText("still", 6)
    )
    assert later.deadline is None


@pytest.mark.parametrize(
    ("timing", "expected"),
    [
        ("immediately", DemandText("q", 0)),
        ("at the next timepoint", DemandText("q", 1)),
        ("within 3 ticks", DemandText("q", 3)),
        ("for 3 ticks", DemandText("q")),
        ("after 3 ticks", DemandText("after 3 ticks satisfy q", 4)),
        ("eventually", DemandText("q")),
        ("always", DemandText("q")),
        ("never", DemandText("!q")),
        ("until r", DemandText("until r satisfy q")),
        ("before r", DemandText("before r satisfy q")),
    ],
)
def test_what_each_timing_demands(timing: str, expected: DemandText) -> None:
    assert demand(requirement(f"whenever p the sw shall {timing} satisfy q")) == expected


def test_an_only_scope_demands_that_it_is_not_so() -> None:
    assert demand(
        requirement("only in m mode, the sw shall within 3 ticks satisfy q & r")
    ) == DemandText("not (within 3 ticks satisfy q & r)")


# Signals around it


def test_the_window_goes_from_two_seconds_before_the_trigger_to_two_after_the_deadline() -> None:
    log = recorded([FAR] * 5 + [NEAR] + [FAR] * 9, [MOVING] * 8 + [NAN, INF] + [MOVING] * 5)
    (violation,) = plain(as_record(audited(WITHIN, log)))["violations"]
    assert violation["window"]["start_ns"] == 3 * S
    assert violation["window"]["end_ns"] == 9 * S
    assert violation["window"]["samples"] == {
        "d": {
            "times_ns": (3 * S, 4 * S, 5 * S, 6 * S, 7 * S, 8 * S, 9 * S),
            "values": (1.0, 1.0, 0.01, 1.0, 1.0, 1.0, 1.0),
        },
        "v": {
            "times_ns": (3 * S, 4 * S, 5 * S, 6 * S, 7 * S, 8 * S, 9 * S),
            "values": (0.4, 0.4, 0.4, 0.4, 0.4, None, "+inf"),
        },
    }


def test_an_infinite_sample_is_told_as_a_text() -> None:
    log = recorded([INF, NEAR, -INF, FAR, FAR], [MOVING] * 5)
    (violation,) = plain(as_record(audited(WITHIN, log)))["violations"]
    assert violation["window"]["samples"]["d"]["values"] == ("+inf", 0.01, "-inf", 1.0, 1.0)


def test_the_sample_in_force_at_the_start_is_told_however_old_it_is() -> None:
    one = Samples(np.array([0], np.int64), np.array([0.5]))
    log = Recording("a", "", 1, 0, 20 * S, {"d": one}, np.array([], np.int64), (), {}, {}, (), True)
    (violation,) = violations(
        outcome([(9, 9)], [9]), DemandText(), 0, lambda t: Moment(t, t * S, float(t)), log, ["d"]
    )
    assert violation.window is not None
    assert violation.window.samples["d"].times.tolist() == [0]


def test_many_samples_are_thinned_evenly_with_the_least_and_the_greatest() -> None:
    times = np.arange(0, 20 * S, S // 1000)
    values = np.sin(times / S)
    values[9_123], values[9_876], values[9_500] = -7.0, 7.0, NAN
    many = Samples(times, values)
    log = Recording(
        "a", "", 1, 0, 20 * S, {"d": many}, np.array([], np.int64), (), {}, {}, (), True
    )
    (violation,) = violations(
        outcome([(9, 9)], [9]), DemandText(), 0, lambda t: Moment(t, t * S, float(t)), log, ["d"]
    )
    assert violation.window is not None
    samples = violation.window.samples["d"]
    assert len(samples.times) <= MOST_SAMPLES
    assert {-7.0, 7.0} <= set(samples.values.tolist())
    assert (samples.times[0], samples.times[-1]) == (7 * S, 11 * S)
    assert np.diff(samples.times).max() < 90 * S // 1000
    unknown = Samples(times, np.full(len(times), NAN))
    (violation,) = violations(
        outcome([(9, 9)], [9]), DemandText(), 0, lambda t: Moment(t, t * S, float(t)),
        Recording("a", "", 1, 0, 1, {"d": unknown}, np.array([], np.int64), (), {}, {}, (), True),
        ["d"],
    )  # fmt: skip
    assert violation.window is not None
    assert len(violation.window.samples["d"].times) <= MOST_SAMPLES


@pytest.mark.parametrize("broken", [8, 9])
def test_the_last_sample_at_the_broken_tick_is_kept_exactly(broken: int) -> None:
    """Its age is reported: the signal falls silent 0.437 s before that tick."""
    silent = broken * S - 437 * S // 1000
    times = np.concatenate([np.arange(0, silent + 1, S // 1000), np.arange(10, 12) * S])
    log = Recording(
        "a", "", 1, 0, 20 * S, {"d": Samples(times, np.sin(times / S))}, np.array([], np.int64),
        (), {}, {}, (), True,
    )  # fmt: skip
    (violation,) = violations(
        outcome([(broken, 12)], [4]),
        DemandText(),
        20,
        lambda t: Moment(t, t * S, float(t)),
        log,
        ["d"],
    )
    assert violation.window is not None
    times = violation.window.samples["d"].times
    assert len(times) <= MOST_SAMPLES
    assert times[times <= broken * S][-1] == silent


def test_only_the_first_violations_carry_their_samples() -> None:
    runs = [(2 * i, 2 * i) for i in range(MOST_WINDOWS + 5)]
    stretches = violations_of(outcome(runs, [], ticks=300))
    assert [v.window is not None for v in stretches] == [True] * MOST_WINDOWS + [False] * 5


def test_a_satisfied_requirement_names_its_least_margin() -> None:
    always = "the rover shall always satisfy !near"
    evidence = audited(always, recorded([FAR, 0.08, FAR], [STILL] * 3))
    assert evidence.reason.endswith(", least margin 0.03 m (d < 5 cm)")
    record = plain(as_record(evidence))
    assert record["thresholds"][0]["nearest"] == {"ns": S, "seconds": 1.0}
    assert record["propositions"] == {"near": {"true": 0, "false": 3, "unknown": 0, "changes": 0}}


def test_the_exercise_is_counted() -> None:
    log = recorded([FAR, NEAR, FAR, NEAR, FAR], [MOVING, MOVING, STILL, STILL, STILL])
    record = plain(as_record(audited(WITHIN, log)))
    assert record["exercised"] == 2
    assert (record["latency_median_s"], record["latency_max_s"]) == (0.5, 1.0)
    idle = plain(as_record(audited(WITHIN, recorded([FAR] * 3, [MOVING] * 3))))
    assert (idle["exercised"], idle["latency_median_s"], idle["latency_max_s"]) == (0, None, None)
