"""Parse FRETish text into a `Sentence`.

The grammar is `grammar.lark`: one LALR(1) pass with a lexer that reserves every key word. The whole
input is parsed, and every operator is in the tree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any, cast

from fretish import expressions as e
from fretish import syntax as s
from fretish.checking import check_depth, check_names, check_response_kinds, check_value
from fretish.clock import SYMBOL_OF, SYMBOLS, whole_duration
from fretish.diagnostics.diagnostic import Code, Diagnostic, DiagnosticError
from fretish.diagnostics.fixes import FixedText
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.grammars import Grammar
from fretish.reading.lalr import (
    Parser,
    SyntaxTreeNode,
    Token,
    UnexpectedCharacterError,
    UnexpectedTokenError,
    build,
)
from fretish.units import NAMES, number
from fretish.units import split as split_quantity

_UNITS: dict[str, s.TimeUnit] = {
    "TICK": "tick",
    "MICROSECOND": "microsecond",
    "MILLISECOND": "millisecond",
    "SECOND": "second",
    "MINUTE": "minute",
    "HOUR": "hour",
}


def parse_value(text: Span) -> e.Expression | Diagnostic:
    """Parse the whole text as one expression: the value of a variable.

    Args:
        text: the span of the expression; spans of the tree refer to the same source.
    """
    parse_tree = _parse_tree(text, "value")
    if isinstance(parse_tree, Diagnostic):
        return parse_tree
    with _spans_in(text):  # Callbacks of an expression raise no error.
        value = cast(e.Expression, build(parse_tree, _TreeBuilder()))
    return next(check_value(value, text), value)


def parse(text: Span) -> s.Sentence | Diagnostic:
    """Parse the whole text as one sentence.

    Args:
        text: the span of the sentence; spans of the tree refer to the same source.

    Returns:
        The tree, or the diagnostic of the first error.
    """
    tree = _parse_sentence(text)
    if isinstance(tree, Diagnostic):
        return tree
    return next(_check(tree), tree)


def words(text: str) -> tuple[Token, ...]:
    """The words of a sentence, right or wrong; what is no word is left out."""
    return tuple(_parser().known_tokens(text))


def continuations(text: str) -> frozenset[str]:
    """The types of token with which the beginning of a sentence can continue.

    Args:
        text: the beginning, without a word that is not complete. None can follow a mistake.
    """
    return _parser().continuations(text)


MOST_ERRORS = 10
"""The largest number of errors that are reported for one sentence."""
_MOST_CHARACTERS = 10_000
"""Characters; in a longer text only the first error is reported, because each needs a parse."""


def find_errors(text: Span) -> tuple[Diagnostic, ...]:
    """All errors of a sentence, in the order of the text.

    After a syntax error with a safe fix, the fixed text is parsed again to find further errors. If
    a second sentence begins at the error, it is parsed, too. A fix after which parsing stops at the
    same point is not safe.
    """
    diagnostics: list[Diagnostic] = []
    fixed = FixedText(text)
    is_long = len(text.text) > _MOST_CHARACTERS
    while len(diagnostics) < MOST_ERRORS:
        span = fixed.span
        tree = _sentence_tree(span)
        start = _start(_in_original(tree, fixed)) if isinstance(tree, Diagnostic) else None
        if start is not None and diagnostics and start <= _start(diagnostics[-1]):
            diagnostics[-1] = _as_unsafe(diagnostics[-1])
            break
        sentence = tree if isinstance(tree, Diagnostic) else _build(tree, span)
        if isinstance(sentence, Diagnostic):
            errors = _with_neighbours(sentence, span)
            fix = _in_original(errors[-1], fixed).fix
        else:
            errors, fix = [*_check(sentence)], None
        diagnostics.extend(_in_original(error, fixed) for error in errors)
        if is_long or fix is None or not fix.is_safe or fixed.touches(fix.span):
            break
        fixed = fixed.with_fix(fix)
    return tuple(sorted(diagnostics[:MOST_ERRORS], key=_start))


def _parse_sentence(text: Span) -> s.Sentence | Diagnostic:
    """The tree of a text, or its first syntax error."""
    tree = _sentence_tree(text)
    return tree if isinstance(tree, Diagnostic) else _build(tree, text)


def _sentence_tree(text: Span) -> list[SyntaxTreeNode] | Diagnostic:
    """The parse tree of a sentence, or a syntax error."""
    if not text.text.strip():
        return diagnostic("no_sentence", text.part(0, 0))
    return _parse_tree(text, "start")


def _parse_tree(text: Span, start: str) -> list[SyntaxTreeNode] | Diagnostic:
    """The parse tree of a text for one start rule of the grammar, or a syntax error."""
    try:
        return _parser().parse(text.text, start)
    except UnexpectedTokenError as error:
        from fretish.syntax_errors import unexpected_word  # none in most texts

        return unexpected_word(error, text)
    except UnexpectedCharacterError as error:
        from fretish.error_rules.operators import unknown_character

        return unknown_character(text, error.position)


def _build(tree: list[SyntaxTreeNode], text: Span) -> s.Sentence | Diagnostic:
    try:
        with _spans_in(text):
            return cast(s.Sentence, build(tree, _TreeBuilder()))
    except _ParseError as error:
        return error.diagnostic


def _check(sentence: s.Sentence) -> Iterator[Diagnostic]:
    """The errors of a sentence that is syntactically correct."""
    deep = check_depth(sentence)
    if deep is not None:
        yield deep
        return
    yield from check_names(sentence)
    yield from check_response_kinds(sentence)


def _with_neighbours(error: Diagnostic, text: Span) -> list[Diagnostic]:
    """A syntax error; if a second sentence begins there, also the errors of both sentences."""
    if error.code is not Code.SEVERAL_SENTENCES or len(text.text) > _MOST_CHARACTERS:
        return [error]
    first, second = text.part(0, _start(error)), text.part(_start(error), text.end)
    tree = _parse_sentence(first)
    before = () if isinstance(tree, Diagnostic) else _check(tree)
    return [*before, *find_errors(second), error]


def _in_original(error: Diagnostic, fixed: FixedText) -> Diagnostic:
    """A diagnostic of the fixed text, with its spans in the original text."""
    assert error.span is not None
    fix = error.fix and replace(error.fix, span=fixed.place(error.fix.span))
    return replace(error, span=fixed.place(error.span), fix=fix)


def _start(error: Diagnostic) -> int:
    assert error.span is not None
    return error.span.start


def _as_unsafe(error: Diagnostic) -> Diagnostic:
    assert error.fix is not None
    fix = replace(error.fix, is_safe=False)
    return replace(error, fix=fix, help=fix.help if error.help == error.fix.help else error.help)


class _ParseError(DiagnosticError):
    """Carries a diagnostic out of the parser's callbacks."""


