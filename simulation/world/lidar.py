"""A range finder turning in the plane: where its beams point and what it says of a distance."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Points:
    """What a scan saw, in the sensor's frame: x ahead, y to the left, metres, each shape (n,)."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Lidar:
    """Beams evenly around the full circle, the first one backwards (-pi), growing to the left.

    Ranges and noise (standard deviation) in metres, period in seconds.
    """

    beams: int = 360
    range_min: float = 0.12
    range_max: float = 12.0
    noise: float = 0.008
    period: float = 0.1
    loses_near: bool = False
    """What is nearer than `range_min` is not told from nothing, as some drivers have it."""

    @property
    def increment(self) -> float:
        """Radians from one beam to the next."""
        return 2 * math.pi / self.beams

    @property
    def angles(self) -> NDArray[np.float64]:
        """Shape (beams,): each beam's direction in the sensor's frame, in radians."""
        return np.asarray(-math.pi + self.increment * np.arange(self.beams), np.float64)

    def report(
        self, distances: NDArray[np.float64], noise: NDArray[np.float64]
    ) -> NDArray[np.float32]:
        """What the sensor says of true distances.

        Args:
            distances: shape (beams,), metres; +inf where a beam meets nothing.
            noise: shape (beams,), metres, added to each distance.

        Returns:
            Shape (beams,): a range within `range_min..range_max`, both included, or -inf for
            something nearer, or +inf for nothing in reach. Never NaN.

        Source: REP 117, Informational Distance Measurements.
        """
        ranges = (distances + noise).astype(np.float32)
        ranges[ranges < np.float32(self.range_min)] = np.inf if self.loses_near else -np.inf
        ranges[ranges > np.float32(self.range_max)] = np.inf
        return ranges

    def points(self, ranges: NDArray[np.floating]) -> Points:
        """The returns of a scan, in the order of its beams.

        Only a finite range within `range_min..range_max`, both included, is a return. `ranges` has
        shape (n,), n at most `beams`, from the first beam on.
        """
        near, far = np.float32(self.range_min), np.float32(self.range_max)
        valid = np.isfinite(ranges) & (ranges >= near) & (ranges <= far)
        measured, angles = ranges[valid].astype(np.float64), self.angles[: len(ranges)][valid]
        return Points(measured * np.cos(angles), measured * np.sin(angles))
