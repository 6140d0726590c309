"""Supervise a robot: decide whether it must stop, and report the status of its requirements.

The module is independent of any middleware. It does not wait and reads no clock: the caller gives
the messages and their times. `now` is in nanoseconds on the clock of messages and arrivals; this
clock may be simulated, stand still, or be set. `steady` is in seconds on a monotonic clock, and is
only used to detect silence.

The robot must stop unless all of these hold: no deciding requirement has, or may have, an open
obligation; each topic that these requirements read has sent a readable message; and none of the
topics is silent for too long.

The text of this module is copied into emitted nodes: it needs the standard library only.
"""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, NamedTuple

from monitors.kernel.verdicts import Truth, same_length
from monitors.perception import BindingConfig, OnlineEvaluator

OK, WARN, ERROR, STALE = range(4)
"""The levels of diagnostic_msgs/DiagnosticStatus."""


class State(NamedTuple):
    """The present status of a requirement, as in `fretc watch --format jsonl`."""

    requirement: str
    verdict: str
    """The verdict if the run ended now."""
    obligation_pending: Truth
    """Whether an obligation is open; None: unknown."""
    triggered_ns: "int | None"
    """The last tick that has certainly triggered the requirement."""
    open_ns: "int | None"
    """The trigger of the obligation that is certainly open."""
    deadline_ns: "int | None"
    """The last tick at which this obligation can be met."""
    violated_ns: "int | None"
    """The first tick at which the requirement was certainly violated."""


class Status(NamedTuple):
    """The contents of a diagnostic_msgs/DiagnosticStatus."""

    level: int
    name: str
    message: str
    values: "tuple[tuple[str, str], ...]"


class StopSupervisor:
    """Supervises one monitor and its topics, and decides whether the robot must stop."""

    def __init__(
        self,
        monitor: "Callable[[], Any]",
        setting: BindingConfig,
        deciding: "Collection[str]" = (),
        source_timeout: float = 0.0,
    ) -> None:
        """Start before the first message.

        Args:
            monitor: function that makes the monitor.
            setting: the configuration from the bindings.
            deciding: the ids of the requirements that stop the robot while an obligation of them
                is open; empty: all.
            source_timeout: seconds of silence after which a topic stops the robot, if its signals
                have a `max_age`; 0: silence has an effect only through `max_age`.

        Raises:
            ValueError: an id of `deciding` is unknown, or the timeout is out of range.
        """
        self._ids = tuple(each.id for each in monitor().REQUIREMENTS)
        unknown = sorted(set(deciding) - set(self._ids))
        if unknown:
            raise ValueError(f"unknown requirement {unknown[0]}: there are {', '.join(self._ids)}")
        bounded("source_timeout", source_timeout, 0.0, LONGEST)
        self._evaluator = OnlineEvaluator(monitor, setting)
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
        """Topic whose last message could not be read -> the reason."""
        self._obligation_pending: tuple[Truth, ...] = (None,) * len(self._ids)
        self._violated: set[str] = set()
        """The requirements that were violated in earlier runs."""
        self._now = 0
        self._states: tuple[State, ...] = ()
        """Those of the last call of `news`."""
        self._computed: tuple[object, tuple[State, ...]] = None, ()
        """What the last states were computed from, and these states."""

    # Input

    def arrive(
        self, topic: str, message: Any, now: int, steady: float, singles: "Collection[str]" = ()
    ) -> None:
        """Process a message with fields as attributes; `singles` is from `single_signals`."""
        time = stamp(message) if self._setting.stamped else None
        time = now if time is None else time
        self._counts[topic] = self._counts.get(topic, 0) + 1
        try:
            self._judge(lambda: self._evaluator.arrive(topic, time, now, message, singles), now)
        except (AttributeError, TypeError, ValueError) as error:
            self._unreadable[topic] = f"{type(error).__name__}: {error}"
        else:
            self._unreadable.pop(topic, None)
            self._heard[topic] = steady

    def refuse(self, topic: str, reason: str, now: int) -> None:
        """Trust a topic no longer: its signals are unknown until its next message arrives."""
        if self._unreadable.get(topic) != reason:
            self._unreadable[topic] = reason
            last = self._evaluator.last(topic) if self._setting.stamped else None
            time = now if last is None else last + 1
            self._judge(lambda: self._evaluator.arrive(topic, time, now, None), now)

    def pass_to(self, now: int) -> None:
        """Advance to `now`: all messages received earlier have been processed."""
        self._judge(lambda: self._evaluator.pass_to(now), now)

    def _judge(self, step: "Callable[[], None]", now: int) -> None:
        """Run a step; keep the violations if it begins a new run."""
        monitor, resets = self._evaluator.monitor, self._evaluator.resets
        try:
            step()
        finally:
            if self._evaluator.resets != resets:
                statuses = monitor.statuses()
                self._violated |= {s.requirement for s in statuses if s.verdict == "violated"}
            self._now = now
            self._obligation_pending = self._evaluator.obligation_pending()

    # Output

    @property
    def ticks(self) -> int:
        """The number of ticks evaluated in the present run."""
        return len(self._evaluator.ledger)

    def stop(self, steady: float) -> bool:
        """Whether the robot must stop now."""
        pending = any(self._obligation_pending[i] is not False for i in self._deciding)
        return pending or any(self.fault(topic, steady) for topic in self._needed)

    def fault(self, topic: str, steady: float) -> str:
        """The reason why a topic is unreliable; empty if it is reliable."""
        if topic in self._unreadable:
            return f"a message of {topic} cannot be read: {self._unreadable[topic]}"
        if topic not in self._heard:
            return f"no message of {topic} yet"
        silence = steady - self._heard[topic]
        if self._timeout and topic in self._aging and silence > self._timeout:
            return f"{topic} is silent for {silence:.1f} s"
        return ""

    def states(self) -> "tuple[State, ...]":
        """The status of each requirement; `obligation_pending` counts messages since the tick."""
        key = self._evaluator.changes, self._obligation_pending
        if self._computed[0] != key:  # Most messages change nothing.
            self._computed = key, self._compute_states()
        return self._computed[1]

    def _compute_states(self) -> "tuple[State, ...]":
        monitor = self._evaluator.monitor
        read = zip(monitor.statuses(), self._obligation_pending, monitor.certain.marks())
        return tuple(
            State(
                status.requirement,
                str(status.verdict),
                pending,
                self._time(mark.last if mark.last >= 0 else None),
                self._time(status.open),
                self._time(status.deadline),
                self._time(status.first_violation),
            )
            for status, pending, mark in read
        )

    def news(self) -> "list[dict[str, Any]]":
        """The requirements whose status changed since the last call, as lines of a watch."""
        before, self._states = self._states, self.states()
        if self._states is before:
            return []
        return [
            {"type": "requirement", **state._asdict(), "time_ns": self._now}
            for state in self._states
            if state not in before
        ]

    def _time(self, tick: "int | None") -> "int | None":
        origin = self._evaluator.perception.origin
        if tick is None or origin is None:
            return None
        return origin + self._setting.phase + tick * self._setting.period

    def statuses(self, steady: float) -> "list[Status]":
        """A status of the sources, and one of each requirement."""
        faults = {topic: self.fault(topic, steady) for topic in self._setting.topics}
        wrong = [fault for fault in faults.values() if fault]
        evaluator = self._evaluator
        values = {f"messages of {topic}": count for topic, count in self._counts.items()}
        values.update(
            {
                "ticks": self.ticks,
                "ticks that became unknown": evaluator.ledger.late,
                "clock was set": evaluator.resets,
            }
        )
        sources = status(STALE if wrong else OK, "sources", "; ".join(wrong) or "all come", values)
        own = [
            [faults[each] for each in topics if faults[each]] for _, topics in self._setting.reads
        ]
        states = self.states()
        same_length(states, own)
        return [
            sources,
            *(
                status_of(state, "".join(some[:1]), violated=state.requirement in self._violated)
                for state, some in zip(states, own)
            ),
        ]


