"""Fingerprints of the nodes of a chain: white space, comments and order do not change them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from compiler.files.build_id import __version__
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from compiler.project.hazards import Hazard
from fretc.audit.evidence import verdict_inputs
from fretc.audit.evidence.result_summaries import Recorded, ResultSummary
from fretc.audit.evidence.verdict_inputs import VerdictInputs
from fretc.traceability import texts
from fretish.bindings.canonical import digest

IN_FORCE = digest("in force")
"""The fingerprint of the status of a draft or approved requirement."""


def print_of_status(status: str) -> str:
    """Fingerprint of a status: drafts and approved requirements share one."""
    return digest("retired") if status == "retired" else IN_FORCE


def outdated(recorded: Recorded, audited_by: str, now: VerdictInputs) -> tuple[str, ...]:
    """The kinds of inputs of a result that have changed since its audit."""
    then = {
        **dict(zip(verdict_inputs.KINDS, recorded, strict=True)),
        verdict_inputs.FRETC: audited_by,
    }
    return verdict_inputs.outdated(then, {**now, verdict_inputs.FRETC: __version__})


def print_of_log(result: ResultSummary) -> str:
    """SHA-256 of the log, or of its summary if the audit read only its index; or "" if unknown."""
    return result.log or result.fingerprints.log_summary or ""


def print_of_header(header: texts.ParentRequirement) -> str:
    """The texts and parents of a requirement, without status and planned methods."""
    words = [header.title, header.text, header.rationale]
    kind = {"kind": header.kind} if header.kind else {}
    return digest({"texts": _normal(words), "parents": sorted(header.parents), **kind})


def print_of_hazard(hazard: Hazard) -> str:
    """Fingerprint of the texts and the id of a hazard."""
    return print_of_words(asdict(hazard))


def print_of_words(value: Any) -> str:
    """Fingerprint of texts, without regard to white space."""
    return digest(_normal(value))


def print_of_proof(result: str, assumptions: Iterable[str]) -> str:
    """Fingerprint of the result and the assumptions of a proof or analysis."""
    return digest([result, sorted(assumptions)])


def print_of_formulas(requirement: FormalizedRequirement) -> str:
    """Fingerprint of the formulas of a requirement, as a reader sees them."""
    formulas = [requirement.ft_infinite, requirement.ft_finite, requirement.pt]
    return digest([printing.readable(formula) for formula in formulas])


def _normal(value: Any) -> Any:
    """The value with white space in texts made uniform."""
    match value:
        case str():
            return " ".join(value.split())
        case dict():
            return {key: _normal(item) for key, item in value.items()}
        case list():
            return [_normal(item) for item in value]
        case _:
            return value
