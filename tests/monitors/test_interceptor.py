"""The interceptor's steps against a naive reading of whole histories, and its contracts."""

import inspect
import re
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from monitors import interceptor
from monitors.interceptor import (
    ZERO,
    CommandHeard,
    Options,
    ScanHeard,
    State,
    StopHeard,
    TimerRang,
    Velocity,
    halted,
    initial,
    step,
)

FAST, SLOW = Velocity(0.4, wz=0.1), Velocity(-0.15)
STOP, GO, SCAN, RING = StopHeard(True), StopHeard(False), ScanHeard(), TimerRang()
Heard = StopHeard | CommandHeard | ScanHeard | TimerRang
PAPER = Options(0, 0, 0, 0, event_driven=True)
LATCHING = Options(0, 0, 0, 0, event_driven=True, latching=True)

events = st.one_of(
    st.sampled_from([STOP, GO, SCAN, RING, RING, RING]),
    st.sampled_from([CommandHeard(FAST), CommandHeard(SLOW), CommandHeard(ZERO)]),
)
timed = st.builds(
    Options,
    hold=st.integers(0, 4),
    stop_timeout=st.integers(0, 4),
    scan_timeout=st.integers(0, 3),
    command_timeout=st.integers(0, 4),
    latching=st.booleans(),
)
options = st.one_of(timed, st.sampled_from([PAPER, LATCHING]))


def outputs(options: Options, *messages: Heard) -> list[Velocity | None]:
    state, out = initial(options), []
    for message in messages:
        state, command = step(state, message, options)
        out.append(command)
    return out


def rings(history: list[Heard], kind: type, value: object = None) -> int | None:
    """Ticks since the last message of the kind; None: there was none."""
    places = [i for i, m in enumerate(history) if isinstance(m, kind) and value in (None, m)]
    return sum(m == RING for m in history[places[-1] :]) if places else None


def by_prose(history: list[Heard], options: Options) -> Velocity | None:
    """What is published at the last message, by the words of the documentation."""
    now = history[-1]
    stops = [m.requested for m in history if isinstance(m, StopHeard)]
    requested = any(stops) if options.latching else [False, *stops][-1]
    since = rings(history, StopHeard, STOP)
    pending = since is not None and (since <= options.hold if now == RING else since < options.hold)
    silent = [
        timeout > 0 and (age is None or age >= timeout)
        for timeout, age in (
            (options.stop_timeout, rings(history, StopHeard)),
            (options.scan_timeout, rings(history, ScanHeard)),
            (options.command_timeout, rings(history, CommandHeard)),
        )
    ]
    commands = [m.command for m in history if isinstance(m, CommandHeard)]
    passed = ZERO if requested or pending or any(silent) else [ZERO, *commands][-1]
    if options.event_driven:
        return passed if isinstance(now, CommandHeard) else None
    if now == STOP:
        return ZERO
    return passed if now == RING or isinstance(now, CommandHeard) else None


@given(options, st.lists(events, max_size=30))
@example(Options(1, 0, 0, 0), [CommandHeard(FAST), STOP, GO, RING, RING])
@example(Options(2, 3, 0, 0), [GO, CommandHeard(FAST), RING, RING, RING, GO, RING])
def test_it_says_what_the_words_say(options: Options, messages: list[Heard]) -> None:
    expected = [by_prose(messages[: i + 1], options) for i in range(len(messages))]
    assert outputs(options, *messages) == expected


def test_the_papers_node_speaks_only_when_a_command_comes() -> None:
    command = CommandHeard(FAST)
    assert outputs(PAPER, command, STOP, RING, command, GO, RING, command) == [
        FAST, None, None, ZERO, None, None, FAST,
    ]  # fmt: skip
    assert outputs(LATCHING, command, STOP, command, GO, command) == [FAST, None, ZERO, None, ZERO]


def test_zero_is_held_for_its_ticks_after_the_last_request() -> None:
    options = Options(2, 0, 0, 0)
    messages = (CommandHeard(FAST), STOP, GO, RING, STOP, GO, RING, RING, RING)
    assert outputs(options, *messages) == [FAST, ZERO, None, ZERO, ZERO, None, ZERO, ZERO, FAST]


def test_a_watched_robot_stands_until_everything_was_heard_and_after_silence() -> None:
    options = Options(0, 2, 1, 0)
    command = CommandHeard(FAST)
    assert outputs(options, command, GO, command, SCAN, command) == [ZERO, None, ZERO, None, FAST]
    messages = (GO, SCAN, command, RING, SCAN, RING, SCAN, GO, command)
    assert outputs(options, *messages) == [None, None, FAST, ZERO, None, ZERO, None, None, FAST]


def test_no_step_looks_into_a_velocity() -> None:
    command: Any = object()
    assert outputs(Options(1, 2, 0, 2), GO, CommandHeard(command), RING, STOP, GO, RING, RING) == [
        None, command, command, ZERO, None, ZERO, ZERO,
    ]  # fmt: skip


# The contracts --------------------------------------------------------------------------------

FUNCTIONS = (
    "initial",
    "halted",
    "expired",
    "hear_stop",
    "hear_command",
    "hear_scan",
    "ring",
    "step",
)


def lines(function: Callable[..., Any], kind: str) -> list[str]:
    return re.findall(rf"^ *{kind}: (.*)$", inspect.getdoc(function) or "", re.MULTILINE)


def checked(function: Callable[..., Any]) -> Callable[..., Any]:
    """It, with each of its lines evaluated."""
    names = tuple(inspect.signature(function).parameters)

    def call(*given: Any) -> Any:
        known = {**vars(interceptor), **dict(zip(names, given, strict=True))}
        for line in lines(function, "pre"):
            assert eval(line, known), line
        result = function(*given)
        for line in lines(function, "post"):
            assert eval(line, {**known, "__return__": result}), (line, given, result)
        return result

    return call


@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_function_states_what_it_promises(name: str) -> None:
    assert lines(getattr(interceptor, name), "post")


@pytest.mark.slow
@given(options, st.lists(events, max_size=20))
@example(LATCHING, [STOP, GO])
@example(Options(2, 0, 0, 0), [CommandHeard(FAST), STOP, GO, RING, RING, RING])
def test_each_line_of_the_contracts_holds_wherever_it_is_called(
    options: Options, messages: list[Heard]
) -> None:
    with pytest.MonkeyPatch.context() as patched:
        for name in FUNCTIONS:
            patched.setattr(interceptor, name, checked(getattr(interceptor, name)))
        state: State = interceptor.initial(options)
        for message in messages:
            state, command = interceptor.step(state, message, options)
            assert command in (None, ZERO) or not halted(state, options)
