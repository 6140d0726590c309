"""Each message has one text, and each use of it gives the values that the text needs."""

import ast
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from string import Formatter

import pytest

from fretish.diagnostics import messages as module
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.fixes import Fix
from fretish.diagnostics.messages import FILES, Message, code_table, diagnostic, message, messages
from fretish.diagnostics.source import Source

ROOT = Path(__file__).parents[3]
ROOMS = ("fretish", "compiler", "fretc")
IMPORT = "from fretish.diagnostics.messages import diagnostic"
ARGUMENTS = {"help", "paste", "subject", "fix", "related"}


@cache
def uses() -> list[tuple[str, str, set[str]]]:
    """Each use of a message: where it is, the name, and the keywords it gives."""
    return [
        use
        for room in ROOMS
        for path in sorted((ROOT / room).rglob("*.py"))
        if IMPORT in (text := path.read_text(encoding="utf-8"))
        for use in uses_in(str(path.relative_to(ROOT)), ast.parse(text))
    ]


def uses_in(path: str, tree: ast.Module) -> Iterator[tuple[str, str, set[str]]]:
    """The uses in one module; of a conditional name both."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "diagnostic":
            place = f"{path}:{node.lineno}"
            for name in names(node.args[0], place):
                yield place, name, {keyword.arg or "**" for keyword in node.keywords}


def names(node: ast.expr, place: str) -> list[str]:
    """The names that an argument may be: a text, or one of two."""
    if isinstance(node, ast.IfExp):
        return [*names(node.body, place), *names(node.orelse, place)]
    assert isinstance(node, ast.Constant), place
    assert isinstance(node.value, str), place
    return [node.value]


def placeholders(message: Message) -> set[str]:
    """The placeholders of message and help, which are plain names."""
    found = set()
    for text in (message.message, message.help):
        for _, name, specification, conversion in Formatter().parse(text):
            if name is not None:
                assert re.fullmatch(r"[a-z][a-z0-9_]*", name), text
                assert (specification, conversion) == ("", None), text
                found.add(name)
    return found


def test_each_use_names_a_message_and_gives_exactly_its_placeholders() -> None:
    for place, name, keywords in uses():
        assert keywords - ARGUMENTS == placeholders(message(name)), f"{place}: {name}"


def test_a_help_text_is_in_the_table_or_in_the_code() -> None:
    for place, name, keywords in uses():
        assert not ("help" in keywords and message(name).help), f"{place}: {name}"


def test_each_message_is_used() -> None:
    assert {name for code in Code for name in messages(code)} == {name for _, name, _ in uses()}


def test_each_name_is_unique_and_plain() -> None:
    tables = map(code_table, Code)
    every = [name for table in tables for name in table.get("messages", {})]
    assert len(every) == len(set(every))
    for name in every:
        assert re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+){0,4}", name), name
        assert not placeholders(message(name)) & ARGUMENTS, name


def test_each_row_has_known_fields_and_a_text_in_one_line() -> None:
    for code in Code:
        for name, row in code_table(code).get("messages", {}).items():
            assert set(row) <= {"message", "help", "severity"}, name
            assert all(text and text == " ".join(text.split()) for text in row.values()), name


def test_the_part_of_a_code_is_all_that_its_file_has_of_it() -> None:
    whole = [tomllib.loads(file.read_text(encoding="utf-8")) for file in FILES.glob("*.toml")]
    tables = {number: table for each in whole for number, table in each.items()}
    assert {code.number: code_table(code) for code in Code} == tables
    assert len(whole) == len({number[1] for number in tables})


def test_values_are_inserted_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """Braces in what a user wrote mean nothing; doubled ones in the table mean one."""
    text = Message(Code.NO_TOPIC, "no `{topic}`", "`values = {{ {word} = 0 }}`", Severity.WARNING)
    monkeypatch.setattr(module, "message", {"no_topic": text}.__getitem__)
    place = Source("b.toml", "x").span()
    assert diagnostic("no_topic", place, topic="/{word}{0}{{", word="{topic}") == Diagnostic(
        Code.NO_TOPIC,
        "no `/{word}{0}{{`",
        place,
        "`values = { {topic} = 0 }`",
        Severity.WARNING,
    )
    assert diagnostic("no_topic", topic="", word="", help="{x}").help == "{x}"
    with pytest.raises(KeyError):
        diagnostic("no_topic", topic="/scan")
    with pytest.raises(KeyError):
        diagnostic("no_such_message")


def test_a_message_without_help_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "message", lambda _: Message(Code.EMPTY_LOG, "empty"))
    assert diagnostic("empty") == Diagnostic(Code.EMPTY_LOG, "empty")


def test_without_a_help_text_the_help_is_that_of_the_fix(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = {
        "empty": Message(Code.EMPTY_LOG, "empty"),
        "helped": Message(Code.EMPTY_LOG, "empty", "fill it"),
    }
    monkeypatch.setattr(module, "message", rows.__getitem__)
    fix = Fix(Source("r.fret", "shal").span(), "shall", is_safe=True)
    assert diagnostic("empty", fix=fix) == Diagnostic(
        Code.EMPTY_LOG, "empty", help="write `shall`", fix=fix
    )
    assert diagnostic("helped", fix=fix).help == "fill it"
    assert diagnostic("empty", fix=fix, help="no").help == "no"


def test_a_name_without_a_message_is_an_error() -> None:
    for name in ("no_such_message", "", "no_topic]\n[F301.messages.no"):
        with pytest.raises(KeyError):
            message(name)
