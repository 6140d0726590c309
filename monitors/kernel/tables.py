"""Reading tables of propositions: CSV with a header, or JSON lines; one row a tick."""

import csv
import itertools
import json
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from monitors.kernel.verdicts import Truth


class InputError(Exception):
    """A trace that cannot be read, with its place in words, on one line."""

    def __init__(self, text: str) -> None:
        super().__init__(visible(text))


def visible(text: str) -> str:
    """What would move the cursor, or begin another line, as escapes."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


_WORDS: dict[str, Truth] = {"": None, "0": False, "1": True, "false": False, "true": True}


def read_rows(
    text: Iterable[str], names: Sequence[str], source: str
) -> Iterator[tuple[Truth, ...]]:
    """The rows of a table: CSV with a header, or JSON lines where the first line is an object.

    Values are 0, 1, true, false, or nothing (null in JSON): unknown. A column `tick` may count
    the rows; it must grow by one from row to row. Other columns are passed over.

    Raises:
        InputError: a column is missing, a value is no truth value, ticks jump.
    """
    for place, row in placed_rows(text, names, source):
        yield tuple(_truth(row[name], name, place) for name in names)


def placed_rows(
    text: Iterable[str], names: Sequence[str], source: str
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Each row with its place, by its columns; a column `tick` is held to its rule.

    Raises:
        InputError: a column is missing, ticks jump.
    """
    lines = iter(text)
    lines = itertools.chain([next(lines, "").removeprefix("\ufeff")], lines)
    number, first = next(((i, line) for i, line in enumerate(lines, 1) if line.strip()), (0, ""))
    if not number:
        raise InputError(f"{source}: the trace is empty")
    lines = itertools.chain([first], lines)
    is_json = re.match(r'\s*\{\s*["}]', first) is not None
    read = _json_rows if is_json else _csv_rows
    tick: int | None = None
    has_tick: bool | None = None
    for place, row in read(lines, names, source, number):
        if "tick" not in names:
            if has_tick not in (None, "tick" in row):
                raise InputError(f"{place}: some rows have a `tick` and some have none")
            has_tick = "tick" in row
            if has_tick:
                tick = _next_tick(row["tick"], tick, place)
        yield place, row


def _csv_rows(
    lines: Iterable[str], names: Sequence[str], source: str, number: int
) -> Iterator[tuple[str, dict[str, Any]]]:
    table = csv.reader(lines, strict=True)
    try:
        header = [name.strip() for name in next(table)]
        _check_columns(header, names, f"{source}:{number}")
        for values in table:
            place = f"{source}:{number - 1 + table.line_num}"
            if not values and len(header) > 1:
                continue  # an empty line; in a table of one column it is an unknown value
            values = values or [""]
            if len(values) != len(header):
                raise InputError(f"{place}: {len(values)} values for {len(header)} columns")
            yield place, dict(zip(header, values, strict=True))
    except csv.Error as error:
        raise InputError(f"{source}:{number - 1 + table.line_num}: {error}") from None


def _json_rows(
    lines: Iterable[str], names: Sequence[str], source: str, first: int
) -> Iterator[tuple[str, dict[str, Any]]]:
    for number, line in enumerate(lines, first):
        if not line.strip():
            continue
        try:
            row = json.loads(line, object_pairs_hook=_distinct)
        except (ValueError, RecursionError) as error:
            raise InputError(f"{source}:{number}: not JSON: {error}") from None
        if not isinstance(row, dict):
            raise InputError(f"{source}:{number}: a line must hold one object")
        _check_columns(row, names, f"{source}:{number}")
        yield f"{source}:{number}", row


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key comes twice")
    return found


def _check_columns(keys: Iterable[str], names: Sequence[str], place: str) -> None:
    columns = list(keys)
    for name in names:
        if name not in columns:
            listing = _short(", ".join(columns)) or "none"
            raise InputError(f"{place}: there is no column `{name}`; there are {listing}")
    for name in (*names, "tick"):
        if columns.count(name) > 1:
            raise InputError(f"{place}: there are two columns `{name}`")


def _short(text: str) -> str:
    """As much of it as a message has room for."""
    return text if len(text) <= _ROOM else f"{text[:_ROOM]}..."


_ROOM = 200


def _truth(value: Any, name: str, place: str) -> Truth:
    if value is None or isinstance(value, bool):
        return value
    word = str(value).strip().lower()
    if word not in _WORDS:
        raise InputError(
            f"{place}: column `{name}`: `{_short(str(value))}` is no truth value; "
            "write 0, 1, true, false, or nothing for unknown"
        )
    return _WORDS[word]


def _next_tick(value: Any, before: int | None, place: str) -> int:
    text = str(value)
    if not re.fullmatch(r"\s*-?[0-9]{1,18}\s*", text):
        raise InputError(f"{place}: column `tick`: `{_short(text)}` is no whole number")
    tick = int(text)
    if before is not None and tick != before + 1:
        fault = "goes back" if tick <= before else "leaves ticks out"
        raise InputError(f"{place}: column `tick` {fault}: {before}, then {tick}")
    return tick
