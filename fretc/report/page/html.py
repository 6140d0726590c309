"""The report as one HTML file; the template only places finished texts and pictures."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

from compiler.explanation.diagram import diagram
from compiler.explanation.drawing import DiagramDrawing
from compiler.explanation.drawing import drawing as diagram_drawing
from compiler.files import log_viewer
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from fretc.report.across.layout import drawn_lanes, drawn_map, drawn_uses
from fretc.report.model.changes import RequirementChanges, follows, new_violations
from fretc.report.model.phrases import joined, times, visible
from fretc.report.model.pictures import Timeline
from fretc.report.model.sets import SetConflict
from fretc.report.model.views import ReportView
from fretc.report.page.matrix import Picture, picture
from fretc.report.page.selection import PageContent, selection, slimmed
from fretc.report.page.sheets import MOST_COLUMNS, sheet_style
from fretc.report.page.tree import MOST, NAMES, Placement, grouped, pieces, placements, shortened
from fretc.report.pictures.plots import drawing, histogram, probability
from fretc.report.sections.argument import argument
from fretc.report.sections.details import Details
from fretc.report.set_analysis.drawing import drawing as play_drawing
from fretish.classes.frozen import dataclass

_MOST_CHANGES, _MOST_RUNS = 100, 20
"""Maximum listed changes, and maximum listed runs with a changed verdict per requirement."""
_SCRIPT, _STYLE = "report/page.js.j2", "report/style.css.j2"


@dataclass(frozen=True, slots=True)
class Inset:
    """A page embedded in the report, which a button opens at a requirement."""

    text: str
    requirements: frozenset[str]
    """Ids of the requirements on the embedded page."""
    scripts: tuple[str, ...]
    """The hash sources of its scripts, because the policies of both pages apply."""
    style: str


def html(
    report: ReportView,
    details: Details,
    requirements: Sequence[FormalizedRequirement] = (),
    inset: Inset | None = None,
) -> str:
    """The HTML page.

    Args:
        report: the report.
        details: the evidence behind the rows of the report.
        requirements: formalized requirements; the page has a diagram of each.
        inset: the page of `fretc play`; None if it is not embedded.
    """
    choice = selection(report, details)
    page = slimmed(report, choice)
    matrix = picture(report, choice.anchors)
    script, style, sheets = render(_SCRIPT), render(_STYLE), sheet_style(report)
    return render(
        "report/report.html.j2",
        times=times,
        report=visible_texts(page),
        selection=visible_texts(choice),
        anchors=choice.anchors,
        pictures=visible_texts(_pictures(choice, details.project.viewer)),
        histograms=visible_texts(_histograms(choice, details)),
        scales=visible_texts(_scales(page)),
        diagrams=_diagrams(page, requirements),
        matrix=visible_texts(matrix),
        rows=_rows(matrix),
        argument=visible_texts(_argument(report)),
        plays=visible_texts(_plays(report)),
        across=visible_texts(_across(report, choice, _links(choice))),
        changes=visible_texts({change.anchor: change for change in page.changes if change.anchor}),
        consequences=_consequences(page.changes),
        stale=[change for change in page.changes if not change.is_root],
        most=_MOST_CHANGES,
        most_runs=_MOST_RUNS,
        inset=inset,
        script_hashes=[hash_source(script), *(inset.scripts if inset else ())],
        sheets=sheets,
        most_columns=MOST_COLUMNS,
        style_hashes=[hash_source(style), hash_source(sheets), *([inset.style] if inset else ())],
    )


def _consequences(changes: Sequence[RequirementChanges]) -> list[dict[str, Any]]:
    """The changes with consequences, those with the most new violations first."""
    found = [
        {
            **visible_texts(change),
            "new_violations": new_violations(change),
            "follows": visible_texts(follows(change)),
        }
        for change in changes
        if change.is_root and follows(change)
    ]
    return sorted(found, key=lambda each: -int(each["new_violations"]))


def hash_source(text: str) -> str:
    """The hash of an inline script or style, as a Content-Security-Policy source.

    Source: Content Security Policy Level 3, section 2.3.1, hash-source.
    """
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _pictures(choice: PageContent, viewer: str) -> dict[str, list[dict[str, Any]]]:
    """Anchor of a result with details → its timelines, each with a link to its log."""
    return {
        result.anchor: [
            drawing(timeline, f"picture-{result.anchor}.{number}")
            | _log_link(timeline, result.run_file, viewer)
            for number, timeline in enumerate(result.timelines, 1)
        ]
        for section in choice.by_anchor.values()
        for result in (*section.details, *section.folded)
    }


def _log_link(timeline: Timeline, log: str, viewer: str) -> dict[str, str]:
    """The link to the log at the first violated tick; empty without a viewer or a violation."""
    if not viewer or timeline.broken is None or timeline.epoch_ns is None:
        return {"log": ""}
    at = timeline.epoch_ns + round(timeline.broken.start * 1e9)
    return {"log": log_viewer.link(viewer, log, at), "log_host": log_viewer.host(viewer)}


def _plays(report: ReportView) -> dict[str, list[dict[str, Any] | None]]:
    """The pictures of the runs of conflicts and of inconsistencies."""
    if report.analysis is None:
        return {}
    parts = {"conflict": report.analysis.conflicts, "clash": report.analysis.clashes}
    return {
        kind: [
            _play(each, f"{kind}-{number}", breaks=kind == "conflict")
            for number, each in enumerate(several, 1)
        ]
        for kind, several in parts.items()
    }


def _play(conflict: SetConflict, id: str, *, breaks: bool) -> dict[str, Any] | None:
    names = joined([member.requirement for member in conflict.members])
    return play_drawing(conflict.play, id, f"A run with {names}", breaks=breaks)


def _links(choice: PageContent) -> frozenset[str]:
    """The anchors of pictures, results and runs on the page, to which pictures can link."""
    return choice.anchors | {
        f"picture-{result.anchor}.{number}"
        for section in choice.by_anchor.values()
        for result in (*section.details, *section.folded)
        for number, _ in enumerate(result.timelines, 1)
    }


def _across(report: ReportView, choice: PageContent, links: frozenset[str]) -> dict[str, Any]:
    """The pictures over all runs, for all requirements and for the worst ones by their anchors."""
    everything = report.across.lanes
    return {
        "lanes": everything and drawn_lanes(everything, "across-lanes", links),
        "maps": [drawn_map(each, f"map-{each.anchor}", links) for each in report.across.maps],
        "maps_left_out": report.across.maps_left_out,
        "requirements": {
            requirement.anchor: {
                "lanes": requirement.lanes
                and drawn_lanes(requirement.lanes, f"lanes-{requirement.anchor}", links),
                "uses": requirement.uses
                and drawn_uses(requirement.uses, f"uses-{requirement.anchor}", links),
            }
            for requirement in report.across.requirements
            if not choice.by_anchor[requirement.anchor].is_short
        },
    }


def _histograms(choice: PageContent, details: Details) -> dict[str, list[dict[str, Any]]]:
    whole = [] if choice.is_compact else [*choice.by_anchor]
    drawn: dict[str, list[dict[str, Any]]] = {anchor: [] for anchor in choice.by_anchor}
    for anchor, some in details.histograms(whole):
        drawn[anchor] = [
            histogram(each, f"histogram-{anchor}.{number}") for number, each in enumerate(some, 1)
        ]
    return drawn


def _rows(matrix: Picture) -> dict[str, str]:
    """Anchor of a requirement → anchor of its first row in the matrix, if it has such rows."""
    lines = (line for block in matrix.blocks for line in block.lines if line.id)
    return {line.row.anchor: line.id for line in lines}


def _diagrams(
    page: ReportView, requirements: Sequence[FormalizedRequirement]
) -> Mapping[str, DiagramDrawing]:
    """Anchor of a requirement → diagram of its meaning, with escaped texts."""
    rules_by_key = {
        (requirement.id, requirement.fingerprint): requirement for requirement in requirements
    }
    diagrams = {}
    for view in page.requirements:
        requirement = rules_by_key.get((view.id, view.fingerprint))
        if view.diagram and requirement is not None:
            diagrams[view.anchor] = diagram_drawing(diagram(requirement), f"means-{view.anchor}")
    return diagrams


def _argument(report: ReportView) -> dict[str, Any]:
    """The argument as a tree and as a list, and the number of its elements."""
    whole = argument(report)
    groups = grouped(whole)
    short = shortened(groups)
    return {
        "total": len(whole),
        "most": MOST,
        "is_short": len(short) < len(groups),
        "pieces": pieces(short),
        "items": _nested(placements(short)),
    }


def _nested(flat: Sequence[Placement]) -> list[dict[str, Any]]:
    """Each element with the number of lists that open before it and close after it."""
    items = []
    for i, each in enumerate(flat):
        after = flat[i + 1].depth if i + 1 < len(flat) else 0
        undeveloped = each.element.undeveloped and not each.is_reference
        states = ["undeveloped" if undeveloped else "", each.state]
        items.append(
            {
                "kind": NAMES[each.element.kind],
                "text": each.text,
                "state": ", ".join(filter(None, states)),
                "opens": after > each.depth,
                "closes": max(0, each.depth - after),
            }
        )
    return items


def _scales(page: ReportView) -> dict[str, dict[str, Any]]:
    """Anchor of a requirement → scale of its probability."""
    return {
        view.anchor: probability(
            view.probability, f"Probability of {view.id}", f"picture-{view.anchor}"
        )
        for view in page.requirements
        if view.probability is not None
    }


def visible_texts(value: Any) -> Any:
    """The value for a template: without dataclasses, and with escapes for hidden characters."""
    match value:
        case str():
            return visible(value)
        case dict():
            return {visible(key): visible_texts(item) for key, item in value.items()}
        case list() | tuple():
            return [visible_texts(item) for item in value]
        case _ if is_dataclass(value):
            return {each.name: visible_texts(getattr(value, each.name)) for each in fields(value)}
        case _:
            return value
