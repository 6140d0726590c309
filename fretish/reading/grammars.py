"""Parsers for grammars, with precomputed parse tables.

Lark takes 0.3 s to compute the tables of FRETish, and 0.02 s to load them. Stored tables are used
if they belong to the same grammar and version of Lark. They are JSON and contain no code.
"""

from __future__ import annotations

import gzip
import hashlib
import json
from collections.abc import Mapping
from dataclasses import field
from importlib import import_module
from pathlib import Path
from typing import Any

import lark
from lark import Lark
from lark.grammar import Rule
from lark.lexer import TerminalDef

from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Grammar:
    """A grammar for an LALR(1) parser, in a file `NAME.lark` of a package."""

    package: str
    name: str
    options: Mapping[str, Any]
    """Options for Lark."""
    addition: str = field(default="", repr=False)
    """Grammar rules that are appended to the file."""

    def parser(self) -> Lark:
        """The parser, from the stored tables if they are current."""
        kept = self._kept()
        return self._new() if kept is None else Lark.load(_with_numbers(kept))

    @property
    def is_kept(self) -> bool:
        """Whether the stored tables belong to this grammar and this version of Lark."""
        return self._kept() is not None

    @property
    def tables_file(self) -> str:
        """The name of the file of tables, in the package."""
        return f"{self.name}.tables.gz"

    def tables(self) -> bytes:
        """The contents of the file of tables, computed from the grammar."""
        data, memo = self._new().memo_serialize([TerminalDef, Rule])
        text = json.dumps({"key": self._key(), "data": data, "memo": memo})
        return gzip.compress(text.encode(), mtime=0)

    def _kept(self) -> Mapping[str, Any] | None:
        file = self._folder / self.tables_file
        if not file.is_file():
            return None
        tables: Mapping[str, Any] = json.loads(gzip.decompress(file.read_bytes()))
        return tables if tables["key"] == self._key() else None

    @property
    def _folder(self) -> Path:
        return Path(import_module(self.package).__path__[0])

    def _new(self) -> Lark:
        return Lark(self._text(), parser="lalr", **self.options)

    def _text(self) -> str:
        file = self._folder / f"{self.name}.lark"
        return file.read_text(encoding="utf-8") + self.addition

    def _key(self) -> str:
        """SHA-256 of all that the tables depend on."""
        parts = [lark.__version__, self._text(), dict(self.options)]
        return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def _with_numbers(tables: Mapping[str, Any]) -> dict[str, Any]:
    """The tables with integer keys, which JSON stores as texts."""
    data = dict(tables["data"])
    table = data["parser"]["parser"]
    data["parser"]["parser"] = {**table, "states": _numbered(table["states"])}
    return {"data": data, "memo": _numbered(tables["memo"])}


def _numbered(table: Mapping[str, Any]) -> dict[int, Any]:
    return {int(key): value for key, value in table.items()}
