"""A report is the same from a file and from a store, and reads in full only what it shows."""

import re
from collections.abc import Collection, Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, cast

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from benchmarks.report import JSON, STORE, project, written
from compiler.files.templating import to_json
from compiler.project.project import Project
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.result_summaries import (
    EvidenceSource,
    ResultSummaries,
    run_facts,
    summary_of,
)
from fretc.audit.evidence.schema import Result
from fretc.audit.store.anywhere import source
from fretc.report.across.assembly import across
from fretc.report.forms import json_text
from fretc.report.forms.csv_rows import csv_text
from fretc.report.forms.json_text import json_pieces
from fretc.report.forms.markdown import markdown
from fretc.report.make import ReportBuild, make
from fretc.report.page.html import html
from fretc.report.page.selection import DETAILED, selection
from fretc.report.sections import details as reading
from fretc.report.sections.details import Details
from fretish.diagnostics.diagnostic import Diagnostic
from tests.effort import FULL, some
from tests.fretc.report import cases
from tests.fretc.report.test_any_evidence import TEXTS, audits
from tests.stores import write_document

pytestmark = pytest.mark.filterwarnings("ignore:Generating overly large repr")

_BRIEFLY = settings(
    deadline=None,
    max_examples=50 if FULL else 4,
    phases=(Phase.generate,),
    suppress_health_check=[HealthCheck.too_slow],
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("sources")


@pytest.fixture(scope="module")
def known(folder: Path) -> Project:
    return cases.project(folder, *TEXTS)


FORMS = [JSON, STORE]
RUNS = 20 if FULL else 4


@pytest.fixture(scope="module", params=FORMS)
def audited(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Evidence of 3 requirements in some runs, half of them violated, in either form."""
    folder = tmp_path_factory.mktemp("audited")
    written(folder, 3, RUNS, 0.5, request.param)
    return folder / str(request.param)


@pytest.fixture(scope="module")
def made(audited: Path) -> tuple[Any, Details]:
    """The report about it."""
    return whole(make(project(audited.parent, 3), str(audited)))


def opened(path: Path) -> EvidenceSource:
    known = source(str(path))
    assert not isinstance(known, Diagnostic), known.message
    return known


def whole(build: ReportBuild) -> tuple[Any, Details]:
    assert build.report is not None, build.diagnostics[0].message
    assert build.details is not None
    return build.report, build.details


# One law of every source -------------------------------------------------------------------------


@pytest.mark.slow
def test_a_source_counts_what_it_has_in_full(audited: Path) -> None:
    known = opened(audited)
    summaries = [*known.summaries()]
    results = dict(known.details(range(len(summaries))))
    assert summaries == [
        (place, summary_of(result)) for place, result in enumerate(results.values())
    ]
    assert [*results] == [*range(3 * RUNS)]
    runs = {run: [r for r in results.values() if r.run == run] for run in known_runs(results)}
    assert [*known.runs()] == [run_facts(of) for of in runs.values()]
    for ids in (("R0",), ("R2", "R0"), ()):
        places = [place for place, result in results.items() if result.requirement in ids]
        late = [(place, [*some]) for place, some in known.latencies(ids)]
        assert late == [(place, [*results[place].latencies]) for place in places]
        near = [(place, [*some]) for place, some in known.thresholds(ids)]
        assert near == [(place, [*results[place].thresholds]) for place in places]
    assert [*known.details([7, 3, 7])] == [(3, results[3]), (7, results[7])]


def known_runs(results: dict[int, Result]) -> list[str]:
    return list(dict.fromkeys(result.run for result in results.values()))


@pytest.mark.slow
@given(drawn=audits())
@_BRIEFLY
def test_a_report_from_a_store_is_that_from_the_file(
    drawn: list[dict[str, Any]], known: Project, folder: Path
) -> None:
    file = cases.report_of(known, folder, *(cases.result(known, **each) for each in drawn))
    one = source(str(folder / "evidence.json"))
    assert isinstance(one, EvidenceFile)
    sha256 = write_document(folder / "evidencestore", one.document)  # as long: lines are the same
    assert isinstance(sha256, str)
    store = make(known, str(folder / "evidencestore"))
    sheets = {sha256[:16]: one.sha256[:16]}  # in the margins of printed sheets
    names = {sha256: one.sha256, "evidencestore": "evidence.json", **sheets}
    forms = []
    for build in (file, store):
        report, details = whole(build)
        texts = [build.json, build.html, csv_text(report), markdown(report, details)]
        forms.append([_named_alike(text or "", names) for text in texts])
    assert forms[0] == forms[1]


def _named_alike(text: str, names: dict[str, str]) -> str:
    for name, other in names.items():
        text = text.replace(name, other)
    return re.sub(r"'sha256-[\w+/=]+'; script-src", "'sha256-'; script-src", text)  # of the sheets


# What is read in full ----------------------------------------------------------------------------


class Counted:
    """A source that knows what was read of it in full."""

    def __init__(self, of: EvidenceSource) -> None:
        self._of, self.read = of, list[int]()

    def details(self, places: Collection[int]) -> Iterator[tuple[int, Result]]:
        self.read += places
        return self._of.details(places)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._of, name)


@pytest.mark.slow
def test_a_page_reads_those_results_in_full_that_it_shows(
    audited: Path, made: tuple[Any, Details]
) -> None:
    report, details = made
    counted = Counted(opened(audited))
    chosen = selection(report, replace(details, evidence=cast(EvidenceSource, counted)))
    shown = [view.anchor for each in chosen.by_anchor.values() for view in each.details]
    folded = [view.anchor for each in chosen.by_anchor.values() for view in each.folded]
    rows = {row.place: row.anchor for view in report.requirements for row in view.results}
    assert sorted(rows[place] for place in counted.read) == sorted((*shown, *folded))
    assert len(shown) <= DETAILED


# The JSON form -----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("audited", some(FORMS, 2), indirect=True)
def test_the_json_form_in_pieces_is_that_in_one(made: tuple[Any, Details]) -> None:
    report, details = made
    anchors = [view.anchor for view in report.requirements]
    histograms = dict(details.histograms(anchors))
    every = [row for view in report.requirements for row in view.results]
    results = {row.anchor: view for row, view in details.results(every)}
    requirements = [
        replace(
            view,
            results=tuple(results[row.anchor] for row in view.results),
            histograms=histograms[view.anchor],
        )
        for view in report.requirements
    ]
    full = replace(
        report,
        runs=details.run_views(report.runs),
        requirements=tuple(requirements),
        across=across(details, anchors, len(anchors)),
    )
    assert "".join(json_pieces(report, details)) == f"{to_json(asdict(full))}\n"


@pytest.mark.slow
@pytest.mark.parametrize("audited", some(FORMS, 2, 1), indirect=True)
def test_how_much_is_read_at_once_changes_nothing(
    made: tuple[Any, Details], monkeypatch: pytest.MonkeyPatch
) -> None:
    report, details = made
    text, page = "".join(json_pieces(report, details)), html(report, details)
    monkeypatch.setattr(json_text, "_AT_ONCE", 2 * RUNS)  # two requirements, then the third
    assert "".join(json_pieces(report, details)) == text
    monkeypatch.setattr(json_text, "_AT_ONCE", 1)
    monkeypatch.setattr(reading, "_AT_ONCE", 1)
    assert ("".join(json_pieces(report, details)), html(report, details)) == (text, page)


def test_result_summaries_stand_by_requirement_in_their_order(audited: Path) -> None:
    summaries = ResultSummaries.of(opened(audited)).by_requirement
    assert {id: [place for place, _ in some] for id, some in summaries.items()} == {
        f"R{n}": [*range(n, 3 * RUNS, 3)] for n in range(3)
    }
