"""Evidence is the same in a file and in a store, exactly."""

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from compiler.files.records import UNSET, decoded, replace, types
from fretc.audit.evidence.result_summaries import run_facts, summary_of
from fretc.audit.evidence.schema import EvidenceDocument, Result
from fretc.audit.evidence.writer import text
from fretc.audit.store.container import record_text
from fretc.audit.store.reader import Store, evidence, opened
from tests.effort import FULL
from tests.fretc.audit.results import SHA, result
from tests.stores import runs_of, write_document

SHARED = ("run", "health", "labels")
LARGE = 2**63

# Values of every type of the schema, by its constraints ------------------------------------------

_FLOATS = [0.0, -0.0, 5e-324, 1.7976931348623157e308, 0.1, 1.0]
TEXTS = ["", "R1", "a.mcap", "mètre \u202e\n", '"', "violated"]


def values(kind: Any, *, held: bool) -> st.SearchStrategy[Any]:
    """Plain values of a type.

    Args:
        kind: the type.
        held: only what columns hold: numbers with a point are no whole ones.
    """
    match kind:
        case types.Metadata(type=inner):
            return values(inner, held=held)
        case types.UnionType(types=inner):
            point = held and any(isinstance(each, types.FloatType) for each in inner)
            some = [e for e in inner if not (point and isinstance(bare(e), types.IntType))]
            return st.one_of([values(each, held=held) for each in some])
        case types.NoneType():
            return st.none()
        case types.BoolType():
            return st.booleans()
        case types.IntType(ge=least, le=most):
            beyond = 2**63 - 1 if held else 2**64 - 1
            least, most = -LARGE if least is None else least, beyond if most is None else most
            few = [n for n in (least, most, 0, 1, 7) if least <= n <= most]
            return st.sampled_from(few) | st.integers(least, most)
        case types.FloatType(ge=least, le=most, gt=above, lt=below):
            least = least if above is None else above
            most = most if below is None else below
            least, most = -1e308 if least is None else least, 1e308 if most is None else most
            return st.sampled_from([x for x in _FLOATS if least < x < most] or [0.75]) | st.floats(
                least, most, exclude_min=True, exclude_max=True
            )
        case types.LiteralType(values=words):
            return st.sampled_from(words)
        case types.StrType(pattern=None, min_length=least):
            return st.sampled_from([*filter(None, TEXTS)] if least else TEXTS)
        case types.StrType(pattern=pattern) if pattern and pattern.startswith("^F"):
            return st.just("F405")
        case types.StrType(max_length=most):
            digest = st.sampled_from([SHA, "ab" * 32])
            return digest if most else digest | st.just("")
        case types.VarTupleType(item_type=item, min_length=least):
            return st.lists(values(item, held=held), min_size=least or 0, max_size=2)
        case types.TupleType(item_types=items):
            return st.tuples(*(values(item, held=held) for item in items)).map(list)
        case types.DictType(key_type=key, value_type=item, min_length=least):
            names, contents = values(key, held=held), values(item, held=held)
            return st.dictionaries(names, contents, min_size=least or 0, max_size=2)
        case types.StructType() | types.DataclassType():
            return records(kind, held=held)
    raise AssertionError(kind)


def bare(kind: Any) -> Any:
    return bare(kind.type) if isinstance(kind, types.Metadata) else kind


def records(kind: Any, *without: str, held: bool) -> st.SearchStrategy[Any]:
    parts = [each for each in kind.fields if each.name not in without]
    needed = {f.encode_name: values(f.type, held=held) for f in parts if f.required}
    others = {f.encode_name: values(f.type, held=held) for f in parts if not f.required}
    found = st.fixed_dictionaries(needed, optional=others)
    return found.map(lambda value: _fixed(value, kind.cls.__name__))


def _fixed(value: dict[str, Any], name: str) -> dict[str, Any]:
    """Times in their order, as many as values; a probability for a bound."""
    if name == "Estimated":
        return value | {"bound": "0.99"}
    lists = [key for key in ("times_ns", "values", "words", "x", "y") if key in value]
    if name in ("WindowSamples", "WordSeries", "RobotPath", "EnumChanges"):
        size = min(len(value[key]) for key in lists)
        value |= {key: value[key][:size] for key in lists} | {"starts": [0][:size]}
        value["times_ns"].sort()
        return (
            value if name == "RobotPath" else {key: value[key] for key in value if key != "starts"}
        )
    if name == "Surroundings":
        start, end = sorted((value["start_ns"], value["end_ns"]))
        return value | {"start_ns": start, "end_ns": end}
    return value


