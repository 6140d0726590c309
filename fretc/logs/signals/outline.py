"""The robot's outline: distances of points in the plane.

Lengths are metres, in the robot's frame. The outline is a simple polygon, convex or not, its
corners in either direction; the last corner is joined to the first.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.samples import Numbers
from fretish.classes.frozen import dataclass

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
    edges = _edges(tuple(outline))
    x, y = points[:, :1], points[:, 1:]
    from_x, from_y = x - edges.x, y - edges.y
    part = (from_x * edges.along_x + from_y * edges.along_y) / edges.square
    part = np.minimum(np.maximum(part, 0.0), 1.0)
    lengths = np.hypot(from_x - part * edges.along_x, from_y - part * edges.along_y)
    nearest = lengths.min(axis=1, initial=np.inf)
    # Inside: a line from the point to the right crosses the outline an odd number of times.
    spans = (edges.y > y) != (edges.end_y > y)
    right = x < edges.x + from_y / edges.height * edges.along_x
    return np.where(np.logical_xor.reduce(spans & right, axis=1), 0.0, nearest)


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
    starts = np.array(outline, np.float64)
    least = np.minimum(distances(first, outline), _to_rays(starts, first, rays).min(axis=1))
    crossed = _crossed(first, rays, starts, np.roll(starts, -1, axis=0))
    return float(np.mean((least >= bound) & ~crossed))


@dataclass(frozen=True, slots=True)
class _Edges:
    """The edges of an outline, each array of shape (edges,)."""

    x: Numbers
    y: Numbers
    """Where they start."""
    end_y: Numbers
    along_x: Numbers
    along_y: Numbers
    """From start to end."""
    square: Numbers
    """Of the length; 1 for an edge without length."""
    height: Numbers
    """From start to end; 1 for a level edge."""


@lru_cache(maxsize=64)
def _edges(outline: tuple[tuple[float, float], ...]) -> _Edges:
    x, y = np.array(outline, np.float64).T.copy()
    end_y = np.roll(y, -1)
    along_x, along_y = np.roll(x, -1) - x, end_y - y
    square = along_x**2 + along_y**2
    return _Edges(
        x,
        y,
        end_y,
        along_x,
        along_y,
        np.where(square == 0, 1.0, square),
        np.where(along_y == 0, 1.0, along_y),
    )


def _lengths(vectors: Numbers) -> Numbers:
    """Shape (..., 2) to shape (...)."""
    return np.asarray(np.hypot(vectors[..., 0], vectors[..., 1]), np.float64)


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
