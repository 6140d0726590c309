"""docs/files.md has each field that the readers accept, and its examples and defaults are right."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from compiler.files import settings
from compiler.project import hazards
from fretc.audit.outputs import table as tables
from fretc.traceability import lock, texts, waivers
from fretc.traceability.chain import ChainItem
from fretish.bindings import declarations as d
from fretish.bindings.tables import (
    actions,
    clock,
    coordinates,
    interceptor,
    labels,
    propositions,
    reader,
    signals,
    variables,
)
from fretish.clock import End, Rounding, TimeSource
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.explanations import ACCEPTANCES, explanations
from fretish.diagnostics.source import Source
from tests.docs import pages
from tests.docs.pages import FOLDER, rows, section
from tests.each import each

PAGE = "files.md"
TEXT = (FOLDER / PAGE).read_text("utf-8")
REVIEW = lock.Review(
    "R1",
    "A. Meier",
    "safety engineer",
    "2026-11-20",
    "first review",
    {ChainItem("sentence", "R1"): "0" * 64},
    {"traces/a.mcap": "satisfied"},
    texts.ReviewedTexts(
        sentence="whenever too_close the rover shall within 200 milliseconds satisfy stopped",
        canonical="whenever too_close rover shall within 200 milliseconds satisfy stopped",
        title="Stop near obstacles",
        status="approved",
        parents=("HAZ-001",),
        params={"too_close": "5 cm"},
        hazards={"HAZ-001": texts.HazardTexts("The robot hits a drum", severity="catastrophic")},
        bindings=texts.BindingsTexts(
            {"tick": "100 ms"},
            {"clearance": {"path": "/clearance.data", "unit": "m", "max_age": "300 ms"}},
            {"too_close": {"expr": "clearance < 5 cm", "role": "input"}},
        ),
        fretc="0.1.0",
    ),
)


# What the page asks for ---------------------------------------------------------------------------


def table(name: str) -> str:
    if name == "lock":
        return f"```toml\n{lock.text(lock.Lock({'R1': REVIEW}))}```"
    if name == "store":
        return "\n".join(["| table | a row for each | columns |", "|---|---|---|", *store_rows()])
    assert name == "acceptances"
    lines = ["| where | warnings |", "|---|---|"]
    for about, (place, example) in ACCEPTANCES.items():
        codes = sorted(code for code, each in explanations().items() if each.accept == about)
        written = example.format(codes[0]).replace("[accept]\n", "")
        lines.append(f"| {place}: `{written}` | {', '.join(codes)} |")
    return "\n".join(lines)


ROWS_OF_STORES = {
    "results": "run and requirement",
    "violations": "stretch of violated ticks",
    "runs": "run",
}


def store_rows() -> Iterator[str]:
    for name, columns in tables.TABLES.items():
        words = ", ".join(f"`{column.replace(chr(34), '')}`" for column in columns)
        yield f"| `{name}` | {ROWS_OF_STORES[name]} | {words} |"


def test_the_page_is_current(request: pytest.FixtureRequest) -> None:
    pages.is_current(PAGE, {"table": table}, request)


# Every field --------------------------------------------------------------------------------------

CHOICES: Mapping[tuple[str, str], tuple[str, ...] | type[StrEnum]] = {
    ("clock", "time"): TimeSource,
    ("clock", "end"): End,
    ("clock", "rounding"): Rounding,
    ("signal.NAME", "reduce"): d.Reduce,
    ("proposition.NAME", "role"): d.Role,
    ("proposition.NAME", "kind"): propositions.KINDS,
    ("proposition.NAME", "agg"): d.Aggregate,
    ("proposition.NAME", "modality"): d.Modality,
    ("variable.NAME", "modality"): d.Modality,
    ("interceptor", "form"): d.InterceptorForm,
    ("assume", "requests"): d.Requests,
    ("assume", "planner"): d.Planner,
    ("waivers.toml", "verdict"): waivers.VERDICTS,
}
"""Fields that are one of a few words; in all other ones no words are listed but examples."""
TABLES = {
    "clock": clock.FIELDS,
    "signal.NAME": signals.FIELDS,
    "proposition.NAME": propositions.FIELDS,
    "variable.NAME": variables.FIELDS,
    "fret": variables._FRET,
    "interceptor": interceptor.FIELDS,
    "assume": interceptor.ASSUMED_FIELDS,
    "map": coordinates.FIELDS,
    "run": labels._RUN,
    "action.NAME": actions.FIELDS,
    "call.NAME": actions.CALL_FIELDS,
    "agent": actions.AGENT_FIELDS,
    "hazards.toml": hazards.FIELDS,
    "waivers.toml": waivers.FIELDS,
    "fretc.toml": settings.SETTINGS_FIELDS,
}
"""Part of the page → the fields that the reader of it accepts."""


def part(name: str) -> str:
    return section(TEXT, f"## `{name}`" if name.endswith(".toml") else f"### `[{name}]`")


def fields(name: str) -> dict[str, tuple[str, ...]]:
    found = [row for row in rows(part(name)) if len(row) == 5]
    assert len({row[0] for row in found}) == len(found)
    return {row[0].strip("`"): row[1:] for row in found}


ROWS = [(name, field, *row[1:3]) for name in TABLES for field, row in fields(name).items()]


def test_each_table_of_the_bindings_has_a_part() -> None:
    assert {name.partition(".")[0] for name in TABLES if ".toml" not in name} == {*reader.FIELDS}


@pytest.mark.parametrize("name", TABLES)
def test_each_field_has_its_row(name: str) -> None:
    assert {*fields(name)} == {*TABLES[name]}


def test_the_fields_of_a_lock_are_those_that_are_written() -> None:
    written = tomllib.loads(lock.text(lock.Lock({"R1": REVIEW})))
    found = {row[0].strip("`") for row in rows(section(TEXT, "## `fretc.lock`"))}
    kept = {f"texts.{name}" for name in texts.ReviewedTexts.__struct_fields__}
    assert found == {"schema", *written["review"]["R1"], *kept}


@pytest.mark.parametrize(("name", "field"), CHOICES)
def test_the_words_of_a_field_are_those_that_it_may_be(name: str, field: str) -> None:
    words = re.findall(r'`"([^"]+)"`', fields(name)[field][0])
    assert words == [str(word) for word in CHOICES[name, field]]


# Examples and defaults ----------------------------------------------------------------------------

Table = dict[str, Any]
LEAST: Mapping[str, Table] = {
    "clock": {"tick": "1 s"},
    "signal.NAME": {"path": "/x.data"},
    "proposition.NAME": {"expr": "vx < 1 m/s"},
    "variable.NAME": {},
    "fret": {},
    "interceptor": {"stop": "/s", "command": "/c", "output": "/o", "period": "10 ms"},
    "assume": {"stands": "stopped", "latency": "1 s", "braking": "1 s"},
    "map": {"x": "/at.x", "y": "/at.y"},
    "run": {},
    "call.NAME": {"service": "/s", "type": "std_srvs/Trigger"},
    "agent": {"trace": "/agent/trace"},
    "action.NAME": {"topic": "/s", "type": "std_msgs/Bool", "message": {}},
    "hazards.toml": {"title": "t"},
    "waivers.toml": {
        "verdict": "vacuous", "reason": "r", "by": "b", "role": "r",
        "granted": "2026-11-20", "expires": "2026-11-30",
    },
    "fretc.toml": {},
}  # fmt: skip
"""What each table has at least."""
EACH = {"path": "/scan.ranges[:]", "reduce": "outline", "footprint": [[1, 0], [0, 1], [1, 1]]}
BESIDE: Mapping[tuple[str, str], Table] = {
    ("signal.NAME", "reduce"): {"path": "/scan.ranges[:]"},
    ("signal.NAME", "invalid"): {"path": "/scan.ranges[:]", "reduce": "min"},
    ("signal.NAME", "footprint"): EACH,
    ("signal.NAME", "sensor"): EACH,
    ("interceptor", "scan_timeout"): {"scan": "/scan"},
    ("assume", "heartbeat"): {"requests": "edge"},
}
"""What a field is written beside."""


def bindings_of(name: str, table: Table) -> d.Declarations:
    """The bindings with one table."""
    kind, _, named = name.partition(".")
    whole: dict[str, Any] = {
        "clock": {"tick": "100 ms"},
        "signal": {"vx": {"path": "/odom.twist.twist.linear.x", "unit": "m/s"}},
        "proposition": {"stopped": {"expr": "vx < 1 m/s"}},
    }
    whole[kind] = {**whole.get(kind, {}), "it": table} if named else table
    found, said = reader.read_bindings(Source("bindings.toml", tomli_w.dumps(whole)))
    assert found is not None, said
    assert not has_errors(said), said
    return replace(found, source=Source("", ""), defaults=())


def hazard_of(name: str, table: Table) -> object:
    Path("hazards.toml").write_text(tomli_w.dumps({"HAZ-1": table}), "utf-8")
    found, said = hazards.hazards("hazards.toml")
    assert not said
    return found


def waiver_of(name: str, table: Table) -> object:
    Path("waivers.toml").write_text(tomli_w.dumps({"R1": table}), "utf-8")
    found, said = waivers.read("waivers.toml", ["R1"], "2026-11-25")
    assert not said
    return found


def settings_of(name: str, table: Table) -> object:
    Path("fretc.toml").write_text(tomli_w.dumps(table), "utf-8")
    found = settings.settings(".")
    assert not isinstance(found, Diagnostic), found
    return found.parents, found.accept, found.project, found.viewer


def value_of(cell: str) -> Any:
    return tomllib.loads(f"it = {cell.strip('`')}")["it"]


READERS: Mapping[str, Callable[[str, Table], object]] = {
    "hazards.toml": hazard_of,
    "waivers.toml": waiver_of,
    "fretc.toml": settings_of,
}


@pytest.mark.slow
@each("row", ROWS)
def test_an_example_is_read_and_a_default_is_what_is_meant_without_it(
    row: tuple[str, str, str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    name, field, default, example = row
    read = READERS.get(name, bindings_of)
    beside = {**LEAST[name], **BESIDE.get((name, field), {})}
    without = {key: value for key, value in beside.items() if key != field}
    shown = {**without, field: value_of(example)}
    if field == "form":  # the node without a timer has no period
        del shown["period"]
    if (name, field) == ("signal.NAME", "value"):  # what is computed is not recorded
        del shown["path"]
    told = read(name, shown)
    if default.startswith("required"):
        with pytest.raises(AssertionError):
            read(name, without)
        return
    assert told != read(name, without), f"the example of {field} is its default"
    if re.fullmatch("`[^`]*`", default):
        assert read(name, {**without, field: value_of(default)}) == read(name, without)