_text: ContextVar[Span] = ContextVar("_text")
"""The sentence being parsed: the grammar's callbacks turn token positions into spans of it."""


@contextmanager
def _spans_in(text: Span) -> Iterator[None]:
    token = _text.set(text)
    try:
        yield
    finally:
        _text.reset(token)


def _span(first: Token, last: Token | None = None) -> Span:
    return _text.get().part(first.start_pos, (last or first).end_pos)


@cache
def _parser() -> Parser:
    return GRAMMAR.parser()


_UNIT = "(?:" + "|".join(sorted((n for n in NAMES if n != "1"), key=len, reverse=True)) + ")"
_POWERED = rf"{_UNIT}(?:\^?-?[0-9]{{1,2}})?(?![\w%]|\.\w)"
_QUANTITY = (
    "\nQUANTITY.3: "
    r"/(?:0|[1-9][0-9]{0,59})(?:\.[0-9]{1,60})?(?:[eE][+-]?[0-9]{1,3}(?![0-9.]))?/"
    rf" WHITE_SPACE? /{_POWERED}(?:[*\/]{_POWERED})*/"
)
"""A number and its unit. The lexer has a list of all units, so a name is never read as a unit."""
GRAMMAR = Grammar("fretish", "grammar", ("start", "value"), _QUANTITY)


def _meta_span(meta: SyntaxTreeNode) -> Span:
    return _text.get().part(meta.start_pos, meta.end_pos)


def _trees(children: list[Any]) -> list[Any]:
    """The children that are trees; tokens of key words are dropped."""
    return [child for child in children if not isinstance(child, Token)]


def _scope_builder(kind: s.ScopeKind) -> Callable[..., s.Scope]:
    def build(self: object, meta: SyntaxTreeNode, children: list[Any]) -> s.Scope:
        (mode,) = _trees(children)
        return s.Scope(kind, mode, _meta_span(meta))

    return build


