import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fretc.logs.signals.outline import blind_share, distances
from fretc.logs.signals.signals import FieldError, blind_zones, nearest, sample
from fretish.bindings.declarations import Declarations, Signal
from fretish.diagnostics.diagnostic import Code, Severity
from tests.fretc.logs.logs import declare

NAN, INF = float("nan"), float("inf")


def signal(fields: str, path: str = "/scan.ranges[:]") -> Signal:
    text = f'[clock]\ntick = "100 ms"\n[signal.s]\npath = "{path}"\n{fields}'
    return declare(text).signals["s"]


def laser(ranges: list[float], **fields: Any) -> SimpleNamespace:
    """A scan as it is decoded: 32-bit floats as Python floats."""
    return SimpleNamespace(
        **{
            "range_min": float(np.float32(0.1)),
            "range_max": float(np.float32(10.0)),
            "angle_min": 0.0,
            "angle_increment": math.pi / 2,
            "ranges": [float(np.float32(r)) for r in ranges],
            **fields,
        }
    )


VALID = 'valid = "range_min <= x and x <= range_max"\n'
SCAN = f'type = "sensor_msgs/LaserScan"\nreduce = "min"\nunit = "m"\n{VALID}'


# Readings of a scan


def test_a_nan_beam_says_nothing_and_the_others_decide() -> None:
    assert sample(signal(SCAN), laser([NAN, 2.0, NAN, 0.5])) == 0.5


def test_all_nan_or_empty_is_unknown_and_never_far() -> None:
    assert math.isnan(sample(signal(SCAN), laser([NAN, NAN])))
    assert math.isnan(sample(signal(SCAN), laser([])))


def test_all_plus_infinity_is_known_to_be_free() -> None:
    assert sample(signal(SCAN), laser([INF, INF])) == INF


def test_minus_infinity_is_too_near_to_measure() -> None:
    assert sample(signal(SCAN), laser([3.0, -INF])) == -INF


def test_readings_out_of_range_are_dropped_by_default_for_a_scan() -> None:
    assert sample(signal(SCAN), laser([0.0, 3.0, 0.05, 101.0])) == 3.0
    assert math.isnan(sample(signal(SCAN), laser([0.0, 101.0])))


@pytest.mark.parametrize(
    ("reading", "expected"), [("far", 3.0), ("near", -INF), ("drop", 3.0), ("unknown", NAN)]
)
def test_a_zero_that_means_no_return_is_read_as_declared(reading: str, expected: float) -> None:
    declared = signal(SCAN + f'invalid = {{ other = "{reading}" }}\n')
    assert sample(declared, laser([0.0, 3.0])) == pytest.approx(expected, nan_ok=True)


def test_far_alone_is_far() -> None:
    assert sample(signal(SCAN + 'invalid = { other = "far" }\n'), laser([101.0])) == INF


def test_other_arrays_are_unknown_with_one_unknown_element() -> None:
    declared = signal('reduce = "max"\n', "/joints.position[:]")
    assert sample(declared, SimpleNamespace(position=[1.0, 2.0])) == 2.0
    assert math.isnan(sample(declared, SimpleNamespace(position=[1.0, NAN])))


def test_the_limits_of_a_sensor_belong_to_the_range_as_32_bit_floats() -> None:
    lowest, highest = float(np.float32(0.1)), float(np.float32(10.0))
    assert sample(signal(SCAN), laser([lowest])) == lowest
    assert sample(signal(SCAN), laser([highest])) == highest


def test_a_number_in_valid_is_compared_with_32_bit_floats_as_one_of_them() -> None:
    declared = signal(SCAN.replace("range_max", "0.3"))
    assert float(np.float32(0.3)) > 0.3
    assert sample(declared, laser([0.3]), single=True) == float(np.float32(0.3))


def test_valid_is_read_in_the_unit_of_the_field() -> None:
    declared = signal('reduce = "min"\nunit = "cm"\nvalid = "x < 20 mm"\n')
    message = SimpleNamespace(ranges=[1.0, 3.0])
    assert math.isnan(sample(declared, message))  # 3 cm is unknown, and so is the sample
    assert sample(declared, SimpleNamespace(ranges=[1.0, 1.5])) == 1.0


