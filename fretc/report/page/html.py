"""The report as one HTML file: every text made visible, every picture laid out, then placed."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

from compiler.explanation.diagram import diagram
from compiler.explanation.drawing import drawing as diagram_drawing
from compiler.files.templating import render
from compiler.formalization.formalized import Formalized
from fretc.report.model.phrases import visible
from fretc.report.model.views import Report
from fretc.report.page.selection import Selection, selection, slimmed
from fretc.report.page.tree import MOST, NAMES, Placement, grouped, pieces, placements, shortened
from fretc.report.pictures.plots import drawing, histogram
from fretc.report.pictures.scales import scale
from fretc.report.sections.argument import argument

_SCRIPT, _STYLE = "report/page.js.j2", "report/style.css.j2"


def html(report: Report, rules: Sequence[Formalized] = ()) -> str:
    """The whole file.

    Args:
        report: what it says.
        rules: those whose meaning is drawn.
    """
    chosen = selection(report)
    page = slimmed(report, chosen)
    script, style = render(_SCRIPT), render(_STYLE)
    return render(
        "report/report.html.j2",
        report=_visible(asdict(page)),
        chosen=_visible(asdict(replace(chosen, anchors=frozenset()))),
        anchors=chosen.anchors,
        pictures=_visible(_pictures(chosen)),
        histograms=_visible(_histograms(page)),
        scales=_visible(_scales(page)),
        diagrams=_diagrams(page, rules),
        argument=_visible(_argument(report)),
        script_hash=_hash(script),
        style_hash=_hash(style),
    )


def _hash(text: str) -> str:
    """As a Content-Security-Policy names an inline script or style.

    Source: Content Security Policy Level 3, section 2.3.1, hash-source.
    """
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _pictures(chosen: Selection) -> dict[str, list[dict[str, Any]]]:
    """Of each result with details its timelines."""
    return {
        result.anchor: [
            asdict(drawing(timeline, f"picture-{result.anchor}.{number}"))
            for number, timeline in enumerate(result.timelines, 1)
        ]
        for section in chosen.by_anchor.values()
        for result in (*section.details, *section.folded)
    }


def _histograms(page: Report) -> dict[str, list[dict[str, Any]]]:
    return {
        view.anchor: [
            asdict(histogram(each, f"histogram-{view.anchor}.{number}"))
            for number, each in enumerate(view.histograms, 1)
        ]
        for view in page.requirements
    }


def _diagrams(page: Report, rules: Sequence[Formalized]) -> Mapping[str, dict[str, Any]]:
    """What each sentence means, drawn; the drawing makes its own texts visible."""
    rules_by_key = {(rule.id, rule.fingerprint): rule for rule in rules}
    diagrams = {}
    for view in page.requirements:
        rule = rules_by_key.get((view.id, view.fingerprint))
        if view.diagram and rule is not None:
            diagrams[view.anchor] = asdict(diagram_drawing(diagram(rule), f"means-{view.anchor}"))
    return diagrams


def _argument(report: Report) -> dict[str, Any]:
    """The tree drawn, the same as a list, and how many elements there are in all."""
    whole = argument(report)
    few = grouped(whole)
    drawn = shortened(few)
    return {
        "total": len(whole),
        "most": MOST,
        "is_short": len(drawn) < len(few),
        "pieces": [asdict(piece) for piece in pieces(drawn)],
        "items": _nested(placements(drawn)),
    }


def _nested(flat: Sequence[Placement]) -> list[dict[str, Any]]:
    """Each element with how many lists open before it and close after it."""
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


def _scales(page: Report) -> dict[str, dict[str, Any]]:
    """Of each probability its scale."""
    return {
        view.anchor: asdict(scale(view.probability, f"picture-{view.anchor}"))
        for view in page.requirements
        if view.probability is not None
    }


def _visible(value: Any) -> Any:
    """The same, with every character to be seen: no text can hide, turn or cut another one."""
    match value:
        case str():
            return visible(value)
        case dict():
            return {visible(key): _visible(item) for key, item in value.items()}
        case list() | tuple():
            return [_visible(item) for item in value]
        case _:
            return value
