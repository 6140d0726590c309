"""The functions of computed signals: the units of their arguments, and of their results.

Their values are defined in `monitors/rounded_functions.py`; `clamp` is a `min` of a `max`. The
functions of every expression (`abs`, `min`, `max`, `pre`) are in `fretish.bindings.expressions`.
"""

from __future__ import annotations

from collections.abc import Mapping

from fretish import expressions as e
from fretish.classes.frozen import dataclass
from fretish.units import DIMENSIONLESS, METRE, Dimension, unit

_RADIAN = unit("rad")
assert _RADIAN is not None
ANGLE = _RADIAN.dimension


@dataclass(frozen=True, slots=True)
class Function:
    """A function of numbers.

    A dimension of None is free: all arguments have one dimension, which the result has, too.
    """

    form: str
    """A call: `atan2(y, x)`."""
    least: int
    """The least number of arguments."""
    most: int | None = None
    """The largest number of arguments; None: any."""
    argument: Dimension | None = None
    result: Dimension | None = None

    @property
    def takes(self) -> str:
        """The number of arguments in words."""
        if self.most is None:
            return f"{self.least} numbers or more"
        return "1 number" if self.least == 1 else f"{self.least} numbers"


def _function(
    form: str, argument: Dimension | None = None, result: Dimension | None = None
) -> Function:
    count = form.count(",") + 1
    is_open = form.endswith("...)")
    return Function(form, count - is_open, None if is_open else count, argument, result)


ROUNDED: Mapping[str, Function] = {
    "sqrt": _function("sqrt(x)"),
    "hypot": _function("hypot(x, y)"),
    "norm": _function("norm(x, ...)"),
    "sign": _function("sign(x)", result=DIMENSIONLESS),
    "floor": _function("floor(x)", DIMENSIONLESS, DIMENSIONLESS),
    "ceil": _function("ceil(x)", DIMENSIONLESS, DIMENSIONLESS),
    "exp": _function("exp(x)", DIMENSIONLESS, DIMENSIONLESS),
    "log": _function("log(x)", DIMENSIONLESS, DIMENSIONLESS),
    "sin": _function("sin(angle)", ANGLE, DIMENSIONLESS),
    "cos": _function("cos(angle)", ANGLE, DIMENSIONLESS),
    "tan": _function("tan(angle)", ANGLE, DIMENSIONLESS),
    "asin": _function("asin(x)", DIMENSIONLESS, ANGLE),
    "acos": _function("acos(x)", DIMENSIONLESS, ANGLE),
    "atan": _function("atan(x)", DIMENSIONLESS, ANGLE),
    "atan2": _function("atan2(y, x)", result=ANGLE),
    "wrap_angle": _function("wrap_angle(angle)", ANGLE, ANGLE),
    "yaw": _function("yaw(x, y, z, w)", DIMENSIONLESS, ANGLE),
    "pitch": _function("pitch(x, y, z, w)", DIMENSIONLESS, ANGLE),
    "roll": _function("roll(x, y, z, w)", DIMENSIONLESS, ANGLE),
    "angle_between": _function(
        "angle_between(x1, y1, z1, w1, x2, y2, z2, w2)", DIMENSIONLESS, ANGLE
    ),
    "haversine": _function("haversine(lat1, lon1, lat2, lon2)", ANGLE, METRE.dimension),
}
"""Functions whose result is a 64-bit float in base units; so are their arguments."""
MEMORY: Mapping[str, str] = {
    "rate": "rate(x)",
    "mean": "mean(x, over = 500 ms)",
    "max": "max(x, over = 500 ms)",
    "min": "min(x, over = 500 ms)",
    "count": "count(x, over = 500 ms)",
}
"""The functions with memory, each with a call."""
OVER = "over"
"""The name of the argument with the length of a window."""
CLAMP = "clamp"
OF_VALUES: Mapping[str, Function] = {CLAMP: _function("clamp(x, least, most)"), **ROUNDED}
"""All functions that only the `value` of a computed signal can call."""


def has_memory(part: e.Expression) -> bool:
    """Whether the part is a call of a function with memory: `max` is one only with `over`."""
    if not isinstance(part, e.Call) or part.name not in MEMORY:
        return False
    return part.name not in ("min", "max") or any(window(arg) is not None for arg in part.args)


def window(arg: e.Expression) -> e.Expression | None:
    """The value of the argument `over = 500 ms`; None: it is another argument."""
    match arg:
        case e.Comparison("=", e.Name(id), value) if id == OVER:
            return value
        case _:
            return None
