import re

import pytest

from compiler.files.records import replace
from fretc.audit.evidence.schema import Hashes, Health, Moment, Result
from fretc.audit.measurements.unknown_inputs import UnknownInput
from fretc.report.model.pictures import SpanMark
from fretc.report.pictures.timeline import DETAIL, answered, timelines
from tests.fretc.audit.results import moment, violation

EMPTY = Result(
    run="a.mcap",
    requirement="R1",
    verdict="satisfied",
    finite=True,
    reason="",
    clock="100 ms, by log_time",
    ticks=100,
    start_ns=0,
    end_ns=10**10,
    states=(),
    answers=(),
    triggers=(),
    violations=(),
    unknown=(),
    open=(),
    latencies=(),
    exercised=0,
    latency_median_s=None,
    latency_max_s=None,
    propositions={},
    thresholds=(),
    units={},
    fingerprints=Hashes(sentence="", bindings="", monitor=""),
    health=Health(True, 1, None, (), (), {}),
    assumptions=(),
)


def at(*ticks: int) -> tuple[Moment, ...]:
    return tuple(moment(tick, tick / 10) for tick in ticks)


def test_a_run_without_violation_is_one_picture() -> None:
    result = replace(EMPTY, triggers=at(10, 11, 40), latencies=(2.5, 2.4, 0.0), unknown=((5, 6),))
    (picture,) = timelines(result, 0.1)
    assert (picture.title, picture.start, picture.end) == ("The whole run", 0.0, 10.0)
    assert {lane.name: lane.marks for lane in picture.lanes} == {
        "triggered": (SpanMark(1.0, 1.2, 2), SpanMark(4.0, 4.1, 1)),
        "waiting": (SpanMark(1.0, 3.5, 2),),
        "unknown": (SpanMark(0.5, 0.7, 1),),
    }
    assert picture.text == (
        "From 0 s to 10 s: 3 ticks with a trigger (1 s to 1.2 s and 4 s to 4.1 s), "
        "2 triggers waiting for their response (1 s to 3.5 s) and "
        "1 interval of unknown ticks (0.5 s to 0.7 s)."
    )


def test_a_violation_is_shown_with_its_trigger_and_some_ticks_around() -> None:
    broken = violation(moment(50, 5.0), moment(59, 5.9), moment(40, 4.0))
    result = replace(EMPTY, verdict="violated", triggers=at(5, 40), violations=(broken,))
    (picture,) = timelines(result, 0.1)
    assert (picture.title, picture.start, picture.end) == ("Violation 1", 2.0, 8.0)
    assert {lane.name: lane.marks for lane in picture.lanes} == {
        "triggered": (SpanMark(4.0, 4.1, 1),),
        "violated": (SpanMark(5.0, 6.0, 1),),
    }


def test_a_violation_of_always_is_shown_around_itself_and_goes_on_at_a_torn_edge() -> None:
    broken = violation(moment(500, 50.0), moment(990, 99.0), moment(0, 0.0))
    result = replace(EMPTY, ticks=1000, verdict="violated", violations=(broken,))
    (picture,) = timelines(result, 0.1)
    assert (picture.start, picture.end, picture.continues) == (48.0, 72.0, 99.1)
    assert picture.flags == ()  # the trigger is before the picture
    assert "The violation goes on to 99.1 s." in picture.text


def test_a_deadline_keeps_its_trigger_in_the_picture() -> None:
    at_end = violation(moment(150, 15.0), moment(150, 15.0), moment(50, 5.0), moment(149, 14.9))
    (picture,) = timelines(replace(EMPTY, ticks=200, violations=(at_end,)), 0.1)
    assert (picture.start, picture.end, picture.continues) == (3.0, 17.1, None)
    assert [flag.kind for flag in picture.flags] == ["trigger", "deadline"]


def test_an_open_demand_reaches_to_the_end() -> None:
    (picture,) = timelines(replace(EMPTY, triggers=at(90), open=at(90)), 0.1)
    assert picture.lanes[-1].name == "open at end"
    assert picture.lanes[-1].marks == (SpanMark(9.0, 10.0, 1),)


def test_a_run_without_ticks_has_no_picture() -> None:
    assert timelines(replace(EMPTY, ticks=0), 0.1) == ()


def test_a_run_without_trigger_says_so() -> None:
    (picture,) = timelines(EMPTY, 0.1)
    assert picture.text == "From 0 s to 10 s: no tick with a trigger."


@pytest.mark.slow
def test_a_hundred_thousand_triggers_are_few_marks_and_all_counted() -> None:
    ticks = range(0, 1_000_000, 10)
    result = replace(EMPTY, ticks=1_000_000, triggers=at(*ticks))
    (picture,) = timelines(result, 0.1)
    (lane,) = picture.lanes
    assert len(lane.marks) <= DETAIL
    assert sum(mark.count for mark in lane.marks) == 100_000
    assert len(picture.text) < 200


def test_marks_that_stand_apart_stay_apart() -> None:
    ticks = range(0, 1_000_000, 10_000)
    (picture,) = timelines(replace(EMPTY, ticks=1_000_000, triggers=at(*ticks)), 0.1)
    assert len(picture.lanes[0].marks) == 100


def test_only_the_first_violations_get_a_picture() -> None:
    broken = tuple(violation(at_once, at_once) for at_once in at(*range(90)))
    pictures = timelines(replace(EMPTY, violations=broken), 0.1)
    assert [re.sub(r"\D", "", picture.title) for picture in pictures] == [
        str(number) for number in range(1, 7)
    ]


def test_latencies_belong_to_the_triggers_that_are_not_open() -> None:
    result = replace(EMPTY, triggers=at(1, 2, 3), open=at(2), latencies=(0.5, 0.1))
    assert answered(result) == [(moment(1, 0.1), 0.5), (moment(3, 0.3), 0.1)]


def test_latencies_that_fit_no_triggers_belong_to_none() -> None:
    assert answered(replace(EMPTY, triggers=at(1, 2), latencies=(0.5,))) == []


def unknown_input(proposition: str, first: int, last: int) -> UnknownInput:
    ends = (first * 10**8, last * 10**8, first / 10, last / 10)
    return UnknownInput(first, last, *ends, proposition=proposition, signal="scan", cause="lost")


def test_each_proposition_that_was_unknown_has_a_lane_with_its_stretches() -> None:
    inputs = (unknown_input("near", 20, 29), unknown_input("fast", 25, 25))
    (picture,) = timelines(
        replace(EMPTY, unknown_inputs=(*inputs, unknown_input("near", 50, 50))), 0.1
    )
    lanes = {lane.name: lane.marks for lane in picture.lanes if lane.kind == "unknown"}
    assert lanes == {
        "near": (SpanMark(2.0, 3.0, 1), SpanMark(5.0, 5.1, 1)),
        "fast": (SpanMark(2.5, 2.6, 1),),
    }
    assert picture.text == (
        "From 0 s to 10 s: no tick with a trigger, `near` unknown (2 s to 3 s and 5 s to 5.1 s) "
        "and `fast` unknown (2.5 s to 2.6 s)."
    )


def test_many_unknown_propositions_share_a_lane() -> None:
    inputs = tuple(unknown_input(f"p{n}", 10 * n, 10 * n) for n in range(6))
    (picture,) = timelines(replace(EMPTY, unknown_inputs=inputs), 0.1)
    lanes = {lane.name: len(lane.marks) for lane in picture.lanes if lane.kind == "unknown"}
    assert lanes == {"p0": 1, "p1": 1, "p2": 1, "other inputs": 3}
