"""Resolve the words in an expression: names that are values of an enumerated signal.

`mode = docking` compares a signal with a word, which may be in quotes. An enumerated signal can be
compared only by `=` and `!=`, with one of its words or with a signal of the same values. A plain
number may be used as a truth value, as `docking` or `docking = true`: 1 is true, 0 is false.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fretish import expressions as e
from fretish.bindings.declarations import Signal
from fretish.bindings.expressions import FUNCTIONS
from fretish.diagnostics.diagnostic import Code, Diagnostic, DiagnosticError, suggestion
from fretish.diagnostics.source import Span
from fretish.reading.recursion import with_recursion_limit

_MOST_LISTED = 12
"""The largest number of words in a message."""


@with_recursion_limit
def resolve_words(
    expression: e.Expression, signals: Mapping[str, Signal], place: Span | None = None
) -> e.Expression | Diagnostic:
    """The expression with each word as a `Word`, and without comparisons with `true` or `false`.

    `docking = true` becomes `docking`, and `docking = false` becomes `!docking`.

    Args:
        expression: a Boolean expression of bindings or of a sentence.
        signals: name → signal; other names are not checked.
        place: the span of a diagnostic about a part without a span.

    Returns:
        The expression, or a diagnostic: a word that is not a value of its signal, an order or
        arithmetic of words, or a signal with a unit that is used as a truth value.
    """
    try:
        return _Resolver(signals, place).truth(expression)
    except _WordError as error:
        return error.diagnostic


class _WordError(DiagnosticError):
    """Carries a diagnostic out of the recursion."""


@dataclass(frozen=True, slots=True)
class _Resolver:
    signals: Mapping[str, Signal]
    place: Span | None

    def truth(self, tree: e.Expression) -> e.Expression:
        """Resolve a part that must be a truth value."""
        match tree:
            case e.Name(id, span):
                if id in self.signals:
                    self._check_truth(self.signals[id], span)
                return tree
            case e.Word(text, span):
                raise self._error(
                    Code.BAD_EXPRESSION,
                    f'`"{text}"` is a word, and a truth value is needed',
                    span,
                    f'compare a signal with it: `mode = "{text}"`',
                )
            case e.Comparison():
                return self._comparison(tree)
            case e.Not(arg):
                return e.Not(self.truth(arg))
            case e.Persistence(arg, duration):
                return e.Persistence(self.truth(arg), duration)
            case e.And(args):
                return e.And(tuple(map(self.truth, args)))
            case e.Or(args):
                return e.Or(tuple(map(self.truth, args)))
            case e.Xor(left, right):
                return e.Xor(self.truth(left), self.truth(right))
            case e.Implies(left, right):
                return e.Implies(self.truth(left), self.truth(right))
            case e.Iff(left, right):
                return e.Iff(self.truth(left), self.truth(right))
            case e.Call(name, args, span) if name not in FUNCTIONS:
                return e.Call(name, tuple(map(self._argument, args)), span)
            case _:
                return self.number(tree)

    def number(self, tree: e.Expression) -> e.Expression:
        """Resolve a part that must be a number."""
        match tree:
            case e.Name(id, span):
                signal = self.signals.get(id)
                if signal is not None and signal.values:
                    raise self._number_needed(f"`{id}`", signal, span)
                return tree
            case e.Word(text, span):
                raise self._number_needed(f'`"{text}"`', None, span)
            case e.Negation(arg, span):
                return e.Negation(self.number(arg), span)
            case e.Arithmetic(op, left, right, span):
                return e.Arithmetic(op, self.number(left), self.number(right), span)
            case e.Call(name, args, span):
                part = self.number if name in FUNCTIONS else self._argument
                return e.Call(name, tuple(map(part, args)), span)
            case e.Truth() | e.Number() | e.Quantity():
                return tree
            case _:
                return self.truth(tree)

    def _argument(self, tree: e.Expression) -> e.Expression:
        """An argument of a temporal predicate: a number or a truth value."""
        if isinstance(tree, e.Name):
            signal = self.signals.get(tree.id)
            return self.number(tree) if signal is not None and signal.values else tree
        return self.truth(tree)

    # Comparisons

    def _comparison(self, tree: e.Comparison) -> e.Expression:
        left, right = tree.left, tree.right
        for truth, other in ((right, left), (left, right)):
            if isinstance(truth, e.Truth) and tree.op in ("=", "!="):
                part = self.truth(other)
                return part if truth.value is (tree.op == "=") else e.Not(part)
        first, second = self._enumerated(left), self._enumerated(right)
        if first is None and second is None:
            if isinstance(left, e.Word) or isinstance(right, e.Word):
                self._check_word(left, right)
                return tree
            return e.Comparison(tree.op, self.number(left), self.number(right), tree.span)
        if tree.op not in ("=", "!="):
            raise self._order_error(tree.op, left, right, tree.span)
        if first is not None and second is not None:
            self._check_enumerated(first, second, left, right)
            return tree
        if first is not None:
            return e.Comparison(tree.op, left, self._word(right, first), tree.span)
        assert second is not None
        return e.Comparison(tree.op, self._word(left, second), right, tree.span)

    def _enumerated(self, tree: e.Expression) -> Signal | None:
        signal = self.signals.get(tree.id) if isinstance(tree, e.Name) else None
        return signal if signal is not None and signal.values else None

    def _word(self, tree: e.Expression, signal: Signal) -> e.Word:
        """The other side of a comparison with an enumerated signal, as one of its words."""
        match tree:
            case e.Word(text, span):
                pass
            case e.Name(text, span) if text in self.signals:
                if text in signal.values:
                    raise self._ambiguous_word(text, signal, span)
                raise self._kind_error(signal, f"`{text}` is a number", span)
            case e.Name(text, span):
                pass
            case _:
                span = getattr(tree, "span", None)
                raise self._kind_error(signal, "this is a number", span)
        if text not in signal.values:
            raise self._unknown_word(text, signal, span)
        return e.Word(text, span)

    def _check_enumerated(
        self, first: Signal, second: Signal, left: e.Expression, right: e.Expression
    ) -> None:
        """Check a comparison of two enumerated signals: equal values, and no ambiguous name."""
        for signal, other, part in ((first, second, right), (second, first, left)):
            if other.name in signal.values:
                raise self._ambiguous_word(other.name, signal, getattr(part, "span", None))
        if first.values != second.values:
            raise self._error(
                Code.BAD_EXPRESSION,
                f"`{first.name}` and `{second.name}` have different values: they cannot be "
                "compared",
                getattr(left, "span", None),
                "give both the same list of `values`, in one order",
            )

    def _check_word(self, left: e.Expression, right: e.Expression) -> None:
        """Check a word that is compared with something other than an enumerated signal.

        Unknown names are ignored.
        """
        word, other = (left, right) if isinstance(left, e.Word) else (right, left)
        assert isinstance(word, e.Word)
        if isinstance(other, e.Name) and other.id not in self.signals:
            return
        side = f"`{other.id}`" if isinstance(other, e.Name) else "the other side"
        raise self._error(
            Code.BAD_EXPRESSION,
            f'`"{word.text}"` is a word, and {side} has no `values`',
            word.span,
            f'declare the words of the signal: `values = ["{word.text}"]`',
        )

    def _check_truth(self, signal: Signal, span: Span | None) -> None:
        """F308 if the signal cannot be used as a truth value."""
        name = signal.name
        if signal.values:
            raise self._error(
                Code.BAD_EXPRESSION,
                f"`{name}` is a word, and a truth value is needed",
                span,
                f'compare it: `{name} = "{signal.values[0]}"`',
            )
        if signal.unit_name:
            raise self._error(
                Code.BAD_EXPRESSION,
                f"`{name}` is in {signal.unit_name}, and a truth value is needed",
                span,
                f"compare it: `{name} > 0 {signal.unit_name}`; only a plain number may be a truth "
                "value, 1 or 0",
            )

    # Mistakes

    def _error(self, code: Code, message: str, span: Span | None, fix: str) -> _WordError:
        return _WordError(Diagnostic(code, message, span or self.place, help=fix))

    def _number_needed(self, what: str, signal: Signal | None, span: Span | None) -> _WordError:
        name, word = (signal.name, signal.values[0]) if signal else ("mode", "word")
        return self._error(
            Code.BAD_EXPRESSION,
            f"{what} is a word, and a number is needed",
            span,
            f'a word can be compared only by `=` and `!=`: `{name} = "{word}"`',
        )

    def _order_error(
        self, op: str, left: e.Expression, right: e.Expression, span: Span | None
    ) -> _WordError:
        place = span or getattr(left, "span", None) or getattr(right, "span", None)
        return self._error(
            Code.BAD_EXPRESSION,
            f"words have no order: `{op}` cannot compare them",
            place,
            "write `=` or `!=`, and join several by `or`",
        )

    def _kind_error(self, signal: Signal, what: str, span: Span | None) -> _WordError:
        return self._error(
            Code.BAD_EXPRESSION,
            f"`{signal.name}` is a word, and {what}: they cannot be compared",
            span,
            f"its values are {listed(signal.values)}",
        )

    def _ambiguous_word(self, text: str, signal: Signal, span: Span | None) -> _WordError:
        return self._error(
            Code.AMBIGUOUS_WORD,
            f"`{text}` is ambiguous: a signal, or a value of `{signal.name}`",
            span,
            f"rename the signal; in `expr`, write the value in quotes: `'{text}'`",
        )

    def _unknown_word(self, text: str, signal: Signal, span: Span | None) -> _WordError:
        near = suggestion(text, signal.values)
        return self._error(
            Code.UNKNOWN_WORD,
            f"`{text}` is not a value of `{signal.name}`",
            span,
            f"{f'did you mean `{near}`? ' if near else ''}its values are {listed(signal.values)}",
        )


def listed(values: tuple[str, ...]) -> str:
    """The first words of a list, for a message."""
    return ", ".join(f"`{word}`" for word in values[:_MOST_LISTED]) + (
        ", ..." if len(values) > _MOST_LISTED else ""
    )
