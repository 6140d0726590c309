"""The forms of the report, in one table: the option of each, and the text that it makes.

All are made of the same values. What makes a form is imported when the form is wanted.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from compiler.project.folder import Project
    from fretc.report.make import Made
    from fretc.report.model.views import Report
    from fretish.diagnostics.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class Subject:
    """What a form is made of."""

    made: Made
    report: Report
    project: Project


@dataclass(frozen=True, slots=True)
class Form:
    """A form of the report."""

    name: str
    """That of its option."""
    help: str
    text: Callable[[Subject], str]
    default: str | None = None
    """Where it goes where no place is given; None: it is not made then."""
    missing: Callable[[], Diagnostic | None] = lambda: None
    """What it needs and is not installed."""


def _html(subject: Subject) -> str:
    return subject.made.html or ""


def _json(subject: Subject) -> str:
    return subject.made.json or ""


def _csv(subject: Subject) -> str:
    from fretc.report.forms.csv_rows import csv_text

    return csv_text(subject.report)


def _junit(subject: Subject) -> str:
    from fretc.report.forms.junit import junit

    return junit(subject.report)


def _sarif(subject: Subject) -> str:
    from fretc.report.forms.sarif import sarif

    project = subject.project
    messages = [*project.diagnostics, *subject.made.diagnostics]
    results = subject.made.results
    return sarif(subject.report, results, project.rules, messages, project.without_rule)


def _markdown(subject: Subject) -> str:
    from fretc.report.forms.markdown import markdown

    return markdown(subject.report)


def _reqif(subject: Subject) -> str:
    from fretc.report.forms.reqif import reqif

    return reqif(subject.report)


def _missing_reqif() -> Diagnostic | None:
    from fretc.report.forms.extras import missing_reqif

    return missing_reqif()


def _gsn(subject: Subject) -> str:
    from fretc.report.forms.gsn import gsn

    return gsn(subject.report)


FORMS: Mapping[str, Form] = {
    form.name: form
    for form in (
        Form("html", "One file, offline.", _html, default="build/report.html"),
        Form("json", "What the report says, for programs.", _json),
        Form("csv", "A row for each requirement and run, for a spreadsheet.", _csv),
        Form("junit", "A test case for each requirement, for a CI server.", _junit),
        Form("sarif", "What the runs show, for code scanning.", _sarif),
        Form("markdown", "A comment for a pull request.", _markdown),
        Form(
            "reqif",
            "Requirements and verdicts, for a requirements tool.",
            _reqif,
            missing=_missing_reqif,
        ),
        Form("gsn", "The assurance argument, as YAML that gsn2x reads.", _gsn),
    )
}
"""In the order of the help."""
