"""All plausible readings of an English sentence as FRETish."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from itertools import islice, product

from fretish import expressions as e
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.diagnostics.source import Source
from fretish.english.amounts import Time
from fretish.english.clauses import Clause, Role, divided, outline
from fretish.english.parts import Part, joined
from fretish.english.phrases import propositions
from fretish.english.responses import Adverb, Response, responses
from fretish.english.vocabulary import Vocabulary, lacking
from fretish.english.words import (
    PUNCTUATION,
    Phrase,
    Places,
    carries_meaning,
    places,
    sentences,
    text,
    words,
)
from fretish.parser import parse
from fretish.printer import sentence as printed

MOST = 24
"""The largest number of readings of a sentence."""
MOST_WORDS = 200
"""A longer sentence has no reading."""
_MOST_TRIED = 256
"""The largest number of combinations of clauses that are tried."""
_IMMEDIATELY, _NEXT, _ALWAYS = s.Immediately(), s.Next(), s.Always()
_EVENTUALLY, _NEVER = s.Eventually(), s.Never()
_TIMED = (Role.WITHIN, Role.FOR, Role.MORE_THAN, Role.AFTER_TIME, Role.EVERY)


@dataclass(frozen=True, slots=True)
class Reading:
    """A sentence that a text may mean."""

    sentence: s.Sentence
    names: Mapping[str, str] = field(default_factory=dict)
    """Name in the sentence → the words that it stands for."""
    left_out: tuple[str, ...] = ()
    """Words of the text that the sentence does not contain."""

    @property
    def text(self) -> str:
        """The sentence as `fretc fmt` writes it."""
        return printed(self.sentence)

    @property
    def lacking(self) -> Mapping[str, tuple[str, ...]]:
        """Name of the project → words of its phrase that the name does not contain."""
        rest = {name: lacking(name, words(said)) for name, said in self.names.items()}
        return {name: some for name, some in rest.items() if some}


def demands(text: str) -> tuple[str, ...]:
    """The demands of a text, as sentences that `readings` reads one by one."""
    return tuple(part for sentence in sentences(text) for part in divided(sentence))


def readings(text: str, names: Vocabulary) -> tuple[Reading, ...]:
    """The readings of one sentence, the most plausible first; FRETish has one, itself.

    Args:
        text: one sentence.
        names: the names of the project.

    Returns:
        Readings with different sentences; none if the text demands nothing, or is too long.
    """
    already = parse(Source("<text>", text).span())
    if isinstance(already, s.Sentence):
        return (Reading(already),)
    phrase = words(text)
    if len(phrase) > MOST_WORDS or not any(carries_meaning(word) for word in phrase):
        return ()
    distinct: dict[str, Reading] = {}
    for reading in _all(phrase, names):
        tree = parse(Source("<text>", reading.text).span())
        if isinstance(tree, s.Sentence):
            distinct.setdefault(reading.text, replace(reading, sentence=tree))
    least = min((len(each.left_out) for each in distinct.values()), default=0)
    return tuple(each for each in distinct.values() if len(each.left_out) == least)[:MOST]


def _all(phrase: Phrase, names: Vocabulary) -> Iterator[Reading]:
    parts = outline(phrase)
    if not parts.predicate and not parts.subject:
        return
    for response in responses(parts, names):
        choices = [tuple(_uses(clause, names, response.negated)) for clause in parts.clauses]
        for chosen in islice(product(*choices), _MOST_TRIED):
            for frame in _frames(parts.clauses, chosen, response):
                yield from _sentences(phrase, response, frame)


# Clauses ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Use:
    """One use of a clause: as scope, condition, timing, or change of the response."""

    scope: s.ScopeKind | None = None
    condition: s.ConditionKind | None = None
    part: Part | None = None
    timing: s.Timing | None = None
    used: Places = frozenset()
    demand: str = ""
    """`only`: the response is forbidden where the part is false; `lasting`: it must not last."""


_TRIGGER, _HOLDING = s.ConditionKind.TRIGGER, s.ConditionKind.HOLDING


def _uses(clause: Clause, names: Vocabulary, negated: bool) -> Iterator[_Use]:
    used = places(clause.marker)
    if clause.time is not None:
        used |= clause.time.used
        yield from _timed(clause, names, used, negated)
        return
    if clause.role is Role.ASIDE or not clause.words:
        yield _Use(used=frozenset())
        return
    for part in propositions(clause.words, names):
        for use in _plain(clause.role, part, negated):
            yield replace(use, used=used | part.used, part=use.part or part)


def _plain(role: Role, part: Part, negated: bool) -> Iterator[_Use]:
    kind = s.ScopeKind
    match role:
        case Role.WHEN:
            yield _Use(condition=_TRIGGER)
            yield _Use(condition=_HOLDING)
        case Role.WHENEVER:
            yield _Use(condition=_HOLDING)
        case Role.UPON:
            yield _Use(condition=_TRIGGER)
        case Role.WHILE:
            yield _Use(scope=kind.IN)
        case Role.UNLESS:
            yield _Use(condition=_HOLDING, part=part.negated())
            yield _Use(timing=s.Until(part.expression))
            yield _Use(scope=kind.NOT_IN)
        case Role.UNTIL:
            yield _Use(timing=s.Until(part.expression))
            yield _Use(scope=kind.BEFORE)
        case Role.BEFORE:
            yield _Use(timing=(s.Until if negated else s.Before)(part.expression))
            yield _Use(scope=kind.BEFORE)
        case Role.AFTER:
            yield _Use(condition=_TRIGGER)
            yield _Use(scope=kind.AFTER)
        case Role.EXCEPT:
            yield _Use(scope=kind.NOT_IN)
        case Role.IFF:
            yield _Use(demand="iff", condition=_HOLDING)
        case Role.ONLY_WHEN:
            yield _Use(demand="only", condition=_HOLDING, part=part.negated())
        case Role.ONLY_AFTER:
            yield _Use(demand="only", timing=s.Until(part.expression))
            yield _Use(scope=kind.ONLY_AFTER)
        case Role.ONLY_BEFORE:
            yield _Use(demand="only", condition=_TRIGGER)
            yield _Use(scope=kind.ONLY_BEFORE)
        case _:
            return


def _timed(clause: Clause, names: Vocabulary, used: Places, negated: bool) -> Iterator[_Use]:
    """A duration, and perhaps the event from which it counts."""
    assert clause.time is not None
    duration = clause.time.duration
    events: tuple[Part | None, ...] = (None,)
    if clause.words and clause.is_since:
        events = propositions(clause.words, names)
    for event in events:
        own = used | (event.used if event else frozenset())
        base = _Use(condition=_TRIGGER if event else None, part=event, used=own)
        match clause.role:
            case Role.WITHIN:
                yield replace(base, timing=(s.For if negated else s.Within)(duration))
            case Role.FOR:
                yield replace(base, timing=s.For(duration))
                if negated:
                    yield replace(base, demand="lasting", timing=_at(clause))
            case Role.MORE_THAN:
                yield replace(base, demand="lasting", timing=_at(clause))
            case Role.EVERY:
                true = Part(e.Truth(True), frozenset())
                yield _Use(condition=_HOLDING, part=true, timing=s.Within(duration), used=own)
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
class _Frame:
    """Scope, condition and timing of a reading, before the response."""

    scope: s.Scope | None
    condition: s.Condition | None
    timing: s.Timing | None
    used: Places
    names: Mapping[str, str]
    demands: tuple[str, ...]
    premise: e.Expression | None = None
    """What must be true at the trigger for the response to be demanded."""


def _frames(
    clauses: Sequence[Clause], uses: tuple[_Use, ...], response: Response
) -> Iterator[_Frame]:
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


def _frame(clauses: Iterable[Clause], uses: tuple[_Use, ...], response: Response) -> _Frame | None:
    """The uses of all clauses as one frame; None if they do not fit together."""
    scopes, timings = [u for u in uses if u.scope], [u for u in uses if u.timing]
    scopes, conditions = _conditions(scopes, [*zip(clauses, uses, strict=True)], response)
    if len(scopes) > 1 or len(timings) > 1:
        return None
    used = frozenset[int]().union(*(use.used for use in uses))
    parts = [use.part for use in uses if use.part]
    names = {name: said for part in parts for name, said in part.names.items()}
    scope = scopes[0] if scopes else None
    return _Frame(
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
    scopes: list[_Use], uses: list[tuple[Clause, _Use]], response: Response
) -> tuple[list[_Use], s.Condition | None]:
    """The scopes that stay scopes, and the condition of all other parts together."""
    kept = scopes
    extra: list[_Use] = []
    if len(scopes) > 1:
        extra = [use for use in scopes if use.scope is s.ScopeKind.IN][1:]
        kept = [use for use in scopes if use not in extra]
    parts = [(use.part, use.condition, clause.is_or) for clause, use in uses if use.condition]
    parts += [(use.part, _HOLDING, False) for use in extra]
    if response.condition is not None:
        kinds = {kind for _, kind, _ in parts}
        kind = _TRIGGER if kinds == {_TRIGGER} else _HOLDING
        parts.insert(0, (response.condition, kind, False))
    whole: Part | None = None
    for part, _, is_or in parts:
        assert part is not None
        whole = joined([whole, part], e.either if is_or else e.both) if whole else part
    if whole is None:
        return kept, None
    kind = _TRIGGER if any(kind is _TRIGGER for _, kind, _ in parts) else _HOLDING
    return kept, s.Condition(kind, whole.expression, "when" if kind is _TRIGGER else "whenever")


# Sentences -------------------------------------------------------------------------------------


def _sentences(phrase: Phrase, response: Response, frame: _Frame) -> Iterator[Reading]:
    used = response.part.used | response.used | frame.used
    names = {**frame.names, **response.part.names}
    if response.condition is not None:
        used |= response.condition.used
        names |= response.condition.names
    missing = _left_out(phrase, used)
    for condition, timing, demanded in _demands(response, frame):
        sentence = s.Sentence(
            frame.scope, condition, response.component, None, timing, demanded, article=True
        )
        yield Reading(sentence, names, missing)


def _left_out(phrase: Phrase, used: Places) -> tuple[str, ...]:
    """The runs of words that no part uses."""
    runs: list[Phrase] = [()]
    for word in phrase:
        if word.start in used:
            runs.append(())
        elif word.text not in PUNCTUATION:
            runs[-1] = (*runs[-1], word)
    return tuple(text(run) for run in runs if any(map(carries_meaning, run)))


_Demand = tuple[s.Condition | None, s.Timing, e.Expression]


def _demands(response: Response, frame: _Frame) -> Iterator[_Demand]:
    """Condition, timing and response: several if the text leaves the timing open."""
    part = response.part
    condition = frame.condition
    if "lasting" in frame.demands:
        assert isinstance(frame.timing, s.Within)
        yield from _lasting(response, frame, frame.timing.duration)
        return
    if "iff" in frame.demands and condition is not None:
        said = part.negated().expression if response.negated else part.expression
        yield None, _ALWAYS, e.Iff(condition.expression, said)
        return
    only = "only" in frame.demands
    negated = response.negated != only
    expression = part.negated().expression if negated else part.expression
    for adverb in response.adverbs or (None,):
        for kind, timing in _timings(adverb, frame, negated=negated):
            own = condition
            if condition and kind and kind is not condition.kind:
                continue
            if only and condition and timing == _NEXT:
                continue
            if frame.premise is not None:
                if timing != _NEVER:
                    yield own, timing, e.Implies(frame.premise, expression)
            elif timing == _NEVER:
                yield own, _NEVER, _forbidden(part, negated)
            else:
                yield own, timing, expression


def _forbidden(part: Part, negated: bool) -> e.Expression:
    """What `never` forbids: a comparison without its sign."""
    return part.expression if negated else part.negated().expression


def _lasting(response: Response, frame: _Frame, duration: s.Duration) -> Iterator[_Demand]:
    """`never persisted(n, p)`: p must not last longer."""
    amount = Time(duration, frozenset(), 0).amount
    lasts = e.Call("persisted", (amount, response.part.expression))
    yield frame.condition, _NEVER, lasts


_Timing = tuple[s.ConditionKind | None, s.Timing]


def _timings(adverb: Adverb | None, frame: _Frame, *, negated: bool) -> Iterator[_Timing]:
    """The timings that the words allow; with the kind of condition that each needs."""
    if frame.timing is not None:
        yield None, frame.timing
        return
    match adverb:
        case Adverb.IMMEDIATELY:
            yield None, _IMMEDIATELY
        case Adverb.NEXT:
            yield None, _NEXT
        case Adverb.FINALLY:
            yield None, s.Finally()
        case Adverb.EVENTUALLY:
            yield None, _EVENTUALLY
        case Adverb.ALWAYS:
            yield from _always(frame, negated)
        case None if frame.condition is None:
            yield from _always(frame, negated)
            if not negated:
                yield None, _EVENTUALLY
                if frame.scope is not None:
                    yield None, _IMMEDIATELY
        case None:
            yield None, _IMMEDIATELY
            yield None, _NEXT
            if not negated:
                yield None, _EVENTUALLY
            yield _TRIGGER, _NEVER if negated else _ALWAYS


def _always(frame: _Frame, negated: bool) -> Iterator[_Timing]:
    """`always`: at every tick at which the condition is true, or from its trigger on."""
    always = _NEVER if negated else _ALWAYS
    if frame.condition is None:
        yield None, always
        return
    yield _HOLDING, _IMMEDIATELY
    yield _TRIGGER, always