def status_of(state: State, fault: str, *, violated: bool = False) -> Status:
    """The diagnostic status of a requirement; a violation stays an error until the node ends.

    Args:
        state: the present status of the requirement.
        fault: the reason why one of its topics is unreliable; empty if there is none.
        violated: whether it was violated in an earlier run.
    """
    values = {name: value for name, value in state._asdict().items() if name != "requirement"}
    if violated or state.verdict == "violated":
        level, message = ERROR, "violated"
    elif fault:
        level, message = STALE, fault
    elif state.obligation_pending is not False:
        level, message = (
            WARN,
            "an obligation is open"
            if state.obligation_pending
            else "unknown whether an obligation is open",
        )
    else:
        level, message = OK, "no obligation is open"
    return status(level, state.requirement, message, values)


def status(level: int, name: str, message: str, values: "Mapping[str, object]") -> Status:
    """A status with its values converted to texts."""
    return Status(level, name, message, tuple((key, str(value)) for key, value in values.items()))


LONGEST = 3600.0
"""The largest `source_timeout` in seconds."""


def bounded(name: str, value: float, least: float, most: float) -> float:
    """The value of a parameter in seconds, after a check of its range.

    Raises:
        ValueError: the value is not a number, or is out of range.
    """
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not is_number or not least <= value <= most:
        raise ValueError(f"{name} is from {least:g} to {most:g} s, not {value!r}")
    return float(value)


# Messages of ROS 1 and ROS 2 ----------------------------------------------------------------------


def stamp(message: Any) -> "int | None":
    """`header.stamp` in nanoseconds, in ROS 2 and in ROS 1; None for a message without one."""
    time = getattr(getattr(message, "header", None), "stamp", None)
    for seconds, nanoseconds in (("sec", "nanosec"), ("secs", "nsecs")):
        if hasattr(time, seconds) and hasattr(time, nanoseconds):
            return int(getattr(time, seconds) * 10**9 + getattr(time, nanoseconds))
    return None


def single_signals(
    setting: BindingConfig, topic: str, message: Any, types: "Callable[[Any], Mapping[str, str]]"
) -> "tuple[str, ...]":
    """The signals of a topic that are read from 32-bit floats.

    Args:
        setting: the configuration from the bindings.
        topic: the topic of the message.
        message: an empty message.
        types: function that gives field -> type name of a message, as the middleware names it.

    Raises:
        ValueError: the message does not have a field of the bindings.
    """
    own = [each for each in setting.policies if each.topic == topic and not each.is_pose]
    for policy in own:
        angles = ("angle_min", "angle_increment") if policy.reduce == "outline" else ()
        for name in (*policy.beside, *angles):
            _type(message, (name,), topic, types)
    return tuple(
        policy.name for policy in own if _SINGLE.match(_type(message, policy.fields, topic, types))
    )


_SINGLE = re.compile(r"(sequence<)?float(32)?(?!\w)")


def _type(
    message: Any, fields: "Sequence[str]", topic: str, types: "Callable[[Any], Mapping[str, str]]"
) -> str:
    name = type(message).__name__
    for index, field in enumerate(fields):
        known = types(message) if hasattr(message, field) else {}
        if field not in known:
            raise ValueError(f"{name} of {topic} has no field {'.'.join(fields[: index + 1])}")
        kind, message = known[field], getattr(message, field)
    return kind
