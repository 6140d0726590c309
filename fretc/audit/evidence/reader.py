"""The evidence file as checked values: the results of audits, or why that cannot be read.

Nothing in the file is trusted: what its types (`fretc.audit.evidence.schema`) do not have is F503,
never a report about half of it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace

from compiler.files.checked_json import MisshapenError, parsed
from compiler.files.records import decoded
from compiler.files.text_files import read as read_text
from compiler.files.text_files import sha256
from fretc.audit.evidence.schema import Document, Evidence, Result
from fretc.audit.measurements.confidence_intervals import REFUTED
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Source
from monitors import kernel

VERDICTS = (
    kernel.VIOLATED,
    kernel.NO_DATA,
    kernel.INCONCLUSIVE,
    kernel.VACUOUS,
    kernel.SATISFIED,
)
"""What an audit can say, the worst first."""


def by_requirement(evidence: Evidence | None) -> Mapping[str, Sequence[Result]]:
    """The results of each requirement that has any, in the order of the evidence."""
    results_of: dict[str, list[Result]] = {}
    for result in evidence.results if evidence else ():
        results_of.setdefault(result.requirement, []).append(result)
    return results_of


def refuted(path: str) -> frozenset[str]:
    """The requirements that all runs together refute; none where there is no evidence."""
    evidence = read(path)
    estimates = () if isinstance(evidence, Diagnostic) else evidence.probabilities
    return frozenset(one.requirement for one in estimates if one.answer == REFUTED)


def read(path: str) -> Evidence | Diagnostic:
    """Read and check an evidence file; a note, not an error, where there is none yet."""
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return _not_audited(path) if source.code is Code.NO_SUCH_FILE else source
    return _parsed(source)


def _parsed(source: Source) -> Evidence | Diagnostic:
    path = source.name
    try:
        file = parsed(source.text)
    except json.JSONDecodeError as error:
        return _not_json(source, error)
    except (ValueError, RecursionError) as error:
        return _wrong(path, f"is not JSON that fretc can read: {_why(error)}")
    try:
        return Evidence(source.name, sha256(source.text), decoded(file.value, Document))
    except MisshapenError as error:
        return _wrong(path, f"is not evidence of fretc: {error}")


def required(path: str) -> Evidence | Diagnostic:
    """The same; an error where there is none."""
    evidence = read(path)
    return (
        replace(evidence, severity=Severity.ERROR) if isinstance(evidence, Diagnostic) else evidence
    )


def _not_audited(path: str) -> Diagnostic:
    """F901 as a note: a report before the first audit has no results."""
    return Diagnostic(
        Code.NO_SUCH_FILE,
        f"no run has been audited: there is no evidence in `{path}`",
        help=f"audit a run: `fretc audit LOG... -o {path}`",
        severity=Severity.NOTE,
    )


def _not_json(source: Source, error: json.JSONDecodeError) -> Diagnostic:
    at = min(error.pos, max(0, len(source.text) - 1))
    return Diagnostic(
        Code.BAD_EVIDENCE,
        f"the evidence is not JSON: {error.msg[:1].lower()}{error.msg[1:]}",
        source.span(at, at + 1),
        help=f"audit again: `fretc audit LOG... -o {source.name}`",
    )


def _wrong(path: str, what: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_EVIDENCE,
        f"`{path}` {what}",
        Source(path, "").span(),
        help=f"audit again: `fretc audit LOG... -o {path}`",
    )


def _why(error: Exception) -> str:
    return "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
