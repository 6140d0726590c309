"""Resolve the words in an expression: names that are values of an enumerated signal.

`mode = docking` compares a signal with a word, which may be in quotes. An enumerated signal can be
compared only by `=` and `!=`, with one of its words or with a signal of the same values. A plain
number may be used as a truth value, as `docking` or `docking = true`: 1 is true, 0 is false.
"""

from __future__ import annotations

from collections.abc import Mapping

from fretish import expressions as e
from fretish.bindings.declarations import ComputedSignal, MeasuredSignal
from fretish.bindings.expressions import FUNCTIONS
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic, DiagnosticError, did_you_mean
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.recursion import with_recursion_limit

_MOST_LISTED = 12
"""The largest number of words in a message."""


@with_recursion_limit
def resolve_words(
    expression: e.Expression, signals: Mapping[str, MeasuredSignal], span: Span | None = None
) -> e.Expression | Diagnostic:
    """The expression with each word as a `Word`, and without comparisons with `true` or `false`.

    `docking = true` becomes `docking`, and `docking = false` becomes `!docking`.

    Args:
        expression: a Boolean expression of bindings or of a sentence.
        signals: name → signal; other names are not checked.
        span: the span of a diagnostic about a part without a span.

    Returns:
        The expression, or a diagnostic: a word that is not a value of its signal, an order or
        arithmetic of words, or a signal with a unit that is used as a truth value.
    """
    try:
        return _Resolver(signals, span).truth(expression)
    except _WordError as error:
        return error.diagnostic


@with_recursion_limit
def resolve_number(
    expression: e.Expression, signals: Mapping[str, MeasuredSignal], span: Span
) -> e.Expression | Diagnostic:
    """The same of an expression that must be a number; the diagnostic of a word in it."""
    try:
        return _Resolver(signals, span).number(expression)
    except _WordError as error:
        return error.diagnostic


class _WordError(DiagnosticError):
    """Carries a diagnostic out of the recursion."""


@dataclass(frozen=True, slots=True)
class _Resolver:
    signals: Mapping[str, MeasuredSignal]
    place: Span | None

    def truth(self, tree: e.Expression) -> e.Expression:
        """Resolve a part that must be a truth value."""
        match tree:
            case e.Name(id, span):
                if id in self.signals:
                    self._check_truth(self.signals[id], span)
                return tree
            case e.Word(text, span):
                raise _WordError(diagnostic("text_as_truth", span or self.place, text=text))
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
            case e.Temporal(_, args):
                return e.with_children(tree, tuple(map(self.truth, args)))
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

    def _enumerated(self, tree: e.Expression) -> MeasuredSignal | None:
        signal = self.signals.get(tree.id) if isinstance(tree, e.Name) else None
        return signal if signal is not None and signal.values else None

    def _word(self, tree: e.Expression, signal: MeasuredSignal) -> e.Word:
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
        self, first: MeasuredSignal, second: MeasuredSignal, left: e.Expression, right: e.Expression
    ) -> None:
        """Check a comparison of two enumerated signals: equal values, and no ambiguous name."""
        for signal, other, part in ((first, second, right), (second, first, left)):
            if other.name in signal.values:
                raise self._ambiguous_word(other.name, signal, getattr(part, "span", None))
        if first.values != second.values:
            raise _WordError(
                diagnostic(
                    "different_values",
                    getattr(left, "span", None) or self.place,
                    first=first.name,
                    second=second.name,
                )
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
        raise _WordError(
            diagnostic("word_without_values", word.span or self.place, word=word.text, side=side)
        )

    def _check_truth(self, signal: MeasuredSignal, span: Span | None) -> None:
        """F308 if the signal cannot be used as a truth value."""
        name = signal.name
        if isinstance(signal, ComputedSignal):
            raise _WordError(diagnostic("computed_as_truth", span or self.place, name=name))
        if signal.values:
            raise _WordError(
                diagnostic("word_as_truth", span or self.place, name=name, word=signal.values[0])
            )
        if signal.unit_name:
            raise _WordError(
                diagnostic(
                    "quantity_as_truth", span or self.place, name=name, unit=signal.unit_name
                )
            )

    # Mistakes

    def _number_needed(
        self, what: str, signal: MeasuredSignal | None, span: Span | None
    ) -> _WordError:
        name, word = (signal.name, signal.values[0]) if signal else ("mode", "word")
        return _WordError(
            diagnostic("word_as_number", span or self.place, what=what, name=name, word=word)
        )

    def _order_error(
        self, op: str, left: e.Expression, right: e.Expression, span: Span | None
    ) -> _WordError:
        place = span or getattr(left, "span", None) or getattr(right, "span", None)
        return _WordError(diagnostic("words_without_order", place or self.place, operator=op))

    def _kind_error(self, signal: MeasuredSignal, what: str, span: Span | None) -> _WordError:
        return _WordError(
            diagnostic(
                "word_with_other",
                span or self.place,
                signal=signal.name,
                what=what,
                values=listed(signal.values),
            )
        )

    def _ambiguous_word(self, text: str, signal: MeasuredSignal, span: Span | None) -> _WordError:
        return _WordError(
            diagnostic("ambiguous_word", span or self.place, text=text, signal=signal.name)
        )

    def _unknown_word(self, text: str, signal: MeasuredSignal, span: Span | None) -> _WordError:
        guess, values = did_you_mean(text, signal.values, ""), listed(signal.values)
        help_ = f"{guess} its values are {values}".lstrip()
        place = span or self.place
        return _WordError(
            diagnostic("unknown_word", place, text=text, signal=signal.name, help=help_)
        )


def listed(values: tuple[str, ...]) -> str:
    """The first words of a list, for a message."""
    return ", ".join(f"`{word}`" for word in values[:_MOST_LISTED]) + (
        ", ..." if len(values) > _MOST_LISTED else ""
    )
