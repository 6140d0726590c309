"""Everything that is known of a requirement, as plain values for JSON."""

from __future__ import annotations

from typing import Any

from compiler.files.build_id import __version__
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from fretish import syntax
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import as_json
from fretish.documents import Requirement
from fretish.meaning import meaning
from fretish.printer import canonical, expression

SCHEMA = "fretc-requirement-1"


def formulas(rule: FormalizedRequirement) -> dict[str, Any]:
    """The object of `--emit ltl --format json`.

    `ft_infinite` is LTL that Spot reads; `ft_finite` may use `LAST`; `pt` is for the last point.
    """
    tree = rule.sentence
    return {
        "id": rule.id,
        "sentence": wording(rule.requirement),
        "component": tree.component,
        "scope": syntax.scope_key(tree),
        "condition": syntax.condition_key(tree),
        "timing": syntax.timing_key(tree),
        "variables": list(rule.variables),
        "durations": [] if rule.ticks is None else [rule.ticks],
        "ft_infinite": printing.future(rule.ft_infinite),
        "ft_finite": printing.future(rule.ft_finite),
        "pt": printing.past(rule.pt),
        "pctl": printing.pctl(rule.pctl) if rule.pctl else None,
    }


def failed(requirement: Requirement, diagnostic: Diagnostic) -> dict[str, Any]:
    """The object of a requirement that could not be formalized."""
    return {
        "id": requirement.id,
        "sentence": wording(requirement),
        "error": as_json(diagnostic),
    }


def wording(requirement: Requirement) -> str:
    """The sentence as written, on one line."""
    return " ".join(requirement.wording.text.split())


def record(rule: FormalizedRequirement) -> dict[str, Any]:
    """The object of `--emit json`; its schema is `templates/json/requirement.schema.json`."""
    requirement, tree = rule.requirement, rule.written
    return {
        "schema": SCHEMA,
        "fretc": __version__,
        **formulas(rule),
        "canonical": canonical(tree),
        "fingerprint": rule.fingerprint,
        "meaning": meaning(tree, rule.ticks, rule.clock),
        "readable": {
            "ft_infinite": printing.readable(rule.ft_infinite),
            "ft_finite": printing.readable(rule.ft_finite),
            "pt": printing.readable(rule.pt),
        },
        "response": expression(tree.response),
        "tick_ns": rule.clock.period if rule.clock else None,
        "title": requirement.title,
        "text": requirement.text,
        "parents": list(requirement.parents),
        "rationale": requirement.rationale,
        "status": requirement.status,
        "verify": list(requirement.verify),
        "params": dict(requirement.params),
        **({"accept": dict(requirement.accept)} if requirement.accept else {}),
        "source": requirement.wording.source.name,
        "line": requirement.wording.line,
    }
