"""Parse the expressions of bindings, and compute their dimensions.

They are a small language, not Python: signals, numbers with units, words in quotes,
comparisons, `and`/`or`/`not`, `abs`, `min`, `max`, `pre` and `... for 200 ms`. The values of
computed signals also call the functions of `fretish.bindings.functions`.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction
from functools import cache
from typing import Any, cast

from fretish import expressions as e
from fretish.bindings.functions import MEMORY, OF_VALUES, Function
from fretish.diagnostics.diagnostic import Code, Diagnostic, DiagnosticError, did_you_mean
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.caching import cache_by_identity
from fretish.reading.grammars import Grammar
from fretish.reading.lalr import (
    Parser,
    SyntaxTreeNode,
    Token,
    UnexpectedCharacterError,
    UnexpectedTokenError,
    build,
)
from fretish.units import (
    DIMENSIONLESS,
    Dimension,
    base_name,
    nanoseconds,
    unit,
    unknown_unit,
)

FUNCTIONS = ("abs", "min", "max", "pre")
Kind = Dimension | None
"""The dimension of a number; None for a truth value."""


def parse(text: Span) -> e.Expression | Diagnostic:
    """Parse the whole text as one expression; spans of the tree refer to the text's source."""
    try:
        return cast(e.Expression, build(_parser().parse(text.text), _ExpressionBuilder(text)))
    except UnexpectedTokenError as error:
        return _unexpected(text.part(error.token.start_pos, error.token.end_pos), text)
    except UnexpectedCharacterError as error:
        return _unexpected(text.part(error.position, error.position + 1), text)
    except _ExpressionError as error:
        return error.diagnostic


class _ExpressionError(DiagnosticError):
    """Carries a diagnostic out of the callbacks of the parser."""


def words(text: str) -> tuple[Token, ...]:
    """The words of an expression, right or wrong; what is no word is left out."""
    return tuple(_parser().known_tokens(text))


@cache
def _parser() -> Parser:
    return GRAMMAR.parser()


GRAMMAR = Grammar("fretish.bindings", "expressions")


def _parts(children: list[Any]) -> list[Any]:
    return [child for child in children if not isinstance(child, Token)]