@pytest.mark.parametrize(
    ("valid", "greatest"),
    [("x * x < 4 m^2", 199.0), ("x <= 50 % * range_max", 500.0)],
)
def test_valid_may_compute_in_the_unit_of_the_field(valid: str, greatest: float) -> None:
    declared = signal(f'unit = "cm"\nvalid = "{valid}"\n', "/t.x")
    assert sample(declared, SimpleNamespace(x=greatest, range_max=1000.0)) == greatest
    assert math.isnan(sample(declared, SimpleNamespace(x=greatest + 1, range_max=1000.0)))


def test_a_limit_that_is_nan_makes_no_reading_valid() -> None:
    assert math.isnan(sample(signal(SCAN), laser([1.0], range_max=NAN)))


# Paths


def test_the_mean_and_an_index_are_in_the_unit_of_the_field() -> None:
    message = SimpleNamespace(position=[10.0, 20.0, 60.0])
    assert sample(signal('reduce = "mean"\nunit = "cm"\n', "/j.position[:]"), message) == 30.0
    assert sample(signal('unit = "cm"\n', "/j.position[2]"), message) == 60.0
    assert math.isnan(sample(signal("", "/j.position[3]"), message))


def test_truth_values_are_one_and_zero() -> None:
    assert sample(signal("", "/stop.data"), SimpleNamespace(data=True)) == 1.0
    assert sample(signal("", "/stop.data"), SimpleNamespace(data=False)) == 0.0


@pytest.mark.parametrize("number", [2**53, 2**53 + 1, 2**64 - 1, -(2**53) - 1, -(2**63)])
def test_whole_numbers_that_64_bit_floats_do_not_hold_stay_what_they_are(number: int) -> None:
    alone = SimpleNamespace(n=number, a=[1, number, 0])
    assert sample(signal("", "/t.n"), alone) == number
    assert sample(signal('valid = "x != 7"\n', "/t.n"), alone) == number
    assert sample(signal("", "/t.a[1]"), alone) == number
    end = "max" if number > 0 else "min"
    assert sample(signal(f'reduce = "{end}"\n', "/t.a[:]"), alone) == number


def test_a_whole_number_beside_fractions_stays_what_it_is() -> None:
    for beside in (0.5, -1, 2**64 - 1):
        message = SimpleNamespace(a=[beside, 2**63 + 1])
        assert sample(signal("", "/t.a[1]"), message) == 2**63 + 1
        assert sample(signal('reduce = "min"\n', "/t.a[:]"), message) == min(beside, 2**63 + 1)


def test_valid_tells_whole_numbers_of_64_bits_apart() -> None:
    declared = signal('valid = "x < 9007199254740993"\n', "/t.n")
    assert sample(declared, SimpleNamespace(n=2**53)) == 2**53
    assert math.isnan(sample(declared, SimpleNamespace(n=2**53 + 1)))


def test_whole_numbers_in_valid_are_not_rounded_to_32_bits() -> None:
    declared = signal('valid = "x < 16777217"\n', "/t.n")
    assert sample(declared, SimpleNamespace(n=16777216)) == 16777216


def test_bytes_are_numbers() -> None:
    assert sample(signal('reduce = "max"\n', "/a.data[:]"), SimpleNamespace(data=b"\1\xff")) == 255


def test_a_dropped_scalar_is_unknown_and_an_infinite_one_is_read_as_declared() -> None:
    declared = signal('invalid = { "+inf" = "far", "-inf" = "drop" }\n', "/x.data")
    assert sample(declared, SimpleNamespace(data=INF)) == INF
    assert math.isnan(sample(declared, SimpleNamespace(data=-INF)))
    assert math.isnan(sample(declared, SimpleNamespace(data=NAN)))


