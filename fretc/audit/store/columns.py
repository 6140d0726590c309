"""Columns of a table from the types of records: conversion of values to columns and back.

A column reports values that it cannot hold exactly (a time beyond 64 bits, a whole number in a
column of real numbers); they are stored as text beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import accumulate, chain, pairwise
from math import inf
from operator import attrgetter
from typing import Any, Protocol

import pyarrow as pa

from compiler.files.checked_json import LARGEST_COUNT, LEAST
from compiler.files.records import UNSET, types

_INFINITE = {"+inf": inf, "-inf": -inf}
_INFINITE_WORDS = {inf: "+inf", -inf: "-inf"}


class InexactError(ValueError):
    """A column cannot hold a value exactly."""


class ArrowColumn(Protocol):
    """The conversion of one kind of value between Python and Arrow. None and `UNSET` are null."""

    @property
    def type(self) -> pa.DataType:
        """The type in Arrow."""

    def array(self, values: Sequence[Any], *, exact: bool) -> pa.Array:
        """The values as an Arrow array.

        Args:
            values: values of records.
            exact: raise an error instead of the nearest value.

        Raises:
            InexactError: a value cannot be held.
        """

    def values(self, array: pa.Array) -> list[Any]:
        """Plain values, as in JSON; None for null."""


# Single values ---------------------------------------------------------------------------------


def _kinds(values: Sequence[Any]) -> set[type]:
    return {*map(type, values)}


@dataclass(frozen=True, slots=True)
class Text:
    """A text, or one of some enumeration values."""

    @property
    def type(self) -> pa.DataType:
        """The type of texts."""
        return pa.string()

    def array(self, values: Sequence[Any], *, exact: bool) -> pa.Array:
        """The texts as an array; an unpaired surrogate, as in some file names, cannot be held."""
        if type(UNSET) in _kinds(values):
            values = [None if value is UNSET else value for value in values]
        try:
            return pa.array(values, self.type)
        except UnicodeEncodeError as error:
            if exact:
                raise InexactError from error
        known = [value and value.encode("utf-8", "replace").decode() for value in values]
        return pa.array(known, self.type)

    def values(self, array: pa.Array) -> list[Any]:
        """Texts."""
        return array.to_pylist()  # type: ignore[no-any-return]


@dataclass(frozen=True, slots=True)
class Flag:
    """True or false."""

    @property
    def type(self) -> pa.DataType:
        """The type of truth values."""
        return pa.bool_()

    def array(self, values: Sequence[Any], *, exact: bool) -> pa.Array:
        """The truth values as an array, always exact."""
        return pa.array(values, self.type)

    def values(self, array: pa.Array) -> list[Any]:
        """Truth values."""
        return array.to_pylist()  # type: ignore[no-any-return]


@dataclass(frozen=True, slots=True)
class Whole:
    """A whole number of 64 bits."""

    @property
    def type(self) -> pa.DataType:
        """The type of whole numbers of 64 bits."""
        return pa.int64()

    def array(self, values: Sequence[Any], *, exact: bool) -> pa.Array:
        """The numbers as an array; without `exact` a larger number becomes null."""
        try:
            return pa.array(values, self.type)
        except OverflowError as error:
            if exact:
                raise InexactError from error
        fits = (None if v is None or not LEAST <= v <= LARGEST_COUNT else v for v in values)
        return pa.array(list(fits), self.type)

    def values(self, array: pa.Array) -> list[Any]:
        """Whole numbers."""
        return array.to_pylist()  # type: ignore[no-any-return]


@dataclass(frozen=True, slots=True)
class Real:
    """A number, which may be infinite if its type has words for infinity."""

    @property
    def type(self) -> pa.DataType:
        """The type of numbers of 64 bits."""
        return pa.float64()

    def array(self, values: Sequence[Any], *, exact: bool) -> pa.Array:
        """The numbers as an array; whole numbers cannot be held, because `1` is not `1.0`."""
        kinds = _kinds(values)
        if exact and int in kinds:
            raise InexactError
        if kinds & {int, str}:
            values = [
                None if value is None else float(_INFINITE.get(value, value)) for value in values
            ]
        return pa.array(values, self.type)

    def values(self, array: pa.Array) -> list[Any]:
        """Numbers, and the words for infinite ones."""
        found = array.to_pylist()
        if inf in found or -inf in found:
            return [_INFINITE_WORDS.get(value, value) for value in found]
        return found  # type: ignore[no-any-return]


# Composite values -------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a record."""

    name: str
    """The name in the file."""
    attribute: str
    """The path of attributes to the field."""
    column: ArrowColumn
    absent: bool = False
    """Whether null means that the key is left out."""

    def below(self, path: str) -> Field:
        """The field as part of a nested record."""
        return replace(self, attribute=f"{path}.{self.attribute}")

    def array(self, records: Sequence[Any], *, exact: bool) -> pa.Array:
        """The column of the field in these records."""
        return self.column.array([*map(attrgetter(self.attribute), records)], exact=exact)


