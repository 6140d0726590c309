"""All plausible readings of an English sentence as FRETish."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from itertools import islice, product
from typing import assert_never

from fretish import expressions as e
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.diagnostics.source import Source
from fretish.english.amounts import Time
from fretish.english.clauses import divided, outlines
from fretish.english.frames import HOLDING, TRIGGER, Effect, Frame, frames, uses
from fretish.english.responses import Adverb, Response, responses
from fretish.english.vocabulary import Vocabulary, lacking
from fretish.english.words import (
    PUNCTUATION,
    Phrase,
    Places,
    carries_meaning,
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
"""The largest number of combinations of clauses that are tried, and of readings that they make."""
_IMMEDIATELY, _NEXT, _ALWAYS = s.Immediately(), s.Next(), s.Always()
_EVENTUALLY, _NEVER = s.Eventually(), s.Never()


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
    for reading in islice(_all(phrase, names), _MOST_TRIED):
        fretish = reading.text
        tree = None if fretish in distinct else parse(Source("<text>", fretish).span())
        if isinstance(tree, s.Sentence):
            distinct[fretish] = replace(reading, sentence=tree)
    least = min((len(each.left_out) for each in distinct.values()), default=0)
    return tuple(each for each in distinct.values() if len(each.left_out) == least)[:MOST]


def _all(phrase: Phrase, names: Vocabulary) -> Iterator[Reading]:
    for parts in outlines(phrase):
        if not parts.predicate and not parts.subject:
            continue
        for response in responses(parts, names):
            choices = [
                tuple(uses(clause, names, negated=response.negated)) for clause in parts.clauses
            ]
            for chosen in islice(product(*choices), _MOST_TRIED):
                for frame in frames(parts.clauses, chosen, response):
                    yield from _sentences(phrase, response, frame)


# Sentences -------------------------------------------------------------------------------------


def _sentences(phrase: Phrase, response: Response, frame: Frame) -> Iterator[Reading]:
    used = response.part.used | response.used | frame.used
    names = {**frame.names, **response.part.names}
    if response.condition is not None:
        used |= response.condition.used
        names |= response.condition.names
    for condition, timing, demanded, of_adverb in _demands(response, frame):
        sentence = s.Sentence(
            frame.scope, condition, response.component, None, timing, demanded, article=True
        )
        yield Reading(sentence, names, _left_out(phrase, used | of_adverb))


def _left_out(phrase: Phrase, used: Places) -> tuple[str, ...]:
    """The runs of words that no part uses."""
    runs: list[Phrase] = [()]
    for word in phrase:
        if word.start in used:
            runs.append(())
        elif word.text not in PUNCTUATION:
            runs[-1] = (*runs[-1], word)
    return tuple(text(run) for run in runs if any(map(carries_meaning, run)))


_Demand = tuple[s.Condition | None, s.Timing, e.Expression, Places]
"""Condition, timing, response, and the places of the adverb that the timing says."""
_NOWHERE: Places = frozenset()


def _goes_with(adverb: Adverb | None, timing: s.Timing, *, negated: bool) -> bool:
    """Whether a timing says what the adverb says: "always until", "never within"."""
    match timing:
        case s.Until() | s.For():
            goes_on = True
        case s.Always() | s.Never() | s.Immediately() | s.Next():
            goes_on = False
        case s.Finally() | s.Eventually() | s.Within() | s.After() | s.Before():
            goes_on = False
        case _:
            assert_never(timing)
    return adverb is Adverb.ALWAYS and (negated or goes_on)


def _demands(response: Response, frame: Frame) -> Iterator[_Demand]:
    """Condition, timing and response: several if the text leaves the timing open."""
    part = response.part
    condition = frame.condition
    if frame.effect is Effect.LASTING:
        duration = s.duration(frame.timing) if frame.timing is not None else None
        assert duration is not None, "what lasts has a duration"
        yield from _lasting(response, frame, duration)
        return
    if frame.effect is Effect.IFF and condition is not None:
        said = part.negated().expression if response.negated else part.expression
        always = [some for adverb, some in response.adverbs if adverb is Adverb.ALWAYS]
        yield None, _ALWAYS, e.Iff(condition.expression, said), _NOWHERE.union(*always)
        return
    only = frame.effect is Effect.ONLY
    negated = response.negated != only
    expression = part.negated().expression if negated else part.expression
    for adverb, places in response.adverbs or ((None, _NOWHERE),):
        if frame.timing is not None and not _goes_with(adverb, frame.timing, negated=negated):
            places = _NOWHERE
        for kind, timing in _timings(adverb, frame, negated=negated):
            own = condition
            if condition and kind and kind is not condition.kind:
                continue
            if only and condition and timing == _NEXT:
                continue
            if frame.premise is not None:
                if timing != _NEVER:
                    yield own, timing, e.Implies(frame.premise, expression), places
            elif timing == _NEVER:
                yield own, _NEVER, part.expression, places
            else:
                yield own, timing, expression, places


def _lasting(response: Response, frame: Frame, duration: s.Duration) -> Iterator[_Demand]:
    """`never persisted(n, p)`: p must not last longer."""
    amount = Time(duration, frozenset(), 0).amount
    lasts = e.Call("persisted", (amount, response.part.expression))
    yield frame.condition, _NEVER, lasts, _NOWHERE


_Timing = tuple[s.ConditionKind | None, s.Timing]


def _timings(adverb: Adverb | None, frame: Frame, *, negated: bool) -> Iterator[_Timing]:
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
            yield None, _NEVER if negated else _EVENTUALLY
        case Adverb.ALWAYS:
            yield from _always(frame, negated)
        case None if frame.scope is not None and frame.scope.kind.negates:
            yield None, _EVENTUALLY
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
            yield TRIGGER, _NEVER if negated else _ALWAYS


def _always(frame: Frame, negated: bool) -> Iterator[_Timing]:
    """`always`: at every tick at which the condition is true, or from its trigger on."""
    always = _NEVER if negated else _ALWAYS
    if frame.condition is None:
        yield None, always
        return
    yield HOLDING, _IMMEDIATELY
    yield TRIGGER, always
