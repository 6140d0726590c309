"""The assurance argument as an indented tree, in pieces that fit on a page.

Each element is a shape of GSN. An element with several parents stands below the first of them;
the others have a reference to it. A dashed line with an open arrowhead joins counter-evidence to
its goal. A defeated goal has a cross.

Source of the shapes: GSN Community Standard, version 3 (2021), part 1, with its dialectic
extension.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from typing import Any

from fretc.report.sections.argument import Element, ElementKind
from fretish.classes.frozen import dataclass

MOST = 120
"""Maximum elements of a drawing; a larger argument is drawn without supported goals."""
_WIDTH, _INDENT, _MARGIN = 720, 26, 4
_LINE, _PAD, _GAP = 15, 9, 12
_LETTER = 6.1
_LINES = 3
_TALL = 880
"""Maximum height of a piece, which fits on a page of A4."""
_ASSUMED = 4
"""Above this number, the assumptions of a goal are merged into one shape."""
_ROUND = (
    ElementKind.SOLUTION,
    ElementKind.COUNTER_SOLUTION,
    ElementKind.ASSUMPTION,
    ElementKind.JUSTIFICATION,
)
NAMES = {kind: kind.name.capitalize().replace("_", "-") for kind in ElementKind}


class ElementRelation(StrEnum):
    """The relation of an element to the one above it."""

    SUPPORT = "support"
    CONTEXT = "context"
    CHALLENGE = "challenge"


@dataclass(frozen=True, slots=True)
class Placement:
    """An element at its position in the tree."""

    element: Element
    depth: int
    relation: ElementRelation
    is_reference: bool = False
    """Whether this is a reference to the same element further up."""
    is_challenged: bool = False
    is_in_doubt: bool = False
    """Whether the element or an element that supports it is challenged."""

    @property
    def text(self) -> str:
        """The text in its shape."""
        element = self.element
        return f"{element.name or element.text}: see above" if self.is_reference else element.text

    @property
    def state(self) -> str:
        """`defeated`, `challenged` or `in doubt`; "" without counter-evidence."""
        if self.element.defeated:
            return "defeated"
        return "challenged" if self.is_challenged else "in doubt" if self.is_in_doubt else ""


def placements(elements: Sequence[Element]) -> tuple[Placement, ...]:
    """All elements from the top goal down: in full at the first place, then as references."""
    by_id = {element.id: element for element in elements}
    against = _challengers(elements)
    in_doubt = _above(set(against), by_id)
    drawn: set[str] = set()
    tree: list[Placement] = []
    waiting = [(element.id, 0, ElementRelation.SUPPORT) for element in elements[:1]]
    while waiting:
        id, depth, relation = waiting.pop()
        element = by_id[id]
        tree.append(Placement(element, depth, relation, id in drawn, id in against, id in in_doubt))
        if id in drawn:
            continue
        drawn.add(id)
        below = [
            *((other, depth + 1, ElementRelation.CONTEXT) for other in element.in_context_of),
            *((other, depth + 1, ElementRelation.CHALLENGE) for other in against.get(id, ())),
            *((other, depth + 1, ElementRelation.SUPPORT) for other in element.supported_by),
        ]
        waiting.extend(reversed(below))
    return tuple(tree)


def _challengers(elements: Sequence[Element]) -> Mapping[str, Sequence[str]]:
    """The counter-evidence against each challenged element, by its id."""
    challengers: dict[str, list[str]] = {}
    for element in elements:
        if element.challenges:
            challengers.setdefault(element.challenges, []).append(element.id)
    return challengers


def _above(ids: Collection[str], by_id: Mapping[str, Element]) -> set[str]:
    """These elements, and all elements that they support, directly or indirectly."""
    above: dict[str, list[str]] = {}
    for element in by_id.values():
        for other in element.supported_by:
            above.setdefault(other, []).append(element.id)
    above_ids, waiting = set(ids), list(ids)
    while waiting:
        for id in above.get(waiting.pop(), ()):
            if id not in above_ids:
                above_ids.add(id)
                waiting.append(id)
    return above_ids


def shortened(elements: Sequence[Element]) -> tuple[Element, ...]:
    """The elements of a drawing: all of them, or those that a reader must see, at most `MOST`.

    Counter-evidence and the goals above it come first, then undeveloped goals and the goals above
    them. Goals that are developed and unchallenged are left out, and so are solutions and context.
    """
    if len(elements) <= MOST:
        return tuple(elements)
    by_id = {element.id: element for element in elements}
    against = _challengers(elements)
    worst = _above(set(against), by_id) | {each for ids in against.values() for each in ids}
    open_ = {elements[0].id} | _above({e.id for e in elements if e.undeveloped}, by_id)
    wanted = [
        *(element.id for element in elements if element.id in worst),
        *(element.id for element in elements if element.id in open_ - worst),
    ]
    ids = set(wanted[:MOST])
    kept = [element for element in elements if element.id in ids]
    return tuple(
        replace(
            element,
            supported_by=tuple(id for id in element.supported_by if id in ids),
            in_context_of=(),
        )
        for element in kept
    )


def grouped(elements: Sequence[Element]) -> tuple[Element, ...]:
    """The elements, with many assumptions of a goal merged; “Assumptions” lists them."""
    kinds = {element.id: element.kind for element in elements}
    kept: list[Element] = []
    replaced: set[str] = set()
    for element in elements:
        assumed = [id for id in element.in_context_of if kinds[id] is ElementKind.ASSUMPTION]
        if len(assumed) <= _ASSUMED:
            kept.append(element)
            continue
        replaced.update(assumed)
        id = f"{assumed[0]}_and_others"
        around = tuple(each for each in element.in_context_of if each not in assumed)
        kept.append(replace(element, in_context_of=(*around, id)))
        kept.append(
            Element(id, ElementKind.ASSUMPTION, f"{len(assumed)} assumptions, listed below")
        )
    return tuple(element for element in kept if element.id not in replaced)


# Layout ----------------------------------------------------------------------------------------


def pieces(elements: Sequence[Element]) -> list[dict[str, Any]]:
    """The drawing in pieces, one for each page, as values for the template."""
    groups: list[list[Placement]] = [[]]
    height = 0.0
    for cluster in _clusters(placements(elements)):
        tall = sum(map(_height, cluster))
        if groups[-1] and (height + tall > _TALL or _begins(cluster[0], height)):
            groups.append([])
            height = 0.0
        groups[-1] += cluster
        height += tall
    return [_piece(group, i, len(groups)) for i, group in enumerate(groups, 1) if group]


def _clusters(flat: Sequence[Placement]) -> Iterator[list[Placement]]:
    """The groups that stay on one page: an element with its context and its counter-evidence."""
    cluster: list[Placement] = []
    height = 0.0
    for placement in flat:
        height += _height(placement)
        if cluster and (placement.relation is ElementRelation.SUPPORT or height > _TALL):
            yield cluster
            cluster, height = [], _height(placement)
        cluster.append(placement)
    if cluster:
        yield cluster


def _begins(each: Placement, height: float) -> bool:
    """Whether a new page begins here: no hazard begins near the end of a page."""
    return each.depth <= 2 and each.relation is ElementRelation.SUPPORT and height > 0.75 * _TALL


def _piece(group: Sequence[Placement], number: int, count: int) -> dict[str, Any]:
    shapes: list[dict[str, Any]] = []
    above: dict[int, tuple[float, float]] = {}
    y = 6.0
    for placement in group:
        shapes.append(_shape(placement, y, above))
        y += _height(placement)
    part = f", part {number} of {count}" if count > 1 else ""
    text = f"{len(group)} elements, from “{group[0].text}”; the list below has them all."
    texts = {"id": f"argument-{number}", "title": f"Assurance argument{part}", "text": text}
    return {**texts, "width": _WIDTH, "height": y, "shapes": shapes}


def _shape(each: Placement, y: float, above: dict[int, tuple[float, float]]) -> dict[str, Any]:
    """An element laid out; `path` is its outline, `link` leads from the element above."""
    element, depth = each.element, each.depth
    x = _MARGIN + _INDENT * depth + 10
    width = _WIDTH - x - _MARGIN - (0 if each.relation is ElementRelation.CONTEXT else 160)
    lines = _lines(each)
    height = _LINE * len(lines) + 2 * _PAD
    inset = x + (26 if element.kind in _ROUND or element.kind is ElementKind.STRATEGY else 12)
    middle, right = y + height / 2, x + width
    whole = each.is_reference or not element.undeveloped
    link = arrow = ""
    if depth:
        # The element above may be in the previous piece.
        from_x, from_y = above.get(depth - 1, (x - _INDENT + 6, 0.0))
        link, arrow = _link(each.relation, from_x, from_y, x, middle)
    above[depth] = (x + 6, y + height)
    cross = f"M{x:g} {y:g}L{right:g} {y + height:g}M{right:g} {y:g}L{x:g} {y + height:g}"
    return {
        "kind": element.kind.name.lower(),
        "name": NAMES[element.kind],
        "lines": [(inset, y + _PAD + 11 + _LINE * i, line) for i, line in enumerate(lines)],
        "path": _outline(element.kind, x, y, width, height),
        "link": link,
        "arrow": arrow,
        "relation": each.relation,
        "is_reference": each.is_reference,
        "letter": _letter(element.kind, right, y + height),
        "diamond": "" if whole else f"M{x + width / 2:g} {y + height:g}l7 5l-7 5l-7 -5z",
        "cross": cross if element.defeated else "",
        "state": (right + 10, middle + 4, each.state) if each.state else None,
    }


def _link(
    relation: ElementRelation, x: float, y: float, to_x: float, to_y: float
) -> tuple[str, str]:
    """A line and its arrowhead: it points at the challenged element, or at the element below."""
    if relation is ElementRelation.CHALLENGE:
        return f"M{x:g} {y + 1:g}V{to_y:g}H{to_x:g}", f"M{x - 5:g} {y + 9:g}L{x:g} {y + 1:g}l5 8"
    return f"M{x:g} {y:g}V{to_y:g}H{to_x - 7:g}", f"M{to_x:g} {to_y:g}l-8 -4v8z"


def _letter(kind: ElementKind, right: float, bottom: float) -> tuple[float, float, str] | None:
    if kind not in (ElementKind.ASSUMPTION, ElementKind.JUSTIFICATION):
        return None
    return right - 8, bottom + 2, kind.value


def _outline(kind: ElementKind, x: float, y: float, width: float, height: float) -> str:
    """Rectangle, parallelogram, ellipse-ended or rounded, as the standard draws each kind."""
    right, bottom, half = x + width, y + height, height / 2
    match kind:
        case ElementKind.GOAL:
            return f"M{x:g} {y:g}H{right:g}V{bottom:g}H{x:g}Z"
        case ElementKind.STRATEGY:
            return f"M{x + 14:g} {y:g}H{right:g}L{right - 14:g} {bottom:g}H{x:g}Z"
        case ElementKind.CONTEXT:
            r = 10
            return (
                f"M{x + r:g} {y:g}H{right - r:g}a{r} {r} 0 0 1 {r} {r}V{bottom - r:g}"
                f"a{r} {r} 0 0 1 -{r} {r}H{x + r:g}a{r} {r} 0 0 1 -{r} -{r}V{y + r:g}"
                f"a{r} {r} 0 0 1 {r} -{r}Z"
            )
        case _:
            r = 26
            return (
                f"M{x + r:g} {y:g}H{right - r:g}a{r} {half:g} 0 0 1 0 {height:g}"
                f"H{x + r:g}a{r} {half:g} 0 0 1 0 -{height:g}Z"
            )


def _height(each: Placement) -> float:
    return _LINE * len(_lines(each)) + 2 * _PAD + _GAP


def _lines(each: Placement) -> list[str]:
    """The text in at most three lines; the list beside the drawing has the whole text."""
    aside = 0 if each.relation is ElementRelation.CONTEXT else 160
    room = _WIDTH - 2 * _MARGIN - 10 - _INDENT * each.depth - 60 - aside
    letters = max(24, int(room / _LETTER))
    lines = list(_wrapped(each.text.replace("`", ""), letters))
    if len(lines) > _LINES:
        return [*lines[: _LINES - 1], f"{lines[_LINES - 1][: letters - 1].rstrip()}…"]
    return lines or [""]


def _wrapped(text: str, letters: int) -> Iterator[str]:
    line = ""
    for word in text.split():
        while len(word) > letters:
            if line:
                yield line
                line = ""
            yield word[:letters]
            word = word[letters:]
        if line and len(line) + 1 + len(word) > letters:
            yield line
            line = word
        else:
            line = f"{line} {word}".strip()
    if line:
        yield line
