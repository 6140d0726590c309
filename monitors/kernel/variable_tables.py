"""Reading tables of variables: CSV with a header, or JSON lines; one row a tick."""

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from monitors.kernel.tables import InputError, _short, _truth, placed_rows
from monitors.kernel.variables import Value, Variable

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?", re.ASCII)
_OTHER_NUMBERS = {"nan": None, "inf": float("inf"), "+inf": float("inf"), "-inf": float("-inf")}
_MOST_DIGITS = 30
"""The largest number of digits of an exact whole number; 64-bit integers have fewer."""


def read_variables(
    text: "Iterable[str]", variables: "Mapping[str, Variable]", source: str
) -> "Iterator[tuple[Value, ...]]":
    """The rows of a table of variables, each a column; the rest is as `read_rows` has it.

    A number is written as `17.5`, `-3`, `1e-3`, `inf`; nothing (null in JSON) is unknown, and
    so is `nan`.

    Raises:
        InputError: a column is missing, a value is of another kind than its variable, ticks jump.
    """
    for location, row in placed_rows(text, tuple(variables), source):
        yield tuple(_value(row[name], name, each, location) for name, each in variables.items())


def _value(value: Any, name: str, variable: Variable, location: str) -> Value:
    if variable.kind == "truth":
        return _truth(value, name, location)
    if value is None or not (str(value).strip() or value in variable.words):
        return None
    if variable.kind == "word":
        return _word(value, name, variable.words, location)
    return _number(value, name, location)


def _word(value: Any, name: str, words: "tuple[str, ...]", location: str) -> str:
    text = str(value)
    if text not in words:  # spaces around a cell are none of it, unless they are of a word
        text = text.strip()
    if text not in words or not isinstance(value, str):
        raise InputError(
            f"{location}: column `{name}`: `{_short(text)}` is none of its words; "
            f"write {', '.join(words)}, or nothing for unknown"
        )
    return text


def _number(value: Any, name: str, location: str) -> "float | None":
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return value
    text = str(value).strip()
    if text.lower() in _OTHER_NUMBERS:
        return _OTHER_NUMBERS[text.lower()]
    if not _NUMBER.fullmatch(text):
        raise InputError(
            f"{location}: column `{name}`: `{_short(text)}` is no number; "
            "write it as 17.5 or 1e-3, or nothing for unknown"
        )
    whole = text.lstrip("+-").isdigit() and len(text) <= _MOST_DIGITS
    return int(text) if whole else float(text)