results = st.one_of(
    *(records(types.type_info(Result), held=held) for held in (True, True, False))
).map(lambda value: decoded(value, Result))
heads = records(types.type_info(EvidenceDocument), "results", held=False)


@st.composite
def documents(draw: st.DrawFn) -> EvidenceDocument:
    """Some results, of which some share what those of one run share."""
    found: list[Result] = []
    alike = draw(st.lists(st.booleans(), min_size=6, max_size=6))
    for one, like_the_last in zip(draw(st.lists(results, max_size=6)), alike, strict=False):
        if found and like_the_last:
            one = replace(one, **{name: getattr(found[-1], name) for name in SHARED})
            one = replace(one, course=draw(st.sampled_from([UNSET, one.course])))
        found.append(one)
    return replace(decoded(draw(heads) | {"results": []}, EvidenceDocument), results=tuple(found))


def stored(folder: Path, document: EvidenceDocument) -> Store:
    digest = write_document(folder, document)
    assert isinstance(digest, str), digest
    store = opened(str(folder))
    assert isinstance(store, Store), store
    assert store.sha256 == digest
    return store


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("store")


def document(*results: Result) -> EvidenceDocument:
    head = {"schema": "fretc-evidence-1", "fretc": "1", "requirements": [], "results": []}
    bindings = {"file": "bindings.toml", "sha256": SHA}
    return replace(decoded(head | {"bindings": bindings}, EvidenceDocument), results=results)


def test_times_of_a_damaged_log_are_kept(tmp_path: Path) -> None:
    late = result(start_ns=0, end_ns=2**64 - 1, verdict="no data")
    good = result(run="b.mcap", verdict="satisfied")
    store = stored(tmp_path, document(late, good))
    assert evidence(store).results == (late, good)
    assert [(one.run, one.end_ns) for _, one in store.summaries()] == [
        ("a.mcap", 2**64 - 1),
        ("b.mcap", None),
    ]


def test_equal_evidence_has_one_identity_whatever_its_file(tmp_path: Path) -> None:
    """It is the SHA-256 of the head and of the results of each run, as JSON."""
    results = [result(run=name, reason=name * 300) for name in "abc"]
    first, other = (
        stored(tmp_path / name, document(*some)) for name, some in (("a", results), ("b", results))
    )
    lines = [text(first.document), *(row.sha256 for row in first.rows)]
    assert first.sha256 == other.sha256 == sha256("\n".join(lines).encode()).hexdigest()
    texts = [record_text([each]) for each in results]
    assert [row.sha256 for row in first.rows] == [sha256(text).hexdigest() for text in texts]
    run = json.loads(texts[0])
    (own,) = run.pop("results")
    assert own | run == json.loads(text(document(*results)))["results"][0]
    assert stored(tmp_path / "c", document(*results[:2])).sha256 != first.sha256


@pytest.mark.slow
@settings(
    max_examples=200 if FULL else 5,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(document=documents())
def test_evidence_comes_back_from_a_store_to_the_letter(
    document: EvidenceDocument, folder: Path
) -> None:
    store = stored(folder, document)
    found = evidence(store)
    assert text(found.document) == text(document)
    assert store.selection == (document.selection or None)
    assert [*store.summaries()] == [*enumerate(map(summary_of, document.results))]
    assert [*store.runs()] == [*map(run_facts, runs_of(document.results))]
    for id in {each.requirement for each in document.results}:
        own = [(n, r) for n, r in enumerate(document.results) if r.requirement == id]
        assert [(n, [*x]) for n, x in store.latencies([id])] == [
            (n, [*r.latencies]) for n, r in own
        ]
        assert [(n, (*x,)) for n, x in store.thresholds([id])] == [
            (n, r.thresholds) for n, r in own
        ]
    for n, one in enumerate(document.results):
        assert [*store.details([n])] == [(n, one)]
