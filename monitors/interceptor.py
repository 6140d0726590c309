"""The interceptor between the planner and the wheels, as pure steps.

It keeps the last command and passes it on, or zero in its place: while a stop is in force, for some
ticks after it was requested, and where a channel that it watches is silent. No input, no output, no
clock: each step takes values and gives values, and none looks into a velocity. The text is copied
into the files of `--emit interceptor`; the lines `pre:` and `post:` are its contracts (PEP 316), as
CrossHair reads them.

Source of the latch and of the first three contracts: the Safe-ROS paper, its Dafny listing of
`cmd_vel_interceptor`.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple


class Velocity(NamedTuple):
    """What a Twist of ROS holds: m/s along x, y and z, rad/s around them."""

    vx: float = 0.0
    vy: float = 0.0
    vz: float = 0.0
    wx: float = 0.0
    wy: float = 0.0
    wz: float = 0.0


ZERO = Velocity()


@dataclass(frozen=True, slots=True)
class Options:
    """How an interceptor behaves. Times are ticks of its own timer."""

    hold: int
    """For so many ticks after a request zero is published, whatever messages come meanwhile."""
    stop_timeout: int
    """After so many ticks without a message of the safety function the robot halts; 0: never."""
    scan_timeout: int
    """The same for scans."""
    command_timeout: int
    """The same for commands."""
    event_driven: bool = False
    """It publishes only when a command comes, and its timer does nothing: the node of the paper."""
    latching: bool = False
    """The first stop is for ever."""


@dataclass(frozen=True, slots=True)
class State:
    """What an interceptor remembers."""

    stop: bool
    """A stop is requested."""
    held: int
    """Ticks for which zero is still owed after the last request."""
    command: Velocity
    """The last one."""
    stop_age: int
    """Ticks since the last message of the safety function, at most the timeout; likewise below."""
    scan_age: int
    command_age: int


@dataclass(frozen=True, slots=True)
class StopHeard:
    """A message of the safety function: a stop is requested, or is no longer."""

    requested: bool


@dataclass(frozen=True, slots=True)
class CommandHeard:
    """A message of the planner, or of another driver."""

    command: Velocity


@dataclass(frozen=True, slots=True)
class ScanHeard:
    """A message of the sensor; only the safety function reads its content."""


@dataclass(frozen=True, slots=True)
class TimerRang:
    """A tick of the interceptor's own timer."""


def initial(options: Options) -> State:
    """No message has come yet: every watchdog has run out, so that a watched robot stands.

    pre: min(options.hold, options.stop_timeout) >= 0
    pre: min(options.scan_timeout, options.command_timeout) >= 0
    post: within(__return__, options)
    post: not __return__.stop
    post: __return__.command is ZERO
    """
    return State(
        stop=False,
        held=0,
        command=ZERO,
        stop_age=options.stop_timeout,
        scan_age=options.scan_timeout,
        command_age=options.command_timeout,
    )


def halted(state: State, options: Options) -> bool:
    """Whether nothing but zero may go to the wheels.

    post: __return__ or not state.stop
    post: __return__ or state.held <= 0
    """
    return (
        state.stop
        or state.held > 0
        or expired(state.stop_age, options.stop_timeout)
        or expired(state.scan_age, options.scan_timeout)
        or expired(state.command_age, options.command_timeout)
    )


def expired(age: int, timeout: int) -> bool:
    """Whether a watchdog has run out; one of 0 ticks never does.

    post: __return__ == (0 < timeout <= age)
    """
    return timeout > 0 and age >= timeout


def within(state: State, options: Options) -> bool:
    """Whether all numbers are in their ranges."""
    return (
        0 <= state.held <= options.hold
        and 0 <= state.stop_age <= options.stop_timeout
        and 0 <= state.scan_age <= options.scan_timeout
        and 0 <= state.command_age <= options.command_timeout
    )


def hear_stop(state: State, requested: bool, options: Options) -> tuple[State, Velocity | None]:
    """A request is in force at once, and zero does not wait for the next tick.

    pre: within(state, options)
    post: within(__return__[0], options)
    post: __return__[0].stop == (requested or (options.latching and state.stop))
    post: __return__[0].held == (options.hold if requested else state.held)
    post: __return__[0].stop_age == 0
    post: __return__[0].command is state.command
    post: __return__[1] is (ZERO if requested and not options.event_driven else None)
    """
    after = replace(
        state,
        stop=requested or (options.latching and state.stop),
        held=options.hold if requested else state.held,
        stop_age=0,
    )
    return after, ZERO if requested and not options.event_driven else None


def hear_command(
    state: State, command: Velocity, options: Options
) -> tuple[State, Velocity | None]:
    """A command is passed on unchanged, or is zero where the robot is halted.

    pre: within(state, options)
    post: within(__return__[0], options)
    post: __return__[0].stop == state.stop
    post: __return__[0].held == state.held
    post: __return__[0].command is command
    post: __return__[0].command_age == 0
    post: __return__[1] is (ZERO if halted(__return__[0], options) else command)
    """
    after = replace(state, command=command, command_age=0)
    return after, ZERO if halted(after, options) else command


def hear_scan(state: State, options: Options) -> tuple[State, Velocity | None]:
    """The sensor lives.

    pre: within(state, options)
    post: within(__return__[0], options)
    post: __return__[0] == replace(state, scan_age=0)
    post: __return__[1] is None
    """
    return replace(state, scan_age=0), None


def ring(state: State, options: Options) -> tuple[State, Velocity | None]:
    """Time passes: the last messages grow older, and `held` counts down.

    pre: within(state, options)
    post: within(__return__[0], options)
    post: __return__[0].stop == state.stop
    post: __return__[0].command is state.command
    post: __return__[0] == state or not options.event_driven
    post: (__return__[1] is None) == options.event_driven
    post: options.event_driven or __return__[0].held == max(state.held - 1, 0)
    post: options.event_driven or __return__[1] is ZERO or __return__[1] is state.command
    post: options.event_driven or __return__[1] is ZERO or not halted(state, options)
    post: options.event_driven or __return__[1] is ZERO or not halted(__return__[0], options)
    """
    if options.event_driven:
        return state, None
    older = replace(
        state,
        stop_age=min(state.stop_age + 1, options.stop_timeout),
        scan_age=min(state.scan_age + 1, options.scan_timeout),
        command_age=min(state.command_age + 1, options.command_timeout),
    )
    output = ZERO if halted(older, options) else state.command
    return replace(older, held=max(state.held - 1, 0)), output


def step(
    state: State, event: StopHeard | CommandHeard | ScanHeard | TimerRang, options: Options
) -> tuple[State, Velocity | None]:
    """The state after an event, and what is published; None: nothing is.

    pre: within(state, options)
    post: within(__return__[0], options)
    post: __return__[0].stop or not (options.latching and state.stop)
    post: __return__[1] is None or __return__[1] is ZERO or not halted(__return__[0], options)
    """
    match event:
        case StopHeard(requested):
            return hear_stop(state, requested, options)
        case CommandHeard(command):
            return hear_command(state, command, options)
        case ScanHeard():
            return hear_scan(state, options)
        case TimerRang():
            return ring(state, options)
