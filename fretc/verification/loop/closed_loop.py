"""The closed loop of monitor, interceptor and any environment, and its two claims.

The search explores the code itself: the monitor as the safety function that requests stops, the
generated monitor of the sentence as the observer, and the steps of the interceptor. The model
between them is `fretc.verification.loop.model`, and its durations are whole cells, rounded up.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import gcd
from typing import TypeVar

from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import exclusion_in_words, impossible_combinations
from compiler.logic import spot as automata
from compiler.logic.claims import ClaimOutcome, Layer, Proof, not_applicable, not_checked, proof
from compiler.targets.interceptor_options import ASSUMED, options, ticks
from compiler.targets.interceptor_options import assumptions_digest as hash_of_assumed
from compiler.targets.python import monitor as target
from fretc.verification.engines import sandbox as processes
from fretc.verification.engines.sandbox import CallLimits, NoResult
from fretc.verification.interceptor.file import otherwise
from fretc.verification.loop.actuation_model import ActuationAssumptions
from fretc.verification.loop.search import Case, Results, search
from fretish.bindings.declarations import (
    Interception,
    InterceptorForm,
    LoopAssumptions,
    Planner,
    Requests,
)
from fretish.classes.frozen import dataclass
from fretish.clock import in_words
from fretish.expressions import names

KEPT = "monitor, interceptor and any environment together satisfy the requirement"
RELEASED = "the stop is released once no demand begins any more"
_FINEST = 20
"""Maximum number of cells in a tick if the interceptor has no timer to define a cell."""


P = TypeVar("P")
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class NamedText:
    """A text to verify, and its name in proofs."""

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Setup:
    """Parts of a loop besides the requirement; None: not declared."""

    monitor: NamedText
    interceptor: NamedText | None
    interception: Interception | None
    assumed: LoopAssumptions | None


def loop_proofs(
    requirement: FormalizedRequirement, setup: Setup, limits: CallLimits
) -> tuple[Proof, ...]:
    """Proofs of both claims: the requirement is satisfied, and the stop is released."""
    reason = inapplicable(requirement, setup)
    problem = reason or case(requirement, setup)
    found = answered(reason, problem, search, limits)
    results = Results(found, found) if isinstance(found, ClaimOutcome) else found
    premises = () if isinstance(problem, str) else tuple(assumptions(requirement, setup, problem))
    return (
        _evidence(requirement, setup, KEPT, results.kept, premises),
        _evidence(requirement, setup, RELEASED, results.released, premises),
    )


def answered(
    inapplicable: str | None, problem: P | str, search: Callable[[P], R], limits: CallLimits
) -> R | ClaimOutcome:
    """The result of a search, or one outcome for all of its claims.

    Args:
        inapplicable: why no search decides the requirement; None: one does.
        problem: the problem to search; or why it cannot be searched.
        search: a function for another process.
        limits: the limits of the process.
    """
    if inapplicable is not None:
        return not_applicable(inapplicable)
    if isinstance(problem, str):
        return not_checked(problem)
    result = processes.confined(limits, search, problem)
    return not_checked(result.reason) if isinstance(result, NoResult) else result


def _evidence(
    requirement: FormalizedRequirement,
    setup: Setup,
    claim: str,
    result: ClaimOutcome,
    premises: tuple[str, ...],
) -> Proof:
    return proof(
        requirement.id,
        Layer.LOOP,
        claim,
        result,
        engine(),
        premises,
        artefacts(requirement, setup),
    )


def engine() -> str:
    """The engine as proofs name it."""
    own = "fretc, explicit states"
    return f"{own}; Spot {automata.version()}" if automata.is_installed() else own


def artefacts(requirement: FormalizedRequirement, setup: Setup) -> dict[str, str]:
    """SHA-256 of each text, and of the assumptions of the bindings."""
    texts = [setup.monitor, *([setup.interceptor] if setup.interceptor else [])]
    hashes = {text.name: sha256(text.text) for text in texts}
    digest = hash_of_assumed(requirement.declarations) if requirement.declarations else ""
    return {**hashes, ASSUMED: digest} if digest else hashes


# The case -------------------------------------------------------------------------------------


def inapplicable(requirement: FormalizedRequirement, setup: Setup) -> str | None:
    """Why no loop decides the requirement; None: one does."""
    if setup.interception is None or setup.interceptor is None:
        return "the bindings declare no interceptor (`[interceptor]`)"
    if setup.assumed is None:
        return "the bindings state no assumptions about the loop (`[assume]`)"
    stands = setup.assumed.stands
    if stands not in {name.id for name in names(requirement.sentence.response)}:
        return f"its response does not mention `{stands}`, which the loop controls"
    return None


def case(requirement: FormalizedRequirement, setup: Setup) -> Case | str:
    """The case to search; or why it cannot be searched."""
    interception, assumed = setup.interception, setup.assumed
    assert interception is not None
    assert setup.interceptor is not None
    assert assumed is not None
    deviation = otherwise(setup.interceptor.text, interception)
    if deviation is not None:
        return deviation
    declared = channel(requirement, interception, assumed)
    if isinstance(declared, str):
        return declared
    return Case(
        requirement.id,
        requirement.ft_infinite,
        setup.monitor.text,
        target.text(requirement),
        setup.interceptor.text,
        options(interception),
        declared,
        assumed.stands,
        excluded=impossible_combinations(requirement),
    )


def channel(
    requirement: FormalizedRequirement, interception: Interception, assumed: LoopAssumptions
) -> ActuationAssumptions | str:
    """The assumptions in cells; or why no cell fits."""
    tick = requirement.clock.period if requirement.clock else None
    if tick is None:
        return "the clock has no period: it ticks with messages"
    cell = cell_of(tick, interception, assumed)
    if tick % cell:
        return (
            f"a tick of the clock, {in_words(tick)}, is not a whole number of periods of the "
            f"interceptor's timer, {in_words(cell)}"
        )
    return ActuationAssumptions(
        tick // cell,
        ticks(assumed.latency, cell),
        assumed.lost,
        assumed.requests is Requests.EDGE,
        assumed.planner is Planner.EVERY_TICK,
        ticks(assumed.braking, cell),
        interception.scan is not None,
        ticks(assumed.heartbeat, tick),
    )


def cell_of(tick: int, interception: Interception, assumed: LoopAssumptions) -> int:
    """Length of a cell in nanoseconds: the timer's period, or the best unit for the durations."""
    if interception.form is InterceptorForm.TIMER:
        return interception.period
    exact = gcd(tick, assumed.latency, assumed.braking)
    return exact if tick // exact <= _FINEST else tick


