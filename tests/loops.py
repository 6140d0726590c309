"""Closed loops in tests: sentences, numbers in cells, and the texts that fretc makes."""

from dataclasses import replace
from typing import Any

from compiler.targets.python import monitor as target
from fretc.verification.loop.actuation_model import ActuationAssumptions
from fretc.verification.loop.search import Case
from monitors.interceptor import Options
from monitors.source_text import interceptor
from tests.monitoring import requirement

WITHIN = "whenever near the sw shall within {} ticks satisfy stopped"
EVENTUALLY = "whenever near the sw shall eventually satisfy stopped"


def interceptor_options(**some: int | bool) -> Options:
    """Options of an interceptor; a time that is not given is none."""
    times = ("hold", "stop_timeout", "scan_timeout", "command_timeout")
    none: dict[str, Any] = dict.fromkeys(times, 0)
    return Options(**{**none, **some})


LATCH = interceptor_options(event_driven=True, latching=True)
"""The node of the Safe-ROS paper."""
TIMER = interceptor_options()
CORE = f"{interceptor().imports}\n\n{interceptor().text}\n"


def case(
    sentence: str,
    settings: Options = TIMER,
    channel: ActuationAssumptions = ActuationAssumptions(1),  # noqa: B008
    core: str = CORE,
) -> Case:
    """The case of a sentence about `near` and `stopped`."""
    made = requirement(sentence)
    text = target.text(made)
    return Case("R1", made.ft_infinite, text, text, core, settings, channel, "stopped")


def with_safety(known: Case, text: str) -> Case:
    """The same, with another text in the place of the safety function."""
    return replace(known, safety=text)


def edited(text: str, old: str, new: str) -> str:
    """The text with its one place of `old` changed."""
    assert text.count(old) == 1, (text.count(old), old)
    return text.replace(old, new)


def with_match(text: str) -> str:
    """An interceptor whose core has `match`, as a core of one's own may have."""
    return edited(
        text,
        """\
    if isinstance(event, StopHeard):
        return hear_stop(state, event.requested, options)
    if isinstance(event, CommandHeard):
        return hear_command(state, event.command, options)
    if isinstance(event, ScanHeard):
        return hear_scan(state, options)
    return ring(state, options)
""",
        """\
    match event:
        case StopHeard(requested):
            return hear_stop(state, requested, options)
        case CommandHeard(command):
            return hear_command(state, command, options)
        case ScanHeard():
            return hear_scan(state, options)
        case TimerRang():
            return ring(state, options)
""",
    )
