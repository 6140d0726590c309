"""Parsers for grammars, with stored parse tables.

Lark takes 0.3 s to compute the tables of FRETish. Stored tables are used if they belong to the same
grammar. They are JSON and contain no code.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fretish.classes.frozen import dataclass
from fretish.reading.lalr import Parser, Tables

if TYPE_CHECKING:
    from lark import Lark
    from lark.grammar import Rule

_GZIP = 31
"""The value by which `zlib` reads and writes the format of gzip."""


@dataclass(frozen=True, slots=True)
class Grammar:
    """A grammar for an LALR(1) parser, in a file `NAME.lark` of a package."""

    package: str
    name: str
    starts: tuple[str, ...] = ("start",)
    """The rules that describe a whole text."""
    addition: str = ""
    """Grammar rules that are appended to the file."""

    def parser(self) -> Parser:
        """The parser, from the stored tables if they are current."""
        return Parser(self._stored() or _tables(self.lark()))

    def lark(self) -> Lark:
        """Lark's own parser of the grammar, computed anew."""
        from lark import Lark

        return Lark(
            self._text(),
            start=list(self.starts),
            parser="lalr",
            lexer="basic",
            maybe_placeholders=False,
            propagate_positions=True,
        )

    @property
    def is_stored(self) -> bool:
        """Whether the stored tables belong to this grammar."""
        return self._stored() is not None

    @property
    def tables_file(self) -> str:
        """The name of the file of tables, in the package."""
        return f"{self.name}.tables.gz"

    def tables(self) -> bytes:
        """The contents of the file of tables, computed from the grammar."""
        text = json.dumps({"key": self._key(), "tables": _tables(self.lark())._asdict()})
        return zlib.compress(text.encode(), 9, _GZIP)

    def _stored(self) -> Tables | None:
        file = self._folder / self.tables_file
        if not file.is_file():
            return None
        document: Mapping[str, Any] = json.loads(zlib.decompress(file.read_bytes(), _GZIP))
        return Tables(**document["tables"]) if document["key"] == self._key() else None

    @property
    def _folder(self) -> Path:
        return Path(import_module(self.package).__path__[0])

    def _text(self) -> str:
        file = self._folder / f"{self.name}.lark"
        return file.read_text(encoding="utf-8") + self.addition

    def _key(self) -> list[str]:
        """All that the tables depend on."""
        return [self._text(), *self.starts]


def _tables(lark: Lark) -> Tables:
    """The tables that Lark has computed."""
    from lark.lexer import BasicLexer

    lexer = BasicLexer(lark.lexer_conf)
    table = lark.parser.parser._parse_table
    number = {rule: i for i, rule in enumerate(lark.rules)}
    assert [*table.states] == [*range(len(table.states))]
    (terminals,) = (each.pattern for each in lexer.scanner._mres)
    assert not lexer.callback
    return Tables(
        terminals=terminals,
        skip=sorted(lexer.ignore_types),
        states=[" ".join(_row(row, number)) for row in table.states.values()],
        rules=[_rule(rule) for rule in lark.rules],
        starts={
            start: [first, table.end_states[start]] for start, first in table.start_states.items()
        },
    )


def _row(row: Mapping[str, tuple[Any, Any]], number: Mapping[Rule, int]) -> Iterator[str]:
    for symbol, (_, target) in row.items():
        yield f"{symbol} {target if isinstance(target, int) else -1 - number[target]}"


def _rule(rule: Rule) -> str:
    """A rule as `Tables.rules` describes it."""
    children = [
        -1 - i if not symbol.is_term and symbol.name.startswith("_") else i
        for i, symbol in enumerate(rule.expansion)
        if rule.options.keep_all_tokens or not getattr(symbol, "filter_out", False)
    ]
    expands = rule.options.expand1 and not rule.alias
    kind = rule.alias or rule.origin.name
    parts = (rule.origin.name, len(rule.expansion), kind, int(expands), *children)
    return " ".join(map(str, parts))