# Assumptions ----------------------------------------------------------------------------------


def assumptions(
    requirement: FormalizedRequirement, setup: Setup, problem: Case, *, any_time: bool = False
) -> Iterator[str]:
    """Assumptions of the verdict in words, each with the table that declares it.

    Args:
        requirement: the requirement.
        setup: the declarations.
        problem: the case of requirement and setup.
        any_time: whether the verdict holds for all latencies, losses and braking times.
    """
    interception, assumed, channel = setup.interception, setup.assumed, problem.channel
    assert interception is not None
    assert assumed is not None
    assert requirement.clock is not None
    tick = requirement.clock.period or 0
    yield from _messages(assumed, tick, any_time=any_time)
    if channel.punctual:
        yield "the planner sends a command in every tick (`planner`, [assume])"
    braking = "`braking`" if any_time else f"{in_words(assumed.braking)} (`braking`, [assume])"
    yield (
        f"`{assumed.stands}` is false while the wheels are commanded to move, and true once they "
        f"have had zero for {braking}, or earlier"
    )
    for exclusion in problem.excluded:
        yield (
            f"never at one tick: {exclusion_in_words(exclusion)}, because no numbers satisfy "
            "both comparisons"
        )
    yield "the wheels follow a published command at once, and keep it until the next one"
    yield "at the first tick the robot stands, and nothing has been received yet"
    yield (
        "the node around the interceptor's step passes on every message, and publishes the result"
    )
    if interception.form is InterceptorForm.TIMER:
        period = in_words(interception.period)
        yield f"the interceptor's timer expires once in each {period} (`period`, [interceptor])"
    yield from _rounded(interception, assumed, tick, any_time=any_time)
    if not problem.settings.stop_timeout:
        yield "the safety function never stops sending: there is no `stop_timeout` ([interceptor])"


def _messages(assumed: LoopAssumptions, tick: int, *, any_time: bool) -> Iterator[str]:
    """The assumptions about stop messages."""
    yield (
        f"the safety function steps at every tick of {in_words(tick)} and sends its request "
        f"{_when(assumed)}"
    )
    latency = "`latency`" if any_time else f"{in_words(assumed.latency)} (`latency`, [assume])"
    yield f"stop messages arrive in the order of sending, each within {latency}"
    if any_time:
        yield "at most `lost` stop messages in a row are lost"
    elif assumed.lost:
        yield f"at most {assumed.lost} stop messages in a row are lost (`lost`, [assume])"
    else:
        yield "no stop message is lost (`lost`, [assume])"


def _when(assumed: LoopAssumptions) -> str:
    if assumed.heartbeat:
        return (
            f"when it changes, and again when it has been silent for "
            f"{in_words(assumed.heartbeat)}, or earlier (`requests` and `heartbeat`, [assume])"
        )
    when = "only when it changes" if assumed.requests is Requests.EDGE else "every time"
    return f"{when} (`requests`, [assume])"


def _rounded(
    interception: Interception, assumed: LoopAssumptions, tick: int, *, any_time: bool
) -> Iterator[str]:
    """Durations that are not a whole number of cells or ticks, which the proof rounds up."""
    cell = cell_of(tick, interception, assumed)
    cells = "whole cells of the model"
    for name, duration, unit, grid in (
        ("latency", 0 if any_time else assumed.latency, cell, cells),
        ("braking", 0 if any_time else assumed.braking, cell, cells),
        ("heartbeat", assumed.heartbeat, tick, "whole ticks of the clock"),
    ):
        if duration % unit:
            longer = in_words(ticks(duration, unit) * unit)
            yield f"`{name}` of {in_words(duration)} counts as {longer}, {grid}"
