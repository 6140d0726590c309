"""A command that a core can store, pass on or drop, but not inspect.

A proof with such a command in place of a velocity holds for every velocity.
"""

from __future__ import annotations

from typing import Any, NoReturn


class InspectedError(Exception):
    """The code has inspected a command."""


def _inspected(*_: object, **__: object) -> NoReturn:
    raise InspectedError


class Opaque:
    """A value that only `is` can distinguish, which no pure core uses."""

    __slots__ = ()


for _name in (
    "__getattribute__ __eq__ __ne__ __lt__ __le__ __gt__ __ge__ __bool__ __len__ __iter__ "
    "__contains__ __getitem__ __hash__ __add__ __radd__ __sub__ __rsub__ __mul__ __rmul__ "
    "__truediv__ __rtruediv__ __floordiv__ __rfloordiv__ __mod__ __rmod__ __pow__ __rpow__ "
    "__matmul__ __rmatmul__ __neg__ __pos__ __abs__ __invert__ __round__ __index__ __int__ "
    "__float__ __complex__ __bytes__ __str__ __repr__ __format__ __call__"
).split():
    setattr(Opaque, _name, _inspected)


def is_opaque(value: Any) -> bool:
    """Whether the value is opaque; it is not inspected."""
    return type(value) is Opaque


def is_zero(value: Any, velocity: type[tuple[Any, ...]]) -> bool:
    """Whether the value is a velocity of zeros; opaque values are not inspected.

    Zeros are floats: ROS 2 takes no other numbers, and integers add up differently beyond 2^53.
    """
    return type(value) is velocity and all(type(part) is float and part == 0 for part in value)
