import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from simulation.nodes.safety import TooClose, outline_clearance, stop_requested
from simulation.world.lidar import Lidar
from simulation.world.scene import ROBOT

LIDAR = Lidar()
NAN, INF = math.nan, math.inf
NEAREST = float(np.float32(0.12))


def scan(value: float, **beams: float) -> NDArray[np.float32]:
    """All beams say `value`, except `b<number>`."""
    ranges = np.full(LIDAR.beams, value, np.float32)
    for name, other in beams.items():
        ranges[int(name[1:])] = other
    return ranges


def clearance(ranges: NDArray[np.float32]) -> float:
    return outline_clearance(ranges, LIDAR, ROBOT)


def test_clearance_ahead_is_range_minus_half_the_length() -> None:
    assert clearance(scan(INF, b180=1.0)) == pytest.approx(1.0 - 0.306)


def test_clearance_to_the_left_is_range_minus_half_the_width() -> None:
    assert clearance(scan(INF, b270=1.0)) == pytest.approx(1.0 - 0.290)


def test_what_is_seen_at_a_corner_is_nearer_than_the_range_tells() -> None:
    # 0.45 m at 45 degrees is (0.3182, 0.3182): 1.22 cm and 2.82 cm beyond the corner.
    assert clearance(scan(INF, b225=0.45)) == pytest.approx(math.hypot(0.0122, 0.0282), abs=1e-4)


def test_a_return_inside_the_outline_leaves_no_clearance() -> None:
    assert clearance(scan(INF, b180=0.25)) == 0.0


def test_too_near_to_measure_leaves_no_clearance() -> None:
    assert clearance(scan(5.0, b10=-INF)) == 0.0
    assert clearance(scan(5.0, b10=0.1)) == 0.0


def test_nothing_in_reach_is_known_to_be_free() -> None:
    assert clearance(scan(INF)) == INF
    assert clearance(scan(12.5, b10=INF)) == INF


@pytest.mark.parametrize(
    "ranges", [scan(NAN), scan(12.5), scan(0.0), scan(-1.0), np.zeros(0, np.float32)], ids=str
)
def test_no_answer_from_any_beam_is_unknown(ranges: NDArray[np.float32]) -> None:
    assert math.isnan(clearance(ranges))


@pytest.mark.parametrize("nan_beam", [0, 179, 181, 359])
def test_a_beam_without_answer_hides_no_other(nan_beam: int) -> None:
    ranges = scan(5.0, b180=0.33)
    ranges[nan_beam] = NAN
    assert clearance(ranges) == pytest.approx(0.33 - 0.306)


@given(
    st.lists(
        st.one_of(
            st.floats(0.125, 12.0, width=32), st.sampled_from([NEAREST, INF, NAN, 0.0, 13.0])
        ),
        min_size=1,
        max_size=360,
    ).filter(lambda values: any(NEAREST <= value <= 12.0 for value in values))
)
def test_clearance_is_the_least_distance_from_a_point_to_the_rectangle(
    values: list[float],
) -> None:
    ranges = np.array(values, np.float32)
    points = [
        (value * math.cos(turn), value * math.sin(turn))
        for beam, value in enumerate(ranges.tolist())
        for turn in [math.radians(beam - 180)]
        if NEAREST <= value <= 12.0
    ]
    expected = min(to_rectangle(x, y) for x, y in points)
    assert clearance(ranges) == pytest.approx(expected, abs=1e-6)


def to_rectangle(x: float, y: float) -> float:
    """From the rectangle's definition: 0 inside, else the nearest of its four edges."""
    if abs(x) <= 0.306 and abs(y) <= 0.290:
        return 0.0
    corners = [(0.306, 0.29), (-0.306, 0.29), (-0.306, -0.29), (0.306, -0.29)]
    edges = zip(corners, corners[1:] + corners[:1], strict=True)
    return min(to_segment((x, y), start, end) for start, end in edges)


def to_segment(
    point: tuple[float, float], start: tuple[float, float], end: tuple[float, float]
) -> float:
    along = (end[0] - start[0], end[1] - start[1])
    offset = (point[0] - start[0], point[1] - start[1])
    share = (offset[0] * along[0] + offset[1] * along[1]) / (along[0] ** 2 + along[1] ** 2)
    share = min(1.0, max(0.0, share))
    return math.dist(point, (start[0] + share * along[0], start[1] + share * along[1]))


@dataclass
class Scan:
    ranges: NDArray[np.float32]


@pytest.mark.parametrize(
    ("ranges", "stop"),
    [
        (scan(NAN), True),
        (np.zeros(0, np.float32), True),
        (scan(INF), False),
        (scan(INF, b3=-INF), True),
        (scan(INF, b180=0.35), True),
        (scan(INF, b180=0.36), False),
    ],
    ids=["all NaN", "empty", "all free", "one too near", "4.4 cm ahead", "5.4 cm ahead"],
)
def test_the_decision_is_to_stop_below_five_centimetres_and_where_nothing_is_known(
    ranges: NDArray[np.float32], stop: bool
) -> None:
    decision = TooClose(LIDAR)
    assert decision.step(0) is True
    decision.hear("/scan", Scan(ranges), 0)
    assert decision.step(0) is stop


def test_a_scan_that_is_too_old_is_unknown() -> None:
    decision = TooClose(LIDAR)
    decision.hear("/scan", Scan(scan(INF)), 0)
    assert not decision.step(300_000_000)
    assert decision.step(300_000_001)


@pytest.mark.parametrize(
    ("before", "demanded", "manual", "after"),
    [
        (False, False, False, False),
        (False, True, False, True),
        (True, False, False, True),
        (True, True, False, True),
        (False, False, True, False),
        (False, True, True, False),
        (True, False, True, False),
        (True, True, True, False),
    ],
)
def test_a_stop_lasts_from_the_demand_until_a_person_takes_over(
    before: bool, demanded: bool, manual: bool, after: bool
) -> None:
    assert stop_requested(before, demanded=demanded, manual=manual) is after
