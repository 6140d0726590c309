"""The fields of messages that a signal can read: numbers, truth values and texts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from enum import StrEnum

from fretish.classes.frozen import dataclass


class FieldKind(StrEnum):
    """The kind of a field."""

    NUMBER = "number"
    FLAG = "flag"
    """True or false."""
    TEXT = "text"


@dataclass(frozen=True, slots=True)
class Leaf:
    """A field, or the elements of one."""

    kind: FieldKind
    names: Mapping[str, int] = field(default_factory=dict)
    """The names of its numbers in the definition of the messages."""


Leaves = Mapping[str, Leaf]
"""Fields by their paths: `a.b`, and `a.c[:]` for an array of numbers."""


def numbers(leaves: Leaves) -> tuple[str, ...]:
    """The paths of all numbers and truth values."""
    return tuple(path for path, leaf in leaves.items() if leaf.kind is not FieldKind.TEXT)