class _ExpressionBuilder:
    def __init__(self, text: Span) -> None:
        self._text = text

    def _span(self, token: Token) -> Span:
        return self._text.part(token.start_pos, token.end_pos)

    def start(self, _node: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        return cast(e.Expression, children[0])

    def persistence(self, _node: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        arg, token = children[0], children[-1]
        duration = nanoseconds(str(token))
        if duration is None:
            text = str(token)
            before = len(text) - len(text.lstrip())
            span = self._span(token).part(before, len(text))
            raise _ExpressionError(diagnostic("not_a_duration", span, text=text.strip()))
        return e.Persistence(arg, duration)

    def either(self, _node: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        return e.either(*_parts(children))

    def both(self, _node: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        return e.both(*_parts(children))

    def not_(self, _node: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        return e.Not(*_parts(children))

    def compare(self, _node: SyntaxTreeNode, children: list[Token]) -> str:
        return "=" if children[0] == "==" else str(children[0])

    def comparison(self, _node: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        left, op, right = children
        return e.Comparison(op, left, right)

    def arithmetic(self, _node: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        left, op, right = children
        return e.Arithmetic(cast(e.ArithmeticOperator, str(op)), left, right)

    def power(self, _node: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        base, _, exponent = children
        span = self._span(exponent)
        digits = exponent.strip()
        span = span.part(len(exponent) - len(digits), len(exponent))
        return e.Arithmetic("^", base, e.Number(digits, span))

    def negation(self, _node: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        return e.Negation(*_parts(children))

    def quantity(self, _node: SyntaxTreeNode, children: list[Token]) -> e.Expression:
        text = str(children[0])
        split = next(i for i, c in enumerate(text) if _begins_unit(text, i, c))
        name = text[split:].strip()
        if unit(name) is None:
            raise _ExpressionError(unknown_unit(name, self._span(children[0])))
        return e.Quantity(text[:split].strip(), name, self._span(children[0]))

    def number(self, _node: SyntaxTreeNode, children: list[Token]) -> e.Expression:
        return e.Number(str(children[0]), self._span(children[0]))

    def truth(self, _node: SyntaxTreeNode, children: list[Token]) -> e.Expression:
        return e.Truth(children[0] == "true")

    def word(self, _node: SyntaxTreeNode, children: list[Token]) -> e.Expression:
        return e.Word(str(children[0])[1:-1], self._span(children[0]))

    def name(self, _node: SyntaxTreeNode, children: list[Token]) -> e.Expression:
        return e.Name(str(children[0]), self._span(children[0]))

    def call(self, _node: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        name, *args = children
        return e.Call(str(name), tuple(args), self._span(name))


def _begins_unit(text: str, i: int, c: str) -> bool:
    """Whether the unit of a quantity begins at index `i`; the `e` of `1e3` is not a unit."""
    exponent = c in "eE" and text[i + 1 : i + 2].lstrip("+-")[:1].isdigit()
    signed = c in "eE" and text[i + 1 : i + 2] in ("+", "-") and text[i + 2 : i + 3].isdigit()
    return (c.isalpha() or c == "%") and not exponent and not signed


def dimension(
    expression: e.Expression, kinds: Mapping[str, Kind], place: Span
) -> Kind | Diagnostic:
    """The dimension of the expression; None for a truth value; F305-F309 if it has errors.

    A word counts as a plain number, the index of its value. `resolve_words` checks where a word is
    allowed.

    Args:
        expression: the expression.
        kinds: name → its dimension, or None for a truth value.
        place: the span of a diagnostic about a part without a span.
    """
    match expression:
        case e.Truth():
            return None
        case e.Name(id, span):
            return kinds[id] if id in kinds else _unknown_name(id, kinds, span or place)
        case e.Number() | e.Word():
            return DIMENSIONLESS
        case e.Quantity(_, name, span):
            measure = unit(name)
            assert measure is not None
            parts = [part for part in re.split("[*/]", name)[1:] if part in kinds]
            also = [
                part for part in parts if (factor := unit(part)) and factor.dimension == kinds[part]
            ]
            return _ambiguous(name, also[0], span or place) if also else measure.dimension
        case e.Negation(arg):
            return _numbers([arg], kinds, place)
        case e.Arithmetic(op, left, right):
            return _arithmetic(op, left, right, kinds, place)
        case e.Comparison(_, left, right):
            both = _numbers([left, right], kinds, place)
            return both if isinstance(both, Diagnostic) else None
        case e.Calculation(_, value):
            return dimension(value, kinds, place)
        case e.Call(name, args, span) if name in OF_VALUES:
            return _of_function(OF_VALUES[name], expression, kinds, place)
        case e.Call(name, args, span):
            if name not in FUNCTIONS:
                return _unknown_function(name, span or place)
            if name == "abs" and len(args) != 1:
                return _kind_error("`abs` takes one number", expression, span or place)
            if name == "pre" and len(args) != 2:
                why = "`pre` takes the value at the first tick, and a number: `pre(0 m/s, speed)`"
                return _kind_error(why, expression, span or place)
            if ticks_back(expression) > MOST_TICKS_BACK:
                why = f"`pre` looks back by more than {MOST_TICKS_BACK} ticks"
                return _kind_error(why, expression, span or place)
            return _numbers(list(args), kinds, span or place)
        case _:
            return _truths(e.children(expression), kinds, place)


def _truths(
    args: tuple[e.Expression, ...], kinds: Mapping[str, Kind], span: Span
) -> Diagnostic | None:
    for arg in args:
        kind = dimension(arg, kinds, span)
        if isinstance(kind, Diagnostic):
            return kind
        if isinstance(arg, e.Name) and kind == DIMENSIONLESS:
            continue  # 1 is true, and 0 is false
        if kind is not None:
            return _kind_error("a truth value is needed, and this is a number", arg, span)
    return None


def _numbers(
    args: list[e.Expression], kinds: Mapping[str, Kind], span: Span
) -> Dimension | Diagnostic:
    """The common dimension of the operands."""
    common: Dimension | None = None
    for arg in args:
        kind = dimension(arg, kinds, span)
        if isinstance(kind, Diagnostic):
            return kind
        if kind is None:
            return _kind_error("a number is needed, and this is a truth value", arg, span)
        if common is not None and kind != common:
            return _mismatch(
                f"{in_words(common)} cannot be compared with or added to {in_words(kind)}",
                arg,
                span,
            )
        common = kind
    return common or DIMENSIONLESS


def _of_function(
    function: Function, call: e.Call, kinds: Mapping[str, Kind], place: Span
) -> Kind | Diagnostic:
    """The dimension of the result of a function, whose arguments have the right ones."""
    least, most = function.least, function.most
    if len(call.args) < least or (most is not None and len(call.args) > most):
        form, span = function.form, call.span or place
        return diagnostic(
            "number_of_arguments", span, name=call.name, takes=function.takes, form=form
        )
    common = _numbers(list(call.args), kinds, place)
    if isinstance(common, Diagnostic):
        return common
    if function.argument is not None and common != function.argument:
        return diagnostic(
            "argument_of_other_unit",
            _span_of(call.args[0]) or call.span or place,
            name=call.name,
            takes=in_words(function.argument),
            what=in_words(common),
        )
    if call.name != "sqrt":
        return common if function.result is None else function.result
    if any(power % 2 for power in common):
        span = _span_of(call.args[0]) or call.span or place
        return diagnostic("root_of_odd_unit", span, what=in_words(common))
    return tuple(power // 2 for power in common)


def _span_of(expression: e.Expression) -> Span | None:
    """The span from the first to the last part that has one; None if no part has one."""
    spans: list[Span] = [
        span for part in e.parts(expression) if (span := getattr(part, "span", None))
    ]
    if not spans:
        return None
    return min(spans, key=lambda span: span.start).to(max(spans, key=lambda span: span.end))


def _arithmetic(
    op: str, left: e.Expression, right: e.Expression, kinds: Mapping[str, Kind], span: Span
) -> Kind | Diagnostic:
    if op in ("+", "-", "mod"):
        return _numbers([left, right], kinds, span)
    if op == "^":
        return _power(left, right, kinds, span)
    first, second = _numbers([left], kinds, span), _numbers([right], kinds, span)
    if isinstance(first, Diagnostic):
        return first
    if isinstance(second, Diagnostic):
        return second
    sign = 1 if op == "*" else -1
    return tuple(a + sign * b for a, b in zip(first, second, strict=True))


def _power(
    base: e.Expression, exponent: e.Expression, kinds: Mapping[str, Kind], place: Span
) -> Kind | Diagnostic:
    dimension = _numbers([base], kinds, place)
    if isinstance(dimension, Diagnostic):
        return dimension
    exact = Fraction(exponent.digits) if isinstance(exponent, e.Number) else Fraction(0)
    times = int(exact)
    if times != exact or not 1 <= times <= e.MOST_EXPONENT:
        span = getattr(exponent, "span", None) or place
        return diagnostic("bad_exponent", span, most=e.MOST_EXPONENT)
    if not is_base(base):
        return diagnostic("power_too_large", getattr(base, "span", None) or place)
    return tuple(times * power for power in dimension)


def is_base(base: e.Expression) -> bool:
    """Whether the expression may be the base of a power: a number, or a signal term without `^`."""
    if not any(e.names(base)):
        return isinstance(base, e.Number | e.Quantity)
    return not any(isinstance(part, e.Arithmetic) and part.op == "^" for part in e.parts(base))


def in_words(dimension: Dimension) -> str:
    """`a quantity in m`, or `a number without a unit`."""
    name = base_name(dimension)
    return f"a quantity in {name}" if name else "a number without a unit"


def _mismatch(message: str, part: e.Expression, span: Span) -> Diagnostic:
    return Diagnostic(
        Code.UNIT_MISMATCH,
        message,
        getattr(part, "span", None) or _span_of(part) or span,
        help="give each number its unit: `min_range < 5 cm`",
    )


def _kind_error(message: str, part: e.Expression, span: Span) -> Diagnostic:
    return Diagnostic(
        Code.BAD_EXPRESSION,
        message,
        getattr(part, "span", None) or _span_of(part) or span,
        help="compare numbers, `x < 5 m`, and join truth values by `and`, `or`, `not`",
    )


MOST_TICKS_BACK = 16
"""The largest nesting depth of `pre`."""


_PRE = frozenset({"pre", "preReal", "preInt"})


@cache_by_identity
def looks_back(part: e.Expression) -> bool:
    """Whether the part is a call of `pre`, `preReal` or `preInt`."""
    return isinstance(part, e.Call) and part.name in _PRE


@cache_by_identity
def ticks_back(expression: e.Expression) -> int:
    """How many ticks its value looks back: the nesting depth of `pre`.

    In a sentence `pre` is called `preReal` or `preInt`.
    """
    deepest = 0
    waiting = [(expression, 0)]
    while waiting:
        part, back = waiting.pop()
        back += looks_back(part)
        deepest = max(deepest, back)
        waiting.extend((child, back) for child in e.children(part))
    return deepest


def is_truth(expression: e.Expression) -> bool:
    """Whether the outermost operator gives a truth value; False for names and calls."""
    numbers = (e.Number, e.Quantity, e.Word, e.Negation, e.Arithmetic, e.Call, e.Name)
    return not isinstance(expression, numbers)


def plain_percents(
    expression: e.Expression, percents: Collection[str], span: Span
) -> Iterator[Diagnostic]:
    """F338 for each comparison of a signal in percent with a plain number above 1.

    Args:
        expression: an expression with consistent dimensions.
        percents: the names of the signals in percent.
        span: the span of a diagnostic about a number without a span.
    """
    for part in e.children(expression):
        yield from plain_percents(part, percents, span)
    if not isinstance(expression, e.Comparison):
        return
    for side, other in ((expression.left, expression.right), (expression.right, expression.left)):
        measured = {name.id for name in e.names(side)}
        limit = other.arg if isinstance(other, e.Negation) else other
        if not measured or not measured <= {*percents} or not isinstance(limit, e.Number):
            continue
        if Fraction(limit.digits) > 1:
            yield diagnostic(
                "plain_percent",
                limit.span or span,
                signals=", ".join(sorted(measured)),
                digits=limit.digits,
            )


def _unknown_name(id: str, kinds: Mapping[str, Kind], span: Span) -> Diagnostic:
    declared = ", ".join(sorted(kinds)) or "nothing"
    return diagnostic(
        "undeclared_name",
        span,
        id=id,
        help=did_you_mean(id, kinds, f"declared here: {declared}"),
    )


def _ambiguous(name: str, part: str, span: Span) -> Diagnostic:
    return diagnostic("ambiguous_unit", span, part=part, name=name)


def _unknown_function(name: str, span: Span) -> Diagnostic:
    known = dict.fromkeys((*FUNCTIONS, *OF_VALUES, *MEMORY))
    return diagnostic("unknown_function", span, name=name, functions=", ".join(known))


def _unexpected(part: Span, text: Span) -> Diagnostic:
    """The diagnostic of an expression in which this part is unexpected."""
    if text.text.startswith("TODO"):
        return diagnostic("empty_expression", text)
    if not part.text:
        return diagnostic("expression_ends", part)
    return diagnostic("misplaced_in_expression", part, text=part.text)
