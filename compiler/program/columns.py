"""A block's operator over whole traces: one operation over columns."""

from __future__ import annotations

from compiler.program.values import Value
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class AtFirst:
    """True at tick 0 alone."""


@dataclass(frozen=True, slots=True)
class PreviousColumn:
    """The value of the tick before; at tick 0, `weak`."""

    value: Value
    weak: bool


@dataclass(frozen=True, slots=True)
class SinceColumn:
    """`guard S[lo,hi] witness` in ticks; `dual`: the negation of that of the negated values."""

    guard: Value | None
    """None: no guard."""
    witness: Value
    lo: int
    hi: int | None
    dual: bool
    unbounded: str | None = None
    """The name of the column without bounds, if that is computed before."""


Column = Value | AtFirst | PreviousColumn | SinceColumn
