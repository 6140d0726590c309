"""What runs together have exercised."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema  # type: ignore[import-untyped]
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.files.templating import template_root
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.store.anywhere import source
from fretc.coverage import record
from fretc.coverage.coverage import Coverage, CoverageStatus, coverage
from fretc.coverage.directions import is_complete
from fretc.coverage.text_output import lines
from fretish.diagnostics.diagnostic import Diagnostic
from tests.fretc.coverage.evidence import KEYS, Shown, evidence, of_run
from tests.stores import write_document

SHOWN = st.none() | st.dictionaries(st.sampled_from(KEYS), st.integers(-5, 5))
BETTER = (
    CoverageStatus.NOT_MEASURED,
    CoverageStatus.NEVER,
    CoverageStatus.PERHAPS,
    CoverageStatus.SEEN,
)


def statuses(covered: Coverage) -> dict[tuple[str, str], CoverageStatus]:
    return {
        (one.id, each.key): each.status for one in covered.requirements for each in one.situations
    }


def of(shown: list[Shown]) -> EvidenceFile:
    return evidence(*(of_run(f"{n}.mcap", each) for n, each in enumerate(shown)))


@given(st.lists(SHOWN, min_size=1, max_size=4), SHOWN)
def test_one_more_run_takes_nothing_away(shown: list[Shown], more: Shown) -> None:
    before, after = statuses(coverage(of(shown))), statuses(coverage(of([*shown, more])))
    assert before.keys() == after.keys()
    for key, status in before.items():
        assert BETTER.index(after[key]) >= BETTER.index(status)


@given(st.lists(SHOWN, min_size=1, max_size=5))
def test_a_status_is_what_the_best_run_shows(shown: list[Shown]) -> None:
    found = statuses(coverage(of(shown)))
    for key in KEYS:
        ticks = [each[key] for each in shown if each is not None and key in each]
        if any(tick >= 0 for tick in ticks):
            expected = CoverageStatus.SEEN
        elif ticks:
            expected = CoverageStatus.PERHAPS
        else:
            measured = any(each is not None for each in shown)
            expected = CoverageStatus.NEVER if measured else CoverageStatus.NOT_MEASURED
        assert found["R1", key] is expected


@given(st.lists(SHOWN, min_size=1, max_size=5))
def test_the_least_runs_show_all_that_is_seen(shown: list[Shown]) -> None:
    covered = coverage(of(shown))
    some = of([shown[place] for place in covered.least.runs] or [{}])
    assert all(
        (statuses(coverage(some))["R1", key] is CoverageStatus.SEEN)
        is (status is CoverageStatus.SEEN)
        for (_, key), status in statuses(covered).items()
    )


@pytest.mark.slow
@settings(max_examples=20)
@given(st.lists(SHOWN, min_size=1, max_size=3))
def test_its_json_is_of_its_schema(shown: list[Shown]) -> None:
    schema = json.loads((template_root() / "json/coverage.schema.json").read_text("utf-8"))
    jsonschema.validate(json.loads(record.text(coverage(of(shown)))), schema)


def test_a_store_shows_what_a_file_shows(tmp_path: Path) -> None:
    file = evidence(of_run("a", {"late": 3, "at-once": -1}), of_run("b", None), of_run("c", {}))
    assert not isinstance(write_document(tmp_path / "store", file.document), Diagnostic)
    store = source(str(tmp_path / "store"))
    assert not isinstance(store, Diagnostic)
    assert coverage(store) == coverage(file)


def test_evidence_of_earlier_versions_has_measured_nothing() -> None:
    covered = coverage(evidence(of_run("a.mcap", None), named=False))
    assert not is_complete(covered, {})
    (one,) = covered.requirements
    assert (one.situations, one.unmeasured) == ((), (0,))


def test_what_only_results_name_is_no_situation() -> None:
    covered = coverage(evidence(of_run("a.mcap", {"invented": 3})))
    assert set(statuses(covered).values()) == {CoverageStatus.NEVER}


def test_two_logs_of_one_name_are_two_runs() -> None:
    one, other = of_run("a.mcap", {"late": 1}), of_run("a.mcap", {"at-once": 1})
    prints = type(one.fingerprints)
    from compiler.files.records import plain, replace

    hashes = [prints(**plain(one.fingerprints) | {"log": digit * 64}) for digit in "12"]
    both = [replace(each, fingerprints=sha) for each, sha in zip((one, other), hashes, strict=True)]
    covered = coverage(evidence(*both))
    assert covered.runs == ("a.mcap", "a.mcap")
    assert covered.least.runs == (0, 1)


def test_what_is_printed() -> None:
    covered = coverage(
        evidence(
            of_run("a.mcap", {"late": 3}),
            of_run("b.mcap", {"late": 2, "at-once": -8}),
            of_run("c.mcap", None),
        )
    )
    assert [text for text, _ in lines(covered, {"R1": "Stop (R1)"}, every=True)] == [
        "○ Stop (R1): 1 of 3 situations seen, not measured in 1 run",
        "    ? it is at-once: perhaps at 0.7 s of b.mcap, where some values are unknown",
        "    ✔ it is late: seen in 2 runs, first at 0.3 s of a.mcap",
        "    ○ it is never-triggered: never",
        "",
        "a.mcap: 1 situation",
        "b.mcap: 1 situation",
        "c.mcap: 0 situations",
        "1 of 3 runs shows all that is seen (the smallest set): a.mcap",
        "3 runs \N{MULTIPLICATION SIGN} 1 requirement: 1 of 3 situations seen, 1 perhaps, 1 never",
    ]
