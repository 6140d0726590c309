from math import inf

from compiler.files.records import replace
from fretc.audit.evidence.samples import RunPart, SignalSamples, WordSeries
from fretc.audit.evidence.schema import Instant, ThresholdRecord, Violation
from fretc.report.model.pictures import SignalPiece, SpanMark, ThresholdLine
from fretc.report.pictures.signals import left_out, panels, word_lanes
from fretc.report.pictures.timeline import cause, timelines
from tests.fretc.audit.results import moment
from tests.fretc.audit.results import violation as violation_of
from tests.fretc.report.pictures.test_timeline import EMPTY, at

NEAR = ThresholdRecord(
    "near", "clearance", "<", 0.05, "m", 0.01, 2.0, "crossed", None, Instant(0, 0.0)
)
SLOW = ThresholdRecord(
    "slow", "abs(vx)", "<=", 0.15, "m/s", 0.0, 0.4, "crossed", None, Instant(0, 0.0)
)
S = 10**9
RESULT = replace(EMPTY, thresholds=(NEAR, SLOW), units={"clearance": "m", "vx": "m/s"})


def broken(**samples: SignalSamples[float]) -> Violation:
    return violation_of(
        moment(123, 12.3),
        moment(125, 12.5),
        moment(110, 11.0),
        moment(123, 12.3),
        "stopped",
        {"clearance": 0.032},
        RunPart(10.0, 13.3, samples),
    )


def test_a_value_is_in_force_until_the_next_or_until_it_is_too_old() -> None:
    samples = SignalSamples((9.9, 10.2, 11.0), (1.0, 2.0, 0.01))
    (panel,) = panels(broken(clearance=samples), RESULT, {"clearance": 0.5}, 10.0, 12.0)
    assert panel.pieces == (
        SignalPiece(((10.0, 1.0, 1.0), (10.2, 2.0, 2.0)), 10.7),
        SignalPiece(((11.0, 0.01, 0.01),), 11.5),
    )
    assert panel.unknown == (SpanMark(10.7, 11.0, 1), SpanMark(11.5, 12.0, 1))
    assert panel.levels == (ThresholdLine(0.05, "< 0.05 m"),)
    assert panel.low < 0.01
    assert panel.high > 2.0


def test_before_the_first_sample_and_where_it_says_so_a_signal_is_unknown() -> None:
    (panel,) = panels(broken(x=SignalSamples((11.0, 11.5), (1.0, None))), RESULT, {}, 10.0, 12.0)
    assert panel.unknown == (SpanMark(10.0, 11.0, 1), SpanMark(11.5, 12.0, 1))


def test_a_signal_without_a_sample_is_unknown_throughout() -> None:
    (panel,) = panels(broken(x=SignalSamples((), ())), RESULT, {"x": 0.5}, 10.0, 12.0)
    assert panel.unknown == (SpanMark(10.0, 12.0, 1),)
    assert panel.pieces == ()


def test_an_infinite_value_is_neither_drawn_as_a_number_nor_unknown() -> None:
    (panel,) = panels(
        broken(clearance=SignalSamples((10.0, 11.0), (inf, 1.0))), RESULT, {}, 10.0, 12.0
    )
    assert panel.infinite == ((10.0, 11.0, "+inf"),)
    assert panel.unknown == ()
    assert panel.pieces == (SignalPiece(((11.0, 1.0, 1.0),), 12.0),)


def test_a_threshold_on_the_absolute_value_has_two_lines() -> None:
    (panel,) = panels(broken(vx=SignalSamples((10.0,), (0.1,))), RESULT, {}, 10.0, 12.0)
    assert panel.levels == (ThresholdLine(0.15, "|vx| <= 0.15 m/s"), ThresholdLine(-0.15, ""))


def test_a_threshold_in_another_unit_is_not_drawn() -> None:
    result = replace(RESULT, units={"clearance": "rad"})
    (panel,) = panels(broken(clearance=SignalSamples((10.0,), (0.1,))), result, {}, 10.0, 12.0)
    assert panel.levels == ()


def test_samples_that_fall_together_become_an_envelope_and_the_last_stays_in_force() -> None:
    samples = SignalSamples((10.0, 10.001, 10.002), (0.5, 2.0, 1.0))
    (panel,) = panels(broken(x=samples), RESULT, {}, 10.0, 34.0)
    assert panel.pieces == (SignalPiece(((10.0, 0.5, 2.0), (10.1, 1.0, 1.0)), 34.0),)