@pytest.mark.parametrize(
    ("path", "message", "help_"),
    [
        ("/t.twist.linera.x", "`twist` has no field `linera`", "did you mean `linear`?"),
        ("/t.speed", "the message has no field `speed`", "it has twist, names, values"),
        ("/t.twist", "`twist` is no number", "it has linear"),
        ("/t.values", "`values` is an array", "write `values[0]`, or `values[:]` with `reduce`"),
        ("/t.twist.linear.x[0]", "`twist.linear.x` is no array", "leave out the index"),
        ("/t.names[0]", "`names` is no array of numbers", None),
    ],
)
def test_what_is_no_number_is_told(path: str, message: str, help_: str | None) -> None:
    linear = SimpleNamespace(x=1.0)
    sent = SimpleNamespace(
        twist=SimpleNamespace(linear=linear), names=["a", "b"], values=[1.0, 2.0]
    )
    with pytest.raises(FieldError) as error:
        sample(signal("", path), sent)
    assert (str(error.value), error.value.fix) == (message, help_)


@pytest.mark.parametrize("valid", ["x < 1 for 200 ms", "x < limit"])
def test_a_valid_that_cannot_be_evaluated_is_told(valid: str) -> None:
    declared = signal(f'reduce = "min"\nvalid = "{valid}"\n')
    with pytest.raises(FieldError):
        sample(declared, SimpleNamespace(ranges=[1.0]))


# The outline

SQUARE = ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0))
HORSESHOE = ((2.0, 2.0), (-2.0, 2.0), (-2.0, -2.0), (2.0, -2.0), (2.0, -1.0), (-1.0, -1.0),
             (-1.0, 1.0), (2.0, 1.0))  # fmt: skip


def outline(extra: str = "", corners: str = "[[1, 1], [-1, 1], [-1, -1], [1, -1]]") -> Signal:
    return signal(
        f'type = "sensor_msgs/LaserScan"\nreduce = "outline"\nunit = "m"\nfootprint = {corners}\n'
        f"{VALID}{extra}"
    )


def test_clearance_is_measured_from_the_outline_and_not_from_the_sensor() -> None:
    assert sample(outline(), laser([1.5, 3.0, 4.0, 5.0])) == pytest.approx(0.5)


def test_the_same_range_is_nearer_where_the_outline_is_farther() -> None:
    ahead = laser([1.42], angle_min=0.0)
    corner = laser([1.42], angle_min=math.pi / 4)
    assert sample(outline(), ahead) == pytest.approx(0.42)
    assert sample(outline(), corner) == pytest.approx(1.42 - math.sqrt(2), abs=1e-6)


def test_the_pose_of_the_sensor_counts() -> None:
    declared = outline("sensor = [1.0, 0.0, 1.5707963267948966]\n")
    assert sample(declared, laser([3.0])) == pytest.approx(2.0)  # to the left of (1, 0)


def test_beams_keep_their_angles_when_others_are_dropped() -> None:
    assert sample(outline(), laser([NAN, NAN, 4.0, NAN])) == pytest.approx(3.0)
    declared = outline("sensor = [0.5, 0.0, 0.0]\n")
    assert sample(declared, laser([NAN, NAN, 4.0, NAN])) == pytest.approx(2.5)


def test_what_is_near_or_inside_has_no_clearance_and_what_is_far_has_infinitely_much() -> None:
    assert sample(outline(), laser([-INF, 5.0])) == 0.0
    assert sample(outline(), laser([0.5, 5.0])) == 0.0
    assert sample(outline(), laser([INF, INF])) == INF
    assert math.isnan(sample(outline(), laser([NAN])))


def test_angles_that_are_nan_make_the_clearance_unknown() -> None:
    assert math.isnan(sample(outline(), laser([5.0], angle_increment=NAN)))


def slow_distance(x: float, y: float, corners: tuple[tuple[float, float], ...]) -> float:
    """By walking along the edges, and by the angle that the outline winds around the point."""
    turned, best = 0.0, INF
    for (x1, y1), (x2, y2) in zip(corners, corners[1:] + corners[:1], strict=True):
        for i in range(2001):
            part = i / 2000
            best = min(best, math.hypot(x1 + part * (x2 - x1) - x, y1 + part * (y2 - y1) - y))
        turned += math.remainder(
            math.atan2(y2 - y, x2 - x) - math.atan2(y1 - y, x1 - x), 2 * math.pi
        )
    return 0.0 if abs(turned) > math.pi else best


