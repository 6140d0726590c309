"""`fretc report`: where each of its forms goes."""

import json
from pathlib import Path

import pytest

from fretc.report.forms.forms import FORMS
from tests.command import Fretc, write
from tests.fretc.report import cases


@pytest.fixture
def project(fretc: Fretc) -> Fretc:
    """A requirement that was audited."""
    known = cases.project(Path("requirements"))
    found = cases.evidence(known, cases.result(known, "satisfied"))
    write("build/evidence.json", json.dumps(found))
    return fretc


def test_the_page_is_made_where_nothing_is_named(project: Fretc) -> None:
    run = project("report")
    assert (run.status, run.out, run.err) == (0, "", "wrote build/report.html\n")


def test_the_page_is_opened_if_that_is_asked(
    project: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("click.launch", opened.append)
    assert project("report").status == 0
    assert opened == []
    assert project("report", "--open").status == 0
    assert project("report", "--open", "--html", "own.html", "--junit", "x.xml").status == 0
    assert project("report", "--open", "--format", "html").status == 0  # printed
    assert opened == ["build/report.html", "own.html"]


@pytest.mark.slow
@pytest.mark.parametrize("form", [name for name, form in FORMS.items() if form.missing() is None])
def test_a_form_is_the_same_by_its_own_option_and_by_format(project: Fretc, form: str) -> None:
    assert project("report", f"--{form}", "own").status == 0
    own = Path("own").read_bytes().decode()
    Path("build/report.html").unlink(missing_ok=True)
    printed = project("report", "--format", form)
    assert (printed.status, printed.out, printed.err) == (0, own, "")
    written = project("report", "--format", form, "-o", "new/file")
    assert (written.status, written.out, written.err) == (0, "", "wrote new/file\n")
    assert Path("new/file").read_bytes().decode() == own
    assert not Path("build/report.html").exists()


def test_one_output_is_the_page_and_others_may_stand_beside_it(project: Fretc) -> None:
    run = project("report", "-o", "page", "--csv", "rows")
    assert (run.status, run.err) == (0, "wrote page\nwrote rows\n")
    assert Path("page").read_text().startswith("<!DOCTYPE html>")
    assert not Path("build/report.html").exists()
    same = project("report", "-o", "one", "--csv", "./one")
    assert (same.status, Path("one").exists()) == (2, False)


def test_evidence_that_is_named_and_is_not_there_is_an_error(fretc: Fretc) -> None:
    write("requirements/r1.fret", "the robot shall always satisfy stopped\n")
    run = fretc("report", "--evidence", "build/evidense.json")
    assert (run.status, run.err.startswith("F901 ")) == (2, True)
    assert not Path("build/report.html").exists()
