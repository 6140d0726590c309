"""The interceptor between the planner and the wheels, as pure functions.

It passes on the last command, or publishes zero instead: while a stop is requested, for `hold`
ticks after a request, and while a channel with a timeout is silent. The functions have no input,
output or clock, and do not inspect velocities. Their text is copied into the files of `--emit
interceptor`. The lines `pre:` and `post:` are contracts (PEP 316) that CrossHair checks.

Source of the latch and of the first three contracts: the Dafny listing of `cmd_vel_interceptor` in
the Safe-ROS paper.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple


class Velocity(NamedTuple):
    """The contents of a ROS Twist: m/s along x, y and z, rad/s around them."""

    vx: float = 0.0
    vy: float = 0.0
    vz: float = 0.0
    wx: float = 0.0
    wy: float = 0.0
    wz: float = 0.0


ZERO = Velocity()


@dataclass(frozen=True)
class Options:
    """The configuration of an interceptor. Times are in ticks of its own timer."""

    hold: int
    """Ticks after a stop request during which zero is published, whatever messages arrive."""
    stop_timeout: int
    """Ticks without a message of the safety function after which the robot halts; 0: never."""
    scan_timeout: int
    """Ticks without a scan after which the robot halts; 0: never."""
    command_timeout: int
    """Ticks without a command after which the robot halts; 0: never."""
    event_driven: bool = False
    """Publish only when a command arrives; the timer has no effect (the node of the paper)."""
    latching: bool = False
    """The first stop is permanent."""


@dataclass(frozen=True)
class State:
    """The state of an interceptor."""

    stop: bool
    """Whether a stop is requested."""
    held: int
    """Remaining ticks of zero after the last stop request."""
    command: Velocity
    """The last command."""
    stop_age: int
    """Ticks since the last message of the safety function, at most the timeout; likewise below."""
    scan_age: int
    command_age: int


@dataclass(frozen=True)
class StopHeard:
    """A message of the safety function: a stop request or its release."""

    requested: bool


@dataclass(frozen=True)
class CommandHeard:
    """A message of the planner, or of another driver."""

    command: Velocity


@dataclass(frozen=True)
class ScanHeard:
    """A message of the sensor, whose contents only the safety function reads."""


@dataclass(frozen=True)
class TimerRang:
    """A tick of the interceptor's own timer."""


def initial(options: Options) -> State:
    """The state before the first message: every timeout has expired, so that the robot stands.

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
    """Whether only zero may be sent to the wheels.

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
    """Whether a timeout has expired; a timeout of 0 never expires.

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


def hear_stop(state: State, requested: bool, options: Options) -> "tuple[State, Velocity | None]":
    """Process a message of the safety function; a stop request publishes zero at once.

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
) -> "tuple[State, Velocity | None]":
    """Process a command: it is passed on unchanged, or replaced by zero if the robot is halted.

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


def hear_scan(state: State, options: Options) -> "tuple[State, Velocity | None]":
    """Process a scan: its age becomes 0.

    pre: within(state, options)
    post: within(__return__[0], options)
    post: __return__[0] == replace(state, scan_age=0)
    post: __return__[1] is None
    """
    return replace(state, scan_age=0), None


def ring(state: State, options: Options) -> "tuple[State, Velocity | None]":
    """Process a tick of the timer: ages increase, and `held` decreases.

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
    state: State, event: "StopHeard | CommandHeard | ScanHeard | TimerRang", options: Options
) -> "tuple[State, Velocity | None]":
    """The state after an event, and the published velocity; None: nothing is published.

    pre: within(state, options)
    post: within(__return__[0], options)
    post: __return__[0].stop or not (options.latching and state.stop)
    post: __return__[1] is None or __return__[1] is ZERO or not halted(__return__[0], options)
    """
    if isinstance(event, StopHeard):
        return hear_stop(state, event.requested, options)
    if isinstance(event, CommandHeard):
        return hear_command(state, event.command, options)
    if isinstance(event, ScanHeard):
        return hear_scan(state, options)
    return ring(state, options)
