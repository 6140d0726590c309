"""The field `values` of a signal: words, and optionally their numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fretish.bindings.tables.fields import Fields
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.toml_text import as_key

_MOST_WORDS, _LONGEST_WORD = 1000, 100
_EXACT = 2**53
"""Numbers below this limit are exact in every numeric type."""


class ValuesField(Fields):
    """Reader of the field `values`."""

    def words(
        self, written: object, at: tuple[str, ...]
    ) -> tuple[tuple[str, ...], tuple[int, ...]]:
        """The words and their numbers; both empty if the field has an error."""
        before = len(self.notes.diagnostics)
        if isinstance(written, dict):
            values, numbers = [*written], [*written.values()]
            self._check_numbers(written, at)
        else:
            values, numbers = written if isinstance(written, list) else [], []
        if not values:
            self._say(diagnostic("bad_values", self.tables.value(*at)))
        if len(values) > _MOST_WORDS:
            self._say(
                diagnostic(
                    "too_many_values",
                    self.tables.value(*at),
                    count=len(values),
                    most=_MOST_WORDS,
                )
            )
        for index, word in enumerate(values[:_MOST_WORDS]):
            self._check_word(word, values[:index], at)
        if len(self.notes.diagnostics) > before:
            return (), ()
        return tuple(values), tuple(numbers)

    def _check_word(self, word: object, before: list[Any], at: tuple[str, ...]) -> None:
        if (
            not isinstance(word, str)
            or not word.isprintable()
            or '"' in word
            or not 0 < len(word) <= _LONGEST_WORD
        ):
            span = self._last_in(at, word)
            self._say(diagnostic("bad_word", span, longest=_LONGEST_WORD))
        elif word in before:
            self._say(diagnostic("word_twice", self._last_in(at, word), word=word))

    def _check_numbers(self, written: Mapping[str, Any], at: tuple[str, ...]) -> None:
        words: dict[int, str] = {}
        for word, number in written.items():
            span = self.tables.value(*at, word)
            if not isinstance(number, int) or isinstance(number, bool) or abs(number) >= _EXACT:
                self._say(diagnostic("bad_number_of_word", span, word=word, key=as_key(word)))
            elif number in words:
                self._say(
                    diagnostic(
                        "same_number_of_words", span, other=words[number], word=word, number=number
                    )
                )
            else:
                words[number] = word

    def _last_in(self, at: tuple[str, ...], word: object) -> Span:
        """The span of the last occurrence of a word in the field; else of the whole value."""
        value = self.tables.value(*at)
        start = value.text.rfind(word) if isinstance(word, str) and word else -1
        return value.part(start, start + len(str(word))) if start >= 0 else value
