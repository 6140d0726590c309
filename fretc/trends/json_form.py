"""Trends as JSON: all items, in the order of the text."""

from __future__ import annotations

from typing import Any

from compiler.files.build_id import __version__
from compiler.files.records import plain
from compiler.files.templating import to_json
from fretc.trends.comparisons import VersionComparison, by_finding
from fretc.trends.histories import Round, counted
from fretc.trends.trends import Item, Trends

SCHEMA = "fretc-trends-1"


def text(trends: Trends) -> str:
    """The text of the whole file."""
    return f"{to_json(_plain(trends))}\n"


def _plain(trends: Trends) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "fretc": __version__,
        "by": trends.by,
        "order": trends.order,
        "runs": trends.runs,
        "rounds": [_round(each) for each in trends.rounds],
        "requirements": dict(trends.sentences),
        "items": [_item(item) for item in trends.items],
        "compared": {
            "before": trends.compared.before,
            "after": trends.compared.after,
            "level": trends.level,
            **{str(kind): count for kind, count in by_finding(trends.comparisons).items()},
        },
        "comparisons": [_comparison(comparison) for comparison in trends.comparisons],
    }


def _round(each: Round) -> dict[str, Any]:
    return {
        "name": each.name,
        "days": each.days,
        "runs": each.runs,
        "versions": list(each.versions),
        "selections": [plain(selection) for selection in each.selections],
    }


def _item(each: Item) -> dict[str, Any]:
    return {
        "requirement": each.requirement,
        "scenario": str(each.scenario),
        "comparable_by": each.scenario.kind,
        "change": str(each.change),
        "flaky": each.flaky,
        "requirement_changed": each.changed,
        "rounds": [dict(counted(verdicts)) for verdicts in each.rounds],
    }


def _comparison(each: VersionComparison) -> dict[str, Any]:
    return {
        "requirements": list(each.measure.requirements),
        "measure": str(each.measure),
        "unit": each.measure.unit,
        "finding": str(each.finding),
        "median_before": each.before,
        "median_after": each.after,
        "runs_before": each.runs_before,
        "runs_after": each.runs_after,
        "p": each.p,
    }
