"""Prove that the text of an interceptor satisfies its contracts, by exploring all its states.

The core is executed in every reachable state, with every kind of message, breadth first. The
history of its messages is computed beside it and independent of it, so that a contract depends on
the history, never on the core's own state. Commands are opaque
(`fretc.verification.interceptor.opaque`), so a result holds for all velocities. A shortest run
shows a violation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from compiler.files.text_files import sha256
from compiler.logic.claims import (
    ClaimOutcome,
    ClaimTrace,
    Layer,
    Proof,
    not_checked,
    proof,
    proved,
    refuted,
)
from fretc.verification.interceptor.exploration import Search, Step, explore
from fretc.verification.interceptor.incoming import (
    CHANNELS,
    COMMAND,
    RELEASE,
    RING,
    STOP,
    ContractStep,
    stands,
)
from fretish.classes.frozen import dataclass
from monitors.interceptor import Options

MOST_STATES = 200_000
"""Maximum number of states: some ten seconds and half a gigabyte."""


@dataclass(frozen=True, slots=True)
class Contract:
    """A claim about every step, or about the first state."""

    claim: str
    broken: Callable[[ContractStep], bool]


def contracts(
    text: str, options: Options, requirement: str = "interceptor", most: int = MOST_STATES
) -> tuple[Proof, ...]:
    """Every contract of an interceptor with these options: proved, refuted or not checked.

    Args:
        text: output of `--emit interceptor`; the core is executed only if it is pure.
        options: options that the bindings declare.
        requirement: name of the proofs.
        most: maximum number of states; with more, the contracts are not checked.
    """
    claims = tuple(_contracts(options))
    outcomes = _outcomes(text, options, claims, most)
    return tuple(
        proof(
            requirement,
            Layer.INTERCEPTOR,
            contract.claim,
            outcome,
            "every state and message of the core, explored",
            tuple(_assumptions(options)),
            {"interceptor.py": sha256(text)},
        )
        for contract, outcome in zip(claims, outcomes, strict=True)
    )


def _assumptions(options: Options) -> Iterator[str]:
    yield (
        "the ROS node passes every message to the core, one at a time, and publishes the "
        "core's output"
    )
    if options.event_driven:
        yield "silence is not detected: form = event in [interceptor]"
        return
    yield "the timer expires at every period in [interceptor]"
    for name, channel in (("stop", "the safety function"), ("scan", "the sensor")):
        if not getattr(options, f"{name}_timeout"):
            yield f"{channel} is never silent for long: no {name}_timeout in [interceptor]"


# Demands ------------------------------------------------------------------------------------


def _contracts(options: Options) -> Iterator[Contract]:
    """The contracts for these options."""
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
    yield from _of_the_output(options)


def _of_the_paper(options: Options) -> Iterator[Contract]:
    """The three proof obligations of the paper."""
    yield Contract(
        "initially no stop is in force",
        lambda m: m.event == "" and bool(m.state.stop),
    )
    latch = ", and no message clears it" if options.latching else " or clears it"
    yield Contract(
        f"each message of the safety function sets the stop{latch}",
        lambda m: (
            m.event in (STOP, RELEASE)
            and m.state.stop != (m.after.requested or (options.latching and m.after.ever))
        ),
    )
    yield Contract(
        "each command is passed on unchanged, or is zero where the robot must stand",
        lambda m: (
            m.event == COMMAND and m.output != ("zero" if stands(m.after, options) else "last")
        ),
    )


def _of_a_stop(options: Options) -> Iterator[Contract]:
    yield Contract(
        "while a stop is requested nothing but zero is published",
        lambda m: m.after.requested and m.output not in ("nothing", "zero"),
    )
    if options.latching:
        yield Contract(
            "after the first request nothing but zero is ever published",
            lambda m: m.after.ever and m.output not in ("nothing", "zero"),
        )
    if not options.event_driven:
        yield Contract(
            "zero is published at once on a request",
            lambda m: m.event == STOP and m.output != "zero",
        )
    if options.hold:
        yield Contract(
            f"after a request nothing but zero is published up to tick {options.hold} of the "
            "timer, and zero at each of these ticks",
            _short_hold,
        )


def _short_hold(m: ContractStep) -> bool:
    if m.event == RING:
        return m.before.hold_pending > 0 and m.output != "zero"
    return m.after.hold_pending > 0 and m.output not in ("nothing", "zero")


def _silence(name: str, timeout: int) -> Callable[[ContractStep], bool]:
    return lambda m: getattr(m.after, name) >= timeout and m.output not in ("nothing", "zero")


def _of_the_output(options: Options) -> Iterator[Contract]:
    yield Contract(
        "nothing but zero and the last command is ever published",
        lambda m: m.output == "other",
    )
    if options.event_driven:
        yield Contract(
            "something is published when a command comes, and at no other time",
            lambda m: m.event != "" and (m.output == "nothing") == (m.event == COMMAND),
        )
    else:
        yield Contract(
            "at each tick of the timer something is published",
            lambda m: m.event == RING and m.output == "nothing",
        )
        yield Contract(
            "at a tick without a reason to stand the last command is published",
            lambda m: (
                m.event == RING
                and not stands(m.after._replace(hold_pending=m.before.hold_pending), options)
                and m.output != ("zero" if m.after.last is None else "last")
            ),
        )
    yield Contract(
        "every number that the core keeps stays between 0 and its bound",
        _outside(options),
    )


def _outside(options: Options) -> Callable[[ContractStep], bool]:
    bounds = [("held", options.hold)]
    bounds += [(f"{name}_age", getattr(options, f"{name}_timeout")) for name, _ in CHANNELS]
    return lambda m: not all(0 <= getattr(m.state, name) <= bound for name, bound in bounds)


# Outcomes ----------------------------------------------------------------------------------


def _outcomes(
    text: str, options: Options, claims: tuple[Contract, ...], most: int
) -> list[ClaimOutcome]:
    """The outcome of each contract."""
    timed = (options.hold, options.stop_timeout, options.scan_timeout, options.command_timeout)
    if options.event_driven and any(timed):
        search: Search | str = (
            "an interceptor without a timer cannot measure the times that are declared"
        )
    else:
        search = explore(text, options, [contract.broken for contract in claims], most)
    if isinstance(search, str):
        return [not_checked(search) for _ in claims]
    size = f"{len(search.origins)} states, {search.steps} steps"
    return [
        refuted(f"a run of {len(run)} steps breaks it", _trace(run, options))
        if (run := search.run(i)) is not None
        else proved(size)
        for i in range(len(claims))
    ]


_OUTPUTS: Mapping[str, str] = {
    "nothing": "nothing is published",
    "zero": "zero is published",
    "last": "the last command is published",
    "other": "something else is published",
}


def _trace(run: list[Step], options: Options) -> ClaimTrace:
    """The steps of a run as a table."""
    watched = [name for name, _ in CHANNELS if getattr(options, f"{name}_timeout")]
    names = ("stop requested", "must stand", "zero", "command", *(f"{w} silent" for w in watched))
    rows = tuple(
        (
            step.history.requested,
            stands(step.history, options),
            step.output == "zero",
            step.output not in ("zero", "nothing"),
            *(getattr(step.history, w) >= getattr(options, f"{w}_timeout") for w in watched),
        )
        for step in run
    )
    actions = tuple(f"{step.event}: {_OUTPUTS[step.output]}" for step in run)
    return ClaimTrace(names, rows, actions)
