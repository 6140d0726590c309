"""The positions of wanted fields in payloads: one pass, then a check of many messages at once.

Fields stand one after the other, and strings and arrays have their lengths before them. Messages
of one topic mostly have the same lengths, and so the same layout: a walk through the first of them
collects the lengths, and the others are compared with these. Only wanted fields are decoded.

Sources: OMG DDSI-RTPS and CDR (plain CDR, XCDR version 1); ROS 1 serialization,
https://wiki.ros.org/roscpp/Overview/MessagesSerializationAndAdaptingTypes.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from fretc.logs.mcap.payloads import Payloads, Places
from fretc.logs.messages.definitions import CARRIED, NUMBERS, TEXTS, MessageField, Types
from fretc.logs.signals.samples import distinct
from fretish.classes.frozen import dataclass

Where = tuple[str, ...]
"""The names of fields from the message down."""

_LENGTH = struct.Struct("<I")
_PADDING = 7
"""Bytes that may follow the last field of CDR."""
_MOST_CHECKS = 64
"""The most lengths in a layout: a message with more shares its layout with no other."""
_MOST_LAYOUTS = 64
"""The most layouts of a stream: each message is compared with all of them."""


class LayoutError(ValueError):
    """The payload does not fit its definition, or a field is missing."""


@dataclass(frozen=True, slots=True)
class Location:
    """The position of a wanted field within a payload."""

    at: int
    """The offset of its first byte."""
    dtype: str
    count: int | None
    """The number of elements of an array; None for a single number."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Positions that many messages share."""

    size: int
    """Bytes of the payload."""
    marks: tuple[tuple[int, str, int], ...]
    """Positions, types and values of all lengths, and of the mark of plain CDR."""
    locations: Mapping[Where, Location]
    texts: tuple[tuple[int, int], ...] = ()
    """Positions and lengths of texts; the decoder refuses texts that are not UTF-8."""


class TopicType:
    """The type of a topic's messages."""

    def __init__(self, name: str, types: Types, *, cdr: bool) -> None:
        self.name, self.types, self.cdr = name, types, cdr
        self._fields: dict[Where, MessageField | None] = {}

    def number(self, where: Where) -> MessageField | None:
        """The number, or the array of numbers, at a path.

        None also for a time of ROS 1 in the message itself: its decoder carries nanoseconds over
        into seconds.
        """
        if where not in self._fields:
            self._fields[where] = self._number(where)
        return self._fields[where]

    def _number(self, where: Where) -> MessageField | None:
        name = self.name
        for depth, part in enumerate(where, 1):
            fields = self.types.get(name, ())
            field = next((field for field in fields if field.name == part), None)
            if field is None:
                return None
            if depth == len(where):
                carried = depth == 2 and name in CARRIED
                return field if field.type in NUMBERS and not carried else None
            if field.many:
                return None
            name = field.type
        return None

    def holder(self, where: Where) -> str | None:
        """The type that directly contains the number at a path; None: there is none."""
        if self.number(where) is None:
            return None
        name = self.name
        for part in where[:-1]:
            name = next(field.type for field in self.types[name] if field.name == part)
        return name

    def has(self, where: Where) -> bool:
        """Whether there is a number at a path."""
        field = self.number(where)
        return field is not None and not field.many

    def numbers(self) -> tuple[Where, ...]:
        """The paths of all numbers."""
        return tuple(where for where, _ in self._fields_below() if self.number(where) is not None)

    def texts(self) -> tuple[Where, ...]:
        """The paths of all texts, except those in arrays."""
        return tuple(
            where for where, field in self._fields_below() if field.type in TEXTS and not field.many
        )

    def _fields_below(self) -> Iterator[tuple[Where, MessageField]]:
        """Each field with a fixed path; the nearest ones first."""
        below: list[tuple[Where, str]] = [((), self.name)]
        for where, name in below:
            for field in self.types[name]:
                at = (*where, field.name)
                if field.type in self.types and not field.many:
                    below.append((at, field.type))
                else:
                    yield at, field

    def layout(self, payload: memoryview, wanted: Sequence[Where]) -> Layout:
        """The positions of the wanted fields in one payload.

        Args:
            payload: a whole message; with the first four bytes of CDR.
            wanted: numbers, or arrays of numbers.

        Raises:
            LayoutError: the length of the payload differs from that of its fields, or is not plain
                little-endian CDR; or a wanted field is missing, or not a number.
        """
        walk = _PayloadPass(payload, self.types, frozenset(wanted), cdr=self.cdr)
        try:
            walk.message(self.name, ())
        except struct.error:
            raise LayoutError("the payload is cut off") from None
        if not 0 <= len(payload) - walk.at <= (_PADDING if self.cdr else 0):
            raise LayoutError("the length of the payload differs from that of its fields")
        absent = [where for where in wanted if where not in walk.locations]
        if absent:
            raise LayoutError(f"no numbers are in `{'.'.join(absent[0])}`")
        return Layout(len(payload), tuple(walk.marks), walk.locations, tuple(walk.texts))