@dataclass(frozen=True, slots=True)
class Struct:
    """A record, or null."""

    fields: tuple[Field, ...]

    @property
    def type(self) -> pa.DataType:
        """A struct with a field for each field of the record."""
        return pa.struct([pa.field(field.name, field.column.type) for field in self.fields])

    def array(self, values: Sequence[Any], *, exact: bool) -> pa.Array:
        """The records as an array."""
        null = [value is None or value is UNSET for value in values]
        if not any(null):
            parts = [field.array(values, exact=exact) for field in self.fields]
            return pa.StructArray.from_arrays(parts, fields=[*self.type])
        there = [value for value, no in zip(values, null, strict=True) if not no]
        places = iter(range(len(there)))
        rows = pa.array([None if no else next(places) for no in null], pa.int64())
        parts = [field.array(there, exact=exact).take(rows) for field in self.fields]
        return pa.StructArray.from_arrays(parts, fields=[*self.type], mask=pa.array(null))

    def values(self, array: pa.Array) -> list[Any]:
        """Objects with their keys."""
        records = objects(self.fields, array.flatten())
        if not array.null_count:
            return records
        valid = array.is_valid().to_pylist()
        return [each if is_there else None for each, is_there in zip(records, valid, strict=True)]


def objects(fields: Sequence[Field], arrays: Sequence[pa.Array]) -> list[Any]:
    """An object for each row."""
    names = [field.name for field in fields]
    parts = [each.column.values(array) for each, array in zip(fields, arrays, strict=True)]
    rows = [dict(zip(names, row, strict=True)) for row in zip(*parts, strict=True)]
    for name in (field.name for field in fields if field.absent):
        for row in rows:
            if row[name] is None:
                del row[name]
    return rows


@dataclass(frozen=True, slots=True)
class Items:
    """A list of values of one kind."""

    item: ArrowColumn

    @property
    def type(self) -> pa.DataType:
        """A list."""
        return pa.list_(self.item.type)

    def array(self, values: Sequence[Any], *, exact: bool) -> pa.Array:
        """The lists as an array."""
        offsets = _offsets(values)
        inner = self.item.array(_flat(values), exact=exact)
        return pa.ListArray.from_arrays(offsets, inner, type=self.type)

    def values(self, array: pa.Array) -> list[Any]:
        """Lists."""
        return _cut(array, self.item.values(array.flatten()))


@dataclass(frozen=True, slots=True)
class Entries:
    """A map from names to values."""

    item: ArrowColumn

    @property
    def type(self) -> pa.DataType:
        """A map."""
        return pa.map_(pa.string(), self.item.type)

    def array(self, values: Sequence[Any], *, exact: bool) -> pa.Array:
        """The maps as an array."""
        keys = Text().array(_flat(values), exact=exact)
        rows = [value.values() for value in values if value]
        items = self.item.array([*chain.from_iterable(rows)], exact=exact)
        return pa.MapArray.from_arrays(_offsets(values), keys, items, type=self.type)

    def values(self, array: pa.Array) -> list[Any]:
        """Objects."""
        entry = pa.struct([pa.field("key", pa.string(), False), ("value", self.item.type)])
        array = array.cast(pa.list_(entry))
        keys, items = array.flatten().flatten()
        pairs = [*zip(keys.to_pylist(), self.item.values(items), strict=True)]
        rows = _cut(array, pairs)
        found = [None if row is None else dict(row) for row in rows]
        if sum(map(len, filter(None, found))) != len(pairs):
            raise InexactError("a name occurs twice")
        return found


