"""Type descriptions against rosbags, which has hashes and texts of its own for the same types."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from fretc.logs.messages.definitions import DefinitionError, short, types
from fretc.logs.messages.type_descriptions import (
    DescribedField,
    DescribedType,
    definition,
    type_hash,
)
from tests.effort import some

NUMBERS = {
    "int8": 2, "uint8": 3, "char": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8,
    "uint64": 9, "float32": 10, "float64": 11, "bool": 15, "octet": 16, "byte": 16, "string": 17,
    "wstring": 18,
}  # fmt: skip
"""The numbers of REP 2016."""


def store() -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def described(store: Any, name: str) -> DescribedType:
    """A type of rosbags, as a node describes it."""
    return DescribedType(name, tuple(_field(each, kind) for each, kind in store.fielddefs[name][1]))


def _field(name: str, kind: Any) -> DescribedField:
    from rosbags.interfaces import Nodetype

    node, about = kind
    if node is Nodetype.BASE:
        base, most = about
        number = NUMBERS[base] + (4 if base == "string" and most else 0)
        return DescribedField(name, number, 0, most, "")
    if node is Nodetype.NAME:
        return DescribedField(name, 1, 0, 0, about)
    element, count = about
    inner = _field(name, element)
    more = 48 if node is Nodetype.ARRAY else 96 if count else 144
    return replace(inner, type_id=inner.type_id + more, capacity=count)


def is_empty(described: DescribedType) -> bool:
    """Whether a message has no field of its own: texts leave out the one that it has for that."""
    names = [field.name for field in described.fields]
    return names in ([], ["structure_needs_at_least_one_member"])


def has_char(store: Any, name: str) -> bool:
    """Whether a message has `char`: for arrays of it, the hash of rosbags is not that of ROS 2."""
    return "'char'" in repr(store.fielddefs[name])


def within(store: Any, name: str) -> Iterator[str]:
    """The names of all types that are in a type, sorted."""
    names, waiting = set[str](), [name]
    while waiting:
        for field in described(store, waiting.pop()).fields:
            if field.nested_type_name and field.nested_type_name not in names:
                names.add(field.nested_type_name)
                waiting.append(field.nested_type_name)
    return iter(sorted(names))


def test_hash_and_fields_are_those_of_the_standard_types() -> None:
    known = store()
    compared = 0
    for name in some(sorted(known.fielddefs), 5):
        main = described(known, name)
        parts = [described(known, each) for each in within(known, name)]
        if any(is_empty(part) or has_char(known, part.name) for part in (main, *parts)):
            continue
        assert type_hash(main, parts) == known.hash_rihs01(name), name
        theirs = str(known.generate_msgdef(name, ros_version=2)[0])
        try:
            expected = types(name, theirs, ros1=False)
        except DefinitionError:
            with pytest.raises(DefinitionError):
                types(name, definition(main, parts), ros1=False)
            continue
        ours = types(name, definition(main, parts), ros1=False)
        assert ours[short(name)] == expected[short(name)], name
        for part in parts:
            assert ours[short(part.name)] == expected[short(part.name)], (name, part.name)
        compared += 1
    assert compared > 20


def test_any_change_of_a_field_changes_the_hash() -> None:
    field = DescribedField("x", 10, 0, 0, "")
    whole = DescribedType("a/msg/B", (field,))
    others = [
        replace(field, name="y"),
        replace(field, type_id=11),
        replace(field, capacity=1),
        replace(field, string_capacity=1),
        replace(field, nested_type_name="a/msg/C"),
    ]
    hashes = {type_hash(replace(whole, fields=(each,)), ()) for each in (field, *others)}
    hashes |= {type_hash(replace(whole, name="a/msg/C"), ()), type_hash(whole, (whole,))}
    assert len(hashes) == 8


@pytest.mark.parametrize(
    "field",
    [
        DescribedField("x\nuint8 y", 3, 0, 0, ""),
        DescribedField("", 3, 0, 0, ""),
        DescribedField("x", 1, 0, 0, "a/msg/B\nuint8 z"),
        DescribedField("x", 1, 0, 0, "a/srv/B"),
        DescribedField("x", 0, 0, 0, ""),
        DescribedField("x", 12, 0, 0, ""),
        DescribedField("x", 195, 0, 0, ""),
    ],
)
def test_a_name_or_number_that_ros_does_not_have_is_refused(field: DescribedField) -> None:
    with pytest.raises(DefinitionError):
        definition(DescribedType("a/msg/A", (field,)), ())
    kind = random.Random(1).choice([3, 10])
    assert definition(DescribedType("a/msg/A", (DescribedField("x", kind, 0, 0, ""),)), ())
