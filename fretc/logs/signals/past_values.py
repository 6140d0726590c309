"""Propositions that look back by ticks, `pre(0 m/s, speed)`: they have a truth value only at ticks.

The value one tick before is the one in force at that tick, not the sample before. Times are
nanoseconds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.measures import NameValues
from fretc.logs.signals.propositions import (
    FALSE,
    TRUE,
    UNKNOWN,
    States,
    history_of,
    truth,
    with_persistences,
)
from fretc.logs.signals.samples import Recording, Times
from fretish.bindings.declarations import Declarations, Proposition
from fretish.bindings.expressions import ticks_back
from fretish.classes.frozen import dataclass

Places = NDArray[np.intp]
"""The index of the event in force at each point; -1: there is none yet."""


@dataclass(frozen=True, slots=True)
class PastValues:
    """A proposition that looks back, with the samples that it reads."""

    proposition: Proposition
    back: int
    """The number of earlier ticks on which the truth value at a tick depends."""
    times: Times
    """The times of the events; between two events, the values of the first one are in force."""
    _events: NameValues
    """The values in force from each event on; the last index is for -1, with all values unknown."""

    def states(self, places: Sequence[Places]) -> States:
        """The truth values at some ticks that have equally many relevant ticks before them.

        Args:
            places: for each of the ticks the event in force at it, then at the tick before, and so
                on: `back + 1` of them; or fewer, if the last one is the first tick of all.
        """
        scope: NameValues | None = None
        for at in reversed(places):
            scope = self._scope(at, scope)
        assert scope is not None, "there is a tick"
        states = truth(self.proposition.expression, scope)
        counted = self.proposition.on_unknown
        if counted is None:
            return states
        known: States = np.where(states == UNKNOWN, TRUE if counted else FALSE, states)
        return known.astype(np.int8)

    def at(self, places: Places) -> States:
        """The truth values at the ticks of a log, the first one first."""
        count = len(places)
        single = [
            self.states([places[k - j : k - j + 1] for j in range(k + 1)])
            for k in range(min(self.back, count))
        ]
        if count <= self.back:
            return np.concatenate([np.zeros(0, np.int8), *single])
        rest = [places[self.back - j : count - j] for j in range(self.back + 1)]
        return np.concatenate([*single, self.states(rest)])

    def _scope(self, at: Places, earlier: NameValues | None) -> NameValues:
        return replace(
            self._events,
            length=len(at),
            numbers={name: values[at] for name, values in self._events.numbers.items()},
            persistences={part: s[at] for part, s in self._events.persistences.items()},
            earlier=earlier,
        )


def past_values(
    proposition: Proposition, declarations: Declarations, recording: Recording
) -> PastValues | None:
    """The proposition over a recording; None: it does not look back by ticks."""
    back = ticks_back(proposition.expression)
    if not back:
        return None
    signals = {name: declarations.signals[name] for name in proposition.signals}
    history, states = with_persistences(proposition.expression, history_of(signals, recording))
    times = history.times
    unknown = np.array([UNKNOWN], np.int8)
    events = replace(
        history.scope({part: np.concatenate([s, unknown]) for part, s in states.items()}),
        length=len(times) + 1,
        numbers={name: np.append(v, v.dtype.type(np.nan)) for name, v in history.numbers.items()},
    )
    return PastValues(proposition, back, times, events)
