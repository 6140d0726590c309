"""The rows of a table: their cells as texts, and as JSON."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from decimal import Decimal
from functools import lru_cache
from typing import TextIO

from fretish.classes.frozen import dataclass

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,4})?")
_PLAIN = re.compile(r"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][+-]?[0-9]{1,4})?")
"""A number as JSON writes it."""
_UNKNOWN = {"", "null", "none", "na", "n/a", "nil"}
_WORDS = {"true": "true", "false": "false", "nan": '"NaN"'}
_INFINITE = {"inf": '"Infinity"', "infinity": '"Infinity"'}
_NOT_TEXT = re.compile(r"[\ud800-\udfff]")
"""Bytes that are not UTF-8."""


_quoted = lru_cache(4096)(json.dumps)


@dataclass(frozen=True, slots=True)
class Row:
    """One row."""

    line: int
    """The line of the file in which it ends, from 1."""
    texts: Sequence[str]
    """Its cells, in the order of the columns."""
    reason: str = ""
    """Why it cannot be read; empty: it can."""
    payload: bytes = b""
    """The whole row as a JSON object, if the file has it so."""
    values: Sequence[str | None] | None = None
    """Its cells as JSON, if the file has types; of each None: it is unknown."""

    @property
    def cells(self) -> Sequence[str | None]:
        """Its cells as JSON; of each None: it is unknown."""
        return [as_value(text) for text in self.texts] if self.values is None else self.values


def csv_rows(stream: TextIO, delimiter: str) -> Iterator[Row]:
    """The rows of a CSV file (RFC 4180), the line of names first."""
    reader = csv.reader(stream, delimiter=delimiter, strict=True)
    columns = 0
    while True:
        try:
            texts = next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            yield Row(reader.line_num, (), str(error))
            continue
        if not texts:
            continue
        columns = columns or len(texts)
        if len(texts) != columns:
            yield Row(reader.line_num, (), f"it has {len(texts)} of {columns} cells")
        elif not (line := "".join(texts)).isascii() and _NOT_TEXT.search(line):
            yield Row(reader.line_num, (), "it is not UTF-8")
        else:
            yield Row(reader.line_num, texts)


def json_rows(stream: TextIO) -> Iterator[Row]:
    """The objects of a file of JSON lines; the names of the first one come before them."""
    columns: tuple[str, ...] = ()
    for line, text in enumerate(stream, 1):
        if not text.strip():
            continue
        try:
            row = json.loads(text, parse_float=Decimal, parse_int=Decimal)
        except (ValueError, RecursionError):
            yield Row(line, (), "it is not JSON")
            continue
        if not isinstance(row, dict) or _NOT_TEXT.search(text):
            yield Row(line, (), "it is not a JSON object")
            continue
        if not columns:
            columns = tuple(row)
            yield Row(0, columns)
        yield Row(line, [str(row.get(name, "")) for name in columns], "", text.encode())


def as_json(names: Sequence[Sequence[str]], cells: Sequence[str | None]) -> bytes:
    """The cells of a row as a JSON object; an unknown one is left out.

    Args:
        names: for each cell the names of its field and of the objects around it; empty: left out.
        cells: the cells as JSON.
    """
    fields: dict[str, object] = {}
    for path, value in zip(names, cells, strict=True):
        if value is None or not path:
            continue
        inside = fields
        for name in path[:-1]:
            inside = inside.setdefault(name, {})  # type: ignore[assignment]
        inside[path[-1]] = value
    return _written(fields).encode()


def as_value(text: str) -> str | None:
    """A cell as JSON; None: it is unknown."""
    if _PLAIN.fullmatch(text):
        return text
    bare = text.strip()
    word = bare.lower()
    if word in _UNKNOWN:
        return None
    if word in _WORDS:
        return _WORDS[word]
    if word.lstrip("+-") in _INFINITE:
        return f'"-{_INFINITE["inf"][1:]}' if word.startswith("-") else _INFINITE["inf"]
    if _PLAIN.fullmatch(bare):
        return bare
    if _NUMBER.fullmatch(bare):
        return repr(float(bare))
    return _quoted(bare)


def _written(fields: Mapping[str, object]) -> str:
    inside = (
        f"{_quoted(name)}:{value if isinstance(value, str) else _written(value)}"  # type: ignore[arg-type]
        for name, value in fields.items()
    )
    return f"{{{','.join(inside)}}}"
