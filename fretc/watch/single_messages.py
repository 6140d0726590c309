"""The bound fields of one message, read at the positions that earlier messages of its channel had.

`fretc.logs.extraction` reads many messages at once, and decides which positions are certain. What
is not usual is left to it: a message of another layout, a text beyond ASCII, infinities, numbers
that no 64-bit float holds.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from math import isfinite, isnan
from typing import Any

import numpy as np

from fretc.logs.extraction import Extraction
from fretc.logs.messages.layouts import Layout, Location, Where
from fretc.logs.messages.python_messages import Value
from fretc.logs.messages.vectorized import samples, siblings
from fretc.logs.signals.enum_values import UNKNOWN
from fretc.logs.signals.samples import WHOLE, widest
from fretc.watch.single_scans import ScanReader, scan_reader
from fretish.bindings.declarations import Signal
from fretish.classes.frozen import dataclass

_NOTHING: Value = (UNKNOWN, None, "")
_SINGLE, _DOUBLE = np.dtype(np.float32), np.dtype(np.float64)


@dataclass(frozen=True, slots=True)
class SingleMessage:
    """The contents of one decoded message."""

    stamp: int | None
    """The time of `header.stamp`; None: the message has none."""
    values: Mapping[str, Value]


Numbers = Sequence[Any]
"""The single numbers of a message, in the order of their positions."""


class SingleMessages:
    """The reader of the messages of one channel, one by one."""

    def __init__(self, extraction: Extraction) -> None:
        """`extraction`: that of the channel, which reads the first message of each layout."""
        self._extraction = extraction
        self._signals = 0
        self._plans: dict[int, list[_Plan | None]] = {}
        """For each size the layouts of messages; None: its values are left to the extraction."""

    def read(self, payload: bytes) -> SingleMessage | None:
        """The contents of a message; None: it is left to the extraction."""
        if len(self._extraction.signals) != self._signals:
            self._signals = len(self._extraction.signals)
            self._plans.clear()
        layouts = self._extraction.known_layouts(len(payload))
        plans = self._plans.setdefault(len(payload), [])
        plans += [_plan(self._extraction, layout) for layout in layouts[len(plans) :]]
        for plan in plans[: len(layouts)]:
            if plan is not None and plan.fits(payload):
                return plan.read(payload)
        return None


class _Plan:
    """Where the numbers of messages of one layout are, and what becomes of them."""

    def __init__(self, extraction: Extraction, layout: Layout) -> None:
        self._marks = tuple(
            (at, at + np.dtype(kind).itemsize, np.array([value], kind).tobytes())
            for at, kind, value in layout.marks
        )
        self._texts = tuple((at, at + length) for at, length in layout.texts)
        single = {where: at for where, at in layout.locations.items() if at.count is None}
        order = sorted(single, key=lambda where: single[where].at)
        self._numbers = _structure([single[where] for where in order])
        place = {where: index for index, where in enumerate(order)}
        stamp = extraction.stamp_places
        self._stamp = (place[stamp[0]], place[stamp[1]]) if stamp else None
        self._readers = tuple(
            (signal.name, _reader(extraction, signal, layout, place))
            for signal in extraction.signals
        )

    def fits(self, payload: bytes) -> bool:
        """Whether a payload of the size of the layout has the layout, and texts in ASCII."""
        for first, end, mark in self._marks:
            if payload[first:end] != mark:
                return False
        return all(payload[first:end].isascii() for first, end in self._texts)

    def read(self, payload: bytes) -> SingleMessage | None:
        numbers = self._numbers.unpack_from(payload)
        values = {}
        for name, reader in self._readers:
            value = reader(numbers, payload)
            if value is None:
                return None
            values[name] = value
        stamp = None
        if self._stamp is not None:
            seconds, nanoseconds = self._stamp
            stamp = numbers[seconds] * 10**9 + numbers[nanoseconds]
        return SingleMessage(stamp, values)


Reader = Callable[[Numbers, bytes], Value | None]
"""The value of one signal, from the single numbers and the payload; None: it is unusual."""


def _plan(extraction: Extraction, layout: Layout) -> _Plan | None:
    """The plan of a layout; None: its values are left to the extraction."""
    locations = layout.locations
    if any(
        signal.values and locations[signal.path.fields].count is not None
        for signal in extraction.signals
    ):
        return None
    if any(
        location.dtype == "?" or not location.count
        for location in locations.values()
        if location.count is not None
    ):
        return None
    return _Plan(extraction, layout)


_CHARACTERS = {
    "?": "?",
    "i1": "b",
    "u1": "B",
    "<i2": "h",
    "<u2": "H",
    "<i4": "i",
    "<u4": "I",
    "<i8": "q",
    "<u8": "Q",
    "<f4": "f",
    "<f8": "d",
}
"""The names of number types in NumPy and in `struct`."""


def _structure(locations: Sequence[Location]) -> struct.Struct:
    """The structure of numbers in the order of their positions, from the begin of the payload."""
    text, end = ["<"], 0
    for location in locations:
        text += [f"{location.at - end}x", _CHARACTERS[location.dtype]]
        end = location.at + np.dtype(location.dtype).itemsize
    return struct.Struct("".join(text))


def _reader(
    extraction: Extraction, signal: Signal, layout: Layout, place: Mapping[Where, int]
) -> Reader:
    location = layout.locations[signal.path.fields]
    kind = extraction.kind(signal)
    if location.count is None and signal.values:
        return _enum_reader(signal, place[signal.path.fields])
    if location.count is None and signal.reduce is None and signal.valid is None:
        return _number_reader(kind, place[signal.path.fields])
    beside = tuple((name, place[name,]) for name in siblings(signal))
    scan = scan_reader(signal, location)
    if scan is not None:
        return _scan_reader(scan, kind, location, beside)
    return _samples_reader(signal, kind, location, beside)


def _number_reader(kind: np.dtype[Any], place: int) -> Reader:
    def read(numbers: Numbers, payload: bytes) -> Value | None:
        number = numbers[place]
        usual = isfinite(number) if isinstance(number, float) else -WHOLE < number < WHOLE
        return (float(number), kind, "") if usual else None

    return read


def _enum_reader(signal: Signal, place: int) -> Reader:
    indices = {float(number): float(index) for index, number in enumerate(signal.numbers)}

    def read(numbers: Numbers, payload: bytes) -> Value | None:
        index = indices.get(float(numbers[place]))
        return None if index is None else (index, _DOUBLE, "")

    return read


def _samples_reader(
    signal: Signal, kind: np.dtype[Any], location: Location, beside: Sequence[tuple[str, int]]
) -> Reader:
    """The reader of an array, or of a number that may be invalid."""
    dtype = np.dtype(location.dtype.replace("?", "u1"))
    count = 1 if location.count is None else location.count

    def read(numbers: Numbers, payload: bytes) -> Value | None:
        array = np.frombuffer(payload, dtype, count, location.at)
        matrix = widest(array != 0 if location.dtype == "?" else array).reshape(1, -1)
        values = samples(
            signal, matrix, {name: np.array([float(numbers[i])]) for name, i in beside}
        )
        return _sampled(float(values[0]), kind) if values.dtype.itemsize <= 8 else None

    return read


def _scan_reader(
    scan: ScanReader, kind: np.dtype[Any], location: Location, beside: Sequence[tuple[str, int]]
) -> Reader:
    dtype, count = np.dtype(location.dtype), location.count or 0
    names, places = [name for name, _ in beside], [place for _, place in beside]

    def read(numbers: Numbers, payload: bytes) -> Value | None:
        array = np.frombuffer(payload, dtype, count, location.at)
        stated = tuple(float(numbers[place]) for place in places)
        value = scan.value(array, dict(zip(names, stated, strict=True)))
        return _sampled(value, kind)

    return read


def _sampled(value: float, kind: np.dtype[Any]) -> Value:
    return _NOTHING if isnan(value) else (value, kind, "")