def _timing_builder(kind: Callable[..., s.Timing]) -> Callable[..., _TimingPart]:
    def build(self: object, meta: SyntaxTreeNode, children: list[Any]) -> _TimingPart:
        return _TimingPart((kind(*_trees(children)), _meta_span(meta)))

    return build


class _TimingPart(tuple[s.Timing, Span]):
    """A timing and its span, until the sentence is built."""

    __slots__ = ()


class _ComponentPart(tuple[str, Span, bool]):
    """The component's name, its span, and whether `the` precedes it."""

    __slots__ = ()


class _TreeBuilder:
    """Builds a `Sentence` from a parse tree, a method for each kind of node."""

    # Names and operands

    def identifier(self, meta: SyntaxTreeNode, children: list[Token]) -> e.Name:
        (token,) = children
        text = str(token)
        return e.Name(text[1:-1] if text.startswith('"') else text, _span(token))

    def name(self, meta: SyntaxTreeNode, children: list[e.Name]) -> e.Name:
        return children[0]

    def mode_name(self, meta: SyntaxTreeNode, children: list[Token]) -> e.Name:
        return e.Name(str(children[0]), _span(children[0]))

    def named_mode(self, meta: SyntaxTreeNode, children: list[Any]) -> e.Name:
        return cast(e.Name, _trees(children)[0])

    def number(self, meta: SyntaxTreeNode, children: list[Token]) -> e.Number:
        return e.Number(str(children[0]), _span(children[0]))

    def quantity(self, meta: SyntaxTreeNode, children: list[Token]) -> e.Quantity:
        digits, unit = split_quantity(str(children[0]))
        return e.Quantity(digits, unit, _span(children[0]))

    def truth(self, meta: SyntaxTreeNode, children: list[Token]) -> e.Truth:
        return e.Truth(children[0] == "true")

    def call(self, meta: SyntaxTreeNode, children: list[Any]) -> e.Call:
        name, *args = children
        return e.Call(name.id, tuple(args), _meta_span(meta))

    def duration_argument(self, meta: SyntaxTreeNode, children: list[Token]) -> e.Quantity:
        digits, unit = children
        return e.Quantity(str(digits), SYMBOL_OF[_UNITS[unit.type]], _meta_span(meta))

    def occurrence(self, meta: SyntaxTreeNode, children: list[Any]) -> e.Call:
        past = any(isinstance(c, Token) and c.type == "PREVIOUS" for c in children)
        return e.Call("prevOcc" if past else "nextOcc", tuple(_trees(children)), _meta_span(meta))

    # Operators

    def not_(self, meta: SyntaxTreeNode, children: list[e.Expression]) -> e.Expression:
        return e.Not(children[0])

    def both(self, meta: SyntaxTreeNode, children: list[e.Expression]) -> e.Expression:
        return e.both(*children)

    def either(self, meta: SyntaxTreeNode, children: list[e.Expression]) -> e.Expression:
        return e.either(*children)

    def xor(self, meta: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        return e.Xor(*_trees(children))

    def implies(self, meta: SyntaxTreeNode, children: list[e.Expression]) -> e.Expression:
        return e.Implies(*children)

    def iff(self, meta: SyntaxTreeNode, children: list[e.Expression]) -> e.Expression:
        return e.Iff(*children)

    def if_then(self, meta: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        return e.Implies(*_trees(children))

    def compare(self, meta: SyntaxTreeNode, children: list[Token]) -> str:
        return str(children[0])

    def comparison(self, meta: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        left, op, right = children
        return e.Comparison(op, left, right, _meta_span(meta))

    def arithmetic(self, meta: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        left, op, right = children
        operator = cast(e.ArithmeticOperator, str(op).lower())
        return e.Arithmetic(operator, left, right, _meta_span(meta))

    def negation(self, meta: SyntaxTreeNode, children: list[Any]) -> e.Expression:
        return e.Negation(_trees(children)[0], _meta_span(meta))

    # Parts of the sentence

    scope_in = _scope_builder(s.ScopeKind.IN)
    scope_not_in = _scope_builder(s.ScopeKind.NOT_IN)
    scope_before = _scope_builder(s.ScopeKind.BEFORE)
    scope_after = _scope_builder(s.ScopeKind.AFTER)
    scope_only_in = _scope_builder(s.ScopeKind.ONLY_IN)
    scope_only_before = _scope_builder(s.ScopeKind.ONLY_BEFORE)
    scope_only_after = _scope_builder(s.ScopeKind.ONLY_AFTER)

    immediately = _timing_builder(s.Immediately)
    next = _timing_builder(s.Next)
    finally_ = _timing_builder(s.Finally)
    eventually = _timing_builder(s.Eventually)
    always = _timing_builder(s.Always)
    never = _timing_builder(s.Never)
    within = _timing_builder(s.Within)
    for_ = _timing_builder(s.For)
    after = _timing_builder(s.After)
    until = _timing_builder(s.Until)
    before = _timing_builder(s.Before)

    def item(self, meta: SyntaxTreeNode, children: list[Any]) -> s.Condition:
        word, expression, *truth = children[0], children[1], *children[2:]
        negated = (word.type == "UNLESS") != any(token.lower() == "false" for token in truth)
        kind = s.ConditionKind.HOLDING if word.type == "WHENEVER" else s.ConditionKind.TRIGGER
        return s.Condition(
            kind, e.Not(expression) if negated else expression, word.lower(), _meta_span(meta)
        )

    def joined(self, meta: SyntaxTreeNode, children: list[Any]) -> tuple[bool, s.Condition]:
        return (children[0] != children[-1] and children[0].type == "OR", children[-1])

    def condition(self, meta: SyntaxTreeNode, children: list[Any]) -> s.Condition:
        """Join condition items: `and` and `or` are left-associative with equal precedence.

        One item that is a trigger makes the whole condition a trigger.
        """
        first, *rest = _trees(children)
        expression, kind, word = first.expression, first.kind, first.word
        for disjoined, item in rest:
            join = e.either if disjoined else e.both
            expression = join(expression, item.expression)
            if kind is s.ConditionKind.HOLDING:
                kind, word = item.kind, item.word
        return s.Condition(kind, expression, word, _meta_span(meta))

    def component(self, meta: SyntaxTreeNode, children: list[Any]) -> _ComponentPart:
        (name,) = _trees(children)
        article = any(isinstance(c, Token) and c.type == "THE" for c in children)
        return _ComponentPart((name.id, name.span, article))

    def probability(self, meta: SyntaxTreeNode, children: list[Any]) -> s.Probability:
        _, _, op, *digits = children
        text = "".join(digits)
        bound = _number(text)
        impossible = bound == 0 if op == "<" else op == ">" and bound == 1
        if bound is None or impossible or not 0 <= bound <= 1:
            from fretish.syntax_errors import bad_probability

            raise _ParseError(bad_probability(_meta_span(meta)))
        return s.Probability(op, bound, text)

    def duration(self, meta: SyntaxTreeNode, children: list[Token]) -> s.Duration:
        *sign, last = children
        if last.type == "QUANTITY":
            digits, symbol = split_quantity(last)
            end = len(last)
            if symbol not in SYMBOLS:
                from fretish.syntax_errors import bad_unit

                raise _ParseError(bad_unit(_span(last).part(end - len(symbol), end)))
            unit = SYMBOLS[symbol]
        else:
            digits, unit = sign.pop(), _UNITS[last.type]
        is_plain = not sign and "e" not in digits.lower()  # FRET reads 2e1 as 2
        length = _number(digits) if is_plain else None
        whole = None if length is None else whole_duration(length, unit, _meta_span(meta))
        if whole is None or whole.amount >= 10**15:
            from fretish.syntax_errors import bad_duration

            raise _ParseError(bad_duration(digits, _meta_span(meta)))
        return whole

    def value(self, meta: SyntaxTreeNode, children: list[e.Expression]) -> e.Expression:
        return children[0]

    def start(self, meta: SyntaxTreeNode, children: list[Any]) -> s.Sentence:
        *parts, response = _trees(children)
        by_type = {type(part): part for part in parts}
        timing, timing_span = by_type.get(_TimingPart, (s.Eventually(explicit=False), None))
        component, component_span, article = by_type[_ComponentPart]
        return s.Sentence(
            scope=by_type.get(s.Scope),
            condition=by_type.get(s.Condition),
            component=component,
            probability=by_type.get(s.Probability),
            timing=timing,
            response=response,
            span=_meta_span(meta),
            component_span=component_span,
            timing_span=timing_span,
            article=article,
        )


def _number(digits: str) -> Fraction | None:
    """The exact number; None if it has too many digits."""
    try:
        return number(digits)
    except ValueError:
        return None
