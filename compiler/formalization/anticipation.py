"""Earlier certain verdicts for sentences whose parts share atoms.

`compiler.formalization.past` detects contradicting demands of any sentence. If parts share atoms,
more can be derived: `whenever !p the sw shall after 3 ticks satisfy p` is violated at its first
trigger. So the reference automaton is explored over the possible letters, and the states from which
no endless trace satisfies (or none violates) the sentence are expressed as a past-time formula.

A long duration is shortened first: only the ticks at its beginning and its end matter, because a
trace is unconstrained in between. Source of the verdicts: Bauer, Leucker, Schallhart, TOSEM 20
(2011).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import assert_never

from compiler.formalization.letters import MOST_ATOMS, all_letters, temporal_predicate
from compiler.formalization.obligation import TRAITS, Demand, Obligation, ObligationKind, Trait
from compiler.formalization.past import MonitorSpec, ScopeFormulas, scope_formulas
from compiler.formalization.reference import (
    BROKEN,
    Automaton,
    Phase,
    ReferenceState,
    TooManyStatesError,
    explore,
    template,
)
from compiler.logic import formula as f
from compiler.logic.implicants import Vector, cover
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.syntax import ConditionKind, ScopeKind

SHORT = 6
"""Number of ticks to which a longer duration is shortened."""
_EDGE = 2
"""Ticks at either end of a duration that are distinguished."""
_MOST_STATES = 500


def anticipated(sentence: s.Sentence, obligation: Obligation, watch: MonitorSpec) -> MonitorSpec:
    """The monitor specification with the early verdicts of this sentence.

    Args:
        sentence: a checked sentence.
        obligation: the demand of the sentence.
        watch: the specification for any sentence of this form.
    """
    automaton = _automaton(sentence, obligation)
    if automaton is None:
        return watch
    observables = tuple(_observables(obligation, automaton))
    lost = _formula(automaton, observables, "violated")
    safe = _formula(automaton, observables, "satisfied")
    return replace(
        watch,
        violation_inevitable=_more(watch.violation_inevitable, lost),
        satisfied_forever=_more(watch.satisfied_forever, safe),
    )


def _more(given: f.Formula, derived: f.Formula) -> f.Formula:
    return given if derived == f.FALSE else f.or_(given, derived)


def _automaton(sentence: s.Sentence, obligation: Obligation) -> Automaton | None:
    """The automaton over the possible letters; None if all are possible, or they are unknown."""
    parts = tuple(_parts(obligation))
    names = tuple(dict.fromkeys(name for part in parts for name in f.atoms(part)))
    if _independent(parts, names) or len(names) > MOST_ATOMS or temporal_predicate(sentence):
        return None
    ticks = min(obligation.demand.ticks, SHORT)
    try:
        return explore(template(sentence, ticks), all_letters(sentence, names), _MOST_STATES)
    except TooManyStatesError:
        return None


def _parts(obligation: Obligation) -> Iterable[f.Formula]:
    """The mode, condition, response and stop condition that the sentence has."""
    if obligation.scope is not None:
        yield obligation.mode
    if obligation.condition is not None:
        yield obligation.trigger
    yield obligation.demand.response
    if Trait.STOPS in TRAITS[obligation.demand.kind]:
        yield obligation.demand.stop


def _independent(parts: Sequence[f.Formula], names: Sequence[str]) -> bool:
    """Whether each part is a different atom or its negation, so that all letters are possible."""
    bare = [part.arg if isinstance(part, f.Not) else part for part in parts]
    return len(names) == len(parts) and all(isinstance(part, f.Atom) for part in bare)


# States as past-time formulas -------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Observable:
    """A property of states, as a function of the automaton's state and as a formula of the past."""

    formula: f.Formula
    holds: Callable[[ReferenceState], bool]


