"""A timing is known everywhere or nowhere: a new one is named wherever something has to be added.

Where code asks which timing it has, it asks a table that has all of them or a `match` that ends
with `assert_never`: the first is held here, the second by the type checker.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, get_args

import pytest

from compiler.formalization import obligation, reference
from compiler.formalization.obligation import ObligationKind
from compiler.targets import dafny
from fretish import syntax as s
from fretish.diagnostics.source import Source
from fretish.expressions import Name
from fretish.parser import parse
from fretish.printer import timing as printed
from tests import meaning
from tests.each import each

ROOT = Path(__file__).parent.parent
SOURCES = sorted(
    p for room in ("fretish", "compiler", "fretc") for p in ROOT.glob(f"{room}/**/*.py")
)
TIMINGS = get_args(s.Timing)
KEYS = [*(timing.__name__.lower() for timing in TIMINGS), "null"]
NAMES = {timing.__name__ for timing in TIMINGS}
"""Of the classes, as `s.Within` or imported by name."""
ENUMS = {("fretish.syntax", "Extent"), ("compiler.formalization.obligation", "Kind")}
TABLES: tuple[tuple[ModuleType, str, object], ...] = (
    (s, "SHAPES", TIMINGS),
    (reference, "_DEMANDS", TIMINGS),
    (reference, "_NEGATED", TIMINGS),
    (dafny, "_COUNTERS", TIMINGS),
    (obligation, "TRAITS", ObligationKind),
    (obligation, "_DUALS", ObligationKind),
    (meaning, "_DEMANDS", KEYS),
    (meaning, "_NEGATED", KEYS),
)


@pytest.mark.parametrize(("module", "name", "rows"), TABLES)
def test_a_table_has_a_row_for_each(module: ModuleType, name: str, rows: Any) -> None:
    assert set(getattr(module, name)) == set(rows)


def test_the_schema_of_a_requirement_has_the_key_of_each() -> None:
    schema = json.loads((ROOT / "templates/json/requirement.schema.json").read_text("utf-8"))
    assert set(schema["properties"]["timing"]["enum"]) == set(KEYS)


def test_no_two_timings_ask_for_the_same() -> None:
    assert len(set(s.SHAPES.values())) == len(TIMINGS)


@pytest.mark.parametrize("timing", TIMINGS, ids=lambda timing: timing.__name__)
def test_a_timing_is_read_and_printed(timing: type[s.Timing]) -> None:
    """The grammar has its words, and they are those that the printer writes."""
    values: dict[str, Any] = {
        "duration": s.Duration(2, "tick"),
        "stop": Name("p"),
        "explicit": True,
    }
    written = timing(**{name: values[name] for name in timing.__dataclass_fields__})
    sentence = f"the sw shall {printed(written)} satisfy q"
    read = parse(Source("r.fret", sentence).span())
    assert isinstance(read, s.Sentence)
    assert read.timing == written


class Names:
    """What a module calls the timings, their extents and the kinds of demand."""

    def __init__(self, module: ast.Module) -> None:
        self.classes: set[str] = set()
        self.enums: set[str] = set()
        self.syntax: set[str] = set()
        for node in ast.walk(module):
            match node:
                case ast.ImportFrom(room, aliases):
                    for alias in aliases:
                        self._add(room, alias.name, alias.asname or alias.name)

    def _add(self, room: str | None, name: str, here: str) -> None:
        if (room, name) == ("fretish", "syntax"):
            self.syntax.add(here)
        elif room == "fretish.syntax" and name in NAMES:
            self.classes.add(here)
        elif (room, name) in ENUMS:
            self.enums.add(here)

    def are_in(self, where: ast.AST) -> bool:
        """Whether one of them stands in it."""
        for node in ast.walk(where):
            match node:
                case ast.Name(id) if id in self.classes:
                    return True
                case ast.Attribute(ast.Name(room), name) if room in self.syntax and name in NAMES:
                    return True
                case ast.Attribute(ast.Name(room), _) if room in self.enums:
                    return True
                case ast.Attribute(ast.Attribute(ast.Name(room), "Extent"), _):
                    return room in self.syntax
        return False


def guesses(module: ast.Module, names: Names) -> Iterator[ast.AST]:
    """Where the module asks for some of them, and is silent about the others."""
    for node in ast.walk(module):
        match node:
            case ast.Compare():
                asked: list[ast.AST] = [node]
            case ast.Call(ast.Name("isinstance" | "issubclass"), [_, classes]):
                asked = [classes]
            case ast.Tuple(parts) | ast.List(parts) | ast.Set(parts):
                asked = [part for part in parts if not isinstance(part, ast.Call)]
            case ast.Match(_, cases):
                last = ast.unparse(cases[-1])
                complete = last.startswith("case _:\n    assert_never(")
                asked = [] if complete else [case.pattern for case in cases]
            case _:
                continue
        if any(map(names.are_in, asked)):
            yield node


def tables(module: ast.Module, names: Names) -> Iterator[str]:
    """The names of what the module keeps by timing, extent or kind."""
    for node in module.body:
        match node:
            case ast.AnnAssign(target, _, ast.Dict(keys)) | ast.Assign([target], ast.Dict(keys)):
                if any(names.are_in(key) for key in keys if key):
                    yield ast.unparse(target)


@pytest.mark.slow
@each("path", SOURCES)
def test_nobody_asks_for_some_timings_alone(path: Path) -> None:
    text, here = path.read_text(encoding="utf-8"), path.relative_to(ROOT).as_posix()
    if not any(word in text for word in ("syntax", *(name for _, name in ENUMS))):
        return  # it can know none of them
    module = ast.parse(text)
    names = Names(module)
    if not (names.classes or names.enums or names.syntax):
        return
    assert [f"{here}:{ast.unparse(node)}" for node in guesses(module, names)] == []
    known = {f"{table.__name__.replace('.', '/')}.py {name}" for table, name, _ in TABLES}
    assert {f"{here} {name}" for name in tables(module, names)} <= known
