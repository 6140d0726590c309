"""From a recording and a generated monitor to a verdict with its reason."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from compiler.files.records import plain
from compiler.formalization.formalize import formalize
from compiler.situations.situations import situations
from compiler.targets.python.monitor import text
from fretc.audit.evidence.writer import RunResult, as_record
from fretc.audit.one_log import MonitoredRequirement, audit, signals_of
from fretc.logs.log_diagnostics import no_topic
from fretc.logs.signals.samples import Recording, Samples, Topic
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from monitors.loading import load
from tests.fretc.audit.results import HASHES
from tests.fretc.logs.logs import declare

S = 10**9
BINDINGS = """
[clock]
tick = "1 s"
[signal.d]
path = "/scan.d"
unit = "m"
[signal.v]
path = "/odom.v"
unit = "m/s"
max_age = "3 s"
[proposition.near]
expr = "d < 5 cm"
agg = "any"
[proposition.still]
expr = "abs(v) < 0.01 m/s"
"""
FAR, NEAR, STILL, MOVING = 1.0, 0.01, 0.0, 0.4


def recorded(
    distances: Sequence[float], speeds: Sequence[float], end: float | None = None
) -> Recording:
    """One sample a second of each, from second 0 on; the log ends at second `end`."""

    def samples(values: Sequence[float]) -> Samples:
        return Samples(
            np.arange(len(values), dtype=np.int64) * S, np.array(values, dtype=np.float64)
        )

    last = int((len(distances) - 1 if end is None else end) * S)
    signals = {"d": samples(distances), "v": samples(speeds)}
    none = np.array([], np.int64)
    return Recording("run.mcap", "ab", 1, 0, last, signals, none, (), {}, {}, (), True)


def audited(
    sentence: str, recording: Recording, declarations: Declarations | None = None
) -> RunResult:
    bindings = declarations or declare(BINDINGS)
    ((entry,), _) = requirements(Source("R1.fret", sentence))
    requirement, diagnostics = formalize(entry, bindings)
    assert requirement is not None, diagnostics
    watched = MonitoredRequirement(
        load("monitor", text(requirement)), HASHES | {"sentence": requirement.fingerprint}
    )
    (evidence,) = audit(recording, bindings, [watched])
    return evidence


EVENTUALLY = "whenever near the rover shall eventually satisfy still"
WITHIN = "whenever near the rover shall within 2 seconds satisfy still"


def test_a_demand_that_is_answered_is_satisfied_with_its_latency() -> None:
    evidence = audited(EVENTUALLY, recorded([FAR, NEAR, FAR, FAR], [MOVING, MOVING, MOVING, STILL]))
    assert (evidence.verdict, evidence.latencies) == ("satisfied", (2.0,))
    assert evidence.reason == (
        "held, 1 trigger, answered after 2 s; the verdict depends on where the ticks begin: "
        "satisfied in less than 1 % of cases, inconclusive in 99 %; a shift of 1 ns changes it"
    )
    assert [moment.seconds for moment in evidence.triggers] == [1.0]


def test_a_deadline_that_passes_is_a_violation_with_its_time_trigger_and_signals() -> None:
    evidence = audited(WITHIN, recorded([FAR, NEAR, FAR, FAR, FAR], [MOVING] * 4 + [STILL]))
    (violation,) = evidence.violations
    assert evidence.verdict == "violated"
    assert (violation.first.seconds, violation.last.seconds) == (3.0, 3.0)
    assert violation.trigger is not None
    assert violation.trigger.seconds == 1.0
    assert violation.values == {"d": FAR, "v": MOVING}
    assert evidence.units == {"d": "m", "v": "m/s"}
    assert evidence.reason == "from 3 s to 4 s (1 s), triggered at 1 s"


def test_a_demand_that_is_open_at_the_end_is_inconclusive() -> None:
    evidence = audited(EVENTUALLY, recorded([FAR, FAR, NEAR], [MOVING] * 3))
    assert (evidence.verdict, evidence.outcome.finite) == ("inconclusive", False)
    assert evidence.reason == "1 demand open at the end of the log since 2 s"


def test_the_clock_can_make_an_open_demand_a_violation() -> None:
    strict = declare(BINDINGS.replace("[clock]", '[clock]\nend = "violated"'))
    evidence = audited(EVENTUALLY, recorded([FAR, FAR, NEAR], [MOVING] * 3), strict)
    assert evidence.verdict == "violated"


def test_what_never_triggers_is_vacuous() -> None:
    evidence = audited(EVENTUALLY, recorded([FAR] * 3, [MOVING] * 3))
    assert (evidence.verdict, evidence.reason) == ("vacuous", "never triggered in 3 ticks")


def test_an_unknown_trigger_is_no_data() -> None:
    evidence = audited(EVENTUALLY, recorded([FAR, float("nan"), FAR], [MOVING, MOVING, STILL]))
    assert evidence.verdict == "no data"
    assert evidence.reason == (
        "unknown where it matters: `near` from 1 s to 2 s (1 s): `d` was no measurement"
    )


def test_of_several_unknown_intervals_the_longest_is_told_with_the_number_of_ticks() -> None:
    nan = float("nan")
    log = recorded([FAR, nan, FAR, nan, nan, FAR], [STILL] * 6)
    assert audited(EVENTUALLY, log).reason.startswith(
        "unknown where it matters: `near` at 3 ticks; the longest: `near` from 3 s to 5 s (2 s): "
    )


def test_an_error_about_a_signal_of_another_requirement_is_no_reason() -> None:
    declared = declare(BINDINGS + '[signal.other]\npath = "/other.x"\n')
    log = recorded([FAR, float("nan"), FAR], [MOVING, MOVING, STILL])

    def reason(*signals: str) -> str:
        spans = (declared.signals[name].span for name in signals)
        errors = tuple(no_topic(f"/{span}", (), span) for span in spans)
        return audited(EVENTUALLY, replace(log, findings=errors), declared).reason

    assert reason("other") == reason()
    own = declared.signals["v"].span
    assert reason("other", "v") == f"the topic `/{own}` is not in the log"


def test_a_stale_response_is_no_data_and_never_a_pass() -> None:
    speeds = [STILL]  # one sample: known up to second 3
    sentence = "whenever near the rover shall immediately satisfy still"
    evidence = audited(sentence, recorded([FAR] * 5 + [NEAR], speeds))
    assert evidence.verdict == "no data"
    assert evidence.reason.startswith(
        "undecided at 1 of 6 ticks (16.7 %), because inputs are unknown: `still` from 4 s to 6 s "
        "(2 s): the last sample of `v` was too old; the verdict depends on where the ticks begin: "
    )


def test_the_remedy_for_old_samples_names_the_limit_and_the_gap() -> None:
    log = recorded([FAR, FAR, FAR, FAR, FAR, NEAR, FAR, FAR], [STILL] * 8)
    known = [0, 1, 6, 7]
    speed = log.samples["v"]
    sparse = replace(speed, times=speed.times[known], values=speed.values[known])
    topic = Topic("/odom", "", "cdr", 4, 0, 7 * S, longest_gap_ns=5 * S)
    samples = {**log.samples, "v": sparse}
    late = replace(log, samples=samples, topics={**log.topics, "/odom": topic})
    evidence = audited("whenever near the rover shall immediately satisfy still", late)
    assert evidence.verdict == "no data"
    assert "; `max_age` is 3 s, the longest gap 5 s: raise it only if a sample" in evidence.reason


def test_violations_after_the_first_are_counted_as_intervals() -> None:
    log = recorded([NEAR, FAR] * 4, [MOVING] * 8)
    evidence = audited("whenever near the rover shall immediately satisfy still", log)
    assert "; the first of 4 intervals" in evidence.reason


def test_a_damaged_log_shows_no_pass_but_a_violation() -> None:
    good = recorded([FAR, NEAR, FAR, FAR], [MOVING, MOVING, MOVING, STILL])
    bad = recorded([FAR, NEAR, FAR, FAR, FAR], [MOVING] * 5)
    assert audited(EVENTUALLY, replace(good, intact=False)).verdict == "no data"
    assert audited(WITHIN, replace(bad, intact=False)).verdict == "violated"


def test_ticks_in_a_gap_are_unknown() -> None:
    whole = recorded([FAR, NEAR, FAR, FAR], [MOVING, STILL, STILL, STILL])
    assert audited(WITHIN, whole).verdict == "satisfied"
    assert audited(WITHIN, replace(whole, gaps=((S, 2 * S),))).verdict == "no data"


@pytest.mark.parametrize(
    ("sentence", "verdict"),
    [
        ("whenever near the rover shall within 3 seconds satisfy still", "inconclusive"),
        ("whenever near the rover shall after 2 seconds satisfy still", "inconclusive"),
        ("whenever near the rover shall for 3 seconds satisfy !still", "inconclusive"),
    ],
)
def test_a_log_that_ends_before_the_deadline_decides_nothing(sentence: str, verdict: str) -> None:
    log = recorded([FAR, NEAR, FAR, FAR], [MOVING] * 4, end=3.1)
    assert audited(sentence, log).verdict == verdict


def test_a_trigger_after_the_last_whole_tick_leaves_the_run_open() -> None:
    log = recorded([FAR] * 3, [MOVING] * 3, end=2.5)
    late = Samples(np.append(log.samples["d"].times, int(2.4 * S)), np.array([FAR] * 3 + [NEAR]))
    evidence = audited(EVENTUALLY, replace(log, samples={**log.samples, "d": late}))
    assert evidence.verdict == "inconclusive"
    assert evidence.reason == "what came after the last whole tick leaves it open"


def test_the_record_is_plain_json_with_times_in_nanoseconds() -> None:
    record = plain(as_record(audited(WITHIN, recorded([FAR, NEAR, FAR, FAR], [MOVING] * 4))))
    (violation,) = record["violations"]
    assert (violation["start_ns"], violation["end_ns"]) == (3 * S, 3 * S)
    assert record["triggers"] == ({"tick": 1, "ns": S, "seconds": 1.0},)
    assert record["hashes"]["log"] == "ab"


def test_the_signals_of_propositions_are_named_once_in_order() -> None:
    assert signals_of(declare(BINDINGS), ["still", "near", "still"]) == ("v", "d")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cm", "where"),
    [
        (3.4, None),
        (3.5, "below"),
        (4.4, "below"),
        (4.6, "at"),
        (5.4, "at"),
        (5.6, "above"),
        (6.4, "above"),
        (6.6, None),
        (float("nan"), None),
    ],
)
def test_a_number_is_at_a_threshold_by_its_rounded_value_where_the_comparison_decides(
    cm: float, where: str | None
) -> None:
    bindings = declare(BINDINGS)
    sentence = "whenever near the rover shall immediately satisfy still"
    ((entry,), _) = requirements(Source("R1.fret", sentence))
    requirement, _ = formalize(entry, bindings)
    assert requirement is not None
    watched = MonitoredRequirement(
        load("monitor", text(requirement)),
        HASHES | {"sentence": requirement.fingerprint},
        situations=situations(requirement),
    )

    def places(speed: float) -> dict[str, list[str]]:
        (found,) = audit(recorded([FAR, cm / 100, FAR], [speed] * 3), bindings, [watched])
        assert found.situations is not None
        return {
            name: [
                key.split(":")[0].removeprefix("threshold-")
                for key, at in moments.items()
                if key.startswith("threshold-")
                and ":condition:near:" in key
                and (at.tick == 1 or name == "seen")
            ]
            for name, moments in (
                ("seen", found.situations.seen),
                ("perhaps", found.situations.perhaps),
            )
        }

    assert places(MOVING)["seen"] == ([] if where is None else [where])
    assert places(STILL)["seen"] == []  # the answer is there, whether it is demanded or not
    unknown = ["below", "at", "above"] if cm != cm else []
    assert places(MOVING)["perhaps"] == unknown
    assert places(STILL)["perhaps"] == []


def test_without_a_list_of_situations_they_are_not_measured() -> None:
    assert audited(WITHIN, recorded([FAR, NEAR], [MOVING, STILL])).situations is None
