"""The reference automaton of a sentence: the meaning of FRETish as a counter stepped tick by tick.

The automaton is written by hand from the definition: the interval of the scope, the trigger of the
condition, the counter of the timing. It shares nothing with the formulas of fretc, so monitors made
from these can be proved against it (`fretc.verification.monitor.equivalence`). A bound is a number
that is compared, never unrolled.

Sources: Giannakopoulou, Pressburger, Mavridou, Schumann, Automated formalization of structured
natural language requirements, IST 137 (2021), sections 3 and 4; for the three verdicts Bauer,
Leucker, Schallhart, Runtime verification for LTL and TLTL, TOSEM 20 (2011).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from enum import IntEnum, auto
from typing import Literal, NamedTuple, assert_never

from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.syntax import ConditionKind, ScopeKind


@dataclass(frozen=True, slots=True)
class Template:
    """A sentence without its expressions: one of FRET's 288 templates, and what it counts."""

    scope: ScopeKind | None
    """The scope; None: the whole trace."""
    condition: ConditionKind | None
    """The condition; None: one trigger, at the first tick of each interval."""
    timing: type[s.Timing]
    ticks: int = 0

    def __post_init__(self) -> None:
        assert self.ticks >= 0


def template(sentence: s.Sentence, ticks: int) -> Template:
    """The template of a sentence.

    Args:
        sentence: a checked sentence; a probability is not part of its template.
        ticks: the duration in ticks; ignored if the sentence has none.
    """
    counted = ticks if s.duration(sentence.timing) else 0
    scope, condition = sentence.scope, sentence.condition
    return Template(
        scope.kind if scope else None,
        condition.kind if condition else None,
        type(sentence.timing),
        counted,
    )


# Scope: on which ticks the sentence is enforced ------------------------------------------------


class Phase(IntEnum):
    """The position of a tick relative to the intervals, derived from the ticks up to it."""

    OUTSIDE = auto()
    """In no interval; one may begin."""
    FIRST_RUN = auto()
    """`after m`: in the first run of m; the interval begins where it ends."""
    INSIDE = auto()
    """In an interval."""
    LAST_RUN = auto()
    """`only after m`: in the interval and in the first run of m; both end together."""
    OVER = auto()
    """In no interval, and none will begin."""


_ENFORCED = (Phase.INSIDE, Phase.LAST_RUN)


def _entered(scope: ScopeKind | None, phase: Phase, m: bool) -> Phase:
    """The phase of a tick with mode m after a tick of `phase`."""
    match scope:
        case None:
            return Phase.INSIDE
        case ScopeKind.IN:
            return Phase.INSIDE if m else Phase.OUTSIDE
        case ScopeKind.NOT_IN | ScopeKind.ONLY_IN:
            return Phase.OUTSIDE if m else Phase.INSIDE
        case ScopeKind.BEFORE:
            return Phase.OVER if m or phase is Phase.OVER else Phase.INSIDE
        case ScopeKind.AFTER:
            if phase is Phase.INSIDE or (phase is Phase.FIRST_RUN and not m):
                return Phase.INSIDE
            return Phase.FIRST_RUN if m else Phase.OUTSIDE
        case ScopeKind.ONLY_BEFORE:
            return Phase.INSIDE if m or phase is Phase.INSIDE else Phase.OUTSIDE
        case ScopeKind.ONLY_AFTER:
            if phase is Phase.OVER or (phase is Phase.LAST_RUN and not m):
                return Phase.OVER
            return Phase.LAST_RUN if m else Phase.INSIDE
        case _:
            assert_never(scope)


# Timing: what is demanded from each trigger on, within one interval ----------------------------

Counter = Callable[[int, int, bool, bool, bool], int | None]
"""One tick of an interval: (count, n, triggered, q, s) to the next count, None where a demand is
broken. The count is 0 as long as no demand is open."""


