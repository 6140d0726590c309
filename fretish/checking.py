"""Checks of a parsed sentence: reserved words, nesting depth, and kinds of values."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from fretish import expressions as e
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.fixes import Fix
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.expressions import depth
from fretish.keywords import UNUSED
from fretish.reading.recursion import MOST
from fretish.syntax import Sentence, stop

_NUMERIC_PREDICATES = frozenset({"preInt", "preReal"})
_NUMERIC_FUNCTIONS = frozenset({"absReal", "absInt", "maxReal", "maxInt", "minReal", "minInt"})


def conditions(sentence: Sentence) -> Iterator[e.Expression]:
    """Every Boolean expression of the sentence: scope, condition, stop condition, response."""
    if sentence.scope is not None:
        yield sentence.scope.mode
    if sentence.condition is not None:
        yield sentence.condition.expression
    stop_condition = stop(sentence.timing)
    if stop_condition is not None:
        yield stop_condition
    yield sentence.response


def check_depth(sentence: Sentence) -> Diagnostic | None:
    """F115 if an expression is nested deeper than `MOST` levels."""
    if all(depth(expression) <= MOST for expression in conditions(sentence)):
        return None
    return too_deep(sentence)


def too_deep(sentence: Sentence) -> Diagnostic:
    """F115 for the whole sentence."""
    return diagnostic("expression_too_deep", sentence.span)


def calls(expression: e.Expression) -> Iterator[str]:
    """The name of each function and predicate that the expression calls.

    An operator of a formula is called `G (formula)`, which is the name of no function.
    """
    for part in e.parts(expression):
        if isinstance(part, e.Call):
            yield part.name
        elif isinstance(part, e.Temporal):
            yield f"{part.operator} (formula)"


def is_formula(sentence: Sentence) -> bool:
    """Whether it is a formula with temporal operators, which no sentence of FRETish has."""
    return any(isinstance(part, e.Temporal) for part in e.parts(sentence.response))


def has_units(sentence: Sentence) -> bool:
    """Whether a number in the sentence has a unit, which FRET cannot read."""
    return any(map(e.has_unit, conditions(sentence)))


def check_names(sentence: Sentence) -> Iterator[Diagnostic]:
    """F109 for each unquoted name that is a reserved word of FRET."""
    names = [name for expression in conditions(sentence) for name in _names(expression)]
    for _, span in [(sentence.component, sentence.component_span), *names]:
        if span is not None and span.text.lower() in UNUSED:
            yield diagnostic("key_word_as_name", span, word=span.text)


def check_value(expression: e.Expression, span: Span) -> Iterator[Diagnostic]:
    """Check the value of a variable: F112 and F115."""
    if depth(expression) > MOST:
        yield diagnostic("expression_too_deep", span)
        return
    is_truth = _is_boolean(expression, expected=True)
    yield from _check_kinds(expression, span, boolean=is_truth)


def _names(expression: e.Expression) -> Iterator[tuple[str, Span | None]]:
    waiting = [expression]
    while waiting:
        part = waiting.pop()
        if isinstance(part, e.Name | e.Call):
            yield (part.id if isinstance(part, e.Name) else part.name), part.span
        waiting.extend(reversed(e.children(part)))


def check_response_kinds(sentence: Sentence) -> Iterator[Diagnostic]:
    """F112 for each number that is used as a truth value, and the reverse."""
    for expression in conditions(sentence):
        yield from _check_kinds(expression, sentence.span)


def _check_kinds(
    expression: e.Expression, span: Span | None, *, boolean: bool = True
) -> Iterator[Diagnostic]:
    """F112 for each part of the wrong kind; a name can be a number or a truth value."""
    waiting: list[tuple[e.Expression, bool, Span | None]] = [(expression, boolean, span)]
    while waiting:
        part, boolean, near = waiting.pop()
        here = getattr(part, "span", None) or near
        if boolean is not _is_boolean(part, boolean):
            yield _wrong_kind(boolean, here)
            continue  # Errors inside a wrong part would only repeat it.
        waiting.extend((child, kind, here) for child, kind in _expected(part))


def _is_boolean(part: e.Expression, expected: bool) -> bool:
    match part:
        case e.Name("FTP"):
            return True
        case e.Name():
            return expected
        case e.Call(name):
            return expected and name not in _NUMERIC_PREDICATES | _NUMERIC_FUNCTIONS
        case e.Number() | e.Quantity() | e.Word() | e.Negation() | e.Arithmetic():
            return False
        case e.Calculation():
            return False
        case (
            e.Truth()
            | e.Comparison()
            | e.Not()
            | e.And()
            | e.Or()
            | e.Xor()
            | e.Implies()
            | e.Iff()
            | e.Temporal()
            | e.Persistence()
        ):
            return True
        case _:
            assert_never(part)


_ALL_TRUTHS = frozenset({"prevOcc", "nextOcc", "preBool"})


def _expected(part: e.Expression) -> list[tuple[e.Expression, bool]]:
    """The operands, each with whether it must be Boolean."""
    match part:
        case e.Call(name, args):
            return [
                (arg, _takes_truth(name, arg, last=i == len(args) - 1))
                for i, arg in enumerate(args)
            ]
        case e.Comparison() | e.Arithmetic() | e.Negation():
            return [(child, False) for child in e.children(part)]
        case _:
            return [(child, True) for child in e.children(part)]


def _takes_truth(name: str, arg: e.Expression, *, last: bool) -> bool:
    if name in _ALL_TRUTHS or (name in e.COUNTING and last):
        return True
    return name not in _NUMERIC_PREDICATES | _NUMERIC_FUNCTIONS and _is_boolean(arg, expected=True)


def _wrong_kind(boolean: bool, span: Span | None) -> Diagnostic:
    wanted, actual = ("truth value", "number") if boolean else ("number", "truth value")
    fix = _at_least(span) if boolean and span is not None else None
    words = (
        "compare a number: `x > 3`"
        if boolean
        else "join truth values by `<->`, `&`, `|`; only numbers can be compared"
    )
    return diagnostic(
        "wrong_kind",
        span,
        wanted=wanted,
        actual=actual,
        help=f"`=>` is an implication: {fix.help}" if fix is not None else words,
        fix=fix,
    )


def _at_least(number: Span) -> Fix | None:
    """The fix `>=` for a `=>` before a number: `x => 3` is an implication."""
    text = number.source.text[: number.start].rstrip()
    if not text.endswith("=>") or text.endswith("<=>"):
        return None
    return Fix(Span(number.source, len(text) - 2, len(text)), ">=")


LOOK_BACK = frozenset("preBool persisted occurred prevOcc FTP".split())
FORMULA_OPERATORS = frozenset(f"{operator} (formula)" for operator in "XFGURW")
LOOK_AHEAD = frozenset("persists occurs nextOcc".split()) | FORMULA_OPERATORS
NUMBERS_BACK = frozenset({"preInt", "preReal"})


def temporal_predicates(sentence: Sentence) -> Iterator[Diagnostic]:
    """F202 for each temporal predicate, which only one of the two formulas can express."""
    ids: set[str] = set()
    for expression in conditions(sentence):
        for id, span in _names(expression):
            if id in ids or id not in LOOK_BACK | LOOK_AHEAD | NUMBERS_BACK:
                continue
            ids.add(id)
            yield _not_formalized(id, span)


def _not_formalized(id: str, span: Span | None) -> Diagnostic:
    if id in NUMBERS_BACK:
        consequence, fix = (
            "the formulas keep it as a name",
            "a monitor keeps the number of the previous tick; an audit needs a proposition",
        )
    elif id in LOOK_BACK:
        consequence = "the PT formula expresses it, the FT formula keeps it as a proposition"
        fix = "read the PT formula, or check with a monitor"
    else:
        consequence = "the FT formula expresses it, the PT formula keeps it as a proposition"
        fix = "read the FT formula; a monitor cannot look ahead"
    return diagnostic(
        "predicate_not_formalized",
        span,
        id=id,
        direction="ahead" if id in LOOK_AHEAD else "back",
        consequence=consequence,
        help=fix,
    )
