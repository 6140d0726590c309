"""Numbers of sentences and bindings as JavaScript constants: the nearest number of each kind."""

from __future__ import annotations

from dataclasses import field
from fractions import Fraction
from math import ceil, floor, inf

from compiler.signals.printing import parts
from fretish.classes.frozen import dataclass
from monitors.kernel.readings import Constant, Single, exact

_WHOLE = 2**52
"""From this value on, 64-bit floats are integers."""


@dataclass(frozen=True, slots=True)
class Constants:
    """Named constants."""

    names: dict[Fraction, str] = field(default_factory=dict)

    def name(self, value: Fraction) -> str:
        """The name of a number; a new number gets a new name."""
        return self.names.setdefault(value, f"number_{len(self.names) + 1}")

    def lines(self) -> tuple[str, ...]:
        """The declarations of the constants."""
        return tuple(f"const {name} = {_constant(value)};" for value, name in self.names.items())


def _constant(value: Fraction) -> str:
    number: Constant = exact(str(value))
    single = _float(number.single)
    if isinstance(number.single, Single):
        single = f"float32({single})"
    parts = [_float(number.double), single]
    if abs(value) >= _WHOLE:
        parts += [f"{floor(value)}n", f"{ceil(value)}n"]
    return f"constant({', '.join(parts)})"


def _float(value: float) -> str:
    if value in (inf, -inf):
        return "Infinity" if value > 0 else "-Infinity"
    return repr(float(value))


def scale(value: Fraction) -> str:
    """A factor as numerator and denominator."""
    return f"[{', '.join(map(_float, parts(value)))}]"


def truth(value: bool | None) -> str:
    """A truth value, or null if unknown."""
    return "null" if value is None else str(value).lower()
