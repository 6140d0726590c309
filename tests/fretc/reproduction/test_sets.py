"""An analysis is never certified that is not the one that is made now, whatever is changed."""

import json
from collections.abc import Iterator
from typing import Any

from compiler.files.checked_json import SchemaError
from compiler.files.records import decoded, plain
from compiler.files.templating import to_json
from fretc.analysis.analysis import AnalysisOptions, analyze
from fretc.analysis.evidence import AnalysisDocument, document
from fretc.reproduction.outcome import ItemOutcome
from fretc.reproduction.sets import compared
from tests.requirement_sets import ROLES, requirement, requirements

SENTENCES = (
    "whenever a the sw shall within 2 ticks satisfy x",
    "whenever b the sw shall for 3 ticks satisfy !x",
    "whenever b the sw shall for 2 ticks satisfy !x",
    "when a & b & !a the sw shall immediately satisfy y",
    "the sw shall always satisfy y | !y",
)
ASSUMED = (requirement("A1", "whenever a the man shall at the next timepoint satisfy !a"),)


def changes(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """The value with one thing in it changed, added or left out, each once, and where."""
    match value:
        case dict():
            for key, part in value.items():
                for where, other in changes(part, f"{path}.{key}"):
                    yield where, {**value, key: other}
        case list():
            for place, part in enumerate(value):
                yield f"{path}[{place}] left out", [*value[:place], *value[place + 1 :]]
                yield f"{path}[{place}] twice", [*value, part]
                for where, other in changes(part, f"{path}[{place}]"):
                    yield where, [*value[:place], other, *value[place + 1 :]]
        case bool():
            yield path, not value
        case None:
            yield path, 1
        case int() | float():
            yield path, value + 1
        case _:
            yield path, f"{value}1"
            for word in ("realizable", "unrealizable", "not checked", "input", "output", "R5"):
                yield f"{path}: {word}", word


def test_no_change_of_an_analysis_stands() -> None:
    members = requirements(*SENTENCES)
    now = analyze(members, ROLES, ASSUMED, AnalysisOptions(60))
    assert now.conflicts
    assert now.vacuous
    assert now.redundant
    assert now.always
    assert now.repairs
    known: Any = json.loads(to_json(plain(document(members, ASSUMED, now, as_fret=False))))
    assert all(
        each.finding is ItemOutcome.STANDS
        for each in compared(decoded(known, AnalysisDocument), now)
    )
    tried = 0
    for where, other in changes(known["analysis"]):
        if "seconds" in where or other == known["analysis"]:
            continue
        try:
            forged = decoded({**known, "analysis": other}, AnalysisDocument)
        except SchemaError:
            continue
        found = [each.finding for each in compared(forged, now)]
        assert {ItemOutcome.DIFFERS, ItemOutcome.UNKNOWN} & {*found}, where
        tried += 1
    assert tried > 100