@pytest.mark.slow
@settings(deadline=None)
@given(st.floats(-4, 4), st.floats(-4, 4), st.sampled_from([SQUARE, SQUARE[::-1], HORSESHOE]))
@example(0.0, 0.0, HORSESHOE)
@example(2.5, 0.0, HORSESHOE)
@example(1.5, 1.5, SQUARE)
def test_distances_agree_with_a_walk_along_the_outline(
    x: float, y: float, corners: tuple[tuple[float, float], ...]
) -> None:
    (found,) = distances(np.array([[x, y]]), corners)
    assert found == pytest.approx(slow_distance(x, y, corners), abs=2e-3)


# Blind zones


def bound(expression: str, reduce: str, extra: str = "") -> Declarations:
    shape = "footprint = [[1, 1], [-1, 1], [-1, -1], [1, -1]]\n" if reduce == "outline" else ""
    return declare(
        f'[clock]\ntick = "100 ms"\n[signal.gap]\npath = "/scan.ranges[:]"\nreduce = "{reduce}"\n'
        f'unit = "m"\n{shape}{extra}[proposition.close]\nexpr = "{expression}"\n'
    )


def warnings(declarations: Declarations, limit: float) -> list[str]:
    found = blind_zones(declarations.propositions["close"], declarations, {"gap": limit})
    assert all(d.code is Code.BLIND_ZONE and d.severity is Severity.WARNING for d in found)
    return [diagnostic.message for diagnostic in found]


def test_a_bound_below_the_least_range_is_blind() -> None:
    declarations = bound("gap < 5 cm", "min")
    assert warnings(declarations, 0.2) == [
        "`close` compares `gap` with 0.05 m, and `/scan` reports nothing nearer than 0.2 m: an "
        "obstacle nearer than the bound is not detected"
    ]
    (diagnostic,) = blind_zones(declarations.propositions["close"], declarations, {"gap": 0.2})
    assert diagnostic.span is not None
    assert diagnostic.span.text == '"gap < 5 cm"'


@pytest.mark.parametrize(
    ("expression", "blind"),
    [
        ("gap < 20 cm", True),
        ("gap <= 20 cm", False),
        ("20 cm > gap", True),
        ("gap >= 20 cm", True),
        ("gap > 20 cm", False),
        ("gap < 21 cm", False),
        ("not (gap > 2 * 5 cm)", True),
        ("gap < 5 cm for 200 ms", True),
        ("gap != 5 cm", False),
    ],
)
def test_the_very_bound_can_be_seen_only_where_it_is_included(expression: str, blind: bool) -> None:
    assert bool(warnings(bound(expression, "min"), 0.2)) is blind


def test_where_other_readings_count_as_near_nothing_is_blind() -> None:
    assert not warnings(bound("gap < 5 cm", "min", 'invalid = { other = "near" }\n'), 0.2)


def test_around_an_outline_only_some_directions_may_be_blind() -> None:
    # The square reaches from 1 m (ahead) to 1.41 m (corners) from the sensor.
    assert warnings(bound("gap < 5 cm", "outline"), 1.0) == []
    (some,) = warnings(bound("gap < 5 cm", "outline"), 1.2)
    share = 4 * 2 * math.degrees(math.acos(1.05 / 1.2))
    assert some.endswith(f"is not detected in {round(share)} of 360 degrees")
    (everywhere,) = warnings(bound("gap < 5 cm", "outline"), 2.0)
    assert everywhere.endswith("is not detected")


def test_a_direction_in_which_the_sensor_looks_at_the_outline_is_not_blind() -> None:
    # From the middle of the horseshoe only the opening (26.57 degrees to either side) has no
    # part of the outline in it, and its corners are within 5 cm of the outermost 1.28 degrees.
    share = blind_share(0.05, 0.5, HORSESHOE, (0.0, 0.0, 0.0))
    assert share * 360 == pytest.approx(2 * (26.57 - 1.28), abs=0.2)
    assert blind_share(0.05, 0.5, SQUARE, (0.0, 0.0, 0.0)) == 0.0


def test_only_the_nearest_of_many_readings_has_a_least_range() -> None:
    assert nearest(signal(SCAN), laser([1.0], range_min=0.25)) == 0.25
    assert nearest(signal(SCAN.replace('min"', 'max"', 1)), laser([1.0])) is None
    assert nearest(signal(SCAN), SimpleNamespace(ranges=[1.0])) is None
