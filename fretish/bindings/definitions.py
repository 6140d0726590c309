"""Variables that stand for something else: constants, and what FRET calls assignments.

`[variable.limit] value = "1.5 m/s"`: in a sentence `limit` is 1.5 m/s. What is put in has the place
of the name, so that every place of a sentence is in its own text.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

from fretish import expressions as e
from fretish import syntax as s
from fretish.checking import conditions, too_deep
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.recursion import MOST, with_recursion_limit
from fretish.syntax import Sentence

Definitions = Mapping[str, e.Expression]
"""What names stand for; none by way of itself."""

MOST_PARTS = 10_000
"""Of a sentence with everything put in: a hundred definitions that each double would be endless."""


def circle(definitions: Definitions) -> tuple[str, ...]:
    """Names that stand for one another, from the first one back to it; empty where none do."""
    done: set[str] = set()
    for name in definitions:
        path = _circle_from(name, definitions, done)
        if path:
            return path
    return ()


def _circle_from(start: str, definitions: Definitions, done: set[str]) -> tuple[str, ...]:
    """A circle that can be reached; adds to `done` what leads to none."""
    path = {start: None}
    waiting = [_needs(start, definitions)]
    while waiting:
        name = next((each for each in waiting[-1] if each not in done), None)
        if name is None:
            done.add(path.popitem()[0])
            waiting.pop()
        elif name in path:
            names = [*path]
            return (*names[names.index(name) :], name)
        else:
            path[name] = None
            waiting.append(_needs(name, definitions))
    return ()


def _needs(name: str, definitions: Definitions) -> Iterator[str]:
    """The names that it stands for directly, as far as they stand for something themselves."""
    if name in definitions:
        yield from dict.fromkeys(
            each.id for each in e.names(definitions[name]) if each.id in definitions
        )


def used(sentence: Sentence, definitions: Definitions) -> Definitions:
    """Those that the sentence needs, each after what it needs itself."""
    found: dict[str, e.Expression] = {}
    for expression in conditions(sentence):
        for name in e.names(expression):
            for each in _order(name.id, definitions, found):
                found[each] = definitions[each]
    return found


def _order(start: str, definitions: Definitions, done: Mapping[str, object]) -> list[str]:
    """The name and all that it needs, from the inside out."""
    found: dict[str, None] = {}
    path = [(start, _needs(start, definitions))] if start in definitions else []
    while path:
        name, needs = path[-1]
        inner = next((each for each in needs if each not in found and each not in done), None)
        if inner is not None:
            path.append((inner, _needs(inner, definitions)))
            continue
        path.pop()
        if name not in done:
            found[name] = None
    return list(found)


def expanded(sentence: Sentence, needed: Definitions) -> Sentence | Diagnostic:
    """The sentence with what its names stand for; F115 or F670 where that is too much.

    Args:
        sentence: as written.
        needed: what it uses, in the order of `used`.
    """
    if not needed:
        return sentence
    sizes: dict[str, int] = {}
    depths: dict[str, int] = {}
    for name, value in needed.items():
        sizes[name], depths[name] = _size(value, sizes), _depth(value, depths)
    if sum(_size(each, sizes) for each in conditions(sentence)) > MOST_PARTS:
        return _too_large(sentence.span)
    if max(_depth(each, depths) for each in conditions(sentence)) > MOST:
        return too_deep(sentence)
    return s.with_expressions(sentence, partial(_put_in, values=needed))


def _size(tree: e.Expression, sizes: Mapping[str, int]) -> int:
    return sum(sizes.get(part.id, 1) if isinstance(part, e.Name) else 1 for part in e.parts(tree))


def _depth(tree: e.Expression, depths: Mapping[str, int]) -> int:
    deepest = 0
    waiting = [(tree, 1)]
    while waiting:
        part, level = waiting.pop()
        inner = depths.get(part.id, 1) if isinstance(part, e.Name) else 1
        deepest = max(deepest, level + inner - 1)
        waiting.extend((child, level + 1) for child in e.children(part))
    return deepest


@with_recursion_limit
def _put_in(tree: e.Expression, values: Definitions) -> e.Expression:
    """The expression with the values of its names, and of the names in these."""
    if isinstance(tree, e.Name):
        return _placed(tree, tree.span, values) if tree.id in values else tree
    return e.with_children(tree, [_put_in(part, values) for part in e.children(tree)])


def _placed(tree: e.Expression, span: Span | None, values: Definitions) -> e.Expression:
    """The expression as if it stood there, from the outside in: each part is made once."""
    while isinstance(tree, e.Name) and tree.id in values:
        tree = values[tree.id]
    placed = e.with_children(tree, [_placed(part, span, values) for part in e.children(tree)])
    match placed:
        case e.Name() | e.Number() | e.Quantity() | e.Negation() | e.Call():
            return replace(placed, span=span)
        case e.Arithmetic() | e.Comparison():
            return replace(placed, span=span)
        case _:
            return placed


def _too_large(place: Span | None) -> Diagnostic:
    return Diagnostic(
        Code.TOO_LARGE,
        f"with what its names stand for the sentence has more than {MOST_PARTS} parts",
        place,
        help="let names stand for less, or bind some of them by a proposition",
    )
