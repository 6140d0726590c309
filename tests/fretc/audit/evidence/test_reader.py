import copy
import json
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from fretc.audit.evidence.reader import EvidenceFile, read
from fretc.audit.evidence.schema import Moment
from fretc.report.make import make
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from tests.effort import examples
from tests.fretc.report.cases import evidence, moment, project, result, violation


def test_what_the_audit_wrote_is_read(tmp_path: Path) -> None:
    own_project = project(tmp_path)
    file = tmp_path / "evidence.json"
    one = result(own_project, "violated", violations=[violation(14, 20, 11)], open=[moment(90)])
    file.write_text(json.dumps(evidence(own_project, one)), encoding="utf-8")
    document = read(str(file))
    assert isinstance(document, EvidenceFile)
    (read_back,) = document.results
    assert read_back.verdict == "violated"
    assert read_back.triggers == (
        Moment(10, 2 * 10**9, 1.0),
        Moment(11, 2_100_000_000, 1.1),
        Moment(40, 5 * 10**9, 4.0),
    )
    assert read_back.violations[0].first == Moment(14, 2_400_000_000, 1.4)
    assert read_back.violations[0].trigger == Moment(11, 2_100_000_000, 1.1)
    assert read_back.violations[0].values == {"clearance": 0.0318, "vx": None}
    assert read_back.open == (Moment(90, 10**10, 9.0),)
    assert [*read_back.health.topics] == ["/odom"]


def test_no_evidence_yet_is_a_note_that_tells_how_to_audit(tmp_path: Path) -> None:
    diagnostic = read("nowhere/evidence.json")
    assert diagnostic == Diagnostic(
        Code.NO_SUCH_FILE,
        "no run has been audited: there is no evidence in `nowhere/evidence.json`",
        help="audit a run: `fretc audit LOG... -o nowhere/evidence.json`",
        severity=Severity.NOTE,
    )


def wrong(folder: Path, text: str) -> Diagnostic:
    file = folder / "evidence.json"
    file.write_text(text, encoding="utf-8")
    outcome = make(project(folder), str(file))
    assert (outcome.html, outcome.json) == (None, None)
    (diagnostic,) = outcome.diagnostics
    assert diagnostic.code is Code.BAD_EVIDENCE
    assert diagnostic.severity is Severity.ERROR
    return diagnostic


def test_what_is_not_json_is_pointed_at(tmp_path: Path) -> None:
    diagnostic = wrong(tmp_path, '{\n  "schema": "fretc-evidence-1",\n  "results": [,]\n}\n')
    assert diagnostic.message == "the evidence is not JSON: expecting value"
    assert diagnostic.span is not None
    assert (diagnostic.span.line, diagnostic.span.column) == (3, 15)


@pytest.mark.parametrize("text", ["", "[" * 100_000, '{"a": NaN}', '{"a": 1' + "0" * 5000 + "}"])
def test_what_python_cannot_read_as_json_is_no_traceback(tmp_path: Path, text: str) -> None:
    assert wrong(tmp_path, text).span is not None


def test_a_folder_that_is_no_store_is_an_error(tmp_path: Path) -> None:
    outcome = make(project(tmp_path), str(tmp_path))
    assert outcome.html is None
    assert [d.code for d in outcome.diagnostics] == [Code.BAD_STORE]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        (("schema",), "fretc-evidence-2", "`$.schema`: invalid enum value 'fretc-evidence-2'"),
        (("results",), {}, "`$.results`: expected `array`, got `object`"),
        (("results", 0, "verdict"), "passed", "`$.results[0].verdict`: invalid enum value"),
        (("results", 0, "verdict"), [], "`$.results[0].verdict`: expected `str`, got `array`"),
        (("results", 0, "ticks"), True, "`$.results[0].ticks`: expected `int`, got `bool`"),
        (("results", 0, "ticks"), -1, "`$.results[0].ticks`: expected `int` >= 0"),
        (("results", 0, "ticks"), 1.0, "`$.results[0].ticks`: expected `int`, got `float`"),
        (("results", 0, "ticks"), 2**63, "`$.results[0].ticks`: expected `int` <= 9223372036"),
        (("results", 0, "finite"), "yes", "`$.results[0].finite`: expected `bool | null`"),
        (("results", 0, "triggers", 1), None, "`$.results[0].triggers[1]`: expected `object`"),
        (("results", 0, "triggers", 1, "seconds"), -1, "`$.results[0].triggers[1].seconds`: "),
        (("results", 0, "triggers", 1, "seconds"), 1e300, "expected `float` <= 10000000000.0"),
        (("results", 0, "unknown"), [[1]], "`$.results[0].unknown[0]`: expected `array` of length"),
        (("results", 0, "hashes"), {}, "`$.results[0].hashes`: object missing required field"),
        (("results", 0, "health", "intact"), 1, "`$.results[0].health.intact`: expected `bool`"),
        (("results", 0, "trials"), None, "`$.results[0].trials`: expected `object`, got `null`"),
        (
            ("results", 0, "health", "topics", "/odom", "count"),
            None,
            "`$.results[0].health.topics[...].count`: expected `int`, got `null`",
        ),
    ],
)
def test_a_wrong_shape_is_named_with_its_place(
    tmp_path: Path, path: tuple[str | int, ...], value: object, says: str
) -> None:
    own_project = project(tmp_path)
    content = evidence(own_project, result(own_project, "satisfied"))
    _put(content, path, value)
    diagnostic = wrong(tmp_path, json.dumps(content))
    assert "is not evidence of fretc: " in diagnostic.message
    assert says in diagnostic.message


