"""When the propositions of a requirement were unknown, and which signal made them so.

Times are nanoseconds. A result without a verdict keeps these intervals: without them nobody could
find the moment in the log.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice, pairwise
from typing import TYPE_CHECKING, Annotated, Literal

from compiler.files.records import about
from fretc.audit.measurements.intervals import Moment, TickInterval, interval_words
from fretish.bindings.declarations import Declarations
from monitors.kernel import Column
from monitors.kernel.columns import runs_of

if TYPE_CHECKING:
    from fretc.logs.signals.samples import Recording

MOST = 100
"""The most intervals of one result."""
UnknownCause = Literal[
    "", "no sample yet", "too old", "lost", "late", "no measurement", "no full window"
]
_WORDS: Mapping[str, str] = {
    "no sample yet": "`{}` had no sample yet",
    "too old": "the last sample of `{}` was too old",
    "lost": "messages of `{}` may have been lost",
    "late": "messages of `{}` came too late",
    "no measurement": "`{}` was no measurement",
    "no full window": "what `{}` looks back on was not fully known",
}


def without_brackets(name: str) -> str:
    """The name of a proposition for a reader: that of a comparison is in brackets."""
    return name[1:-1] if name.startswith("(") and name.endswith(")") else name


class UnknownInput(TickInterval, frozen=True):
    """An interval of ticks at which a proposition was unknown."""

    proposition: str
    signal: Annotated[str, about("the signal that made it unknown; empty: that is not clear")]
    cause: Annotated[
        UnknownCause,
        about("what was wrong with the signal at the first tick; empty: that is not clear"),
    ]

    def in_words(self, clock: str) -> str:
        """`` `near` from 20.4 s to 22.2 s (1.8 s): the last sample of `clearance` was too old``.

        Args:
            clock: the clock, in the words of evidence.
        """
        when = interval_words(self.first, self.last, clock)
        why = _WORDS[self.cause].format(self.signal) if self.cause else ""
        return f"`{without_brackets(self.proposition)}` {when}{f': {why}' if why else ''}"


def unknown_inputs(
    columns: Mapping[str, Column],
    at: Callable[[int], Moment],
    declarations: Declarations,
    recording: Recording,
) -> tuple[UnknownInput, ...]:
    """The first intervals at which the propositions were unknown, in order of time.

    Args:
        columns: the values of the propositions of a requirement.
        at: the moment of a tick.
        declarations: every proposition is declared.
        recording: the samples of their signals.
    """
    found = sorted(
        (first, last, name)
        for name, column in columns.items()
        for first, last in islice(runs_of(column.unknown), MOST)
    )
    return tuple(
        _interval(name, at(first), at(last), at(max(0, first - 1)).ns, declarations, recording)
        for first, last, name in found[:MOST]
    )


def _interval(
    name: str,
    first: Moment,
    last: Moment,
    before: int,
    declarations: Declarations,
    recording: Recording,
) -> UnknownInput:
    signals = declarations.propositions[name].signals
    signal, cause = next(_causes(signals, before, first.ns, declarations, recording), ("", ""))
    return UnknownInput(
        first.tick, last.tick, first.ns, last.ns, first.seconds, last.seconds, name, signal, cause
    )


def _causes(
    signals: Sequence[str], before: int, now: int, declarations: Declarations, recording: Recording
) -> Iterator[tuple[str, UnknownCause]]:
    """The signals that are unknown between the tick before and now, and why."""
    import numpy as np

    for name in signals:
        signal, samples = declarations.signals[name], recording.samples.get(name)
        late = recording.late.get(signal.path.topic)
        if late is not None and late.at(np.array([now], np.int64)).any():
            yield name, "late"
            continue
        start = 0 if samples is None else int(np.searchsorted(samples.times, before, "right"))
        end = 0 if samples is None else int(np.searchsorted(samples.times, now, "right"))
        if samples is None or not end:
            yield name, "no sample yet"
            continue
        # The sample in force before the tick, those within it, and the tick itself.
        begin = max(0, start - 1)
        times = [*samples.times[begin:end].tolist(), now]
        ages = [late - early for early, late in pairwise(times)]
        if any(gap[0] <= now and times[-2] <= gap[1] for gap in recording.gaps):
            yield name, "lost"
        elif signal.max_age is not None and max(ages) > signal.max_age:
            yield name, "too old"
        elif np.isnan(samples.values[begin:end]).any():
            yield name, "no measurement" if signal.memory is None else "no full window"
