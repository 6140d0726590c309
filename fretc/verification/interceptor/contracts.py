"""Show that the text of an interceptor keeps its contracts, by walking through all it can do.

The core is executed in every state that it can come to, with every kind of message, breadth first.
Beside it goes what has been heard, written down here independently of the core: what a contract
demands is read off that, never off the core's own state. Commands are opaque
(`fretc.verification.interceptor.opaque`), so a result holds for all velocities. A shortest run is
told where a contract is broken.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from compiler.files.text_files import sha256
from compiler.logic.claims import Layer, Outcome, Proof, Trace, not_checked, proof, proved, refuted
from fretc.verification.interceptor.exploration import Search, explored
from fretc.verification.interceptor.incoming import (
    CHANNELS,
    COMMAND,
    RELEASE,
    RING,
    STOP,
    Moment,
    Seen,
    stands,
)
from monitors.interceptor import Options

MOST_STATES = 200_000
"""Some ten seconds and half a gigabyte."""


@dataclass(frozen=True, slots=True)
class Contract:
    """A claim about every step, or about the first state."""

    claim: str
    broken: Callable[[Moment], bool]


def contracts(
    text: str, options: Options, requirement: str = "interceptor", most: int = MOST_STATES
) -> tuple[Proof, ...]:
    """Every contract of an interceptor with the options, each proved, refuted or not checked.

    Args:
        text: what `--emit interceptor` wrote; the core is executed once it is known to be pure.
        options: those that the bindings declare.
        requirement: whom the evidence is for.
        most: states; with more, nothing is known.
    """
    claims = tuple(_contracts(options))
    found = _results(text, options, claims, most)
    return tuple(
        proof(
            requirement,
            Layer.INTERCEPTOR,
            contract.claim,
            result,
            "every state and message of the core, explored",
            tuple(_assumptions(options)),
            {"interceptor.py": sha256(text)},
        )
        for contract, result in zip(claims, found, strict=True)
    )


def _assumptions(options: Options) -> Iterator[str]:
    yield "the ROS node hands every message to the core, one at a time, and publishes what it says"
    if options.event_driven:
        yield "no silence is noticed: form = event in [interceptor]"
        return
    yield "the timer rings at every period in [interceptor]"
    for name, channel in (("stop", "the safety function"), ("scan", "the sensor")):
        if not getattr(options, f"{name}_timeout"):
            yield f"{channel} is never silent for long: no {name}_timeout in [interceptor]"


# What is demanded -----------------------------------------------------------------------------


def _contracts(options: Options) -> Iterator[Contract]:
    """Those that the options call for."""
    yield from _of_the_paper(options)
    yield from _of_a_stop(options)
    for name, channel in CHANNELS:
        timeout = getattr(options, f"{name}_timeout")
        if timeout:
            yield Contract(
                f"{timeout} ticks of the timer after the last message of {channel}, and until the "
                "next one, nothing but zero is published",
                _silence(name, timeout),
            )
    yield from _of_speech(options)


def _of_the_paper(options: Options) -> Iterator[Contract]:
    """The three proof obligations of the paper."""
    yield Contract(
        "at first no stop is in force",
        lambda m: m.heard == "" and bool(m.state.stop),
    )
    latch = ", and no message clears it" if options.latching else " or clears it"
    yield Contract(
        f"each message of the safety function sets the stop{latch}",
        lambda m: (
            m.heard in (STOP, RELEASE)
            and m.state.stop != (m.after.requested or (options.latching and m.after.ever))
        ),
    )
    yield Contract(
        "each command is passed on unchanged, or is zero where the robot must stand",
        lambda m: m.heard == COMMAND and m.said != ("zero" if stands(m.after, options) else "last"),
    )


def _of_a_stop(options: Options) -> Iterator[Contract]:
    yield Contract(
        "while a stop is requested nothing but zero is published",
        lambda m: m.after.requested and m.said not in ("nothing", "zero"),
    )
    if options.latching:
        yield Contract(
            "after the first request nothing but zero is ever published",
            lambda m: m.after.ever and m.said not in ("nothing", "zero"),
        )
    if not options.event_driven:
        yield Contract(
            "zero is published at once on a request",
            lambda m: m.heard == STOP and m.said != "zero",
        )
    if options.hold:
        yield Contract(
            f"after a request nothing but zero is published up to tick {options.hold} of the "
            "timer, and zero at each of these ticks",
            _short_hold,
        )


def _short_hold(m: Moment) -> bool:
    if m.heard == RING:
        return m.before.owed > 0 and m.said != "zero"
    return m.after.owed > 0 and m.said not in ("nothing", "zero")


def _silence(name: str, timeout: int) -> Callable[[Moment], bool]:
    return lambda m: getattr(m.after, name) >= timeout and m.said not in ("nothing", "zero")


def _of_speech(options: Options) -> Iterator[Contract]:
    yield Contract(
        "nothing but zero and the last command is ever published",
        lambda m: m.said == "other",
    )
    if options.event_driven:
        yield Contract(
            "something is published when a command comes, and at no other time",
            lambda m: m.heard != "" and (m.said == "nothing") == (m.heard == COMMAND),
        )
    else:
        yield Contract(
            "at each tick of the timer something is published",
            lambda m: m.heard == RING and m.said == "nothing",
        )
        yield Contract(
            "at a tick without a reason to stand the last command is published",
            lambda m: (
                m.heard == RING
                and not stands(m.after._replace(owed=m.before.owed), options)
                and m.said != ("zero" if m.after.last is None else "last")
            ),
        )
    yield Contract(
        "every number that the core keeps stays between 0 and its bound",
        _outside(options),
    )


def _outside(options: Options) -> Callable[[Moment], bool]:
    bounds = [("held", options.hold)]
    bounds += [(f"{name}_age", getattr(options, f"{name}_timeout")) for name, _ in CHANNELS]
    return lambda m: not all(0 <= getattr(m.state, name) <= bound for name, bound in bounds)


# Results -----------------------------------------------------------------------------------


def _results(text: str, options: Options, claims: tuple[Contract, ...], most: int) -> list[Outcome]:
    """The result of each contract."""
    timed = (options.hold, options.stop_timeout, options.scan_timeout, options.command_timeout)
    if options.event_driven and any(timed):
        found: Search | str = (
            "an interceptor without a timer cannot measure the times that are declared"
        )
    else:
        found = explored(text, options, [contract.broken for contract in claims], most)
    if isinstance(found, str):
        return [not_checked(found) for _ in claims]
    looked = f"{len(found.came)} states, {found.steps} steps"
    return [
        refuted(f"a run of {len(run)} steps breaks it", _trace(run, options))
        if (run := found.run(i)) is not None
        else proved(looked)
        for i in range(len(claims))
    ]


_SAID: Mapping[str, str] = {
    "nothing": "nothing is published",
    "zero": "zero is published",
    "last": "the last command is published",
    "other": "something else is published",
}


def _trace(run: list[tuple[str, str, Seen]], options: Options) -> Trace:
    """A row for each step."""
    watched = [name for name, _ in CHANNELS if getattr(options, f"{name}_timeout")]
    names = ("stop requested", "must stand", "zero", "command", *(f"{w} silent" for w in watched))
    rows = tuple(
        (
            seen.requested,
            stands(seen, options),
            said == "zero",
            said not in ("zero", "nothing"),
            *(getattr(seen, w) >= getattr(options, f"{w}_timeout") for w in watched),
        )
        for _, said, seen in run
    )
    actions = tuple(f"{heard}: {_SAID[said]}" for heard, said, _ in run)
    return Trace(names, rows, actions)
