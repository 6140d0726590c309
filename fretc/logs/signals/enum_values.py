"""Enumeration signals: the index of a decoded message's value in `values`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from math import isnan
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from fretc.logs.signals.samples import Numbers, Values
from fretc.logs.signals.signals import FieldError, UnstatedError, field_of, fields, goal_number
from fretish.bindings.declarations import Signal
from fretish.classes.frozen import dataclass
from fretish.diagnostics.rendering import visible

UNKNOWN = float("nan")
_LONGEST = 40
"""The most characters of a value that are shown."""


@dataclass(frozen=True, slots=True)
class UnmappedSamples:
    """Samples of a signal that are not among its values."""

    count: int
    first: int
    """The index of the first one among all samples."""
    text: str
    """The text of the first one, escaped for display."""

    def followed(self, later: UnmappedSamples) -> UnmappedSamples:
        """These samples and later ones."""
        return UnmappedSamples(self.count + later.count, self.first, self.text)


def enum_index(signal: Signal, message: object) -> float | str:
    """The index of the signal's enumeration value in one message.

    Args:
        signal: a signal with `values`.
        message: a decoded message.

    Returns:
        NaN, unknown, for a field that is left out, an index past the end, and a NaN. For a value
        outside the signal's values, its text.

    Raises:
        FieldError: the message has no such field, or the field is neither a text nor a number.
    """
    if signal.goals is not None:
        return goal_number(signal.goals, message)
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
    """The enumeration values, or their numbers, with their indices."""
    return {key: float(index) for index, key in enumerate(keys)}


def enum_indices(signal: Signal, numbers: Values) -> tuple[Numbers, NDArray[np.bool_]]:
    """`enum_index` of many numbers: the indices, and a mask of numbers without a value.

    Args:
        signal: a signal with `numbers`.
        numbers: the values of the field, shape (n,).
    """
    with np.errstate(invalid="ignore"):  # a signaling NaN is a NaN, as for the official decoder
        double = numbers.astype(np.float64)
    enum_numbers = np.array(signal.numbers, np.float64)
    order = np.argsort(enum_numbers)
    nearest = order[np.searchsorted(enum_numbers[order], double).clip(max=len(enum_numbers) - 1)]
    is_value = enum_numbers[nearest] == double
    return np.where(is_value, nearest, UNKNOWN), ~is_value & ~np.isnan(double)


def shown(value: object) -> str:
    """A value of a log, short and safe to print."""
    text = (value or "an empty text") if isinstance(value, str) else str(_plain(value))
    cut = f"{text[:_LONGEST]}..." if len(text) > _LONGEST else text
    return visible(cut)


def _plain(value: object) -> object:
    """A number without a decimal point, if it is whole."""
    if isinstance(value, np.generic):
        value = value.item()
    whole = isinstance(value, float | np.longdouble) and value.is_integer()
    return int(value) if whole else value  # type: ignore[call-overload]


def enum_value(index: float, values: Sequence[str]) -> str | None:
    """The enumeration value at an index; None: unknown."""
    return None if isnan(index) else values[int(index)]
