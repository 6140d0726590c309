"""The counter automaton of a sentence as a module of NuSMV, symbol by symbol.

The module mirrors `compiler.formalization.reference`: the phase of the scope, the trigger of the
condition, the count of the timing. A state is the one before a tick; `violated` includes the tick
itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import assert_never

from compiler.formalization.obligation import TRAITS, Obligation, ObligationKind, Trait
from fretish.classes.frozen import dataclass
from fretish.syntax import ConditionKind, ScopeKind

Cases = tuple[tuple[str, str], ...]
"""Pairs (condition, value), of which the first true one counts; the last condition is TRUE."""


@dataclass(frozen=True, slots=True)
class SmvVariable:
    """A state variable."""

    name: str
    type: str
    initial: str
    next: Cases
    comment: str


@dataclass(frozen=True, slots=True)
class Definition:
    """A name for an expression."""

    name: str
    value: Cases
    comment: str = ""


@dataclass(frozen=True, slots=True)
class SmvModule:
    """One `MODULE` of the file."""

    parameters: tuple[str, ...]
    variables: tuple[SmvVariable, ...]
    definitions: tuple[Definition, ...]


def monitor(obligation: Obligation) -> SmvModule:
    """The module of a sentence; its parameters are the expressions that the sentence has.

    It defines `violated` (a demand is broken, for good) and, with `eventually` and `finally`,
    `unmet` (a demand is open that the end of the interval would break).
    """
    counter = _counter(obligation)
    stops = Trait.STOPS in TRAITS[obligation.demand.kind]
    has = {
        "mode": obligation.scope is not None,
        "condition": obligation.condition is not None,
        "response": True,
        "stop": stops,
    }
    failed = SmvVariable(
        "failed", "boolean", "FALSE", _plain("violated"), "a demand was broken at a tick before"
    )
    return SmvModule(
        tuple(name for name, there in has.items() if there),
        (*_scope_variables(obligation), *counter.variables, failed),
        (
            *_scope_definitions(obligation),
            *counter.definitions,
            Definition("violated", _plain("failed | broken"), "for good: nothing repairs it"),
        ),
    )


def _plain(value: str) -> Cases:
    return (("TRUE", value),)


# Scope and condition --------------------------------------------------------------------------

_PHASES: Mapping[ScopeKind | None, tuple[str, Cases]] = {
    None: ("", _plain("inside")),
    ScopeKind.IN: ("", (("mode", "inside"), ("TRUE", "outside"))),
    ScopeKind.NOT_IN: ("", (("mode", "outside"), ("TRUE", "inside"))),
    ScopeKind.ONLY_IN: ("", (("mode", "outside"), ("TRUE", "inside"))),
    ScopeKind.BEFORE: ("over", (("mode | phase = over", "over"), ("TRUE", "inside"))),
    ScopeKind.AFTER: (
        "first_run",
        (
            ("phase = inside | (phase = first_run & !mode)", "inside"),
            ("mode", "first_run"),
            ("TRUE", "outside"),
        ),
    ),
    ScopeKind.ONLY_BEFORE: ("", (("mode | phase = inside", "inside"), ("TRUE", "outside"))),
    ScopeKind.ONLY_AFTER: (
        "last_run, over",
        (
            ("phase = over | (phase = last_run & !mode)", "over"),
            ("mode", "last_run"),
            ("TRUE", "inside"),
        ),
    ),
}
"""The phases besides `outside` and `inside`; and the phase of a tick, from that of the tick
before."""


def _is_everywhere(obligation: Obligation) -> bool:
    """Whether the module needs no phase, because not even the first tick differs."""
    return obligation.scope is None and obligation.condition is not None


def _scope_variables(obligation: Obligation) -> Iterator[SmvVariable]:
    more, _ = _PHASES[obligation.scope]
    if not _is_everywhere(obligation):
        values = ", ".join(("outside", "inside", *([more] if more else [])))
        comment = "where the tick before lies"
        yield SmvVariable("phase", f"{{{values}}}", "outside", _plain("now"), comment)
    if obligation.condition is ConditionKind.TRIGGER:
        yield SmvVariable(
            "held",
            "boolean",
            "FALSE",
            _plain("enforced & condition"),
            "the condition held at the tick before, in the same interval",
        )


def _scope_definitions(obligation: Obligation) -> Iterator[Definition]:
    more, cases = _PHASES[obligation.scope]
    inside = ["inside", *(["last_run"] if "last_run" in more else [])]
    if _is_everywhere(obligation):
        yield Definition("enforced", _plain("TRUE"), "at every tick")
    else:
        yield Definition("now", cases, "where this tick lies")
        enforced = " | ".join(f"now = {phase}" for phase in inside)
        yield Definition("enforced", _plain(enforced), "in an interval")
    match obligation.condition:
        case None:
            first = " & ".join(f"phase != {phase}" for phase in inside)
            yield Definition("triggered", _plain(f"enforced & {first}"), "at its first tick")
        case ConditionKind.HOLDING:
            yield Definition("triggered", _plain("enforced & condition"))
        case ConditionKind.TRIGGER:
            yield Definition("triggered", _plain("enforced & condition & !held"))


# Timing ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _SmvCounter:
    variables: tuple[SmvVariable, ...]
    definitions: tuple[Definition, ...]


def _counter(obligation: Obligation) -> _SmvCounter:
    n = obligation.demand.ticks
    match obligation.demand.kind:
        case ObligationKind.WITHIN | ObligationKind.FOR if (
            n == 0
        ):  # a range of one number is no range
            return _flag(None, broken="triggered & !response")
        case ObligationKind.IMMEDIATELY:
            return _flag(None, broken="triggered & !response")
        case ObligationKind.NEXT:
            comment = "the tick before was a trigger"
            return _flag("triggered", comment, broken="enforced & open & !response")
        case ObligationKind.EVENTUALLY:
            over = _interval_over(obligation)
            return _at_the_end(_flag("unmet", "no response yet", broken=over), "!response")
        case ObligationKind.FINALLY:
            return _finally(_interval_over(obligation))
        case ObligationKind.ALWAYS:
            return _flag("due", "there was a trigger", broken="due & !response", due=True)
        case ObligationKind.UNTIL:
            broken = "due & !stop & !response"
            return _flag("due & !stop", "no stop condition yet", broken=broken, due=True)
        case ObligationKind.BEFORE:
            return _flag("due & !response", "no response yet", broken="due & stop", due=True)
        case ObligationKind.WITHIN:
            return _within(n)
        case ObligationKind.FOR:
            return _for(n)
        case ObligationKind.AFTER:
            return _after(n)
        case ObligationKind.NOT_AFTER:
            return _not_after(n) if obligation.condition is None else _register(n)
        case _:
            assert_never(obligation.demand.kind)


_DUE = Definition("due", _plain("triggered | (enforced & open)"), "a demand is open at this tick")


def _interval_over(obligation: Obligation) -> str:
    """Expression: the interval ended with the tick before, and a demand is open."""
    return "FALSE" if obligation.scope is None else "!enforced & open"


def _flag(carry: str | None, comment: str = "", *, broken: str, due: bool = False) -> _SmvCounter:
    """The counter of one bit, whether a demand is open; `carry` is its value for the next tick."""
    broken_at = Definition("broken", _plain(broken), "at this tick")
    opened = (
        () if carry is None else (SmvVariable("open", "boolean", "FALSE", _plain(carry), comment),)
    )
    return _SmvCounter(opened, (*([_DUE] if due else []), broken_at))


def _at_the_end(counter: _SmvCounter, absence: str) -> _SmvCounter:
    unmet = Definition("unmet", _plain(f"due & {absence}"), "and would fail if the interval ended")
    return _SmvCounter(counter.variables, (_DUE, unmet, *counter.definitions))


def _finally(over: str) -> _SmvCounter:
    """`open`: there was a trigger; the response at the tick before is the last of an interval."""
    answered = SmvVariable(
        "answered", "boolean", "FALSE", _plain("response"), "the response held at the tick before"
    )
    opened = SmvVariable("open", "boolean", "FALSE", _plain("due"), "there was a trigger")
    broken = "FALSE" if over == "FALSE" else f"{over} & !answered"
    counter = _SmvCounter((opened, answered), (Definition("broken", _plain(broken), "at its end"),))
    return _at_the_end(counter, "!response")


def _count(most: int, cases: Cases, comment: str) -> SmvVariable:
    return SmvVariable("count", f"0..{most}", "0", cases, comment)


_DUE_BY_COUNT = Definition(
    "due", _plain("triggered | (enforced & count > 0)"), "a demand is open at this tick"
)


def _within(n: int) -> _SmvCounter:
    count = _count(
        n,
        (("!due | response", "0"), (f"count = {n}", str(n)), ("TRUE", "count + 1")),
        "ticks since the oldest open trigger, its tick included",
    )
    broken = Definition("broken", _plain(f"due & !response & count = {n}"), "the deadline")
    return _SmvCounter((count,), (_DUE_BY_COUNT, broken))


def _for(n: int) -> _SmvCounter:
    count = _count(
        n,
        (
            ("!enforced", "0"),
            ("triggered", str(n)),
            ("count > 0", "count - 1"),
            ("TRUE", "0"),
        ),
        "ticks for which the newest trigger still demands the response",
    )
    return _SmvCounter((count,), (_DUE_BY_COUNT, Definition("broken", _plain("due & !response"))))


def _after(n: int) -> _SmvCounter:
    count = _count(
        n + 1,
        ((f"!due | count = {n + 1}", "0"), ("TRUE", "count + 1")),
        "ticks since the oldest open trigger, its tick included",
    )
    clash = SmvVariable(
        "clash",
        "boolean",
        "FALSE",
        _plain(f"clashes & count < {n + 1}"),
        "a trigger has come since: it forbids the response that the oldest demands",
    )
    clashes = Definition("clashes", _plain("enforced & (clash | (count > 0 & triggered))"))
    too_early = f"(count < {n + 1} & response)"
    too_late = f"(count = {n + 1} & (clashes | !response))"
    broken = Definition("broken", _plain(f"due & ({too_early} | {too_late})"))
    return _SmvCounter((count, clash), (_DUE_BY_COUNT, clashes, broken))


def _not_after(n: int) -> _SmvCounter:
    """The counter with one trigger for each interval, whose time is a count."""
    count = _count(
        n + 1,
        ((f"!due | response | count = {n + 1}", "0"), ("TRUE", "count + 1")),
        "ticks since the trigger, while no response has come",
    )
    broken = Definition("broken", _plain(f"enforced & response & count = {n + 1}"))
    return _SmvCounter((count,), (_DUE_BY_COUNT, broken))


def _register(n: int) -> _SmvCounter:
    """The register of triggers, each of which forbids the response at a different tick."""
    carry = "enforced & !response"
    ago = [
        SmvVariable(
            f"ago_{k}",
            "boolean",
            "FALSE",
            _plain(f"{carry} & {'triggered' if k == 1 else f'ago_{k - 1}'}"),
            f"a trigger {k} tick{'s' if k > 1 else ''} ago, and no response since",
        )
        for k in range(1, n + 2)
    ]
    broken = Definition("broken", _plain(f"enforced & response & ago_{n + 1}"))
    return _SmvCounter(tuple(ago), (broken,))
