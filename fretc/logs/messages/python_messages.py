"""Samples of signals from messages in Python: mappings or objects."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from dataclasses import replace
from math import isnan
from typing import Any

import numpy as np

from fretc.logs.signals.enum_values import UNKNOWN, enum_index
from fretc.logs.signals.samples import EXACT
from fretc.logs.signals.signals import (
    Sparse,
    UnstatedError,
    fields,
    is_chosen,
    optional_field,
    sample,
)
from fretish.bindings.declarations import Signal

Value = tuple[float, np.dtype[Any] | None, str]
"""The sample, its number type (None: it is unknown), and its text if it is not among the values of
its signal (else empty)."""


class PythonMessage(Sparse):
    """A message in Python: a mapping, or an object with attributes.

    None is unknown; a missing field is an error.
    """

    def __init__(self, message: object) -> None:
        self._message = message

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its fields; in a message of rclpy they differ from its slots."""
        if isinstance(self._message, Mapping):
            return tuple(map(str, self._message))
        declared = getattr(self._message, "get_fields_and_field_types", None)
        return tuple(declared()) if callable(declared) else fields(self._message)

    def constant(self, name: str) -> int | None:
        """A whole constant of the message's type, as in ROS."""
        value = getattr(type(self._message), name, None)
        return value if isinstance(value, int) else None

    def field(self, name: str) -> object:
        """The value of a field; an `array.array` becomes an array of NumPy."""
        if name not in self.names:
            raise KeyError(name)
        mapping = isinstance(self._message, Mapping)
        value = self._message[name] if mapping else getattr(self._message, name)  # type: ignore[index]
        if value is None:
            raise UnstatedError
        if isinstance(value, array):
            return np.asarray(value)
        inner = isinstance(value, Mapping) or fields(value)
        return PythonMessage(value) if inner else value


def sampled(signal: Signal, message: PythonMessage) -> Value:
    """The sample of a message.

    Raises:
        FieldError: the message has no such field.
    """
    single = _is_single(signal, message)
    signal = _named(signal, message)
    value = enum_index(signal, message) if signal.values else sample(signal, message, single=single)
    if isinstance(value, str):
        return UNKNOWN, None, value
    if isinstance(value, int):
        return value, EXACT, ""
    if isnan(value):
        return value, None, ""
    return value, np.dtype(np.float32 if single and is_chosen(signal) else np.float64), ""


def _named(signal: Signal, message: PythonMessage) -> Signal:
    """The signal with the numbers of its values, if the field's message has such constants."""
    if not signal.values or signal.numbers:
        return signal
    holder: object = message
    for name in signal.path.fields[:-1]:
        holder = optional_field(holder, name)
    if not isinstance(holder, PythonMessage) or isinstance(
        optional_field(holder, signal.path.fields[-1]), str
    ):
        return signal
    numbers = tuple(
        number for value in signal.values if (number := holder.constant(value)) is not None
    )
    return replace(signal, numbers=numbers) if len(set(numbers)) == len(signal.values) else signal


def _is_single(signal: Signal, message: PythonMessage) -> bool:
    """Whether the field of the signal holds 32-bit floats."""
    value: object = message
    for name in signal.path.fields:
        value = optional_field(value, name)
    return getattr(value, "dtype", None) == np.float32
