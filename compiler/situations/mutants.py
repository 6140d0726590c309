"""Mutants: sentences that differ slightly from a requirement, as in mutation testing.

Tests that cannot distinguish a sentence from its mutants would not detect that it is wrong. The
operators are those of `OPERATORS`, each applied wherever it fits, in their order.

Source: Fraser, Wotawa, Complementary criteria for testing temporal logic properties, TAP 2009;
Black, Okun, Yesha, Mutation operators for specifications, ASE 2000.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.situations.changes import changes, opposite
from fretish import expressions as e
from fretish import syntax as s
from fretish.checking import is_formula
from fretish.classes.frozen import dataclass
from fretish.clock import in_unit
from fretish.diagnostics.source import Source
from fretish.printer import canonical, condition, expression, scope, timing
from fretish.printer import sentence as printed
from fretish.reading.recursion import with_recursion_limit

OPERATORS: Mapping[str, str] = {
    "scope": "another scope, or none",
    "condition": "`whenever` for `upon` and the other way, or no condition",
    "timing": "another timing, with the duration or the stop condition of the sentence; a timing "
    "that needs a duration which the sentence lacks has one of 3 ticks",
    "bound": "a duration one tick longer or shorter, half, twice, or none",
    "negated": "a part, or an operand in it, negated",
    "stuck": "a part that is always true, or always false",
    "dropped": "a conjunction or disjunction without one operand",
    "operator": "`|` for `&`, `&` for `|`, `|` for `xor`, `<->` for `->`, `->` for `<->`",
    "compared": "`<=` for `<` and the other way, `>` for `<` and the other way",
    "threshold": "a number in a comparison, more or less by one unit of its last digit",
}
"""Mutation operators with their descriptions. A part is the mode, the condition, the response or
the stop condition."""
_UNBOUND = s.Duration(3, "tick")


@dataclass(frozen=True, slots=True)
class Mutant:
    """A requirement with one small change."""

    key: str
    """The operator of `OPERATORS`, a colon and the place; unique within a requirement."""
    words: str
    """The change in words."""
    requirement: FormalizedRequirement
    """The mutated requirement, with the same id and bindings."""


@dataclass(frozen=True, slots=True)
class _Draft:
    """A candidate for a mutant, which may equal the original or be invalid."""

    key: str
    words: str
    sentence: s.Sentence


@with_recursion_limit
def mutants(requirement: FormalizedRequirement) -> tuple[Mutant, ...]:
    """The mutants of a requirement; their sentences differ from each other and from the original.

    Sentences that cannot be formalized are left out. A formula has no mutants.
    """
    if is_formula(requirement.sentence):
        return ()
    seen = {canonical(requirement.written)}
    by_key: dict[str, Mutant] = {}
    for draft in _drafts(requirement):
        text = canonical(draft.sentence)
        formalized = None if text in seen else _formalized(requirement, draft.sentence)
        seen.add(text)
        if formalized is not None:
            key = _unique(draft.key, by_key)
            by_key[key] = Mutant(key, draft.words, formalized)
    return tuple(by_key.values())


def _unique(key: str, taken: Mapping[str, Mutant]) -> str:
    number = 2
    while f"{key}-{number}" in taken:
        number += 1
    return f"{key}-{number}" if key in taken else key


def _formalized(
    requirement: FormalizedRequirement, sentence: s.Sentence
) -> FormalizedRequirement | None:
    source = Source(requirement.entry.wording.source.name, printed(sentence))
    formalized, _ = formalize(
        replace(requirement.entry, wording=source.span()), requirement.declarations
    )
    return formalized


def _drafts(requirement: FormalizedRequirement) -> Iterator[_Draft]:
    sentence = requirement.written
    yield from _scopes(sentence)
    yield from _conditions(sentence)
    yield from _timings(sentence)
    yield from _bounds(requirement)
    drafts = [draft for part in _parts(sentence) for draft in _of_part(sentence, *part)]
    order = [*OPERATORS]
    yield from sorted(drafts, key=lambda draft: order.index(draft.key.partition(":")[0]))


# The template -----------------------------------------------------------------------------------


def _scopes(sentence: s.Sentence) -> Iterator[_Draft]:
    own = sentence.scope
    if own is None:
        return
    for kind in s.ScopeKind:
        other = replace(own, kind=kind)
        words = f"`{scope(other)}` in place of `{scope(own)}`"
        yield _Draft(f"scope:{own.kind}->{kind}", words, replace(sentence, scope=other))
    yield _Draft("scope:missing", f"without `{scope(own)}`", replace(sentence, scope=None))


def _conditions(sentence: s.Sentence) -> Iterator[_Draft]:
    own = sentence.condition
    if own is None:
        return
    for kind in s.ConditionKind:
        other = replace(own, kind=kind)
        words = f"`{condition(other)}` in place of `{condition(own)}`"
        yield _Draft(f"condition:{own.kind}->{kind}", words, replace(sentence, condition=other))
    words = f"without `{condition(own)}`"
    yield _Draft("condition:missing", words, replace(sentence, condition=None))


def _timings(sentence: s.Sentence) -> Iterator[_Draft]:
    own, stop = sentence.timing, s.stop(sentence.timing)
    bound = s.duration(own) or _UNBOUND
    others: list[s.Timing] = [s.Immediately(), s.Next(), s.Finally(), s.Eventually(), s.Always()]
    others += [s.Never(), s.Within(bound), s.For(bound), s.After(bound)]
    others += [] if stop is None else [s.Until(stop), s.Before(stop)]
    for other in others:
        if type(other) is not type(own):
            words = f"`{timing(other)}` in place of {_named(own)}"
            changed = replace(sentence, timing=other)
            key = f"timing:{s.timing_key(sentence)}->{s.timing_key(changed)}"
            yield _Draft(key, words, changed)


def _named(own: s.Timing) -> str:
    return f"`{timing(own)}`" if timing(own) else "no timing"


def _bounds(requirement: FormalizedRequirement) -> Iterator[_Draft]:
    own, ticks = s.duration(requirement.written.timing), requirement.ticks
    if own is None or ticks is None:
        return
    others = {
        "bound:+1": ticks + 1,
        "bound:-1": ticks - 1,
        "bound:half": ticks // 2,
        "bound:double": 2 * ticks,
        "bound:0": 0,
    }
    for key, number in others.items():
        if number >= 0:
            other = s.with_duration(
                requirement.written.timing, in_unit(number, own.unit, requirement.clock)
            )
            words = f"`{timing(other)}` in place of `{timing(requirement.written.timing)}`"
            yield _Draft(key, words, replace(requirement.written, timing=other))


# The expressions --------------------------------------------------------------------------------


def _parts(sentence: s.Sentence) -> Iterator[tuple[str, e.Expression]]:
    stop = s.stop(sentence.timing)
    if sentence.scope is not None:
        yield "mode", sentence.scope.mode
    if sentence.condition is not None:
        yield "condition", sentence.condition.expression
    yield "response", sentence.response
    if stop is not None:
        yield "stop", stop


def _of_part(sentence: s.Sentence, name: str, part: e.Expression) -> Iterator[_Draft]:
    text = expression(part)

    def draft(key: str, words: str, other: e.Expression) -> _Draft:
        return _Draft(key, words, _with(sentence, name, other))

    other = opposite(part)
    yield draft(f"negated:{name}", f"`{expression(other)}` in place of `{text}`", other)
    for value in (True, False):
        stuck = e.Truth(value)
        words = f"`{expression(stuck)}` in place of `{text}`"
        yield draft(f"stuck:{name}-{expression(stuck)}", words, stuck)
    for change in changes(part):
        about = change.about.replace(" ", "")
        yield draft(f"{change.operator}:{name}:{about}", change.words, change.whole)


def _with(sentence: s.Sentence, name: str, part: e.Expression) -> s.Sentence:
    """The sentence with one part replaced by another expression."""
    place = {id(own_part): part if key == name else own_part for key, own_part in _parts(sentence)}
    return s.with_expressions(sentence, lambda own_part: place[id(own_part)])
