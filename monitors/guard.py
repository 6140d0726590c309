"""What a node on a robot says: whether the robot must stop, and how it keeps its requirements.

Nothing here knows a middleware, waits, or looks at a clock: who calls it says what has arrived, and
when. `now` is in nanoseconds on the clock that stamps messages and arrivals; it may be simulated,
stand still, or be set. `steady` is in seconds on a clock that nothing sets, for silence alone.

The robot must stop unless each requirement that decides owes nothing for certain, each topic that
these read has sent a message that could be read, and none of them is silent for too long.

The text of this module is copied into emitted nodes: it needs the standard library only.
"""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, NamedTuple

from monitors.kernel.verdicts import Truth
from monitors.perception import Judging, Setting

OK, WARN, ERROR, STALE = range(4)
"""The levels of diagnostic_msgs/DiagnosticStatus."""


class State(NamedTuple):
    """What is known of a requirement now, as `fretc watch --format jsonl` says it."""

    requirement: str
    verdict: str
    """If the run ended now."""
    owed: Truth
    """Whether a demand is open that the robot must meet now."""
    triggered_ns: int | None
    """The last tick that has triggered it for certain."""
    open_ns: int | None
    """The trigger of the demand that is open for certain."""
    deadline_ns: int | None
    """The last tick at which that can be met."""
    violated_ns: int | None
    """The first tick at which it was violated for certain."""


class Status(NamedTuple):
    """For a diagnostic_msgs/DiagnosticStatus."""

    level: int
    name: str
    message: str
    values: tuple[tuple[str, str], ...]


class Guard:
    """One monitor, what it reads, and what follows."""

    def __init__(
        self,
        monitor: Callable[[], Any],
        setting: Setting,
        deciding: Collection[str] = (),
        source_timeout: float = 0.0,
    ) -> None:
        """Nothing has come yet.

        Args:
            monitor: makes one.
            setting: what the bindings say.
            deciding: the requirements that stop the robot while one of them is owed; none: all.
            source_timeout: after so many seconds of silence a topic stops the robot whose samples
                grow too old; 0: only by their ages.

        Raises:
            ValueError: there is no such requirement, or no such time.
        """
        self._ids = tuple(each.id for each in monitor().REQUIREMENTS)
        unknown = sorted(set(deciding) - set(self._ids))
        if unknown:
            raise ValueError(f"there is no requirement {unknown[0]}: {', '.join(self._ids)}")
        bounded("source_timeout", source_timeout, 0.0, LONGEST)
        self._judging = Judging(monitor, setting)
        self._setting, self._timeout = setting, source_timeout
        self._deciding = [i for i, id in enumerate(self._ids) if not deciding or id in deciding]
        self._needed = [
            topic
            for id, topics in setting.reads
            if not deciding or id in deciding
            for topic in topics
        ]
        self._aging = {policy.topic for policy in setting.policies if policy.max_age is not None}
        self._heard: dict[str, float] = {}
        self._counts = dict.fromkeys(setting.topics, 0)
        self._unreadable: dict[str, str] = {}
        """The topics whose last message could not be read, and why."""
        self._owed: tuple[Truth, ...] = (None,) * len(self._ids)
        self._violated: set[str] = set()
        """The requirements that were violated before a clock was set."""
        self._now = 0
        self._states: tuple[State, ...] = ()

    # What comes

    def arrive(
        self, topic: str, message: Any, now: int, steady: float, singles: Collection[str] = ()
    ) -> None:
        """One message, which has fields as attributes; `singles` as `single_signals` gives them."""
        time = stamp(message) if self._setting.stamped else None
        time = now if time is None else time
        self._counts[topic] += 1
        try:
            self._judge(lambda: self._judging.arrive(topic, time, now, message, singles), now)
        except (AttributeError, TypeError, ValueError) as error:
            self._unreadable[topic] = f"{type(error).__name__}: {error}"
        else:
            self._unreadable.pop(topic, None)
            self._heard[topic] = steady

    def pass_to(self, now: int) -> None:
        """Everything that was received before `now` has been given."""
        self._judge(lambda: self._judging.pass_to(now), now)

    def _judge(self, step: Callable[[], None], now: int) -> None:
        """A violation stays one where a clock is set, and another run begins."""
        monitor, resets = self._judging.monitor, self._judging.resets
        try:
            step()
        finally:
            if self._judging.resets != resets:
                standings = monitor.standings()
                self._violated |= {s.requirement for s in standings if s.verdict == "violated"}
            self._now = now
            self._owed = self._judging.owed()

    # What follows

    @property
    def ticks(self) -> int:
        """How many were judged since the clock was set."""
        return len(self._judging.ledger)

    def stop(self, steady: float) -> bool:
        """Whether the robot must stop now."""
        owed = any(self._owed[i] is not False for i in self._deciding)
        return owed or any(self.fault(topic, steady) for topic in self._needed)

    def fault(self, topic: str, steady: float) -> str:
        """Why a topic cannot be relied on, in words; empty: nothing is wrong."""
        if topic in self._unreadable:
            return f"a message of {topic} cannot be read: {self._unreadable[topic]}"
        if topic not in self._heard:
            return f"no message of {topic} yet"
        silence = steady - self._heard[topic]
        if self._timeout and topic in self._aging and silence > self._timeout:
            return f"{topic} is silent for {silence:.1f} s"
        return ""

    def states(self) -> tuple[State, ...]:
        """Of each requirement what is known now; what it owes counts what came since the tick."""
        monitor = self._judging.monitor
        read = zip(monitor.standings(), self._owed, monitor.must.marks(), strict=True)
        return tuple(
            State(
                standing.requirement,
                str(standing.verdict),
                owed,
                self._time(mark.last if mark.last >= 0 else None),
                self._time(standing.open),
                self._time(standing.deadline),
                self._time(standing.first_violation),
            )
            for standing, owed, mark in read
        )

    def news(self) -> list[dict[str, Any]]:
        """The requirements that are otherwise than at the last call: lines of a watch."""
        before, self._states = self._states, self.states()
        return [
            {"type": "requirement", **state._asdict(), "time_ns": self._now}
            for state in self._states
            if state not in before
        ]

    def _time(self, tick: int | None) -> int | None:
        origin = self._judging.perception.origin
        if tick is None or origin is None:
            return None
        return origin + self._setting.phase + tick * self._setting.period

    def statuses(self, steady: float) -> list[Status]:
        """One for what is read, and one for each requirement."""
        faults = {topic: self.fault(topic, steady) for topic in self._setting.topics}
        wrong = [fault for fault in faults.values() if fault]
        judging = self._judging
        values = {f"messages of {topic}": count for topic, count in self._counts.items()}
        values |= {
            "ticks": self.ticks,
            "ticks that became unknown": judging.ledger.late,
            "clock was set": judging.resets,
        }
        sources = status(STALE if wrong else OK, "sources", "; ".join(wrong) or "all come", values)
        own = [
            [faults[each] for each in topics if faults[each]] for _, topics in self._setting.reads
        ]
        read = zip(self.states(), own, strict=True)
        return [
            sources,
            *(
                status_of(state, "".join(some[:1]), violated=state.requirement in self._violated)
                for state, some in read
            ),
        ]


