"""Checks that numbers in titles, texts and `params` agree with the sentence and its bindings.

A title with 5 cm and a binding with 0.9 m mislead everyone who reads only one of them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

from compiler.formalization.formalized import FormalizedRequirement
from fretish import syntax, units
from fretish.bindings.constants import Exact, constants
from fretish.bindings.declarations import Declarations, Proposition
from fretish.checking import conditions
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.expressions import COUNTING, Call, Expression, Quantity, parts
from fretish.syntax import TimeUnit

_WORDS: dict[str, TimeUnit] = {
    "tick": "tick", "microsecond": "microsecond", "millisecond": "millisecond",
    "second": "second", "sec": "second", "minute": "minute", "hour": "hour",
}  # fmt: skip
_SECONDS: dict[TimeUnit, Fraction] = {
    "microsecond": Fraction(1, 10**6), "millisecond": Fraction(1, 1000),
    "second": Fraction(1), "minute": Fraction(60), "hour": Fraction(3600),
}  # fmt: skip
_LONG_UNITS = {"percent": "%", "metre": "m", "meter": "m", "degree": "deg"}
_QUANTITY = re.compile(
    r"(?<![\w.,/-])(?P<digits>[0-9]{1,12}(?:\.[0-9]{1,12})?)[ \u00a0\u202f]?"
    r"(?P<unit>%|[A-Za-z]{1,12}(?:/[A-Za-z]{1,12}(?:\^?[0-9])?)?)(?![\w%])"
)


def check_stated_numbers(
    requirement: FormalizedRequirement, declarations: Declarations
) -> Iterator[Diagnostic]:
    """F310 and F351 for numbers in `params`, title or text that the bindings contradict."""
    yield from _parameters(requirement, declarations)
    yield from _prose(requirement, declarations)


def drifted(
    requirement: FormalizedRequirement, declarations: Declarations
) -> Iterator[tuple[str, str]]:
    """The contradicted numbers as field and text: `("title", "0.40 m/s")`."""
    for name, text in requirement.entry.params.items():
        if _has_drifted(text, _propositions(requirement, declarations, name)):
            yield "params", text
    yield from ((field, words) for field, words, _ in _drifted_words(requirement, declarations))


def first_unit(requirements: Iterable[FormalizedRequirement]) -> Diagnostic | None:
    """F352 for the first number with a unit in the sentences of a project."""
    for requirement in requirements:
        for expression in conditions(requirement.written):
            durations = {*map(id, _counts(expression))}
            for part in parts(expression):
                if isinstance(part, Quantity) and id(part) not in durations:
                    return diagnostic(
                        "unit_in_sentence", part.span, digits=part.digits, unit=part.unit
                    )
    return None


# Parameters


def _parameters(
    requirement: FormalizedRequirement, declarations: Declarations
) -> Iterator[Diagnostic]:
    """F310; a number of `params` belongs to a proposition, or to a compared signal."""
    for name, text in requirement.entry.params.items():
        span = requirement.entry.place("params", name)
        propositions = _propositions(requirement, declarations, name)
        mistaken = {("proposition", name), ("signal", name)} & declarations.mistakes.keys()
        if not propositions and not mistaken:
            yield diagnostic("unbound_parameter", span, name=name)
            continue
        if units.quantity(text) is None:
            yield diagnostic("parameter_not_quantity", span, text=text)
        elif _has_drifted(text, propositions):
            yield diagnostic("parameter_drift", propositions[0].span, text=text, name=name)


def _has_drifted(text: str, propositions: Sequence[Proposition]) -> bool:
    """Whether no proposition has the quantity of `params`."""
    stated = units.quantity(text)
    return stated is not None and bool(propositions) and not _is_stated(stated, propositions)


def _is_stated(number: Exact, propositions: Iterable[Proposition]) -> bool:
    return any(number in constants(proposition.expression) for proposition in propositions)


def _propositions(
    requirement: FormalizedRequirement, declarations: Declarations, name: str
) -> list[Proposition]:
    """The proposition with the name; for a signal the propositions of the sentence that read it."""
    if name in declarations.propositions:
        return [declarations.propositions[name]]
    own = (declarations.propositions.get(watched) for watched in requirement.watched)
    return [
        proposition
        for proposition in own
        if proposition and name in (*proposition.signals, *proposition.calculations)
    ]


# Title and text


def _prose(requirement: FormalizedRequirement, declarations: Declarations) -> Iterator[Diagnostic]:
    """F351 for each quantity in title and text that the requirement does not use."""
    for field, words, elsewhere in _drifted_words(requirement, declarations):
        yield _differs(requirement, field, words, requirement.entry.place(field), elsewhere)


def _drifted_words(
    requirement: FormalizedRequirement, declarations: Declarations
) -> Iterator[tuple[str, str, Span | None]]:
    """Field, quantity, and the span of the number of its dimension that the requirement uses."""
    numbers = _numbers(requirement, declarations)
    for field in ("title", "text"):
        for words, stated in _quantities(getattr(requirement.entry, field)):
            rivals = [(number, span) for number, span in numbers if number[0] == stated[0]]
            if not rivals or any(number == stated for number, _ in rivals):
                continue
            yield field, words, rivals[0][1]


def _numbers(
    requirement: FormalizedRequirement, declarations: Declarations
) -> list[tuple[Exact, Span | None]]:
    """Every number of the sentence and its bindings, with its span."""
    bound = [declarations.propositions.get(name) for name in requirement.watched]
    numbers = [
        (number, proposition.span)
        for proposition in bound
        if proposition is not None
        for number in constants(proposition.expression)
    ]
    duration = syntax.duration(requirement.sentence.timing)
    if duration is not None and duration.unit in _SECONDS:
        seconds = duration.amount * _SECONDS[duration.unit]
        numbers.append(((units.SECOND.dimension, seconds), duration.span))
    numbers.extend(_durations_of_predicates(requirement))
    return numbers


def _durations_of_predicates(
    requirement: FormalizedRequirement,
) -> Iterator[tuple[Exact, Span | None]]:
    """The durations in `persisted(10 s, p)` and its like, with their spans."""
    for expression in conditions(requirement.written):
        for part in _counts(expression):
            if isinstance(part, Quantity) and (
                exact := units.quantity(f"{part.digits} {part.unit}")
            ):
                yield exact, part.span


def _counts(expression: Expression) -> Iterator[Expression]:
    """The first arguments of the predicates that count time."""
    for part in parts(expression):
        if isinstance(part, Call) and part.name in COUNTING:
            yield from part.args[:-1]


def _quantities(text: str) -> Iterator[tuple[str, Exact]]:
    """The quantities in a text: `5 cm`, `0.4 m/s`, `20 percent`, `200 milliseconds`."""
    for match in _QUANTITY.finditer(text):
        word = match["unit"]
        single = word[:-1] if word.endswith("s") and len(word) > 2 else word
        duration = _WORDS.get(single)
        if duration in _SECONDS:
            yield match[0], (units.SECOND.dimension, Fraction(match["digits"]) * _SECONDS[duration])
            continue
        measure = units.unit(_LONG_UNITS.get(single, word))
        if measure is not None and word != "1":
            yield match[0], (measure.dimension, Fraction(match["digits"]) * measure.factor)


def _differs(
    requirement: FormalizedRequirement, field: str, words: str, span: Span, elsewhere: Span | None
) -> Diagnostic:
    at = span.text.find(words)
    where = span.part(at, at + len(words)) if at >= 0 else span
    other = ""
    if elsewhere is not None:
        other = f": {elsewhere.text} ({elsewhere.source.name}:{elsewhere.line}:{elsewhere.column})"
    return diagnostic(
        "prose_drift", where, field=field, requirement=requirement.id, words=words, other=other
    )
