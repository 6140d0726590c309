"""A requirement as a counter over Boolean functions: safe ticks and next state.

It defines symbolically what `compiler.formalization.reference` defines tick by tick: the phase of
the scope, the trigger of the condition, the count of the timing. Tests compare the two.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import Obligation, ObligationKind
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.formula_automata import formula_counter
from fretc.analysis.arena.memory import (
    LONGEST_DELAY,
    Bit,
    Memory,
    PastMemory,
    RequirementCounter,
    constant,
    either,
    equals,
    only,
    predecessor,
    some,
    successor,
)
from fretc.analysis.arena.variables import Numbers, UnsupportedError
from fretish.checking import is_formula
from fretish.classes.frozen import dataclass
from fretish.reading.recursion import with_recursion_limit
from fretish.syntax import ConditionKind, ScopeKind


@with_recursion_limit
def counter(
    requirement: FormalizedRequirement,
    alphabet: Alphabet,
    fresh: Numbers,
    shared: dict[Function, Bit],
    *,
    as_fret: bool = False,
) -> RequirementCounter:
    """The counter of a requirement.

    Args:
        requirement: the formalized requirement.
        alphabet: the alphabet of all requirements.
        fresh: variables for its bits.
        shared: value → bit with its value at the previous tick, shared by all counters.
        as_fret: whether no obligation may be open at the end of any tick, as if FRET's past form
            held at every tick.

    Raises:
        UnsupportedError: the requirement has no counter.
    """
    if requirement.sentence.probability is not None:
        raise UnsupportedError("it states a probability")
    if is_formula(requirement.sentence):
        if as_fret:
            raise UnsupportedError("a formula has no past form of FRET")
        return formula_counter(requirement, alphabet, Memory(fresh, shared))
    demanded = requirement.demanded
    memory = Memory(fresh, shared)
    past = PastMemory(alphabet.atom, memory)
    tick = _CounterTick(demanded, memory, past.value)
    timing = _timing(tick, demanded.demand.ticks)
    safe, fair = -timing.broken, timing.fair
    if as_fret and timing.obligation_pending is not None:
        safe, fair = safe - timing.obligation_pending, None
    roots = [safe, tick.enforced, tick.triggered, *([] if fair is None else [fair])]
    bits = memory.needed(roots)
    steps = tuple(memory.steps[bit] for bit in bits)
    return RequirementCounter(
        requirement.id, bits, steps, safe, fair, tuple(memory.words), tick.enforced, tick.triggered
    )


class _CounterTick:
    """Scope and condition at one tick."""

    def __init__(
        self, demanded: Obligation, memory: Memory, value: Callable[..., Function]
    ) -> None:
        self.demanded, self.memory = demanded, memory
        self.q = value(demanded.demand.response)
        self.stop = value(demanded.demand.stop)
        p, m = value(demanded.trigger), value(demanded.mode)
        self.enforced, before = _interval(demanded.scope, m, memory)
        match demanded.condition:
            case None:
                self.triggered = self.enforced - before
            case ConditionKind.HOLDING:
                self.triggered = self.enforced & p
            case ConditionKind.TRIGGER:
                held = memory.keep(self.enforced & p)
                self.triggered = (self.enforced & p) - held
            case _:
                assert_never(demanded.condition)


def _interval(scope: ScopeKind | None, m: Function, memory: Memory) -> tuple[Function, Function]:
    """Whether a tick lies in an interval of the scope, and whether the previous tick did."""

    def after(begun: Callable[[Function], Function]) -> tuple[Function, Function]:
        """A condition that holds from some tick on, and its value at the previous tick."""
        bit = memory.bit()
        was = bdd.variable(bit.now)
        memory.steps[bit] = begun(was)
        return memory.steps[bit], was

    match scope:
        case None:
            enforced = bdd.true()
        case ScopeKind.IN:
            enforced = m
        case ScopeKind.NOT_IN | ScopeKind.ONLY_IN:
            enforced = -m
        case ScopeKind.BEFORE:
            over, _ = after(lambda was: was | m)
            enforced = -over
        case ScopeKind.AFTER:
            inside, first_run = memory.bit(), memory.bit()
            was, run = bdd.variable(inside.now), bdd.variable(first_run.now)
            enforced = was | (run - m)
            memory.steps |= {inside: enforced, first_run: m - enforced}
        case ScopeKind.ONLY_BEFORE:
            enforced, _ = after(lambda was: was | m)
        case ScopeKind.ONLY_AFTER:
            last_run, over = memory.bit(), memory.bit()
            run, was = bdd.variable(last_run.now), bdd.variable(over.now)
            ended = was | (run - m)
            enforced = -ended
            memory.steps |= {last_run: m - ended, over: ended}
        case _:
            assert_never(scope)
    return enforced, memory.keep(enforced)


@dataclass(frozen=True, slots=True)
class _Timing:
    broken: Function
    obligation_pending: Function | None = None
    """Whether an obligation is open at the end of the tick."""
    fair: Function | None = None


def _timing(tick: _CounterTick, n: int) -> _Timing:
    """The safe ticks of the timing; its count becomes a part of the memory."""
    enforced, triggered, q, stop = tick.enforced, tick.triggered, tick.q, tick.stop
    kind = tick.demanded.demand.kind
    match kind:
        case ObligationKind.IMMEDIATELY:
            return _Timing(triggered - q)
        case ObligationKind.NEXT:
            due = enforced & tick.memory.keep(triggered)
            return _Timing(due - q)
        case ObligationKind.EVENTUALLY:
            return _eventually(tick)
        case ObligationKind.FINALLY:
            return _finally(tick)
        case ObligationKind.ALWAYS if tick.demanded.condition is None:
            return _Timing(enforced - q)
        case ObligationKind.ALWAYS:
            return _Timing(_open(tick, lambda due: due) - q)
        case ObligationKind.UNTIL:
            return _Timing(_open(tick, lambda due: due - stop) - stop - q)
        case ObligationKind.BEFORE:
            return _Timing(_open(tick, lambda due: due - q) & stop)
        case ObligationKind.WITHIN:
            return _within(tick, n)
        case ObligationKind.FOR:
            return _for(tick, n)
        case ObligationKind.AFTER:
            return _after(tick, n)
        case ObligationKind.NOT_AFTER:
            return _not_after(tick, n) if tick.demanded.condition is None else _register(tick, n)
        case _:
            assert_never(kind)


def _open(tick: _CounterTick, stays: Callable[[Function], Function]) -> Function:
    """Whether an obligation is open at a tick; if it `stays`, it is open at the next tick too."""
    bit = tick.memory.bit()
    due = tick.triggered | (tick.enforced & bdd.variable(bit.now))
    tick.memory.steps[bit] = stays(due)
    return due


def _eventually(tick: _CounterTick) -> _Timing:
    bit = tick.memory.bit()
    was = bdd.variable(bit.now)
    pending = (tick.triggered | (tick.enforced & was)) - tick.q
    tick.memory.steps[bit] = pending
    return _Timing(was - tick.enforced, pending, -was)


def _finally(tick: _CounterTick) -> _Timing:
    """An interval without an end has no last tick, so that no obligation falls due."""
    bit = tick.memory.bit()
    was = bdd.variable(bit.now)
    due = tick.triggered | (tick.enforced & was)
    tick.memory.steps[bit] = due
    answered = tick.memory.keep(tick.q)
    return _Timing(was - answered - tick.enforced, due - tick.q)


def _within(tick: _CounterTick, n: int) -> _Timing:
    """The count is the number of ticks since the oldest open trigger."""
    bits, count = tick.memory.word(n)
    open_ = (tick.triggered | (tick.enforced & some(count))) - tick.q
    tick.memory.set(bits, only(open_, successor(count)))
    return _Timing(open_ & equals(count, n))


def _for(tick: _CounterTick, n: int) -> _Timing:
    """The count is the number of remaining ticks of the newest trigger."""
    bits, count = tick.memory.word(n)
    due = tick.triggered | (tick.enforced & some(count))
    rest = only(tick.enforced, predecessor(count))
    tick.memory.set(bits, either(tick.triggered, constant(n, count), rest))
    return _Timing(due - tick.q)


def _after(tick: _CounterTick, n: int) -> _Timing:
    """The count is the number of ticks since the oldest trigger.

    A second trigger before the deadline forbids the response at the tick at which the first one
    demands it: only the end of the interval can satisfy both.
    """
    bits, count = tick.memory.word(n + 1)
    clash = tick.memory.bit()
    seen = some(count)
    clashes = tick.enforced & (bdd.variable(clash.now) | (seen & tick.triggered))
    due = tick.triggered | (tick.enforced & seen)
    last = equals(count, n + 1)
    tick.memory.set(bits, only(due - last, successor(count)))
    tick.memory.steps[clash] = clashes - last
    return _Timing(due & bdd.ite(last, clashes | -tick.q, tick.q))


def _not_after(tick: _CounterTick, n: int) -> _Timing:
    """With one trigger in an interval, a count gives its time."""
    bits, count = tick.memory.word(n + 1)
    due = tick.triggered | (tick.enforced & some(count))
    last = equals(count, n + 1)
    tick.memory.set(bits, only(due - last - tick.q, successor(count)))
    return _Timing(tick.enforced & last & tick.q)


def _register(tick: _CounterTick, n: int) -> _Timing:
    """Each trigger forbids the response at a tick of its own, so each trigger is stored."""
    if n > LONGEST_DELAY:
        raise UnsupportedError(f"each of its triggers is remembered for {n} ticks")
    unanswered = tick.enforced - tick.q
    ago = tick.triggered
    for _ in range(n + 1):
        ago = tick.memory.keep(ago & unanswered)
    return _Timing(tick.enforced & tick.q & ago)