def test_thinned_samples_are_no_gaps_but_a_long_silence_is() -> None:
    """Fifty of six hundred samples stand further apart than those of the log."""
    times = [10.0 + 0.2 * i for i in range(25)] + [16.0 + 0.2 * i for i in range(25)]
    samples = SignalSamples(tuple(times), (1.0,) * 50)
    (panel,) = panels(broken(x=samples), RESULT, {"x": 0.1}, 10.0, 20.5)
    assert panel.unknown == (SpanMark(15.3, 16.0, 1),)


def test_four_signals_are_drawn_those_with_a_threshold_first_and_the_others_named() -> None:
    one = SignalSamples((10.0,), (1.0,))
    violation = broken(a=one, b=one, c=one, d=one, clearance=one)
    drawings = panels(violation, RESULT, {}, 10.0, 12.0)
    assert [panel.signal for panel in drawings] == ["clearance", "a", "b", "c"]
    assert left_out(violation, drawings) == ("d",)


def test_a_signal_of_words_is_a_lane_with_what_is_unknown() -> None:
    series = WordSeries((9 * S, 10_500_000_000, 11 * S), ("drive", "docking", None))
    violation = broken()
    assert violation.surroundings is not None
    around = replace(violation.surroundings, words={"mode": series})
    violation = replace(violation, surroundings=around)
    (lane,) = word_lanes(violation, {"mode": 1.2}, 10.0, 13.0)
    assert lane.words == (
        (10.0, 10.2, "drive"),
        (10.2, 10.5, None),
        (10.5, 11.0, "docking"),
        (11.0, 13.0, None),
    )
    assert left_out(violation, (), (lane,)) == ()
    assert left_out(violation, ()) == ("mode",)


def test_a_violation_without_samples_has_no_panel() -> None:
    assert panels(replace(broken(), surroundings=None), RESULT, {}, 10.0, 12.0) == ()


def test_the_picture_marks_trigger_deadline_and_the_broken_stretch() -> None:
    violation = broken(clearance=SignalSamples((9.0,), (0.032,)))
    result = replace(RESULT, ticks=200, triggers=at(110), violations=(violation,))
    (picture,) = timelines(result, 0.1)
    assert (picture.start, picture.end) == (10.0, 13.3)
    assert [(flag.kind, flag.at) for flag in picture.flags] == [
        ("trigger", 11.0),
        ("deadline", 12.3),
    ]
    assert picture.broken == SpanMark(12.3, 12.6, 1)


def test_the_cause_says_what_did_not_come_and_what_the_signals_were() -> None:
    assert cause(broken(), RESULT, {}) == (
        "`stopped` was not true by 12.3 s, triggered at 11 s; at 12.3 s clearance was 0.032 m."
    )
    endless = replace(broken(), deadline=None, trigger=None, values={})
    assert cause(endless, RESULT, {}) == "`stopped` was false from 12.3 s to 12.6 s (300 ms)."
    far = replace(broken(clearance=SignalSamples((9.0,), (inf,))), values={"clearance": None})
    assert cause(far, RESULT, {}).endswith("at 12.3 s clearance was +inf.")


def test_a_crossing_too_small_to_see_has_an_enlarged_panel() -> None:
    samples = SignalSamples((10.0, 12.3), (2.0, 0.049))
    whole, part = panels(broken(clearance=samples), RESULT, {}, 10.0, 13.0)
    assert (whole.is_enlarged, part.is_enlarged) == (False, True)
    assert (round(part.low, 6), round(part.high, 6)) == (0.046, 0.054)
    assert part.levels == (ThresholdLine(0.05, "< 0.05 m"),)
    assert part.pieces == whole.pieces


def test_a_crossing_that_can_be_seen_has_one_panel() -> None:
    samples = SignalSamples((10.0, 12.3), (0.3, 0.01))
    assert len(panels(broken(clearance=samples), RESULT, {}, 10.0, 13.0)) == 1


def test_a_bound_that_must_hold_for_some_time_says_for_how_long() -> None:
    samples = SignalSamples((10.0, 12.3), (0.3, 0.01))
    held = {("near", "clearance"): " for 500 ms"}
    (panel,) = panels(broken(clearance=samples), RESULT, {}, 10.0, 13.0, held)
    assert panel.levels == (ThresholdLine(0.05, "< 0.05 m for 500 ms"),)
