"""What an agent believed when a requirement was violated: which belief was absent, late or wrong.

A belief belongs to the proposition of its name. It is compared with the proposition from the start
of the interval in which that was true when the violated demand began, up to the first violated
tick. No verdict depends on it. Nothing is compared where a report may have been lost, or where the
proposition is unknown.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from itertools import zip_longest
from math import inf
from typing import TYPE_CHECKING, Annotated, Literal

from compiler.files.records import Number, Record, about
from fretc.audit.measurements.intervals import Moment
from fretish.bindings.amounts import duration, seconds
from fretish.classes.frozen import dataclass
from monitors.kernel import Column

if TYPE_CHECKING:
    from fretc.logs.signals.samples import AgentTrace, Gap, Recording

BeliefState = Literal["in time", "late", "absent", "wrong"]
PROMPT = 2
"""A belief later than so many ticks after its proposition is late."""


class AgentBelief(Record, frozen=True):
    """A belief of an agent at a violation; seconds count from the first tick of the run."""

    agent: str
    belief: str
    proposition: str
    state: Annotated[
        BeliefState,
        about(
            "late: more than two ticks after the proposition became true; absent: the proposition "
            "was true, and the agent did not believe it up to the first violated tick; wrong: it "
            "was false at that tick, and the agent believed it"
        ),
    ]
    true_s: Annotated[
        Number | None, about("since when the proposition was true; null: it was false")
    ]
    believed_s: Annotated[
        Number | None, about("since when the agent believed it; null: it did not")
    ]
    reported_s: Annotated[
        Number | None, about("the last report before the violation; null: there is none")
    ]
    action: Annotated[
        str | None, about("the last action before the violation; null: there is none")
    ]
    action_s: Annotated[Number | None, about("the time of that action")]

    def in_words(self) -> str:
        """`` `sw` did not believe `near`, which was true from 3.2 s; it last did `go`, at 1 s``."""
        name, belief = f"`{self.agent}`", f"`{self.belief}`"
        match self.state:
            case "absent":
                text = f"{name} did not believe {belief}, which was true from {_at(self.true_s)}"
            case "wrong":
                text = f"{name} believed {belief} from {_at(self.believed_s)}, and it was false"
            case "late":
                assert self.believed_s is not None
                assert self.true_s is not None
                text = (
                    f"{name} believed {belief} only from {_at(self.believed_s)}, "
                    f"{duration(round(self.believed_s - self.true_s, 6))} after it became true"
                )
            case _:
                text = f"{name} believed {belief} from {_at(self.believed_s)}"
        if self.reported_s is None:
            return f"{text}, and had reported nothing"
        last = f"its last report is of {_at(self.reported_s)}" if self.state == "absent" else ""
        did = (
            f"its last action was `{self.action}`, at {_at(self.action_s)}"
            if self.action
            else "it had done nothing"
        )
        return "; ".join(filter(None, [text, last, did]))


def _at(time: float | None) -> str:
    assert time is not None, "the state says that there is a time"
    return seconds(time)


def agent_beliefs(
    recording: Recording,
    columns: Mapping[str, Column],
    beliefs: Mapping[str, str],
    at: Callable[[int], Moment],
    trigger: Moment | None,
    broken: Moment,
) -> tuple[AgentBelief, ...]:
    """The beliefs of all agents about the propositions of a violated requirement.

    A proposition that an agent never believes in the whole log is none of its beliefs.

    Args:
        recording: with the traces of agents.
        columns: proposition → its truth at each tick.
        beliefs: proposition → the name of the belief.
        at: the moment of a tick.
        trigger: the trigger whose demand was broken; None: there is none.
        broken: the first violated tick.
    """
    results = []
    for agent, trace in recording.agents.items():
        for proposition, column in columns.items():
            belief = beliefs.get(proposition, proposition)
            held = _held(trace, belief)
            episode = _episode(column, trigger or broken, broken)
            if held and episode and not _is_lost(trace, recording.gaps, at(episode.since), broken):
                state, since = _compared(held, episode, at, broken)
                if state is not None:
                    true = at(episode.since) if episode.value else None
                    names = (agent, belief, proposition)
                    results.append(_belief(names, trace, state, true, since, at(0), broken))
    return tuple(results)


@dataclass(frozen=True, slots=True)
class _Episode:
    """An interval of ticks in which a proposition had one value, up to or beside a violation."""

    value: bool
    since: int
    """Its first tick."""


def _episode(column: Column, begin: Moment, broken: Moment) -> _Episode | None:
    """The interval in which it was true, at the violated tick or when the demand began.

    If it was true at neither, the interval in which it was false; None: it was unknown.
    """
    now, first = column.at(broken.tick), column.at(begin.tick)
    if now is None:
        return None
    value = now or bool(first)
    tick = broken.tick if now == value else begin.tick
    while tick and column.at(tick - 1) is value:
        tick -= 1
    return _Episode(value, tick)


def _held(trace: AgentTrace, belief: str) -> Sequence[tuple[int, float]]:
    """The intervals in which the agent believed it: from the first time to before the second."""
    held: list[tuple[int, float]] = []
    for state, after in zip_longest(trace.states, trace.states[1:]):
        if belief in state.beliefs:
            until = inf if after is None else after.ns
            if held and held[-1][1] == state.ns:
                held[-1] = held[-1][0], until
            else:
                held.append((state.ns, until))
    return held


def _compared(
    held: Sequence[tuple[int, float]],
    episode: _Episode,
    at: Callable[[int], Moment],
    broken: Moment,
) -> tuple[BeliefState | None, int | None]:
    """The state of the belief, and since when it was held; None: it was rightly not held."""
    begin, end = at(episode.since).ns, broken.ns
    prompt = episode.since + PROMPT
    limit = at(prompt).ns if prompt <= broken.tick else end
    if not episode.value:
        now = [start for start, until in held if start <= end < until]
        is_wrong = bool(now) and (now[0] >= begin or end > limit)
        return ("wrong", now[0]) if is_wrong else (None, None)
    during = [start for start, until in held if start <= end and until > begin]
    if not during:
        return "absent", None
    return ("late" if during[0] > limit else "in time"), during[0]


def _is_lost(trace: AgentTrace, gaps: Sequence[Gap], begin: Moment, broken: Moment) -> bool:
    """Whether a report that matters may have been lost."""
    index = bisect_right(trace.times, begin.ns) - 1
    before = int(trace.times[index]) if index >= 0 else 0
    return any(start <= broken.ns and end >= before for start, end in gaps)


def _belief(
    names: tuple[str, str, str],
    trace: AgentTrace,
    state: BeliefState,
    true: Moment | None,
    since: int | None,
    first: Moment,
    broken: Moment,
) -> AgentBelief:
    def seconds_of(ns: int | None) -> float | None:
        return None if ns is None else round((ns - first.ns) / 1e9, 9)

    reports = bisect_right(trace.times, broken.ns)
    acted = [(ns, action) for ns, action in trace.actions if ns <= broken.ns]
    return AgentBelief(
        *names,
        state,
        None if true is None else true.seconds,
        seconds_of(since),
        seconds_of(int(trace.times[reports - 1])) if reports else None,
        acted[-1][1] if acted else None,
        seconds_of(acted[-1][0]) if acted else None,
    )
