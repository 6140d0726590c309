"""Diagram and traces of a requirement in Markdown, for an editor."""

from __future__ import annotations

import base64
from collections.abc import Iterator

from compiler.explanation import drawing
from compiler.explanation.explain import Explanation, explanation, table
from compiler.formalization.formalized import FormalizedRequirement
from fretish.reading.limits import ExceededError, stoppable

_MOST_TICKS = 1000
"""The longest duration that is drawn: a diagram has a column for each tick."""
_SECONDS = 0.2
"""CPU seconds for diagram and traces; a requirement that takes longer has none."""


def lines(requirement: FormalizedRequirement, *, as_image: bool) -> Iterator[str]:
    """Markdown lines with a diagram, a trace that satisfies and one that violates.

    Args:
        requirement: the requirement.
        as_image: whether the diagram is an SVG image, or else text.
    """
    explained = _explained(requirement)
    if explained is None:
        return
    if as_image:
        svg = base64.b64encode(drawing.svg(explained.picture).encode()).decode()
        yield f"![diagram](data:image/svg+xml;base64,{svg})"
        yield ""
    yield "```"
    if not as_image:
        yield drawing.text(explained.picture)
        yield ""
    for verdict in (True, False):
        first = next((each for each in explained.traces if each.satisfied is verdict), None)
        if first is not None:
            yield table(explained, first)
    yield "```"


def _explained(requirement: FormalizedRequirement) -> Explanation | None:
    if (requirement.ticks or 0) > _MOST_TICKS:
        return None
    try:
        with stoppable(lambda: False, _SECONDS):
            return explanation(requirement)
    except ExceededError:
        return None
