"""`dataclass` of the standard library, at a seventh of its cost at each start.

The standard library compiles six methods for each frozen class when the class is defined. A command
defines some 300 classes, which took a third of its time. Here the fields come from the standard
library, `__init__`, `__eq__` and `__hash__` are compiled when they are first used, and the other
methods are shared.

Only frozen classes with slots differ. Their values are as fast as those of the standard library,
and work with `fields`, `replace`, `asdict`, `match`, `copy` and `pickle`.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(cls=None, /, **options):
        """What `dataclasses.dataclass` returns for these options."""
        if options != {"frozen": True, "slots": True}:
            return dataclasses.dataclass(cls, **options)
        return _frozen if cls is None else _frozen(cls)


_fields_and_slots = dataclasses.dataclass(init=False, repr=False, eq=False, slots=True)


def _frozen(made: type) -> type:
    """The class with slots and the methods that a frozen dataclass has.

    As in the standard library, a method that the class itself defines stays.

    Raises:
        TypeError: a base is a frozen dataclass of the standard library.
    """
    made.__doc__ = made.__doc__ or made.__name__  # else the standard library writes a signature
    cls: type = _fields_and_slots(made)
    own = {name for name, value in cls.__dict__.items() if value is not None}
    later = {name: _at_first_use(cls, name) for name in _TEXTS}
    for name, method in {**_SHARED, **later}.items():
        if name not in own:  # `__eq__` alone makes `__hash__` None
            setattr(cls, name, method)
    return cls


def _at_first_use(cls: Any, name: str) -> Callable[..., Any]:
    """A method that compiles the real one, and puts it in its own place."""

    def first(self: object, /, *values: object, **named: object) -> Any:
        text, scope = _TEXTS[name](cls)
        exec(text, scope)
        method = scope[name]
        method.__qualname__ = f"{cls.__qualname__}.{name}"
        setattr(cls, name, method)
        return method(self, *values, **named)

    return first


_Written = tuple[str, dict[str, Any]]
"""The text of a method, and the names that it uses."""


def _initializer(cls: Any) -> _Written:
    scope: dict[str, Any] = {"_set": object.__setattr__, "_missing": dataclasses.MISSING}
    parameters, lines = ["self"], []
    for each in dataclasses.fields(cls):
        assert not each.kw_only
        name = value = parameter = each.name
        default = f"_default_{name}"
        if each.default_factory is not dataclasses.MISSING:
            scope[default] = each.default_factory
            parameter = f"{name}=_missing"
            value = f"{default}() if {name} is _missing else {name}"
        elif each.default is not dataclasses.MISSING:
            scope[default] = each.default
            parameter = f"{name}={default}"
        if each.init:
            parameters.append(parameter)
        else:
            value = f"{default}()"
        lines.append(f"_set(self, {name!r}, {value})")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    return f"def __init__({', '.join(parameters)}):\n " + "\n ".join(lines or ["pass"]), scope


def _equality(cls: Any) -> _Written:
    same = f"{_content(cls, 'self')} == {_content(cls, 'other')}"
    return (
        "def __eq__(self, other):\n"
        f" return {same} if other.__class__ is self.__class__ else NotImplemented"
    ), {}


def _hash(cls: Any) -> _Written:
    return f"def __hash__(self):\n return hash({_content(cls, 'self')})", {}


def _content(cls: Any, value: str) -> str:
    """The tuple of the fields by which values are compared."""
    return (
        f"({''.join(f'{value}.{each.name}, ' for each in dataclasses.fields(cls) if each.compare)})"
    )


_TEXTS: dict[str, Callable[[type], _Written]] = {
    "__init__": _initializer,
    "__eq__": _equality,
    "__hash__": _hash,
}
"""The methods that values need often, each with the text that the standard library writes."""


@recursive_repr()
def _text(self: Any) -> str:
    shown = (each.name for each in dataclasses.fields(self) if each.repr)
    parts = (f"{name}={getattr(self, name)!r}" for name in shown)
    return f"{self.__class__.__qualname__}({', '.join(parts)})"


def _refuse_change(_self: object, name: str, _value: object) -> None:
    raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")


def _refuse_deletion(_self: object, name: str) -> None:
    raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")


def _state(self: Any) -> list[object]:
    return [getattr(self, each.name) for each in dataclasses.fields(self)]


def _set_state(self: Any, state: list[object]) -> None:
    for each, value in zip(dataclasses.fields(self), state, strict=True):
        object.__setattr__(self, each.name, value)


_SHARED: dict[str, Callable[..., object]] = {
    "__repr__": _text,
    "__setattr__": _refuse_change,
    "__delattr__": _refuse_deletion,
    "__getstate__": _state,
    "__setstate__": _set_state,
}
