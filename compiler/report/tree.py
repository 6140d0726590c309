"""The assurance argument as an indented tree: each element a shape of GSN, in pieces of a page.

Source of the shapes: GSN Community Standard, version 3 (2021), part 1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from compiler.report.argument import Element, Kind

MOST = 120
"""More elements than these are not drawn: then only what is not shown is."""
_WIDTH, _INDENT, _MARGIN = 720, 26, 4
_LINE, _PAD, _GAP = 15, 9, 12
_LETTER = 6.1
_LINES = 3
_TALL = 880
"""A piece fits on a page of A4 at this height."""
_ASSUMED = 4
"""More assumptions of one goal are drawn as one."""
_ROUND = (Kind.SOLUTION, Kind.ASSUMPTION, Kind.JUSTIFICATION)


@dataclass(frozen=True, slots=True)
class Placed:
    """An element in the tree; `context` tells how it hangs on the one above."""

    element: Element
    depth: int
    context: bool


@dataclass(frozen=True, slots=True)
class Shape:
    """An element laid out; `path` is its outline, `link` leads from the element above."""

    kind: str
    name: str
    lines: tuple[tuple[float, float, str], ...]
    path: str
    link: str
    arrow: str
    context: bool
    letter: tuple[float, float, str] | None
    diamond: str


@dataclass(frozen=True, slots=True)
class Piece:
    """As much of the tree as fits on a page."""

    id: str
    title: str
    text: str
    width: int
    height: float
    shapes: tuple[Shape, ...]


def placed(elements: Sequence[Element]) -> tuple[Placed, ...]:
    """All elements from the top goal down, each once: where it is referred to first."""
    known = {element.id: element for element in elements}
    seen: set[str] = set()
    found: list[Placed] = []
    waiting = [(element.id, 0, False) for element in elements[:1]]
    while waiting:
        id, depth, context = waiting.pop()
        if id in seen:
            continue
        seen.add(id)
        element = known[id]
        found.append(Placed(element, depth, context))
        below = [(other, depth + 1, False) for other in element.supported_by]
        around = [(other, depth + 1, True) for other in element.in_context_of]
        waiting.extend(reversed([*around, *below]))
    return tuple(found)


def shortened(elements: Sequence[Element]) -> tuple[Element, ...]:
    """The hazards and requirements that are not shown, where all would be too many.

    A goal is left out where everything below it is developed, and whatever is not a goal or a
    strategy with it.
    """
    if len(elements) <= MOST:
        return tuple(elements)
    known = {element.id: element for element in elements}
    open_ = _open(elements[0].id, known)
    kept = [element for element in elements if element.id in open_][:MOST]
    ids = {element.id for element in kept}
    return tuple(
        replace(
            each, supported_by=tuple(id for id in each.supported_by if id in ids), in_context_of=()
        )
        for each in kept
    )


def grouped(elements: Sequence[Element]) -> tuple[Element, ...]:
    """Many assumptions of one goal as one, which says how many; the page lists them elsewhere."""
    kinds = {element.id: element.kind for element in elements}
    found: list[Element] = []
    gone: set[str] = set()
    for element in elements:
        assumed = [id for id in element.in_context_of if kinds[id] is Kind.ASSUMPTION]
        if len(assumed) <= _ASSUMED:
            found.append(element)
            continue
        gone.update(assumed)
        id = f"{assumed[0]}_and_others"
        around = tuple(each for each in element.in_context_of if each not in assumed)
        found.append(replace(element, in_context_of=(*around, id)))
        found.append(Element(id, Kind.ASSUMPTION, f"{len(assumed)} assumptions, listed in part 6"))
    return tuple(element for element in found if element.id not in gone)


def _open(top: str, known: Mapping[str, Element]) -> set[str]:
    """The top goal and each element below which something is undeveloped."""
    order, waiting, seen = [], [top], {top}
    while waiting:
        id = waiting.pop()
        order.append(id)
        fresh = [other for other in known[id].supported_by if other not in seen]
        seen.update(fresh)
        waiting.extend(fresh)
    found = {id for id in order if known[id].undeveloped}
    changed = True
    while changed:  # a requirement may stand under several hazards
        more = {id for id in order if id not in found and found & {*known[id].supported_by}}
        found |= more
        changed = bool(more)
    return {top, *found}


# Layout ----------------------------------------------------------------------------------------


def pieces(elements: Sequence[Element]) -> tuple[Piece, ...]:
    """The drawing; where it is longer than a page, in several pieces."""
    groups: list[list[Placed]] = [[]]
    height = 0.0
    for each in placed(elements):
        tall = _height(each)
        if groups[-1] and (height + tall > _TALL or _begins(each, height)):
            groups.append([])
            height = 0.0
        groups[-1].append(each)
        height += tall
    return tuple(_piece(group, i, len(groups)) for i, group in enumerate(groups, 1) if group)


def _begins(each: Placed, height: float) -> bool:
    """A hazard does not begin near the end of a page."""
    return each.depth <= 2 and not each.context and height > 0.75 * _TALL


def _piece(group: Sequence[Placed], number: int, count: int) -> Piece:
    shapes: list[Shape] = []
    above: dict[int, tuple[float, float]] = {}
    y = 6.0
    for each in group:
        shapes.append(_shape(each, y, above))
        y += _height(each)
    part = f", part {number} of {count}" if count > 1 else ""
    text = f"{len(group)} elements, from “{group[0].element.text}”; the list below says them all."
    return Piece(f"argument-{number}", f"Assurance argument{part}", text, _WIDTH, y, tuple(shapes))


def _shape(each: Placed, y: float, above: dict[int, tuple[float, float]]) -> Shape:
    element, depth = each.element, each.depth
    x = _MARGIN + _INDENT * depth + 10
    width = _WIDTH - x - _MARGIN - (160 if not each.context else 0)
    lines = _lines(each)
    height = _LINE * len(lines) + 2 * _PAD
    inset = x + (26 if element.kind in _ROUND or element.kind is Kind.STRATEGY else 12)
    middle = y + height / 2
    link = arrow = ""
    if depth:
        from_x, from_y = above.get(depth - 1, (x - _INDENT + 6, 0.0))  # from the piece before
        link = f"M{from_x:g} {from_y:g}V{middle:g}H{x - 7:g}"
        arrow = f"M{x:g} {middle:g}l-8 -4v8z"
    above[depth] = (x + 6, y + height)
    return Shape(
        kind=element.kind.name.lower(),
        name=element.kind.name.capitalize(),
        lines=tuple((inset, y + _PAD + 11 + _LINE * i, line) for i, line in enumerate(lines)),
        path=_outline(element.kind, x, y, width, height),
        link=link,
        arrow=arrow,
        context=each.context,
        letter=_letter(element.kind, x + width, y + height),
        diamond=f"M{x + width / 2:g} {y + height:g}l7 5l-7 5l-7 -5z" if element.undeveloped else "",
    )


def _letter(kind: Kind, right: float, bottom: float) -> tuple[float, float, str] | None:
    if kind not in (Kind.ASSUMPTION, Kind.JUSTIFICATION):
        return None
    return right - 8, bottom + 2, kind.value


def _outline(kind: Kind, x: float, y: float, width: float, height: float) -> str:
    """Rectangle, parallelogram, ellipse-ended or rounded, as the standard draws each kind."""
    right, bottom, half = x + width, y + height, height / 2
    match kind:
        case Kind.GOAL:
            return f"M{x:g} {y:g}H{right:g}V{bottom:g}H{x:g}Z"
        case Kind.STRATEGY:
            return f"M{x + 14:g} {y:g}H{right:g}L{right - 14:g} {bottom:g}H{x:g}Z"
        case Kind.CONTEXT:
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


def _height(each: Placed) -> float:
    return _LINE * len(_lines(each)) + 2 * _PAD + _GAP


def _lines(each: Placed) -> list[str]:
    """The text in at most three lines; what does not fit stands in the list."""
    room = _WIDTH - 2 * _MARGIN - 10 - _INDENT * each.depth - 60 - (0 if each.context else 160)
    letters = max(24, int(room / _LETTER))
    found = list(_wrapped(each.element.text, letters))
    if len(found) > _LINES:
        return [*found[: _LINES - 1], f"{found[_LINES - 1][: letters - 1].rstrip()}…"]
    return found or [""]


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
