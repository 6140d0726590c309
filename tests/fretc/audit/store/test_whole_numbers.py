"""Each number of evidence has one range: of the schema, of the readers, of files and of stores."""

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema  # type: ignore[import-untyped]
import pytest

from compiler.files.records import types
from fretc.audit.evidence.reader import EvidenceFile, read
from fretc.audit.evidence.schema import EvidenceDocument, schema
from fretc.audit.evidence.writer import text
from fretc.audit.store.anywhere import read as read_anywhere
from fretish.diagnostics.diagnostic import Diagnostic
from tests.effort import some
from tests.fretc.audit.results import SHA
from tests.fretc.audit.store.test_law import bare
from tests.stores import write_document

Step = str | int
Place = tuple[Step, ...]

NUMBERS = sorted(
    {
        sign * bound + beside
        for bound in (0, 1, 2**31, 2**53, 10**9, 10**10, 2**63, 2**64)
        for beside in (-1, 0, 1)
        for sign in (-1, 1)
    }
    | {10**30, -(10**30)}
)


def filled(kind: Any) -> Any:
    """A plain value of a type in which each part is there once."""
    match kind:
        case types.Metadata(type=inner):
            return filled(inner)
        case types.UnionType(types=inner):
            kinds = [*map(type, map(bare, inner))]
            (first, *_) = [kind for kind in _FIRST if kind in kinds]
            return filled(inner[kinds.index(first)])
        case types.BoolType():
            return True
        case types.IntType(ge=least):
            return least if least == 1 else 0
        case types.FloatType(gt=above):
            return 0.0 if above is None else 0.75
        case types.LiteralType(values=words):
            return words[0]
        case types.StrType(pattern=pattern) if pattern:
            return "F405" if pattern.startswith("^F") else SHA
        case types.StrType():
            return "1"
        case types.VarTupleType(item_type=item):
            return [filled(item)]
        case types.TupleType(item_types=items):
            return [filled(item) for item in items]
        case types.DictType(value_type=item):
            return {"name": filled(item)}
        case types.StructType() | types.DataclassType():
            return {each.encode_name: filled(each.type) for each in kind.fields}
    raise AssertionError(kind)


_FIRST: tuple[type, ...] = (
    types.StructType,
    types.DataclassType,
    types.VarTupleType,
    types.DictType,
    types.FloatType,
    types.IntType,
    types.BoolType,
    types.StrType,
    types.LiteralType,
)
"""Of several types the first one here: columns hold it, so that one number is changed."""


@cache
def _empty() -> str:
    document = filled(types.type_info(EvidenceDocument))
    document["probabilities"][0]["bound"] = "0.5"
    return json.dumps(document)


def numbers(value: Any, at: Place = ()) -> Iterator[Place]:
    """Each number in a value."""
    match value:
        case dict():
            for key, inner in value.items():
                yield from numbers(inner, (*at, key))
        case list():
            for place, inner in enumerate(value):
                yield from numbers(inner, (*at, place))
        case bool():
            pass
        case int() | float():
            yield at


def put(value: Any, at: Place, number: Any) -> None:
    """Put a number there; a stretch of time has no length then."""
    for step in at[:-1]:
        value = value[step]
    value[at[-1]] = number
    if at[-1] == "start_ns" and "samples" in value:
        value["end_ns"] = number
    if at[-1] == "end_ns" and "samples" in value:
        value["start_ns"] = number


def evidence(*changes: tuple[Place, int]) -> str:
    """A file with a run for each change, of two results, of which the first has the number.

    What is not about a run is changed where it is.
    """
    document = json.loads(_empty())
    (one,) = document["results"]
    results = []
    for place, (at, number) in enumerate(changes):
        result = json.loads(json.dumps(one | {"run": f"{place}", "requirement": "first"}))
        if at[0] == "results":
            put(result, at[2:], number)
        else:
            put(document, at, number)
        other = result | {"requirement": "other"}
        del other["course"]
        results += [result, other]
    return json.dumps(document | {"results": results})


def accepted(content: str, path: Path) -> bool:
    path.write_text(content)
    return isinstance(read(str(path)), EvidenceFile)


ALL = [(at, number) for at in numbers(json.loads(_empty())) for number in NUMBERS]
CASES = [
    *some(ALL, 149),
    *some([case for case in ALL if case[1] in (2**63, 2**64 - 1)], 7),
]


@pytest.mark.slow
def test_every_number_that_the_schema_admits_is_read_and_no_other(tmp_path: Path) -> None:
    validator = jsonschema.Draft202012Validator(schema())
    assert accepted(evidence((("results", 0, "ticks"), 1)), tmp_path / "e.json")
    different = []
    for at, number in CASES:
        if at[-2:] == ("starts", 0) and number > 0:
            continue  # where a line begins there must be a point, whatever the range is
        content = evidence((at, number))
        admitted = validator.is_valid(json.loads(content))
        if admitted != accepted(content, tmp_path / "e.json"):
            different.append((at, number, admitted))
    assert different == []


@pytest.mark.slow
def test_every_number_that_is_read_comes_back_from_a_store(tmp_path: Path) -> None:
    there = [each for each in CASES if accepted(evidence(each), tmp_path / "e.json")]
    of_runs = [each for each in there if each[0][0] == "results"]
    for group in (of_runs, *([each] for each in there if each[0][0] != "results")):
        assert accepted(evidence(*group), tmp_path / "e.json")
        before = read(str(tmp_path / "e.json"))
        assert isinstance(before, EvidenceFile)
        assert isinstance(write_document(tmp_path / "store", before.document), str)
        after = read_anywhere(str(tmp_path / "store"))
        assert not isinstance(after, Diagnostic), after.message
        assert text(after.document) == text(before.document)
