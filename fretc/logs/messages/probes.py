"""Generated messages of a definition, for comparison of layouts with the official decoder.

Messages of a log may hide an error: if all bytes are zero, a wrong position reads the same.
Generated messages have different bytes everywhere, and lengths that move the following fields.
"""

from __future__ import annotations

import random
from functools import lru_cache, reduce

import numpy as np

from fretc.logs.messages.decoding import Decode
from fretc.logs.messages.definitions import NUMBERS, TEXTS, MessageField, Types
from fretc.logs.messages.layouts import Location, TopicType
from fretc.logs.signals.samples import Numbers

_PROBES = 8
"""Enough for each length to have each value between two numbers of 8 bytes."""
_LARGEST = 2**18
"""The most bytes of a generated message."""


@lru_cache(256)
def trusted(shape: TopicType, decode: Decode) -> bool:
    """Whether the decoder reads each number of some generated messages like the layout."""
    payloads = [probe(shape, seed) for seed in range(_PROBES)]
    return all(payload is not None and _same(shape, decode, payload) for payload in payloads)


def probe(shape: TopicType, seed: int) -> bytes | None:
    """A payload with random contents; None: it would be too long."""
    probe = _Probe(shape.types, seed, cdr=shape.cdr)
    try:
        probe.message(shape.name)
    except _TooLongError:
        return None
    return bytes(probe.payload)


def _same(shape: TopicType, decode: Decode, payload: bytes) -> bool:
    wanted = shape.numbers()
    try:
        layout = shape.layout(memoryview(payload), wanted)
        message = decode(payload)
        official = [_numbers(reduce(getattr, where, message)) for where in wanted]
    except Exception:  # any exception: the decoder cannot read the message
        return False
    ours = [_at(payload, layout.locations[where]) for where in wanted]
    return all(
        a.shape == b.shape and np.array_equal(a, b, equal_nan=True)
        for a, b in zip(ours, official, strict=True)
    )


def _numbers(value: object) -> Numbers:
    return np.array(list(value) if isinstance(value, bytes) else value, np.float64).reshape(-1)


def _at(payload: bytes, location: Location) -> Numbers:
    count = 1 if location.count is None else location.count
    with np.errstate(invalid="ignore"):  # signalling NaN
        numbers = np.frombuffer(payload, location.dtype.replace("?", "u1"), count, location.at)
        return (numbers != 0 if location.dtype == "?" else numbers).astype(np.float64)


class _TooLongError(Exception):
    pass


class _Probe:
    """A payload under construction."""

    def __init__(self, types: Types, seed: int, *, cdr: bool) -> None:
        self.payload = bytearray(b"\0\1\0\0" if cdr else b"")
        self._types, self._random, self._cdr = types, random.Random(seed), cdr
        self._next = seed
        self._left = _LARGEST

    def message(self, name: str) -> None:
        """All fields of a type."""
        fields = self._types[name]
        if self._cdr and not fields:
            self._put(1, b"\0")
        for field in fields:
            self._field(field)

    def _field(self, field: MessageField) -> None:
        count = 1
        if field.many:
            count = self._next_length(4) if field.count is None else field.count
            if field.count is None:
                self._length(count)
        self._spend(count)
        for _ in range(count):
            if field.type in NUMBERS:
                size = np.dtype(NUMBERS[field.type]).itemsize
                self._put(size, self._random.randbytes(size))
            elif field.type in TEXTS:
                self._text()
            else:
                self.message(field.type)

    def _text(self) -> None:
        text = b"text of a"[: self._next_length(8)] + (b"\0" if self._cdr else b"")
        self._length(len(text))
        self.payload += text

    def _next_length(self, most: int) -> int:
        """A length that differs from message to message, and from place to place."""
        self._next += 1
        return self._next % most

    def _length(self, length: int) -> None:
        self._put(4, length.to_bytes(4, "little"))

    def _put(self, size: int, data: bytes) -> None:
        if self._cdr:
            self.payload += bytes(-(len(self.payload) - 4) % size)
        self.payload += data

    def _spend(self, count: int) -> None:
        self._left -= count + 1
        if self._left < 0:
            raise _TooLongError
