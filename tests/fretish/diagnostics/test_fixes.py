"""What a message proposes can be pasted: whatever in it is TOML parses."""

import ast
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from string import Formatter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretish.bindings.tables.interceptor import TABLE
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.messages import messages
from fretish.reading.toml_text import as_key
from tests.fixes import toml_in

ROOT = Path(__file__).parents[3]
MODULES = sorted(
    p for room in ("fretish", "monitors", "compiler", "fretc") for p in (ROOT / room).rglob("*.py")
)


def texts(module: Path) -> Iterator[str]:
    """Every text of a module but its docstrings; what is filled in later is `X`."""
    written = module.read_text("utf-8")
    if not re.search(r"`(\[|[^`\n]* = )", re.sub(r"""["']\s+[a-z]*["']""", "", written)):
        return  # before its tree is built: most modules have no TOML
    nodes = list(ast.walk(ast.parse(written)))
    inner = {id(part) for node in nodes if isinstance(node, ast.JoinedStr) for part in node.values}
    statements = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
    for node in nodes:
        if isinstance(node, ast.JoinedStr):
            parts = (p.value if isinstance(p, ast.Constant) else "X" for p in node.values)
            yield "".join(map(str, parts))
        elif (
            isinstance(node, ast.Constant) and id(node) not in inner and id(node) not in statements
        ):
            yield str(node.value)


def templates() -> Iterator[str]:
    """The text and help of every message; what is filled in is `X`."""
    for message in (each for code in Code for each in messages(code).values()):
        for text in (message.message, message.help):
            names = [name for _, name, _, _ in Formatter().parse(text) if name is not None]
            yield text.format_map(dict.fromkeys(names, "X"))


def test_toml_in_a_message_of_the_tables_parses() -> None:
    found = {found for text in templates() for found in toml_in(text)}
    for fragment in sorted(found):
        assert tomllib.loads(fragment), fragment
    assert {'tick = "100 ms"', "[clock]", "[proposition.X]", "lost = 0"} <= found


@pytest.mark.slow
def test_toml_in_a_text_of_a_module_parses() -> None:
    found = {found for module in MODULES for text in texts(module) for found in toml_in(text)}
    for fragment in sorted(found):
        assert tomllib.loads(fragment), fragment
    assert {'tick = "100 ms"', "[clock]", "[X.X]"} <= found


@given(st.text(st.characters(exclude_categories=["Cs"]), min_size=1))
def test_any_name_can_be_a_key(name: str) -> None:
    assert tomllib.loads(f"[proposition.{as_key(name)}]") == {"proposition": {name: {}}}


def test_a_plain_name_stays_as_it_is() -> None:
    assert (as_key("too_close"), as_key("(x <= 1.5)")) == ("too_close", '"(x <= 1.5)"')


def test_what_is_to_be_pasted_parses() -> None:
    assert tomllib.loads(TABLE)["interceptor"]["stop"] == "/stop"
