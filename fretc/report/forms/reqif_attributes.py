"""The ReqIF attributes of each hazard and each requirement, as text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from enum import StrEnum

from fretc.audit.evidence.verdicts import CURRENT, SUSPECT, VERDICTS
from fretc.report.model import phrases
from fretc.report.model.results import ResultRow
from fretc.report.model.views import HazardView, RequirementView
from fretish.documents import STATUSES

_LISTED = 50


class AttributeType(StrEnum):
    """The data type of an attribute; the values are its name.

    Texts of people are XHTML, as tools expect for `ReqIF.Text`: a string has no line ends, and
    StrictDoc interprets backslashes and non-ASCII characters in strings as escapes.
    """

    ID = "string"
    TEXT = "xhtml"
    WORD = "enumeration"


HAZARD: Mapping[str, AttributeType] = {
    "ReqIF.ForeignID": AttributeType.ID,
    "ReqIF.Name": AttributeType.TEXT,
    "ReqIF.Text": AttributeType.TEXT,
    "Severity": AttributeType.TEXT,
    "Source": AttributeType.TEXT,
}
REQUIREMENT: Mapping[str, AttributeType] = {
    "ReqIF.ForeignID": AttributeType.ID,
    "ReqIF.Name": AttributeType.TEXT,
    "ReqIF.Text": AttributeType.TEXT,
    "Rationale": AttributeType.TEXT,
    "Parents": AttributeType.TEXT,
    "Sentence": AttributeType.TEXT,
    "Meaning": AttributeType.TEXT,
    "FT": AttributeType.TEXT,
    "FT finite": AttributeType.TEXT,
    "PT": AttributeType.TEXT,
    "Status": AttributeType.WORD,
    "Coverage": AttributeType.ID,  # Tools would read the commas in two of its values as separators.
    "Verdict": AttributeType.WORD,
    "Currency": AttributeType.WORD,
    "Reasons": AttributeType.TEXT,
    "Runs": AttributeType.TEXT,
    "Review": AttributeType.TEXT,
    "Fingerprint SHA-256": AttributeType.ID,
}
"""Attributes of a requirement, in the order in which tools show them."""
WORDS: Mapping[str, tuple[str, ...]] = {
    "Status": STATUSES,
    "Verdict": tuple(VERDICTS),
    "Currency": (CURRENT, SUSPECT),
}
"""Attribute → all its enumeration values."""
_FORMULAS = {"FT": "Future time", "FT finite": "Future time, finite", "PT": "Past time"}


def of_hazard(hazard: HazardView) -> Mapping[str, str]:
    """Attribute of `HAZARD` → text; "" if there is no value."""
    return {
        "ReqIF.ForeignID": hazard.id,
        "ReqIF.Name": " ".join(hazard.title.split()),
        "ReqIF.Text": hazard.text,
        "Severity": hazard.severity,
        "Source": hazard.source,
    }


def of_requirement(view: RequirementView) -> Mapping[str, str]:
    """Attribute of `REQUIREMENT` → text; "" if there is no value."""
    formulas = {formula.name: formula.text for formula in view.formulas}
    review = view.review
    return {
        "ReqIF.ForeignID": view.id,
        "ReqIF.Name": " ".join(view.title.split()),
        "ReqIF.Text": view.text,
        "Rationale": view.rationale,
        "Parents": ", ".join(parent.id for parent in view.parents),
        "Sentence": view.sentence,
        "Meaning": view.meaning,
        **{name: formulas.get(formula, "") for name, formula in _FORMULAS.items()},
        "Status": view.status,
        "Coverage": view.coverage,
        "Verdict": view.mark.word,
        "Currency": SUSPECT if view.mark.suspect else CURRENT,
        "Reasons": "\n".join((*_waived(view), *view.reasons)),
        "Runs": "\n".join(_runs(view)),
        "Review": f"{review.text}: {review.by}" if review.by else review.text,
        "Fingerprint SHA-256": view.fingerprint,
    }


def _waived(view: RequirementView) -> Iterator[str]:
    """The waiver and the verdict that it covers."""
    waiver = view.waiver
    if waiver is not None:
        yield f"waived until {waiver.until} by {waiver.by}: {waiver.reason}"
        yield f"without the waiver: {waiver.covers.text}"


def _runs(view: RequirementView) -> Iterator[str]:
    """Numbers of runs by verdict, the estimate, then each run, unsatisfied ones first."""
    ordered = sorted(view.results, key=lambda result: result.mark.severity)
    counts = Counter(result.mark.text for result in ordered)
    yield "; ".join(f"{text} in {phrases.times(n, 'run')}" for text, n in counts.items())
    if view.probability:
        yield f"all runs: {view.probability.mark.text}: {view.probability.reason}"
    yield from map(_run, ordered[:_LISTED])
    if len(ordered) > _LISTED:
        yield f"… and {phrases.times(len(ordered) - _LISTED, 'more run')}"


def _run(result: ResultRow) -> str:
    return (
        f"{result.run_file}: {result.mark.text}: {'; '.join([result.reason, *result.suspicions])}"
    )
