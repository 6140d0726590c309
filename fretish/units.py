"""Physical units, and exact conversion between them.

There are six base units. The angle is one of them, so that radians differ from plain numbers.
Source of the factors: The International System of Units (SI Brochure, 9th edition), tables 2-8; of
ft and kn, the units of aviation and shipping, ICAO Annex 5, table 3-3.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from fractions import Fraction
from functools import lru_cache
from itertools import combinations
from operator import mul

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic, suggestion
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span

_BASES = ("m", "kg", "s", "A", "K", "rad")
Dimension = tuple[int, ...]
"""Exponents of metre, kilogram, second, ampere, kelvin, radian."""

DIMENSIONLESS: Dimension = (0,) * len(_BASES)


@dataclass(frozen=True, slots=True)
class Unit:
    """A product of powers of the bases, times a factor; 1 km is 1000 times the base unit m."""

    dimension: Dimension
    factor: Fraction

    def __str__(self) -> str:
        """The base unit of the dimension: `m/s`, `rad`, or nothing for a plain number."""
        return base_name(self.dimension)


def _base(name: str, factor: Fraction | int = 1) -> Unit:
    return Unit(tuple(int(name == base) for base in _BASES), Fraction(factor))


def times(left: Unit, right: Unit, power: int = 1) -> Unit:
    """`left * right ^ power`."""
    dimension = tuple(a + power * b for a, b in zip(left.dimension, right.dimension, strict=True))
    return Unit(dimension, left.factor * right.factor**power)


ONE = Unit(DIMENSIONLESS, Fraction(1))
PERCENT = Unit(DIMENSIONLESS, Fraction(1, 100))
SECOND = _base("s")
METRE = _base("m")
_KILOGRAM = _base("kg")
_NEWTON = Unit((1, 1, -2, 0, 0, 0), Fraction(1))
_VOLT = Unit((2, 1, -3, -1, 0, 0), Fraction(1))

_UNITS: dict[str, Unit] = {
    "1": ONE,
    "%": PERCENT,
    "m": METRE,
    "km": _base("m", 1000),
    "dm": _base("m", Fraction(1, 10)),
    "cm": _base("m", Fraction(1, 100)),
    "mm": _base("m", Fraction(1, 1000)),
    "um": _base("m", Fraction(1, 10**6)),
    "ft": _base("m", Fraction(3048, 10**4)),
    "kn": Unit((1, 0, -1, 0, 0, 0), Fraction(1852, 3600)),
    "s": SECOND,
    "ms": _base("s", Fraction(1, 1000)),
    "us": _base("s", Fraction(1, 10**6)),
    "ns": _base("s", Fraction(1, 10**9)),
    "min": _base("s", 60),
    "h": _base("s", 3600),
    "rad": _base("rad"),
    "mrad": _base("rad", Fraction(1, 1000)),
    "deg": _base("rad", Fraction(math.pi) / 180),
    "kg": _KILOGRAM,
    "g": _base("kg", Fraction(1, 1000)),
    "A": _base("A"),
    "mA": _base("A", Fraction(1, 1000)),
    "K": _base("K"),
    "N": _NEWTON,
    "Nm": times(_NEWTON, METRE),
    "Pa": times(_NEWTON, METRE, -2),
    "kPa": Unit((-1, 1, -2, 0, 0, 0), Fraction(1000)),
    "bar": Unit((-1, 1, -2, 0, 0, 0), Fraction(10**5)),
    "V": _VOLT,
    "mV": Unit(_VOLT.dimension, Fraction(1, 1000)),
    "W": times(_VOLT, _base("A")),
    "Hz": Unit((0, 0, -1, 0, 0, 0), Fraction(1)),
}
NAMES = tuple(_UNITS)
_FACTOR = re.compile(r"([A-Za-z%]+|1)(?:\^?(-?[0-9]{1,2}))?")
_MOST_FACTORS = 16
"""The largest number of factors of a unit; it bounds the size of conversion factors."""


def unit(text: str) -> Unit | None:
    """Parse `m`, `m/s`, `m/s^2`, `kg*m/s2`; None if a part is unknown."""
    result = ONE
    if text.count("*") + text.count("/") >= _MOST_FACTORS:
        return None
    for position, factors in enumerate(text.split("/")):
        for factor in factors.split("*"):
            match = _FACTOR.fullmatch(factor.strip())
            if match is None or match[1] not in _UNITS:
                return None
            power = int(match[2] or 1) * (1 if position == 0 else -1)
            result = times(result, _UNITS[match[1]], power)
    return result


def unit_product(left: str, right: str) -> str:
    """The name of a product of units: `km*s/h` for `km/h` and `s`; empty for plain numbers."""
    above, below = _fraction(left)
    more, less = _fraction(right)
    return _spelt([*above, *more], [*below, *less])


def unit_quotient(left: str, right: str) -> str:
    """The name of a quotient of units: `m/s` for `m` and `s`; empty for plain numbers."""
    above, below = _fraction(left)
    more, less = _fraction(right)
    return _spelt([*above, *less], [*below, *more])


def is_vague(name: str) -> bool:
    """Whether a product has units of one dimension that do not cancel: `cm/m`, `km/h*s`, `%*m`."""
    above, below = (Counter(map(_without_power, part)) for part in _fraction(name))
    left = {*(above - below), *(below - above)} - {"1"}
    return any(_is_alike(_UNITS[a], _UNITS[b]) for a, b in combinations(left, 2))


def _is_alike(a: Unit, b: Unit) -> bool:
    """Whether two units share a base unit or one is dimensionless, and not both are coherent."""
    shared = any(map(mul, a.dimension, b.dimension))
    plain = DIMENSIONLESS in (a.dimension, b.dimension)
    return (shared or plain) and not a.factor == b.factor == 1


def _without_power(factor: str) -> str:
    match = _FACTOR.fullmatch(factor.strip())
    assert match is not None, "the reader of bindings refuses unknown units"
    return match[1]


def _fraction(name: str) -> tuple[list[str], list[str]]:
    """The factors of numerator and denominator; `m/s*s` is m / (s s)."""
    above, *below = name.split("/")
    factors = [factor for factor in above.split("*") if factor not in ("", "1")]
    return factors, [factor for part in below for factor in part.split("*")]


def _spelt(above: list[str], below: list[str]) -> str:
    return "/".join(["*".join(above) or ("1" if below else ""), *below])


_NUMBER = re.compile(r"-?[0-9]{1,60}(?:\.[0-9]{1,60})?(?:[eE][+-]?[0-9]{1,3})?")


def number(text: str) -> Fraction:
    """The exact value of `2.5` or `1e-3`.

    Raises:
        ValueError: the text is not a number, or has too many digits or too large an exponent:
            the value of `1e999999999` would not fit into memory.
    """
    if _NUMBER.fullmatch(text) is None:
        raise ValueError(
            f"`{text[:80]}` is not a number of at most 60 digits with an exponent of at most 3 "
            "digits"
        )
    return Fraction(text)


def quantity(text: str) -> tuple[Dimension, Fraction] | None:
    """`5 cm` → its dimension, and its exact value 1/20 in base units; None if it is no quantity."""
    digits, *name = text.split(maxsplit=1) or [""]
    measure = unit(*name) if name else ONE
    try:
        return None if measure is None else (measure.dimension, number(digits) * measure.factor)
    except ValueError:
        return None


@lru_cache(maxsize=256)
def base_name(dimension: Dimension) -> str:
    """The base unit of a dimension: `m/s` for (1, 0, -1, 0, 0, 0); empty for a plain number."""
    numerator = [_power(b, n) for b, n in zip(_BASES, dimension, strict=True) if n > 0]
    denominator = [_power(b, -n) for b, n in zip(_BASES, dimension, strict=True) if n < 0]
    return "/".join(["*".join(numerator) or ("1" if denominator else ""), *denominator])


def _power(base: str, exponent: int) -> str:
    return base if exponent == 1 else f"{base}^{exponent}"


_SPLIT = re.compile(r"([0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)\s*(.*)")


def split(text: str) -> tuple[str, str]:
    """`1.5 m/s` → `1.5` and `m/s`.

    Raises:
        ValueError: the text does not begin with a digit.
    """
    match = _SPLIT.fullmatch(text.strip())
    if match is None:
        raise ValueError(f"`{text[:80]}` is not a quantity")
    return match[1], match[2]


_DURATION = re.compile(r"\s*(\d{1,30}(?:\.\d{1,30})?)\s*(ns|us|ms|s|min|h)\s*")


def nanoseconds(text: str) -> int | None:
    """`100 ms` → 100 000 000; None if it is no whole number of nanoseconds, or over 140 years."""
    match = _DURATION.fullmatch(text)
    if match is None:
        return None
    exact = Fraction(match[1]) * _UNITS[match[2]].factor * 10**9
    return int(exact) if exact.denominator == 1 and exact < 2**62 else None


_SPELT = {"mps": "m/s", "kph": "km/h", "kmh": "km/h", "rps": "rad/s", "degrees": "deg"}
"""Other names of units → the unit that they mean."""


def unknown_unit(name: str, span: Span) -> Diagnostic:
    """F306, with the nearest unit."""
    near = _SPELT.get(name) or suggestion(name, NAMES)
    examples = "m, cm, s, ms, rad, deg, m/s, rad/s, m/s^2, kg, A, V, Hz, %"
    return diagnostic(
        "unknown_unit",
        span,
        name=name,
        help=f"did you mean `{near}`?" if near else f"write a unit such as {examples}",
    )
