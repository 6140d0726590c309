"""The numbers of the signals of one stream from its payloads, many messages at once.

Fields are read at their positions in the payloads. The official decoder, slower and the reference,
also decodes generated messages, and some of the first real ones, and their numbers are compared; if
the decoder disagrees, it reads the whole stream.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fretc.logs import log_diagnostics
from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.mcap.damage import LATEST
from fretc.logs.mcap.payloads import Payloads, Places
from fretc.logs.messages.decoding import Decode, constants, decoder, is_single, shape, stamp
from fretc.logs.messages.layouts import Layout, Layouts, Location, TopicType, Where
from fretc.logs.messages.probes import trusted
from fretc.logs.messages.vectorized import nearest, samples, siblings
from fretc.logs.signals.enum_values import UnmappedSamples, enum_index, enum_indices, shown
from fretc.logs.signals.samples import EXACT, Numbers, Times, Values, widest
from fretc.logs.signals.signals import RANGE_MIN, FieldError, is_chosen, sample
from fretc.logs.signals.signals import nearest as nearest_of_one
from fretish.bindings.declarations import Reduce, Signal
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic

_CHECKED = 8
"""The number of layouts of a stream that are compared with the official decoder on three
messages."""
_FEW_ROWS, _LARGE = 128, 1024
"""If a layout has fewer messages, and they have more bytes, one is compared: decoding three would
cost more than the rest."""
_BLOCK = 2**17
"""Numbers of an array field in one block, so that the passes over them stay within the cache."""
_FEW = 512
"""Bytes up to which the official decoder is faster. Two channels of one topic may alternate, and
then each message comes alone."""
_SECONDS = ("int32", "uint32")
"""Types of a stamp's fields for which no sum of seconds and nanoseconds overflows."""
_STAMPS = (("sec", "nanosec"), ("secs", "nsecs"))
"""Names of the fields of a stamp in ROS 2 and in ROS 1."""


@dataclass(slots=True)
class Extract:
    """The contents of some messages of a stream, in their order."""

    values: dict[str, Values]
    """The values of each signal, shape (messages,), as recorded; NaN where unknown."""
    decoded: NDArray[np.bool_]
    stamps: Times
    stamped: NDArray[np.bool_]
    nearest: dict[str, float] = field(default_factory=dict)
    foreign: dict[str, NDArray[np.bool_]] = field(default_factory=dict)
    """For each enumeration signal, the messages without any of its values; absent: none."""
    texts: dict[str, tuple[int, str]] = field(default_factory=dict)
    """The first such message, and its text."""

    @classmethod
    def empty(cls, count: int, signals: Iterable[Signal], single: Container[str] = ()) -> Extract:
        """An extract to fill; `single` are signals of 32-bit floats."""
        kinds = {
            signal.name: "f4" if signal.name in single and is_chosen(signal) else "f8"
            for signal in signals
        }
        return cls(
            {name: np.full(count, np.nan, kind) for name, kind in kinds.items()},
            np.zeros(count, bool),
            np.zeros(count, np.int64),
            np.zeros(count, bool),
        )

    def put(self, signal: Signal, at: int | Places, numbers: float | Values) -> None:
        """Store the numbers of a signal in some messages."""
        wide = isinstance(numbers, int) or (
            isinstance(numbers, np.ndarray) and numbers.dtype == EXACT
        )
        if wide:
            self.values[signal.name] = self.values[signal.name].astype(EXACT, copy=False)
        self.values[signal.name][at] = numbers

    def put_enum_value(self, signal: Signal, at: int, word: float | str) -> None:
        """Store the index of an enumeration value, or record a text without one."""
        if isinstance(word, str):
            self._note(signal, np.array([at]), word)
        else:
            self.values[signal.name][at] = word

    def put_enum_values(self, signal: Signal, at: Places, numbers: Values) -> None:
        """Store the enumeration values of some numbers."""
        places, foreign = enum_indices(signal, numbers)
        self.values[signal.name][at] = places
        if foreign.any():
            self._note(signal, at[foreign], shown(numbers[foreign][0]))

    def _note(self, signal: Signal, at: Places, first: str) -> None:
        """Record messages, in their order, without any value of an enumeration signal."""
        rows = self.foreign.setdefault(signal.name, np.zeros(len(self.decoded), bool))
        rows[at] = True
        first_text, _ = self.texts.get(signal.name, (len(rows), ""))
        if int(at[0]) < first_text:
            self.texts[signal.name] = int(at[0]), first

    def foreign_of(self, name: str, usable: NDArray[np.bool_]) -> UnmappedSamples | None:
        """The samples of an enumeration signal outside its values, in the usable messages."""
        rows = self.foreign[name][usable] if name in self.foreign else np.zeros(0, bool)
        if not rows.any():
            return None
        return UnmappedSamples(int(rows.sum()), int(rows.argmax()), self.texts[name][1])

    def is_foreign(self, name: str, row: int) -> bool:
        """Whether one message has none of the values of an enumeration signal."""
        return name in self.foreign and bool(self.foreign[name][row])

    def near(self, signal: Signal, least: float | None) -> None:
        """Record the least distance that some messages state."""
        if least is not None:
            self.nearest[signal.name] = min(least, self.nearest.get(signal.name, least))