def status_of(state: State, fault: str, *, violated: bool = False) -> Status:
    """What is said of a requirement: a violation stays an error, whatever else is wrong.

    Args:
        state: what is known of it.
        fault: why a topic that it reads cannot be relied on; empty: nothing is wrong.
        violated: whether it was before, in another run.
    """
    values = {name: value for name, value in state._asdict().items() if name != "requirement"}
    if violated or state.verdict == "violated":
        level, message = ERROR, "violated"
    elif fault:
        level, message = STALE, fault
    elif state.owed is not False:
        level, message = (
            WARN,
            "an obligation is open" if state.owed else "unknown whether an obligation is open",
        )
    else:
        level, message = OK, "no obligation is open"
    return status(level, state.requirement, message, values)


def status(level: int, name: str, message: str, values: Mapping[str, object]) -> Status:
    """With its values as texts."""
    return Status(level, name, message, tuple((key, str(value)) for key, value in values.items()))


LONGEST = 3600.0
"""Seconds that a topic may be silent at most."""


def bounded(name: str, value: float, least: float, most: float) -> float:
    """The value of a parameter, in seconds.

    Raises:
        ValueError: it is no number, or out of bounds.
    """
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not is_number or not least <= value <= most:
        raise ValueError(f"{name} is from {least:g} to {most:g} s, not {value!r}")
    return float(value)


# What middlewares have in common -----------------------------------------------------------------


def stamp(message: Any) -> int | None:
    """`header.stamp` in nanoseconds, in ROS 2 and in ROS 1; None for a message without one."""
    time = getattr(getattr(message, "header", None), "stamp", None)
    for seconds, nanoseconds in (("sec", "nanosec"), ("secs", "nsecs")):
        if hasattr(time, seconds) and hasattr(time, nanoseconds):
            return int(getattr(time, seconds) * 10**9 + getattr(time, nanoseconds))
    return None


def single_signals(
    setting: Setting, topic: str, message: Any, types: Callable[[Any], Mapping[str, str]]
) -> tuple[str, ...]:
    """The signals of a topic that are read from 32-bit floats.

    Args:
        setting: what the bindings say.
        topic: of the message.
        message: an empty one.
        types: gives the type of each field of a message, as the middleware names it.

    Raises:
        ValueError: the message has no such field.
    """
    own = [policy for policy in setting.policies if policy.topic == topic]
    for policy in own:
        angles = ("angle_min", "angle_increment") if policy.reduce == "outline" else ()
        for name in (*policy.beside, *angles):
            _type(message, (name,), topic, types)
    return tuple(
        policy.name for policy in own if _SINGLE.match(_type(message, policy.fields, topic, types))
    )


_SINGLE = re.compile(r"(sequence<)?float(32)?(?!\w)")


def _type(
    message: Any, fields: Sequence[str], topic: str, types: Callable[[Any], Mapping[str, str]]
) -> str:
    name = type(message).__name__
    for place, field in enumerate(fields):
        known = types(message) if hasattr(message, field) else {}
        if field not in known:
            raise ValueError(f"{name} of {topic} has no field {'.'.join(fields[: place + 1])}")
        found, message = known[field], getattr(message, field)
    return found
