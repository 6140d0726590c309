"""Clauses as scope, condition and timing: all combinations that fit together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from fretish import expressions as e
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.english.markers import Clause, Role
from fretish.english.parts import Part, joined
from fretish.english.phrases import propositions
from fretish.english.responses import Response
from fretish.english.vocabulary import Vocabulary
from fretish.english.words import Places, places


@dataclass(frozen=True, slots=True)
class Use:
    """One use of a clause: as scope, condition, timing, or change of the response."""

    scope: s.ScopeKind | None = None
    condition: s.ConditionKind | None = None
    part: Part | None = None
    timing: s.Timing | None = None
    used: Places = frozenset()
    demand: str = ""
    """`only`: the response is forbidden where the part is false; `lasting`: it must not last."""


TRIGGER, HOLDING = s.ConditionKind.TRIGGER, s.ConditionKind.HOLDING


def uses(clause: Clause, names: Vocabulary, *, negated: bool) -> Iterator[Use]:
    """The uses that a clause may have.

    Args:
        clause: a clause of the sentence.
        names: the names of the project.
        negated: whether the main clause forbids.
    """
    used = places(clause.marker)
    if clause.time is not None:
        used |= clause.time.used
        yield from _timed(clause, names, used, negated)
        return
    if clause.role is Role.ASIDE or not clause.words:
        yield Use(used=frozenset())
        return
    for part in propositions(clause.words, names):
        for use in _plain(clause.role, part, negated):
            yield replace(use, used=used | part.used, part=use.part or part)


def _plain(role: Role, part: Part, negated: bool) -> Iterator[Use]:
    kind = s.ScopeKind
    match role:
        case Role.WHEN:
            yield Use(condition=TRIGGER)
            yield Use(condition=HOLDING)
        case Role.WHENEVER:
            yield Use(condition=HOLDING)
        case Role.UPON:
            yield Use(condition=TRIGGER)
        case Role.WHILE:
            yield Use(scope=kind.IN)
        case Role.UNLESS:
            yield Use(condition=HOLDING, part=part.negated())
            yield Use(timing=s.Until(part.expression))
            yield Use(scope=kind.NOT_IN)
        case Role.UNTIL:
            yield Use(timing=s.Until(part.expression))
            yield Use(scope=kind.BEFORE)
        case Role.BEFORE:
            yield Use(timing=(s.Until if negated else s.Before)(part.expression))
            yield Use(scope=kind.BEFORE)
        case Role.AFTER:
            yield Use(condition=TRIGGER)
            yield Use(scope=kind.AFTER)
        case Role.EXCEPT:
            yield Use(scope=kind.NOT_IN)
        case Role.IFF:
            yield Use(demand="iff", condition=HOLDING)
        case Role.ONLY_WHEN:
            yield Use(demand="only", condition=HOLDING, part=part.negated())
        case Role.ONLY_AFTER:
            yield Use(demand="only", timing=s.Until(part.expression))
            yield Use(scope=kind.ONLY_AFTER)
        case Role.ONLY_BEFORE:
            yield Use(demand="only", condition=TRIGGER)
            yield Use(scope=kind.ONLY_BEFORE)
        case _:
            return


def _timed(clause: Clause, names: Vocabulary, used: Places, negated: bool) -> Iterator[Use]:
    """A duration, and perhaps the event from which it counts."""
    assert clause.time is not None
    duration = clause.time.duration
    events: tuple[Part | None, ...] = (None,)
    if clause.words and clause.is_since:
        events = propositions(clause.words, names)
    for event in events:
        own = used | (event.used if event else frozenset())
        base = Use(condition=TRIGGER if event else None, part=event, used=own)
        match clause.role:
            case Role.WITHIN:
                yield replace(base, timing=(s.For if negated else s.Within)(duration))
            case Role.FOR:
                yield replace(base, timing=s.For(duration))
                if negated:
                    yield replace(base, demand="lasting", timing=_at(clause))
            case Role.MORE_THAN if not negated:
                yield replace(base, timing=s.For(duration))
            case Role.MORE_THAN | Role.AT_MOST:
                yield replace(base, demand="lasting", timing=_at(clause))
            case Role.EVERY | Role.AFTER_TIME if negated:
                return
            case Role.EVERY:
                true = Part(e.Truth(True), frozenset())
                yield Use(condition=HOLDING, part=true, timing=s.Within(duration), used=own)
            case _:
                yield replace(base, timing=s.After(duration))
                if event:
                    yield replace(base, timing=s.Within(duration))


def _at(clause: Clause) -> s.Timing:
    """`never`, which holds the duration until `_demand` puts it into the response."""
    assert clause.time is not None
    return s.Within(clause.time.duration)


# Their combination -----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Frame:
    """Scope, condition and timing of a reading, before the response."""

    scope: s.Scope | None
    condition: s.Condition | None
    timing: s.Timing | None
    used: Places
    names: Mapping[str, str]
    demands: tuple[str, ...]
    premise: e.Expression | None = None
    """What must be true at the trigger for the response to be demanded."""


def frames(clauses: Sequence[Clause], uses: tuple[Use, ...], response: Response) -> Iterator[Frame]:
    """The uses of all clauses together; none if they do not fit.

    "R if p, at the time of E" is "upon E & p", or "upon E: p -> R".
    """
    whole = _frame(clauses, uses, response)
    if whole is None:
        return
    yield whole
    pairs = [*zip(clauses, uses, strict=True)]
    events = [use for clause, use in pairs if clause.role is Role.UPON]
    others = [use for _, use in pairs if use.condition and use not in events]
    if whole.demands:
        return
    if events and others and not any(clause.is_or or clause.time for clause in clauses):
        upon = _frame(
            [clause for clause, use in pairs if use not in others],
            tuple(use for use in uses if use not in others),
            response,
        )
        if upon is not None:
            premise = joined([use.part for use in others if use.part], e.both)
            said = {**upon.names, **premise.names}
            yield replace(upon, premise=premise.expression, used=whole.used, names=said)


def _frame(clauses: Iterable[Clause], uses: tuple[Use, ...], response: Response) -> Frame | None:
    """The uses of all clauses as one frame; None if they do not fit together."""
    scopes, timings = [u for u in uses if u.scope], [u for u in uses if u.timing]
    scopes, conditions = _conditions(scopes, [*zip(clauses, uses, strict=True)], response)
    if len(scopes) > 1 or len(timings) > 1:
        return None
    if any(use.demand == "iff" for use in uses) and sum(use.part is not None for use in uses) > 1:
        return None
    used = frozenset[int]().union(*(use.used for use in uses))
    parts = [use.part for use in uses if use.part]
    names = {name: said for part in parts for name, said in part.names.items()}
    scope = scopes[0] if scopes else None
    return Frame(
        s.Scope(scope.scope, scope.part.expression)
        if scope and scope.scope and scope.part
        else None,
        conditions,
        timings[0].timing if timings else None,
        used,
        names,
        tuple(use.demand for use in uses if use.demand),
    )


def _conditions(
    scopes: list[Use], uses: list[tuple[Clause, Use]], response: Response
) -> tuple[list[Use], s.Condition | None]:
    """The scopes that stay scopes, and the condition of all other parts together."""
    kept = scopes
    extra: list[Use] = []
    if len(scopes) > 1:
        extra = [use for use in scopes if use.scope is s.ScopeKind.IN][1:]
        kept = [use for use in scopes if use not in extra]
    parts = [(use.part, use.condition, clause.is_or) for clause, use in uses if use.condition]
    parts += [(use.part, HOLDING, False) for use in extra]
    if response.condition is not None:
        kinds = {kind for _, kind, _ in parts}
        kind = TRIGGER if kinds == {TRIGGER} else HOLDING
        parts.insert(0, (response.condition, kind, False))
    whole: Part | None = None
    for part, _, is_or in parts:
        assert part is not None
        whole = joined([whole, part], e.either if is_or else e.both) if whole else part
    if whole is None:
        return kept, None
    kind = TRIGGER if any(kind is TRIGGER for _, kind, _ in parts) else HOLDING
    return kept, s.Condition(kind, whole.expression, "when" if kind is TRIGGER else "whenever")