class Extraction:
    """The reader of one stream."""

    def __init__(
        self, stream: ChannelDefinition, signals: Sequence[Signal], few: int | None = None
    ) -> None:
        """`few`: bytes of messages up to which the official decoder reads them; None: the usual."""
        self._few = _FEW if few is None else few
        self.signals = list(signals)
        """The readable signals; the others have a diagnostic."""
        self.diagnostics: dict[str, Diagnostic] = {}
        self._checks = _CHECKED
        decode = decoder(stream)
        self._decode: Decode | None = None if isinstance(decode, str) else decode
        self._single: frozenset[str] = frozenset()
        """Signals of 32-bit floats."""
        if self._decode is not None:
            self._single = frozenset(s.name for s in signals if is_single(stream, s.path.fields))
            self._name_numbers(stream)
        self._shape = _shape(stream, self._decode)
        self._sought: tuple[str, ...] | None = None
        """The signals of the present layouts; fewer after one was refused."""
        self._layouts: Layouts | None = None
        """None: some wanted field has no fixed position."""
        if isinstance(decode, str):
            for signal in signals:
                self._refuse(signal, log_diagnostics.unknown_encoding(signal, decode))

    @property
    def reads(self) -> bool:
        """Whether any signal or time can be decoded."""
        return self._decode is not None

    def extract(self, payloads: Payloads) -> Extract:
        """The contents of the messages."""
        extract = Extract.empty(len(payloads), self.signals, self._single)
        if self._decode is None:
            return extract
        slow: Sequence[int] = range(len(payloads))
        if self._shape is not None and payloads.sizes.sum() >= self._few:
            if not self._placed(
                self._shape
            ):  # one message shows which signals have no fixed position
                self._one_by_one(0, bytes(payloads.payload(0)), extract)
                slow = slow[1:]
            if self._placed(self._shape):
                slow = self._at_once(payloads, extract)
            if self._shape is None:
                extract = Extract.empty(len(payloads), self.signals, self._single)
                slow = range(len(payloads))
        for row in slow:
            self._one_by_one(row, bytes(payloads.payload(row)), extract)
        return extract

    def kind(self, signal: Signal) -> np.dtype[Any]:
        """The type of the samples of a signal, unless a whole number of 2^53 and more is one."""
        return Extract.empty(0, [signal], self._single).values[signal.name].dtype

    def known_layouts(self, size: int) -> Sequence[Layout]:
        """The layouts of earlier messages of a size; those with more follow later."""
        if self._layouts is None or self._shape is None:
            return ()
        if self._sought is None or len(self._sought) != len(self.signals):
            return ()
        return self._layouts.known(size)

    @property
    def stamp_places(self) -> tuple[Where, ...]:
        """The seconds and nanoseconds of `header.stamp`; empty: they have no fixed position."""
        return _stamp_places(self._shape) if self._shape is not None else ()

    def _refuse(self, signal: Signal, diagnostic: Diagnostic) -> None:
        self.signals.remove(signal)
        self.diagnostics[signal.name] = diagnostic

    def _name_numbers(self, stream: ChannelDefinition) -> None:
        """Look up the number of each enumeration value in the definition of the messages."""
        for signal in tuple(self.signals):
            if not signal.values or signal.numbers:
                continue
            named_numbers = constants(stream, signal.path.fields)
            if named_numbers is None:
                continue
            numbers = tuple(named_numbers[word] for word in signal.values if word in named_numbers)
            if len(set(numbers)) < len(signal.values):
                self._refuse(signal, log_diagnostics.no_constant(signal, named_numbers))
            else:
                named = replace(signal, numbers=numbers)
                self.signals[self.signals.index(signal)] = named

    # By the official decoder

    def _one_by_one(self, row: int, payload: bytes, extract: Extract) -> None:
        message = self._message(payload)
        if message is None:
            return
        extract.decoded[row] = True
        time = stamp(message)
        if time is not None:
            extract.stamps[row] = max(-LATEST, min(time, LATEST))
            extract.stamped[row] = True
        for signal in tuple(self.signals):
            try:
                if signal.values:
                    extract.put_enum_value(signal, row, enum_index(signal, message))
                else:
                    number = sample(signal, message, single=signal.name in self._single)
                    extract.put(signal, row, number)
            except FieldError as error:
                self._refuse(signal, log_diagnostics.no_field(signal, error))
                continue
            extract.near(signal, nearest_of_one(signal, message))

    def _message(self, payload: bytes) -> object | None:
        assert self._decode is not None
        try:
            return self._decode(payload)
        except Exception:  # the decoder trusts each byte, and each may be wrong
            return None

    # By positions

    def _placed(self, shape: TopicType) -> bool:
        """Whether every wanted field has a position; if not, each message must be decoded."""
        names = tuple(signal.name for signal in self.signals)
        if names != self._sought:
            self._sought = names
            placed = self._are_placed(shape)
            self._layouts = Layouts(shape, self._wanted(shape)) if placed else None
        return self._layouts is not None

    def _are_placed(self, shape: TopicType) -> bool:
        return all(_reads(shape, signal) for signal in self.signals) and all(
            field is not None and field.type in _SECONDS
            for field in map(shape.number, _stamp_places(shape))
        )

    def _at_once(self, payloads: Payloads, extract: Extract) -> Sequence[int]:
        """Read all messages that fit a layout; return the remaining rows.

        If the official decoder reads one of them differently, all messages are decoded from then
        on.
        """
        assert self._layouts is not None
        rest: list[int] = []
        for group in self._layouts.groups(payloads):
            if group.layout is None:
                rest.extend(group.rows.tolist())
                continue
            self._fill(payloads, group.rows, group.layout, extract)
            if group.new and self._checks:
                self._checks -= 1
                rows = _telling(group.rows, payloads)
                if not all(self._agrees(row, payloads, group.layout, extract) for row in rows):
                    self._shape = None
                    break
        return sorted(rest)

    def _wanted(self, shape: TopicType) -> tuple[Where, ...]:
        wanted: dict[Where, None] = {}
        for signal in self.signals:
            wanted[signal.path.fields] = None
            wanted.update({(name,): None for name in siblings(signal)})
            if shape.has((RANGE_MIN,)):
                wanted[RANGE_MIN,] = None
        wanted.update(dict.fromkeys(_stamp_places(shape)))
        return tuple(wanted)

    def _agrees(self, row: int, payloads: Payloads, layout: Layout, extract: Extract) -> bool:
        """Whether the official decoder reads the same values of one message as the extract has."""
        official = Extract.empty(1, self.signals, self._single)
        before = len(self.diagnostics)
        self._one_by_one(0, bytes(payloads.payload(row)), official)
        if len(self.diagnostics) != before or not official.decoded[0]:
            return False
        return (
            all(
                _alike(official.values[s.name][0], extract.values[s.name][row])
                and (s.name in official.foreign) == extract.is_foreign(s.name, row)
                for s in self.signals
            )
            and bool(official.stamped[0] == extract.stamped[row])
            and bool(official.stamps[0] == extract.stamps[row])
            and official.nearest == self._nearest(row, payloads, layout)
        )

    def _nearest(self, row: int, payloads: Payloads, layout: Layout) -> dict[str, float]:
        """The least distances that one message states."""
        single = Extract.empty(1, ())
        place = layout.locations.get((RANGE_MIN,))
        if place is not None and place.count is None:
            stated = _numbers(payloads.gathered(np.array([row]), place.at, place.dtype, None))
            self._note_nearest(stated, single)
        return single.nearest

    def _note_nearest(self, range_min: Numbers, extract: Extract) -> None:
        for signal in self.signals:
            if signal.reduce in (Reduce.MIN, Reduce.OUTLINE):
                extract.near(signal, nearest(signal, range_min))

    def _fill(self, payloads: Payloads, rows: Places, layout: Layout, extract: Extract) -> None:
        """Put the contents of some messages into the extract."""
        extract.decoded[rows] = True
        locations = layout.locations
        single = {
            where: payloads.gathered(rows, field.at, field.dtype, None)
            for where, field in locations.items()
            if field.count is None
        }
        for signal in self.signals:
            sibling_values = {name: _numbers(single[name,]) for name in siblings(signal)}
            field = locations[signal.path.fields]
            if field.count is None:
                matrix = _matrix(single[signal.path.fields])
                # An infinity is none of the values of an enumeration, and a sample of it unknown.
                is_enum = bool(signal.values)
                values = matrix[:, 0] if is_enum else samples(signal, matrix, sibling_values)
            else:
                values = self._reduced(signal, payloads, rows, field, sibling_values)
            if signal.values:
                extract.put_enum_values(signal, rows, values)
            else:
                extract.put(signal, rows, values)
        if (RANGE_MIN,) in single:
            self._note_nearest(_numbers(single[RANGE_MIN,]), extract)
        places = self.stamp_places
        if places:
            seconds, nanoseconds = (single[place].astype(np.int64) for place in places)
            extract.stamps[rows] = seconds * 10**9 + nanoseconds
            extract.stamped[rows] = True

    def _reduced(
        self,
        signal: Signal,
        payloads: Payloads,
        rows: Places,
        field: Location,
        sibling_values: Mapping[str, Numbers],
    ) -> Values:
        """A signal of an array, block by block; shape (rows,)."""
        values: list[Values] = [np.zeros(0, np.float32)]
        step = max(1, _BLOCK // max(1, field.count or 0))
        for first in range(0, len(rows), step):
            block = slice(first, first + step)
            gathered = payloads.gathered(rows[block], field.at, field.dtype, field.count)
            siblings_of_block = {name: numbers[block] for name, numbers in sibling_values.items()}
            values.append(samples(signal, _matrix(gathered), siblings_of_block))
        return np.concatenate(values)


def _shape(stream: ChannelDefinition, decode: Decode | None) -> TopicType | None:
    """The layout of the messages; None: it is not certain."""
    layout = shape(stream) if decode is not None else None
    return layout if decode and layout and trusted(layout, decode) else None


def _telling(rows: Places, payloads: Payloads) -> set[int]:
    """The rows to compare: the first, the middle and the last.

    Of few large ones, only the row of these three with the most different bytes: equal bytes do not
    distinguish two positions.
    """
    chosen = {int(rows[i]) for i in (0, (len(rows) - 1) // 2, -1)}
    if len(rows) >= _FEW_ROWS or payloads.sizes[rows[0]] <= _LARGE:
        return chosen
    return {max(sorted(chosen), key=lambda row: len(set(bytes(payloads.payload(row)))))}


def _reads(shape: TopicType, signal: Signal) -> bool:
    """Whether the signal's fields are numbers, or arrays where its path needs arrays."""
    field, path = shape.number(signal.path.fields), signal.path
    return (
        field is not None
        and field.many == (path.each or path.index is not None)
        and all(shape.has((name,)) for name in siblings(signal))
    )


def _alike(one: np.floating[Any], other: np.floating[Any]) -> bool:
    return bool(one == other) or bool(np.isnan(one) and np.isnan(other))


def _matrix(numbers: NDArray[np.generic]) -> Values:
    """One row for each message."""
    return widest(numbers.reshape(len(numbers), numbers[:1].size))


def _numbers(numbers: NDArray[np.generic]) -> Numbers:
    with np.errstate(invalid="ignore"):
        return numbers.astype(np.float64)


def _stamp_places(shape: TopicType) -> tuple[Where, ...]:
    """The seconds and nanoseconds of `header.stamp`, if the messages have one."""
    for names in _STAMPS:
        places = tuple(("header", "stamp", name) for name in names)
        if all(map(shape.has, places)):
            return places
    return ()
