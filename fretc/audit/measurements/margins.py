"""The distances of a run to the thresholds of a requirement.

Times are nanoseconds, numbers are in base units.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from fretc.logs.signals.measures import Measure, term, together
from fretc.logs.signals.propositions import TRUE, UNKNOWN, History, history_of, truth
from fretc.logs.signals.samples import Recording, Times
from fretc.logs.signals.thresholds import Threshold, thresholds
from fretish.bindings.declarations import Declarations, Proposition
from fretish.classes.frozen import dataclass

CROSSED = "crossed"


@dataclass(frozen=True, slots=True)
class Margin:
    """The distance to one threshold over the audited time of one run, without unknown samples.

    `least` and `greatest` are None if nothing is known, and may be infinite: nothing in range, or
    too near to measure.
    """

    threshold: Threshold
    comparison: bool | str | None
    """The truth value of the comparison over the whole run, or `CROSSED`; None: it is always
    unknown."""
    least: float | None
    greatest: float | None
    distance: float | None
    """The least distance to the bound, if the comparison kept one truth value."""
    nearest_ns: int | None
    """The first time of the least distance; if the comparison was crossed, the time of its first
    change."""

    @property
    def share(self) -> float | None:
        """The margin as a fraction of the bound, to compare margins of different units."""
        if self.distance is None:
            return None
        assert self.least is not None
        assert self.greatest is not None
        reached = [abs(end) for end in (self.least, self.greatest) if np.isfinite(end)]
        scale = abs(self.threshold.bound) or max(reached)
        return self.distance / scale if scale else 0.0


def margins(
    proposition: Proposition, declarations: Declarations, recording: Recording, ticks: Times
) -> tuple[Margin, ...]:
    """The margin of each threshold of the proposition.

    All samples from the start of the first tick to the last tick count, also those that `agg`
    combines within a tick; samples that are too old or within a gap do not count.

    Args:
        proposition: over declared signals.
        declarations: signals and clock.
        recording: the recording with the samples of all signals that the proposition reads.
        ticks: the times of the whole ticks.
    """
    bounds = thresholds(proposition, declarations.signals)
    if not bounds:
        return ()
    signals = {name: declarations.signals[name] for name in proposition.signals}
    history = history_of(signals, recording)
    begin = recording.start_ns if declarations.clock.period is not None else None
    audited = _audited(history.times, ticks, begin)
    return tuple(_margin(threshold, history, audited) for threshold in bounds)


def worst(margins: Iterable[Margin]) -> Margin | None:
    """The margin that is smallest as a fraction of its bound; None: every threshold was crossed."""
    uncrossed = [margin for margin in margins if margin.share is not None]
    return min(uncrossed, key=lambda margin: margin.share or 0.0, default=None)


def _audited(times: Times, ticks: Times, begin: int | None) -> slice:
    """The events that the ticks use: those of the audited time, and the one in force before it."""
    if not len(ticks):
        return slice(0, 0)
    start = int(ticks[0]) if begin is None else begin
    first = int(np.searchsorted(times, start, "left"))
    in_force = first if first < len(times) and times[first] == start else first - 1
    return slice(max(0, in_force), int(np.searchsorted(times, ticks[-1], "right")))


def _margin(threshold: Threshold, history: History, audited: slice) -> Margin:
    scope = history.scope()
    states = truth(threshold.comparison, scope)[audited]
    definite = states != UNKNOWN
    truths, times = states[definite] == TRUE, history.times[audited][definite]
    if not len(times):
        return Margin(threshold, None, None, None, None, None)
    measured, bound, scale = together(term(threshold.term, scope), term(threshold.limit, scope))
    measured = measured[audited][definite]
    values = Measure(measured, scale).base
    least, greatest = float(values.min()), float(values.max())
    if truths.any() and not truths.all():
        changed = int(times[np.argmax(truths != truths[0])])
        return Margin(threshold, CROSSED, least, greatest, None, changed)
    distances = Measure(np.abs(measured - bound), scale).base
    at = int(np.argmin(distances))
    if not np.isfinite(distances[at]):  # all its values are infinite
        return Margin(threshold, bool(truths[0]), least, greatest, None, None)
    nearest, distance = int(times[at]), float(distances[at])
    return Margin(threshold, bool(truths[0]), least, greatest, distance, nearest)
