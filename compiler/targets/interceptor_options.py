"""The options of the interceptor that the bindings declare, in ticks of its own timer."""

from __future__ import annotations

from dataclasses import asdict

from fretish.bindings.canonical import clock, digest
from fretish.bindings.declarations import (
    Declarations,
    Interception,
    InterceptorForm,
    LoopAssumptions,
    Requests,
)
from monitors.interceptor import Options


def options(interception: Interception) -> Options:
    """Durations become ticks, rounded up.

    Ticks are not synchronized with requests: `hold` of n ticks ends with the n-th tick after the
    request, more than n - 1 periods after it; a timeout of n ticks halts at most n periods after
    the last message.
    """
    if interception.form is InterceptorForm.EVENT:
        return Options(0, 0, 0, 0, event_driven=True, latching=interception.latching)
    period = interception.period
    return Options(
        hold=ticks(interception.hold, period),
        stop_timeout=ticks(interception.stop_timeout, period),
        scan_timeout=ticks(interception.scan_timeout, period),
        command_timeout=ticks(interception.command_timeout, period),
        latching=interception.latching,
    )


ASSUMED = "[interceptor] and [assume]"
"""The name of the assumptions among the artefacts of a proof about the closed loop."""


def assumptions_digest(declarations: Declarations) -> str:
    """SHA-256 of `[interceptor]` and `[assume]`; "" without `[assume]`.

    Equal meanings have equal digests. The clock is included, since times are counted in ticks.
    """
    if declarations.assumed is None:
        return ""
    loop = (declarations.interceptor, declarations.assumed)
    tables = [{**asdict(part), "span": None} if part else None for part in loop]
    return digest([clock(declarations.clock), *tables])


def ticks(duration: int, period: int) -> int:
    """The number of periods that cover the duration; both in nanoseconds, the period above 0."""
    return -(-duration // period)


def repetition(assumption: LoopAssumptions, tick: int) -> int | None:
    """Ticks after which an unchanged request is sent again; None: never.

    Args:
        assumption: the assumptions about the safety function.
        tick: the length of its tick in nanoseconds.
    """
    if assumption.requests is Requests.LEVEL:
        return 1
    return ticks(assumption.heartbeat, tick) or None
