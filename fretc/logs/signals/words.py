"""Signals of words: from the field of a decoded message to the place of its word among `values`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isnan
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.samples import Numbers, Values
from fretc.logs.signals.signals import FieldError, UnstatedError, field_of, fields
from fretish.bindings.declarations import Signal
from fretish.diagnostics.rendering import visible

UNKNOWN = float("nan")
_LONGEST = 40
"""Characters that are shown of a value."""


@dataclass(frozen=True, slots=True)
class UnmappedSamples:
    """Samples of a signal that are none of its values."""

    count: int
    first: int
    """The place of the first one among all samples."""
    text: str
    """What it is, as it can be shown."""

    def followed(self, later: UnmappedSamples) -> UnmappedSamples:
        """These and later ones."""
        return UnmappedSamples(self.count + later.count, self.first, self.text)


def word(signal: Signal, message: object) -> float | str:
    """The place of the signal's word in one message.

    Args:
        signal: with `values`.
        message: a decoded one.

    Returns:
        NaN, unknown, for a field that is left out, an index past the end, and a number that is
        NaN. A text: how to show a value that is none of the words.

    Raises:
        FieldError: the message has no such field, or neither a text nor a number is in it.
    """
    try:
        value = field_of(signal.path, message)
    except UnstatedError:
        return UNKNOWN
    name = ".".join(signal.path.fields)
    if signal.path.index is not None:
        if isinstance(value, str) or not isinstance(value, Sequence | np.ndarray):
            raise FieldError(f"`{name}` is no array", "leave out the index")
        if signal.path.index >= len(value):
            return UNKNOWN
        value = value[signal.path.index]
    return _place(signal, value, name)


def _place(signal: Signal, value: object, name: str) -> float | str:
    if isinstance(value, str):
        known = {} if signal.numbers else _places(signal.values)
        return known[value] if value in known else shown(value)
    if isinstance(value, Real | np.bool_):
        number = float(value)
        if isnan(number):
            return UNKNOWN
        numbers = _places(signal.numbers)
        return numbers[number] if number in numbers else shown(value)
    if value is None:
        return UNKNOWN
    inner = fields(value)
    if inner:
        raise FieldError(f"`{name}` is neither a text nor a number", f"it has {', '.join(inner)}")
    raise FieldError(f"`{name}` is an array", f"write `{name}[0]`")


@lru_cache(256)
def _places(keys: tuple[str, ...] | tuple[int, ...]) -> Mapping[object, float]:
    """Words, or their numbers, with their places."""
    return {key: float(place) for place, key in enumerate(keys)}


def words(signal: Signal, numbers: Values) -> tuple[Numbers, NDArray[np.bool_]]:
    """`word` of many numbers at once: the places, and which of the numbers mean none of the words.

    Args:
        signal: with `numbers`.
        numbers: of the field, shape (n,).
    """
    double = numbers.astype(np.float64)
    known = np.array(signal.numbers, np.float64)
    order = np.argsort(known)
    nearest = order[np.searchsorted(known[order], double).clip(max=len(known) - 1)]
    found = known[nearest] == double
    return np.where(found, nearest, UNKNOWN), ~found & ~np.isnan(double)


def shown(value: object) -> str:
    """A value of a log, short and safe to print."""
    text = (value or "an empty text") if isinstance(value, str) else str(_plain(value))
    cut = f"{text[:_LONGEST]}..." if len(text) > _LONGEST else text
    return visible(cut)


def _plain(value: object) -> object:
    """A number without a point, where it is whole."""
    if isinstance(value, np.generic):
        value = value.item()
    whole = isinstance(value, float | np.longdouble) and value.is_integer()
    return int(value) if whole else value  # type: ignore[call-overload]


def word_at(place: float, values: Sequence[str]) -> str | None:
    """The word at a place; None where that is unknown."""
    return None if isnan(place) else values[int(place)]
