"""The claims of a file of `--emit dafny`, and their coverage of the closed loop."""

from __future__ import annotations

from collections.abc import Iterator

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import Uninterpreted, boolean
from compiler.logic import formula as f
from compiler.logic.claims import Layer
from compiler.logic.printing import identifier
from compiler.targets.interceptor_options import options as core
from compiler.targets.interceptor_options import repetition, ticks
from fretish import syntax as s
from fretish.bindings.declarations import Declarations, InterceptorForm, Requests
from fretish.classes.frozen import dataclass
from fretish.printer import timing as printed

CHANNELS = (
    ("Stop", "stop", "StopHeard"),
    ("Scan", "scan", "ScanHeard"),
    ("Command", "command", "CommandHeard"),
)
"""The inputs of an interceptor: their names in lemmas, in its fields, and its events."""


@dataclass(frozen=True, slots=True)
class ResponseDelay:
    """The delay from a trigger to the response, in ticks of the requirement's clock."""

    reach: int
    """A request arrives before the end of the tick that comes this number of ticks after the
    trigger: the latency rounded up, less the tick itself, and for each message that may be lost in
    a row the time to the next one (a tick, or the heartbeat)."""
    braking: int
    """The number of consecutive ticks at whose end the wheels have zero before the response:
    braking rounded up, and the tick in which it began."""

    @property
    def total(self) -> int:
        """The smallest bound that the requirement may have."""
        return self.reach + self.braking


def no_loop_reason(
    requirement: FormalizedRequirement, declarations: Declarations | None
) -> str | None:
    """The reason why the file has no claim about the closed loop; None if it has one."""
    if declarations is None or declarations.interceptor is None:
        return "the bindings have no [interceptor], and the plain form waits for a command to stop"
    if declarations.interceptor.form is InterceptorForm.EVENT:
        return "the event form waits for a command to stop, so no delay bounds its answer"
    timing = requirement.sentence.timing
    if not (s.deadline(timing) or s.is_eventual(timing)):
        return f"it is about answers, and `{printed(timing)}` asks for something else"
    assumed = declarations.assumed
    response = boolean(requirement.sentence.response, Uninterpreted().alone())
    if assumed is not None and response != f.Atom(identifier(assumed.stands)):
        return f"what a stop brings about is `{assumed.stands}`, and the response is something else"
    return None


def delay(
    requirement: FormalizedRequirement, declarations: Declarations | None
) -> ResponseDelay | str | None:
    """The delay under [assume], or why it has no number of ticks; None without [assume]."""
    assumed = declarations.assumed if declarations else None
    if assumed is None:
        return None
    period = requirement.clock.period if requirement.clock else None
    if period is None:
        return "the clock ticks by message, so a latency is no number of ticks"
    every = repetition(assumed, period)
    if every is None and assumed.lost:
        return "a request that is sent once may be lost ([assume] requests, lost and no heartbeat)"
    reach = max(ticks(assumed.latency, period) - 1, 0) + assumed.lost * (every or 0)
    return ResponseDelay(reach, ticks(assumed.braking, period) + 1)


@dataclass(frozen=True, slots=True)
class Claim:
    """A claim that holds once Dafny verifies every lemma and method of the file."""

    layer: Layer
    sentence: str
    assumptions: tuple[str, ...] = ()
    unshown: str | None = None
    """The reason why the file does not prove the claim."""


def claims(
    requirement: FormalizedRequirement, declarations: Declarations | None
) -> tuple[Claim, ...]:
    """The claims of a requirement's file, in order; parts that the file lacks have none."""
    return (
        _monitor_claim(requirement),
        _interceptor_claim(declarations),
        *_loop_claims(requirement, declarations),
    )


def _monitor_claim(requirement: FormalizedRequirement) -> Claim:
    timing = requirement.sentence.timing
    every = ", for every bound" if s.duration(timing) else ""
    if s.is_eventual(timing) or s.SHAPES[type(timing)].extent.needs_end:
        statement = "has an open demand exactly where the definition leaves one unanswered"
    else:
        statement = "is violated exactly where the definition is"
    sentence = f"the counter of `{printed(timing)}` {statement}, on every sequence of ticks{every}"
    return Claim(Layer.MONITOR, sentence)


def _interceptor_claim(declarations: Declarations | None) -> Claim:
    if declarations is None or declarations.interceptor is None:
        sentence = "the plain interceptor latches the stop, publishes only zero then, and else "
        return Claim(Layer.INTERCEPTOR, f"{sentence}forwards commands unchanged")
    options = core(declarations.interceptor)
    contracts = [
        "a model of the interceptor publishes only zero while it is halted, and else commands"
    ]
    if not options.event_driven:
        contracts.append(f"a request gives {options.hold} ticks of zero")
    contracts += [
        f"{timeout} ticks without a {channel} halt"
        for _, channel, _ in CHANNELS
        if (timeout := getattr(options, f"{channel}_timeout"))
    ]
    if options.latching:
        contracts.append("a stop is for ever")
    return Claim(Layer.INTERCEPTOR, "; ".join(contracts))


_ASSUMED = (
    "the safety function requests a stop while a demand is open, and its messages keep their order",
    "of an open demand a request is heard in the tick `reach` ticks after the trigger, or before",
    "the response holds once the wheels had only zero at the ends of `braking` ticks in a row",
)


def _assumed(declarations: Declarations | None) -> tuple[str, ...]:
    """The assumptions of the closed loop; a request that is sent on change only needs one more."""
    assumed = declarations.assumed if declarations else None
    if assumed is None or assumed.requests is Requests.LEVEL:
        return _ASSUMED
    requests, delivery, stands = _ASSUMED
    return (requests, f"{delivery}; or one from before the trigger is still in force", stands)


def _loop_claims(
    requirement: FormalizedRequirement, declarations: Declarations | None
) -> Iterator[Claim]:
    if no_loop_reason(requirement, declarations) is not None:
        return
    assumptions = _assumed(declarations)
    declared, bound = delay(requirement, declarations), requirement.ticks
    every = "for every bound n and every delay reach + braking of at most n"
    sentence = f"never violated, {every}"
    if bound is None:
        sentence = "every trigger is answered within reach + braking ticks, whatever they are"
    yield Claim(Layer.BOUNDS, sentence, assumptions)
    if declared is not None:
        yield _declared_claim(declared, bound, assumptions)


def _declared_claim(
    declared: ResponseDelay | str, bound: int | None, assumptions: tuple[str, ...]
) -> Claim:
    """The claim for the numbers of [assume]."""
    at = "the declared delay" if bound is None else f"the bound of {bound} ticks"
    if isinstance(declared, str):
        return Claim(Layer.BOUNDS, f"never late at {at}", assumptions, declared)
    numbers = (
        f"reach = {declared.reach} ticks ([assume] latency and lost)",
        f"braking = {declared.braking} ticks ([assume] braking)",
    )
    if bound is None:
        sentence = f"every trigger is answered within {declared.total} ticks, the declared delay"
        return Claim(Layer.BOUNDS, sentence, (*assumptions, *numbers))
    late = f"the declared delay of {declared.total} ticks is more than the bound of {bound}"
    sentence = f"never violated at {at} and the declared delay of {declared.total}"
    return Claim(
        Layer.BOUNDS, sentence, (*assumptions, *numbers), late if declared.total > bound else None
    )