class _PayloadPass:
    """One pass through a payload."""

    def __init__(
        self, payload: memoryview, types: Types, wanted: frozenset[Where], *, cdr: bool
    ) -> None:
        self.at = 0
        self.marks: list[tuple[int, str, int]] = []
        self.locations: dict[Where, Location] = {}
        self.texts: list[tuple[int, int]] = []
        self._payload, self._types, self._wanted, self._cdr = payload, types, wanted, cdr
        if cdr:
            if bytes(payload[:2]) != b"\0\1":
                raise LayoutError("it is not plain little-endian CDR")
            self.marks.append((0, ">u2", 1))
            self.at = 4

    def message(self, name: str, where: Where) -> None:
        """All fields of a type; ROS 2 writes a byte for a type without any."""
        if self._cdr and not self._types[name]:
            self.at += 1
        for field in self._types[name]:
            self._field(field, (*where, field.name))
        if self.at > len(self._payload):  # raised here, to end arrays of empty elements
            raise LayoutError("the payload is cut off")

    def _field(self, field: MessageField, where: Where) -> None:
        count = (self._length() if field.count is None else field.count) if field.many else None
        if field.type in NUMBERS:
            self._numbers(NUMBERS[field.type], count, where)
        elif field.type in TEXTS:
            for _ in range(1 if count is None else self._bounded(count)):
                self._text(self._length())
        elif count is None:
            self.message(field.type, where)
        elif self._cdr or self._types[field.type]:  # ROS 1 writes nothing for an empty type
            for _ in range(self._bounded(count)):
                self.message(field.type, ("[]",))  # it contains no wanted field

    def _numbers(self, dtype: str, count: int | None, where: Where) -> None:
        size = np.dtype(dtype).itemsize
        if self._cdr and count != 0:  # empty arrays are not aligned
            self.at += -(self.at - 4) % size
        if where in self._wanted:
            self.locations[where] = Location(self.at, dtype, count)
        self.at += size if count is None else size * count

    def _text(self, length: int) -> None:
        if self._cdr and length > 1:  # the last byte is a terminator
            self.texts.append((self.at, length - 1))
        self.at += length

    def _length(self) -> int:
        if self._cdr:
            self.at += -self.at % 4
        (length,) = _LENGTH.unpack_from(self._payload, self.at)
        self.marks.append((self.at, "<u4", length))
        self.at += 4
        return int(length)

    def _bounded(self, count: int) -> int:
        """The count, after a check: each element takes at least a byte of the payload."""
        if count > len(self._payload):
            raise LayoutError("the payload is cut off")
        return count


# Many messages --------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class MessageGroup:
    """Messages of one layout; None: they fit no layout."""

    rows: Places
    layout: Layout | None
    new: bool = False
    """Whether this is the first message with the layout."""


class Layouts:
    """The layouts of the messages of one stream, collected as they come."""

    def __init__(self, shape: TopicType, wanted: Sequence[Where]) -> None:
        self._shape, self._wanted = shape, wanted
        self._layouts: dict[int, list[Layout]] = {}
        """Layouts by size; at most `_MOST_LAYOUTS` in all."""
        self._count = 0

    def known(self, size: int) -> Sequence[Layout]:
        """The layouts of a size, the first one first."""
        return self._layouts.get(size, ())

    def groups(self, payloads: Payloads) -> Iterator[MessageGroup]:
        """All messages, grouped by layout."""
        rest = np.arange(len(payloads))
        if self._count:
            for size in distinct(payloads.sizes).tolist():
                for layout in self._layouts.get(size, ()):
                    same = _same(payloads, rest, layout)
                    yield from _split(payloads, rest[same], layout, new=False)
                    rest = rest[~same]
        while len(rest):
            try:
                layout = self._shape.layout(payloads.payload(int(rest[0])), self._wanted)
            except LayoutError:
                yield MessageGroup(rest[:1], None)
                rest = rest[1:]
                continue
            self._keep(layout)
            same = _same(payloads, rest, layout)
            same[0] = True
            rows, rest = rest[same], rest[~same]
            yield from _split(payloads, rows, layout, new=True)

    def _keep(self, layout: Layout) -> None:
        if self._count < _MOST_LAYOUTS and len(layout.marks) <= _MOST_CHECKS:
            self._count += 1
            self._layouts.setdefault(layout.size, []).append(layout)


def _split(
    payloads: Payloads, rows: Places, layout: Layout, *, new: bool
) -> Iterator[MessageGroup]:
    """Separate messages with texts beyond ASCII, which the decoder checks."""
    plain = _plain(payloads, rows, layout)
    if plain.any():
        yield MessageGroup(rows[plain], layout, new)
    if not plain.all():
        yield MessageGroup(rows[~plain], None)


def _same(payloads: Payloads, rows: Places, layout: Layout) -> NDArray[np.bool_]:
    """The rows that have the layout, as far as its marks show."""
    same: NDArray[np.bool_] = payloads.sizes[rows] == layout.size
    if len(layout.marks) > _MOST_CHECKS:
        return np.zeros(len(rows), bool)
    matching = rows[same]
    agree = np.ones(len(matching), bool)
    for at, dtype, value in layout.marks:
        agree &= payloads.gathered(matching, at, dtype, None) == value
    same[same] = agree
    return same


def _plain(payloads: Payloads, rows: Places, layout: Layout) -> NDArray[np.bool_]:
    """The rows in which all texts are ASCII; only the decoder can check others."""
    plain = np.ones(len(rows), bool)
    for at, length in layout.texts:
        plain &= (payloads.gathered(rows, at, "u1", length).view(np.int8) >= 0).all(axis=1)
    return plain
