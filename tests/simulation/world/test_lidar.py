import math

import numpy as np
import pytest

from simulation.world.lidar import Lidar

LIDAR = Lidar(beams=8)


def test_the_first_beam_looks_back_and_the_middle_one_ahead() -> None:
    assert LIDAR.angles[0] == -math.pi
    assert LIDAR.angles[4] == pytest.approx(0.0)
    assert LIDAR.angles[6] == pytest.approx(math.pi / 2)


def test_what_is_out_of_reach_is_infinite_and_what_is_too_near_is_minus_infinite() -> None:
    distances = np.array([np.inf, 12.5, 12.0, 3.0, 0.13, 0.12, 0.11, 0.0])
    ranges = LIDAR.report(distances, np.zeros(8))
    assert ranges.dtype == np.float32
    assert ranges.tolist() == [
        math.inf,
        math.inf,
        12.0,
        3.0,
        np.float32(0.13),
        np.float32(0.12),
        -math.inf,
        -math.inf,
    ]


def test_noise_moves_a_range_over_the_limits_but_no_miss_into_reach() -> None:
    distances = np.array([11.99, 0.13, np.inf, 5.0] * 2)
    noise = np.array([0.02, -0.02, -0.02, -0.02] * 2)
    assert LIDAR.report(distances, noise)[:4].tolist() == [
        math.inf,
        -math.inf,
        math.inf,
        np.float32(4.98),
    ]


def test_only_ranges_within_the_limits_are_points() -> None:
    ranges = np.array([np.nan, np.inf, -np.inf, 0.0, 2.0, 0.05, 3.0, 12.5], np.float32)
    points = LIDAR.points(ranges)
    np.testing.assert_allclose(points.x, [2.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(points.y, [0.0, 3.0], atol=1e-12)


def test_a_lidar_that_loses_what_is_near_reads_plus_infinite() -> None:
    lidar = Lidar(beams=2, range_min=0.9, loses_near=True)
    assert lidar.report(np.array([0.5, 1.0]), np.zeros(2)).tolist() == [np.inf, 1.0]
