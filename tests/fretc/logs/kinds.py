"""Message types of any shape, messages of them, and both as ROS writes them."""

from __future__ import annotations

import random
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from io import BytesIO
from typing import Any

import numpy as np
from hypothesis import strategies as st
from mcap.records import Channel, Schema
from mcap_ros1._vendor import genpy
from mcap_ros1._vendor.genpy import dynamic
from mcap_ros2._dynamic import serialize_dynamic

from fretc.logs.mcap.container import ChannelDefinition

SIZES = {
    "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
    "int64": "q", "uint64": "Q", "float32": "f", "float64": "d", "bool": "?",
    "byte": "B", "char": "b",
}  # fmt: skip
TIMES = ("time", "duration")


@dataclass(frozen=True)
class Part:
    """A field: of a primitive type, or of another kind; `array` is what stands in brackets."""

    name: str
    type: str | Kind
    array: str | None = None


@dataclass(frozen=True)
class Kind:
    """A message type."""

    name: str
    parts: tuple[Part, ...]

    def definition(self, *, ros1: bool) -> str:
        """As it stands in a log, with the kinds that it is made of."""
        below = {kind.name: kind for kind in self.below()}
        sections = [self.lines()]
        for kind in below.values():
            sections.append(f"MSG: {kind.name}\n{kind.lines()}\n")
        return ("=" * 80 + "\n").join(sections)

    def lines(self) -> str:
        lines = []
        for part in self.parts:
            type_ = part.type if isinstance(part.type, str) else part.type.name
            array = "" if part.array is None else f"[{part.array}]"
            lines.append(f"{type_}{array} {part.name}\n")
        return "".join(lines)

    def below(self) -> Iterator[Kind]:
        for part in self.parts:
            if isinstance(part.type, Kind):
                yield part.type
                yield from part.type.below()


@st.composite
def kinds(draw: st.DrawFn, *, ros1: bool) -> Kind:
    """Each with up to three levels of others in it."""
    primitives = [*SIZES, "string", "string", "string", *(TIMES if ros1 else ("string<=40",))]
    arrays = ["", "1", "3"] + ([] if ros1 else ["<=9"])
    known: list[Kind] = []
    for i in range(draw(st.integers(1, 4))):
        parts = []
        least = 1 if i == 0 and ros1 else 0  # ROS 1 takes no room for an empty type
        for j in range(draw(st.integers(least, 6))):
            inner = draw(st.booleans()) if known else False
            type_ = draw(st.sampled_from(known)) if inner else draw(st.sampled_from(primitives))
            array = draw(st.sampled_from([None, None, *arrays]))
            if ros1 and isinstance(type_, Kind) and not type_.parts:
                array = None
            parts.append(Part(f"f{j}", type_, array))
        package = draw(st.sampled_from(["one", "two"]))
        known.append(Kind(f"{package}/T{i}", tuple(parts)))
    return known[-1]


def message(kind: Kind, random: random.Random, *, ros1: bool) -> dict[str, Any]:
    return {part.name: _part(part, random, ros1=ros1) for part in kind.parts}


def _part(part: Part, random: random.Random, *, ros1: bool) -> Any:
    if part.array is None:
        return _one(part.type, random, ros1=ros1)
    count = int(part.array) if part.array.isdigit() else random.choice([0, 1, 2, 5])
    return [_one(part.type, random, ros1=ros1) for _ in range(count)]


def _one(type_: str | Kind, random: random.Random, *, ros1: bool) -> Any:
    if isinstance(type_, Kind):
        return message(type_, random, ros1=ros1)
    if type_.startswith("string"):
        return random.choice(["", "a", "ab", "abc", "abcd", "some_frame_id", "é"])
    if type_ in TIMES:
        seconds = random.choice([0, 1, 2**31 - 1, *([] if type_ == "time" else [-5])])
        return {"secs": seconds, "nsecs": random.choice([0, 5, 999_999_999, 1_500_000_000])}
    if type_ in ("byte", "char") and ros1:
        type_ = {"byte": "int8", "char": "uint8"}[type_]
    if type_ == "bool":
        return random.random() < 0.5
    if type_.startswith("float") and random.random() < 0.3:
        return random.choice([float("nan"), float("inf"), -float("inf"), 0.0, -0.0])
    code = SIZES[type_]
    (value,) = struct.unpack("<" + code, random.randbytes(struct.calcsize("<" + code)))
    return value


class Encoder:
    """Writes messages of one kind, by the official serializers."""

    def __init__(self, kind: Kind, *, ros1: bool) -> None:
        self.kind, self.ros1 = kind, ros1
        text = kind.definition(ros1=ros1)
        encoding = "ros1" if ros1 else "cdr"
        schema = Schema(1, text.encode(), f"{'ros1' if ros1 else 'ros2'}msg", kind.name)
        self.stream = ChannelDefinition(Channel(1, "/x", encoding, {}, 1), schema)
        generate: Any = dynamic.generate_dynamic
        self._classes = generate(kind.name, text) if ros1 else {}
        self._encode = None if ros1 else serialize_dynamic(kind.name, text)[kind.name]

    def __call__(self, message: dict[str, Any]) -> bytes:
        if self._encode is not None:
            return bytes(self._encode(message))
        buffer = BytesIO()
        self._filled(self.kind, message).serialize(buffer)
        return buffer.getvalue()

    def _filled(self, kind: Kind, message: dict[str, Any]) -> Any:
        made = self._classes[kind.name]()
        for part in kind.parts:
            value = message[part.name]
            if part.type in TIMES:
                self._time(made, part, value)
            elif isinstance(part.type, Kind):
                value = (
                    self._filled(part.type, value)
                    if part.array is None
                    else [self._filled(part.type, one) for one in value]
                )
                setattr(made, part.name, value)
            else:
                setattr(made, part.name, value)
        return made

    def _time(self, made: Any, part: Part, value: Any) -> None:
        kind: Any = genpy.Time if part.type == "time" else genpy.Duration

        def time(parts: dict[str, int]) -> Any:
            one = kind()
            one.set(**parts)
            return one

        setattr(made, part.name, time(value) if part.array is None else [*map(time, value)])


def official(message: object, where: tuple[str, ...]) -> np.ndarray[Any, Any]:
    """The number, or the numbers, at a place of a decoded message."""
    value = reduce(getattr, where, message)
    return np.array(list(value) if isinstance(value, bytes) else value, np.float64)
