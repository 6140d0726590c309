"""No single change to evidence, or to proofs, is certified by `fretc verify-evidence`.

The logs are audited once for each integrity, and every change is compared with that.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from functools import lru_cache
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from compiler.files.records import plain
from compiler.logic.claims import (
    SCHEMA,
    ClaimResult,
    ClaimTrace,
    Layer,
    VerificationDocument,
    proof,
    proved,
    refuted,
    vacuous,
)
from compiler.project.folder import load_folder
from compiler.project.project import Project
from fretc.audit.evidence.reader import read
from fretc.audit.evidence.result_summaries import ResultSummaries
from fretc.audit.many_logs import SEQUENTIAL, LogAudits, LogResult, audit_logs
from fretc.audit.measurements import confidence_intervals
from fretc.audit.plan import Plan, planned
from fretc.audit.store.anywhere import required
from fretc.reproduction import proofs as reproving
from fretc.reproduction import results
from fretc.reproduction.completeness import ComparisonScope
from fretc.reproduction.manifest import Manifest
from fretc.reproduction.manifest import read as read_manifest
from fretc.reproduction.outcome import ItemOutcome, Recheck
from fretc.reproduction.results import recheck
from fretc.traceability.chain_builder import chains
from fretc.traceability.lock import Lock, accepted
from fretc.verification import reader as proven
from fretc.verification.engines.sandbox import CallLimits
from fretish.diagnostics.diagnostic import Diagnostic
from tests.command import write
from tests.effort import FULL
from tests.fretc.commands.test_verify_evidence import BINDINGS, log, manifested

Step = str | int
Place = tuple[Step, ...]

REQUIREMENTS = {
    "r1": "whenever p the sw shall within 2 ticks satisfy q",
    "r2": "the sw shall always satisfy q | !p",
    "r7": "whenever p the sw shall with probability >= 0.5 within 2 ticks satisfy q",
}
ASSUMING = BINDINGS.replace('agg = "last"', "on_unknown = false").replace('max_age = "250 ms"', "")
"""Something of each kind that a result may assume."""
FREE: Mapping[tuple[str, ...], str] = {
    ("bindings", "file"): "a place: what the bindings say is compared by its hash",
    ("requirements", "*", "sentence"): "another wording of one meaning is the same sentence",
    ("probabilities", "*", "confidence"): "all that is said with it is made again with it",
    ("results", "*", "health", "findings", "*", "line"): "a comment above moves it",
    ("results", "*", "health", "findings", "*", "column"): "a comment above moves it",
}
"""What may be otherwise, and why."""
STRUCTURE = ("taken out", "emptied", "a key more", "twice", "one more", "in another order")
ASSUMED = ("results", "*", "assumptions")
DEFAULTS = (
    "the last sample of a tick counts",
    "readings that are no measurement are unknown",
    "the default",
)
"""Ends of assumptions that the bindings may write out, so that they may be absent."""


# Changes --------------------------------------------------------------------------------------


MARK = "written twice: "


def written(value: Any) -> str:
    """JSON, with keys that are there twice where one of them has the mark."""
    return json.dumps(value).replace(MARK, "")


def places(value: Any, at: Place = ()) -> Iterator[Place]:
    """Everywhere in a value; of a list of records the first, of an outermost list the last, too."""
    yield at
    match value:
        case dict():
            for key, inner in value.items():
                yield from places(inner, (*at, key))
        case list() if value:
            is_short = len(value) < 10 and not isinstance(value[0], dict | list)
            last = len(value) - 1 if len(at) == 1 else 0
            for i in range(len(value)) if is_short else sorted({0, last}):
                yield from places(value[i], (*at, i))
        case _:
            pass


def inside(value: Any, at: Place) -> Any:
    for step in at:
        value = value[step]
    return value


def put(content: Any, at: Place, value: Any) -> str:
    """The text with another value there."""
    if not at:
        return written(value)
    holder, last = inside(content, at[:-1]), at[-1]
    before, holder[last] = holder[last], value
    text = written(content)
    holder[last] = before
    return text


def taken_out(content: Any, at: Place) -> str:
    """The text without the value there."""
    holder = inside(content, at[:-1])
    if isinstance(holder, dict):
        return put(content, at[:-1], {key: holder[key] for key in holder if key != at[-1]})
    return put(content, at[:-1], [one for i, one in enumerate(holder) if i != at[-1]])


def others(value: Any) -> list[Any]:
    """Values in the place of a leaf; texts of a hash stay hashes."""
    match value:
        case bool():
            return [not value, int(value), None]
        case int():
            return [value + 1, -1, float(value), True]
        case float():
            return [value + 1e-9, float("nan"), str(value)]
        case str() if len(value) == 64:
            return [value[:-1] + ("0" if value[-1] != "0" else "1"), ""]
        case str():
            words = ("satisfied", "violated", "supported")
            return [f"{value}x", *(word for word in words if word != value)]
        case _:
            return [0, "", False]


def changes(content: Any, *, every: bool = True) -> Iterator[tuple[str, Place, str]]:
    """What is done, where, and the text of the file then.

    Not every one: one key of an object is there twice, and other values of a leaf take turns.
    """
    turns = count()
    for at in places(content):
        value = inside(content, at)
        if at:
            yield "taken out", at, taken_out(content, at)
        if isinstance(value, dict | list) and value:
            yield "emptied", at, put(content, at, type(value)())
        if isinstance(value, dict):
            yield "a key more", at, put(content, at, {**value, "more": 1})
            for key in value if every else [*value][:1]:
                twice = {**value, f"{MARK}{key}": value[key]}
                yield "twice", (*at, key), put(content, at, twice)
        elif isinstance(value, list):
            for extra in [*value[:1], *value[1:][-1:], 1]:
                yield "one more", at, put(content, at, [*value, extra])
            for first in value[:1]:
                yield "one more", at, put(content, at, [first, *value])
            if [*reversed(value)] != value:
                yield "in another order", at, put(content, at, [*reversed(value)])
        else:
            values = others(value)
            for other in values if every else [values[next(turns) % len(values)]]:
                yield f"{other!r}", at, put(content, at, other)


def is_free(content: Any, what: str, at: Place) -> bool:
    """Whether it is a leaf that may be otherwise, or the order of what is not ordered."""
    place = tuple(map(generic, at))
    if what == "in another order":
        return place in UNORDERED
    if what == "taken out" and place[:-1] == ASSUMED:
        return str(inside(content, at)).endswith(DEFAULTS)
    return place in FREE and what not in STRUCTURE


def generic(step: Step) -> str:
    """A key, or any place of a list."""
    return "*" if isinstance(step, int) else step


UNORDERED: Mapping[tuple[str, ...], str] = {
    ("requirements",): "files are read in any order",
    ("results",): "each has its run and its requirement",
    ASSUMED: "the tables of the bindings may stand in any order",
    ("probabilities",): "each has its requirement",
    ("evidence",): "each proof has its requirement and its claim",
}
"""Lists whose order says nothing, and why."""


# Evidence -------------------------------------------------------------------------------------


class Case:
    """A small project, audited and reviewed, whose logs are audited once for each integrity."""

    def __init__(self, project: Project, plan: Plan, lock: Lock, manifest: Manifest) -> None:
        self.project, self._plan, self._lock, self._manifest = project, plan, lock, manifest
        self._known: dict[tuple[str, str], LogResult] = {}

    def judged(self, text: str) -> Sequence[Recheck] | Diagnostic:
        document = required(write("build/changed.json", text))
        if isinstance(document, Diagnostic):
            return document
        runs = dict.fromkeys(result.run for result in document.results)
        there = {run: run for run in runs if run and Path(run).is_file()}
        scope = ComparisonScope(tuple(claim.id for claim in self._plan.claims), self._lock)
        again = recheck(document.document, self._plan, there, self._engine, scope, self._manifest)
        assert not isinstance(again, Diagnostic)
        return again

    def _engine(self, plan: Plan, logs: Sequence[str]) -> LogAudits:
        for one in logs:
            key = (plan.integrity, one)
            if key not in self._known:
                with closing(SEQUENTIAL(plan, [one])) as audits:
                    for done in audits:
                        assert not isinstance(done, Diagnostic)
                        self._known[key] = done[1]
            yield one, self._known[key]


def stands(rechecks: Sequence[Recheck] | Diagnostic) -> bool:
    """Whether the command would exit with 0."""
    if isinstance(rechecks, Diagnostic):
        return False
    return all(one.finding is ItemOutcome.STANDS for one in rechecks)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with pytest.MonkeyPatch.context() as patch:
        place = tmp_path_factory.mktemp("project")
        patch.chdir(place)
        patch.setattr(results, "_wording", lru_cache(results._wording))
        least = lru_cache(confidence_intervals._least)
        patch.setattr(confidence_intervals, "_least", lambda runs, c: least(tuple(runs), c))
        yield place


@pytest.fixture(scope="module")
def case(folder: Path) -> Case:
    for id, sentence in REQUIREMENTS.items():
        write(f"requirements/{id}.fret", sentence)
    write("requirements/bindings.toml", ASSUMING)
    log("logs/good.mcap", 0, 1.5, 3, 0, 0, 0)
    log("logs/bad.mcap", 0, 1.5, 0, 0, 1.5)
    manifested()
    project, manifest = load_folder("requirements"), read_manifest("logs.sha256")
    assert isinstance(project, Project)
    assert isinstance(manifest, Manifest)
    plan = planned(project)
    assert isinstance(plan, Plan)
    audit = audit_logs(plan, ["logs/bad.mcap", "logs/good.mcap"])
    assert not isinstance(audit, Diagnostic)
    audited = read(write("build/evidence.json", audit.evidence))
    assert not isinstance(audited, Diagnostic)
    chain_of = chains(project, ResultSummaries.of(audited))
    reviews = {c.requirement: accepted(c, "A", "b", "2026-01-02", "c") for c in chain_of}
    return Case(project, plan, Lock(reviews), manifest)


@pytest.mark.slow
def test_no_change_to_evidence_is_certified(case: Case) -> None:
    content = json.loads(Path("build/evidence.json").read_text())
    assert stands(case.judged(json.dumps(content)))
    passed, tried = [], 0
    first: dict[tuple[str, ...], Place] = {}  # of the places that differ by their numbers alone
    for what, at, text in changes(content, every=FULL):
        if FULL or first.setdefault(tuple(map(generic, at)), at) == at:
            tried += 1
            if not is_free(content, what, at) and stands(case.judged(text)):
                passed.append((what, at))
    assert tried > (1000 if FULL else 300)
    assert passed == []


LEFT_OUT: Mapping[str, Callable[[Mapping[str, Any]], bool]] = {
    "a run": lambda one: one["run"] == "logs/bad.mcap",
    "a requirement": lambda one: one["requirement"] == "r2",
    "what is violated": lambda one: one["verdict"] == "violated",
    "all": lambda one: True,
}


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("name", LEFT_OUT)
def test_nothing_is_left_out(case: Case, name: str, named: bool) -> None:
    content = json.loads(Path("build/evidence.json").read_text())
    omitted = [one for one in content["results"] if LEFT_OUT[name](one)]
    assert omitted
    content["results"] = [one for one in content["results"] if one not in omitted]
    if not named:  # neither at the beginning of the file
        ids = {one["requirement"] for one in content["results"]}
        requirements = [one for one in content["requirements"] if one["id"] in ids]
        content["requirements"] = requirements
    assert not stands(case.judged(json.dumps(content)))


# Proofs ---------------------------------------------------------------------------------------

TRACE = ClaimTrace(("p", "q"), ((True, False), (None, False)), ("it starts", "it ends"), 0)
PROOFS_NOW = (
    proof("r1", Layer.MONITOR, "it means it", proved("9 states"), "fretc", (), {"m": "a" * 64}),
    proof("r1", Layer.LOOP, "it is kept", refuted("at 1", TRACE), "fretc", ("(1) so",)),
    proof("r2", Layer.MONITOR, "it means it", vacuous("never"), "fretc", (), {"n": "b" * 64}),
    proof("r2", Layer.LOOP, "it is kept", proved("all"), "Dafny 4.9", ("(1) so",)),
)
"""What is found again, whatever is asked for."""


def test_no_change_to_proofs_is_certified(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reproving, "prove", lambda *arguments: PROOFS_NOW)
    content = json.loads(json.dumps(plain(VerificationDocument(SCHEMA, "0.1.0", PROOFS_NOW))))

    def judged(text: str) -> Sequence[Recheck] | Diagnostic:
        proofs = proven.read(write("build/changed.json", text))
        if isinstance(proofs, Diagnostic):
            return proofs
        again = reproving.prove_again(
            case.project, proofs, CallLimits(), tuple(REQUIREMENTS), lambda words: None
        )
        assert not isinstance(again, Diagnostic)
        return again

    assert stands(judged(json.dumps(content)))
    texts = [(what, at, text) for what, at, text in changes(content)]
    for i, record in enumerate(content["evidence"]):
        for result in {*map(str, ClaimResult)} - {record["result"]}:
            at = ("evidence", i, "result")
            texts.append((result, at, put(content, at, result)))
        for layer in {*map(str, Layer)} - {record["layer"]}:
            at = ("evidence", i, "layer")
            texts.append((layer, at, put(content, at, layer)))
    passed = [
        (what, at)
        for what, at, text in texts
        if stands(judged(text)) and not is_free(content, what, at)
    ]
    assert len(texts) > 100
    assert passed == []