def _offsets(values: Sequence[Any]) -> pa.Array:
    lengths = (len(value) if value else 0 for value in values)
    ends = [*accumulate(lengths, initial=0)]
    if None not in values and UNSET not in values:
        return pa.array(ends, pa.int32())
    starts = [
        None if value is None or value is UNSET else end
        for value, end in zip(values, ends, strict=False)
    ]
    return pa.array([*starts, ends[-1]], pa.int32())


def _flat(values: Sequence[Any]) -> list[Any]:
    return [*chain.from_iterable(value for value in values if value)]


def _cut(array: pa.Array, items: Sequence[Any]) -> list[Any]:
    """The items of each list; None for null."""
    lengths = array.value_lengths().to_pylist()
    ends = accumulate((length or 0 for length in lengths), initial=0)
    return [
        None if length is None else items[start:end]
        for length, (start, end) in zip(lengths, pairwise(ends), strict=True)
    ]


@dataclass(frozen=True, slots=True)
class Tuple:
    """A tuple of values, each of its own kind."""

    items: tuple[ArrowColumn, ...]

    @property
    def type(self) -> pa.DataType:
        """A struct with numbers for names."""
        return pa.struct([(f"{n + 1}", item.type) for n, item in enumerate(self.items)])

    def array(self, values: Sequence[Any], *, exact: bool) -> pa.Array:
        """The tuples as an array; no tuple is null."""
        columns = zip(*values, strict=True) if values else [()] * len(self.items)
        parts = [
            item.array(column, exact=exact)
            for item, column in zip(self.items, columns, strict=True)
        ]
        return pa.StructArray.from_arrays(parts, fields=[*self.type])

    def values(self, array: pa.Array) -> list[Any]:
        """Lists."""
        parts = zip(self.items, array.flatten(), strict=True)
        return [*map(list, zip(*(item.values(part) for item, part in parts), strict=True))]


@dataclass(frozen=True, slots=True)
class NumberOrWord:
    """A number or a word."""

    @property
    def type(self) -> pa.DataType:
        """A struct of both; both are null if the value is unknown."""
        return pa.struct([("number", pa.float64()), ("word", pa.string())])

    def array(self, values: Sequence[Any], *, exact: bool) -> pa.Array:
        """The values as an array."""
        numbers = [None if isinstance(value, str) else value for value in values]
        words = [value if isinstance(value, str) else None for value in values]
        parts = [Real().array(numbers, exact=exact), Text().array(words, exact=exact)]
        return pa.StructArray.from_arrays(parts, fields=[*self.type])

    def values(self, array: pa.Array) -> list[Any]:
        """Numbers and texts."""
        numbers, words = array.flatten()
        pairs = zip(numbers.to_pylist(), words.to_pylist(), strict=True)
        return [number if word is None else word for number, word in pairs]


# Columns of types -------------------------------------------------------------------------------


@cache
def fields_of(record: type) -> tuple[Field, ...]:
    """A column for each field of a record, by its name in the file."""
    return _fields(types.type_info(record))


def _fields(kind: Any) -> tuple[Field, ...]:
    return tuple(
        Field(field.encode_name, field.name, column_of(field.type), not field.required)
        for field in kind.fields
    )


def column_of(kind: Any) -> ArrowColumn:
    """The column for a type, as `types.type_info` describes it."""
    options = _options(kind)
    names = {type(option) for option in options}
    if names == {types.FloatType, types.StrType}:
        return NumberOrWord()
    if types.FloatType in names:
        return Real()
    (one,) = options
    match one:
        case types.IntType():
            return Whole()
        case types.BoolType():
            return Flag()
        case types.StrType() | types.LiteralType():
            return Text()
        case types.StructType() | types.DataclassType():
            return Struct(_fields(one))
        case types.VarTupleType(item_type=item):
            return Items(column_of(item))
        case types.TupleType(item_types=items):
            return Tuple(tuple(map(column_of, items)))
        case types.DictType(value_type=item):
            return Entries(column_of(item))
        case _:
            raise AssertionError(f"no column holds {one}")


def _options(kind: Any) -> list[Any]:
    """The kinds of values other than null; a number may be whole."""
    while isinstance(kind, types.Metadata):
        kind = kind.type
    if not isinstance(kind, types.UnionType):
        return [kind]
    options = [option for inner in kind.types for option in _options(inner)]
    present = [option for option in options if not isinstance(option, types.NoneType)]
    has_point = any(isinstance(each, types.FloatType) for each in present)
    return [each for each in present if not (has_point and isinstance(each, types.IntType))]
