"""Table of the formats of the report: the option and the writer of each.

Writers are imported when they are used, to keep the start of a command fast.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import unless_installed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from compiler.project.project import Project
    from fretc.report.model.views import ReportView
    from fretc.report.page.html import Inset
    from fretc.report.sections.details import Details


@dataclass(frozen=True, slots=True)
class FormInput:
    """The input of the writer of a format."""

    report: ReportView
    project: Project
    details: Details
    """The evidence behind its rows."""
    diagnostics: Sequence[Diagnostic]
    """Diagnostics of the report, in addition to those of the project."""
    inset: Inset | None = None
    """The page of `fretc play` to embed in the HTML page."""


@dataclass(frozen=True, slots=True)
class Form:
    """A format of the report."""

    name: str
    """The name of the option."""
    help: str
    text: Callable[[FormInput], str | Iterable[str]]
    """Writes the whole text, or pieces if it may not fit into memory."""
    default: str | None = None
    """The default path of the file; None if the format is only written on request."""
    missing: Callable[[], Diagnostic | None] = lambda: None
    """A diagnostic if a library for the format is not installed."""


def _html(subject: FormInput) -> str:
    from fretc.report.page.html import html

    return html(subject.report, subject.details, subject.project.formalized, subject.inset)


def _json(subject: FormInput) -> Iterable[str]:
    from fretc.report.forms.json_text import json_pieces

    return json_pieces(subject.report, subject.details)


def _csv(subject: FormInput) -> str:
    from fretc.report.forms.csv_rows import csv_text

    return csv_text(subject.report)


def _junit(subject: FormInput) -> str:
    from fretc.report.forms.junit import junit

    return junit(subject.report)


def _sarif(subject: FormInput) -> str:
    from fretc.report.forms.sarif import sarif

    project = subject.project
    diagnostics = [*project.diagnostics, *subject.diagnostics]
    return sarif(
        subject.report, subject.details, project.formalized, diagnostics, project.without_rule
    )


def _markdown(subject: FormInput) -> str:
    from fretc.report.forms.markdown import markdown

    return markdown(subject.report, subject.details)


def _reqif(subject: FormInput) -> str:
    from fretc.report.forms.reqif import reqif

    return reqif(subject.report)


def _gsn(subject: FormInput) -> str:
    from fretc.report.forms.gsn import gsn

    return gsn(subject.report)


FORMS: Mapping[str, Form] = {
    form.name: form
    for form in (
        Form("html", "HTML page: one file, works offline.", _html, default="build/report.html"),
        Form("json", "All content of the report, for programs.", _json),
        Form("csv", "One row for each requirement and run, for spreadsheets.", _csv),
        Form("junit", "One test case for each requirement and run, for CI servers.", _junit),
        Form("sarif", "Violations and open results, for code scanning.", _sarif),
        Form("markdown", "Summary, for a comment on a pull request.", _markdown),
        Form(
            "reqif",
            "Requirements and verdicts, for requirements management tools.",
            _reqif,
            missing=lambda: unless_installed("a report as ReqIF needs", ["reqif"], "reqif"),
        ),
        Form("gsn", "Assurance argument, as YAML for gsn2x.", _gsn),
    )
}
"""In the order of the help."""