def _immediately(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """Q at the trigger."""
    return None if triggered and not q else 0


def _next(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """Q at the tick after the trigger; count 1: the tick before was a trigger."""
    return None if count and not q else int(triggered)


def _finally(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """Q at the last tick of the interval; count 1: q is missing now, -1: it is not."""
    return 0 if not (count or triggered) else -1 if q else 1


def _eventually(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """Q at some tick from the trigger on; count 1: not yet."""
    return int((count or triggered) and not q)


def _always(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """Q from the trigger on; count 1: there was a trigger."""
    begun = count or triggered
    return None if begun and not q else int(begun)


def _within(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """Q at some tick of t..t+n; the count is the ticks of the oldest open trigger t so far.

    An interval that ends before t+n demands nothing; the count is not read any more.
    """
    if q or not (count or triggered):
        return 0
    return None if count == n else count + 1


def _for(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """Q throughout t..t+n; the count is the ticks left of the newest trigger t."""
    pending = n + 1 if triggered else count
    return None if pending and not q else max(pending - 1, 0)


def _after(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """No q throughout t..t+n, then q at t+n+1.

    The count is the ticks since the oldest open trigger, with its own. It is negative once another
    trigger has come: that one forbids q at t+n+1, so only the end of the interval can meet the
    demand.
    """
    seen, clashes = abs(count), count < 0 or (count > 0 and triggered)
    if not (seen or triggered):
        return 0
    if seen == n + 1:
        return None if clashes or not q else 0
    if q:
        return None
    return -(seen + 1) if clashes else seen + 1


def _not_after(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """Q at some tick of t..t+n, or none at t+n+1; what `only` scopes demand for `after`.

    The demand is broken if q comes at t+n+1 for the first time since t: each trigger forbids q at a
    different instant, and an earlier q lifts that. So the count is a register of the triggers since
    the last q, bit k for the one k ticks ago. With a condition there are up to 2^(n+1) registers,
    which is inherent.
    """
    triggers = count << 1 | triggered
    forbidden = triggers >> (n + 1)
    if q:
        return None if forbidden else 0
    return triggers ^ (forbidden << (n + 1))


def _until(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """Q at every tick from the trigger to before the first s; count 1: no s yet."""
    if s or not (count or triggered):
        return 0
    return 1 if q else None


def _before(count: int, n: int, triggered: bool, q: bool, s: bool) -> int | None:
    """If s comes, q at a tick from the trigger on and before it; count 1: no q yet."""
    if not (count or triggered):
        return 0
    return None if s else int(not q)


_PENDING_AT_THE_END = (_finally, _eventually)
"""The counters that violate with a positive count if the interval ends."""

_DEMANDS: Mapping[type[s.Timing], tuple[Counter, bool]] = {
    s.Immediately: (_immediately, True),
    s.Next: (_next, True),
    s.Finally: (_finally, True),
    s.Eventually: (_eventually, True),
    s.Always: (_always, True),
    s.Never: (_always, False),
    s.Within: (_within, True),
    s.For: (_for, True),
    s.After: (_after, True),
    s.Until: (_until, True),
    s.Before: (_before, True),
}
"""The counter of each timing, and whether it counts q or its negation."""

_NEGATED: Mapping[type[s.Timing], tuple[Counter, bool]] = {
    s.Immediately: (_immediately, False),
    s.Next: (_next, False),
    s.Finally: (_finally, False),
    s.Eventually: (_always, False),
    s.Always: (_eventually, False),
    s.Never: (_eventually, True),
    s.Within: (_for, False),
    s.For: (_within, False),
    s.After: (_not_after, True),
    s.Until: (_before, False),
    s.Before: (_until, False),
}
"""The demands of `only` scopes outside of the scope: the duals, not the complements."""


def _demand(template: Template) -> tuple[Counter, bool]:
    negates = template.scope is not None and template.scope.negates
    return (_NEGATED if negates else _DEMANDS)[template.timing]


# The automaton --------------------------------------------------------------------------------


class ReferenceState(NamedTuple):
    """The state after a tick; small and hashable."""

    phase: Phase
    held: bool
    """Whether the condition held at this tick of an interval; false if the next tick does not need
    it."""
    counted: int
    """The counter of the timing; 0 outside of intervals."""


def initial(template: Template) -> ReferenceState:
    """The state before the first tick."""
    return ReferenceState(Phase.OUTSIDE, held=False, counted=0)


def step(
    template: Template, state: ReferenceState, m: bool, p: bool, q: bool, s: bool
) -> ReferenceState | None:
    """The state after one more tick; None if a demand is broken, which nothing can repair.

    Args:
        template: what the sentence is.
        state: before the tick.
        m: the mode at the tick; any value where the template has none, as for p and s.
        p: the condition.
        q: the response.
        s: the stop condition.
    """
    phase = _entered(template.scope, state.phase, m)
    if phase not in _ENFORCED:
        return ReferenceState(phase, held=False, counted=0) if accepts(template, state) else None
    first = state.phase not in _ENFORCED
    counter, positive = _demand(template)
    triggered = _triggers(template.condition, p, first=first, held=state.held)
    counted = counter(state.counted, template.ticks, triggered, q is positive, s)
    if counted is None:
        return None
    return ReferenceState(
        phase, held=p and template.condition is ConditionKind.TRIGGER, counted=counted
    )


def _triggers(condition: ConditionKind | None, p: bool, *, first: bool, held: bool) -> bool:
    """Whether a demand begins at a tick of an interval.

    A condition that was already true before the interval triggers at its first tick: `held` refers
    only to ticks of the same interval.
    """
    match condition:
        case None:
            return first
        case ConditionKind.HOLDING:
            return p
        case ConditionKind.TRIGGER:
            return p and not held
        case _:
            assert_never(condition)


class TickRole(NamedTuple):
    """Whether a tick is enforced, and whether it is a trigger."""

    enforced: bool
    """The tick lies in an interval."""
    triggered: bool
    """A demand begins at it."""


def tick_role(template: Template, state: ReferenceState, m: bool, p: bool) -> TickRole:
    """The properties of a tick with mode `m` and condition `p`, after `state`."""
    if _entered(template.scope, state.phase, m) not in _ENFORCED:
        return TickRole(enforced=False, triggered=False)
    first = state.phase not in _ENFORCED
    return TickRole(True, _triggers(template.condition, p, first=first, held=state.held))


def accepts(template: Template, state: ReferenceState) -> bool:
    """FRET's verdict on a finite trace that ends here: an open interval ends with it."""
    return state.counted <= 0 or _demand(template)[0] not in _PENDING_AT_THE_END


def accepting(template: Template, state: ReferenceState) -> bool:
    """Büchi acceptance: an unbroken infinite trace satisfies if it visits such states for ever.

    An endless interval has no last tick, so `finally` demands nothing there.
    """
    return accepts(template, state) or _demand(template)[0] is _finally


# Verdicts -------------------------------------------------------------------------------------

Verdict = Literal["violated", "satisfied", "pending"]
Letter = tuple[bool, bool, bool, bool]
"""Mode, condition, response and stop condition at one tick."""
BROKEN = -1
"""Target of a move that breaks a demand: not a state, but the end of the run."""


class TooManyStatesError(Exception):
    """The automaton has more states than was allowed."""


@dataclass(frozen=True, slots=True)
class Automaton:
    """The reachable part of a template's automaton, deterministic and complete."""

    template: Template
    letters: tuple[Letter, ...]
    """The letters that can occur."""
    states: tuple[ReferenceState, ...]
    """The initial state comes first."""
    moves: tuple[tuple[int, ...], ...]
    """For each state and each letter: the index of the next state, or `BROKEN`."""
    verdicts: tuple[Verdict, ...]
    """For each state: violated (no continuation satisfies), satisfied (none violates), pending.

    Continuations are infinite and consist of the letters. Finite traces are another matter: see
    `accepts`.
    """


def explore(template: Template, letters: Iterable[Letter], limit: int = 10**6) -> Automaton:
    """The automaton over the letters that can occur.

    Args:
        template: what the sentence is.
        letters: at least one; parts of a sentence may share variables, so not all combinations need
            occur.
        limit: the most states.

    Raises:
        TooManyStatesError: there are more states than `limit`.
    """
    alphabet = tuple(dict.fromkeys(letters))
    assert alphabet
    start = initial(template)
    numbers = {start: 0}
    states, moves = [start], []
    for state in states:  # grows while it is read: breadth first
        row = []
        for letter in alphabet:
            after = step(template, state, *letter)
            if after is None:
                row.append(BROKEN)
                continue
            index = numbers.setdefault(after, len(states))
            if index == len(states):
                states.append(after)
            row.append(index)
        if len(states) > limit:
            raise TooManyStatesError(f"more than {limit} states")
        moves.append(tuple(row))
    accepted = [accepting(template, state) for state in states]
    return Automaton(
        template, alphabet, tuple(states), tuple(moves), tuple(_verdicts(moves, accepted))
    )


def _verdicts(moves: Sequence[Sequence[int]], accepted: Sequence[bool]) -> Iterable[Verdict]:
    """For each state, whether a continuation satisfies and whether one violates.

    One satisfies where an accepting state on a cycle can be reached, one violates where a broken
    demand can be reached or a cycle without an accepting state.
    """
    edges = [sorted(set(row) - {BROKEN}) for row in moves]
    rejecting = [
        [] if accepted[state] else [after for after in row if not accepted[after]]
        for state, row in enumerate(edges)
    ]
    kept = {state for state in _on_cycles(edges) if accepted[state]}
    breaking = {state for state, row in enumerate(moves) if BROKEN in row}
    before = reversed_edges(moves)
    satisfiable = reachable(before, kept)
    violable = reachable(before, breaking.union(_on_cycles(rejecting)))
    for state in range(len(moves)):
        if state not in satisfiable:
            yield "violated"
        else:
            yield "pending" if state in violable else "satisfied"


def reversed_edges(moves: Sequence[Sequence[int]]) -> list[list[int]]:
    """For each state the states with a move to it, each once."""
    back: list[list[int]] = [[] for _ in moves]
    for state, row in enumerate(moves):
        for after in {*row} - {BROKEN}:
            back[after].append(state)
    return back


def reachable(edges: Sequence[Sequence[int]], starts: Collection[int]) -> set[int]:
    """The starts and all states that are reachable from them."""
    seen = set(starts)
    waiting = list(starts)
    while waiting:
        for after in edges[waiting.pop()]:
            if after not in seen:
                seen.add(after)
                waiting.append(after)
    return seen


def _on_cycles(edges: Sequence[Sequence[int]]) -> Iterable[int]:
    """The states that lie on a cycle.

    Source: Tarjan, Depth-first search and linear graph algorithms, SIAM J. Comput. 1 (1972); a
    stack of our own in place of recursion, for automata as deep as their bound.
    """
    unseen, done = -1, len(edges)
    low = [unseen] * len(edges)  # the smallest number that is known to be in the component
    count = 0
    component: list[int] = []
    for root in range(len(edges)):
        if low[root] != unseen:
            continue
        path = [(root, iter(edges[root]), count)]
        while path:
            state, rest, number = path[-1]
            if low[state] == unseen:
                low[state] = number
                count += 1
                component.append(state)
            after = next(rest, None)
            if after is None:
                path.pop()
                if path:
                    low[path[-1][0]] = min(low[path[-1][0]], low[state])
                if low[state] == number:
                    members = _popped(component, state)
                    if len(members) > 1 or state in edges[state]:
                        yield from members
                    for member in members:
                        low[member] = done
            elif low[after] == unseen:
                path.append((after, iter(edges[after]), count))
            else:
                low[state] = min(low[state], low[after])


def _popped(stack: list[int], state: int) -> list[int]:
    """The state and all above it, taken from the stack."""
    members = [stack.pop()]
    while members[-1] != state:
        members.append(stack.pop())
    return members
