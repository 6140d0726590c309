"""The functions of computed signals: 64-bit floats in base units (metres, radians, seconds).

An audit computes with these functions, too. NaN is unknown: the result of an unknown argument, and
of an argument for which the function is not defined. A result beyond 64-bit floats is infinite. The
text of this module is copied into emitted nodes: it needs the standard library only.
"""

import math
from collections.abc import Callable, Mapping

from monitors.kernel.readings import Constant, Reading, Term

_EARTH = 6371008.8
"""The mean radius of the Earth in metres: R1 of the International Union of Geodesy."""
_TURN = 2 * math.pi


def rounded(name: str, *args: Term) -> Reading:
    """The value of a function; None: unknown."""
    value = ROUNDED_FUNCTIONS[name](*map(_float, args))
    return None if math.isnan(value) else value


def _float(term: Term) -> float:
    if isinstance(term, Constant):
        return term.double
    return math.nan if term is None else float(term)


def _norm(*numbers: float) -> float:
    total = 0.0
    for number in numbers:
        total += number * number
    return math.sqrt(total)


def _sign(x: float) -> float:
    return x if math.isnan(x) else float((x > 0) - (x < 0))


def _to_whole(function: "Callable[[float], int]") -> "Callable[[float], float]":
    return lambda x: float(function(x)) if math.isfinite(x) else x


def _defined(function: "Callable[[float], float]") -> "Callable[[float], float]":
    """NaN where the function is not defined."""

    def value(x: float) -> float:
        try:
            return function(x)
        except ValueError:
            return math.nan

    return value


def _exp(x: float) -> float:
    try:
        return math.exp(x)
    except OverflowError:
        return math.inf


def _wrap_angle(angle: float) -> float:
    if not math.isfinite(angle):
        return math.nan
    turned = math.remainder(angle, _TURN)
    return math.pi if turned <= -math.pi else turned


def _yaw(x: float, y: float, z: float, w: float) -> float:
    return _direction(2 * (w * z + x * y), w * w + x * x - y * y - z * z, x, y, z, w)


def _roll(x: float, y: float, z: float, w: float) -> float:
    return _direction(2 * (w * x + y * z), w * w - x * x - y * y + z * z, x, y, z, w)


def _direction(up: float, along: float, *quaternion: float) -> float:
    return math.atan2(up, along) if _is_rotation(*quaternion) else math.nan


def _pitch(x: float, y: float, z: float, w: float) -> float:
    if not _is_rotation(x, y, z, w):
        return math.nan
    sine = 2 * (w * y - x * z) / (x * x + y * y + z * z + w * w)
    return math.asin(max(-1.0, min(1.0, sine)))


def _is_rotation(*quaternion: float) -> bool:
    """Whether the squared length of a quaternion is a number above 0."""
    return 0 < sum(part * part for part in quaternion) < math.inf


def _angle_between(*numbers: float) -> float:
    (a, b, c, d), (e, f, g, h) = numbers[:4], numbers[4:]
    if not _is_rotation(a, b, c, d) or not _is_rotation(e, f, g, h):
        return math.nan
    x, y = d * e - a * h - b * g + c * f, d * f + a * g - b * h - c * e
    z, w = d * g - a * f + b * e - c * h, d * h + a * e + b * f + c * g
    across = _norm(x, y, z)
    return 2 * math.atan2(across, abs(w)) if math.isfinite(across) else math.nan


def _haversine(lat1: float, lon1: float, lat2: float, lon2: float) -> float:
    if not all(map(math.isfinite, (lat1, lon1, lat2, lon2))):
        return math.nan
    north, east = math.sin((lat2 - lat1) / 2), math.sin((lon2 - lon1) / 2)
    share = north * north + math.cos(lat1) * math.cos(lat2) * east * east
    return 2 * _EARTH * math.asin(math.sqrt(max(0.0, min(1.0, share))))


ROUNDED_FUNCTIONS: "Mapping[str, Callable[..., float]]" = {
    "sqrt": _defined(math.sqrt),
    "hypot": _norm,
    "norm": _norm,
    "sign": _sign,
    "floor": _to_whole(math.floor),
    "ceil": _to_whole(math.ceil),
    "exp": _exp,
    "log": _defined(math.log),
    "sin": _defined(math.sin),
    "cos": _defined(math.cos),
    "tan": _defined(math.tan),
    "asin": _defined(math.asin),
    "acos": _defined(math.acos),
    "atan": math.atan,
    "atan2": math.atan2,
    "wrap_angle": _wrap_angle,
    "yaw": _yaw,
    "pitch": _pitch,
    "roll": _roll,
    "angle_between": _angle_between,
    "haversine": _haversine,
}
"""Name -> function of floats; no function raises an error."""