def _observables(obligation: Obligation, automaton: Automaton) -> Iterable[_Observable]:
    """The observable properties, cheap ones first."""
    stage = scope_formulas(obligation)
    enforced = (Phase.INSIDE, Phase.LAST_RUN)
    yield _Observable(stage.inside, lambda state: state.phase in enforced)
    if obligation.scope in (ScopeKind.AFTER, ScopeKind.ONLY_AFTER):
        begun = (Phase.INSIDE, Phase.FIRST_RUN)
        if obligation.scope is ScopeKind.ONLY_AFTER:
            begun = (Phase.OVER, Phase.LAST_RUN)
        yield _Observable(f.once(obligation.mode), lambda state: state.phase in begun)
    if obligation.condition is ConditionKind.TRIGGER:
        yield _Observable(f.and_(stage.inside, obligation.trigger), lambda state: state.held)
    yield from _counted(obligation.demand, stage, automaton.template.ticks)


def _counted(demand: Demand, stage: ScopeFormulas, short: int) -> Iterable[_Observable]:
    """Properties of the timing's counter; `short` is the automaton's largest count."""
    q, n = demand.response, demand.ticks
    waits = stage.open(f.not_(q))
    match demand.kind:
        case ObligationKind.IMMEDIATELY:
            return
        case ObligationKind.NEXT:
            yield _Observable(stage.trigger, lambda state: state.counted > 0)
        case ObligationKind.FINALLY:
            yield _Observable(stage.open(f.TRUE), lambda state: state.counted != 0)
            missing = f.and_(stage.open(f.TRUE), f.not_(q))
            yield _Observable(missing, lambda state: state.counted > 0)
        case ObligationKind.ALWAYS:
            yield _Observable(stage.open(f.TRUE), lambda state: state.counted > 0)
        case ObligationKind.UNTIL:
            yield _Observable(stage.open(f.not_(demand.stop)), lambda state: state.counted > 0)
        case ObligationKind.EVENTUALLY | ObligationKind.BEFORE:
            yield _Observable(waits, lambda state: state.counted > 0)
        case ObligationKind.WITHIN:
            yield from _ages(n, short, lambda age: _open_for(q, age, stage))
        case ObligationKind.AFTER:
            yield from _ages(n + 1, short + 1, lambda age: _open_for(q, age, stage))
            clash = f.and_(stage.trigger, f.previous(waits))
            kept = f.and_(f.not_(q), stage.inside)
            yield _Observable(f.since(kept, f.and_(clash, kept)), lambda state: state.counted < 0)
        case ObligationKind.FOR:
            yield from _ages(n, short, lambda age: stage.open(f.TRUE, f.Interval(0, n - 1 - age)))
        case ObligationKind.NOT_AFTER:
            recent = stage.open(f.not_(q), f.Interval(0, n))
            yield _Observable(recent, lambda state: state.counted > 0)
        case _:
            assert_never(demand.kind)


def _open_for(q: f.Formula, age: int, stage: ScopeFormulas) -> f.Formula:
    """Formula: the oldest open trigger lies `age` ticks back, or more."""
    return stage.open(f.not_(q), f.Interval(age, None))


def _ages(n: int, short: int, older: Callable[[int], f.Formula]) -> Iterable[_Observable]:
    """Whether the counter exceeds each of its values up to n; the middle values are merged."""
    for age in range(short):
        if n == short or age < _EDGE:
            real = age
        elif age >= short - _EDGE:
            real = n - short + age
        else:
            continue

        def above(state: ReferenceState, age: int = age) -> bool:
            return abs(state.counted) > age

        yield _Observable(older(real), above)


def _formula(automaton: Automaton, observables: Sequence[_Observable], verdict: str) -> f.Formula:
    """A formula that is true at the states with the verdict, and at no other."""
    with_it: dict[Vector, None] = {}
    others: set[Vector] = set()
    for number in {after for row in automaton.moves for after in row if after != BROKEN}:
        state = automaton.states[number]
        vector = tuple(observable.holds(state) for observable in observables)
        if automaton.verdicts[number] == verdict:
            with_it[vector] = None
        else:
            others.add(vector)
    certain = [vector for vector in sorted(with_it) if vector not in others]
    return f.or_(*(_term(term, observables) for term in cover(certain, others)))


def _term(term: Mapping[int, bool], observables: Sequence[_Observable]) -> f.Formula:
    parts = ((observables[i].formula, value) for i, value in term.items())
    return f.and_(*(part if value else f.not_(part) for part, value in parts))