def _put(content: Any, path: tuple[str | int, ...], value: object) -> None:
    for step in path[:-1]:
        content = content[step]
    content[path[-1]] = value


def test_a_missing_field_is_named(tmp_path: Path) -> None:
    own_project = project(tmp_path)
    content = evidence(own_project, result(own_project, "satisfied"))
    del content["results"][0]["reason"]
    assert wrong(tmp_path, json.dumps(content)).message.endswith(
        "`$.results[0]`: object missing required field `reason`"
    )


@pytest.mark.parametrize(
    ("path", "says"),
    [
        (("signed",), "object contains unknown field `signed`"),
        (("results", 0, "why"), "`$.results[0]`: object contains unknown field `why`"),
        (("results", 0, "health", "checked", "all"), "`$.results[0].health.checked`: object"),
        (("results", 0, "hashes", "lop"), "`$.results[0].hashes`: object contains unknown field"),
    ],
)
def test_what_is_unknown_is_refused(tmp_path: Path, path: tuple[str | int, ...], says: str) -> None:
    own_project = project(tmp_path)
    content = evidence(own_project, result(own_project, "satisfied"))
    _put(content, path, "yes")
    assert says in wrong(tmp_path, json.dumps(content)).message


@pytest.mark.slow
@pytest.mark.parametrize("sha256", ["", "0" * 63, "0" * 64 + "\n", "A" * 64, "<script>"])
@pytest.mark.parametrize("name", ["log", "sentence", "monitor"])
def test_a_hash_is_a_hash(tmp_path: Path, name: str, sha256: str) -> None:
    own_project = project(tmp_path)
    content = evidence(own_project, result(own_project, "satisfied", hashes={name: sha256}))
    message = wrong(tmp_path, json.dumps(content)).message
    assert f"`$.results[0].hashes.{name}`: expected `str`" in message


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"verdict"', '"verdict": "violated", "verdict"', "`verdict` appears twice in one object"),
        ('"fretc"', '"fretc": "0.0.0", "fretc"', "`fretc` appears twice in one object"),
        ("2.4", "1e999", "`1e999` is too large for a number"),
        ("2.4", "Infinity", "`Infinity` is not a JSON number"),
        ("2.4", f"{10**400}", "is too large for a number"),
    ],
)
def test_what_two_readers_may_take_for_two_things_is_refused(
    tmp_path: Path, old: str, new: str, says: str
) -> None:
    own_project = project(tmp_path)
    text = json.dumps(evidence(own_project, result(own_project, "satisfied"))).replace(old, new, 1)
    assert says in wrong(tmp_path, text).message


# Mutations: whatever the file says, a report or F503 comes out, never an exception.

LEAVES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.sampled_from([0, -1, 2**62, 2**63, 10**400]),
    st.floats(allow_nan=False),
    st.text(max_size=5),
    st.sampled_from(["satisfied", "violated", "R1", "\ud800", "\u202e", "error"]),
)
VALUES = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=5,
)


def _paths(value: Any, at: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    inside: list[tuple[str | int, Any]] = []
    if isinstance(value, dict):
        inside = list(value.items())
    elif isinstance(value, list):
        inside = list(enumerate(value))
    return [at] * bool(at) + [p for key, part in inside for p in _paths(part, (*at, key))]


@pytest.mark.slow
@settings(examples(10), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
@example(data=None)
def test_no_mutation_of_the_evidence_gives_a_traceback(
    tmp_path: Path, data: st.DataObject | None
) -> None:
    own_project = project(tmp_path)
    full = result(
        own_project,
        "violated",
        violations=[violation(14, 20, 11), violation(30, 30)],
        unknown=[[1, 2]],
        open=[moment(90), moment(91)],
        health={"gaps": [{"start_ns": 1, "end_ns": 2}], "findings": [FINDING]},
    )
    content = copy.deepcopy(
        evidence(own_project, full, result(own_project, "no data", run="b.mcap"))
    )
    if data is not None:
        for path in data.draw(st.lists(st.sampled_from(_paths(content)), min_size=1, max_size=3)):
            _mutate(content, path, data.draw(VALUES))
    file = tmp_path / "evidence.json"
    file.write_text(json.dumps(content), encoding="utf-8")
    outcome = make(own_project, str(file))
    if outcome.html is None:
        assert [d.code for d in outcome.diagnostics] == [Code.BAD_EVIDENCE]
    else:
        assert outcome.json is not None
        outcome.html.encode("utf-8")


FINDING = {
    "code": "F404",
    "severity": "error",
    "message": "a part of the log is damaged",
    "file": "a.mcap",
    "line": None,
    "column": None,
    "help": None,
}


def _mutate(content: Any, path: tuple[str | int, ...], value: object) -> None:
    with suppress(KeyError, IndexError, TypeError):  # an earlier mutation took the place away
        _put(content, path, value)
