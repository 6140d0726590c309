"""The robot's outline: distances of points in the plane.

Lengths are metres, in the robot's frame. The outline is a simple polygon, convex or not, its
corners in either direction; the last corner is joined to the first.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.samples import Numbers

Corners = Sequence[tuple[float, float]]
_DIRECTIONS = 3600
"""The number of directions of the circle: tenths of a degree."""


def distances(points: Numbers, outline: Corners) -> Numbers:
    """The distance of each point to the outline; 0 inside of it and on it.

    Args:
        points: shape (n, 2).
        outline: three corners or more.

    Returns:
        Shape (n,); NaN where a coordinate is NaN.
    """
    starts, ends = _edges(outline)
    nearest = _to_segments(points, starts, ends).min(axis=1, initial=np.inf)
    return np.where(_inside(points, starts, ends), 0.0, nearest)


def places(ranges: Numbers, angles: Numbers, sensor: tuple[float, float, float]) -> Numbers:
    """Polar readings of a sensor as points in the robot's frame, shape (n, 2).

    Args:
        ranges: shape (n,), metres from the sensor.
        angles: shape (n,), radians from the sensor's forward direction.
        sensor: its x, y in metres and yaw in radians.
    """
    x, y, yaw = sensor
    return np.column_stack((x + ranges * np.cos(angles + yaw), y + ranges * np.sin(angles + yaw)))


def blind_share(
    bound: float, nearest: float, outline: Corners, sensor: tuple[float, float, float]
) -> float:
    """The share of the circle in which nothing nearer to the outline than `bound` can be measured.

    A direction from the sensor is blind if each of its points at `nearest` or farther is `bound` or
    more away from the outline. A direction through a part of the outline is not blind.

    Args:
        bound: metres from the outline.
        nearest: the least distance in metres that the sensor reports.
        outline: three corners or more.
        sensor: its x, y in metres and yaw in radians.

    Returns:
        From 0 to 1, of directions a tenth of a degree apart.
    """
    angles = np.linspace(0.0, 2 * np.pi, _DIRECTIONS, endpoint=False)
    first = places(np.full(_DIRECTIONS, nearest), angles, sensor)
    rays = np.column_stack((np.cos(angles + sensor[2]), np.sin(angles + sensor[2])))
    starts, ends = _edges(outline)
    least = np.minimum(distances(first, outline), _to_rays(starts, first, rays).min(axis=1))
    crossed = _crossed(first, rays, starts, ends)
    return float(np.mean((least >= bound) & ~crossed))


def _edges(outline: Corners) -> tuple[Numbers, Numbers]:
    corners = np.array(outline, np.float64)
    return corners, np.concatenate((corners[1:], corners[:1]))


def _to_segments(points: Numbers, starts: Numbers, ends: Numbers) -> Numbers:
    """Shape (points, segments)."""
    along = ends - starts
    length = (along**2).sum(axis=1)
    offset = points[:, None, :] - starts
    part = (offset * along).sum(axis=2) / np.where(length == 0, 1.0, length)
    foot = np.clip(part, 0.0, 1.0)[:, :, None] * along
    return _lengths(offset - foot)


def _lengths(vectors: Numbers) -> Numbers:
    """Shape (..., 2) to shape (...)."""
    return np.asarray(np.hypot(vectors[..., 0], vectors[..., 1]), np.float64)


def _inside(points: Numbers, starts: Numbers, ends: Numbers) -> NDArray[np.bool_]:
    """Whether a line from the point to the right crosses the outline an odd number of times."""
    x, y = points[:, :1], points[:, 1:]
    (x1, y1), (x2, y2) = starts.T, ends.T
    spans = (y1 > y) != (y2 > y)
    height = np.where(y1 == y2, 1.0, y2 - y1)
    right = x < x1 + (y - y1) / height * (x2 - x1)
    odd: NDArray[np.bool_] = (spans & right).sum(axis=1) % 2 == 1
    return odd


def _to_rays(points: Numbers, origins: Numbers, rays: Numbers) -> Numbers:
    """The distance of each point to each half-line, shape (rays, points); rays have length 1."""
    offset = points[None, :, :] - origins[:, None, :]
    part = np.maximum((offset * rays[:, None, :]).sum(axis=2), 0.0)
    return _lengths(offset - part[:, :, None] * rays[:, None, :])


def _crossed(origins: Numbers, rays: Numbers, starts: Numbers, ends: Numbers) -> NDArray[np.bool_]:
    """Whether a half-line meets an edge, shape (rays,)."""

    def side(corners: Numbers) -> Numbers:
        offset = corners[None, :, :] - origins[:, None, :]
        return rays[:, :1] * offset[:, :, 1] - rays[:, 1:] * offset[:, :, 0]

    def ahead(corners: Numbers) -> Numbers:
        offset = corners[None, :, :] - origins[:, None, :]
        return np.asarray((offset * rays[:, None, :]).sum(axis=2))

    start_side, end_side = side(starts), side(ends)
    apart = (start_side > 0) != (end_side > 0)
    part = start_side / np.where(apart, start_side - end_side, 1.0)
    meets = ahead(starts) + part * (ahead(ends) - ahead(starts))
    met: NDArray[np.bool_] = (apart & (meets >= 0)).any(axis=1)
    return met
