"""Reading tables of propositions: CSV with a header, or JSON lines; one row a tick."""

import csv
import io
import itertools
import json
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple, TextIO

from monitors.kernel.columns import Piece, code, pieces_of
from monitors.kernel.verdicts import Truth, same_length


class InputError(Exception):
    """A trace that cannot be read, with its place in words, on one line."""

    def __init__(self, text: str) -> None:
        super().__init__(visible(text))


def visible(text: str) -> str:
    """The text with control characters as escapes."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


_WORDS: "dict[str, Truth]" = {"": None, "0": False, "1": True, "false": False, "true": True}


def read_pieces(text: TextIO, names: "Sequence[str]", source: str) -> "Iterator[Piece]":
    """A table, in pieces: CSV with a header, or JSON lines where the first line is an object.

    Values are 0, 1, true, false, or nothing (null in JSON): unknown. A column `tick` may count
    the rows; it must grow by one from row to row. Other columns are passed over.

    Raises:
        InputError: a column is missing, a value is no truth value, ticks jump.
    """
    lines, number, is_json = _beginning(text, source)
    if is_json:
        rows = _in_order(_json_rows(lines, names, source, number), names)
        return pieces_of(_truths(rows, names))
    header, line = _header(lines, names, source, number)
    return _csv_pieces(text, header, names, source, line)


def placed_rows(
    text: "Iterable[str]", names: "Sequence[str]", source: str
) -> "Iterator[tuple[str, dict[str, Any]]]":
    """The rows of a table, each with its position; a column `tick` is checked.

    Raises:
        InputError: a column is missing, or `tick` does not increase by one.
    """
    lines, number, is_json = _beginning(text, source)
    if is_json:
        return _in_order(_json_rows(lines, names, source, number), names)
    header, line = _header(lines, names, source, number)
    return _in_order(_csv_rows(lines, header, source, line), names)


def _beginning(text: "Iterable[str]", source: str) -> "tuple[Iterator[str], int, bool]":
    """The lines from the first non-empty one, its number, and whether the table is JSON."""
    lines = iter(text)
    first = next(lines, "")  # It may begin with a byte order mark.
    lines = itertools.chain([first[1:] if first.startswith("\ufeff") else first], lines)
    number, first = next(((i, line) for i, line in enumerate(lines, 1) if line.strip()), (0, ""))
    if not number:
        raise InputError(f"{source}: the trace is empty")
    is_json = re.match(r'\s*\{\s*["}]', first) is not None
    return itertools.chain([first], lines), number, is_json


def _in_order(
    rows: "Iterable[tuple[str, dict[str, Any]]]", names: "Sequence[str]", tick: "int | None" = None
) -> "Iterator[tuple[str, dict[str, Any]]]":
    """The rows, after a check that a column `tick` increases by one."""
    has_tick: bool | None = None
    for location, row in rows:
        if "tick" not in names:
            if has_tick not in (None, "tick" in row):
                raise InputError(f"{location}: some rows have a `tick` and some have none")
            has_tick = "tick" in row
            if has_tick:
                tick = _next_tick(row["tick"], tick, location)
        yield location, row


def _truths(
    rows: "Iterable[tuple[str, dict[str, Any]]]", names: "Sequence[str]"
) -> "Iterator[tuple[Truth, ...]]":
    for location, row in rows:
        yield tuple([_truth(row[name], name, location) for name in names])


def _header(
    lines: "Iterable[str]", names: "Sequence[str]", source: str, number: int
) -> "tuple[list[str], int]":
    """The column names of a CSV header, and the number of its last line."""
    table = csv.reader(lines, strict=True)
    try:
        header = [name.strip() for name in next(table)]
    except csv.Error as error:
        raise InputError(f"{source}:{number - 1 + table.line_num}: {error}") from None
    _check_columns(header, names, f"{source}:{number}")
    return header, number - 1 + table.line_num


def _csv_rows(
    lines: "Iterable[str]", header: "Sequence[str]", source: str, before: int
) -> "Iterator[tuple[str, dict[str, Any]]]":
    """The rows of CSV below its header, of which so many lines are before these."""
    table = csv.reader(lines, strict=True)
    try:
        for values in table:
            location = f"{source}:{before + table.line_num}"
            if not values and len(header) > 1:
                continue  # an empty line; in a table of one column it is an unknown value
            values = values or [""]
            if len(values) != len(header):
                raise InputError(f"{location}: {len(values)} values for {len(header)} columns")
            yield location, dict(zip(header, values))
    except csv.Error as error:
        raise InputError(f"{source}:{before + table.line_num}: {error}") from None


def _json_rows(
    lines: "Iterable[str]", names: "Sequence[str]", source: str, first: int
) -> "Iterator[tuple[str, dict[str, Any]]]":
    for number, line in enumerate(lines, first):
        if not line.strip():
            continue
        try:
            row = _JSON.decode(line)
        except (ValueError, RecursionError) as error:
            raise InputError(f"{source}:{number}: not JSON: {error}") from None
        if not isinstance(row, dict):
            raise InputError(f"{source}:{number}: a line must hold one object")
        _check_columns(row, names, f"{source}:{number}")
        yield f"{source}:{number}", row


def _distinct(pairs: "list[tuple[str, Any]]") -> "dict[str, Any]":
    row = dict(pairs)
    if len(row) < len(pairs):
        raise ValueError("a key comes twice")
    return row


_JSON = json.JSONDecoder(object_pairs_hook=_distinct)


def _check_columns(keys: "Iterable[str]", names: "Sequence[str]", location: str) -> None:
    columns = list(keys)
    for name in names:
        if name not in columns:
            listing = _short(", ".join(columns)) or "none"
            raise InputError(f"{location}: there is no column `{name}`; there are {listing}")
    for name in (*names, "tick"):
        if columns.count(name) > 1:
            raise InputError(f"{location}: there are two columns `{name}`")


def _short(text: str) -> str:
    """The text, shortened for a message."""
    return text if len(text) <= _ROOM else f"{text[:_ROOM]}..."


_ROOM = 200


def _truth(value: Any, name: str, location: str) -> Truth:
    if value is None or isinstance(value, bool):
        return value
    word = str(value).strip().lower()
    if word not in _WORDS:
        raise InputError(
            f"{location}: column `{name}`: `{_short(str(value))}` is no truth value; "
            "write 0, 1, true, false, or nothing for unknown"
        )
    return _WORDS[word]


def _next_tick(value: Any, before: "int | None", location: str) -> int:
    text = str(value)
    if not _WHOLE.fullmatch(text):
        raise InputError(f"{location}: column `tick`: `{_short(text)}` is no whole number")
    tick = int(text)
    if before is not None and tick != before + 1:
        fault = "goes back" if tick <= before else "leaves ticks out"
        raise InputError(f"{location}: column `tick` {fault}: {before}, then {tick}")
    return tick


_WHOLE = re.compile(r"\s*-?[0-9]{1,18}\s*")


# Whole pieces of CSV, where they are unambiguous ----------------------------------------------

_CHARACTERS, _MOST_CHARACTERS = 1 << 12, 1 << 22
"""Characters of a piece per column, and the largest number; a piece ends at the end of a line."""


class _Block(NamedTuple):
    """The lines of a text, as a piece of the trace."""

    lines: int
    tick: "int | None"
    """In the last row, by the column `tick`."""
    piece: Piece


def _csv_pieces(
    text: TextIO, header: "Sequence[str]", names: "Sequence[str]", source: str, line: int
) -> "Iterator[Piece]":
    """CSV below its header, which ends in that line.

    Where a piece is ambiguous it is read row by row, and so is all that follows: that is slower,
    and finds what is wrong, and where.
    """
    tick: int | None = None
    size = min(_CHARACTERS * len(header), _MOST_CHARACTERS)
    while part := text.read(size) + text.readline():
        try:
            block = _block(part, header, names, tick)
        except (csv.Error, KeyError, ValueError):
            lines = itertools.chain(io.StringIO(part, newline=""), text)
            rows = _in_order(_csv_rows(lines, header, source, line), names, tick)
            yield from pieces_of(_truths(rows, names))
            return
        line, tick = line + block.lines, block.tick
        yield block.piece


def _block(
    part: str, header: "Sequence[str]", names: "Sequence[str]", tick: "int | None"
) -> _Block:
    """Whole lines of CSV, which follow the row with that tick.

    Raises:
        csv.Error, KeyError, ValueError: the lines are ambiguous.
    """
    width, has_tick = len(header), "tick" in header and "tick" not in names
    codes = None if has_tick else _at_once(part, width)
    if codes:
        named = dict(zip(header, codes))
        rows = len(codes[0])
        return _Block(rows, None, Piece(rows, [named[name] for name in names]))
    table = csv.reader(io.StringIO(part, newline=""), strict=True)
    values = [row or [""] for row in table if row or width == 1]
    same_length(header, *values)
    columns = list(zip(*values)) or [()] * width
    cells = dict(zip(header, columns))
    if has_tick:
        tick = _last_tick(cells["tick"], tick)
    piece = Piece(len(values), [_codes(cells[name]) for name in names])
    return _Block(table.line_num, tick, piece)


def _at_once(part: str, width: int) -> "list[bytes] | None":
    """The codes of every column, if each cell is 0, 1, true, false or empty, without quotes."""
    text = part.encode()
    text = text.replace(b"\r\n", b"\n") if b"\r" in text else text
    text = text if text.endswith(b"\n") else text + b"\n"
    cells = width * text.count(b"\n")
    separators, values = (b"," * (width - 1) + b"\n") * (cells // width), b"01"
    if len(text) != 2 * cells:
        # No word arises from what is put in for another: so no other cell becomes one digit.
        text = text.lower().replace(b"true", b"1").replace(b"false", b"0")
        if text.translate(None, b"01") != separators:
            return None
        text = text.replace(b"\n", b",")
        text = b"2" + text if text.startswith(b",") else text
        for _ in range(2):  # the second of two empty cells shares a comma with the first
            text = text.replace(b",,", b",2,")
        separators, values = b"," * cells, b"012"
    digits = text[::2]
    if text[1::2] != separators or digits.strip(values):
        return None
    codes = digits.translate(_CODES)
    return [codes[index::width] for index in range(width)]


_CODES = bytes.maketrans(b"012", b"\0\1\2")


def _codes(words: "Sequence[str]") -> bytes:
    """The codes of truth values."""
    known = {word: code(_WORDS[word.strip().lower()]) for word in set(words)}
    return bytes(map(known.__getitem__, words))


def _last_tick(words: "Sequence[str]", before: "int | None") -> "int | None":
    """The last tick, if ticks increase by one and have no leading zeros; else None."""
    if not words:
        return before
    if not (_WHOLE.fullmatch(words[0]) and _WHOLE.fullmatch(words[-1])):
        raise ValueError
    first = int(words[0]) if before is None else before + 1
    after = first + len(words)
    if list(map(str.strip, words)) != list(map(str, range(first, after))):
        raise ValueError
    return after - 1
