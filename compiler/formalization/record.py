"""A requirement with its formulas, as plain values for JSON."""

from __future__ import annotations

from typing import Any

from compiler.files.build_id import __version__
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from fretish import syntax
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import as_json
from fretish.documents import RequirementEntry
from fretish.meaning import meaning
from fretish.printer import canonical, expression

SCHEMA = "fretc-requirement-1"


def formulas(requirement: FormalizedRequirement) -> dict[str, Any]:
    """The object of `--emit ltl --format json`.

    `ft_infinite` is LTL that Spot reads; `ft_finite` may use `LAST`; `pt` is for the last point.
    """
    tree = requirement.sentence
    return {
        "id": requirement.id,
        "sentence": wording(requirement.entry),
        "component": tree.component,
        "scope": syntax.scope_key(tree),
        "condition": syntax.condition_key(tree),
        "timing": syntax.timing_key(tree),
        "variables": list(requirement.variables),
        "durations": [] if requirement.ticks is None else [requirement.ticks],
        "ft_infinite": printing.future(requirement.ft_infinite),
        "ft_finite": printing.future(requirement.ft_finite),
        "pt": printing.past(requirement.pt),
        "pctl": printing.pctl(requirement.pctl) if requirement.pctl else None,
    }


def failed(requirement: RequirementEntry, diagnostic: Diagnostic) -> dict[str, Any]:
    """The object of a requirement that could not be formalized."""
    return {
        "id": requirement.id,
        "sentence": wording(requirement),
        "error": as_json(diagnostic),
    }


def wording(requirement: RequirementEntry) -> str:
    """The sentence as written, on one line."""
    return " ".join(requirement.wording.text.split())


def record(requirement: FormalizedRequirement) -> dict[str, Any]:
    """The object of `--emit json`; its schema is `templates/json/requirement.schema.json`."""
    entry, tree = requirement.entry, requirement.written
    return {
        "schema": SCHEMA,
        "fretc": __version__,
        **formulas(requirement),
        "canonical": canonical(tree),
        "fingerprint": requirement.fingerprint,
        "meaning": meaning(tree, requirement.ticks, requirement.clock),
        "readable": {
            "ft_infinite": printing.readable(requirement.ft_infinite),
            "ft_finite": printing.readable(requirement.ft_finite),
            "pt": printing.readable(requirement.pt),
        },
        "response": expression(tree.response),
        "tick_ns": requirement.clock.period if requirement.clock else None,
        "title": entry.title,
        "text": entry.text,
        "parents": list(entry.parents),
        "rationale": entry.rationale,
        "status": entry.status,
        **({"kind": entry.kind} if entry.is_assumption else {}),
        "verify": list(entry.verify),
        "params": dict(entry.params),
        **({"accept": dict(entry.accept)} if entry.accept else {}),
        "source": entry.wording.source.name,
        "line": entry.wording.line,
    }
