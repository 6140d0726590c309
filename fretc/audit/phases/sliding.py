"""The values of the propositions at each phase of the tick grid.

Times and phases are nanoseconds. Phase 0 is where the grid would begin; at phase s every tick is s
later. The value at tick k changes only at finitely many phases, and each of them is computed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.past_values import PastValues, Places, past_values
from fretc.logs.signals.propositions import UNKNOWN, States, StepFunction, evaluate, truth_values
from fretc.logs.signals.samples import Late, Recording, Times, distinct
from fretc.logs.signals.traces import (
    combined,
    complete_from,
    first_before,
    late_messages,
    origin,
    packed,
)
from fretish.bindings.declarations import Declarations, Proposition
from fretish.classes.frozen import dataclass
from monitors.kernel import Column


@dataclass(frozen=True, slots=True)
class PropositionByPhase:
    """The values of one proposition.

    `base` has shape (ticks at phase 0,): its states there. From `phases[i]` on, tick `ticks[i]` has
    `states[i]`; all three have shape (changes,), phases do not decrease. The cut tick has
    `cut_states[i]` from `cut_phases[i]` on; phases increase, and the first one is 0.
    """

    base: States
    phases: Times
    ticks: NDArray[np.int64]
    states: States
    cut_phases: Times
    cut_states: States

    def column(self, low: int, high: int, ticks: int) -> Column:
        """The values at the first ticks for phases `low` to `high`; unknown where they change."""
        done, more = np.searchsorted(self.phases, [low, high], "right").tolist()
        states = self.base.copy()
        states[self.ticks[:done]] = self.states[
            :done
        ]  # of several changes of a tick the last one counts
        states[self.ticks[done:more]] = UNKNOWN
        return packed(states[:ticks])

    def cut(self, phase: int) -> bool | None:
        """The value at the cut tick."""
        index = int(np.searchsorted(self.cut_phases, phase, "right")) - 1
        return truth_values(self.cut_states[index : index + 1])[0]


@dataclass(frozen=True, slots=True)
class PropositionsByPhase:
    """The values of all propositions of one log; `length` is the time from phase 0 to its end."""

    period: int
    declared: int
    length: int
    of: Mapping[str, PropositionByPhase]

    @property
    def most_ticks(self) -> int:
        """The number of ticks at phase 0."""
        return self.ticks(0)

    def ticks(self, phase: int) -> int:
        """The number of whole ticks."""
        return int(self.length - phase) // self.period + 1

    def cut(self, names: Iterable[str], phase: int) -> dict[str, bool | None] | None:
        """The values of some propositions at the cut tick; None: there is no such tick."""
        if not self.ticks(phase) or (self.length - phase) % self.period == 0:
            return None
        return {name: self.of[name].cut(phase) for name in names}

    def breaks(self, slides: Sequence[PropositionByPhase]) -> list[int]:
        """The phases at which the end changes: the last tick, or the values of the cut tick."""
        end = self.length % self.period  # here the last tick is at the very end
        places = {0, end, end + 1}
        for slide in slides:
            last = (self.length - slide.phases) // self.period
            places |= {*slide.cut_phases.tolist(), *slide.phases[slide.ticks == last].tolist()}
        return sorted(places - {self.period})

    def starts(self, slides: Sequence[PropositionByPhase], breaks: Sequence[int]) -> Times:
        """Shape (classes,): the phases at which any value changes, in order."""
        return distinct(np.concatenate([np.array(breaks, np.int64), *(s.phases for s in slides)]))


def sliding(
    declarations: Declarations, recording: Recording, names: Iterable[str]
) -> PropositionsByPhase | None:
    """The propositions at each phase; None: the clock ticks by message and has no phase.

    Args:
        declarations: clock, signals and propositions.
        recording: the recording with the samples of all signals that the propositions read.
        names: the names of declared propositions.
    """
    period = declarations.clock.period
    if period is None:
        return None
    start = origin(declarations, recording, period)
    length = max(0, recording.end_ns - start)
    slides = {
        name: _slide(declarations.propositions[name], declarations, recording, start, length)
        for name in names
    }
    return PropositionsByPhase(period, declarations.clock.phase, length, slides)


def _slide(
    proposition: Proposition,
    declarations: Declarations,
    recording: Recording,
    start: int,
    length: int,
) -> PropositionByPhase:
    period = declarations.clock.period
    assert period is not None
    late = late_messages(proposition, declarations, recording)
    past = past_values(proposition, declarations, recording)
    if past is not None:
        return _slide_of_past(past, late, start, length, period)
    steps = evaluate(proposition, declarations, recording)
    begun = recording.start_ns, complete_from(proposition, recording)
    first = _first(steps, proposition, begun, start, min(period - 1, length))
    later = _later(steps, proposition, start, length, period)
    cut = _cut(steps, proposition, start, length, period)
    return _joined([first], later, cut, late, start, length, period)


Seen = tuple[Times, States]
"""A step function: the value at a tick from each of these times on, until the next one."""


def _joined(
    firsts: Sequence[Seen],
    later: Seen,
    cut: Seen,
    late: Sequence[Late],
    start: int,
    length: int,
    period: int,
) -> PropositionByPhase:
    """The slide of the first ticks, one after the other, and of all later ones.

    Each is computed as if no message had been `late`.
    """
    end = np.array([start + length], np.int64)
    if any(each.at(end)[0] for each in late):
        cut = cut[0], np.full(len(cut[0]), UNKNOWN, np.int8)
    ends = [min(start + (i + 1) * period - 1, start + length) for i in range(len(firsts))]
    firsts = [_masked(seen, late, last) for seen, last in zip(firsts, ends, strict=True)]
    later = _masked(later, late, start + length)
    later_times, later_states = later
    grid = start + np.arange(len(firsts), length // period + 1, dtype=np.int64) * period
    base = [states[:1] for _, states in firsts]
    base.append(later_states[np.searchsorted(later_times, grid, "right") - 1])
    changes = [_changes(times, states) for times, states in (*firsts, later)]
    times = np.concatenate([times for times, _ in changes])
    states = np.concatenate([states for _, states in changes])
    ticks, phases = np.divmod(times - start, period)
    order = np.argsort(phases, kind="stable")
    order = order[phases[order] > 0]  # changes at phase 0 are in `base`
    return PropositionByPhase(
        np.concatenate(base), phases[order], ticks[order], states[order], *cut
    )


def _masked(seen: Seen, late: Sequence[Late], last: int) -> Seen:
    """The slide with unknown values at ticks for which a message was late, up to tick `last`."""
    for each in late:
        times, states = seen
        if not len(times):
            break
        edges = np.concatenate([each.firsts, each.lasts + 1])
        edges = edges[(edges > times[0]) & (edges <= last)]
        every = np.sort(np.append(times, edges), kind="stable")
        states = states[times.searchsorted(every, "right") - 1]
        seen = every, np.where(each.at(every), UNKNOWN, states).astype(np.int8)
    return seen


def _slide_of_past(
    past: PastValues, late: Sequence[Late], start: int, length: int, period: int
) -> PropositionByPhase:
    """The slide of a proposition that looks back by ticks.

    Its state changes when a sample comes, and one tick, two ticks, and so on, later.
    """
    back = min(past.back, length // period + 1)
    shifts = np.arange(past.back + 1, dtype=np.int64) * period
    moments = (past.times[:, None] + shifts).ravel()
    firsts = []
    for tick in range(back):
        begin = start + tick * period
        times = _within(moments, begin, min(begin + period - 1, start + length))
        firsts.append((times, past.states(_places(past, times, tick, period))))
    times = _within(moments, start + back * period, start + length)
    later = times, past.states(_places(past, times, past.back, period))
    cut = _cut_of_past(past, start, length, period)
    return _joined(firsts, later, cut, late, start, length, period)


def _places(past: PastValues, times: Times, before: int, period: int) -> list[Places]:
    """The samples in force at a tick at each of these times, and at so many ticks before it."""
    return [_in_force(past, times - back * period) for back in range(before + 1)]


def _in_force(past: PastValues, times: Times) -> Places:
    return np.searchsorted(past.times, times, "right") - 1


def _cut_of_past(past: PastValues, start: int, length: int, period: int) -> Seen:
    """The values at the cut tick, for a proposition that looks back by ticks.

    The tick before the cut one is the last whole one, if there is any.
    """
    end = start + length
    shifts = np.arange(past.back, dtype=np.int64) * period
    lasts = _within((past.times[:, None] + shifts).ravel(), end - period + 1, end)
    whole = np.array([0, (length + 1) % period], np.int64)
    phases = np.sort(np.append((lasts - start) % period, whole))
    counts = np.minimum((length - phases) // period + 1, past.back)
    states = np.empty(len(phases), np.int8)
    for count in distinct(counts).tolist():
        here = counts == count
        last = end - (length - phases[here]) % period
        before = _places(past, last, count - 1, period) if count else []
        states[here] = past.states([_in_force(past, np.full(len(last), end)), *before])
    return _once(phases, states)


def _first(
    steps: StepFunction, proposition: Proposition, begun: tuple[int, int], start: int, more: int
) -> Seen:
    """The values at the first tick, from each of these times on."""
    times = _within(steps.times, start, start + more)
    upto = np.searchsorted(steps.times, times, "right")
    return times, combined(steps, first_before(steps, begun, upto), upto, proposition)


def _later(
    steps: StepFunction, proposition: Proposition, start: int, length: int, period: int
) -> Seen:
    """The values at a later tick, from each of these times on.

    Its window is one tick long: the value changes when a step enters it, and when one leaves it.
    """
    moments = np.concatenate([steps.times, steps.times + period])
    times = _within(moments, start + period, start + length)
    before, upto = (np.searchsorted(steps.times, at, "right") for at in (times - period, times))
    return times, combined(steps, before, upto, proposition)


def _within(times: Times, first: int, last: int) -> Times:
    """The first time, and the times after it up to the last one; empty if the last one is earlier.

    They are in order, with duplicates: to remove them would cost more than to keep them.
    """
    inside = times[(times > first) & (times <= last)]
    return np.sort(np.append(inside, first), kind="stable") if first <= last else inside


def _changes(times: Times, states: States) -> Seen:
    """The phases at which the state differs from that one nanosecond before, with the new state."""
    new = np.append(False, states[1:] != states[:-1])[: len(states)]
    return times[new], states[new]


def _cut(
    steps: StepFunction, proposition: Proposition, start: int, length: int, period: int
) -> Seen:
    """The phases from which on the state at the cut tick changes, with the new state."""
    end = start + length
    lasts = _within(steps.times, end - period + 1, end)
    ends = np.array([0, (length + 1) % period], np.int64)
    phases = np.sort(np.append((lasts - start) % period, ends))
    last = end - (length - phases) % period
    before, upto = (np.searchsorted(steps.times, at, "right") for at in (last, end))
    return _once(phases, combined(steps, before, np.full(len(last), upto), proposition))


def _once(phases: Times, states: States) -> Seen:
    """The changes, without those that keep the state."""
    changed = np.append(True, states[1:] != states[:-1])
    return phases[changed], states[changed]
